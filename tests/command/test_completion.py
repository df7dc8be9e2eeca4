#!/usr/bin/python3
"""What the Tab key offers in each shell, asked of the shell itself; a shell that is not installed is skipped."""

import os
import pty
import re
import select
import shutil
import signal
import subprocess
import time
import unittest

from program import RODSWEEP, rodsweep


class Completion:
    """The cases for one shell, whose offers(LINE) are the words that it shows for the last one of a line."""

    shell = None
    others = ()  # of the same folder, which it shows behind the files that are meant

    @classmethod
    def setUpClass(cls):
        if not shutil.which(cls.shell):
            raise unittest.SkipTest(f"{cls.shell} is not installed")
        for name in ("demo.json", "demo.h5", "notes.txt"):
            open(name, "w", encoding="utf-8").close()
        os.makedirs("deeper", exist_ok=True)
        cls.script = rodsweep("completion", cls.shell).stdout
        os.environ["PATH"] = os.path.dirname(RODSWEEP) + os.pathsep + os.environ["PATH"]

    def assert_offers(self, line, *words):
        offered = self.offers(line)
        self.assertEqual(sorted(offered), sorted(words), line)

    def test_commands_and_options(self):
        self.assert_offers("rodsweep re", "rerun")
        self.assert_offers("rodsweep --v", "--version")
        self.assert_offers("rodsweep query --c", "--columns", "--csv")
        self.assert_offers("rodsweep info demo.h5 --verify --j", "--job", "--json")
        self.assertIn("query", self.offers("rodsweep "))

    def test_shells(self):
        self.assertLessEqual({"bash", "zsh", "fish"}, set(self.offers("rodsweep completion ")))

    def test_job_files_and_results_files(self):
        for line, wanted, other in (("run de", "demo.json", "demo.h5"), ("status de", "demo.h5", "demo.json"),
                                    ("info --verify de", "demo.h5", "demo.json"),
                                    ("merge demo.h5 de", "demo.h5", "demo.json"),
                                    ("run demo.json -o de", "demo.h5", "demo.json"),
                                    ("run demo.json --extend de", "demo.h5", "demo.json")):
            with self.subTest(line=line):
                self.assert_offers("rodsweep " + line, wanted, "deeper", *({other} & {*self.others}))
        self.assert_offers("rodsweep keep --hosts no", "notes.txt")

    def test_values_that_are_no_files(self):
        self.assert_offers("rodsweep run demo.json --time-limit ")
        self.assert_offers("rodsweep query demo.h5 --sort d")

    def test_a_command_behind_keep(self):
        self.assert_offers("rodsweep keep --si", "--silence")
        self.assertIn("demo.json", self.offers("rodsweep keep --silence 60 -- mpirun -n 3 rodsweep run de"))


class Bash(Completion, unittest.TestCase):
    shell = "bash"

    def offers(self, line):
        ask = self.script + 'COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _rodsweep; printf "%s\\n" "${COMPREPLY[@]}"'
        said = subprocess.run(["bash", "-c", ask, "bash", *line.split(" ")], capture_output=True, text=True, timeout=60)
        self.assertEqual((said.returncode, said.stderr), (0, ""))
        return said.stdout.split()


class Fish(Completion, unittest.TestCase):
    shell = "fish"
    others = ("demo.h5", "demo.json")

    def offers(self, line):
        said = subprocess.run(["fish", "--no-config", "-c", f"{self.script}\ncomplete -C '{line}'"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(said.stderr, "")
        return [offer.split("\t")[0].rstrip("/") for offer in said.stdout.splitlines()]

    def test_descriptions(self):
        said = subprocess.run(["fish", "--no-config", "-c", f"{self.script}\ncomplete -C 'rodsweep info --ver'"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(said.stdout, "--verify\tCompare every finished task with its checksum\n")


class Zsh(Completion, unittest.TestCase):
    """On a terminal of its own, where Tab lists."""

    shell = "zsh"

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        with open("_rodsweep", "w", encoding="utf-8") as file:
            file.write(cls.script)
        cls.process, cls.terminal = pty.fork()
        if cls.process == 0:
            os.environ.update(TERM="dumb", LC_ALL="C.UTF-8")
            os.execlp("zsh", "zsh", "-f", "-i")
        cls.type("PS1='rea''dy>'; unset zle_bracketed_paste; unsetopt prompt_cr prompt_sp; stty cols 200 rows 200; "
                 "fpath=($PWD $fpath); autoload -U compinit; compinit -u -D; bindkey '^I' list-choices; "
                 "print en''d\n")
        cls.read()

    @classmethod
    def tearDownClass(cls):
        os.kill(cls.process, signal.SIGKILL)
        os.waitpid(cls.process, 0)
        os.close(cls.terminal)

    @classmethod
    def type(cls, text):
        os.write(cls.terminal, text.encode())

    @classmethod
    def read(cls):
        """All that is shown up to the next prompt, which is typed for with `print en''d`."""
        shown, until = b"", time.monotonic() + 30
        while not shown.endswith(b"end\r\nready>"):
            if not select.select([cls.terminal], [], [], max(0, until - time.monotonic()))[0]:
                raise AssertionError(f"zsh says nothing more: {shown!r}")
            shown += os.read(cls.terminal, 65536)
        return shown.decode()

    def shown(self, line):
        """The list under the line."""
        self.type(f"{line}\t\x15print en''d\n")
        rows = self.read().split("\r\nready>")[0].split("\r\n")
        return [row.strip() for row in rows[1:]] if len(rows) > 1 else []

    def offers(self, line):
        return [word.rstrip("/") for row in self.shown(line) if row != "end"
                for word in re.split(" +-- ", row)[0].split()]

    def test_descriptions(self):
        self.assertEqual(self.shown("rodsweep info --ver"), ["--verify  -- Compare every finished task with its checksum"])


if __name__ == "__main__":
    unittest.main()
