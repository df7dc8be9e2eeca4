"""The scripts on files of the program itself (RODSWEEP): derived numbers against the rows that they come from."""

import json
import os
import re
import subprocess
import tempfile
import unittest
import unittest.mock

import synthetic  # noqa: F401  (makes analysis/ importable)
import h5py
import numpy as np
import rodsweep
import temporal
from rodsweep.reading import along_time, joints, measures, timings, trajectory
from rodsweep.reading.sweepfile import SweepFile
from running import run

ROD = {"type": "bending_rod", "segments": {"grid": [6, 9]}, "length_m": {"uniform": [1, 5]}, "radius_m": 0.05,
       "density_kg_m3": 1000, "youngs_modulus_pa": {"log_uniform": [1e4, 1e6]}, "torsion_modulus_pa": 1e6}
HELIX = {"type": "helix", "segments": 12, "helix_radius_m": 0.5, "helix_height_m": {"uniform": [0.4, 0.6]},
         "windings": 2, "radius_m": 0.05, "density_kg_m3": 1000, "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 1e5}
JOB = {"name": "analysis", "kind": "sweep", "seed": 3, "samples": 2, "scene": {"grid": [ROD, HELIX]},
       "time": {"step_s": 0.02, "steps": 4, "newton_iterations": 3}, "solve": {"method": "cg", "tolerance": 1e-2},
       "guesses": ["zero", "previous", "quadratic", {"oracle": {"error": 0.1}}]}


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
            rodsweep.open(self.run_job("data", kind="dataset", solve=None, guesses=None))

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

    def test_times_are_sums_of_the_rows(self):
        with SweepFile(self.run_job("paired")) as file, unittest.mock.patch.object(timings, "INTERRUPTED", np.inf):
            sims = everything(file)
            times = timings.times(file, sims)["all"]
            rows = slice(file.first_solve[2], file.first_solve[2] + file.solves[2])
            for name in ("cg_s", "guess_s"):
                expected = np.nansum(file.h5[f"timing/solves/{name}"][rows].astype(float), axis=0)
                np.testing.assert_allclose(getattr(times, name)[2], expected, rtol=1e-6)
            self.assertTrue(np.isfinite(times.direct_s).all() and np.isfinite(times.rest_s).all())
            for values in timings.speedups({"first": times, "all": times}, "first").values():
                self.assertTrue((values > 0).all())
                np.testing.assert_allclose(values[:, 0], 1, rtol=1e-6)

    def test_a_paired_sweep_has_its_figures_and_table(self):
        path = self.run_job("paired")
        self.assertEqual(len(self.script("spatial.py", path).split()), 6)
        said = self.script("summary.py", path)
        for words in ("6 of 6 tasks ok", "Bending rod, n = 4", "Helix, n = 2", "oracle", "jacobi", "1e-2", "joint gap"):
            self.assertIn(words, said)

    def test_a_closed_loop_pairs_every_guess_with_zero(self):
        path = self.run_job("closed", evaluation="closed_loop")
        with SweepFile(path) as file:
            self.assertEqual(file.task_count, 24)
            sims = everything(file)
            self.assertTrue(sims.closed_loop)
            self.assertEqual(sims.task.shape, (6, 4))
            ratio = measures.cg_counts(file, sims, "first").ratio
            self.assertTrue(np.isfinite(ratio[..., :4]).all())
            np.testing.assert_array_equal(ratio[:, 0, :4], 1)
        self.assertEqual(len(self.script("spatial.py", path).split()), 6)
        self.assertIn("closed-loop evaluation", self.script("summary.py", path))

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
        for words in ("Bending rod, guesses[1] = previous, n = 4",
                      "Bending rod, guesses[1] = oracle, guesses[1].oracle.error = 0.5, n = 4",
                      "Bending rod, guesses[1] = oracle, guesses[1].oracle.error = 0.001, n = 4"):
            self.assertIn(words, said)
        self.assertEqual(len(self.script("spatial.py", path).split()), 2)
        by_error = self.script("summary.py", path, "--by", "guesses[1].oracle.error", "--select", "guesses[1]=oracle")
        self.assertIn("guesses[1].oracle.error = 0.001", by_error)
        self.assertNotIn("previous, n", by_error)

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

    def test_a_direct_only_job_has_times_and_steps(self):
        path = self.run_job("direct", solve={"method": "direct"}, guesses=[])
        with SweepFile(path) as file:
            self.assertEqual((file.guesses, file.zero), ([], None))
        self.assertIn("Newton its/step", self.script("summary.py", path))

    def test_a_summary_has_the_ratios_of_the_full_record(self):
        with SweepFile(self.run_job("paired")) as full, \
                SweepFile(self.run_job("short", record={"solves": "summary"})) as short:
            ratios = [measures.cg_counts(file, everything(file), "first").ratio for file in (full, short)]
            np.testing.assert_array_equal(*ratios)
            self.assertFalse(timings.timed(short))
        self.assertEqual(len(self.script("spatial.py", short.path).split()), 2)
        self.assertIn("No times", self.script("summary.py", short.path))

    def test_the_curve_along_the_time_is_that_of_the_rows(self):
        path = self.run_job("paired")
        with SweepFile(path) as file:
            tasks = np.flatnonzero(file.scene_types() == "helix")
            sims = measures.simulations(file, np.isin(np.arange(file.task_count), tasks))
            found = along_time.windows(file, sims, "first", [0, 1], [1], width=1)
            curve = temporal.estimate(sims, found, 0, relative=True).value[:, 1, 0]
            rows = np.concatenate([np.arange(file.first_solve[t], file.first_solve[t] + file.solves[t]) for t in tasks])
            first = rows[file.h5["solves/newton"][:][rows] == 0]
            counts, step = file.h5["solves/iterations"][:][first][..., 1], file.h5["solves/step"][:][first]
            self.assertTrue((counts >= 0).all())
            for k in range(4):
                sums = counts[step == k].sum(axis=0)
                self.assertAlmostEqual(curve[k], sums[1] / sums[0])
        self.assertEqual(len(self.script("temporal.py", path, "--scene", "helix").split()), 4)

    def test_heat_maps_of_counts_times_and_steps(self):
        path = self.run_job("paired")
        for measure in ("ratio", "matvec-ratio", "speedup-step", "joint-gap"):
            x = ("--x", "scene.segments", "--y", "scene.length_m", "--measure", measure, "--scene", "bending_rod")
            self.assertEqual(len(self.script("heatmap.py", path, *x).split()), 2)

    def test_a_long_run_of_cg_and_direct_side_by_side(self):
        path = self.run_job("long", evaluation="closed_loop", scene=HELIX, guesses=["zero", "previous"],
                            solve={"method": {"grid": ["cg", "direct"]}, "tolerance": 1e-2})
        said = self.script("long_term.py", path)
        for method in ("zero", "previous", "direct"):
            self.assertIn(f"\n  {method}", said)

    def test_without_a_direct_solve_everything_else_is_there(self):
        path = self.run_job("by_cg", solve={"method": "cg", "reference": "cg", "tolerance": 1e-2})
        with SweepFile(path) as file:
            self.assertTrue(np.isnan(file.h5["timing/solves/direct_s"][:]).all())
            self.assertTrue((file.h5["tasks/cg_ratio"][:, 0] == 1).all())
        said = self.script("summary.py", path)
        self.assertIn("CG ratio", said)
        self.assertIn("guess + CG", said)
        self.assertNotIn("nan", said)
        for script in ("spatial.py", "temporal.py", "export.py"):
            self.script(script, path)

    def test_an_export_has_the_sums_of_the_file(self):
        path = self.run_job("paired")
        rows = [line.split(",") for line in self.script("export.py", path, "--columns", "task,iterations_sum").split()]
        with SweepFile(path) as file:
            self.assertEqual(sum(int(row[1]) for row in rows[1:]), file.h5["tasks/iterations_sum"][:].sum())
        solves = self.script("export.py", path, "--level", "solves", "--columns", "newton", "--guess", "zero").split()
        with SweepFile(path) as file:
            self.assertEqual(len(solves) - 1, (file.h5["solves/newton"][:] >= 0).sum())

    def test_a_data_set_has_its_table_and_exports(self):
        path = self.run_job("data", kind="dataset", solve=None, guesses=None)
        self.assertIn("advanced by the direct solve, no guesses", self.script("summary.py", path))
        self.assertEqual(len(self.script("export.py", path).split("\n")), 1 + 6 + 1)
        self.assertEqual(len(self.script("export.py", path, "--level", "steps").split("\n")), 1 + 24 + 1)
        self.assertNotIn("first_system", self.script("export.py", path, "--list"))

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
                np.testing.assert_array_equal(joints.pairs(shown), [[k, k + 1] for k in range(segments - 1)])
        picture = os.path.join(self.folder.name, "rod.png")
        self.assertEqual(self.script("render.py", path, "--task", "2", "--size", "60x40", "-o", picture).strip(), picture)
        self.assertTrue(os.path.exists(self.script("paraview.py", path, "--task", "2").strip()))

    def test_tasks_that_are_not_complete_are_not_read(self):
        path = self.run_job("partial")
        with h5py.File(path, "r+") as h5:
            h5["tasks/state"][:2] = 0
        with SweepFile(path) as file:
            self.assertEqual(len(everything(file)), 4)
        self.assertIn("4 of 6 tasks ok, none failed, 2 pending", self.script("summary.py", path))


if __name__ == "__main__":
    unittest.main()
