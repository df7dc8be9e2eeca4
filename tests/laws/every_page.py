#!/usr/bin/python3
"""Every fenced block of README.md and docs/*.md runs as written, in the order of its page, in a folder that has what a
reader has: the source tree with the program, and the results of the two commands that other pages begin with.

  sh       is run; later blocks of the page have its folder and environment
  json     a job is written to the file that the text before it names, and validated; parts of a job in a whole one
  python   is written to the file that the text before it names, else run in one interpreter for the page
  others   are output

LEFT_OUT has what is not run, with the reason. `every_page.py long` runs what takes minutes.
"""

import ast
import concurrent.futures
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import traceback
import unittest
from dataclasses import dataclass
from pathlib import Path

ROOT, RODSWEEP = Path(os.environ["SOURCE_DIR"]), Path(os.environ["RODSWEEP"])
LONG = "long" in sys.argv[1:]
OUTPUT = ("", "cpp", "c")

# {page: {first words of a line, or of a whole block in another language than sh: reason}}
LEFT_OUT = {
    "README.md": {"make demo": "builds, minutes", "make test": "builds, minutes"},
    "docs/extending.md": {"gcc ": "needs an installed header: command/plugin compiles and runs it"},
    "docs/installing.md": {words: "installs packages, or needs a network" for words in (
        "make install", "make uninstall", "cmake ", "docker ", "apptainer ", "mpirun ", "srun ", "spack ", "conda ")},
    "docs/jobs.md": {"build/rodsweep run jobs/networks/bending_data.json": "720 MB"},
    "docs/models.md": {"build/rodsweep run jobs/networks/": "minutes, gigabytes"},
    "docs/python.md": {"analysis/export.py results/demo.h5 --level solves -o solves.parquet": "needs pyarrow"},
    "docs/report.md": {"make ": "builds, minutes", "jobs/studies.py ": "writes into the repository"},
    "docs/running.md": {"sbatch ": "needs Slurm: command/slurm_script and test-cluster run it"},
    "docs/score.md": {"analysis/score.py --": "hours"},
    "docs/speed.md": {"make bench": "builds, an hour"},
}
MODES = "takes a minute"
MINUTES = {    # left out unless long
    "docs/own-guess.md": {words: MODES for words in (
        "sed ", "     s/", "for task in", "/usr/bin/python3 train.py", "rodsweep run training.json",
        "rodsweep run modes_guess.json", "rodsweep summary results/modes_guess.h5")},
    "docs/pictures.md": {words: "minutes of rendering" for words in (
        "build/rodsweep ", "analysis/", "printf ")},
}
# What readers of a page have: the job of the README, its results, and those of the demo, all with fewer tasks; a curve.
GIVEN = {"frame.csv": ("docs/curves.md",), "my.json": ("docs/faults.md", "docs/running.md"),
         "results/stiffness.h5": ("docs/report.md",),
         "results/demo.h5": ("docs/format.md", "docs/python.md", "docs/reading.md", "docs/report.md")}


@dataclass(frozen=True)
class Block:
    page: str
    line: int
    language: str
    text: str
    before: str    # the text of the page since the last heading or block

    def left_out(self):
        """{words of LEFT_OUT or MINUTES: whether they are those of a line, or of the block if it is not sh}"""
        table = LEFT_OUT.get(self.page, {}) | ({} if LONG else MINUTES.get(self.page, {}))
        lines = self.text.splitlines() if self.language == "sh" else [self.text]
        return {words: any(line.startswith(words) for line in lines) for words in table}

    def runs(self):
        """The text without what is left out."""
        words = tuple(words for words, here in self.left_out().items() if here)
        if self.language == "sh" and "<<'END'" not in self.text:
            return "\n".join(line for line in self.text.splitlines() if not line.startswith(words))
        return "" if words else self.text

    def named(self, ending):
        """The file that the text before names."""
        found = re.findall(rf"`([\w-]+\.{ending})`", self.before)
        return found[-1] if found else None


