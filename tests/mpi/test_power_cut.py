#!/usr/bin/python3
"""A power cut in the middle of a sweep: the results' file system is shut down as if the machine had died.

An ext4 on a loop device, shut down without a flush of its journal (EXT4_IOC_SHUTDOWN): unsynced data are lost, in the
order of the kernel's write-back. Then the test mounts it again and continues the sweep. Without root and a loop device
the test is skipped.
"""

import fcntl
import os
import random
import struct
import subprocess
import threading
import time
import unittest

import h5py
from program import ALL_DONE, SweepCase, job, kill_all, rodsweep, start, wait_for_tasks

EXT4_IOC_SHUTDOWN, NO_LOG_FLUSH = 0x8004587D, 2


class Disk:
    """A file system in `folder`."""

    def __init__(self, folder, megabytes=96):
        self.image, self.folder = os.path.abspath(folder + ".img"), os.path.abspath(folder)
        os.makedirs(self.folder, exist_ok=True)
        with open(self.image, "wb") as image:
            image.truncate(megabytes << 20)
        run("mkfs.ext4", "-q", "-F", self.image)
        self.mount()

    def mount(self):
        run("mount", "-o", "loop", self.image, self.folder)

    def unmount(self):
        for _ in range(50):
            if subprocess.run(["umount", self.folder], capture_output=True, check=False).returncode == 0:
                return
            time.sleep(0.1)
        run("umount", "-l", self.folder)

    def cut(self):
        folder = os.open(self.folder, os.O_RDONLY)
        try:
            fcntl.ioctl(folder, EXT4_IOC_SHUTDOWN, struct.pack("I", NO_LOG_FLUSH))
        finally:
            os.close(folder)

    def remove(self):
        self.unmount()
        os.remove(self.image)


def run(*command):
    subprocess.run(command, check=True, capture_output=True)


class PowerCut(SweepCase):
    @classmethod
    def setUpClass(cls):
        try:
            cls.disk = Disk("disk")
        except (subprocess.CalledProcessError, OSError) as error:
            raise unittest.SkipTest(f"no file system of its own to cut off: {error}") from error
        cls.addClassCleanup(cls.disk.remove)
        cls.job = job("cut", samples=40, segments=(10, 20, 30), steps=30)
        assert rodsweep(3, "run", cls.job, "-o", "whole.h5").returncode == ALL_DONE

    def cut_and_go_on(self, seed, tasks):
        path = os.path.join(self.disk.folder, f"cut-{seed}.h5")
        sweep = start(3, "run", self.job, "-o", path)
        wait_for_tasks(sweep, path, tasks)
        # Starts a write-back, so that pages are lost in no order, as on a real machine.
        writing_back = threading.Thread(target=subprocess.run, args=(["sync", "-f", self.disk.folder],),
                                        kwargs={"capture_output": True, "check": False})
        writing_back.start()
        time.sleep(random.Random(seed).uniform(0, 0.01))
        self.disk.cut()
        kill_all(sweep)
        sweep.communicate()
        writing_back.join()
        self.disk.unmount()
        self.disk.mount()
        with h5py.File(path) as file:
            kept = int((file["tasks/state"][:] != 0).sum())
        self.assertGreaterEqual(kept, 1)
        resumed = self.rodsweep(3, "run", self.job, "-o", path, "--resume")
        self.assertNotIn("checksum", resumed.stderr)   # all tasks marked as done are intact
        self.assert_same_results("whole.h5", path)
        os.remove(path)

    def test_what_is_done_survives_and_the_rest_is_run_again(self):
        for seed in range(2):
            with self.subTest(seed=seed):
                self.cut_and_go_on(seed, tasks=10 + 20 * seed)

    def test_a_sweep_that_has_just_ended_is_there_after_a_cut(self):
        path = os.path.join(self.disk.folder, "ended.h5")
        self.rodsweep(3, "run", self.job, "-o", path)
        self.disk.cut()
        self.disk.unmount()
        self.disk.mount()
        self.assert_same_results("whole.h5", path)


if __name__ == "__main__":
    unittest.main()
