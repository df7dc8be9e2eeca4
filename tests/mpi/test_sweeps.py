#!/usr/bin/python3
"""Sweeps under mpirun, from outside: equal results on any number of ranks, refusals, exits. For interruptions see
test_interruptions.py.

Run by CTest in an empty folder, with RODSWEEP, MPIRUN and FAILING_DISK in the environment.
"""

import json
import os
import signal
import subprocess
import time
import unittest
import unittest.mock

import h5py
import numpy as np
from program import ALL_DONE, MPIRUN, RODSWEEP, TASKS_FAILED, TOO_LONG, USER_ERROR, SweepCase, checksum, data_job, job, \
    kill_all, long_job, ranks_of, rodsweep, start, status, wait_for_tasks


class RankCounts(SweepCase):
    """Closed loops: tests/laws/every_run.py."""

    def test_results_are_the_same_on_1_2_and_5_ranks(self):
        for path in (job(), data_job()):
            self.rodsweep(0, "run", path, "-o", path + "-alone.h5")
            self.assert_whole(path + "-alone.h5")
            for ranks in (1, 2, 5):
                with self.subTest(path=path, ranks=ranks):
                    self.rodsweep(ranks, "run", path, "-o", f"{path}-{ranks}.h5")
                    self.assert_same_results(path + "-alone.h5", f"{path}-{ranks}.h5")


