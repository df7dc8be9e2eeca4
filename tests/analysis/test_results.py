"""rodsweep.open(): frames, blocks and datasets against the planted file; units, missing values, plain refusals."""

import os
import subprocess
import sys
import unittest
import unittest.mock
import warnings

import synthetic
import numpy as np
import pandas
import rodsweep
from rodsweep.reading import tidy
from rodsweep.reading.errors import IgnoredData, KeyNotFound
from running import Folder

PLANT = synthetic.Plant()
PLANT.reached = lambda guess, tolerance, newton, segments, draw: guess != "previous" or tolerance > 1e-3


class Opened(Folder):
    def open(self, **settings):
        self.path = os.path.join(self.folder, f"{len(os.listdir(self.folder))}.h5")    # the previous file may be open
        usual = {"plant": PLANT, "counts_in_rows": True, "failed": {3: "diverged"}, "pending": (4,), "steps": 2}
        synthetic.Sweep(**{**usual, **settings}).write(self.path)
        with synthetic.h5py.File(self.path, "r+") as h5:
            h5["steps/length_drift"].attrs.update({"unit": "1", "meaning": "relative change of the length"})
            h5["solves/iterations"].attrs.update({"unit": "1", "meaning": "CG iterations"})
        results = rodsweep.open(self.path)
        self.addCleanup(results.close)
        return results


