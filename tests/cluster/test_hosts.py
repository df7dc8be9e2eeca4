#!/usr/bin/python3
"""Sweeps over three hosts (hosts.py) under `rodsweep keep --hosts`: workers that die or hang, hosts that are cut off or die.

Run by CTest within alone.sh. It prints how long recovery took: docs/faults.md has the times of one run.
"""

import os
import signal
import time
import unittest

from hosts import Hosts
from sweeps import KeptSweep, ranks_on, run_undisturbed
from test_sweeps import ALL_DONE, SweepCase, job, status

TIMEOUT_S = 3   # of a worker; two minutes unless told
SILENCE_S = 15  # of a whole sweep; five minutes unless told
# Open MPI looks after its own connections: `keep` has it find a dead one within 40 s, here it is to take 7.
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
        sweep = KeptSweep(self.hosts, self.job, self.id().split(".")[-1] + ".h5", run=("--worker-timeout", str(TIMEOUT_S)),
                          keep=("--pause", "0.2", "--silence", str(SILENCE_S)))
        self.addCleanup(sweep.kill)
        return sweep

    def assert_done(self, sweep, starts):
        self.assertEqual(sweep.end(), ALL_DONE, sweep.text())
        self.assert_whole(sweep.path)
        self.assert_same_results("whole.h5", sweep.path)
        self.assertEqual([s["exit_code"] for s in status(sweep.path)["starts"]], starts, sweep.text())

    def assert_goes_on(self, sweep, fault_s, lost=()):
        """What was lost with the fault at that time is in others' hands, or the next start has it."""
        def given_to_others():
            return lost and all(sweep.said(f"rank {rank} on .* was not heard") for rank in lost)

        sweep.wait_until("the loss is noticed", lambda: given_to_others() or sweep.said("are left to do", fault_s))
        seconds = sweep.now() - fault_s
        print(f"{self.id().split('.')[-1]}: {'others have' if given_to_others() else 'another start has'} it after {seconds:.1f} s",
              flush=True)
        self.assertLess(seconds, 200, sweep.text())


class WithinAStart(HostsCase):
    """What is lost is done by others, without another start."""

    def assert_goes_on_without_a_worker(self, number):
        sweep = self.start()
        sweep.wait_for_tasks(20)
        rank, pid = max(ranks_on(self.hosts[2]).items())
        os.kill(pid, number)
        self.assert_goes_on(sweep, sweep.now(), [rank])
        self.assert_done(sweep, [ALL_DONE])

    def test_a_worker_is_killed(self):
        self.assert_goes_on_without_a_worker(signal.SIGKILL)

    def test_a_worker_hangs(self):
        self.assert_goes_on_without_a_worker(signal.SIGSTOP)

    def test_a_host_is_cut_off(self):
        sweep = self.start()
        sweep.wait_for_tasks(20)
        lost = list(ranks_on(self.hosts[2]))
        self.hosts[2].cut_off()
        self.assert_goes_on(sweep, sweep.now(), lost)
        self.assert_done(sweep, [ALL_DONE])


class NextStart(HostsCase):
    """Another start does what is left."""

    def test_a_host_dies(self):
        sweep = self.start()
        sweep.wait_for_tasks(20)
        self.hosts[2].die()
        self.assert_goes_on(sweep, sweep.now())
        self.assert_done(sweep, [None, ALL_DONE])

    def test_the_masters_host_dies(self):
        sweep = self.start()
        sweep.wait_for_tasks(20)
        self.hosts[0].die()
        self.assert_goes_on(sweep, sweep.now())
        self.assertIsNotNone(sweep.said("h1 does not answer: this start does without it"), sweep.text())
        self.assert_done(sweep, [None, ALL_DONE])

    def test_the_masters_host_is_cut_off(self):
        # Its files are everybody's here, and its own workers go on. On NFS it would hang, as where it dies.
        sweep = self.start()
        sweep.wait_for_tasks(20)
        self.hosts[0].cut_off()
        self.assertEqual(sweep.end(), ALL_DONE, sweep.text())
        self.assert_whole(sweep.path)
        self.assert_same_results("whole.h5", sweep.path)

    def test_a_host_that_does_not_answer_is_left_out_until_it_does(self):
        self.hosts[2].cut_off()
        sweep = self.start()
        sweep.wait_for_tasks(20)
        self.assertIsNotNone(sweep.said("h3 does not answer: this start does without it"), sweep.text())
        self.hosts[2].reconnect()
        os.kill(ranks_on(self.hosts[0])[0], signal.SIGKILL)
        self.assert_goes_on(sweep, sweep.now())
        self.assert_done(sweep, [None, ALL_DONE])
        self.assertEqual([s["host"] for s in status(sweep.path)["starts"]], ["h1 h2", "h1 h2 h3"])

    def test_all_hosts_are_out_of_reach_for_a_while(self):
        for host in self.hosts:
            host.cut_off()
        sweep = self.start()
        sweep.wait_until("nobody answers", lambda: sweep.said("none of the hosts of .* answers"))
        for host in self.hosts:
            host.reconnect()
        self.assert_done(sweep, [ALL_DONE])

    def test_status_tells_from_elsewhere_what_runs_on_which_host(self):
        sweep = self.start()
        sweep.wait_for_tasks(20)
        now = status(sweep.path)
        self.assertIs(now["being_written"], True)
        self.assertLessEqual({r["host"] for r in now["running"]}, {"h1", "h2", "h3"})
        self.assertGreaterEqual(len({r["host"] for r in now["running"]}), 2, now["running"])
        sweep.process.kill()  # the sweep stops as on a signal
        sweep.process.wait()
        deadline = time.monotonic() + 60
        while status(sweep.path)["being_written"] and time.monotonic() < deadline:
            time.sleep(0.5)
        dead = status(sweep.path)
        self.assertEqual((dead["being_written"], dead["running"]), (False, []))


if __name__ == "__main__":
    unittest.main()
