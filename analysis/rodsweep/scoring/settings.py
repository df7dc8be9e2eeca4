"""A setting of the score: a step and a way to solve its systems; its kind; and the axes on which settings differ.

A setting is what a job says. Learned ones name a training, 1 to 3: models/rods.h5, rods-2.h5, ....
"""

import json
import re
from dataclasses import asdict, dataclass, replace

from rodsweep.reading import job_paths, texts

STEPS_S = (0.08, 0.04, 0.02, 0.01, 0.005, 0.0025, 0.00125, 0.000625)
INTEGRATORS = ("bdf2", "euler")
NEWTON = (1, 2, 3, 6)
CONTACT = (1e-2, 1e-3, 1e-4, 1e-5)
TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
LAGS = (0, 4, 8, 32)
LAG_OF_CHOLESKY = 10            # of lagged_cholesky, if a job gives no other
SWEEPS = (1, 3, 10, 30, 100)    # of Gauss-Seidel
STOPS = (1, 0.1)                # stop_at, over the tolerance of the solve
TRAININGS = (1, 2, 3)
OURS = "score"                  # folder of the models with three trainings
MOST_ITERATIONS = 1000

DIRECT, ZERO, CLASSICAL, CALL, FACTORS, JACOBI, GAUSS_SEIDEL, OWN = KINDS = (
    "direct solve", "CG from zero", "CG, classical guess", "CG, one call", "CG, learned preconditioner", "CG, Jacobi",
    "Gauss-Seidel", "your guess")
OF_CG = (ZERO, CLASSICAL, CALL, FACTORS, JACOBI)


@dataclass(frozen=True, order=True)
class Step:
    """Without contact, `contact` (its tolerance) is 0. Gauss-Seidel has neither `newton` nor balance."""
    step_s: float
    integrator: str
    newton: int = 1
    balance: bool = False
    contact: float = 0

    def text(self):
        return ", ".join([f"Newton {self.newton}", f"{self.integrator} {1e3 * self.step_s:g} ms",
                          *(["in balance"] if self.balance else []),
                          *([f"contact {texts.tolerance_label(self.contact)}"] if self.contact else [])])


@dataclass(frozen=True)
class Setting:
    """`solve` and `guess` are JSON as in a job, with sorted keys; a guess is of CG only."""
    step: Step
    solve: str
    guess: str = '"zero"'

    def kinds(self):
        solve, guess = json.loads(self.solve), json.loads(self.guess)
        if solve["method"] == "direct":
            return {DIRECT}
        if solve["method"] == "xpbd":
            return {GAUSS_SEIDEL}
        if "python" in guess:
            return {OWN}
        return {_kind_of_guess(guess, solve["preconditioner"])} | ({JACOBI} if solve["preconditioner"] == "jacobi" else set())

    def trainings(self):
        """It, and the same with other trainings."""
        return list(dict.fromkeys(self.of_training(number) for number in TRAININGS))

    def of_training(self, number):
        """With our models of another training, which have -2 or -3 in their names."""
        solve, guess = (canonical(job_paths.placed(json.loads(part), lambda path: model_of(path, number), ("model",)))
                        for part in (self.solve, self.guess))
        return replace(self, solve=solve, guess=guess)

    def models(self):
        """Their paths."""
        return job_paths.given([json.loads(self.solve), json.loads(self.guess)], ("model",))

    def lags(self):
        """The numbers of steps for which it keeps a preconditioner or a network's factors."""
        solve = json.loads(self.solve)
        own = solve.get("lag_steps", LAG_OF_CHOLESKY if solve.get("preconditioner") == "lagged_cholesky" else 0)
        return {own, *map(int, re.findall(r'"lag_steps": (\d+)', self.guess))} - {0}

    def preconditioner(self):
        """With its lag and model, as JSON."""
        solve = json.loads(self.solve)
        return canonical({key: solve[key] for key in ("preconditioner", "lag_steps", "learned_preconditioner") if key in solve})

    def text(self):
        solve = json.loads(self.solve)
        if solve["method"] != "cg":
            way = solve["method"] if "iterations" not in solve else f"{solve['method']} {solve['iterations']}"
            return f"{way}, {self.step.text()}"
        name = solve["preconditioner"]
        if name == "learned":
            name += " " + _model(solve["learned_preconditioner"]["model"])
        name += f" lag {solve['lag_steps']}" if solve.get("lag_steps") else ""
        forced = " with forcing terms" if "forcing" in solve else ""
        return (f"CG {name} from {guess_text(json.loads(self.guess))} to {texts.tolerance_label(solve['tolerance'])}{forced}, "
                f"{self.step.text()}")

    def as_json(self):
        return {"step": asdict(self.step), "solve": json.loads(self.solve), "guess": json.loads(self.guess)}

    @classmethod
    def from_json(cls, found):
        return cls(Step(**found["step"]), canonical(found["solve"]), canonical(found["guess"]))


