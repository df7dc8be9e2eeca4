#!/usr/bin/python3
"""A table of interruptions that one machine can inject: each hits a sweep in its middle, one after another in one file,
which ends with the bits of an undisturbed run. For power cuts and hosts see test_power_cut.py and tests/cluster.

Run by CTest in an empty folder, with RODSWEEP, MPIRUN and FAILING_DISK in the environment.
"""

import json
import os
import shutil
import signal
import time
import unittest
import unittest.mock
from dataclasses import dataclass, field
from typing import Callable

import h5py
import numpy as np
from program import ALL_DONE, LOST, STOPPED, TOO_LONG, USER_ERROR, SweepCase, data_job, kill_all, long_job, ranks_of, start, \
    status
from test_foreign import write_note

STEPS = 40    # of long_job()
ANY = "any"   # mpirun may kill its ranks before they record the end
FORWARDED = r"mpirun \(SIGTERM\).*--resume"
HIT = 2       # the rank


@dataclass
class Fault:
    hit: Callable               # of the sweep and its process
    code: int = STOPPED         # of the process
    end: int | None = STOPPED   # exit code of the run in the file; None: it did not record its end
    says: tuple = ("-o {path} --resume", )    # patterns of its standard error
    once: str = ""              # what it says there exactly once
    ranks: int = 3
    words: tuple = ()
    environment: dict = field(default_factory=dict)


def to_rank(*numbers, rank=HIT):
    return lambda _, process: [os.kill(ranks_of(process)[rank], number) for number in numbers]


def to_process(*numbers):
    return lambda _, process: [process.send_signal(number) for number in numbers]


def hang_and_stop(_, process):
    os.kill(ranks_of(process)[HIT], signal.SIGSTOP)
    process.send_signal(signal.SIGUSR1)


def hang_and_come_back(_, process):
    rank = ranks_of(process)[HIT]
    os.kill(rank, signal.SIGSTOP)
    while "timed out" not in process.stderr.readline():
        assert process.poll() is None
    os.kill(rank, signal.SIGCONT)
    process.send_signal(signal.SIGUSR1)


def fill_the_disk_for_a_while(*_):
    open("full", "w").close()
    time.sleep(1.5)  # at least one heartbeat
    os.remove("full")


def meddle(case, process):
    """Neither another program nor a second run may write."""
    case.assertNotEqual(write_note(case.path, locking=True), 0)
    case.assert_refused_once(0, "run", case.job, "-o", case.path, "--resume", says="is being written by another run")
    process.send_signal(signal.SIGUSR1)


FAULTS = {
    "a kill of all ranks": Fault(lambda _, process: kill_all(process), -signal.SIGKILL, None, ()),
    "a signal that mpirun forwards": Fault(to_process(signal.SIGUSR1)),
    "another writer": Fault(meddle),
    "a kill of a worker": Fault(to_rank(signal.SIGKILL), 128 + signal.SIGKILL, None, (FORWARDED, )),
    "a full disk": Fault(lambda *_: open("full", "w").close(), end=None, says=("error: rank 2 on", "-o {path} --resume"),
                         once="H5Dwrite failed",
                         environment={"LD_PRELOAD": os.environ["FAILING_DISK"], "FAIL_RANK": str(HIT),
                                      "FAIL_FILE": os.path.abspath("full")}),
    "a signal to the master": Fault(to_rank(signal.SIGTERM, rank=0)),
    **{f"a worker's {number.name}": Fault(to_rank(number)) for number in (
        signal.SIGTERM, signal.SIGUSR1, signal.SIGUSR2, signal.SIGXCPU, signal.SIGHUP)},
    "Ctrl-C without mpirun": Fault(to_process(signal.SIGINT), says=(r"Ctrl-C \(SIGINT\)", "-o {path} --resume"), ranks=0),
    "two signals without mpirun": Fault(to_process(signal.SIGINT, signal.SIGTERM), ranks=0),
    "a stop while a worker hangs": Fault(hang_and_stop, words=("--worker-timeout", "2")),
    "a worker that continues after its timeout": Fault(hang_and_come_back, words=("--worker-timeout", "0.5")),
    **{f"{number.name} to mpirun, which kills soon after": Fault(to_process(number), ANY, ANY, (FORWARDED, ))
       for number in (signal.SIGTERM, signal.SIGINT)},
}


class InterruptedCase(SweepCase):
    def sweep(self, path):
        """Sets the job to interrupt, and runs it once without interruption."""
        self.job, self.path, self.whole = path, path.replace("json", "h5"), path.replace(".json", "-whole.h5")
        self.rodsweep(3, "run", path, "-o", self.whole)

    def finished(self):
        if not os.path.exists(self.path):
            return []
        with h5py.File(self.path, locking=False) as file:
            return np.flatnonzero(file["tasks/state"][:] == 1)

    def interrupt(self, fault):
        """Continues the sweep until a few more tasks are done, hits it, and compares how it ends; returns its output."""
        before = len(self.finished())
        with unittest.mock.patch.dict(os.environ, fault.environment):
            process = start(fault.ranks, "run", self.job, "-o", self.path, "--resume", *fault.words)
        while len(self.finished()) < before + 4:
            self.assertIsNone(process.poll(), "the sweep is too short to be interrupted")
            time.sleep(0.005)
        fault.hit(self, process)
        stdout, stderr = process.communicate(timeout=600)
        self.assertIn(fault.code, (process.returncode, ANY), f"{stdout}\n{stderr}")
        for pattern in fault.says:
            self.assertRegex(stderr, pattern.format(path=self.path))
        if fault.once:
            self.assertEqual(stderr.count(fault.once), 1, stderr)
        run = status(self.path)["runs"][-1]
        self.assertIn(fault.end, (run["exit_code"], ANY))
        self.assertEqual(run["tasks"], len(self.finished()) - before)
        if fault.end == STOPPED:
            self.assertRegex(stdout, r"tasks: \d+ ok, \d+ left")
        return stdout, stderr

    def interrupt_by(self, *names):
        for name in names:
            with self.subTest(fault=name):
                self.interrupt(FAULTS[name])

    def resume(self, ranks=2):
        self.rodsweep(ranks, "run", self.job, "-o", self.path, "--resume")
        self.assert_as_undisturbed()

    def assert_as_undisturbed(self):
        self.assert_whole(self.path)
        self.assert_same_results(self.whole, self.path)


