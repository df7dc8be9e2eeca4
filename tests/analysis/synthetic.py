"""Results files with planted numbers, in the layout of runner/file/columns.cpp, for the tests of the analysis scripts.

Every solve of simulation s with N segments takes Plant.zero_iterations() from zero, and that times Plant.ratio() with a
guess. Times are planted in the same way. Import this module first in a test: it makes analysis/ importable.
"""

import itertools
import os
import sys
from dataclasses import dataclass, field

import numpy as np

ANALYSIS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "analysis")
sys.path.insert(0, ANALYSIS)
import h5py  # noqa: E402

GUESSES = ("zero", "previous", "quadratic", "oracle(0.1)")
ALONG = ("length_drift", "kinetic_energy_j", "potential_energy_j", "elastic_energy_j")
TOLERANCES = tuple(10.0 ** -k for k in range(1, 9))


class Plant:
    """Known qualities; tests override some. `draw` is the number of the sample."""

    def __init__(self, **others):
        vars(self).update(others)

    quality = {"zero": 1.0, "previous": 0.5, "linear": 0.6, "quadratic": 0.25, "oracle(0.1)": 0.1, "oracle(0.01)": 0.05}

    def zero_iterations(self, segments, tolerance):
        return 20 * segments * (1 + tolerance)

    def ratio(self, guess, tolerance, newton, segments, draw):
        return self.quality[guess] if newton == 0 else 1.0 if guess == "zero" else 0.9

    def cg_s(self, guess, newton, segments, draw):
        return 1e-6 * segments * self.quality[guess] * (1 if newton == 0 else 0.5)

    def guess_s(self, guess, newton, segments, draw):
        return 0.0 if guess == "zero" else 1e-7 * segments

    def at_step(self, guess, step):
        """A factor of the iterations in each step."""
        return np.ones(len(step))

    def length_drift(self, step, steps, draw, guess):
        return -self.drift * step / max(1, steps - 1)

    def kinetic_energy_j(self, step, steps, draw, guess):
        return np.full(len(step), 2.0)

    def potential_energy_j(self, step, steps, draw, guess):
        return -0.5 * np.arange(len(step)) / max(1, steps - 1)

    def elastic_energy_j(self, step, steps, draw, guess):
        return np.full(len(step), 1.0)

    assemble_s = 2e-6
    direct_s = 8e-6
    rest_s = 3e-6
    drift = 1e-3
    gap = 2e-3           # before every solve and at the end of a step, like the residual
    residual = 1e-10     # of Newton
    penetration = None   # a number: the penetration in every step of a file with contact
    reached = staticmethod(lambda guess, tolerance, newton, segments, draw: True)    # to 1e-2: the timed solves too


def unless(guess, least=0):
    """A Plant.reached: a guess does not reach tolerances of at most `least`."""
    return lambda name, tolerance, *_: name != guess or tolerance > least


