"""jobs/studies.py: lists and runs studies; its commands exist."""

import contextlib
import io
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "jobs"))
import studies  # noqa: E402


class Studies(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        self.folder = Path(folder.name)
        (self.folder / "bin").mkdir()
        self.write_program("echo \"$*\" >>log; exit $(cat code)")
        self.write_code(0)

    def write_program(self, text):
        program = self.folder / "bin" / "rodsweep"
        program.write_text("#!/bin/sh\n" + text)
        program.chmod(0o755)

    def write_code(self, code):
        (self.folder / "code").write_text(str(code))

    def main(self, *words):
        """What is printed, and the message of the end if it is an error."""
        steps = studies.run("smoke") + ["echo made >table"]
        printed = io.StringIO()
        with mock.patch.multiple(studies, ROOT=self.folder, ALL={"small": studies.Study("how much", "1 s", steps)}), \
                mock.patch.object(sys, "argv", ["studies.py", *words]), contextlib.redirect_stdout(printed):
            try:
                studies.main()
            except SystemExit as end:
                return printed.getvalue(), end.code
        return printed.getvalue(), 0

    def test_a_study_runs_its_jobs_and_draws(self):
        self.assertEqual(self.main("small", "--build", "bin"), ("", 0))
        self.assertEqual((self.folder / "log").read_text(),
                         f"run jobs/smoke.json -n {len(os.sched_getaffinity(0))} -o results/smoke.h5 --resume\n")
        self.assertEqual((self.folder / "table").read_text(), "made\n")

    def test_failed_tasks_are_in_the_tables_and_other_failures_stop(self):
        self.write_code(studies.SOME_FAILED)
        self.assertEqual(self.main("small", "--build", "bin")[1], 0)
        (self.folder / "table").unlink()
        self.write_code(4)
        self.assertEqual(self.main("small", "--build", "bin")[1], "studies.py: exit code 4, the next call continues here:\n"
                         "  rodsweep run jobs/smoke.json -n $(nproc) -o results/smoke.h5 --resume")
        self.assertFalse((self.folder / "table").exists())

    def test_a_missing_program_is_named(self):
        self.assertEqual(self.main("small")[1], "studies.py: there is no build/rodsweep: run `make build`")

    def test_a_study_whose_jobs_read_results_keeps_to_that_folder(self):
        for name, refused in (("temporal", True), ("variants", True), ("score", True), ("integrators", False)):
            with mock.patch.object(sys, "argv", ["studies.py", name, "--results", "x", "--dry-run"]), \
                    contextlib.redirect_stdout(io.StringIO()):
                if refused:
                    with self.assertRaisesRegex(SystemExit, f"{name} needs results/ of this folder: leave out --results"):
                        studies.main()
                else:
                    studies.main()

    def test_a_dry_run_prints_the_commands(self):
        printed, code = self.main("small", "--dry-run")
        self.assertEqual((printed.splitlines()[1], code), ("echo made >table", 0))
        self.assertFalse((self.folder / "log").exists())

    def test_without_names_and_in_the_help_is_the_list(self):
        for words in ((), ("--help",)):
            said = subprocess.run([ROOT / "jobs" / "studies.py", *words], capture_output=True, text=True, check=True).stdout
            for name, study in (studies.STUDIES | studies.OTHERS).items():
                self.assertRegex(said, rf"(?m)^  {name} +{re.escape(study.question)} \({re.escape(study.time)}\)$")

    def test_unknown_names_are_refused_with_the_nearest(self):
        for name, near in (("spacial", "spatial"), ("scores", "score"),
                           ("knot", "contact"), ("learned_rods_length", "learned_rods")):
            with self.assertRaises(SystemExit) as refused:
                studies.wanted(name)
            self.assertIn(f"unknown study '{name}': did you mean '{near}'?\nIt may be all, spatial, ", refused.exception.code)

    def test_every_command_has_a_script_that_knows_its_options(self):
        commands = [part for study in studies.ALL.values() for step in study.steps for part in re.split(r"\|+", step)]
        options = {}
        for command in commands:
            words = command.split()
            if words[0].startswith("analysis/"):
                options.setdefault(words[0], set()).update(word for word in words if word.startswith("--"))
        self.assertGreater(len(options), 10)
        for script, used in options.items():
            self.assertTrue(os.access(ROOT / script, os.X_OK), script)
            if used:
                told = subprocess.run([ROOT / script, "--help"], capture_output=True, text=True, check=True).stdout
                self.assertEqual(used - set(re.findall(r"--[\w-]+", told)), set(), script)