class Killers(SweepCase):
    """A task that kills its worker in every run, as one that exceeds the memory does."""

    def test_a_killer_is_tried_last_then_alone_and_then_named(self):
        # Many short tasks, and a longer one that comes first.
        killer = 100
        path = job("killer", samples=1, segments=[20 + n // 50 for n in range(killer)] + [200], steps=40,
                   record={"solves": "summary", "norms": "one"})
        self.rodsweep(3, "run", path, "-o", "undisturbed.h5")

        before, done, accused = [], [], []
        for attempt in range(3):
            process = start(3, "run", path, "-o", "killer.h5", "--resume")
            before.append(self.kill_who_runs(process, "killer.h5", killer))
            process.communicate(timeout=600)
            with h5py.File("killer.h5") as file:
                starts = file["/timing/tasks/tries"][:]
                self.assertEqual(starts[killer], attempt + 1)
                accused.append(np.flatnonzero(starts))
                done.append(int(file["/tasks/state"][:].sum()))
        self.assertLess(before[0], killer // 2)   # first, while nothing is known of it,
        self.assertGreater(done[1], killer - 10)  # then last, perhaps beside the last of the others,
        self.assertEqual(list(accused[2]), [killer])  # then alone: no other incomplete task has lost a worker

        last = self.rodsweep(3, "run", path, "-o", "killer.h5", "--resume", code=TASKS_FAILED)
        after = status("killer.h5")
        self.assertEqual(after["outcomes"], {"ok": killer, "crashed": 1})
        self.assertEqual([(f["task"], f["outcome"]) for f in after["failures"]], [(killer, "crashed")])
        self.assertRegex(after["failures"][0]["message"], r"\b3\b")  # number of starts
        self.assertIn("--retry-failed", last.stdout)
        self.assert_whole("killer.h5")

        # Without a killer it is a normal task.
        self.rodsweep(3, "run", path, "-o", "killer.h5", "--resume", "--retry-failed")
        self.assert_same_results("undisturbed.h5", "killer.h5")

    def kill_who_runs(self, process, path, task):
        """Waits until a worker starts the task once more, then kills the worker. Returns how many were done before."""
        deadline = time.monotonic() + 600
        before = None
        while time.monotonic() < deadline and process.poll() is None:
            try:
                with h5py.File(path, "r", locking=False) as file:
                    starts, rank = int(file["/timing/tasks/tries"][task]), int(file["/timing/tasks/rank"][task])
                    done = int(file["/tasks/state"][:].sum())
            except OSError:
                starts, rank, done = 0, 0, 0
            if before is None:
                before = starts
            elif starts > before:
                os.kill(ranks_of(process)[rank], signal.SIGKILL)
                return done
            time.sleep(0.01)
        self.fail(f"task {task} was not begun")


class Watching(SweepCase):
    def test_status_tells_a_running_sweep_from_a_dead_one_and_what_runs_where(self):
        path = job("watched", samples=200, segments=(40,), steps=200, record={"solves": "summary"})
        process = start(3, "run", path, "-o", "watched.h5")
        wait_for_tasks(process, "watched.h5", 2)
        now = status("watched.h5")
        self.assertEqual((now["being_written"], now["alive"]), (True, True))
        self.assertLess(now["silent_s"], 30)
        self.assertIn(len(now["running"]), (1, 2))
        self.assertEqual({r["host"] for r in now["running"]}, {os.uname().nodename})
        self.assertLessEqual({r["rank"] for r in now["running"]}, {1, 2})

        watch = start(0, "status", "watched.h5", "--watch", "0.2")
        self.assertTrue(any(" left" in line for line in watch.stdout))    # from the first heartbeat after a task
        self.assertRegex(rodsweep(0, "status", "watched.h5").stdout,
                         r"tasks/s, .* left\n  task \d+ .*, rank [12]\n(.*\n)?run 0: .* \S+ m?s ago\n$")
        self.assertGreater(status("watched.h5")["left_s"], 0)
        kill_all(process)
        process.communicate(timeout=600)
        rest, _ = watch.communicate(timeout=600)  # ends by itself
        self.assertIn("was killed", rest)
        dead = status("watched.h5")
        self.assertEqual((dead["being_written"], dead["alive"], dead["running"]), (False, False, []))
        self.assertEqual((dead["silent_s"], dead["tasks_per_s"], dead["left_s"]), (None, None, None))

    def test_a_run_that_hangs_is_told_by_its_silence(self):
        path = job("hung", samples=200, segments=(40,), steps=200, record={"solves": "summary"})
        process = start(3, "run", path, "-o", "hung.h5")
        wait_for_tasks(process, "hung.h5", 2)
        ranks = ranks_of(process)
        for pid in ranks.values():
            os.kill(pid, signal.SIGSTOP)
        before = time.time() - 200
        os.utime("hung.h5", (before, before))  # the last write was long ago
        said = rodsweep(0, "status", "hung.h5").stdout
        for pid in [process.pid, *ranks.values()]:
            os.kill(pid, signal.SIGKILL)
        process.communicate(timeout=600)
        self.assertRegex(said, r"run 0: .*running.*\b3 min \d\d s\b")


class Refusals(SweepCase):
    """For their words see tests/runner/file/test_file_refusals.cpp."""

    def test_where_there_are_no_locks_a_file_that_is_being_written_is_known_by_its_time(self):
        failing = {"LD_PRELOAD": os.environ["FAILING_DISK"], "FAIL_LOCKS": "1"}
        self.enterContext(unittest.mock.patch.dict(os.environ, failing))
        path = long_job("longer", 200)  # long enough for the second run to see the first one
        first = start(3, "run", path, "-o", "unlocked.h5")
        wait_for_tasks(first, "unlocked.h5", 1)
        self.assert_refused_once(2, "run", path, "-o", "unlocked.h5", "--resume", says="unlocked.h5 seems to be")
        _, stderr = first.communicate(timeout=600)
        self.assertEqual((first.returncode, stderr.count("file system without locks")), (ALL_DONE, 1), stderr)
        with h5py.File("unlocked.h5", "r+") as file:
            file["runs/end"][0] = b""  # as if it was killed
        before = time.time() - 31
        os.utime("unlocked.h5", (before, before))
        self.rodsweep(2, "run", path, "-o", "unlocked.h5", "--resume")

    def test_a_bad_job_is_refused_once_and_nothing_is_created(self):
        path = job("bad", time={"step_s": 0.02, "steps": -4})
        self.assert_refused_once(3, "run", path, "-o", "bad.h5", says="time.steps")
        self.assertFalse(os.path.exists("bad.h5"))


class Outcomes(SweepCase):
    def test_failed_tasks_are_data_and_make_exit_code_3_also_when_resumed(self):
        path = job("hard", evaluation="closed_loop",
                   solve={"method": "cg", "preconditioner": "none", "tolerance": 1e-8, "max_iterations": 2})
        first = self.rodsweep(3, "run", path, code=TASKS_FAILED)
        self.assertIn("iteration_limit", first.stdout)
        self.assertIn("and 19 more", first.stdout)
        self.rodsweep(3, "run", path, "--resume", code=TASKS_FAILED)
        now = status("results/hard.h5")
        self.assertEqual((now["failed"], now["pending"]), (24, 0))
        self.assertEqual([s["exit_code"] for s in now["runs"]], [TASKS_FAILED])

    def test_a_limit_belongs_to_a_start_and_not_to_the_results(self):
        path = job("limited", samples=1, segments=[6, 3000], solve={"reference": "cg"}, guesses=["zero"],
                   time={"step_s": 0.02, "steps": 1, "newton_iterations": 1})
        short = self.rodsweep(2, "run", path, "--task-time-limit", "0.1", code=TASKS_FAILED)
        self.assertIn("0.1 s", short.stdout)
        self.assertEqual(status("results/limited.h5")["outcomes"], {"ok": 1, "timed_out": 1})
        self.rodsweep(2, "run", path, "--resume", "--retry-failed")
        self.rodsweep(2, "run", path, "-o", "unlimited.h5")
        self.assert_same_results("unlimited.h5", "results/limited.h5")

    def test_a_run_that_ends_no_task_in_time_says_what_to_do(self):
        path = job("lengthy", samples=1, segments=[6, 8, 2000], guesses=["zero"], record={"solves": "summary"},
                   time={"step_s": 0.001, "steps": 1000})
        limit = ("--time-limit", "5")    # ten times the time of the short tasks
        first = self.rodsweep(2, "run", path, *limit, code=TOO_LONG)  # the longest task is the first one
        self.assertIn("no task ended within the time limit of 5.0 s", first.stderr)
        self.assertIn("--task-time-limit", first.stderr)
        self.assertIn("time limit", rodsweep(0, "status", "results/lengthy.h5").stdout)
        self.rodsweep(2, "run", path, *limit, "--resume", "--task-time-limit", "1", code=TASKS_FAILED)
        self.assertEqual(status("results/lengthy.h5")["outcomes"], {"ok": 2, "timed_out": 1})

    def test_a_task_beyond_its_share_of_memory_is_an_error_and_no_death(self):
        path = job("large", samples=1, segments=[6, 300000], guesses=["zero"], record={"solves": "summary"},
                   time={"step_s": 0.02, "steps": 1, "newton_iterations": 1})
        bounded = self.rodsweep(2, "run", path, "--memory-limit-gb", "0.6", code=TASKS_FAILED)
        self.assertEqual(status("results/large.h5")["outcomes"], {"ok": 1, "error": 1})
        self.assertIn("600 MB", bounded.stdout)
        refused = self.rodsweep(0, "run", job("tiny"), "--memory-limit-gb", "0.005", code=USER_ERROR)
        self.assertIn("--memory-limit-gb", refused.stderr)

    def test_tasks_whose_results_do_not_fit_into_memory_are_left_out_and_named(self):
        path = job("record", samples=1, segments=[6, 4000], guesses=["zero"],
                   time={"step_s": 0.02, "steps": 2000, "newton_iterations": 1},
                   record={"solves": "summary", "trajectory_every": 1})  # a record of 460 MB that is not written
        bounded = self.rodsweep(2, "run", path, "--memory-limit-gb", "0.3", code=TOO_LONG)
        self.assertRegex(bounded.stderr, r"task 1 .*\b4\d\d MB.*\b2\d\d MB")
        self.assertIn("--resume", bounded.stderr)
        now = status("results/record.h5")
        self.assertEqual((now["outcomes"], now["pending"]), ({"ok": 1}, 1))
        plan = json.loads(rodsweep(0, "plan", path, "--json").stdout)
        self.assertGreater(plan["probes"][-1]["memory_bytes"], 448e6)
        self.assertRegex(rodsweep(0, "plan", path).stdout, r"memory .*\b[45]\d\d MB .*\d+ processes\n")

    def test_more_workers_than_cores_are_warned_of_and_marked(self):
        ranks = len(os.sched_getaffinity(0)) + 2
        crowded = self.rodsweep(ranks, "run", job("crowded"))
        self.assertEqual(crowded.stderr.count("warning"), 1, crowded.stderr)
        self.assertTrue(status("results/crowded.h5")["runs"][0]["oversubscribed"])
        self.rodsweep(2, "run", job("roomy"))
        self.assertFalse(status("results/roomy.h5")["runs"][0]["oversubscribed"])


class Speaking(SweepCase):
    def speak_once(self, *rows):
        for words, text in rows:
            with self.subTest(words=words):
                said = self.rodsweep(3, *words)
                self.assertEqual(said.stdout.count(text), 1, said.stdout)

    def test_commands_that_need_no_ranks_speak_once_under_mpirun(self):
        path = job()
        self.speak_once((("validate", path), "6 tasks"), (("--version",), "Open MPI"), (("plan", path), "core-hours"),
                        (("plan", path, "--no-probe"), "tasks    6"), (("run", "--help"), "Exit codes:"))

    def test_commands_on_files_work_and_speak_once_under_mpirun(self):
        self.rodsweep(2, "run", job("files"))
        path = "results/files.h5"
        self.speak_once((("query", path), "cg_ratio.previous"), (("schema",), '"rodsweep job"'),
                        (("rerun", path, "3"), "task 3: ok"), (("merge", path, "-o", "results/files-all.h5"), "6 of 6"))
        made = sorted(name for name in os.listdir("results") if name.startswith("files"))
        self.assertEqual(made, ["files-all.h5", "files-task-3.h5", "files.h5"])

    def test_results_go_to_stdout_and_progress_to_stderr_without_colours(self):
        ran = self.rodsweep(2, "run", job("said"))
        self.assertIn("6 tasks: 6 ok", ran.stdout)
        self.assertIn("next: ", ran.stdout)
        self.assertNotIn("\x1b", ran.stdout + ran.stderr)
        self.assertNotIn("\r", ran.stderr)


class Apart(SweepCase):
    """A rank that finds another folder at the path of the results: here it starts elsewhere."""

    def run_apart(self, *words):
        os.makedirs("elsewhere", exist_ok=True)
        program = [RODSWEEP, "run", os.path.abspath(job("apart")), *words]
        start = ["sh", "-c", '[ "$OMPI_COMM_WORLD_RANK" != 2 ] || cd elsewhere; exec "$@"', "sh", *program]
        return subprocess.run([MPIRUN, "-n", "3", *start], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              timeout=60, check=False)

    def test_it_is_refused_and_nothing_is_written(self):
        said = self.run_apart("-o", "common/apart.h5")
        self.assertEqual(said.returncode, USER_ERROR, said.stderr)
        self.assertEqual(said.stderr.count("error: "), 1, said.stderr)
        self.assertIn(f"common/apart.h5: ranks on {os.uname().nodename} do not find there", said.stderr)
        self.assertEqual(os.listdir("common"), [])
        self.assertEqual(os.listdir("elsewhere"), [])
        self.rodsweep(2, "run", "apart.json", "-o", "common/apart.h5")
        before = checksum("common/apart.h5")
        self.assertEqual(self.run_apart("-o", "common/apart.h5", "--resume").returncode, USER_ERROR)
        self.assertEqual(checksum("common/apart.h5"), before)
        self.assertEqual(self.run_apart("-o", os.path.abspath("common/both.h5")).returncode, ALL_DONE)


class Alone(SweepCase):
    def test_the_job_comes_back_byte_for_byte(self):
        path = job("kept")
        self.rodsweep(0, "run", path)
        with open(path) as file:
            self.assertEqual(rodsweep(0, "info", "results/kept.h5", "--job").stdout, file.read())

    def test_workers_start_their_own_ranks(self):
        path = job("crew")
        self.rodsweep(0, "run", path, "-o", "alone.h5")
        self.rodsweep(0, "run", path, "-n", "2", "-o", "crew.h5")
        self.assert_same_results("alone.h5", "crew.h5")
        self.assertEqual(status("crew.h5")["runs"][0]["ranks"], 3)
        self.assert_refused_once(2, "run", path, "-o", ".", says=". is a folder: name a file, such as -o ./crew.h5")
        self.assert_refused_once(2, "run", path, "-n", "4", "-o", "more.h5", says="-n 4 needs 5 ranks, but 2 were started")


if __name__ == "__main__":
    unittest.main()