def model_of(path, number):
    """The path of another training of a model; its own if there is only one."""
    return re.sub(rf"((?:^|/){OURS}/[\w-]+?)(-\d)?\.h5$", rf"\1{f'-{number}' if number > 1 else ''}.h5", path)


def canonical(value):
    return json.dumps(value, sort_keys=True)


def _kind_of_guess(guess, preconditioner):
    text = canonical(guess)
    corrections = int((re.search(r'"corrections": (\d+)', text) or [0, 1])[1])
    if preconditioner == "learned" or corrections > 1:
        return FACTORS
    return CALL if "copingnet" in text else ZERO if guess == "zero" else CLASSICAL


def _model(path):
    return path.rsplit("/", 1)[-1].removesuffix(".h5")


def guess_text(guess):
    """As the program's labels: copingnet rods 5 lag 8 to 0.001."""
    if isinstance(guess, str):
        return guess
    (name, keys), = guess.items()
    if name == "copingnet":
        words = [_model(keys["model"]), keys.get("corrections"), keys.get("lag_steps") and f"lag {keys['lag_steps']}",
                 keys.get("stop_at") and f"to {keys['stop_at']:g}"]
    elif name == "python":
        words = [_model(keys["file"]).removesuffix(".py")]
    else:
        words = [guess_text(keys["guess"]) if "guess" in keys else None, keys.get("size")]
    return " ".join([name, *(str(word) for word in words if word)])


@dataclass(frozen=True)
class Way:
    """How CG solves a system. In `guess`, "stop_at" counts in tolerances of the solve."""
    preconditioner: str
    tolerance: float
    guess: str
    forcing: bool = False

    def setting(self, step):
        solve = {"method": "cg", "tolerance": self.tolerance, "max_iterations": MOST_ITERATIONS,
                 **json.loads(self.preconditioner)}
        if self.forcing and step.newton > 1:
            solve["forcing"] = "eisenstat_walker"
        return Setting(step, canonical(solve), canonical(_stopping(json.loads(self.guess), self.tolerance)))


def _stopping(guess, tolerance):
    """A guess whose "stop_at", also within another guess, is multiplied by the tolerance."""
    if not isinstance(guess, dict):
        return guess
    return {key: float(f"{value * tolerance:.1e}") if key == "stop_at" else _stopping(value, tolerance)
            for key, value in guess.items()}


def direct(step):
    return Setting(step, canonical({"method": "direct"}))


def gauss_seidel(step, iterations):
    return Setting(step, canonical({"method": "xpbd", "iterations": iterations}))


def steps(contact):
    """All steps of the grid for a direct solve, and those of Gauss-Seidel."""
    tolerances = CONTACT if contact else (0,)
    every = [Step(step, integrator, newton, balance, tolerance) for tolerance in tolerances for step in STEPS_S
             for integrator in INTEGRATORS for newton in NEWTON for balance in (False, True)]
    return every, [Step(step, integrator, contact=tolerance) for tolerance in tolerances for step in STEPS_S
                   for integrator in INTEGRATORS]


