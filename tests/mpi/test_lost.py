#!/usr/bin/python3
"""Workers that hang or die, and `rodsweep keep`: the sweep goes on, or is begun again, without anybody's help.

Run by CTest in an empty folder, with RODSWEEP and MPIRUN in the environment.
"""

import os
import signal
import subprocess
import time
import types
import unittest

from test_sweeps import ALL_DONE, RODSWEEP, STOPPED, SweepCase, TASKS_FAILED, USER_ERROR, command, job, kill_all, \
    long_job, ranks_of, rodsweep, start, status, wait_for_tasks
from test_training import TrainingCase, train_job


def keep(*words, options=()):
    return subprocess.Popen([RODSWEEP, "keep", *options, "--", *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def start_of(keeper, but=None):
    """The mpirun of its present start, which is not `but`."""
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        with open(f"/proc/{keeper.pid}/task/{keeper.pid}/children") as file:
            for pid in map(int, file.read().split()):
                if pid != but and len(ranks_of(types.SimpleNamespace(pid=pid))) > 1:
                    return types.SimpleNamespace(pid=pid, poll=keeper.poll, communicate=keeper.communicate)
        time.sleep(0.01)
    raise AssertionError("it started nothing")


class LostCase(SweepCase):
    def setUp(self):
        self.job = long_job("long", 20)
        if not os.path.exists("whole.h5"):
            self.assert_exit(rodsweep(3, "run", self.job, "-o", "whole.h5"), ALL_DONE)

    def end(self, process, code):
        stdout, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, code, f"{stdout}\n{stderr}")
        return stdout, stderr

    def wait_for_end(self, pid):
        deadline = time.monotonic() + 20
        while os.path.exists(f"/proc/{pid}") and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertFalse(os.path.exists(f"/proc/{pid}"))

    def assert_as_undisturbed(self, path, starts):
        self.assert_whole(path)
        self.assert_same_results("whole.h5", path)
        self.assertEqual([s["exit_code"] for s in status(path)["starts"]], starts)


class Silent(LostCase):
    def test_the_sweep_goes_on_without_a_worker_that_hangs(self):
        process = start(4, "run", self.job, "-o", "hung.h5", "--worker-timeout", "1")
        wait_for_tasks(process, "hung.h5", 4)
        ranks = ranks_of(process)
        os.kill(ranks[2], signal.SIGSTOP)
        stdout, stderr = self.end(process, ALL_DONE)
        self.assertEqual(stderr.count("was not heard for too long"), 1, stderr)
        self.assertIn("rank 2 on " + os.uname().nodename, stderr)
        self.assertIn("40 ok", stdout)
        self.wait_for_end(ranks[2])
        self.assert_as_undisturbed("hung.h5", [ALL_DONE])

    def test_a_worker_that_comes_back_is_welcome(self):
        path = long_job("longer", 100)
        process = start(3, "run", path, "-o", "back.h5", "--worker-timeout", "0.5")
        wait_for_tasks(process, "back.h5", 4)
        rank = ranks_of(process)[1]
        os.kill(rank, signal.SIGSTOP)
        time.sleep(1)
        os.kill(rank, signal.SIGCONT)
        _, stderr = self.end(process, ALL_DONE)
        self.assertIn("is back", stderr)
        self.assert_exit(rodsweep(3, "run", path, "-o", "longer-whole.h5"), ALL_DONE)
        self.assert_same_results("longer-whole.h5", "back.h5")

    def test_a_worker_that_hangs_does_not_hold_up_a_stop(self):
        process = start(3, "run", self.job, "-o", "stopped.h5", "--worker-timeout", "2")
        wait_for_tasks(process, "stopped.h5", 4)
        os.kill(ranks_of(process)[2], signal.SIGSTOP)
        process.send_signal(signal.SIGUSR1)
        _, stderr = self.end(process, STOPPED)
        self.assertIn("nothing is lost. To continue:", stderr)
        self.assert_exit(rodsweep(3, "run", self.job, "-o", "stopped.h5", "--resume"), ALL_DONE)
        self.assert_as_undisturbed("stopped.h5", [STOPPED, ALL_DONE])


class KeptCase(LostCase):
    def kept(self, path, hit, code=ALL_DONE, ranks=3, words=(), options=("--pause", "0.1")):
        process = keep(*command(ranks, "run", self.job, "-o", path, *words), options=options)
        mpirun = start_of(process)
        wait_for_tasks(mpirun, path, 4)
        hit(mpirun)
        return self.end(process, code)


class KeptWorkers(KeptCase):
    """A kept sweep goes on within its start."""

    def test_a_worker_is_killed_and_the_others_go_on(self):
        _, stderr = self.kept("worker.h5", lambda p: os.kill(ranks_of(p)[2], signal.SIGKILL), ranks=4,
                              words=("--worker-timeout", "1"))
        self.assertIn("rank 2", stderr)
        self.assert_as_undisturbed("worker.h5", [ALL_DONE])

    def test_a_worker_hangs_and_is_ended_with_the_rest(self):
        ranks = {}

        def hang(mpirun):
            ranks.update(ranks_of(mpirun))
            os.kill(ranks[1], signal.SIGSTOP)

        self.kept("hangs.h5", hang, words=("--worker-timeout", "1"))
        self.wait_for_end(ranks[1])
        self.assert_as_undisturbed("hangs.h5", [ALL_DONE])


class KeptKillers(KeptCase):
    """Tasks that end their workers."""

    def test_a_task_that_ends_workers_is_named_in_one_start(self):
        killer = 40
        path = job("killer", samples=1, segments=[20 + n % 7 for n in range(killer)] + [400], steps=40,
                   record={"solves": "summary", "norms": "one"})
        self.assert_exit(rodsweep(3, "run", path, "-o", "undisturbed.h5"), ALL_DONE)
        process = keep(*command(5, "run", path, "-o", "killer.h5", "--worker-timeout", "1"))
        mpirun = start_of(process)
        self.kill_whoever_runs("killer.h5", killer, mpirun, 3)
        stdout, _ = self.end(process, TASKS_FAILED)
        after = status("killer.h5")
        self.assertEqual(after["outcomes"], {"ok": killer, "crashed": 1})
        self.assertEqual([s["exit_code"] for s in after["starts"]], [TASKS_FAILED])
        self.assertIn("each of the 3 times", stdout)
        self.assert_exit(rodsweep(3, "run", path, "-o", "killer.h5", "--resume", "--retry-failed"), ALL_DONE)
        self.assert_same_results("undisturbed.h5", "killer.h5")

    def test_a_task_that_ends_workers_is_named_though_failures_are_tried_again(self):
        path = job("again", samples=1, segments=[20, 21, 22, 400], steps=40, record={"solves": "summary", "norms": "one"})
        self.assert_exit(rodsweep(3, "run", path, "-o", "again.h5", "--task-time-limit", "1e-6"), TASKS_FAILED)
        process = keep(*command(2, "run", path, "-o", "again.h5", "--resume", "--retry-failed", "--worker-timeout", "1"),
                       options=("--pause", "0.1"))
        for start in range(3):
            mpirun = start_of(process, mpirun.pid if start else None)
            self.kill_whoever_runs("again.h5", 3, mpirun, 1)
        self.end(process, TASKS_FAILED)
        self.assertEqual(status("again.h5")["outcomes"], {"ok": 3, "crashed": 1})

    def kill_whoever_runs(self, path, task, mpirun, times):
        killed = []
        deadline = time.monotonic() + 40
        while len(killed) < times and time.monotonic() < deadline:
            time.sleep(0.002)
            if not os.path.exists(path):
                continue
            for running in status(path)["running"]:
                if running["task"] == task and running["rank"] not in killed:
                    os.kill(ranks_of(mpirun)[running["rank"]], signal.SIGKILL)
                    killed.append(running["rank"])
        self.assertEqual(len(killed), times)


class Kept(KeptCase):
    """What keep does of itself. The fault hits in the middle."""

    def test_all_is_killed(self):
        _, stderr = self.kept("all.h5", kill_all)
        self.assertIn("the start ended with signal 9", stderr)
        self.assert_as_undisturbed("all.h5", [None, ALL_DONE])

    def test_the_master_is_killed(self):
        self.kept("master.h5", lambda p: os.kill(ranks_of(p)[0], signal.SIGKILL), options=("--pause", "0.1", "--silence", "7"))
        self.assert_as_undisturbed("master.h5", [None, ALL_DONE])

    def test_everything_hangs(self):
        def stop_all(mpirun):
            for pid in ranks_of(mpirun).values():
                os.kill(pid, signal.SIGSTOP)

        _, stderr = self.kept("hung.h5", stop_all, options=("--pause", "0.1", "--silence", "7"))
        self.assertIn("no sign of life since 7", stderr)
        self.assert_whole("hung.h5")
        self.assert_same_results("whole.h5", "hung.h5")
        # mpirun wakes it by the signal that ends it, and kills it a second later: time to say that it was stopped, or
        # to come to the end of its tasks, or, beside other work, for neither.
        self.assertIn([s["exit_code"] for s in status("hung.h5")["starts"]],
                      ([STOPPED, ALL_DONE], [ALL_DONE], [None, ALL_DONE]))

    def test_a_signal_from_elsewhere_is_followed_by_the_next_start(self):
        self.kept("elsewhere.h5", lambda p: os.kill(ranks_of(p)[2], signal.SIGTERM), ranks=4)
        self.assert_as_undisturbed("elsewhere.h5", [STOPPED, ALL_DONE])

    def test_a_signal_stops_it_and_the_same_line_goes_on(self):
        process = keep(*command(3, "run", self.job, "-o", "signal.h5"))
        wait_for_tasks(start_of(process), "signal.h5", 4)
        process.send_signal(signal.SIGTERM)
        self.end(process, STOPPED)
        self.end(keep(*command(3, "run", self.job, "-o", "signal.h5")), ALL_DONE)
        self.assert_as_undisturbed("signal.h5", [STOPPED, ALL_DONE])

    def test_a_keeper_that_is_killed_takes_its_sweep_along(self):
        process = keep(*command(3, "run", self.job, "-o", "keeper.h5"))
        mpirun = start_of(process)
        wait_for_tasks(mpirun, "keeper.h5", 4)
        process.kill()
        self.wait_for_end(mpirun.pid)
        self.assertEqual(status("keeper.h5")["starts"][0]["exit_code"], STOPPED)
        process.communicate()


class KeptTraining(TrainingCase):
    def setUp(self):
        super().setUp()
        self.job = train_job("long", training={"epochs": 600, "batch": 60, "ratio_every_epochs": 100})
        if not os.path.exists("whole.h5"):
            self.assert_exit(rodsweep(0, "run", self.job, "-o", "whole.h5"), ALL_DONE)

    def hit(self, path, number, options=()):
        """Sends the signal in mid-training, and sees it to its end: what keep said."""
        process = keep(RODSWEEP, "run", self.job, "-o", path, options=("--pause", "0.1", *options))
        deadline = time.monotonic() + 30
        while not os.path.exists(path) and time.monotonic() < deadline:
            time.sleep(0.005)
        with open(f"/proc/{process.pid}/task/{process.pid}/children") as file:
            os.kill(int(file.read().split()[0]), number)
        stdout, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, ALL_DONE, f"{stdout}\n{stderr}")
        self.assert_same_results("whole.h5", path)
        return stderr

    def test_it_goes_on_to_the_same_bits_after_being_killed(self):
        self.hit("kept.h5", signal.SIGKILL)
        self.assertEqual([s["exit_code"] for s in status("kept.h5")["starts"]], [None, ALL_DONE])

    def test_it_goes_on_after_it_hung(self):
        said = self.hit("hung.h5", signal.SIGSTOP, options=("--silence", "0.6"))
        self.assertIn("hung.h5 shows no sign of life since 6.0 s: this start is ended", said)
        self.assertEqual([s["exit_code"] for s in status("hung.h5")["starts"]], [STOPPED, ALL_DONE])