class Frames(Opened):
    def test_a_row_per_task_guess_and_tolerance_of_what_is_complete(self):
        results = self.open()
        tasks = results.tasks()
        self.assertEqual(len(tasks), 23 * 4 * 8)
        self.assertEqual(sorted(set(tasks.task)), [t for t in range(24) if t != 4])
        self.assertEqual(set(tasks.outcome[tasks.task == 3]), {"diverged"})
        one = tasks[(tasks.task == 8) & (tasks.guess == "previous") & (tasks.tolerance == 0.01)]
        self.assertEqual(one[["iterations_sum", "scene.segments", "scene.type", "sample"]].values.tolist(),
                         [[2 * 404, 40, "bending_rod", 0]])
        self.assertNotIn("solve.norm", tasks)    # the same for every task

    def test_what_was_not_reached_is_nan_and_what_has_no_meaning_too(self):
        solves = self.open(failed={}, pending=()).solves(where="scene.type=helix")
        self.assertEqual(len(solves), 12 * 2 * 3 * 4)
        zero = solves[(solves.guess == "zero") & (solves["scene.segments"] == 10)]
        self.assertEqual(set(zero["iterations_1e-2"]), {202})
        self.assertAlmostEqual(solves.direct_s.iloc[0], 8e-6)
        self.assertEqual(set(solves.guess[solves["iterations_1e-4"].isna()]), {"previous"})
        self.assertTrue(solves["scene.length_m"].isna().all())
        self.assertEqual(solves.newton.dtype.kind, "i")

    def test_counts_are_whole_numbers_also_where_some_are_missing(self):
        results = self.open()
        tasks, solves = results.tasks(), results.solves()
        self.assertEqual([str(tasks[name].dtype) for name in ("iterations_sum", "unreached", "task", "sample")],
                         ["Int64", "Int64", "int64", "int64"])
        self.assertEqual(str(solves["iterations_1e-4"].dtype), "Int64")
        self.assertTrue(solves["iterations_1e-4"].isna().any())
        self.assertEqual(solves["iterations_1e-4"].min(), 20)
        self.assertEqual(results.dataset("solves").iterations.dtype.kind, "f")
        self.assertEqual(str(results.summary().unreached_solves.dtype), "Int64")

    def test_a_tolerance_that_was_not_counted_is_refused(self):
        for reader in (self.open().tasks, self.open().summary):
            with self.assertRaisesRegex(KeyNotFound, "no tolerance meets tolerance=0.02; known: 1e-08, .* 0.01, 0.1"):
                reader(where="tolerance=0.02")

    def test_data_of_a_user_in_our_groups_are_no_columns(self):
        with self.open() as before:
            columns = [list(getattr(before, level)().columns) for level in ("tasks", "solves", "steps")]
        with synthetic.h5py.File(self.path, "r+") as h5:
            h5["tasks/mine"], h5["tasks/parameters/mine"] = np.arange(3), 1.5
            h5["steps/mine"], h5["solves/notes"] = np.zeros((2, 2)), "mine"
            h5["timing/solves/mine"] = np.zeros(3)
        with self.assertWarnsRegex(IgnoredData, "ignored /tasks/mine, /tasks/parameters/mine, /solves/notes, "
                                                "/timing/solves/mine, /steps/mine: not a row per task, solve or step$"):
            after = rodsweep.open(self.path)
        self.assertEqual([list(getattr(after, level)().columns) for level in ("tasks", "solves", "steps")], columns)

    def test_units_meanings_and_what_is_missing_stay(self):
        results = self.open()
        steps = results.steps()
        self.assertEqual([steps[f"momentum_kg_m_s_{k}"].iloc[0] for k in "xyz"], [3, 0, 4])
        self.assertAlmostEqual(steps.length_drift.min(), -1e-3)
        self.assertEqual(steps.attrs["unit"]["scene.youngs_modulus_pa"], "Pa")
        self.assertEqual(steps.attrs["meaning"]["length_drift"], "relative change of the length")
        self.assertEqual(steps.attrs["missing"], "1 pending, 1 diverged of 24 tasks")
        self.assertIn("22 of 24 tasks ok, failed: 1 diverged, 1 pending", repr(results))
        self.assertEqual(results.columns("solves").meaning["iterations_1e-2"], "CG iterations; 1e-2")
        self.assertEqual(self.open(failed={}, pending=()).missing, "")

    def test_columns_and_conditions_are_chosen(self):
        results = self.open()
        solves = results.solves(["guess", "step", "iterations_1e-2"],
                                ["newton=0", "guess=zero,quadratic", "scene.segments>=20"])
        self.assertEqual(list(solves), ["guess", "step", "iterations_1e-2"])
        self.assertEqual(len(solves), 15 * 2 * 2)
        self.assertEqual(results.steps("task", "task<2").task.tolist(), [0, 0, 1, 1])
        self.assertEqual(len(results.tasks(where="outcome=torn")), 0)
        self.assertEqual(list(results.tasks(where="outcome=torn")), list(results.tasks()))

    def test_groups_of_several_columns_are_the_combinations_that_exist(self):
        results = self.open(failed={3: "diverged", 12: "diverged"})    # of both scenes, with few segments
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            groups = results.tasks().groupby(["scene.type", "outcome", "scene.segments"]).size()
            means = results.tasks(where=["tolerance=1e-2", "guess!=zero", "scene.type=helix"]) \
                .groupby(["scene.segments", "guess"]).iterations_sum.mean().unstack()
            summary = results.summary().groupby(["scene", "settings", "guess"]).size()
        self.assertEqual(len(groups), 2 * 3 + 2)
        self.assertGreater(groups.min(), 0)
        self.assertEqual(list(means), ["oracle(0.1)", "previous", "quadratic"])
        self.assertTrue(means.notna().all(axis=None))
        self.assertEqual(len(summary), 2 * 5)    # guesses, and the direct solve

    def test_missing_texts_are_nan_and_equal_ones_share_their_memory(self):
        message = self.open().tasks().message
        self.assertEqual(set(message.dropna()), {"planted"})
        self.assertEqual(message.notna().sum(), 4 * 8)
        self.assertEqual(len({id(text) for text in message.dropna()}), 1)

    def test_blocks_are_the_frame_in_parts_of_bounded_size(self):
        results = self.open()
        with unittest.mock.patch.object(tidy, "BLOCK_ROWS", 20):
            parts = list(results.blocks("solves", where="newton<2", rows=50))
        self.assertGreater(len(parts), 5)
        self.assertLess(max(len(part) for part in parts), 50 + 20)
        together = pandas.concat(parts).sort_values(["task", "guess", "step", "newton"], ignore_index=True)
        whole = results.solves(where="newton<2").sort_values(["task", "guess", "step", "newton"], ignore_index=True)
        pandas.testing.assert_frame_equal(together, whole)
        self.assertEqual(parts[0].attrs["unit"]["scene.youngs_modulus_pa"], "Pa")

    def test_a_closed_loop_and_direct_simulations_have_frames(self):
        closed = self.open(scenes=("helix",), closed_loop=True, failed={}, pending=()).tasks(where="tolerance=1e-2")
        self.assertEqual(closed.groupby("guess").size().to_dict(), dict.fromkeys(synthetic.GUESSES, 12))
        direct = self.open(method="direct", plant=synthetic.Plant())
        self.assertEqual(len(direct.tasks()), 23)
        self.assertEqual(len(direct.steps()), 23 * 2)

    def test_a_sweep_that_has_just_begun_has_empty_frames(self):
        results = self.open(pending=range(24), failed={})
        for frame in (results.tasks(), results.solves(), results.steps(), results.summary()):
            self.assertEqual((len(frame), frame.attrs["missing"]), (0, "24 pending of 24 tasks"))
        self.assertIn("quantity", results.summary(by="scene.segments"))
        self.assertEqual(list(results.blocks("solves")), [])
        self.assertEqual(results.dataset("solves").sizes["row"], 0)

    def test_the_summary_has_the_planted_ratio_with_its_interval(self):
        summary = self.open(samples=6).summary(by="scene.segments")
        row, = summary[(summary.quantity == "cg_ratio") & (summary.guess == "quadratic") & (summary.tolerance == 1e-2) &
                       (summary.scene == "helix") & (summary["scene.segments"] == 20)].itertuples()
        self.assertAlmostEqual(row.value, 0.25, delta=0.003)
        self.assertLessEqual(row.low, row.value)
        self.assertEqual(row.simulations, 6)

    def test_conditions_choose_guesses_and_tolerances_of_the_summary(self):
        summary = self.open(samples=6).summary(where=["tolerance=1e-2", "guess=quadratic", "scene.segments=20"])
        ratios = summary[summary.quantity == "cg_ratio"]
        self.assertEqual(ratios[["scene", "guess", "tolerance", "simulations"]].values.tolist(),
                         [["bending_rod", "quadratic", 0.01, 6], ["helix", "quadratic", 0.01, 6]])
        self.assertEqual(len(self.open().summary(where=["guess!=zero", "guess=zero"])), 0)

    def test_a_closed_loop_names_the_guess_that_advances_the_rods(self):
        results = self.open(scenes=("helix",), closed_loop=True, failed={}, pending=())
        tasks = results.tasks(where="own_guess=quadratic")
        self.assertEqual({*tasks.guess, *tasks.own_guess}, {"quadratic"})