class Axes:
    """The values of a kind of CG on each axis; the first ones are where its search begins. `models`: {path: numbers of
    corrections}; `paper`: paths of networks of Shao et al. for this scene; `condensed`: the preconditioner makes sense."""

    def __init__(self, kind, models, paper=(), condensed=False):
        plain = [{"preconditioner": "block_icc"}, {"preconditioner": "jacobi"}, {"preconditioner": "lagged_cholesky"},
                 *({"preconditioner": name, "lag_steps": lag} for name in ("block_icc", "lagged_cholesky") for lag in LAGS[1:]),
                 *([{"preconditioner": "condensed"}, {"preconditioner": "condensed", "lag_steps": 8}] if condensed else [])]
        learned = [{"preconditioner": "learned", "learned_preconditioner": {"model": model},
                    **({"lag_steps": lag} if lag else {})} for model in models for lag in LAGS]
        classical = ["previous", "quadratic", {"regression": {"size": 6}}, {"totals": {"guess": {"regression": {"size": 6}}}},
                     {"fischer": {"size": 10}}, {"subspace": {"size": 10}}, {"totals": {"guess": {"subspace": {"size": 10}}}},
                     *([] if condensed else [{"deflation": {"size": 10}}, {"ritz": {"guess": "previous", "size": 10}}])]
        one = [{"copingnet": {"model": model, **lagged}} for model in models for lagged in _lagged()]
        one += [{"first": {"guess": guess}} for guess in one if "lag_steps" not in guess["copingnet"]]
        one += [{"first": {"guess": {"copingnet": {"model": model}}}} for model in paper]
        several = [{"copingnet": {"model": model, "corrections": corrections, **lagged}} for model, several in models.items()
                   for corrections in several for lagged in _lagged() if "stop_at" in lagged]
        self.preconditioners, self.guesses = {
            ZERO: (plain, ["zero"]), CLASSICAL: (plain, classical), CALL: (plain, one),
            FACTORS: (learned + plain, several + ["zero", *classical, *one]),
            JACOBI: ([{"preconditioner": "jacobi"}], ["zero", *classical, *one, *several])}[kind]
        self.preconditioners = [canonical(value) for value in self.preconditioners]
        self.guesses = [canonical(value) for value in self.guesses]
        self.kind = kind

    def first(self):
        return Way(self.preconditioners[0], 1e-2, self.guesses[0])

    def has(self, way):
        return self.kind in way.setting(Step(1, "bdf2")).kinds()

    def beside(self, way):
        """The ways that differ on one axis."""
        found = [replace(way, preconditioner=value) for value in self.preconditioners]
        found += [replace(way, tolerance=value, forcing=forcing) for value in TOLERANCES for forcing in (False, True)]
        found += [replace(way, guess=value) for value in self.guesses]
        return [other for other in dict.fromkeys(found) if other != way and self.has(other)]

    def screened(self):
        """Every preconditioner with every tolerance, for the first guess, and for the first that keeps a network's factors
        and stops at a residual."""
        lagged = next((guess for guess in self.guesses if "lag_steps" in guess and "stop_at" in guess), self.guesses[0])
        return [way for guess in dict.fromkeys([self.guesses[0], lagged]) for value in self.preconditioners
                for tolerance in TOLERANCES if self.has(way := Way(value, tolerance, guess))]

    def crossed(self, way, guesses):
        """A way of any kind or error with these guesses, where that is of this kind."""
        return [other for guess in guesses if self.has(other := replace(way, guess=guess))]


def _lagged():
    """Uses of a network's factors: with or without a residual at which they stop, for 0 to 32 steps."""
    return [{**({"lag_steps": lag} if lag else {}), **({"stop_at": stop} if stop else {})}
            for lag in LAGS for stop in (None, *STOPS)]
