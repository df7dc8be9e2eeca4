"""The package: imports go from scripts to drawing to reading, without cycles, and numbers need no drawing library; it
installs with pip."""

import ast
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
# Each may import those before it. `rodsweep` means the modules directly in the package; "" means the scripts, "results" those
# that make the tables of this repository.
ROOMS = ("rodsweep.reading", "rodsweep.writing", "rodsweep.drawing", "rodsweep.report", "rodsweep", "rodsweep.scoring", "",
         "results")
DRAW = {"matplotlib", "PIL"}          # not imported by reading and writing


def imports(root):
    """(file, line, importing module, imported module) of files below root; full names: rodsweep.reading.measures."""
    files = {".".join(path.relative_to(root).with_suffix("").parts): path for path in sorted(root.rglob("*.py"))
             if path.relative_to(root).parts[0] != "build"}    # made by pip
    for module, path in files.items():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, (ast.Import, ast.ImportFrom)) else []
            if isinstance(node, ast.ImportFrom):
                base = f"{room(module)}.{node.module or ''}".strip(".") if node.level else node.module
                names = [f"{base}.{name}" if f"{base}.{name}" in files else base for name in names]
            for name in dict.fromkeys(names):
                yield path.relative_to(root).as_posix(), node.lineno, module, name


def room(module):
    return module.rpartition(".")[0]


def violations(root):
    found = list(imports(root))
    uses = {}
    for _, _, module, name in found:
        uses.setdefault(module, set()).add(name)

    def reachable(start):
        seen, ahead = set(), [start]
        while ahead:
            some = uses.get(ahead.pop(), set()) - seen
            seen |= some
            ahead += some
        return seen

    for file, line, module, name in found:
        here, own = room(module), Path(root, *name.split(".")).with_suffix(".py").exists()
        if own and ROOMS.index(room(name)) > ROOMS.index(here):
            yield f"{file}:{line}: {here} must not use {name}"
        elif own and here == room(name) == "":
            yield f"{file}:{line}: a script must not use another, {name}"
        elif own and module in reachable(name):
            yield f"{file}:{line}: closes a circle with {name}"
        elif here in ("rodsweep.reading", "rodsweep.writing") and name.partition(".")[0] in DRAW:
            yield f"{file}:{line}: {here} draws nothing, {name}"


class Imports(unittest.TestCase):
    def test_they_run_one_way_without_circles(self):
        self.assertGreater(len(list(imports(ROOT))), 100)
        self.assertEqual(list(violations(ROOT)), [])

    def test_violations_are_named_with_file_and_line(self):
        planted = {"reading/a.py": "import numpy\nfrom rodsweep.reading import b, c\n",
                   "reading/b.py": "from rodsweep.reading.c import x\n",
                   "reading/c.py": "import os\n\ndef f():\n    from . import a\n",
                   "reading/d.py": "from rodsweep.drawing import page\n", "reading/e.py": "import matplotlib.pyplot as plt\n",
                   "drawing/page.py": "from rodsweep.reading import e\nimport figure\n",
                   "../figure.py": "from rodsweep.reading.a import y\n", "../table.py": "import figure\n"}
        with tempfile.TemporaryDirectory() as folder:
            for name, text in planted.items():
                path = Path(folder, "rodsweep", name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            found = [line.split(": ")[0] for line in violations(Path(folder))]
        within = [line.removeprefix("rodsweep/") for line in found]
        self.assertEqual(within, ["drawing/page.py:2", "reading/a.py:2", "reading/a.py:2", "reading/b.py:1",
                                  "reading/c.py:4", "reading/d.py:1", "reading/e.py:1", "table.py:1"])

    def test_a_script_without_figures_loads_no_program_to_draw(self):
        code = f"import sys; sys.path.insert(0, {synthetic.ANALYSIS!r}); import summary, export, report; print(*sys.modules)"
        loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
        self.assertEqual(DRAW & set(loaded), set())
        self.assertIn("rodsweep.reading.sweepfile", loaded)


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
            self.assertIn("\n  rodsweep-long-term results/long_term_learned.h5\n", long_term)
            place, ok = said(python, "-c", "import rodsweep; print(rodsweep.__file__, "
                             "rodsweep.open('sweep.h5').census().ok)").split()
            self.assertTrue(place.startswith(os.path.join(folder, "environment", "lib")), place)
            self.assertEqual(ok, "12")

    def offline(self):
        """The page's pip command that works without a network."""
        page = (ROOT.parent / "docs" / "python.md").read_text(encoding="utf-8")
        return re.search(r"`(pip install [^`]*--no-index [^`]*)`", page)[1]