@dataclass
class Sweep:
    """A job: scenes x grid x samples (x guesses in a closed loop). `grid` maps parameter names to lists of values."""
    scenes: tuple = ("bending_rod", "helix")
    grid: dict = field(default_factory=lambda: {"scene.segments": [10, 20, 40]})
    random: dict = field(default_factory=lambda: {"scene.youngs_modulus_pa": ("Pa", lambda draw: 1e4 * 2.0 ** draw)})
    samples: int = 4
    guesses: tuple = GUESSES
    steps: int = 5
    newton: int = 3    # iterations a step, the most that are allowed
    closed_loop: bool = False
    method: str = "cg"
    model: str = ""   # for end_to_end
    solves: bool = True
    plant: Plant = field(default_factory=Plant)
    pending: tuple = ()
    failed: dict = field(default_factory=dict)       # task: outcome
    oversubscribed: bool = False
    counts_in_rows: bool = False   # True: planted counts in rows of /solves; else 10 in all, as the planted times have
    attributes: dict = field(default_factory=lambda: {"program": "rodsweep", "schema_version": 2})

    def tasks(self):
        """(scene, grid values, draw, own guess, point) of every task, in order."""
        found, point = [], 0
        for scene in self.scenes:
            for values in itertools.product(*self.grid.values()):
                for draw in range(self.samples):
                    for own in range(len(self.guesses)) if self.closed_loop else [-1]:
                        found.append((scene, dict(zip(self.grid, values)), draw, own, point))
                    point += 1
        return found

    def write(self, path):
        with h5py.File(path, "w") as h5:
            self._write(h5)
        return path

    def _write(self, h5):
        h5.attrs.update(self.attributes)
        tasks, count = self.tasks(), len(self.tasks())
        guessing = self.method == "cg"
        guesses = self.guesses if guessing else ()
        h5["job/text"] = np.bytes_('{"name": "synthetic", "kind": "sweep", "seed": 7}')
        if guessing:
            h5["axes/guess"] = np.array([label.encode() for label in guesses], dtype="S48")
            h5["axes/tolerance"] = np.array(TOLERANCES)
        rows_per_task = self.steps * self.newton if self.solves and guessing else 0
        integer = {"point": [t[4] for t in tasks], "sample": [t[2] for t in tasks], "own_guess": [t[3] for t in tasks],
                   "segments": [t[1].get("scene.segments", 10) for t in tasks],
                   "first_step": np.arange(count) * self.steps, "steps": [self.steps] * count,
                   "first_solve": np.arange(count) * rows_per_task, "solves": [rows_per_task] * count}
        for name, values in integer.items():
            h5[f"tasks/{name}"] = np.array(values, dtype=np.int64)
        done = np.array([t not in self.pending for t in range(count)])
        h5["tasks/state"] = done.astype(np.uint8)
        h5["tasks/outcome"] = np.array([self.failed.get(t, "ok") if done[t] else "" for t in range(count)], dtype="S16")
        h5["tasks/message"] = np.array(["planted" if t in self.failed else "" for t in range(count)], dtype="S64")
        self._parameters(h5, tasks)
        runs = {"begin": ["2025-11-21T10:00:00Z", ""], "end": ["", ""], "host": ["here", ""],
                "revision": ["abc123", ""]}
        for name, values in runs.items():
            h5[f"runs/{name}"] = np.array(values, dtype="S32")
        h5["runs/ranks"] = np.array([3, 0], dtype=np.int32)
        h5["runs/oversubscribed"] = np.array([self.oversubscribed, 0], dtype=np.uint8)
        for name, values in self._results(tasks, guesses, done, rows_per_task).items():
            h5[name] = values

    def _parameters(self, h5, tasks):
        text = {"solve.method": self.method, **({"solve.model": self.model} if self.model else {}),
                "solve.preconditioner": "jacobi", "solve.norm": "true_residual"}
        columns = {"scene.type": ("", [t[0] for t in tasks])}
        columns.update({key: ("", [value] * len(tasks)) for key, value in text.items()})
        columns.update({"solve.tolerance": ("", [1e-2] * len(tasks)), "time.step_s": ("s", [0.02] * len(tasks))})
        columns["time.newton_iterations"] = ("", [self.newton] * len(tasks))
        columns["time.newton_tolerance"] = ("", [1e-9] * len(tasks))
        columns.update({key: ("", [t[1][key] for t in tasks]) for key in self.grid})
        columns.update({key: (unit, [value(t[2]) for t in tasks]) for key, (unit, value) in self.random.items()})
        columns["scene.length_m"] = ("m", [1.0 + t[2] if t[0] == "bending_rod" else np.nan for t in tasks])
        if self.closed_loop:
            columns["guess"] = ("", [self.guesses[t[3]] for t in tasks])
        for key, (unit, values) in columns.items():
            text = isinstance(values[0], str)
            if text:
                values = [value.encode() for value in values]
            item = h5.create_dataset(f"tasks/parameters/{key}", data=np.array(values, dtype="S48" if text else None))
            item.attrs.update({"unit": unit, "meaning": f"the {key}", "swept": len(set(values)) > 1})

    def _results(self, tasks, guesses, done, rows_per_task):
        """All datasets of results. Rows of pending tasks are zero, like unwritten bytes of a file."""
        parts = []
        for t, (_, values, draw, own, _) in enumerate(tasks):
            mine, leading = (range(len(guesses)), "") if own < 0 else ([own], guesses[own])
            part = {**self._steps(draw, leading),
                    **self._solves(guesses, mine, values.get("scene.segments", 10), draw, rows_per_task > 0)}
            parts.append(part if done[t] else {name: np.zeros_like(rows) for name, rows in part.items()})
        found = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        found["tasks/steps_done"] = np.where(done, self.steps, 0).astype(np.int32)
        found["timing/tasks/run"] = np.zeros(len(tasks), dtype=np.int32)
        return found

    def _steps(self, draw, guess):
        """A task's rows of /steps."""
        plant, step = self.plant, np.arange(self.steps)
        found = {"time_s": 0.02 * (step + 1), "joint_gap": np.full(len(step), plant.gap),
                 "newton_residual": np.full(len(step), plant.residual),
                 "momentum_kg_m_s": np.tile([3.0, 0, 4], (len(step), 1)),
                 "newton_iterations": np.full(len(step), self.newton, dtype=np.int16),
                 **{name: getattr(plant, name)(step, self.steps, draw, guess) for name in ALONG}}
        if plant.penetration is not None:
            found["penetration"] = np.full(len(step), plant.penetration)
        return {**{f"steps/{name}": values for name, values in found.items()},
                "timing/steps/rest_s": np.full(len(step), plant.rest_s, dtype=np.float32)}

    def _solves(self, guesses, mine, segments, draw, with_rows):
        """The sums of /solves of a task with the guesses `mine`; its rows too, if with_rows."""
        plant, shape = self.plant, (len(guesses), len(TOLERANCES))
        j, at = np.tile(np.arange(self.newton), self.steps), np.repeat(np.arange(self.steps), self.newton)
        sums = {f"tasks/{name}{which}": np.full((1,) + shape, -1, dtype=np.int64)
                for name in ("iterations_sum", "unreached") for which in ("", "_all")}
        counts = np.full((len(j),) + shape, -1, dtype=np.int16)
        timed = {name: np.full((1, len(guesses)), -1, dtype=np.int32) for name in ("solves_timed", "solves_missed")}
        for g, (k, tolerance) in itertools.product(mine, enumerate(TOLERANCES)):
            by_newton = np.array([plant.zero_iterations(segments, tolerance) *
                                  plant.ratio(guesses[g], tolerance, i, segments, draw) for i in range(self.newton)])
            used = np.rint(by_newton[j] * plant.at_step(guesses[g], at)).astype(int)
            reached = np.array([plant.reached(guesses[g], tolerance, i, segments, draw) for i in range(self.newton)])[j]
            if tolerance == 1e-2:
                timed["solves_timed"][0, g], timed["solves_missed"][0, g] = len(j), np.count_nonzero(~reached)
            for which, counted in (("", j == 0), ("_all", j >= 0)):
                sums[f"tasks/iterations_sum{which}"][0, g, k] = used[counted].sum()
                sums[f"tasks/unreached{which}"][0, g, k] = (counted & ~reached).sum()
            counts[:, g, k] = np.where(reached, used, -1) if self.counts_in_rows else 10
        times = np.full((2, self.newton, len(guesses)), np.nan, dtype=np.float32)
        for g, i in itertools.product(mine, range(self.newton)):
            times[:, i, g] = [take(guesses[g], i, segments, draw) for take in (plant.guess_s, plant.cg_s)]
        rows = {"solves/iterations": counts, "solves/start_matvecs": np.zeros(counts.shape[:2], dtype=np.int16),
                "solves/step": at.astype(np.int32), "solves/newton": j.astype(np.int32),
                "solves/newton_residual": np.full(len(j), plant.residual),
                "solves/joint_gap": np.full(len(j), plant.gap),
                "timing/solves/guess_s": times[0, j], "timing/solves/cg_s": times[1, j],
                **{f"timing/solves/{name}": np.full(len(j), getattr(plant, name), dtype=np.float32)
                   for name in ("assemble_s", "direct_s")}}
        sums.update({f"timing/tasks/{name}": values for name, values in timed.items()})
        return {**sums, **{name: values if with_rows else values[:0] for name, values in rows.items()}}


