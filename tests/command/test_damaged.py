#!/usr/bin/python3
"""The commands on damaged files and after a killed program: plain errors, never a signal."""

import os
import random
import socket
import subprocess
import unittest

from program import ALL_DONE, DAMAGED, STOPPED, TASKS_FAILED, USER_ERROR, changed, rodsweep, sweep

JOB = os.path.join("jobs", "small.json")


def contents_of(path):
    with open(path, "rb") as file:
        return file.read()


def write(path, contents):
    with open(path, "wb") as file:
        file.write(contents)
    return path


class Plain(unittest.TestCase):
    def assert_plain(self, said, *codes):
        self.assertIn(said.returncode, codes, said.stderr)
        for word in ("std::", "json.exception", "bad_alloc", "Traceback"):
            self.assertNotIn(word, said.stderr)
        if said.returncode == USER_ERROR:
            self.assertRegex(said.stderr, r"error: |^query\.py: ")


class Damaged(Plain):
    def flipped(self, draw, most, *words):
        """Runs a command on a copy of a sweep's file with one bit flipped among the first `most` bytes."""
        contents = bytearray(contents_of(sweep()))
        contents[draw.randrange(most or len(contents))] ^= 1 << draw.randrange(8)
        write("flipped.h5", contents)
        said = rodsweep(*words)
        if os.path.exists("new.h5"):
            os.remove("new.h5")
        return said

    def test_flipped_bits_end_no_command(self):
        draw = random.Random(3)
        commands = (("status",), ("info", "--verify"), ("query", "--csv"), ("merge", "-o", "new.h5"))
        for number in range(24):
            command, *rest = commands[number % len(commands)]
            with self.subTest(number=number, command=command):
                said = self.flipped(draw, 12000 if number % 2 else 0, command, "flipped.h5", *rest)
                self.assert_plain(said, ALL_DONE, USER_ERROR, DAMAGED)

    def test_commands_that_write_refuse_a_file_or_do_what_is_left(self):
        draw = random.Random(4)
        commands = (("run", JOB, "-o", "flipped.h5", "--resume"), ("rerun", "flipped.h5", 0, "-o", "new.h5"),
                    ("merge", "flipped.h5", "-o", "new.h5"), ("run", JOB, "-o", "new.h5", "--extend", "flipped.h5"))
        for number in range(12):
            words = commands[number % len(commands)]
            with self.subTest(number=number, words=words):
                self.assert_plain(self.flipped(draw, 12000, *words), ALL_DONE, USER_ERROR, TASKS_FAILED, STOPPED)

    def test_a_parameter_that_is_not_the_jobs_is_found(self):
        self.assertIn("parameters", rodsweep("info", sweep(), "--verify").stdout)
        for column, value in (("tasks/parameters/scene.segments", 7), ("tasks/first_solve", 1), ("axes/tolerance", 0.3)):
            def change(h5):
                h5[column][1] = value
            with self.subTest(column=column):
                said = rodsweep("info", changed("changed.h5", change), "--verify")
                self.assert_plain(said, USER_ERROR)
                self.assertIn("changed.h5", said.stderr)

    def test_data_that_are_not_what_was_written_come_with_what_to_do(self):
        def change(h5):
            h5["steps/joint_gap"][0] = 0.5
        said = rodsweep("info", changed("changed.h5", change), "--verify")
        self.assert_plain(said, DAMAGED)
        self.assertRegex(said.stderr, r"\btask 0\b.*--resume")
        self.assert_plain(rodsweep("run", JOB, "-o", "changed.h5", "--resume"), ALL_DONE)
        self.assertEqual(rodsweep("info", "changed.h5", "--verify").returncode, ALL_DONE)


class Left(Plain):
    """X.h5.unfinished-HOST-PROCESS-RANDOM, left by a program that was killed while it wrote X.h5."""

    def test_what_a_killed_program_left_is_named(self):
        ended = subprocess.Popen(["true"])
        ended.wait()
        name = f"left.h5.unfinished-{socket.gethostname()}-{ended.pid}-0123abcd"
        write(name, b"half")
        said = rodsweep("status", "left.h5")
        self.assert_plain(said, USER_ERROR)
        self.assertRegex(said.stderr, f"left.h5: file not found; .*{name}")
        sweep()
        self.assertIn(name, rodsweep("run", JOB, "-o", "left.h5").stderr)
        self.assertIn(name, rodsweep("status", "left.h5").stderr)
        os.remove(name)
        self.assertNotIn("unfinished", rodsweep("status", "left.h5").stderr)

    def test_what_a_program_makes_now_is_not(self):
        write(f"made.h5.unfinished-{socket.gethostname()}-{os.getpid()}-0123abcd", b"half")
        self.assertNotIn("unfinished", rodsweep("status", "made.h5").stderr)
        write("made.h5.unfinished-elsewhere-1-0123abcd", b"half")
        self.assertIn("made.h5.unfinished-elsewhere-1-0123abcd", rodsweep("status", "made.h5").stderr)


if __name__ == "__main__":
    unittest.main()
