#!/usr/bin/python3
"""Sweeps over three hosts (hosts.py): workers die or hang, hosts are cut off or die.

Run by CTest within alone.sh. Prints recovery times.
"""

import os
import signal
import subprocess
import unittest

from hosts import Hosts
from sweeps import HostSweep, ranks_on, run_undisturbed
from program import ALL_DONE, MPIRUN, RODSWEEP, USER_ERROR, SweepCase, job, status

TIMEOUT_S = 3   # a worker's; the default is two minutes
# TCP's keep-alive reports a dead connection to Open MPI, here within 7 s.
KEEPALIVE = {"time": "4", "intvl": "1", "probes": "3"}


class HostsCase(SweepCase):
    @classmethod
    def setUpClass(cls):
        for name, value in KEEPALIVE.items():
            os.environ["OMPI_MCA_oob_tcp_keepalive_" + name] = value
        cls.hosts = Hosts("hosts")
        cls.job = job("swept", samples=60, segments=(15, 30), steps=40, record={"solves": "all", "norms": "one"})
        run_undisturbed(cls.job, "whole.h5")

    def tearDown(self):
        for host in self.hosts:
            host.die()
            host.up()

    def start(self):
        sweep = HostSweep(self.hosts, self.job, self.id().split(".")[-1] + ".h5", run=("--worker-timeout", str(TIMEOUT_S)))
        self.addCleanup(sweep.kill)
        return sweep

    def assert_done(self, sweep, runs):
        sweep.end()    # mpirun always exits with 0, since ranks may die alone
        self.assert_whole(sweep.path)
        self.assert_same_results("whole.h5", sweep.path)
        self.assertEqual([s["exit_code"] for s in status(sweep.path)["runs"]], runs, sweep.text())

    def assert_continues(self, sweep, fault_s, lost):
        """Waits until the tasks of lost ranks are reassigned."""
        sweep.wait_until("the loss is noticed", lambda: all(sweep.said(f"rank {rank} on .* timed out") for rank in lost))
        seconds = sweep.now() - fault_s
        print(f"{self.id().split('.')[-1]}: reassigned after {seconds:.1f} s", flush=True)
        self.assertLess(seconds, 200, sweep.text())


class Unshared(HostsCase):
    def test_a_host_with_a_folder_of_its_own_is_named(self):
        os.makedirs("results", exist_ok=True)
        self.hosts[2].run("mount", "-t", "tmpfs", "none", os.path.abspath("results"))
        done = subprocess.run([MPIRUN, "--hostfile", self.hosts.file, "--map-by", "node", "--oversubscribe", "-n", "4",
                               RODSWEEP, "run", self.job, "-o", "results/apart.h5"],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, USER_ERROR, done.stderr)
        self.assertIn("results/apart.h5: ranks on h3 do not find there", done.stderr)
        self.assertEqual(os.listdir("results"), [])


class WithinARun(HostsCase):
    """The tasks of lost workers are reassigned within the run."""

    def assert_continues_without_a_worker(self, number):
        sweep = self.start()
        sweep.wait_for_tasks(20)
        rank, pid = max(ranks_on(self.hosts[2]).items())
        os.kill(pid, number)
        self.assert_continues(sweep, sweep.now(), [rank])
        self.assert_done(sweep, [ALL_DONE])

    def test_a_worker_is_killed(self):
        self.assert_continues_without_a_worker(signal.SIGKILL)

    def test_a_worker_hangs(self):
        self.assert_continues_without_a_worker(signal.SIGSTOP)

    def test_a_host_is_cut_off(self):
        sweep = self.start()
        sweep.wait_for_tasks(20)
        lost = list(ranks_on(self.hosts[2]))
        self.hosts[2].cut_off()
        self.assert_continues(sweep, sweep.now(), lost)
        self.assert_done(sweep, [ALL_DONE])


class Resumed(HostsCase):
    """The run ends, and --resume continues."""

    def test_a_host_dies(self):
        sweep = self.start()
        sweep.wait_for_tasks(20)
        self.hosts[2].die()
        sweep.end()
        self.hosts[2].up()
        if status(sweep.path)["pending"]:
            again = HostSweep(self.hosts, self.job, sweep.path, run=("--resume",))
            self.addCleanup(again.kill)
            again.end()
        self.assert_whole(sweep.path)
        self.assert_same_results("whole.h5", sweep.path)


if __name__ == "__main__":
    unittest.main()
