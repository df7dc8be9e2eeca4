"""analysis/pyproject.toml: it includes all files and installs with pip."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest
import venv
from pathlib import Path

import synthetic

ROOT = Path(synthetic.ANALYSIS)
TOOLS = ("pip", "setuptools", "wheel")


class Package(unittest.TestCase):
    def setUp(self):
        self.project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))

    def test_every_script_has_a_program_and_every_folder_is_a_package(self):
        programs = {f"rodsweep-{path.stem.replace('_', '-')}" for path in ROOT.glob("*.py")}
        self.assertEqual(set(self.project["project"]["scripts"]), programs)
        self.assertEqual(set(self.project["project"]["scripts"].values()), {"rodsweep.launch:run"})
        folders = {".".join(path.parent.relative_to(ROOT).parts) for path in ROOT.glob("rodsweep/**/__init__.py")}
        self.assertEqual(set(self.project["tool"]["setuptools"]["packages"]), folders | {"rodsweep.scripts"})

    @unittest.skipUnless(all(map(importlib.util.find_spec, TOOLS)), f"one of {', '.join(TOOLS)} is not installed")
    def test_what_pip_installs_as_the_page_says_works_away_from_here(self):
        with tempfile.TemporaryDirectory() as folder:
            source, programs = os.path.join(folder, "analysis"), os.path.join(folder, "environment", "bin")
            python = os.path.join(programs, "python3")
            left_out = shutil.ignore_patterns("results", "__pycache__", "build", "*.egg-info")
            shutil.copytree(ROOT, source, ignore=left_out)
            venv.create(os.path.join(folder, "environment"), system_site_packages=True)    # includes Debian's pip

            def said(*command):
                return subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True, check=True,
                                      cwd=folder).stdout

            said(python, "-m", *self.offline().split())
            shutil.rmtree(source)
            synthetic.Sweep(scenes=("helix",)).write(os.path.join(folder, "sweep.h5"))
            summary = said(os.path.join(programs, "rodsweep-summary"), "sweep.h5", "--csv")
            self.assertEqual(summary, said(sys.executable, ROOT / "summary.py", "sweep.h5", "--csv"))
            long_term = said(os.path.join(programs, "rodsweep-long-term"), "--help")
            self.assertIn("\n  rodsweep-long-term results/long_term.h5\n", long_term)
            place, ok = said(python, "-c", "import rodsweep; print(rodsweep.__file__, "
                             "rodsweep.open('sweep.h5').census().ok)").split()
            self.assertTrue(place.startswith(os.path.join(folder, "environment", "lib")), place)
            self.assertEqual(ok, "12")

    def offline(self):
        """The page's pip command that works without a network."""
        page = (ROOT.parent / "docs" / "python.md").read_text(encoding="utf-8")
        return re.search(r"`(pip install [^`]*--no-index [^`]*)`", page)[1]


if __name__ == "__main__":
    unittest.main()
