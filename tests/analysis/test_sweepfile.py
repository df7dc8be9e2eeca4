"""The reader: refusals and their words, masking by state, parameters, rows in bounded blocks. Scripts on truncated or
incomplete files: one plain line and exit code 2, or the figures, never a traceback. Bytes are not flipped here: on some
such files libhdf5 1.10 crashes, and with it the process."""

import os
import random

import synthetic
import h5py
import numpy as np
from rodsweep.reading import errors
from rodsweep.reading.errors import KeyNotFound, SweepFileError
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.reading.task_columns import TaskColumns
from running import Folder, Scripts, run

SCRIPTS = (("summary.py",), ("summary.py", "--json"), ("export.py",), ("spatial.py",))


class Refusals(Folder):
    def refused(self, *parts):
        with self.assertRaises(SweepFileError) as caught:
            SweepFile(self.path)
        for part in (self.path, *parts):
            self.assertIn(part, str(caught.exception))

    def test_what_is_no_file_of_hdf5(self):
        self.refused("file not found")
        os.mkdir(self.path)
        self.refused("is a folder")
        os.rmdir(self.path)
        with open(self.path, "w") as text:
            text.write("step,ratio\n")
        self.refused("not an HDF5 file", "rodsweep run")

    def test_files_of_others(self):
        for attributes, *parts in (({}, "not one of rodsweep", "`program`"),
                                   ({"program": "lammps", "schema_version": 2}, "not one of rodsweep", "'lammps'"),
                                   ({"program": "rodsweep", "schema_version": 1}, "schema version 1", "read 2"),
                                   ({"program": "rodsweep", "schema_version": 2}, "/tasks/state", "not the results")):
            with self.subTest(attributes=attributes):
                with h5py.File(self.path, "w") as h5:
                    h5.attrs.update(attributes)
                self.refused(*parts)

    def test_columns_that_are_missing_or_do_not_fit_together(self):
        for column, values, words in (("first_solve", None, "/tasks/first_solve is missing"),
                                      ("outcome", np.array([b"ok"] * 3), "is damaged"),
                                      ("outcome", np.float64(1), "is damaged"),
                                      ("state", np.zeros((2, 2)), "is damaged")):
            synthetic.Sweep().write(self.path)
            with h5py.File(self.path, "r+") as h5:
                del h5[f"tasks/{column}"]
                if values is not None:
                    h5[f"tasks/{column}"] = values
            self.refused(words)

    def test_the_file_is_closed_after_a_refusal(self):
        h5py.File(self.path, "w").close()
        self.refused()
        h5py.File(self.path, "w").close()  # fails while the file is open


class Masking(Folder):
    def test_pending_tasks_have_no_outcome_and_no_results(self):
        file = self.open(pending=(1, 5), failed={2: "diverged"})
        self.assertEqual(list(file.outcome[:3]), ["ok", "pending", "diverged"])
        self.assertEqual(list(np.flatnonzero(~file.complete)), [1, 5])
        self.assertEqual(list(np.flatnonzero(file.complete & ~file.ok)), [2])
        with self.assertRaises(ValueError):
            file.results("iterations_sum", [0, 1])
        with self.assertRaises(ValueError):
            next(file.solve_blocks([5], ["/solves/newton"]))

    def test_control_characters_of_a_message_are_shown_by_their_number(self):
        self.open(failed={1: "error"})

        def rude(h5):
            h5["tasks/message"][1] = "\x1b[31mred\n\u0085ä".encode()
        self.assertEqual(self.changed(rude).results("message", [1])[0], "\\x1b[31mred\n\\x85ä")

    def test_absent_and_empty_columns_are_none(self):
        file = self.open(method="direct")
        self.assertEqual((file.guesses, len(file.tolerances), file.zero), ([], 0, None))
        self.assertIsNone(file.results("iterations_sum", [0]))
        self.assertIsNone(file.results("no_such_column", [0]))
        self.assertFalse(file.has("/solves/newton"))


