"""Every script of analysis/ over every shape of results: a figure, a table, or one sentence that says why there is none.

A shape is a small planted file: without solves, without guesses, with failures only, and so on. No script may blame
the file, print a value that is not a number, or show a warning. By default, scripts that draw nothing run over all
shapes, and the others over the shapes in WORST; in Long, the others run over all shapes in turn.
"""

import contextlib
import os
import re
import unittest
import unittest.mock
import warnings

import h5py
import numpy as np

import running
import synthetic
import trajectories
import rodsweep.drawing.layout    # noqa: F401: running.run() replaces its Page.save()

FORBIDDEN = re.compile(r"damaged|Traceback|Warning|\b[+-]?(nan|inf)\b", re.IGNORECASE)
SMALL = {"samples": 2, "steps": 2, "newton": 2, "guesses": ("zero", "previous", "quadratic"),
         "grid": {"scene.segments": [6, 12]}}
SMALLEST = {**SMALL, "scenes": ("helix",), "samples": 1, "grid": {"scene.segments": [6]}}
LABELS = ("zero", r"copingnet $\frac{a}", r"größe_{1} → 50 % & $x^2$", "oracle(0.1) \\alpha # ~")
CHEAP = {"summary": (), "summary --json": ("--json",), "query": (), "export solves": ("--level", "solves"),
         "export steps": ("--level", "steps"), "loss": ()}
DRAWING = {"summary --csv": ("--csv",), "export": (), "ablation": ("models",), "balance": (),
           "combinations": ("--x", "scene.segments"), "combinations by default": (),
           "compare": ("sweep.h5",), "compare with plain": ("plain.h5", "--by", "parameters"), "front": (),
           "heatmap": ("--x", "scene.segments", "--y", "tolerance"),
           "heatmap step": ("--x", "scene.segments", "--y", "scene.type", "--measure", "speedup-step"),
           "heatmap residual": ("--x", "scene.segments", "--y", "scene.type", "--measure", "newton-residual"),
           "integrators": (), "long_term": (), "long_term --csv": ("--csv",), "paraview": ("--force",),
           "render": ("--force",), "report": ("--force",), "side_by_side": (), "spatial": (), "temporal": ()}
SCRIPTS = {**CHEAP, **DRAWING}


class Slow(synthetic.Plant):
    """No times, or times of zero as of a coarse clock."""

    def __init__(self, seconds):
        self.seconds = self.assemble_s = self.direct_s = self.rest_s = seconds

    def cg_s(self, *_):
        return self.seconds

    guess_s = cg_s


class Labelled(synthetic.Plant):
    quality = dict.fromkeys(LABELS, 0.5)


class Missed(synthetic.Plant):
    reached = staticmethod(lambda *_: False)


class NotNumbers(synthetic.Plant):
    """A run whose values are not numbers."""

    gap = drift = residual = np.nan

    def kinetic_energy_j(self, step, *_):
        return np.full(len(step), np.nan)


class AtRest(synthetic.Plant):
    """Rods without motion: no energy, no error."""

    gap = drift = residual = 0.0

    def kinetic_energy_j(self, step, *_):
        return np.zeros(len(step))


def recorded(path):
    """Adds the columns and frames that the program writes and synthetic.py does not."""
    trajectories.plant(path, segments=6, frames=3)
    with h5py.File(path, "r+") as h5:
        count = len(h5["tasks/state"])
        h5["tasks/joints"], h5["tasks/frames"] = np.full(count, 5), np.full(count, 3)
        h5["tasks/first_frame_row"] = 18 * np.arange(count)
        h5["steps/momentum_residual"] = h5["steps/newton_residual"][:]
        h5["timing/tasks/elapsed_s"] = np.full(count, 0.5)
        h5["tasks/parameters/time.balance"] = np.zeros(count, dtype=np.int64)
        for which in ("", "_all"):
            sums = h5[f"tasks/iterations_sum{which}"][:].astype(float)
            h5[f"tasks/matvecs_sum{which}"] = h5[f"tasks/iterations_sum{which}"][:]
            if sums.size:
                ratio = np.full(sums.shape, np.nan)
                np.divide(sums, sums[:, :1], out=ratio, where=sums[:, :1] > 0)
                h5[f"tasks/cg_ratio{which}"] = ratio


