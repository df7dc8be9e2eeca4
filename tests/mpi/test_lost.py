#!/usr/bin/python3
"""Workers hang or die; the sweep continues without them.

Run by CTest in an empty folder, with RODSWEEP and MPIRUN in the environment.
"""

import os
import signal
import subprocess
import time
import unittest

from program import ALL_DONE, LOST, STOPPED, SweepCase, command, long_job, ranks_of, start, status, wait_for_tasks


class LostCase(SweepCase):
    def setUp(self):
        self.job = long_job("long", 20)
        if not os.path.exists("whole.h5"):
            self.rodsweep(3, "run", self.job, "-o", "whole.h5")

    def end(self, process, code):
        stdout, stderr = process.communicate(timeout=600)
        self.assertEqual(process.returncode, code, f"{stdout}\n{stderr}")
        return stdout, stderr

    def wait_for_end(self, pid):
        deadline = time.monotonic() + 600
        while os.path.exists(f"/proc/{pid}") and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertFalse(os.path.exists(f"/proc/{pid}"))

    def assert_as_undisturbed(self, path, starts):
        self.assert_whole(path)
        self.assert_same_results("whole.h5", path)
        self.assertEqual([s["exit_code"] for s in status(path)["runs"]], starts)


class Silent(LostCase):
    def test_the_sweep_goes_on_without_a_worker_that_hangs(self):
        process = start(4, "run", self.job, "-o", "hung.h5", "--worker-timeout", "1")
        wait_for_tasks(process, "hung.h5", 4)
        ranks = ranks_of(process)
        os.kill(ranks[2], signal.SIGSTOP)
        stdout, stderr = self.end(process, ALL_DONE)
        self.assertEqual(stderr.count("timed out"), 1, stderr)
        self.assertIn("rank 2 on " + os.uname().nodename, stderr)
        self.assertIn("40 ok", stdout)
        self.wait_for_end(ranks[2])
        self.assert_as_undisturbed("hung.h5", [ALL_DONE])

    def test_a_worker_that_continues_after_its_timeout_is_ignored(self):
        path = long_job("longer", 100)
        process = start(3, "run", path, "-o", "back.h5", "--worker-timeout", "0.5")
        wait_for_tasks(process, "back.h5", 4)
        rank = ranks_of(process)[1]
        os.kill(rank, signal.SIGSTOP)
        process.stderr.readline()    # the first line, about the start
        self.assertIn("timed out", process.stderr.readline())
        os.kill(rank, signal.SIGCONT)
        self.end(process, ALL_DONE)
        self.rodsweep(3, "run", path, "-o", "longer-whole.h5")
        self.assert_same_results("longer-whole.h5", "back.h5")

    def test_a_worker_that_hangs_does_not_hold_up_a_stop(self):
        process = start(3, "run", self.job, "-o", "stopped.h5", "--worker-timeout", "2")
        wait_for_tasks(process, "stopped.h5", 4)
        os.kill(ranks_of(process)[2], signal.SIGSTOP)
        process.send_signal(signal.SIGUSR1)
        _, stderr = self.end(process, STOPPED)
        self.assertIn("-o stopped.h5 --resume", stderr)
        self.rodsweep(3, "run", self.job, "-o", "stopped.h5", "--resume")
        self.assert_as_undisturbed("stopped.h5", [STOPPED, ALL_DONE])


class Recovery(LostCase):
    """With Open MPI's orte_enable_recovery a dead rank does not end the others, and mpirun always exits with 0."""

    def start(self, *words):
        return subprocess.Popen(command(4, "run", self.job, *words), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, env={**os.environ, "OMPI_MCA_orte_enable_recovery": "1"})

    def test_the_sweep_goes_on_without_a_worker_that_dies(self):
        process = self.start("-o", "died.h5", "--worker-timeout", "1")
        wait_for_tasks(process, "died.h5", 4)
        os.kill(ranks_of(process)[2], signal.SIGKILL)
        _, stderr = self.end(process, 0)
        self.assertIn("rank 2", stderr)
        self.assert_as_undisturbed("died.h5", [ALL_DONE])

    def test_without_any_worker_it_ends_and_is_resumed(self):
        process = self.start("-o", "alone.h5", "--worker-timeout", "1")
        wait_for_tasks(process, "alone.h5", 4)
        for rank, pid in ranks_of(process).items():
            if rank > 0:
                os.kill(pid, signal.SIGKILL)
        self.end(process, 0)
        self.rodsweep(3, "run", self.job, "-o", "alone.h5", "--resume")
        self.assert_as_undisturbed("alone.h5", [LOST, ALL_DONE])


if __name__ == "__main__":
    unittest.main()