class Parameters(Folder):
    def test_units_meanings_and_which_are_swept(self):
        file = self.open()
        self.assertEqual(file.parameter("scene.youngs_modulus_pa").unit, "Pa")
        self.assertEqual(file.parameter("scene.segments").meaning, "the scene.segments")
        self.assertEqual(set(file.swept()),
                         {"scene.type", "scene.segments", "scene.youngs_modulus_pa", "scene.length_m"})
        np.testing.assert_array_equal(file.parameter("scene.length_m").applies(), file.scene_types() == "bending_rod")

    def test_an_unknown_name_is_answered_with_the_nearest(self):
        file = self.open()
        for asked, answer in (("scene.segment", "scene.segments"), ("segments", "scene.segments"),
                              ("scene.young_modulus", "scene.youngs_modulus_pa")):
            with self.assertRaises(KeyNotFound) as caught:
                file.parameter(asked)
            self.assertIn(f"{asked!r} is not in the file; did you mean {answer}?", caught.exception.args[0])

    def test_the_nearest_is_near(self):
        """The cases of the program (tests/runner/job/test_job_refusals.cpp), and names with a point."""
        known = ["length_m", "segments", "step_s", "gravity_m_s2", "zero", "previous", "scene.type", "evaluation",
                 "0.01"]
        for word, wanted in (("lenght_m", "length_m"), ("Segment", "segments"), ("steps", "step_s"), ("zreo", "zero"),
                             ("gravity", "gravity_m_s2"), ("types", "scene.type"), ("temperature", ""), ("", ""),
                             ("x" * 100_000, ""), ("nope", ""), ("newton", ""), ("0.03", "")):
            self.assertEqual(errors.nearest(word, known), wanted, word[:20])
        many = [f"column_{k}" for k in range(65)]
        self.assertRegex(errors.not_found("column", "nope", many, "all: here").args[0],
                         rf"'nope' .*: {', '.join(many[:12])} and 53 more \(all: here\)")
        self.assertRegex(errors.not_found("guess", "zreo", known[4:6]).args[0],
                         "'zreo' .*did you mean zero.* zero, previous$")

    def test_unknown_guesses_and_tolerances(self):
        file = self.open()
        with self.assertRaisesRegex(KeyNotFound, "guess 'quadratc'.*did you mean quadratic"):
            file.guess_index("quadratc")
        with self.assertRaisesRegex(KeyNotFound, "tolerance '0.03' is not in the file"):
            file.tolerance_index(0.03)
        self.assertEqual(file.tolerance_index(1e-3), 2)

    def test_conditions_that_no_task_meets_together_are_refused(self):
        file = self.open()
        with self.assertRaisesRegex(KeyNotFound, "no task meets all"):
            TaskColumns(file).select(["scene.segments=10", "scene.segments=20"])


class Rows(Folder):
    def test_blocks_cover_every_row_once_whatever_their_size(self):
        file = self.open(samples=2, pending=(3,))
        tasks = np.flatnonzero(file.complete)[::-1]
        times, first = file.h5["/timing/solves/cg_s"][:, 0], file.first_solve
        whole = {int(t): times[first[t]:first[t] + file.solves[t]].sum() for t in tasks}
        for limit in (1, 4, 15, 16, 40, 10 ** 6):
            found, rows_seen = dict.fromkeys(whole, 0.0), 0
            for owners, starts, rows in file.solve_blocks(tasks, ["/timing/solves/cg_s"], limit):
                values = rows["/timing/solves/cg_s"][:, 0].astype(float)
                self.assertLessEqual(len(values), limit)
                rows_seen += len(values)
                for owner, total in zip(owners, np.add.reduceat(values, starts)):
                    found[owner] += total
            self.assertEqual(rows_seen, file.solves[tasks].sum())
            for task, total in whole.items():
                self.assertAlmostEqual(found[task], total, places=9, msg=f"task {task}, limit {limit}")

    def test_no_rows_no_blocks(self):
        file = self.open(solves=False)
        self.assertEqual(list(file.solve_blocks([0, 1], ["/solves/newton"])), [])


class Provenance(Folder):
    def test_runs_the_job_and_oversubscribed_runs_by_the_tasks_they_timed(self):
        file = self.open(oversubscribed=True)
        self.assertEqual([run["revision"] for run in file.runs()], ["abc123"])
        self.assertEqual(file.job()["name"], "synthetic")
        self.assertTrue(file.oversubscribed(np.array([0])))

        def extend(h5):
            h5["runs/begin"][1] = b"2025-11-21T11:00:00Z"
            h5["timing/tasks/run"][2:] = 1
        file = self.changed(extend)
        self.assertTrue(file.oversubscribed(np.array([0, 5])))
        self.assertFalse(file.oversubscribed(np.array([2, 5])))


class Damaged(Scripts):
    def setUp(self):
        super().setUp()
        self.write(scenes=("helix",), samples=2)
        with open(self.path, "rb") as whole:
            self.whole = whole.read()

    def plant(self, contents):
        with open(self.path, "wb") as damaged:
            damaged.write(contents)

    def assert_plain(self, script, *arguments):
        done = run(script, self.path, *arguments)
        if done.code:
            self.assertEqual(done.code, 2, done.stderr)
            *warnings, error = done.stderr.splitlines()
            self.assertTrue(error.startswith(f"{script}: "), done.stderr)
            self.assertTrue(all(": ignored /" in line for line in warnings), done.stderr)
        return done.code

    def test_a_file_that_was_cut_short(self):
        for part in range(16):
            with self.subTest(part=part):
                self.plant(self.whole[:len(self.whole) * part // 16])
                self.assertEqual(self.assert_plain(*SCRIPTS[part % len(SCRIPTS)]), 2)

    def test_datasets_that_are_missing_or_of_another_shape_or_kind(self):
        paths = []
        with h5py.File(self.path) as file:
            file.visititems(lambda name, item: paths.append(name) if isinstance(item, h5py.Dataset) else None)
        draw = random.Random(5)
        for number, path in enumerate(draw.sample(paths, 24)):
            script = SCRIPTS[number % len(SCRIPTS)]
            with self.subTest(path=path, script=script):
                self.plant(self.whole)
                with h5py.File(self.path, "a") as file:
                    values = file[path][()]
                    del file[path]
                    if number % 4 == 1:
                        file[path] = values.ravel()[:1]
                    elif number % 4 == 2:
                        file[path] = "text"
                    elif number % 4 == 3:
                        file.create_group(path)
                self.assert_plain(*script)