class Datasets(Opened):
    def test_guess_and_tolerance_are_axes(self):
        dataset = self.open().dataset("tasks")
        self.assertEqual(dict(dataset.sizes), {"task": 23, "guess": 4, "cg_tolerance": 8})
        self.assertEqual(dataset.iterations_sum.sel(task=8, guess="previous", cg_tolerance=0.01).item(), 2 * 404)
        self.assertEqual(dataset["scene.youngs_modulus_pa"].attrs["units"], "Pa")
        self.assertEqual(dataset.attrs["missing"], "1 pending, 1 diverged of 24 tasks")
        self.assertEqual(dataset.outcome.sel(task=3).item(), "diverged")

    def test_rows_belong_to_tasks_and_conditions_choose_them(self):
        results = self.open()
        solves = results.dataset("solves", where=["newton=0", "guess!=zero", "task<4"])
        self.assertEqual(dict(solves.sizes), {"row": 4 * 2, "guess": 3, "cg_tolerance": 8})
        self.assertEqual(set(solves.newton.values.tolist()), {0})
        self.assertEqual(solves.iterations.attrs["long_name"], "CG iterations")
        self.assertTrue(np.isnan(solves.iterations.sel(guess="previous", cg_tolerance=1e-4)).all())
        steps = results.dataset("steps", ["momentum_kg_m_s", "scene.segments"])
        self.assertEqual(steps.momentum_kg_m_s.sel(xyz="z").values.tolist(), [4.0] * 46)
        self.assertEqual(list(steps.data_vars), ["momentum_kg_m_s"])


class Refusals(Opened):
    def refused(self, words, call):
        with self.assertRaises(rodsweep.UserError) as caught:
            call()
        self.assertIn(words, str(caught.exception))

    def test_what_is_no_sweep_is_refused(self):
        self.refused("file not found", lambda: rodsweep.open("none.h5"))
        for kind, words in (("model", "of kind model without tasks"),
                            ("dataset", "is a dataset, not the results of a sweep")):
            self.open().close()
            with synthetic.h5py.File(self.path, "r+") as h5:
                h5.attrs["kind"] = kind
                if kind == "model":
                    del h5["tasks"]
            self.refused(words, lambda: rodsweep.open(self.path))

    def test_what_there_is_not_is_answered_with_the_nearest(self):
        results = self.open()
        self.refused("did you mean iterations_sum?", lambda: results.tasks(["iteration_sum"]))
        self.refused("did you mean scene.segments?", lambda: results.steps(where="scene.segmnts=20"))
        self.refused("did you mean iterations?", lambda: results.dataset("solves", ["iterationss"]))
        self.refused("has a value for every guess", lambda: results.dataset("solves", where="cg_s>1"))
        self.refused("has a value for every guess", lambda: results.summary(where="iterations_sum>1"))
        self.refused("choose one of tasks, solves, steps", lambda: results.blocks("task"))
        self.refused("choose one of first, all", lambda: results.summary(newton="last"))
        self.refused("has no rows of solves", self.open(solves=False).solves)

    def test_without_pandas_the_scripts_work_and_frames_say_what_is_missing(self):
        self.open().close()
        code = ("import sys; sys.modules['pandas'] = None; import rodsweep, rodsweep.reading.sweepfile\n"
                f"results = rodsweep.open({self.path!r})\n"
                "try: results.tasks()\nexcept rodsweep.UserError as error: print(error)")
        said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True,
                              env={**os.environ, "PYTHONPATH": synthetic.ANALYSIS}).stdout
        self.assertIn("pandas is not installed: apt-get install python3-pandas", said)

    def test_without_h5py_importing_says_what_to_install(self):
        code = "import sys; sys.modules['h5py'] = None; import rodsweep"
        said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False,
                              env={**os.environ, "PYTHONPATH": synthetic.ANALYSIS}).stderr
        self.assertIn("rodsweep needs h5py: apt-get install python3-h5py", said.splitlines()[-1])


if __name__ == "__main__":
    unittest.main()