def blocks(page):
    text, end = (ROOT / page).read_text(encoding="utf-8"), 0
    for found in re.finditer(r"^```(\w*)\n(.*?)^```$", text, re.S | re.M):
        before = re.split(r"^#+ .*$", text[end:found.start()], flags=re.M)[-1]
        yield Block(page, text[:found.start()].count("\n") + 2, found[1], found[2], before)
        end = found.end()


def pages():
    return ["README.md", *sorted(f"docs/{path.name}" for path in ROOT.glob("docs/*.md"))]


class Reader:
    """A reader of a page, in the current folder."""

    def __init__(self):
        self.session = {**os.environ}
        self.folder, self.names = os.getcwd(), {"__name__": "page"}

    def sh(self, text):
        text += f"\nenv -0 >'{self.folder}/.env'\npwd >'{self.folder}/.pwd'"
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=self.at(), env=self.session,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True)
        if done.returncode:
            raise AssertionError(f"exit code {done.returncode}: {done.stdout[-2000:]}\n{done.stderr[-3000:]}")
        variables = Path(self.folder, ".env").read_bytes().decode().rstrip("\0").split("\0")
        self.session = dict(variable.split("=", 1) for variable in variables)

    def at(self):
        """The folder of the last command."""
        path = Path(self.folder, ".pwd")
        return path.read_text().rstrip("\n") if path.exists() else self.folder

    def python(self, block):
        if name := block.named("py"):
            Path(self.at(), name).write_text(block.text, encoding="utf-8")
            self.check_imports(block.text)
            return
        exec(compile("\n" * (block.line - 1) + block.text, block.page, "exec"), self.names)

    def check_imports(self, code):
        """Python finds the modules that a file imports."""
        nodes = list(ast.walk(ast.parse(code)))
        names = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
        names |= {node.module for node in nodes if isinstance(node, ast.ImportFrom)}
        find = "import importlib.util as u, sys; print(*(name for name in sys.argv[1:] if not u.find_spec(name)))"
        found = subprocess.run([sys.executable, "-c", find, *names], cwd=self.at(), env=self.session,
                               capture_output=True, text=True, check=True).stdout.split()
        if found:
            raise AssertionError(f"no module {', '.join(found)}")

    def json(self, block):
        if block.text.startswith("{"):
            name = block.named("json") or "my.json"
            Path(self.at(), name).write_text(block.text, encoding="utf-8")
            self.validate([name])
            return
        for keys in objects(block.text):
            made = jobs_with(keys)
            for k, job in enumerate(made):
                Path(self.at(), f"part-{k}.json").write_text(json.dumps(job), encoding="utf-8")
            self.validate([f"part-{k}.json" for k in range(len(made))], any)

    def validate(self, names, needed=all):
        done = subprocess.run([RODSWEEP, "validate", "--later", *names], cwd=self.at(), capture_output=True, text=True)
        if not needed(f"{name}: valid, " in done.stdout for name in names):
            raise AssertionError(done.stderr)


def objects(text):
    """The members of a text such as `"a": {...}, "b": 1`, as objects: a new one begins with a key that is there."""
    found, decode = [{}], json.JSONDecoder().raw_decode
    while text.strip(", \n"):
        text = text.lstrip(", \n")
        key, end = decode(text)
        value, length = decode(text[end:].lstrip(": "))
        text = text[end:].lstrip(": ")[length:]
        if key in found[-1]:
            found.append({})
        found[-1][key] = value
    return found


def jobs_with(keys):
    """Jobs that have these keys: of the job, else of its scene, in the first job of each type of scene in jobs/."""
    top = set(json.loads((ROOT / "jobs" / "schema.json").read_text(encoding="utf-8"))["properties"])
    scenes = {}
    for path in sorted((ROOT / "jobs").rglob("*.json")):
        given = json.loads(path.read_text(encoding="utf-8")).get("scene", {})
        for scene in given.get("grid", [given]):
            if isinstance(scene.get("type"), str) and "grid" not in scene:
                scenes.setdefault(scene["type"], scene)
    base = {"name": "part", "kind": "sweep", "time": {"step_s": 0.01, "steps": 5}, "guesses": ["zero"]}
    if set(keys) <= top:
        return [{**base, "scene": next(iter(scenes.values())), **keys}]
    return [{**base, "scene": {**scene, **keys}} for scene in scenes.values()]


