#!/usr/bin/python3
"""One sweep meets every fault of docs/faults.md that one machine can inject, one after another in one file, and ends with
the bits of an undisturbed run.

Run by CTest in an empty folder, with RODSWEEP, MPIRUN and FAILING_DISK in the environment.
"""

import json
import os
import shutil
import signal
import time
import unittest
import unittest.mock

import h5py
import numpy as np
from program import ALL_DONE, STOPPED, TOO_LONG, USER_ERROR, SweepCase, kill_all, long_job, ranks_of, rodsweep, start
from test_foreign import write_note

FILE, STEPS = "drill.h5", 40


def finished():
    with h5py.File(FILE, locking=False) as file:
        return np.flatnonzero(file["tasks/state"][:] == 1)


def overwrite(path, row, value):
    with h5py.File(FILE, "r+") as file:
        file[path][row] = value


class Drill(SweepCase):
    def setUp(self):
        self.job = long_job("drill", samples=250)

    def interrupted(self, hit, codes, ranks=3):
        """Continues the sweep until a few more tasks are done, calls hit(process), expects one of the exit codes."""
        before = len(finished()) if os.path.exists(FILE) else 0
        process = start(ranks, "run", self.job, "-o", FILE, "--resume")
        while not os.path.exists(FILE) or len(finished()) < before + 4:
            self.assertIsNone(process.poll(), "the sweep is too short for the drill")
            time.sleep(0.005)
        hit(process)
        stdout, stderr = process.communicate(timeout=600)
        self.assertIn(process.returncode, codes, f"{stdout}\n{stderr}")
        return stderr

    def refused(self, *words, says):
        self.assert_refused_once(0, "run", *words, says=says)

    def test_a_sweep_that_meets_every_fault_ends_with_the_bits_of_an_undisturbed_one(self):
        self.rodsweep(3, "run", self.job, "-o", "undisturbed.h5")

        for number in (signal.SIGUSR2, signal.SIGXCPU, signal.SIGHUP, signal.SIGTERM):
            self.interrupted(lambda p: os.kill(ranks_of(p)[1], number), [STOPPED])
        self.interrupted(lambda p: p.send_signal(signal.SIGINT), [STOPPED], ranks=0)
        self.interrupted(kill_all, [-signal.SIGKILL])
        self.interrupted(lambda p: os.kill(ranks_of(p)[2], signal.SIGKILL), [128 + signal.SIGKILL])
        failing = {"LD_PRELOAD": os.environ["FAILING_DISK"], "FAIL_RANK": "2", "FAIL_FILE": os.path.abspath("full")}
        with unittest.mock.patch.dict(os.environ, failing):
            self.interrupted(lambda p: open("full", "w").close(), [STOPPED])

        def meddle(process):
            self.assertNotEqual(write_note(FILE, locking=True), 0)  # another program may not write
            self.refused(self.job, "-o", FILE, "--resume", says="is being written by another run")  # nor a second run
            process.send_signal(signal.SIGUSR1)
        self.interrupted(meddle, [STOPPED])

        def move(process):
            os.rename(FILE, "moved.h5")
            process.send_signal(signal.SIGUSR1)
        self.assertIn("is not the file that this run wrote", self.interrupted(move, [USER_ERROR]))
        os.rename("moved.h5", FILE)

        self.refused(self.job, "-o", FILE, says="exists already")
        with unittest.mock.patch.dict(os.environ, {"PETSC_OPTIONS": "-options_file nowhere"}):
            self.refused(self.job, "-o", FILE, "--resume", says="nowhere")
        self.refused(long_job("other", samples=251), "-o", FILE, "--resume", says="samples was 250 and is 251")
        with open(self.job, encoding="utf-8") as file:
            values = json.load(file)
        with open(self.job, "w", encoding="utf-8", newline="\r\n") as file:  # the same job, written in another way
            json.dump(values, file, indent=7, sort_keys=True)
        self.assertEqual(rodsweep(0, "run", self.job, "-o", FILE, "--resume", "--time-limit", "0.001").returncode, TOO_LONG)

        shutil.copy(FILE, "before.h5")
        first, second = finished()[:2]
        overwrite("tasks/state", first, 7)
        overwrite("steps/joint_gap", STEPS * second, 1e9)
        self.assertEqual(rodsweep(0, "compare", FILE, "before.h5").returncode, USER_ERROR)
        said = self.rodsweep(3, "run", self.job, "-o", FILE, "--resume", code=ALL_DONE).stderr
        self.assertIn("because of a wrong checksum", said)

        self.assert_whole(FILE)
        self.assert_same_results("undisturbed.h5", FILE)


if __name__ == "__main__":
    unittest.main()