def written(**settings):
    """A shape: a function that writes a file of these settings."""
    def write(path):
        synthetic.Sweep(**{**SMALL, **settings}).write(path)
        recorded(path)
    return write


def changed(change, **settings):
    """A shape that is changed(its h5py.File) after it is written."""
    def write(path):
        written(**settings)(path)
        with h5py.File(path, "r+") as h5:
            change(h5)
    return write


def unsolved(h5, scenes=("helix",)):
    """No linear system had to be solved in these scenes: no Newton iterations, only rows that were not reached."""
    unsolve(h5, np.flatnonzero(np.isin(h5["tasks/parameters/scene.type"].asstr()[:], scenes)))


def unsolve(h5, tasks):
    blank(h5, tasks, "solves")
    blank(h5, tasks, "tasks", 0, "iterations_sum", "unreached", "matvecs_sum")
    blank(h5, tasks, "tasks", np.nan, "cg_ratio")
    rows = rows_of(h5, tasks, "step")
    values = h5["steps/newton_iterations"][:]
    values[rows] = 0
    h5["steps/newton_iterations"][...] = values


def timed_out(h5, tasks=slice(None)):
    """These tasks were cancelled before their first step."""
    tasks = np.arange(len(h5["tasks/state"]))[tasks]
    unsolve(h5, tasks)
    blank(h5, tasks, "steps")
    for name, value in (("outcome", b"timed_out"), ("message", b"step 0: the time limit of 1 s has passed"),
                        ("steps_done", 0)):
        values = h5[f"tasks/{name}"][:]
        values[tasks] = value
        h5[f"tasks/{name}"][...] = values
    first = h5["trajectories/first_row"][:]
    first[tasks] = -1
    h5["trajectories/first_row"][...] = first


def rows_of(h5, tasks, kind):
    first, count = h5[f"tasks/first_{kind}"][:], h5[f"tasks/{kind}s"][:]
    ranges = [np.arange(first[task], first[task] + count[task]) for task in tasks]
    return np.concatenate([np.empty(0, dtype=int), *ranges])


def blank(h5, tasks, level, value=None, *starts):
    """Writes missing values, or `value`, in the rows of these tasks and in their times."""
    rows = tasks if level == "tasks" else rows_of(h5, tasks, level.removesuffix("s"))
    for group in (level, f"timing/{level}") if level != "tasks" else (level,):
        for name, item in h5.get(group, {}).items():
            if isinstance(item, h5py.Dataset) and (not starts or name.startswith(starts)) and len(item):
                values = item[:]
                values[rows] = value if value is not None else np.nan if values.dtype.kind == "f" else -1
                item[...] = values


def methods(*names, **columns):
    """The tasks take these methods in turn; each column has a value for every method."""
    def change(h5):
        turn = h5["tasks/point"][:] % len(names)
        for key, values in {"solve.method": [name.encode() for name in names], **columns}.items():
            path = f"tasks/parameters/{key}"
            if path in h5:
                del h5[path]
            item = h5.create_dataset(path, data=np.array(values)[turn])
            item.attrs.update({"unit": "", "meaning": key, "swept": len(set(values)) > 1})
        if "axes/guess" in h5:
            own = np.where(np.array(names)[turn] == "cg", h5["tasks/own_guess"][:], -1)
            h5["tasks/own_guess"][...] = own
    return change


def without(*paths):
    def change(h5):
        for path in paths:
            if path in h5:
                del h5[path]
    return change


def other_tolerances(h5):
    h5["axes/tolerance"][...] = 3.0 * h5["axes/tolerance"][:]


def one_frame(h5):
    first = h5["trajectories/first_row"][:]
    first[:, 1:] = -1
    h5["trajectories/first_row"][...] = first


def not_numbers(h5):
    h5["trajectories/position_m"][...] = np.nan


