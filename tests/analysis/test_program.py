"""The scripts on files of the program itself (RODSWEEP): derived numbers against the rows that they come from."""

import json
import os
import re
import subprocess
import tempfile
import unittest

from running import run
import h5py
import numpy as np
import rodsweep
from rodsweep.reading import measures, timings, trajectory
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

ROD = {"type": "bending_rod", "segments": {"grid": [6, 9]}, "length_m": {"uniform": [1, 5]}, "radius_m": 0.05,
       "density_kg_m3": 1000, "youngs_modulus_pa": {"log_uniform": [1e4, 1e6]}, "torsion_modulus_pa": 1e6}
HELIX = {"type": "helix", "segments": 12, "helix_radius_m": 0.5, "helix_height_m": {"uniform": [0.4, 0.6]},
         "windings": 2, "radius_m": 0.05, "density_kg_m3": 1000, "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 1e5}
JOB = {"name": "analysis", "kind": "sweep", "seed": 3, "samples": 2, "scene": {"grid": [ROD, HELIX]},
       "time": {"step_s": 0.02, "steps": 4, "newton_iterations": 3}, "solve": {"method": "cg", "tolerance": 1e-2},
       "guesses": ["zero", "previous", "quadratic", {"oracle": {"error": 0.1}}]}
CLOSED, SHORT = {"evaluation": "closed_loop"}, {"record": {"solves": "summary"}}    # changes to it
DATA = {"kind": "dataset", "solve": None, "guesses": None}


def program(*words):
    """The output of the program."""
    return subprocess.run([os.environ["RODSWEEP"], *words], check=True, capture_output=True,
                          stdin=subprocess.DEVNULL).stdout


def everything(file):
    return measures.simulations(file, np.ones(file.task_count, dtype=bool))


class Program(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)

    def run_job(self, name, *options, **changes):
        """Path of the results of JOB with changes; run once. A change to None removes a key."""
        job, results = (os.path.join(self.folder.name, name + ending) for ending in (".json", ".h5"))
        if not os.path.exists(results):
            with open(job, "w", encoding="utf-8") as text:
                values = {**JOB, "name": name, **changes}
                json.dump({key: value for key, value in values.items() if value is not None}, text)
            program("run", job, "-o", results, *options)
        return results

    def script(self, name, *arguments):
        done = run(name, *arguments)
        self.assertEqual(done.code, 0, done.stderr)
        return done.stdout

    def test_tasks_parameters_and_axes_are_understood(self):
        with SweepFile(self.run_job("paired")) as file:
            self.assertEqual(file.task_count, 6)
            self.assertTrue(file.ok.all(), file.outcome)
            self.assertEqual(len(file.guesses), 4)
            self.assertEqual(file.zero, 0)
            self.assertEqual(file.job()["name"], "paired")
            self.assertEqual(file.parameter("scene.youngs_modulus_pa").unit, "Pa")
            self.assertLessEqual({"scene.type", "scene.segments", "scene.length_m"}, set(file.swept()))
            np.testing.assert_array_equal(file.parameter("scene.length_m").applies(),
                                          file.scene_types() == "bending_rod")
            self.assertEqual(len(file.runs()), 1)

    def test_frames_and_datasets_hold_what_the_file_holds_with_its_units(self):
        with rodsweep.open(self.run_job("paired")) as results, h5py.File(results.file.path) as h5:
            tasks = results.tasks(where=["guess=quadratic", "tolerance=1e-3"])
            np.testing.assert_array_equal(tasks.cg_ratio, h5["tasks/cg_ratio"][:, 2, 2])
            self.assertEqual(tasks.attrs["unit"]["scene.youngs_modulus_pa"], "Pa")
            self.assertIn("iterations_sum over that of the zero guess", tasks.attrs["meaning"]["cg_ratio"])
            solves, rows = results.solves(["iterations_1e-2"], "guess=previous"), results.dataset("solves")
            counts = h5["solves/iterations"][:][h5["solves/newton"][:] >= 0].astype(float)
            counts[counts == -1] = np.nan
            np.testing.assert_array_equal(solves["iterations_1e-2"], counts[:, 1, 1])
            np.testing.assert_array_equal(rows.iterations, counts)
            self.assertEqual(rows.cg_s.attrs["units"], "s")
            np.testing.assert_array_equal(results.steps().length_drift, h5["steps/length_drift"][:])
        with self.assertRaisesRegex(rodsweep.UserError, "is a dataset, not the results of a sweep"):
            rodsweep.open(self.run_job("data", **DATA))

    def test_the_page_shows_the_demo_with_the_tasks_that_it_has(self):
        source = os.environ["SOURCE_DIR"]
        with open(os.path.join(source, "docs", "python.md"), encoding="utf-8") as page:
            shown = re.search(r"# \.\.\. (\d+) of (\d+) tasks ok", page.read())
        plan = json.loads(program("plan", os.path.join(source, "jobs", "demo.json"), "--no-probe", "--json"))
        self.assertEqual({int(shown[1]), int(shown[2])}, {plan["tasks"]})

    def test_ratios_are_those_of_the_rows_and_of_the_file(self):
        with SweepFile(self.run_job("paired")) as file:
            sims = everything(file)
            found = {newton: measures.cg_counts(file, sims, newton).ratio for newton in ("first", "all")}
            iterations, newton = file.h5["solves/iterations"][:].astype(float), file.h5["solves/newton"][:]
            for task in range(file.task_count):
                rows = slice(file.first_solve[task], file.first_solve[task] + file.solves[task])
                for which, mask in (("first", newton[rows] == 0), ("all", newton[rows] >= 0)):
                    counted = iterations[rows][mask]
                    reached = (counted >= 0).all(axis=(0, 1)) & (counted[:, 0].sum(axis=0) > 0)
                    expected = counted.sum(axis=0)[:, reached] / counted[:, 0].sum(axis=0)[reached]
                    self.assertTrue(reached[:4].all())
                    np.testing.assert_allclose(found[which][task][:, reached], expected)
            stored = file.h5["tasks/cg_ratio"][:]
            both = np.isfinite(found["first"]) & np.isfinite(stored)
            self.assertTrue(both[..., :4].all())
            np.testing.assert_allclose(found["first"][both], stored[both])

    def test_a_closed_loop_pairs_every_guess_with_zero(self):
        path = self.run_job("closed", **CLOSED)
        with SweepFile(path) as file:
            self.assertEqual(file.task_count, 24)
            sims = everything(file)
            self.assertTrue(sims.closed_loop)
            self.assertEqual(sims.task.shape, (6, 4))
            ratio = measures.cg_counts(file, sims, "first").ratio
            self.assertTrue(np.isfinite(ratio[..., :4]).all())
            np.testing.assert_array_equal(ratio[:, 0, :4], 1)

    def test_a_guess_that_varies_is_told_apart_by_its_parameters(self):
        varying = {"grid": ["previous", {"oracle": {"error": 0.5}}, {"oracle": {"error": 0.001}}]}
        path = self.run_job("varying", scene=ROD, guesses=["zero", varying, {"oracle": {"error": 0.5}}],
                            record={"solves": "summary"})
        with SweepFile(path) as file:
            self.assertEqual(file.guesses, ["zero", "previous | oracle 0.5 | oracle 0.001", "oracle 0.5"])
            self.assertEqual(file.parameter("guesses[1]").values.tolist()[::2], 2 * ["previous", "oracle", "oracle"])
            ratios = file.results("cg_ratio", np.arange(file.task_count))[:, :, 1].reshape(2, 3, 2, 3)
            np.testing.assert_array_equal(ratios[:, 1, :, 1], ratios[:, 1, :, 2])  # the same guess in both columns
            self.assertTrue((ratios[:, 2, :, 1] < ratios[:, 1, :, 1]).all())
        said = self.script("summary.py", path)
        for words in ("Bending rod, guesses[1] = previous, 4 simulations",
                      "Bending rod, guesses[1] = oracle, guesses[1].oracle.error = 0.5, 4 simulations",
                      "Bending rod, guesses[1] = oracle, guesses[1].oracle.error = 0.001, 4 simulations"):
            self.assertIn(words, said)
        by_error = self.script("summary.py", path, "--by", "guesses[1].oracle.error", "--select", "guesses[1]=oracle")
        self.assertIn("guesses[1].oracle.error = 0.001", by_error)
        self.assertNotIn("previous, 4", by_error)

    def test_text_settings_are_swept_and_told_apart(self):
        solve = {"preconditioner": {"grid": ["none", "icc"]}, "norm": {"zip": ["natural", "true_residual"]}}
        path = self.run_job("texts", scene={**ROD, "clamp": {"zip": ["wall", "segment"]}}, solve=solve)
        with SweepFile(path) as file:
            self.assertTrue(file.ok.all())
            self.assertEqual(set(file.swept()) - set(ROD), {"scene.segments", "scene.length_m", "scene.clamp",
                             "scene.youngs_modulus_pa", "solve.preconditioner", "solve.norm"})
            sums = file.results("iterations_sum", np.arange(file.task_count))[:, 0, 1]
            icc = file.parameter("solve.preconditioner").values == "icc"
            self.assertLess(sums[icc].max(), sums[~icc].min())
        said = self.script("summary.py", path)
        self.assertIn("solve.norm = natural, solve.preconditioner = icc", said)

    def test_a_summary_has_the_ratios_of_the_full_record(self):
        with SweepFile(self.run_job("paired")) as full, \
                SweepFile(self.run_job("short", **SHORT)) as short:
            ratios = [measures.cg_counts(file, everything(file), "first").ratio for file in (full, short)]
            np.testing.assert_array_equal(*ratios)
            self.assertFalse(timings.timed(short))

    def test_a_trajectory_is_where_its_rod_is_and_can_be_drawn(self):
        path = self.run_job("frames", scene=ROD, record={"trajectory_every": 2})
        with SweepFile(path) as file:
            for task in (0, 2):
                shown = trajectory.of_task(file, task)
                segments = int(file.h5["tasks/segments"][task])
                length = file.parameter("scene.length_m").values[task]
                self.assertEqual((shown.frames(), len(shown.length)), (3, segments))
                self.assertTrue(shown.static[0] and not shown.static[1:].any())
                self.assertAlmostEqual(shown.length.sum(), length)
                low, high = shown.ends(0)
                np.testing.assert_allclose(low[1:], high[:-1], atol=1e-12)
                self.assertAlmostEqual(np.linalg.norm(high[-1] - low[0]), length)
                np.testing.assert_array_equal(trajectory.joints(shown), [[k, k + 1] for k in range(segments - 1)])
        picture = os.path.join(self.folder.name, "rod.png")
        self.assertEqual(self.script("render.py", path, "--task", "2", "--size", "60x40", "-o", picture).strip(), picture)
        self.assertTrue(os.path.exists(self.script("paraview.py", path, "--task", "2").strip()))

    def test_forces_of_joints_are_read_frame_by_frame(self):
        path = self.run_job("forces", scene=ROD, record={"trajectory_every": 2, "forces": True})
        with rodsweep.open(path) as results:
            for task in (0, 2):
                shown = results.trajectory(task)
                segments, first = len(shown.length), results.file.h5["tasks/first_frame_joint"][task]
                np.testing.assert_array_equal(shown.joint_segments(), [[k, k + 1] for k in range(segments - 1)])
                self.assertTrue(np.isnan(shown.joint_forces(0)).all() and np.isnan(shown.tensions(0)).all())
                for frame in (1, -1):
                    np.testing.assert_allclose(shown.joint_positions(frame), shown.ends(frame)[1][:-1], atol=1e-3)
                    row = first + (frame % 3) * (segments - 1)
                    force = results.file.h5["trajectories/joint_force_n"][row:row + segments - 1]
                    np.testing.assert_array_equal(shown.joint_forces(frame), force)
                    self.assertTrue((np.abs(shown.tensions(frame)) <= np.linalg.norm(force, axis=1)).all())
                    self.assertGreater(np.abs(shown.joint_moments(frame)[0]).max(), 0)
                    inside, tension = shown.internal_forces(frame), shown.tensions(frame)
                    np.testing.assert_allclose(inside["tension"][1:-1], (tension[:-1] + tension[1:]) / 2,
                                               atol=5e-2 * np.abs(tension).max())    # axes differ
                    self.assertTrue(all(np.isfinite(values).all() for values in inside.values()))
            reaction = results.steps(columns=["clamp_force_n_y"])
            self.assertEqual(reaction.attrs["unit"]["clamp_force_n_y"], "N")
            self.assertTrue((reaction.clamp_force_n_y.abs() > 0).all())
        with rodsweep.open(self.run_job("frames", scene=ROD, record={"trajectory_every": 2})) as results, \
                self.assertRaisesRegex(KeyNotFound, "record.forces"):
            results.trajectory(0).tensions(-1)

    def test_scripts_read_every_kind_of_file(self):
        plane = ("--x", "scene.segments", "--y", "scene.length_m", "--scene", "bending_rod", "--measure")
        kinds = {    # changes to JOB, and scripts with words or the number of lines that they print
            "paired": ({}, [("spatial.py", 6), ("summary.py", "6 of 6 tasks ok"), ("temporal.py", "--scene", "helix", 4),
                            *(("heatmap.py", *plane, measure, 2)
                              for measure in ("ratio", "matvec-ratio", "speedup-step", "joint-gap"))]),
            "closed": (CLOSED, [("spatial.py", 6), ("summary.py", "closed-loop evaluation")]),
            "direct": ({"solve": {"method": "direct"}, "guesses": []}, [("summary.py", "Newton its/step")]),
            "short": (SHORT, [("spatial.py", 2), ("summary.py", "No times")]),
            "data": (DATA, [("summary.py", "advanced by the direct solve, no guesses"), ("export.py", 1 + 6),
                            ("export.py", "--level", "steps", 1 + 24)]),
            "long": ({**CLOSED, "scene": HELIX, "guesses": ["zero", "previous"],
                      "solve": {"method": {"grid": ["cg", "direct"]}, "tolerance": 1e-2}},
                     [("long_term.py", f"\n  {method}") for method in ("zero", "previous", "direct")]),
            "by_cg": ({"solve": {"method": "cg", "reference": "cg", "tolerance": 1e-2}},
                      [("summary.py", "guess + CG"), ("spatial.py", 6), ("temporal.py", 4), ("export.py", "sample")])}
        for name, (changes, scripts) in kinds.items():
            path = self.run_job(name, **changes)
            for script, *arguments, expected in scripts:
                with self.subTest(kind=name, script=script, arguments=arguments):
                    said = self.script(script, path, *arguments)
                    if isinstance(expected, int):
                        self.assertEqual(len(said.splitlines()), expected)
                    else:
                        self.assertIn(expected, said)
        with h5py.File(self.run_job("by_cg")) as h5:
            self.assertTrue(np.isnan(h5["timing/solves/direct_s"][:]).all() and (h5["tasks/cg_ratio"][:, 0] == 1).all())
        self.assertNotIn("nan", self.script("summary.py", self.run_job("by_cg")))
        self.assertNotIn("first_system", self.script("export.py", self.run_job("data"), "--list"))