def read(page):
    """Runs a page in the current folder. Returns the exit code."""
    sys.path.insert(0, os.path.abspath("analysis"))
    reader = Reader()
    for block in blocks(page):
        text = block.runs()
        if block.language in OUTPUT or not text.strip():
            continue
        try:
            if block.language == "sh":
                reader.sh(text)
            else:
                getattr(reader, block.language)(block)
        except Exception:    # pylint: disable=broad-except
            print(f"{page}:{block.line}: {block.text.splitlines()[0]}\n{traceback.format_exc()}", file=sys.stderr)
            return 1
    return 0


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.shared.cleanup)
        cls.given = Path(cls.shared.name)
        demo = json.loads((ROOT / "jobs" / "demo.json").read_text(encoding="utf-8"))
        demo["samples"], demo["time"]["steps"] = 2, 5
        job = json.loads(next(block for block in blocks("README.md") if block.language == "json").text)
        job["samples"], job["time"]["steps"] = 2, 5
        (cls.given / "my.json").write_text(json.dumps(job), encoding="utf-8")
        (cls.given / "frame.csv").write_text("0,0,0\n0.3,0.2,0\n0.6,0,0\n", encoding="utf-8")
        cls.prepare(cls.given)
        (cls.given / "demo.json").write_text(json.dumps(demo).replace("../network", "network"), encoding="utf-8")
        for name in ("demo.json", "my.json"):
            subprocess.run([RODSWEEP, "run", name], cwd=cls.given, check=True, capture_output=True)

    @staticmethod
    def prepare(folder):
        """The source tree, without results."""
        for path in ROOT.iterdir():
            if path.name not in ("build", "results", ".git") and not path.name.startswith("build"):
                (folder / path.name).symlink_to(path)
        (folder / "build").symlink_to(RODSWEEP.parent)

    def read(self, page):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            self.prepare(folder)
            (folder / "results").mkdir()
            for path, takers in GIVEN.items():
                if page in takers:
                    shutil.copy(self.given / path, folder / path)
            words = [sys.executable, "-B", __file__, "--page", page, *(["long"] if LONG else [])]
            done = subprocess.run(words, cwd=folder, env={**os.environ, "MPLBACKEND": "Agg"}, capture_output=True,
                                  text=True)
            return done.stderr if done.returncode else ""

    def test_every_block_runs(self):
        some = [page for page in pages() if (not LONG or page in MINUTES) and
                any(block.language not in OUTPUT and block.runs().strip() for block in blocks(page))]
        self.assertGreater(len(some), 1)
        with concurrent.futures.ThreadPoolExecutor(2) as readers:
            for page, error in zip(some, readers.map(self.read, some)):
                with self.subTest(page=page):
                    self.assertEqual(error, "")

    def test_what_is_left_out_is_there(self):
        for table in (LEFT_OUT, MINUTES):
            for page, reasons in table.items():
                of = list(blocks(page))
                for words in reasons:
                    with self.subTest(page=page, words=words):
                        lines = [line for block in of for line in (block.text.splitlines() if block.language == "sh"
                                                                   else [block.text])]
                        self.assertTrue(any(line.startswith(words) for line in lines))

    def test_every_language_is_known(self):
        for page in pages():
            for block in blocks(page):
                self.assertIn(block.language, (*OUTPUT, "sh", "json", "python"), f"{page}:{block.line}")


if __name__ == "__main__":
    if "--page" in sys.argv:
        sys.exit(read(sys.argv[sys.argv.index("--page") + 1]))
    unittest.main(argv=sys.argv[:1])
