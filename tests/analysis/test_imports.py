"""Imports of analysis/ go from scripts to drawing to reading, without cycles; numbers need no drawing library."""

import ast
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import synthetic

# Each may import those before it. `rodsweep` means the modules directly in the package; "" means the scripts, "results" those
# that make the tables of this repository.
ROOMS = ("rodsweep.reading", "rodsweep.writing", "rodsweep.drawing", "rodsweep.report", "rodsweep", "", "results")
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
        root = Path(synthetic.ANALYSIS)
        self.assertGreater(len(list(imports(root))), 100)
        self.assertEqual(list(violations(root)), [])

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


if __name__ == "__main__":
    unittest.main()
