"""Base classes for tests of analysis/: planted files in a temporary folder, and scripts run on them as by a user."""

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
import numpy as np
from rodsweep.reading import commandline, measures
from rodsweep.reading.sweepfile import SweepFile

HEADS = {".pdf": b"%PDF", ".png": b"\x89PNG"}


def laid_out(page, folder, name, *_):
    """Replaces Page.save(): lays out without pixels and files, in a fifth of the time."""
    page.figure.draw_without_rendering()
    sys.modules["rodsweep.drawing.layout"].plt.close(page.figure)
    return [os.path.join(folder, name + ending) for ending in HEADS]


def run(name, *arguments, files=False):
    """Runs a script in this process, since a new Python takes a second to start. Returns its output and exit code.
    files: write the figures instead of laying them out only."""
    script = importlib.import_module(name.removesuffix(".py"))
    out, error, code = io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True), io.StringIO(), 0
    with contextlib.ExitStack() as around:
        around.enter_context(contextlib.redirect_stdout(out))
        around.enter_context(contextlib.redirect_stderr(error))
        around.enter_context(unittest.mock.patch.object(sys, "argv", [name, *arguments]))
        if not files and "rodsweep.drawing.layout" in sys.modules:    # not every script draws
            around.enter_context(unittest.mock.patch("rodsweep.drawing.layout.Page.save", laid_out))
        try:
            commandline.run(script.main)
        except SystemExit as left:
            code = left.code
    said = out.buffer.getvalue().decode()
    if files:
        paths = [line for line in said.splitlines() if line[-4:] in HEADS]
        for path in paths:
            with open(path, "rb") as figure:
                assert figure.read(4) == HEADS[path[-4:]] and os.path.getsize(path) > 5000, path
        assert paths, said + error.getvalue()
    return types.SimpleNamespace(stdout=said, stderr=error.getvalue(), code=code)


class Folder(unittest.TestCase):
    file = None

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder, self.path = folder.name, os.path.join(folder.name, "sweep.h5")

    def open(self, **settings):
        """A planted sweep; valid until the next open() or changed()."""
        self.close()
        synthetic.Sweep(**settings).write(self.path)
        return self.opened()

    def changed(self, *changes):
        """The file, opened again after changes: (path, index, value or a function of the old values), or functions of its
        h5py.File. A path that is not there becomes a new dataset with this value, without an index."""
        self.close()
        with synthetic.h5py.File(self.path, "r+") as h5:
            for change in changes:
                if callable(change):
                    change(h5)
                    continue
                path, index, value = change
                if path in h5:
                    values = h5[path][:]
                    values[index] = value(values[index]) if callable(value) else value
                    h5[path][...] = values
                else:
                    h5[path] = value
        return self.opened()

    def opened(self):
        self.file = SweepFile(self.path)
        self.addCleanup(self.file.h5.close)
        return self.file

    def close(self):
        if self.file:
            self.file.h5.close()

    def simulations(self, **settings):
        """A planted sweep and all its complete simulations."""
        file = self.open(**settings)
        return file, measures.simulations(file, np.ones(file.task_count, dtype=bool))


class Scripts(Folder):
    """Each test in an empty folder of its own."""

    def setUp(self):
        super().setUp()
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        self.folder = os.getcwd()    # without symbolic links

    def write(self, **settings):
        settings.setdefault("steps", 2)
        self.close()
        synthetic.Sweep(**settings).write(self.path)

    def run_script(self, name, *arguments, code=0, files=False):
        done = run(name, *arguments, files=files)
        self.assertEqual(done.code, code, done.stderr)
        return done

    def refused(self, name, *arguments, words):
        """Checks that the script fails with one line that contains these words; returns the line."""
        error = self.run_script(name, *arguments, code=2).stderr
        self.assertEqual(error.count("\n"), 1, error)
        self.assertTrue(error.startswith(f"{name}: "), error)
        self.assertIn(words, error)
        return error