def balanced(h5):
    h5["tasks/parameters/time.balance"][...] = np.arange(len(h5["tasks/state"])) % 2


SHAPES = {
    "plain": written(),
    "a grid with many panels": written(grid={"solve.preconditioner": [f"method {k}" for k in range(7)]}),
    "no rows of solves": written(solves=False),
    "direct": written(method="direct"),
    "direct and xpbd": changed(methods("direct", "xpbd"), method="direct", samples=1),
    "xpbd alone": changed(methods("xpbd"), method="direct"),
    "direct, xpbd and pbd with iterations": changed(
        methods("direct", "xpbd", "pbd", **{"solve.iterations": [-1, 5, 7]}), method="direct"),
    "closed loop of cg, direct, xpbd": changed(methods("cg", "direct", "xpbd"), closed_loop=True, samples=1),
    "closed loop": written(closed_loop=True),
    "one task": written(**SMALLEST),
    "one task of zero": written(**{**SMALLEST, "guesses": ("zero",)}),
    "all failed": written(failed=dict.fromkeys(range(8), "diverged")),
    "closed loop, all failed": written(closed_loop=True, failed=dict.fromkeys(range(24), "torn")),
    "all timed out": changed(timed_out),
    "all timed out in a closed loop": changed(timed_out, closed_loop=True),
    "direct, all timed out": changed(timed_out, method="direct"),
    "some timed out": changed(lambda h5: timed_out(h5, slice(0, None, 2)), closed_loop=True),
    "all pending": written(pending=range(8)),
    "some pending": written(pending=range(3)),
    "no solves": changed(lambda h5: unsolved(h5, ("helix", "bending_rod"))),
    "no solves in one scene": changed(unsolved),
    "no solves in a closed loop": changed(unsolved, closed_loop=True, scenes=("helix",)),
    "direct, no solves": changed(unsolved, method="direct", scenes=("helix",)),
    "labels": written(guesses=LABELS, plant=Labelled()),
    "labels in a closed loop": written(guesses=LABELS, plant=Labelled(), closed_loop=True),
    "one step": written(steps=1),
    "one step and iteration": written(steps=1, newton=1),
    "one number of segments": written(grid={"scene.segments": [6]}),
    "no grid": written(grid={}),
    "times that are not numbers": written(plant=Slow(np.nan)),
    "times of zero": written(plant=Slow(0.0)),
    "no tolerance reached": written(plant=Missed(), counts_in_rows=True),
    "values that are not numbers": written(plant=NotNumbers()),
    "values that are not numbers in a closed loop": written(plant=NotNumbers(), closed_loop=True),
    "no zero guess": written(guesses=("previous", "quadratic")),
    "other tolerances": changed(other_tolerances),
    "no frames": changed(without("trajectories")),
    "one frame": changed(one_frame),
    "two kinds of steps": changed(balanced),
    "two kinds of steps of direct": changed(balanced, method="direct"),
    "positions that are not numbers": changed(not_numbers),
    "grid of time steps": written(grid={"time.step_s": [0.01, 0.02]}, method="direct"),
    "direct with several Newton iterations": written(grid={"time.newton_iterations": [1, 2]}, method="direct"),
    "rods at rest": written(grid={"time.step_s": [0.01, 0.02]}, method="direct", plant=AtRest()),
    "few parameters": changed(without(*(f"tasks/parameters/{key}" for key in (
        "solve.method", "solve.tolerance", "solve.preconditioner", "time.newton_iterations", "time.step_s",
        "scene.segments", "solve.norm")))),
}
# Shapes that once made these scripts fail.
WORST = {"direct and xpbd": ("long_term", "report", "side_by_side"),
         "all timed out in a closed loop": ("long_term", "side_by_side"),
         "no solves": ("balance", "combinations", "front", "heatmap", "spatial", "temporal"),
         "no solves in one scene": ("spatial", "front"), "labels": ("spatial",), "times of zero": ("report", "front"),
         "times that are not numbers": ("spatial", "combinations"), "one step": ("balance",),
         "values that are not numbers": ("long_term",), "plain": ("combinations by default", "compare"),
         "other tolerances": ("heatmap",), "grid of time steps": ("integrators",)}
