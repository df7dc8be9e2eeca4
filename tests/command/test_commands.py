#!/usr/bin/python3
"""The commands from outside: output, files, refusals. Their exit codes: tests/laws/every_command.py."""

import csv
import io
import os
import re
import signal
import subprocess
import sys
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "analysis"))
import h5py
import numpy as np
from program import ALL_DONE, DATA, DIFFER, OUTPUT_LOST, ROD, RODSWEEP, STOPPED, TASKS_FAILED, Case, changed, \
    rodsweep, sweep, write_job
from rodsweep.reading.sweepfile import SweepFile

LONG = "LONG" in os.environ


def unfinished():
    """The file of a sweep in which only task 0 is done."""
    def clear(h5):
        h5["tasks/state"][1:] = 0
    return changed("part.h5", clear)


class Query(Case):
    """For its options see tests/analysis/test_conditions.py."""

    def test_csv_holds_what_the_file_holds(self):
        words = ("--columns", "task,scene.segments,scene.length_m", "--columns", "cg_ratio.oracle 0.1@1e-3")
        text = self.said("query", sweep(), "--csv", *words, "scene.segments=8")
        rows = list(csv.DictReader(io.StringIO(text)))
        with SweepFile(sweep()) as file:
            tasks = np.flatnonzero(file.parameter("scene.segments").values == 8)
            self.assertEqual([int(row["task"]) for row in rows], list(tasks))
            ratio = file.results("cg_ratio", tasks)[:, 2, file.tolerance_index(1e-3)]
            self.assertEqual([float(row["cg_ratio.oracle 0.1@1e-3"]) for row in rows], list(ratio))
            self.assertEqual([float(row["scene.length_m"]) for row in rows],
                             list(file.parameter("scene.length_m").values[tasks]))
        self.assert_refused(("query", sweep(), "scene.segmant=3"), "did you mean scene.segments?")

    def test_it_reads_while_a_sweep_writes(self):
        path, job = "live.h5", write_job("live", samples=100, time={"step_s": 0.02, "steps": 40})
        writer = subprocess.Popen([RODSWEEP, "run", job, "-o", path], stdin=subprocess.DEVNULL,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        seen = 0
        while writer.poll() is None:
            if os.path.exists(path):
                rows = self.shown("query", path, "state=done")
                self.assertGreaterEqual(len(rows), seen)
                self.assertTrue(all(row["outcome"] == "ok" and row["cg_ratio.previous"] is not None for row in rows))
                seen = len(rows)
            time.sleep(0.02)
        self.assertEqual(writer.returncode, ALL_DONE)


class Rerun(Case):
    def again(self, path, task, output, *words, code=ALL_DONE):
        """Runs the task again; returns what compare says, which exits with `code`."""
        self.said("rerun", path, task, "-o", output, *words)
        return self.said("compare", path, output, code=code)

    def test_a_task_runs_again_identically_with_its_trajectory(self):
        said = self.said("rerun", sweep(), 2)
        line = re.search(r"next: \S+ (compare \S+ \S+)", said).group(1)
        self.assertRegex(self.said(*line.split()), r"results: 1 compared.* 0 differ\n")
        with SweepFile(sweep()) as whole, SweepFile("results/small-task-2.h5") as one:
            self.assertEqual(one.task_count, 1)
            self.assertTrue(one.ok[0])
            self.assertEqual(one.parameter("scene.length_m").values[0], whole.parameter("scene.length_m").values[2])
            np.testing.assert_array_equal(one.results("cg_ratio", [0])[0], whole.results("cg_ratio", [2])[0])
            self.assertFalse(whole.has("/trajectories/position_m"))
            self.assertEqual(one.h5["trajectories/position_m"].shape, (7 * 8, 3))
            np.testing.assert_allclose(one.h5["trajectories/time_s"][0], 0.02 * np.arange(7))
        info = self.shown("info", "results/small-task-2.h5", "--verify")
        self.assertEqual(info["verified"], {"checked": 1, "damaged": []})
        self.assertEqual((info["tasks"], info["rerun_of_task"]), (1, 2))
        script = os.path.join(os.environ["SOURCE_DIR"], "analysis", "summary.py")
        table = subprocess.run(["/usr/bin/python3", script, "results/small-task-2.h5"], check=True, capture_output=True,
                               text=True)
        self.assertIn("1 of 1 tasks ok", table.stdout)

    def test_every_kind_of_sweep_is_reproduced(self):
        oracle = {"oracle": {"error": {"grid": [0.1, 0.3]}, "label": "oracle"}}
        for name, task, changes in (("closed", 5, {"evaluation": "closed_loop"}),
                                    ("direct", 1, {"solve": {"method": "direct"}, "guesses": []}),
                                    ("data", 2, {**DATA, "record": {"systems": "all"}}),
                                    ("summary", 3, {"record": {"solves": "summary"}}),
                                    ("swept", 7, {"guesses": ["zero", oracle]})):
            with self.subTest(name=name):
                path = sweep(name, **changes)
                self.assertIn(" 0 differ", self.again(path, task, name + "-again.h5"))

    def test_frames_of_the_same_times_are_compared(self):
        path = sweep("frames", record={"trajectory_every": 2})
        with h5py.File(path, "r+") as h5:
            row = h5["tasks/first_frame_row"][1] + 3 * h5["tasks/segments"][1]  # in the frame of step 6
            h5["trajectories/position_m"][row, 0] += 1e-12
        said = self.again(path, 1, "second.h5", "--trajectory-every", 2, code=DIFFER)
        self.assertRegex(said, r"/trajectories/position_m +1 +1 +1e-12 +1\n")
        said = self.again(path, 1, "third.h5", "--trajectory-every", 3)
        self.assertRegex(said, r"not compared .*/trajectories \(2 columns\)")

    def test_a_task_that_fails_is_written_and_makes_exit_code_3(self):
        path = sweep("hard", evaluation="closed_loop",
                     solve={"preconditioner": "none", "tolerance": 1e-8, "max_iterations": 2})
        said = self.said("rerun", path, 0, "-o", "hard-again.h5", code=TASKS_FAILED)
        self.assertIn("task 0: iteration_limit", said)
        self.assertIn("0 differ", self.said("compare", path, "hard-again.h5"))

    def test_the_job_comes_from_the_file_and_its_paths_begin_where_it_was(self):
        path = sweep("moved")
        with h5py.File(path) as h5:
            self.assertEqual(h5["runs/job"][0].decode(), os.path.abspath("jobs/moved.json"))
        os.remove("jobs/moved.json")
        os.makedirs("elsewhere", exist_ok=True)
        self.said("rerun", "../" + path, 0, "-o", "moved.h5", cwd="elsewhere")
        self.assertIn(" 0 differ", self.said("compare", path, "elsewhere/moved.h5"))
        with h5py.File("elsewhere/moved.h5") as h5:
            self.assertEqual(h5["runs/job"][0].decode(), os.path.abspath("jobs/moved.json"))

    def test_mistakes_are_refused_and_nothing_is_overwritten(self):
        self.assert_refused(("rerun", sweep(), 4), "no task 4", "0 to 3")
        with open("mine.h5", "w", encoding="utf-8") as file:
            file.write("precious")
        self.assert_refused(("rerun", sweep(), 0, "-o", "mine.h5"), "mine.h5 exists already")
        with open("mine.h5", encoding="utf-8") as file:
            self.assertEqual(file.read(), "precious")
        self.said("rerun", sweep(), 1, "-o", "one.h5")
        self.assert_refused(("rerun", "one.h5", 0), "one.h5 ", "task 1 ", "rodsweep rerun")


class Compressed(Case):
    """A copy by h5repack."""

    def copy(self, path, *filters):
        copy = os.path.basename(path)
        subprocess.run(["h5repack", *filters, path, copy], check=True)
        return copy

    def test_all_readers_take_the_copy_for_the_original(self):
        path = sweep("roomy", samples=10, record={"trajectory_every": 1})
        copy = self.copy(path, "-f", "GZIP=4")
        self.assertLess(os.path.getsize(copy), os.path.getsize(path))
        for words in (("status",), ("info", "--verify")):
            with self.subTest(words=words):
                one, other = (self.shown(words[0], file, *words[1:]) for file in (path, copy))
                self.assertEqual({**one, "file": "", "bytes": 0}, {**other, "file": "", "bytes": 0})
        for words in (("query", "--csv"), ("summary", "--csv"), ("export",)):
            with self.subTest(words=words):
                self.assertEqual(*(self.said(words[0], file, *words[1:]) for file in (path, copy)))
        self.said("rerun", copy, 0, "-o", "rerun.h5")
        self.said("compare", copy, "rerun.h5")
        self.said("merge", copy, "-o", "merged.h5")
        self.said("compare", path, "merged.h5")
        self.assert_refused(("run", "jobs/roomy.json", "-o", copy, "--resume"), "roomy.h5 is a compressed copy (",
                            "h5repack -f NONE -l CONTI")
        subprocess.run(["h5repack", "-f", "NONE", "-l", "CONTI", copy, "again.h5"], check=True)
        self.said("run", "jobs/roomy.json", "-o", "again.h5", "--resume")
        self.said("compare", path, "again.h5")

    @unittest.skipUnless(LONG, "writes 200 MB")
    def test_a_copy_of_100_mb_is_read(self):
        path = sweep("large", scene={**ROD, "segments": 100}, samples=1, solve={"method": "direct"}, guesses=[],
                     time={"step_s": 0.02, "steps": 20_000, "newton_iterations": 1}, record={"trajectory_every": 1})
        copy = self.copy(path, "-f", "SHUF", "-f", "GZIP=1")
        with h5py.File(copy) as h5:
            self.assertGreater(sum(h5["trajectories"][name].nbytes for name in ("position_m", "orientation")), 100e6)
        self.assertEqual(self.shown("info", copy, "--verify")["verified"], {"checked": 1, "damaged": []})
        self.said("summary", copy)
        for file in (path, copy):
            os.remove(file)


class DataSets(Case):
    def test_the_file_says_what_it_is(self):
        path = sweep("data", **DATA)
        info = self.shown("info", path, "--verify")
        self.assertEqual((info["kind"], info["guesses"], info["verified"]["damaged"]), ("dataset", [], []))
        rows = self.shown("query", path)
        self.assertEqual([row["scene.segments"] for row in rows], [5, 5, 8, 8])
        with h5py.File(path) as h5:
            self.assertEqual(h5.attrs["kind"], b"dataset")
            self.assertEqual(h5["systems/step"][:].tolist(), 4 * [0, 1, 2, 3, 4, 5])

    def test_the_plan_says_how_much_is_recorded(self):
        sweep("data", **DATA)
        self.assertRegex(self.said("plan", "jobs/data.json", "--no-probe"), r"systems +72 .*\b24 ")
        planned = self.shown("plan", "jobs/data.json", "--no-probe")["file_bytes"]
        self.assertAlmostEqual(planned, os.path.getsize("results/data.h5"), delta=0.1 * planned)

    def test_a_sweep_is_not_extended_by_a_data_set(self):
        sweep("data", **DATA)
        self.assert_refused(("run", "jobs/data.json", "-o", "both.h5", "--extend", sweep()), "jobs/data.json: ")
        self.assertFalse(os.path.exists("both.h5"))


class Output(Case):
    """Output that is not writable: see tests/laws/every_command.py too."""

    def test_the_results_of_a_sweep_are_complete_all_the_same(self):
        sweep()
        write_job("failing", evaluation="closed_loop",
                  solve={"preconditioner": "none", "tolerance": 1e-8, "max_iterations": 2})
        for job, code in (("small", OUTPUT_LOST), ("failing", TASKS_FAILED)):
            for name, options in (("full", {"stdout": open("/dev/full", "w", encoding="utf-8")}),
                                  ("closed", {"stdout": None, "preexec_fn": lambda: os.close(1)})):
                with self.subTest(job=job, stdout=name):
                    path = f"{job}-{name}.h5"
                    said = rodsweep("run", f"jobs/{job}.json", "-o", path, **options)
                    self.assertEqual(said.returncode, code)
                    self.assertIn("standard output", said.stderr)
                    now = self.shown("info", path, "--verify")
                    self.assertEqual((now["pending"], now["verified"]["damaged"]), (0, []))
                    self.assertEqual(now["runs"][0]["exit_code"], TASKS_FAILED if job == "failing" else ALL_DONE)

    def test_a_sweep_outlives_the_reader_of_its_progress(self):
        sweep()
        reader, writer = os.pipe()
        os.close(reader)
        with open(writer, "wb"):
            said = self.said("run", "jobs/small.json", "-o", "unread.h5", stderr=writer)
        self.assertIn("4 tasks: 4 ok", said)


class Launched(Case):
    """`run -n`, which starts mpirun."""

    def test_its_output_is_that_of_the_run(self):
        job = write_job("crew")
        self.assertIn("4 tasks: 4 ok", self.said("run", job, "-n", 2))
        self.assert_refused(("run", job, "-n", 2), "crew.h5 exists already")
        with open("/dev/full", "w", encoding="utf-8") as full:
            said = self.ran("run", job, "-n", 2, "-o", "full.h5", code=OUTPUT_LOST, stdout=full).stderr
        self.assertIn("standard output failed: No space left on device", said)
        self.assertEqual(self.shown("info", "full.h5", "--verify")["pending"], 0)

    def started(self, name):
        job = write_job(name, samples=1, scene={**ROD, "segments": {"grid": [5, 100]}}, record={"solves": "summary"},
                        time={"step_s": 0.02, "steps": 1_000_000})
        process = subprocess.Popen([RODSWEEP, "run", job, "-n", "2"], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        while not os.path.exists(f"results/{name}.h5") or not self.shown("status", f"results/{name}.h5")["running"]:
            self.assertIsNone(process.poll())
            time.sleep(0.05)
        return process

    def test_mpirun_gets_its_signals_once(self):
        process = self.started("stopped")
        process.send_signal(signal.SIGUSR1)
        self.assertIn("stopped by SIGUSR1", process.communicate(timeout=60)[1])
        self.assertEqual(process.returncode, STOPPED)
        self.assertEqual(self.shown("status", "results/stopped.h5")["runs"][0]["exit_code"], STOPPED)

    def test_ranks_end_with_a_launcher_that_is_killed(self):
        process = self.started("killed")
        process.kill()
        process.communicate(timeout=60)
        while self.shown("status", "results/killed.h5")["being_written"]:
            time.sleep(0.05)


if __name__ == "__main__":
    unittest.main()
