#!/usr/bin/python3
"""The commands from outside: what they print, write, refuse and exit with."""

import csv
import io
import json
import os
import signal
import subprocess
import sys
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "analysis"))
import h5py
import numpy as np
import program
from program import ALL_DONE, DATA, JOB, OUTPUT_LOST, STOPPED, TASKS_FAILED, USER_ERROR, rodsweep, sweep
from rodsweep.reading.sweepfile import SweepFile


class Case(unittest.TestCase):
    def assert_exit(self, process, code):
        self.assertEqual(process.returncode, code, f"{process.stdout}\n{process.stderr}")
        return process.stdout

    def assert_refused(self, process, *texts):
        self.assert_exit(process, USER_ERROR)
        self.assertEqual(process.stdout, "")
        for text in texts:
            self.assertIn(text, process.stderr)


def unfinished(name, path):
    """A copy of a sweep's file in which only task 0 is done."""
    with open(sweep(name), "rb") as whole, open(path, "wb") as part:
        part.write(whole.read())
    with h5py.File(path, "r+") as h5:
        h5["tasks/state"][1:] = 0
    return path


class Query(Case):
    def test_the_table_shows_what_is_swept_the_outcome_and_the_ratios(self):
        said = rodsweep("query", sweep())
        lines = self.assert_exit(said, ALL_DONE).splitlines()
        self.assertEqual(lines[0].split(), ["task", "scene.length_m", "scene.segments", "scene.youngs_modulus_pa",
                                            "outcome", "cg_ratio.previous", "cg_ratio.oracle", "0.1"])
        self.assertEqual(len(lines), 5)
        self.assertIn("4 of 4 tasks", said.stderr)

    def test_csv_holds_what_the_file_holds(self):
        words = ("--columns", "task,scene.segments,scene.length_m", "--columns", "cg_ratio.oracle 0.1@1e-3")
        text = self.assert_exit(rodsweep("query", sweep(), "--csv", *words, "scene.segments=8"), ALL_DONE)
        rows = list(csv.DictReader(io.StringIO(text)))
        with SweepFile(sweep()) as file:
            tasks = np.flatnonzero(file.parameter("scene.segments").values == 8)
            self.assertEqual([int(row["task"]) for row in rows], list(tasks))
            ratio = file.results("cg_ratio", tasks)[:, 2, file.tolerance_index(1e-3)]
            self.assertEqual([float(row["cg_ratio.oracle 0.1@1e-3"]) for row in rows], list(ratio))
            self.assertEqual([float(row["scene.length_m"]) for row in rows],
                             list(file.parameter("scene.length_m").values[tasks]))

    def test_json_is_sorted_and_limited(self):
        words = ("--sort", "scene.length_m", "--descending", "--limit", "2", "--json")
        rows = json.loads(self.assert_exit(rodsweep("query", sweep(), *words), ALL_DONE))
        with SweepFile(sweep()) as file:
            order = np.argsort(-file.parameter("scene.length_m").values, kind="stable")
        self.assertEqual([row["task"] for row in rows], list(order[:2]))

    def test_conditions_are_all_met_however_they_are_given(self):
        words = ("scene.segments>=8", "--where", "task<3", "--columns", "task", "--csv")
        self.assertEqual(self.assert_exit(rodsweep("query", sweep(), *words), ALL_DONE), "task\n2\n")

    def test_no_task_is_no_error(self):
        said = rodsweep("query", sweep(), "outcome=diverged", "--json")
        self.assertEqual(json.loads(self.assert_exit(said, ALL_DONE)), [])

    def test_pending_tasks_show_no_results(self):
        path = unfinished("small", "part.h5")
        rows = json.loads(self.assert_exit(rodsweep("query", path, "--json"), ALL_DONE))
        self.assertEqual([row["outcome"] for row in rows], ["ok", "pending", "pending", "pending"])
        self.assertIsNotNone(rows[0]["cg_ratio.previous"])
        self.assertTrue(all(row["cg_ratio.previous"] is None for row in rows[1:]))
        self.assertIn("1 of 4 tasks", rodsweep("query", path, "state=done").stderr)

    def test_a_closed_loop_shows_whose_guess_advances_the_rods(self):
        path = sweep("closed", evaluation="closed_loop")
        rows = json.loads(self.assert_exit(rodsweep("query", path, "own_guess=oracle 0.1", "--json"), ALL_DONE))
        self.assertEqual([row["task"] for row in rows], [2, 5, 8, 11])
        self.assertEqual(rows[0]["steps_done"], 6)

    def test_a_job_without_guesses_has_tasks_too(self):
        path = sweep("direct", solve={"method": "direct"}, guesses=[])
        self.assertEqual(len(json.loads(self.assert_exit(rodsweep("query", path, "--json"), ALL_DONE))), 4)

    def test_a_file_that_is_not_what_its_key_says_is_refused_before_anything_runs(self):
        path = sweep()
        for guess, key, words in (({"copingnet": {"model": f"../{path}"}}, "copingnet.model", "not a model"),
                                  ({"knn": {"data": f"../{path}"}}, "knn.data", "not a data set")):
            with open("jobs/wrong.json", "w", encoding="utf-8") as file:
                json.dump({**JOB, "name": "wrong", "guesses": ["zero", guess]}, file)
            for command in ("run", "plan", "validate"):
                self.assert_refused(rodsweep(command, "jobs/wrong.json"), f"guesses[1].{key}", words)
            self.assertFalse(os.path.exists("results/wrong.h5"))

    def test_all_columns_are_listed_with_meaning_and_unit(self):
        said = self.assert_exit(rodsweep("query", sweep(), "--columns", "help"), ALL_DONE)
        for words in ("scene.length_m", "length of the rod; of a tree's trunk [m]", "cg_ratio.GUESS[@TOLERANCE]",
                      "GUESS      zero, previous, oracle 0.1", "without one 1e-2"):
            self.assertIn(words, said)

    def test_mistakes_are_refused_before_anything_is_shown(self):
        self.assert_refused(rodsweep("query", sweep(), "scene.segmant=3"), "did you mean scene.segments?")
        self.assert_refused(rodsweep("query", sweep(), "--columns", "task,outcom"), "did you mean outcome?")
        self.assert_refused(rodsweep("query", sweep(), "--sort", "lenght_m"), "lenght_m")
        self.assert_refused(rodsweep("query", "nowhere.h5"), "nowhere.h5")

    def test_it_reads_while_a_sweep_writes(self):
        path, job = "live.h5", "live.json"
        with open(job, "w", encoding="utf-8") as file:
            json.dump({**program.JOB, "name": "live", "samples": 100, "time": {"step_s": 0.02, "steps": 40}}, file)
        writer = subprocess.Popen([program.RODSWEEP, "run", job, "-o", path], stdin=subprocess.DEVNULL,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        seen = 0
        while writer.poll() is None:
            if os.path.exists(path):
                rows = json.loads(self.assert_exit(rodsweep("query", path, "state=done", "--json"), ALL_DONE))
                self.assertGreaterEqual(len(rows), seen)
                self.assertTrue(all(row["outcome"] == "ok" and row["cg_ratio.previous"] is not None for row in rows))
                seen = len(rows)
            time.sleep(0.02)
        self.assertEqual(writer.returncode, ALL_DONE)


class Rerun(Case):
    def test_a_task_runs_again_identically_with_its_trajectory(self):
        said = self.assert_exit(rodsweep("rerun", sweep(), 2), ALL_DONE)
        self.assertIn("identical to task 2 of results/small.h5", said)
        with SweepFile(sweep()) as whole, SweepFile("results/small-task-2.h5") as one:
            self.assertEqual(one.task_count, 1)
            self.assertTrue(one.ok[0])
            self.assertEqual(one.parameter("scene.length_m").values[0], whole.parameter("scene.length_m").values[2])
            np.testing.assert_array_equal(one.results("cg_ratio", [0])[0], whole.results("cg_ratio", [2])[0])
            self.assertFalse(whole.has("/trajectories/position_m"))
            self.assertEqual(one.h5["trajectories/position_m"].shape, (7 * 8, 3))
            np.testing.assert_allclose(one.h5["trajectories/time_s"][0], 0.02 * np.arange(7))
        info = json.loads(rodsweep("info", "results/small-task-2.h5", "--verify", "--json").stdout)
        self.assertEqual(info["verified"], {"checked": 1, "damaged": []})
        self.assertEqual((info["tasks"], info["rerun_of_task"]), (1, 2))
        script = os.path.join(os.environ["SOURCE_DIR"], "analysis", "summary.py")
        table = subprocess.run(["/usr/bin/python3", script, "results/small-task-2.h5"], capture_output=True, text=True)
        self.assertIn("1 of 1 tasks ok", self.assert_exit(table, 0))

    def test_every_kind_of_sweep_is_reproduced(self):
        oracle = {"oracle": {"error": {"grid": [0.1, 0.3]}, "label": "oracle"}}
        for name, task, changes in (("closed", 5, {"evaluation": "closed_loop"}),
                                    ("direct", 1, {"solve": {"method": "direct"}, "guesses": []}),
                                    ("data", 2, {**DATA, "record": {"systems": "all"}}),
                                    ("summary", 3, {"record": {"solves": "summary"}}),
                                    ("swept", 7, {"guesses": ["zero", oracle]})):
            with self.subTest(name=name):
                said = rodsweep("rerun", sweep(name, **changes), task, "-o", name + "-again.h5")
                self.assertIn("identical", self.assert_exit(said, ALL_DONE))

    def test_frames_of_the_sweep_are_compared_where_both_have_one(self):
        path = sweep("frames", record={"trajectory_every": 2})
        self.assert_exit(rodsweep("rerun", path, 1, "-o", "every.h5"), ALL_DONE)
        with h5py.File(path, "r+") as h5:
            row = h5["tasks/first_frame_row"][1] + 3 * h5["tasks/segments"][1]  # in the frame of step 6
            h5["trajectories/position_m"][row, 0] += 1e-12
        differs = rodsweep("rerun", path, 1, "--trajectory-every", 3, "-o", "third.h5")
        self.assertIn("/trajectories/position_m", self.assert_exit(differs, TASKS_FAILED))
        # No frame of step 6: step 0 alone is in both.
        self.assert_exit(rodsweep("rerun", path, 1, "--trajectory-every", 5, "-o", "fifth.h5"), ALL_DONE)

    def test_what_differs_is_named_and_makes_exit_code_3(self):
        with open(sweep(), "rb") as whole, open("changed.h5", "wb") as copy:
            copy.write(whole.read())
        with h5py.File("changed.h5", "r+") as h5:
            h5["steps/joint_gap"][h5["tasks/first_step"][1] + 2] = 0.5
            h5["tasks/cg_ratio"][1, 0, 3] = 7
        said = self.assert_exit(rodsweep("rerun", "changed.h5", 1), TASKS_FAILED)
        self.assertIn("differ from task 1 of changed.h5:\n  /tasks/cg_ratio\n  /steps/joint_gap\n", said)
        self.assertIn("2 of ", said)

    def test_a_pending_task_has_nothing_to_be_compared_with(self):
        said = self.assert_exit(rodsweep("rerun", unfinished("small", "part.h5"), 3), ALL_DONE)
        self.assertIn("task 3 is pending in part.h5: there is nothing to compare it with", said)

    def test_a_failed_task_fails_again_identically(self):
        path = sweep("hard", evaluation="closed_loop",
                     solve={"preconditioner": "none", "tolerance": 1e-8, "max_iterations": 2})
        said = self.assert_exit(rodsweep("rerun", path, 0), ALL_DONE)
        self.assertIn("task 0: iteration_limit", said)
        self.assertIn("identical", said)

    def test_the_job_comes_from_the_file_and_its_paths_begin_where_it_was(self):
        path = sweep("moved")
        with h5py.File(path) as h5:
            self.assertEqual(h5["runs/job"][0].decode(), os.path.abspath("jobs/moved.json"))
        os.remove("jobs/moved.json")
        os.makedirs("elsewhere", exist_ok=True)
        said = rodsweep("rerun", "../" + path, 0, "-o", "moved.h5", cwd="elsewhere")
        self.assertIn("identical", self.assert_exit(said, ALL_DONE))
        with h5py.File("elsewhere/moved.h5") as h5:
            self.assertEqual(h5["runs/job"][0].decode(), os.path.abspath("jobs/moved.json"))

    def test_a_packed_file_can_be_rerun_from(self):
        self.assert_exit(rodsweep("pack", sweep(), "-o", "packed.h5"), ALL_DONE)
        self.assertIn("identical", self.assert_exit(rodsweep("rerun", "packed.h5", 0), ALL_DONE))

    def test_mistakes_are_refused_and_nothing_is_overwritten(self):
        self.assert_refused(rodsweep("rerun", sweep(), 4), "has no task 4: they are numbered 0 to 3")
        with open("mine.h5", "w", encoding="utf-8") as file:
            file.write("precious")
        self.assert_refused(rodsweep("rerun", sweep(), 0, "-o", "mine.h5"), "mine.h5 exists already")
        with open("mine.h5", encoding="utf-8") as file:
            self.assertEqual(file.read(), "precious")
        self.assert_exit(rodsweep("rerun", sweep(), 1, "-o", "one.h5"), ALL_DONE)
        self.assert_refused(rodsweep("rerun", "one.h5", 0), "holds task 1 of a sweep, made by `rodsweep rerun`")
        self.assert_refused(rodsweep("run", "jobs/small.json", "-o", "one.h5", "--resume"), "holds one task of a sweep")

    def test_a_signal_ends_it_without_a_file(self):
        path = sweep("endless", samples=1, time={"step_s": 0.02, "steps": 3000}, record={"solves": "summary"},
                     scene={**program.ROD, "segments": 200}, task_time_limit_s=0.01)
        with h5py.File(path, "r+") as h5:  # without the limit the sweep would take as long as the rerun
            text = h5["job/text"][()]
            h5["job/text"][()] = text.replace(b'"task_time_limit_s": 0.01', b'"task_time_limit_s": 0.00')
        process = subprocess.Popen([program.RODSWEEP, "rerun", path, "0"], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertIn("task 0: 200 segments", process.stderr.readline())
        process.send_signal(signal.SIGTERM)
        _, stderr = process.communicate(timeout=30)
        self.assertEqual(process.returncode, STOPPED, stderr)
        self.assertIn("stopped early by SIGTERM; nothing was written", stderr)
        self.assertEqual([name for name in os.listdir("results") if name.startswith("endless")], ["endless.h5"])


class Pack(Case):
    def test_all_readers_take_the_copy_for_the_original(self):
        path = sweep("roomy", samples=10, record={"trajectory_every": 1})
        said = self.assert_exit(rodsweep("pack", path), ALL_DONE)
        self.assertRegex(said, r"results/roomy-packed.h5: [0-9.]+ kB, from [0-9.]+ kB \(\d+ %\); 20 finished tasks verified")
        packed = "results/roomy-packed.h5"
        self.assertLess(os.path.getsize(packed), 0.5 * os.path.getsize(path))
        diff = subprocess.run(["h5diff", path, packed], capture_output=True, text=True)
        self.assertEqual((diff.returncode, diff.stdout), (0, ""))
        for words in (("status", "--json"), ("info", "--verify", "--json"), ("query", "--csv")):
            with self.subTest(words=words):
                one, other = (self.assert_exit(rodsweep(words[0], file, *words[1:]), 0) for file in (path, packed))
                if words[0] == "query":
                    self.assertEqual(one, other)
                else:
                    a, b = (json.loads(text) for text in (one, other))
                    self.assertEqual({k: v for k, v in a.items() if k not in ("file", "bytes")},
                                     {k: v for k, v in b.items() if k not in ("file", "bytes")})
        with SweepFile(path) as a, SweepFile(packed) as b:
            self.assertEqual(a.swept(), b.swept())
            np.testing.assert_array_equal(a.results("cg_ratio", np.arange(20)), b.results("cg_ratio", np.arange(20)))
            for one, other in zip(a.solve_blocks(np.arange(20), ["/solves/iterations"]),
                                  b.solve_blocks(np.arange(20), ["/solves/iterations"])):
                np.testing.assert_array_equal(one[2]["/solves/iterations"], other[2]["/solves/iterations"])

    def test_an_unfinished_sweep_is_packed_with_a_warning(self):
        said = rodsweep("pack", unfinished("small", "part.h5"))
        self.assert_exit(said, ALL_DONE)
        self.assertIn("3 of 4 tasks are pending, and a packed file cannot be continued: keep part.h5", said.stderr)
        self.assertEqual(json.loads(rodsweep("status", "part-packed.h5", "--json").stdout)["pending"], 3)

    def test_a_packed_file_is_not_resumed(self):
        self.assert_exit(rodsweep("pack", sweep(), "-o", "packed.h5"), ALL_DONE)
        self.assert_refused(rodsweep("run", "jobs/small.json", "-o", "packed.h5", "--resume"),
                            "packed.h5 is a packed copy, which cannot be written: resume the file")

    def test_mistakes_are_refused_and_leave_nothing(self):
        os.makedirs("clean", exist_ok=True)
        self.assert_refused(rodsweep("pack", "nowhere.h5", "-o", "clean/a.h5"), "there is no such file")
        self.assert_refused(rodsweep("pack", sweep(), "-o", sweep()), "exists already and is never overwritten")
        self.assertEqual(os.listdir("clean"), [])


class DataSets(Case):
    def test_the_file_says_what_it_is_and_its_rows_follow_the_tasks(self):
        path = sweep("data", **DATA)
        info = json.loads(self.assert_exit(rodsweep("info", path, "--verify", "--json"), ALL_DONE))
        self.assertEqual((info["kind"], info["guesses"], info["verified"]["damaged"]), ("dataset", [], []))
        rows = json.loads(self.assert_exit(rodsweep("query", path, "--json"), ALL_DONE))
        self.assertEqual([row["scene.segments"] for row in rows], [5, 5, 8, 8])
        with h5py.File(path) as h5:
            self.assertEqual(h5.attrs["kind"], b"dataset")
            self.assertEqual(h5["tasks/first_system"][:].tolist(), [0, 6, 12, 18])
            self.assertEqual(h5["tasks/first_system_segment"][:].tolist(), [0, 30, 60, 108])
            self.assertEqual(h5["systems/step"][:].tolist(), 4 * [0, 1, 2, 3, 4, 5])
            for name, shape in (("segments/position_m", (156, 3)), ("segments/orientation", (156, 4)),
                                ("segments/velocity_m_s", (156, 3)), ("segments/angular_velocity_rad_s", (156, 3)),
                                ("joints/lambda", (132, 6)), ("joints/solution", (132, 6))):
                values = h5["systems"][name]
                self.assertEqual(values.shape, shape)
                self.assertTrue(np.isfinite(values[:]).all())
                self.assertTrue(values.attrs["unit"] and values.attrs["meaning"])
            np.testing.assert_allclose(np.linalg.norm(h5["systems/segments/orientation"][:], axis=1), 1)

    def test_the_plan_says_how_much_is_recorded(self):
        sweep("data", **DATA)
        said = self.assert_exit(rodsweep("plan", "jobs/data.json", "--no-probe"), ALL_DONE)
        self.assertIn("systems  72 at most, of which 24 recorded", said)
        planned = json.loads(rodsweep("plan", "jobs/data.json", "--no-probe", "--json").stdout)["file_bytes"]
        self.assertAlmostEqual(planned, os.path.getsize("results/data.h5"), delta=0.1 * planned)

    def test_a_sweep_is_not_extended_by_a_data_set(self):
        sweep("data", **DATA)
        self.assert_refused(rodsweep("run", "jobs/data.json", "-o", "both.h5", "--extend", sweep()), "jobs/data.json: ")
        self.assertFalse(os.path.exists("both.h5"))


class Output(Case):
    """Standard output that cannot be written."""

    def every_command(self):
        path = sweep()
        yield from ((), ("status", path), ("status", path, "--json"), ("info", path, "--job"), ("info", path, "--verify"),
                    ("plan", "jobs/small.json"), ("validate", "jobs/small.json"), ("schema",),
                    ("--version",), ("--help",), ("run", "--help"))

    def without_reader(self, *words, of="stdout", **options):
        """Where nobody reads what the program prints, as after `| head`."""
        reader, writer = os.pipe()
        os.close(reader)
        try:
            return rodsweep(*words, **{of: writer}, **options)
        finally:
            os.close(writer)

    def test_every_command_says_so_and_fails(self):
        for words in self.every_command():
            with self.subTest(words=words), open("/dev/full", "w", encoding="utf-8") as full:
                said = rodsweep(*words, stdout=full)
                self.assertEqual(said.returncode, OUTPUT_LOST if words else USER_ERROR)
                if words:  # without any the usage is told on stderr
                    self.assertIn("rodsweep: error: writing to standard output failed: No space left on device",
                                  said.stderr)

    def test_the_results_of_a_sweep_are_complete_all_the_same(self):
        sweep()
        hard = {**JOB, "name": "failing", "evaluation": "closed_loop",
                "solve": {"preconditioner": "none", "tolerance": 1e-8, "max_iterations": 2}}
        with open("jobs/failing.json", "w", encoding="utf-8") as file:
            json.dump(hard, file)
        for job, code in (("small", OUTPUT_LOST), ("failing", TASKS_FAILED)):
            for name, options in (("full", {"stdout": open("/dev/full", "w", encoding="utf-8")}),
                                  ("closed", {"stdout": None, "preexec_fn": lambda: os.close(1)})):
                with self.subTest(job=job, stdout=name):
                    path = f"{job}-{name}.h5"
                    said = rodsweep("run", f"jobs/{job}.json", "-o", path, **options)
                    self.assertEqual(said.returncode, code)
                    self.assertIn("writing to standard output failed: ", said.stderr)
                    now = json.loads(self.assert_exit(rodsweep("info", path, "--verify", "--json"), ALL_DONE))
                    self.assertEqual((now["pending"], now["verified"]["damaged"]), (0, []))
                    self.assertEqual(now["starts"][0]["exit_code"], TASKS_FAILED if job == "failing" else ALL_DONE)

    def test_a_reader_that_has_left_ends_it_without_a_word(self):
        for words in (("schema",), ("--help",), ("status", sweep())):
            for inherited in (True, False):  # the signal at its default, and ignored
                with self.subTest(words=words, inherited=inherited):
                    said = self.without_reader(*words, restore_signals=inherited)
                    self.assertEqual((said.returncode, said.stderr), (-signal.SIGPIPE, ""))

    def test_a_sweep_outlives_the_reader_of_its_progress(self):
        sweep()
        said = self.without_reader("run", "jobs/small.json", "-o", "unread.h5", of="stderr")
        self.assertIn("4 tasks: 4 ok", self.assert_exit(said, ALL_DONE))


if __name__ == "__main__":
    unittest.main()