class Interrupted(InterruptedCase):
    def test_a_heartbeat_that_fails_is_a_warning(self):
        self.sweep(long_job("beating", samples=400))
        failing = {**FAULTS["a full disk"].environment, "FAIL_RANK": "0"}
        self.interrupt(Fault(fill_the_disk_for_a_while, ALL_DONE, ALL_DONE, (), "the heartbeat failed: H5Dwrite failed",
                             environment=failing))
        self.assert_as_undisturbed()

    def test_by_some_faults(self):
        self.sweep(long_job("some", samples=60))
        self.interrupt_by("a kill of all ranks", "a signal that mpirun forwards", "another writer")
        self.resume()

    def test_a_data_set(self):
        # Newton iterations that only take time: the file stays small.
        self.sweep(data_job("data", samples=160, segments=(20,), record={"solves": "summary"},
                            time={"step_s": 0.02, "steps": 45, "newton_iterations": 80, "newton_tolerance": 0}))
        self.interrupt_by("a kill of all ranks")
        self.resume()

    def test_by_every_fault_and_mistake(self):
        self.sweep(long_job("every", samples=500))
        self.interrupt_by(*FAULTS)

        again = ("run", self.job, "-o", self.path, "--resume")
        self.assert_refused_once(0, *again[:-1], says="exists already")
        with unittest.mock.patch.dict(os.environ, {"PETSC_OPTIONS": "-options_file nowhere"}):
            self.assert_refused_once(0, *again, says="nowhere")
        other = long_job("other", samples=501)
        self.assert_refused_once(0, "run", other, "-o", self.path, "--resume", says="samples was 500 and is 501")
        with open(self.job, encoding="utf-8") as file:
            values = json.load(file)
        with open(self.job, "w", encoding="utf-8", newline="\r\n") as file:  # the same job, written in another way
            json.dump(values, file, indent=7, sort_keys=True)
        self.rodsweep(0, *again, "--time-limit", "0.001", code=TOO_LONG)

        shutil.copy(self.path, "before.h5")
        first, second = self.finished()[:2]
        with h5py.File(self.path, "r+") as file:
            file["tasks/state"][first] = 7
            file["steps/joint_gap"][STEPS * second] = 1e9
        self.rodsweep(0, "compare", self.path, "before.h5", code=USER_ERROR)
        self.assertIn("because of a wrong checksum", self.rodsweep(3, *again).stderr)
        self.assert_as_undisturbed()


class Lost(InterruptedCase):
    """Workers hang or die; the sweep goes on without them. With Open MPI's orte_enable_recovery a dead rank does not end the
    others, and mpirun of Open MPI 4 always exits with 0."""

    LATE = ("--worker-timeout", "1")
    RECOVERY = {"OMPI_MCA_orte_enable_recovery": "1"}

    def setUp(self):
        self.sweep(long_job(self.id().rpartition(".")[2]))

    def test_the_sweep_goes_on_without_a_worker_that_hangs(self):
        def hang(_, process):
            hung.append(ranks_of(process)[HIT])
            os.kill(hung[0], signal.SIGSTOP)
        hung, host = [], f"rank {HIT} on {os.uname().nodename}"
        stdout, _ = self.interrupt(Fault(hang, ALL_DONE, ALL_DONE, (host, ), "timed out", ranks=4, words=self.LATE))
        self.assertIn("40 ok", stdout)
        deadline = time.monotonic() + 600
        while os.path.exists(f"/proc/{hung[0]}") and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertFalse(os.path.exists(f"/proc/{hung[0]}"))
        self.assert_as_undisturbed()

    def test_the_sweep_goes_on_without_a_worker_that_dies(self):
        self.interrupt(Fault(to_rank(signal.SIGKILL), 0, ALL_DONE, (f"rank {HIT}", ), ranks=4, words=self.LATE,
                             environment=self.RECOVERY))
        self.assert_as_undisturbed()

    def test_without_any_worker_it_ends_and_is_resumed(self):
        def kill_workers(_, process):
            for rank, pid in ranks_of(process).items():
                if rank > 0:
                    os.kill(pid, signal.SIGKILL)
        code = LOST if shutil.which("prterun") else 0    # Open MPI 5 returns the code of the ranks
        self.interrupt(Fault(kill_workers, code, LOST, (), ranks=4, words=self.LATE, environment=self.RECOVERY))
        self.resume(3)


if __name__ == "__main__":
    unittest.main()