def write_large(path, tasks, steps, newton, closed_loop=False):
    """A packed file of about `tasks` tasks: copies of the tasks of one draw, with different random parameters."""
    Sweep(scenes=("helix",), grid={"scene.segments": [10]}, samples=1, steps=steps, newton=newton,
          closed_loop=closed_loop, counts_in_rows=True).write(path + ".one")
    with h5py.File(path + ".one") as one, h5py.File(path, "w") as h5:
        mine = len(one["tasks/state"])
        copies = tasks // mine
        h5.attrs.update(one.attrs)

        def copy(name, item):
            if not isinstance(item, h5py.Dataset):
                return
            values, rows = item[()], name.split("/")[-2] in ("steps", "solves")
            if name.startswith(("tasks/", "timing/tasks/")):
                made = h5.create_dataset(name, data=np.concatenate(copies * [values]))
            elif rows:
                made = h5.create_dataset(name, (copies * len(values),) + values.shape[1:], values.dtype, shuffle=True,
                                         compression="gzip", compression_opts=1, chunks=(4096,) + values.shape[1:])
                some = max(1, (1 << 16) // len(values))    # copies written at once
                for first in range(0, copies, some):
                    block = np.concatenate(min(some, copies - first) * [values])
                    made[first * len(values):first * len(values) + len(block)] = block
            else:
                made = h5.create_dataset(name, data=values)
            made.attrs.update(item.attrs)

        one.visititems(copy)
        draw = np.repeat(np.arange(copies), mine)
        for name, values in (("first_step", np.arange(len(draw)) * steps), ("sample", draw), ("point", draw),
                             ("first_solve", np.arange(len(draw)) * steps * newton),
                             ("parameters/scene.youngs_modulus_pa", 1e4 + draw)):
            h5[f"tasks/{name}"][:] = values
        h5["tasks/parameters/scene.youngs_modulus_pa"].attrs["swept"] = True
    os.remove(path + ".one")
    return path


def spend_on_quadratic(h5):
    """Gives a planted sweep products with A, those of quadratic itself as many as CG from zero takes."""
    for which in ("", "_all"):
        spent = h5[f"tasks/iterations_sum{which}"][:]
        spent[:, 2] += spent[:, 0]
        h5[f"tasks/matvecs_sum{which}"] = spent
