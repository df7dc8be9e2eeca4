"""Every script on files of ROWS rows of /solves (default 10^7; RODSWEEP_LARGE_ROWS changes it), in under 500 MB."""

import os
import subprocess
import sys
import tempfile
import time
import unittest

import synthetic

ROWS = int(os.environ.get("RODSWEEP_LARGE_ROWS", 10_000_000))
LIMIT_MB = 500
BY_SIZE = ("--x", "scene.segments", "--y", "tolerance")


class Large(unittest.TestCase):
    def measured(self, *command):
        """Runs a script of analysis/; prints its largest resident memory and checks the bound."""
        begin = time.monotonic()
        with open(os.path.join(self.folder, "out.txt"), "wb") as out:
            process = subprocess.Popen([sys.executable, os.path.join(synthetic.ANALYSIS, command[0]), *command[1:]],
                                       stdout=out, stdin=subprocess.DEVNULL)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        megabytes = usage.ru_maxrss / 1024
        seconds = time.monotonic() - begin
        print(f"{' '.join(command[:1] + command[2:4])}: {megabytes:.0f} MB, {seconds:.0f} s", flush=True)
        self.assertEqual(process.returncode, 0, command)
        self.assertLess(megabytes, LIMIT_MB, command)

    def check(self, scripts, **shape):
        with tempfile.TemporaryDirectory() as self.folder:
            path = synthetic.write_large(os.path.join(self.folder, "large.h5"), **shape)
            for script, *arguments in scripts:
                with self.subTest(script=script, arguments=arguments):
                    self.measured(script, path, *(word.format(folder=self.folder) for word in arguments))

    def test_many_short_tasks(self):
        self.check([("summary.py",), ("report.py",), ("spatial.py",), ("temporal.py",), ("heatmap.py", *BY_SIZE),
                    ("heatmap.py", *BY_SIZE[:2], "--y", "time.step_s", "--measure", "speedup-step"),
                    ("long_term.py",), ("export.py", "--where", "tolerance=1e-2"),
                    ("export.py", "--level", "solves", "--columns", "task,guess,iterations_1e-2", "--where",
                     "newton=0"),
                    ("export.py", "--level", "solves", "-o", "{folder}/solves.csv.gz"),
                    ("export.py", "--level", "steps", "--columns", "task,length_drift")],
                   tasks=ROWS // 600, steps=100, newton=6)

    def test_few_long_tasks_in_a_closed_loop(self):
        self.check([("summary.py",), ("report.py",), ("spatial.py",), ("temporal.py",), ("long_term.py",),
                    ("export.py", "--level", "steps", "--columns", "task,length_drift")],
                   tasks=max(4, ROWS // 120_000 // 4 * 4), steps=20_000, newton=6, closed_loop=True)
