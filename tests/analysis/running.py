"""Scripts of analysis/ as a user runs them, in this process, on planted files: the base of the tests of scripts."""

import contextlib
import importlib
import io
import os
import sys
import tempfile
import types
import unittest
import unittest.mock

import synthetic
from reading import commandline


class Scripts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder, self.path = folder.name, os.path.join(folder.name, "sweep.h5")

    def write(self, **settings):
        settings.setdefault("steps", 2)
        synthetic.Sweep(**settings).write(self.path)

    def run_script(self, name, *arguments, code=0):
        """In this process, as `name` would: a start of Python with its libraries takes a second."""
        script = importlib.import_module(name.removesuffix(".py"))
        out, error, here = io.StringIO(), io.StringIO(), os.getcwd()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error), \
                unittest.mock.patch.object(sys, "argv", [name, *arguments]):
            os.chdir(self.folder)
            left = 0
            try:
                commandline.run(script.main)
            except SystemExit as stop:
                left = stop.code
            finally:
                os.chdir(here)
        self.assertEqual(left, code, error.getvalue())
        return types.SimpleNamespace(stdout=out.getvalue(), stderr=error.getvalue())

    def refused(self, name, *arguments, words):
        error = self.run_script(name, *arguments, code=2).stderr
        self.assertEqual(error.count("\n"), 1, error)
        self.assertTrue(error.startswith(f"{name}: "), error)
        self.assertIn(words, error)
