"""The scenes of the score: jobs/score/NAME_draws.json is the reference of its draws. Everything else follows from the job.

The reference is the direct solve in balance with BDF2, with two steps, s and s / 2. Its frames at the larger step are the
instants at which motions are compared. `samples` is the number of draws for tuning, for testing, and for those who time
the chosen settings again. Seeds of these are SEEDS_APART apart.
"""

import copy
import json
import os

from rodsweep.reading import job_paths
from rodsweep.reading.errors import KeyNotFound, SweepFileError, not_found
from rodsweep.scoring import settings
from rodsweep.scoring.settings import Axes

ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", ".."))
JOBS = os.path.join("jobs", "score")
MODELS = os.path.join("network", "pretrained")
MEASURED = os.path.join("analysis", "results", "score")
LEVELS = (1e-1, 1e-2, 1e-3, 1e-4)
TUNING, TEST, AGAIN = DRAWS = ("tuning", "test", "again")
ENDING = "_draws.json"
SEEDS_APART = 10000
FEWER_RENEWALS = 0.1
CHAINS = {"rods": (5, 30), "rods-large": (3,)}
LATTICES = {"lattices": (5, 20)}
SMALLER = {"large_forest": "forest", "large_lattice": "lattice", "large_net": "net"}
PAPER = {"bending_rod": "bending-paper-best", "helix": "helix-paper-best", "tree": "tree-paper-best",
         "falling_rods": "falling-paper-best", "knot": "knot-paper-best"}


def names(root=ROOT):
    """Raises KeyNotFound if there are none, as where pip installed the package."""
    folder = os.path.join(root, JOBS)
    there = os.listdir(folder) if os.path.isdir(folder) else []
    found = [name.removesuffix(ENDING) for name in there if name.endswith(ENDING)]
    if not found:
        raise KeyNotFound(f"{folder} has no scenes (NAME{ENDING}): give the folder of rodsweep's sources with --root")
    return sorted(found)


class Scene:
    """`root` has jobs/ and network/: paths of settings are relative to it."""

    def __init__(self, name, root=ROOT):
        self.name, self.root = name, root
        path = os.path.join(root, JOBS, name + ENDING)
        if not os.path.exists(path):
            raise not_found("scene", name, names(root))
        with open(path, encoding="utf-8") as file:
            self.job = json.load(file)
        self.samples = self.job["samples"]
        self.few, self.fewest = max(2, self.samples // 5), min(2, self.samples // 4)
        scene = self.job["scene"]
        self.title = name.replace("_", " ")
        self.has_contact = isinstance(scene.get("contact"), dict)
        self.meshed = scene["type"] in ("lattice", "net")
        self.steps_s = self.job["time"]["step_s"]["grid"]
        self.instant_s = self.steps_s[0] * self.job["record"]["trajectory_every"]

    def measured(self, ending):
        """Path of what was measured: NAME.json, and NAME.jsonl.xz with all settings that were tried."""
        return os.path.join(self.root, MEASURED, self.name + ending)

    def axes(self, kind):
        paper = PAPER.get(self.job["scene"]["type"])
        return Axes(kind, {os.path.join(MODELS, settings.OURS, f"{name}.h5"): corrections
                           for name, corrections in (LATTICES if self.meshed else CHAINS).items()},
                    [os.path.join(MODELS, f"{paper}.h5")] if paper else [], self.meshed)

    def steps(self):
        """Those of the grid whose instants are whole numbers of steps, and that the reference is finer than."""
        def fits(step):
            between = self.instant_s / step.step_s
            return step.step_s > self.steps_s[-1] and abs(between - round(between)) < 1e-9
        return tuple([step for step in some if fits(step)] for some in settings.steps(self.has_contact))

    def renews(self, setting):
        """Whether the timed steps, all but the first, renew what a setting keeps about as often as it would in the long run."""
        timed = round(self.job["time"]["duration_s"] / setting.step.step_s) - 1
        return all(timed // lag * lag >= (1 - FEWER_RENEWALS) * timed for lag in setting.lags())

    def reference_job(self, draws):
        made = copy.deepcopy(self.job)
        made["name"] = f"{self.name}_reference_{draws}"
        made["seed"] += SEEDS_APART * DRAWS.index(draws)
        return made

    def job_of(self, some, draws, samples, frames=True):
        """A job whose points are these settings, in this order. With frames they must have one step_s."""
        made = self.reference_job(draws)
        made.update(name=f"{self.name}_{draws}", samples=samples)
        time = made["time"]
        del time["step_s"], time["newton_iterations"]
        entries = {"step_s": [s.step.step_s for s in some], "integrator": [s.step.integrator for s in some],
                   "newton_iterations": [s.step.newton for s in some], "balance": [s.step.balance for s in some]}
        time.update({key: {"zip": values} for key, values in entries.items()})
        if self.has_contact:
            made["scene"]["contact"]["tolerance"] = {"zip": [s.step.contact for s in some]}
        made["solve"] = {"zip": [self._placed(s.solve) for s in some]}
        if any(settings.DIRECT not in s.kinds() and settings.GAUSS_SEIDEL not in s.kinds() for s in some):
            made["guesses"] = [{"zip": [self._placed(s.guess) for s in some]}]
        made["record"] = {"solves": "summary", "norms": "none"}
        if frames:
            steps = {s.step.step_s for s in some}
            if len(steps) > 1:
                raise SweepFileError(f"frames at fixed instants need one step_s, not {sorted(steps)}")
            made["record"]["trajectory_every"] = round(self.instant_s / steps.pop())
        return made

    def _placed(self, text):
        return job_paths.placed(json.loads(text), lambda path: os.path.join(self.root, path))