class KeptCommand(LostCase):
    def test_what_can_never_run_is_not_begun_again(self):
        stdout, stderr = self.end(keep(*command(2, "run", job("bad", samples=-1))), USER_ERROR)
        self.assertEqual(stderr.count("samples"), 1, stderr)

    def test_it_gives_up_where_nothing_gets_done(self):
        begin = time.monotonic()
        _, stderr = self.end(keep("sh", "-c", "exit 7", RODSWEEP, "run", self.job, "-o", "vain.h5",
                                  options=("--pause", "0.2", "--vain-starts", "3")), USER_ERROR)
        self.assertIn("3 starts in a row got nothing done, the last one ended with exit code 7", stderr)
        self.assertGreater(time.monotonic() - begin, 0.6)  # 0.2 s, then 0.4 s

    def test_a_sweep_that_still_runs_elsewhere_is_waited_for(self):
        first = start(3, "run", self.job, "-o", "still.h5")
        wait_for_tasks(first, "still.h5", 1)
        _, stderr = self.end(keep(*command(3, "run", self.job, "-o", "still.h5")), ALL_DONE)
        self.assertIn("still.h5 is being written by another run: its end is waited for", stderr)
        self.end(first, ALL_DONE)
        self.assertEqual([s["tasks"] for s in status("still.h5")["starts"]], [40, 0])

    def test_later_starts_have_what_is_left_of_the_time_limit(self):
        with open("run.sh", "w", encoding="ascii") as file:  # begins a sweep twice in vain
            file.write('echo "$*" >>said\n[ "$(wc -l <said)" -lt 3 ] || shift; [ "$1" = -c ] && exit 9; exec "$@"\n')
        self.end(keep("sh", "run.sh", "-c", RODSWEEP, "run", self.job, "-o", "limited.h5", "--time-limit", "50",
                      options=("--pause", "1")), ALL_DONE)
        with open("said", encoding="ascii") as file:
            passed = [int(line.split()[-1]) for line in file]
        self.assertEqual(passed[0], 0)
        self.assertGreaterEqual(passed[2], 3)

    def test_a_launcher_that_is_not_there_is_named_at_once(self):
        _, stderr = self.end(keep("mpirum", "-n", "3", RODSWEEP, "run", self.job), USER_ERROR)
        self.assertIn("mpirum cannot be started: No such file or directory", stderr)
        self.assertEqual(stderr.count("\n"), 1, stderr)

    def test_a_command_without_a_run_is_refused(self):
        _, stderr = self.end(keep("mpirun", "-n", "3", "true"), USER_ERROR)
        self.assertIn("there is no 'rodsweep run JOB' in it", stderr)

    def test_hosts_that_do_not_answer_are_left_out(self):
        with open("agent", "w") as file:  # in ssh's place: knows one host, and runs nothing but `true`
            file.write('#!/bin/sh\n[ "$1" = here ] && [ "$2" = true ] || exit 255\n')
        os.chmod("agent", 0o755)
        with open("hosts", "w") as file:
            file.write("# two hosts\nhere slots=2\nelsewhere slots=2\n")
        os.environ["OMPI_MCA_plm_rsh_agent"] = os.path.abspath("agent")
        self.addCleanup(os.environ.pop, "OMPI_MCA_plm_rsh_agent")
        _, stderr = self.end(keep("sh", "-c", 'cp "$0" seen; shift; exec "$@"', "{hosts}", "x", RODSWEEP, "run", self.job,
                                  "-o", "hosts.h5", options=("--hosts", "hosts")), ALL_DONE)
        self.assertIn("elsewhere does not answer", stderr)
        with open("seen") as file:
            self.assertEqual(file.read(), "here slots=2\n")
        self.assert_same_results("whole.h5", "hosts.h5")


if __name__ == "__main__":
    unittest.main()
