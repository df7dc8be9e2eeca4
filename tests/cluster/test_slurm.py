#!/usr/bin/python3
"""jobs/slurm/sweep.sbatch under a real Slurm with two nodes (slurm.py): normal end, time limits, killed workers,
scancel, lost nodes. Results have the same bits as those of an undisturbed run.

Run by CTest within alone.sh. Prints recovery times.
"""

import glob
import os
import signal
import subprocess
import time
import unittest

from slurm import Slurm, wait_until
from sweeps import processes_on, ranks_on, run_undisturbed, states
from program import ALL_DONE, SweepCase, TASKS_FAILED, TOO_LONG, job, status

SCRIPT = os.path.join(os.environ["SOURCE_DIR"], "jobs", "slurm", "sweep.sbatch")


class SlurmCase(SweepCase):
    @classmethod
    def setUpClass(cls):
        cls.slurm = Slurm("slurm")
        cls.job = job("swept", samples=150, segments=(15, 30), steps=40, record={"solves": "all", "norms": "one"})
        run_undisturbed(cls.job, "whole.h5")

    def setUp(self):
        self.name = self.id().split(".")[-1]
        self.path = self.name + ".h5"

    def submit(self, *words, options=(), job_file=None):
        log = self.name + ("-%a.log" if any("--array" in option for option in options) else ".log")
        return self.slurm.submit("--ntasks=2", "--nodes=1", "--time=20", "--output=" + log, *options, SCRIPT,
                                 job_file or self.job, *(words or (self.path,)))

    def log(self):
        with open(self.name + ".log", encoding="utf-8", errors="replace") as file:
            return file.read()

    def done(self, path=None):
        found = states(path or self.path)
        return 0 if found is None else int(found.sum())

    def wait_for_tasks(self, count, seconds=120):
        wait_until(f"{count} tasks", seconds, lambda: self.done() >= count)

    def wait_for_end(self, number, state="COMPLETED", seconds=300):
        ended = ("COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL")
        # A job that requeues itself is COMPLETED or FAILED for a moment.
        wait_until(f"job {number} to end", seconds, lambda: self.slurm.job(number)["JobState"] in ended
                   and (time.sleep(2) or self.slurm.job(number)["JobState"] in ended))
        found = self.slurm.job(number)
        self.assertEqual(found["JobState"], state, f"{found}\n{self.log()}")
        return found

    def host_of(self, number):
        name = self.slurm.job(number)["NodeList"]
        return next(host for host in self.slurm.hosts if host.name == name)

    def assert_as_undisturbed(self):
        self.assert_whole(self.path)
        self.assert_same_results("whole.h5", self.path)

    def tell(self, text):
        print(f"{self.name}: {text}", flush=True)


class Slurmed(SlurmCase):
    def test_a_sweep_runs_to_its_end(self):
        self.wait_for_end(self.submit())
        self.assert_as_undisturbed()
        self.assertEqual([s["exit_code"] for s in status(self.path)["runs"]], [ALL_DONE])
        self.assertIn("--time-limit", status(self.path)["runs"][0]["command"])

    def test_a_killed_worker_has_the_run_repeated(self):
        number = self.submit()
        self.wait_for_tasks(20)
        os.kill(max(ranks_on(self.host_of(number)).items())[1], signal.SIGKILL)
        self.wait_for_end(number)
        self.assertIn("sweep.sbatch: the run ended with code 137", self.log())
        self.assert_as_undisturbed()
        self.assertEqual([s["exit_code"] for s in status(self.path)["runs"]], [None, ALL_DONE])

    def test_a_cancelled_job_goes_on_when_it_is_submitted_again(self):
        number = self.submit()
        self.wait_for_tasks(20)
        subprocess.run(["scancel", number], check=True)
        self.wait_for_end(number, "CANCELLED")
        before = self.done()
        self.assertGreaterEqual(before, 20)
        self.assertLess(before, 300)
        self.wait_for_end(self.submit())
        self.assert_as_undisturbed()
        self.assertEqual(status(self.path)["runs"][-1]["tasks"], 300 - before)

    def test_an_array_makes_shards_that_merge_into_what_a_single_run_writes(self):
        number = self.submit(self.path, options=("--array=1-3", "--ntasks=1"))
        wait_until("three shards", 300, lambda: sum(self.done(p) for p in glob.glob(self.name + "-*of3.h5")) == 300)
        queue = ["squeue", "-h", "-j", number]
        wait_until("an empty queue", 60,
                   lambda: not subprocess.run(queue, capture_output=True, text=True, check=False).stdout)
        shards = sorted(glob.glob(self.name + "-*of3.h5"))
        self.assertEqual(len(shards), 3)
        self.rodsweep(0, "merge", *shards, "-o", self.path)
        self.assert_as_undisturbed()


