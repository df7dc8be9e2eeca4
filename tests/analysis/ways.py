"""Planted rods moved by several methods, each with a known distance from the converged trajectory and a known time. For
tests of solvers.py and work_precision.py."""

import h5py
import numpy as np

import running
from rodsweep.reading.accuracy import Way

GUESSES = ("zero", "previous")
PLANTED = {   # way: distance from the reference in rod lengths, time of a step; the first is the reference
    Way("direct", 20): (0, 9e-5),
    Way("direct", 2): (1e-5, 2e-5),
    Way("xpbd", iterations=50): (1e-3, 1e-5),
    Way("pbd", iterations=5): (0.2, 4e-6),
    Way("cg", 2, 0, 1e-2, "jacobi", "zero"): (5e-5, 6e-5),
    Way("cg", 2, 0, 1e-2, "icc", "zero"): (5e-5, 5e-5),
    Way("cg", 2, 0, 1e-2, "icc", "previous"): (5e-5, 4e-5),
    Way("cg", 1, 0, 1e-1, "icc", "previous"): (5e-3, 3e-5),
}
WAYS = list(PLANTED)
OFF, STEP_S = (np.array(column) for column in zip(*PLANTED.values()))
STEPS, FRAMES, SEGMENTS, SAMPLES = 4, 3, 5, 2
ASSEMBLE_S, DIRECT_S, GUESS_S, CG_S = 5e-6, 1e-5, 2e-6, 8e-6


class Planted(running.Scripts):
    def write(self, **settings):
        """Two rods of every scene for every method, with one row of /solves per step and with trajectories."""
        super().write(**{"method": "direct", "scenes": ("bending_rod",), "samples": SAMPLES, "steps": STEPS,
                         "grid": {"time.newton_iterations": tuple(way.newton or 6 for way in WAYS)}, **settings})
        with h5py.File(self.path, "a") as h5:
            count = len(h5["tasks/state"])
            way = np.arange(count) // SAMPLES % len(WAYS)
            for name, values in _columns(count, way).items():
                name = name.replace("parameters/solve/", "parameters/solve.")
                attributes = dict(h5[name].attrs) if name in h5 else {}
                if name in h5:
                    del h5[name]
                h5[name] = values
                h5[name].attrs.update(attributes)


def _columns(count, way):
    def of(value):
        return np.array([value(w) for w in WAYS])[way]

    linear = np.repeat(of(lambda w: w.newton > 0), STEPS)
    cg = np.repeat(of(lambda w: w.guess != ""), STEPS)
    own = of(lambda w: GUESSES.index(w.guess) if w.guess else -1)
    mine = np.repeat(own, STEPS)[:, None] == np.arange(len(GUESSES))
    times = np.repeat(STEP_S[way], STEPS)
    times[::STEPS] += 1     # an interruption by the machine
    position = np.zeros((count, FRAMES, SEGMENTS, 3))
    position[..., 2] = np.linspace(0, 1, SEGMENTS)
    position[:, 1, :, 0] += OFF[way, None]
    return {"axes/guess": np.array(GUESSES, dtype="S8"), "axes/tolerance": np.array([1e-1, 1e-2]),
            "tasks/own_guess": own,
            "tasks/first_solve": np.arange(count) * STEPS, "tasks/solves": np.full(count, STEPS),
            "tasks/parameters/solve/method": of(lambda w: w.method).astype("S8"),
            "tasks/parameters/solve/iterations": of(lambda w: w.iterations or -1),
            "tasks/parameters/solve/tolerance": of(lambda w: w.tolerance or 1e-2),
            "tasks/parameters/solve/preconditioner": of(lambda w: w.preconditioner or "jacobi").astype("S32"),
            "timing/steps/rest_s": times - np.where(linear, ASSEMBLE_S + DIRECT_S, 0),
            "timing/solves/assemble_s": np.where(linear, ASSEMBLE_S, np.nan),
            "timing/solves/direct_s": np.where(linear, np.where(cg, 1, DIRECT_S), np.nan),    # not a cost of CG
            "timing/solves/guess_s": np.where(mine, GUESS_S, np.nan),
            "timing/solves/cg_s": np.where(mine, CG_S, np.nan),
            "trajectories/position_m": position.reshape(-1, 3),
            "trajectories/first_row": np.arange(count * FRAMES).reshape(count, FRAMES) * SEGMENTS}
