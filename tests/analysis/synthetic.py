"""Results files with planted numbers, in the layout of runner/file/record.hpp, for the tests of the analysis scripts.

Every solve of simulation s with N segments takes Plant.zero_iterations() from zero and that times Plant.ratio() with a
guess; the times are planted in the same way. Put first among a test's imports: it makes analysis/ importable.
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
TOLERANCES = tuple(10.0 ** -k for k in range(1, 9))


class Plant:
    """Known qualities. Override what a test needs; `draw` is the number of the sample."""

    quality = {"zero": 1.0, "previous": 0.5, "linear": 0.6, "quadratic": 0.25, "oracle(0.1)": 0.1, "oracle(0.01)": 0.05}

    def zero_iterations(self, segments, tolerance):
        return 20 * segments * (1 + tolerance)

    def ratio(self, guess, tolerance, newton, segments, draw):
        return self.quality[guess] if newton == 0 else 1.0 if guess == "zero" else 0.9

    def cg_s(self, guess, newton, segments, draw):
        return 1e-6 * segments * self.quality[guess] * (1 if newton == 0 else 0.5)

    def guess_s(self, guess, newton, segments, draw):
        return 0.0 if guess == "zero" else 1e-7 * segments

    assemble_s = 2e-6
    direct_s = 8e-6
    rest_s = 3e-6
    drift = 1e-3
    gap = 2e-3
    reached = staticmethod(lambda guess, tolerance, newton, segments, draw: True)


@dataclass
class Sweep:
    """A job: scenes x grid x samples (x guesses in a closed loop). `grid` maps parameter names to lists of values."""
    scenes: tuple = ("bending_rod", "helix")
    grid: dict = field(default_factory=lambda: {"scene.segments": [10, 20, 40]})
    random: dict = field(default_factory=lambda: {"scene.youngs_modulus_pa": ("Pa", lambda draw: 1e4 * 2.0 ** draw)})
    samples: int = 4
    guesses: tuple = GUESSES
    steps: int = 5
    newton: int = 3
    closed_loop: bool = False
    method: str = "cg"
    solves: bool = True
    plant: Plant = field(default_factory=Plant)
    pending: tuple = ()
    failed: dict = field(default_factory=dict)       # task: outcome
    oversubscribed: bool = False
    attributes: dict = field(default_factory=lambda: {"program": "rodsweep", "schema_version": 1})

    def tasks(self):
        """(scene, grid values, draw, own guess, point) of every task in order."""
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
            h5["axes/guess"] = np.array(guesses, dtype="S32")
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
        text = {"solve.method": self.method, "solve.preconditioner": "jacobi", "solve.norm": "true_residual"}
        columns = {"scene.type": ("", [t[0] for t in tasks])}
        columns.update({key: ("", [value] * len(tasks)) for key, value in text.items()})
        columns.update({"solve.tolerance": ("", [1e-2] * len(tasks)), "time.step_s": ("s", [0.02] * len(tasks))})
        columns.update({key: ("", [t[1][key] for t in tasks]) for key in self.grid})
        columns.update({key: (unit, [value(t[2]) for t in tasks]) for key, (unit, value) in self.random.items()})
        columns["scene.length_m"] = ("m", [1.0 + t[2] if t[0] == "bending_rod" else np.nan for t in tasks])
        if self.closed_loop:
            columns["guess"] = ("", [self.guesses[t[3]] for t in tasks])
        for key, (unit, values) in columns.items():
            text = isinstance(values[0], str)
            item = h5.create_dataset(f"tasks/parameters/{key}", data=np.array(values, dtype="S32" if text else None))
            item.attrs.update({"unit": unit, "meaning": f"the {key}", "swept": len(set(values)) > 1})

    def _results(self, tasks, guesses, done, rows_per_task):
        """All datasets of results; rows of pending tasks stay zero, as the file's unwritten bytes do."""
        count, plant = len(tasks), self.plant
        shape = (count, len(guesses), len(TOLERANCES))
        sums = {name: np.zeros(shape, dtype=np.int64) for name in ("iterations_sum", "iterations_sum_all")}
        missed = {name: np.zeros(shape, dtype=np.int32) for name in ("unreached", "unreached_all")}
        rows = count * rows_per_task
        guess_s, cg_s = (np.zeros((rows, len(guesses)), dtype=np.float32) for _ in range(2))
        iterations = np.zeros((rows, len(guesses), len(TOLERANCES)), dtype=np.int16)
        one = {name: np.zeros(rows, dtype=np.float32) for name in ("assemble_s", "direct_s")}
        newton = np.zeros(rows, dtype=np.int16)
        steps = {name: np.zeros(count * self.steps) for name in ("length_drift", "joint_gap", "newton_residual")}
        used, rest = np.zeros(count * self.steps, dtype=np.int16), np.zeros(count * self.steps, dtype=np.float32)
        for t in np.flatnonzero(done):
            _, values, draw, own, _ = tasks[t]
            n = values.get("scene.segments", 10)
            mine = range(len(guesses)) if own < 0 else [own]
            for array in (*sums.values(), *missed.values()):
                array[t] = -1
            for g, (k, tolerance) in itertools.product(mine, enumerate(TOLERANCES)):
                by_newton = [round(plant.zero_iterations(n, tolerance) * plant.ratio(guesses[g], tolerance, j, n, draw))
                             for j in range(self.newton)]
                reached = [plant.reached(guesses[g], tolerance, j, n, draw) for j in range(self.newton)]
                sums["iterations_sum"][t, g, k] = self.steps * by_newton[0]
                sums["iterations_sum_all"][t, g, k] = self.steps * sum(by_newton)
                missed["unreached"][t, g, k] = self.steps * (not reached[0])
                missed["unreached_all"][t, g, k] = self.steps * (self.newton - sum(reached))
            for r in range(t * rows_per_task, (t + 1) * rows_per_task):
                newton[r] = (r - t * rows_per_task) % self.newton
                one["assemble_s"][r], one["direct_s"][r] = plant.assemble_s, plant.direct_s
                guess_s[r] = cg_s[r] = np.nan
                iterations[r] = -1
                for g in mine:
                    iterations[r, g] = 10
                    guess_s[r, g] = plant.guess_s(guesses[g], newton[r], n, draw)
                    cg_s[r, g] = plant.cg_s(guesses[g], newton[r], n, draw)
            span = slice(t * self.steps, (t + 1) * self.steps)
            steps["length_drift"][span] = -plant.drift * np.linspace(0, 1, self.steps)
            steps["joint_gap"][span], steps["newton_residual"][span] = plant.gap, 1e-10
            used[span], rest[span] = self.newton, plant.rest_s
        found = {f"tasks/{name}": array for name, array in {**sums, **missed}.items()}
        found["tasks/steps_done"] = np.where(done, self.steps, 0).astype(np.int32)
        found.update({f"steps/{name}": array for name, array in steps.items()})
        found.update({"steps/newton_iterations": used, "timing/steps/rest_s": rest, "solves/newton": newton,
                      "solves/iterations": iterations,
                      "timing/solves/guess_s": guess_s, "timing/solves/cg_s": cg_s,
                      "timing/tasks/attempt": np.where(done, 0, 0).astype(np.int32)})
        found.update({f"timing/solves/{name}": array for name, array in one.items()})
        return found
