#!/usr/bin/python3
"""Other programs meddle with the results file of a sweep: they write to it, move it, remove it.

Run by CTest in an empty folder, with RODSWEEP and MPIRUN in the environment.
"""

import os
import subprocess
import sys
import unittest

from program import ALL_DONE, USER_ERROR, SweepCase, long_job, start, wait_for_tasks

NOTE = "import h5py, sys; f = h5py.File(sys.argv[1], 'r+'); f.attrs['note'] = 'mine'; f.close()"


def write_note(path, locking):
    """Another program sets an attribute; returns its exit code."""
    environment = {**os.environ, "HDF5_USE_FILE_LOCKING": "TRUE" if locking else "FALSE"}
    return subprocess.run([sys.executable, "-c", NOTE, path], env=environment, stderr=subprocess.DEVNULL).returncode


class Foreign(SweepCase):
    def begin(self, path):
        process = start(3, "run", long_job(), "-o", path)
        wait_for_tasks(process, path, 4)
        return process

    def end(self, process, code, says=""):
        stdout, stderr = process.communicate(timeout=600)
        self.assertEqual(process.returncode, code, f"{stdout}\n{stderr}")
        self.assertIn(says, stderr)

    def test_a_run_does_not_begin_on_a_file_that_is_open_for_writing(self):
        self.rodsweep(3, "run", long_job(), "-o", "open.h5")
        code = "import h5py; f = h5py.File('open.h5', 'r+'); print(flush=True); input()"
        holder = subprocess.Popen([sys.executable, "-c", code],
                                  stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        holder.stdout.readline()
        self.assert_refused_once(3, "run", long_job(), "-o", "open.h5", "--resume",
                                 says="open.h5 is open for writing in another program")
        holder.communicate(b"\n")
        self.rodsweep(3, "run", long_job(), "-o", "open.h5", "--resume")

    def test_success_is_told_only_of_a_file_that_opens_even_if_a_writer_ignores_locks(self):
        process = self.begin("unlocked.h5")
        write_note("unlocked.h5", locking=False)
        process.communicate(timeout=600)
        opens = subprocess.run(["h5ls", "unlocked.h5"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0
        self.assertEqual(process.returncode, ALL_DONE if opens else USER_ERROR)

    def test_a_file_that_was_moved_or_removed_is_told(self):
        process = self.begin("moved.h5")
        os.rename("moved.h5", "elsewhere.h5")
        self.end(process, USER_ERROR, says="moved.h5 is not the file that this run wrote")
        self.assert_whole("elsewhere.h5")
        process = self.begin("removed.h5")
        os.remove("removed.h5")
        self.end(process, USER_ERROR, says="removed.h5 is not the file that this run wrote")
        self.assertFalse(os.path.exists("removed.h5"))


if __name__ == "__main__":
    unittest.main()
