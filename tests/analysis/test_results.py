"""rodsweep.open(): frames, blocks and datasets against the planted file; units, missing values, plain refusals. export.py:
the same rows; options, compressed output."""

import csv
import gzip
import io
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
from running import Folder, Scripts

PLANT = synthetic.Plant(reached=synthetic.unless("previous", 1e-3))


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

    def test_missing_texts_are_nan_and_equal_ones_share_their_memory(self):
        results = self.open()
        message = results.tasks().message
        self.assertEqual((set(message.dropna()), message.notna().sum()), ({"planted"}, 4 * 8))
        self.assertEqual(len({id(text) for text in message.dropna()}), 1)
        torn = results.tasks(where="outcome=torn")
        self.assertEqual((len(torn), list(torn)), (0, list(results.tasks())))

    def test_the_summary_has_the_planted_ratio_with_its_interval_of_what_conditions_choose(self):
        results = self.open(samples=6)
        summary = results.summary(by="scene.segments", where=["tolerance=1e-2", "guess=quadratic", "scene.segments=20"])
        ratios = summary[summary.quantity == "cg_ratio"]
        self.assertEqual(ratios[["scene", "guess", "tolerance", "simulations", "scene.segments"]].values.tolist(),
                         [[scene, "quadratic", 0.01, 6, 20] for scene in ("bending_rod", "helix")])
        for row in ratios.itertuples():
            self.assertAlmostEqual(row.value, 0.25, delta=0.003)
            self.assertTrue(row.low <= row.value <= row.high)
        self.assertEqual(len(results.summary(where=["guess!=zero", "guess=zero"])), 0)

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

    def test_steps_are_numbered_from_zero_in_every_task(self):
        results = self.open(steps=5, pending=(4, 9))
        with unittest.mock.patch.object(tidy, "BLOCK_ROWS", 3):    # a task is in several blocks
            steps = results.steps()
            self.assertEqual(results.dataset("steps", "step").step.values.tolist(), steps.step.tolist())
        self.assertEqual(steps.groupby("task").step.apply(list).tolist(), 22 * [[0, 1, 2, 3, 4]])
        self.assertEqual(results.columns("steps").meaning["step"], "time step, from 0")
        self.assertEqual(results.steps(["task", "step"], where=["step>3", "task=3,5"]).values.tolist(), [[3, 4], [5, 4]])
        drift = results.solves(where="guess=zero").merge(steps, on=["task", "step"]).length_drift
        self.assertTrue(drift.notna().all())

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
        opened = self.open(scenes=("helix",), closed_loop=True, failed={}, pending=())
        closed, steps = opened.tasks(where="tolerance=1e-2"), opened.steps()
        self.assertEqual(closed.groupby("guess").size().to_dict(), dict.fromkeys(synthetic.GUESSES, 12))
        self.assertTrue((closed.guess == closed.own_guess).all())    # the guess that advances the rods
        owners = dict(zip(closed.task, closed.own_guess))
        self.assertEqual([owners[task] for task in steps.task], list(steps.own_guess))
        direct = self.open(method="direct", plant=synthetic.Plant())
        self.assertEqual(len(direct.tasks()), 23)
        self.assertEqual(len(direct.steps()), 23 * 2)

    def test_a_sweep_that_has_just_begun_has_empty_frames(self):
        results = self.open(pending=range(24), failed={})
        for frame in (results.tasks(), results.solves(), results.steps(), results.summary()):
            self.assertEqual((len(frame), frame.attrs["missing"]), (0, "24 pending of 24 tasks"))
        self.assertIn("quantity", results.summary(by="scene.segments"))
        self.assertEqual(list(results.blocks("solves")), [])
        self.assertEqual([results.dataset(level).sizes["row"] for level in ("solves", "steps")], [0, 0])


class Datasets(Opened):
    def test_conditions_that_nothing_meets_leave_an_empty_one(self):
        found = self.open().dataset("solves", where=["guess=quadratic", "step>1000000"])
        self.assertEqual((found.sizes["guess"], found.sizes["row"]), (1, 0))

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