class TimeLimits(SlurmCase):
    """One minute is Slurm's shortest limit. A sweep stops STOP_S before it."""

    def submit_short(self, *words, stop_s, **others):
        os.environ["RODSWEEP_STOP_S"] = str(stop_s)
        self.addCleanup(os.environ.pop, "RODSWEEP_STOP_S", None)
        return self.submit(*words, options=("--time=1", "--signal=B:USR1@5"), **others)

    def test_a_job_stops_before_its_limit_and_requeues_itself_until_all_is_done(self):
        path = job("longer", samples=600, segments=(15, 30), steps=40, record={"solves": "summary", "norms": "one"})
        run_undisturbed(path, "longer-whole.h5")
        number = self.submit_short(self.path, stop_s=45, job_file=path)
        found = self.wait_for_end(number, seconds=800)
        starts = status(self.path)["runs"]
        self.assertGreaterEqual(int(found["Restarts"]), 1, self.log())
        self.assertEqual([s["exit_code"] for s in starts], [4] * int(found["Restarts"]) + [ALL_DONE])
        self.assertEqual(self.log().count("left to do\n"), int(found["Restarts"]), self.log())
        self.assert_whole(self.path)
        self.assert_same_results("longer-whole.h5", self.path)
        self.tell(f"{found['Restarts']} restarts")

    def test_tasks_longer_than_the_limit_end_the_job(self):
        path = job("lengthy", samples=1, segments=[10, 12, 14, 800], guesses=["zero"], record={"solves": "summary"},
                   time={"step_s": 0.001, "steps": 3000})
        number = self.submit_short(self.path, stop_s=30, job_file=path)
        found = self.wait_for_end(number, "FAILED", seconds=400)
        self.assertEqual(found["ExitCode"], f"{TOO_LONG}:0")
        self.assertIn("no task ended within the time limit", self.log())
        self.assertEqual(self.done(), 3)
        self.assertLessEqual(len(status(self.path)["runs"]), 3)
        self.tell(f"{len(status(self.path)['runs'])} runs of 30 s until it said so")

        number = self.submit_short(self.path, "--task-time-limit", "3", stop_s=30, job_file=path)
        self.assertEqual(self.wait_for_end(number, "FAILED")["ExitCode"], f"{TASKS_FAILED}:0")
        self.assertEqual(status(self.path)["outcomes"], {"ok": 3, "timed_out": 1})


class Nodes(SlurmCase):
    def test_a_node_that_dies_has_its_job_go_on_elsewhere(self):
        number = self.submit()
        self.wait_for_tasks(20)
        host = self.host_of(number)
        host.die()
        begin, before = time.monotonic(), self.done()
        self.wait_for_tasks(before + 1)
        self.tell(f"work again after {time.monotonic() - begin:.1f} s")
        self.wait_for_end(number)
        self.assert_as_undisturbed()
        starts = status(self.path)["runs"]
        self.assertEqual([s["exit_code"] for s in starts], [None, ALL_DONE])
        self.assertEqual(starts[0]["host"], host.name)
        self.assertNotEqual(starts[1]["host"], host.name)
        host.up()
        self.slurm.start_node(host)

    def test_a_node_that_is_given_up_and_works_on_is_waited_for(self):
        longer = job("longer", samples=900, segments=(15, 30), steps=40, record={"solves": "all", "norms": "one"})
        run_undisturbed(longer, "longer.h5")
        number = self.submit(job_file=longer)  # long enough to run until the job restarts
        self.wait_for_tasks(20)
        host = self.host_of(number)
        for pid in processes_on(host, "slurmd"):  # else slurmd may end its job before the restart looks
            os.kill(pid, signal.SIGSTOP)
            self.addCleanup(os.kill, pid, signal.SIGCONT)
        subprocess.run(["scontrol", "update", "NodeName=" + host.name, "State=DOWN", "Reason=test"], check=True)
        self.wait_for_end(number)
        self.assertIn("is being written by another run", self.log())
        self.assertIn("sweep.sbatch: the run ended with code 2", self.log())
        self.assert_whole(self.path)
        self.assert_same_results("longer.h5", self.path)


if __name__ == "__main__":
    unittest.main()