SENTENCES = {   # (shape, script): what it says
    ("no solves", "spatial"): "sweep.h5 has no CG ratios: no solve of the chosen simulations took an iteration (first "
                              "Newton iteration (j = 0))",
    ("all timed out", "long_term"): "sweep.h5 has no recorded step in the chosen simulations: 0 of 8 tasks ok, failed: "
                                    "8 timed_out",
    ("times that are not numbers", "front"): "sweep.h5 has no times above 0, so the cost of guesses is not known",
    ("xpbd alone", "temporal"): "sweep.h5 has no guesses to compare in the chosen simulations",
    ("no rows of solves", "front"): "sweep.h5 has no times, so the cost of guesses is not known",
    ("no rows of solves", "temporal"): "sweep.h5 has no rows of single solves (record.solves is \"summary\"), which this "
                                       "script needs",
    ("no zero guess", "combinations"): "sweep.h5 has no preconditioner or no zero guess to compare with",
    ("plain", "balance"): "sweep.h5 has only one kind of step in the chosen simulations: sweep time.balance or "
                          "time.integrator"}
EVERY = 4    # a script that draws runs over every fourth shape


class Shapes(running.Scripts):
    def setUp(self):
        super().setUp()
        os.mkdir("models")
        SHAPES["plain"]("plain.h5")

    def check(self, shape, names):
        SHAPES[shape](self.path)
        for name in names:
            with self.subTest(shape=shape, script=name):
                self.assert_plain(name.split()[0] + ".py", *SCRIPTS[name])

    def assert_plain(self, script, *arguments):
        with contextlib.ExitStack() as around:
            around.enter_context(warnings.catch_warnings())
            warnings.simplefilter("always")
            if script == "render.py":
                around.enter_context(unittest.mock.patch("rodsweep.drawing.povray.picture", lambda *_: b""))
                around.enter_context(unittest.mock.patch("render.require_program"))
            done = running.run(script, "sweep.h5", *arguments)
            rodsweep.drawing.layout.plt.close("all")    # of a script that stopped before it saved them
        said = done.stdout + done.stderr
        self.assertIn(done.code, (0, 2) if script != "compare.py" else (0, 2, 8), said)
        said_of_data = said.replace("values that are not numbers", "").replace("\nWARNING: ", "")    # of summary.py
        found = FORBIDDEN.search(said_of_data)
        self.assertIsNone(found, said[max(0, found.start() - 500):found.end() + 500] if found else "")
        if done.code == 2:
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertTrue(done.stderr.startswith(f"{script}: "), done.stderr)


class Short(Shapes):
    def test_scripts_without_figures_over_every_shape(self):
        for shape in SHAPES:
            self.check(shape, CHEAP)

    def test_figures_of_the_worst_shapes(self):
        for shape, names in WORST.items():
            self.check(shape, names)

    def test_the_sentence_says_what_is_missing(self):
        for (shape, name), sentence in SENTENCES.items():
            with self.subTest(shape=shape, script=name):
                SHAPES[shape](self.path)
                self.assertEqual(running.run(f"{name}.py", "sweep.h5").stderr, f"{name}.py: {sentence}\n")

    def test_xpbd_without_its_key_has_the_default_iterations(self):
        SHAPES["direct and xpbd"](self.path)
        self.assertIn("\n  xpbd 20 ", running.run("long_term.py", "sweep.h5").stdout)

    def test_a_scene_without_solves_is_left_out_of_ratios_with_a_note(self):
        SHAPES["no solves in one scene"](self.path)
        printed = running.run("front.py", "sweep.h5").stdout
        self.assertIn("Bending rod", printed)
        self.assertNotIn("Helix", printed)


class Long(Shapes):
    def test_figures_of_every_shape(self):
        for number, shape in enumerate(SHAPES):
            self.check(shape, [name for turn, name in enumerate(DRAWING) if (number + turn) % EVERY == 0])