class Export(Scripts):
    def rows(self, *arguments):
        name = os.path.join(self.folder, "out.csv")
        self.run_script("export.py", "sweep.h5", *arguments, "-o", name, "--force")
        with open(name, encoding="utf-8", newline="") as text:
            return list(csv.DictReader(text))

    def test_every_level_has_the_rows_that_rodsweep_open_hands_out(self):
        def text(said):
            return pandas.read_csv(io.StringIO(said))

        incomplete = {"failed": {3: "diverged"}, "pending": (4,), "counts_in_rows": True, "plant": PLANT}
        for settings, levels in ((incomplete, 3), ({"closed_loop": True, "scenes": ("helix",)}, 3),
                                 ({"method": "direct"}, 2)):
            self.write(**settings)
            with rodsweep.open("sweep.h5") as results:
                for level in ("tasks", "steps", "solves")[:levels]:
                    with self.subTest(level=level, **settings):
                        rows = self.run_script("export.py", "sweep.h5", "--level", level).stdout
                        frame = getattr(results, level)().to_csv(index=False)
                        pandas.testing.assert_frame_equal(text(rows), text(frame), check_dtype=False)
                        self.assertNotIn(",-1,", rows)

    def test_conditions_are_on_any_column_and_columns_come_in_the_given_order(self):
        self.write(scenes=("helix",), counts_in_rows=True)
        rows = self.rows("--level", "solves", "--columns", "guess,task", "--where", "newton=0", "--where",
                         "guess=quadratic,previous", "--where", "scene.segments=15:40")
        self.assertEqual(list(rows[0]), ["guess", "task"])
        self.assertEqual(len(rows), 8 * 2 * 2)
        self.assertEqual({row["guess"] for row in rows}, {"previous", "quadratic"})
        self.assertEqual(self.rows("--where", "outcome=diverged"), [])
        tolerances = self.rows("--where", "tolerance<=1e-3", "--where", "guess!=zero", "--where", "iterations_sum>=100")
        self.assertEqual({row["tolerance"] for row in tolerances},
                         {"0.001", "0.0001", "1e-05", "1e-06", "1e-07", "1e-08"})
        self.assertGreaterEqual(min(int(row["iterations_sum"]) for row in tolerances), 100)
        solves = self.rows("--level", "solves", "--tolerance", "1e-2,1e-4")
        self.assertEqual([name for name in solves[0] if name.startswith("iterations")],
                         ["iterations_1e-2", "iterations_1e-4"])

    def test_rows_of_a_step_that_newton_left_early_are_left_out(self):
        self.write(scenes=("helix",))
        self.changed(("solves/newton", 2, -1))
        self.assertEqual(len(self.rows("--level", "solves", "--guess", "zero")), 12 * 6 - 1)

    def test_numbers_and_texts_come_back_as_they_are_in_the_file(self):
        self.write(scenes=("helix",), failed={2: "error"})
        values = np.random.Generator(np.random.PCG64(2)).normal(size=24)
        values[3] = np.nan
        self.changed(("steps/joint_gap", slice(None), values), ("tasks/message", 2, b'say "hi", you\ntwo lines'))
        found = [row["joint_gap"] for row in self.rows("--level", "steps")]
        self.assertEqual(found[3], "")
        self.assertEqual([float(text) for text in found[:3] + found[4:]], [*values[:3], *values[4:]])
        self.assertEqual({row["task"]: row["message"] for row in self.rows() if row["message"]},
                         {"2": 'say "hi", you\ntwo lines'})

    def test_a_name_that_ends_in_gz_is_compressed_and_standard_output_has_the_same(self):
        self.write(scenes=("helix",))
        said = self.run_script("export.py", "sweep.h5", "-o", "out.csv.gz").stdout
        self.assertEqual(said, f"{12 * 4 * 8} rows: out.csv.gz\n")
        with gzip.open(os.path.join(self.folder, "out.csv.gz"), "rt", encoding="utf-8", newline="") as text:
            compressed = text.read()
        self.assertEqual(len(list(csv.DictReader(io.StringIO(compressed)))), 12 * 4 * 8)
        self.assertEqual(self.run_script("export.py", "sweep.h5").stdout, compressed)

    def test_a_file_without_rows_or_columns_that_later_versions_have_is_read(self):
        self.write(scenes=("helix",), solves=False)
        self.changed(lambda h5: h5.update({"tasks/matvecs_sum": h5["tasks/iterations_sum"][:] * 2}))
        self.assertEqual({float(row["matvecs_sum"]) / float(row["iterations_sum"]) for row in self.rows()}, {2.0})
        self.refused("export.py", "sweep.h5", "--level", "solves", words="no rows of solves")

    def test_parquet_holds_the_rows_of_the_csv_and_needs_pyarrow(self):
        self.write(scenes=("helix",), failed={3: "diverged"})
        with unittest.mock.patch.object(pandas.DataFrame, "to_parquet", side_effect=ImportError):
            self.refused("export.py", "sweep.h5", "-o", "out.parquet", words="pip install pyarrow")
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith("out")], [])
        for level in ("tasks", "solves", "steps"):
            with unittest.mock.patch.object(pandas.DataFrame, "to_parquet", autospec=True) as written:
                self.run_script("export.py", "sweep.h5", "--level", level, "-o", "out.parquet", "--force")
            frame = written.call_args.args[0]
            read = pandas.read_csv(io.StringIO(self.run_script("export.py", "sweep.h5", "--level", level).stdout))
            pandas.testing.assert_frame_equal(frame.astype(read.dtypes), read)

    def test_a_terminal_shows_the_first_rows_and_how_many_there_are(self):
        self.write(scenes=("helix",), samples=1)
        whole = self.run_script("export.py", "sweep.h5")
        self.assertEqual(whole.stderr, "")
        with unittest.mock.patch("export.at_terminal", return_value=True):
            for level, rows in (("tasks", 96), ("steps", 6)):
                shown = self.run_script("export.py", "sweep.h5", "--level", level)
                self.assertEqual(len(shown.stdout.splitlines()), 1 + min(rows, 20))
                self.assertEqual(shown.stderr, "the first 20 of 96 rows; -o FILE writes all\n" if rows > 20 else "")
                if level == "tasks":
                    self.assertEqual(shown.stdout.splitlines(), whole.stdout.splitlines()[:21])

    def test_nothing_is_overwritten_and_mistakes_are_one_line(self):
        self.write(scenes=("helix",))
        self.run_script("export.py", "sweep.h5", "-o", "out.csv")
        for words, *arguments in (("out.csv already exists", "-o", "out.csv"),
                                  ("sweep.h5 already exists", "-o", "sweep.h5", "--force"),
                                  ("did you mean iterations_sum?", "--columns", "iterationssum"),
                                  ("did you mean quadratic?", "--where", "guess=quadratc"),
                                  ("did you mean time.newton_iterations?\n", "--where", "newton=0"),
                                  (" more (export.py --list and results.columns()", "--columns", "nope"),
                                  ("named twice", "--columns", "task,task"),
                                  ("COLUMN=VALUE", "--where", "newton"), ('"x"', "--where", "sample=x", "-o", "x.csv")):
            self.refused("export.py", "sweep.h5", *arguments, words=words)
        self.assertEqual(sorted(os.listdir(self.folder)), ["out.csv", "sweep.h5"])
        self.run_script("export.py", "sweep.h5", "-o", "new/out.csv")
        self.assertEqual(os.listdir(os.path.join(self.folder, "new")), ["out.csv"])
        self.assertIn("iterations_sum\n", self.run_script("export.py", "sweep.h5", "--list").stdout)
