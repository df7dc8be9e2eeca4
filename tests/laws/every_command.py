#!/usr/bin/python3
"""Law: every command, however it ends, has the exit code of the table, and its files are whole or absent.

The commands are those of `rodsweep --help` and the scripts of analysis/pyproject.toml: one without a row in COMMANDS fails.
Each is run to success, with wrong input, interrupted while it works, on a full disk, and with a standard output that is
full, closed, or not read. Scripts run in forks of this process, which has their libraries; drawing is left out, writing is
not.
"""

import contextlib
import importlib
import io
import os
import re
import resource
import runpy
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import traceback
import unittest
from dataclasses import dataclass
from pathlib import Path

SOURCE = Path(os.environ["SOURCE_DIR"])
ANALYSIS = SOURCE / "analysis"
sys.path[:0] = [str(SOURCE / "tests" / "command"), str(ANALYSIS)]
import h5py  # noqa: E402
import matplotlib.figure  # noqa: E402
import numpy as np  # noqa: E402
from program import RODSWEEP, ROD, Case, rodsweep, write_job  # noqa: E402
from rodsweep.reading.job_paths import checksum  # noqa: E402
from rodsweep.scoring import answers, scenes, settings  # noqa: E402

os.environ.update(RODSWEEP=os.path.abspath(RODSWEEP), PMIX_MCA_gds="hash")    # else Open MPI needs room for files
CODES = {name: int(number) for name, number in re.findall(
    r"^  (\w+) = (\d+),", (SOURCE / "runner" / "command" / "exit_codes.hpp").read_text(encoding="utf-8"), re.M)}
OK, REFUSED, STOPPED, OUTPUT_LOST = (CODES[name] for name in ("ok", "user_error", "stopped", "output_lost"))
INPUT = re.compile(r"\{(\w+)\}")


@dataclass
class Row:
    """Words of a command; {NAME} is a file or folder of Inputs. `writes`: it makes files in the current folder. `long`: words
    of a call that takes seconds, to interrupt it; "": none does, or it is a script, which is interrupted when it has read
    its input, and when it is about to name a file that it has written."""
    words: str
    writes: bool = False
    long: str = ""
    hdf5: bool = True    # it opens a file of HDF5


PROGRAM = {
    "run": Row("run {job} -o a.h5", True, "run {longjob} -o a.h5"),
    "plan": Row("plan {job}", False, "plan {longjob}"),
    "validate": Row("validate {job}"),
    "status": Row("status {sweep}", False, "status {stopped} --watch 9"),
    "info": Row("info {sweep} --verify"),
    "rerun": Row("rerun {sweep} 0 -o a.h5", True, "rerun {stopped} 1 -o a.h5"),
    "systems": Row("systems {sweep} 0 --first -o a.h5", True, "systems {stopped} 1 --every 100 -o a.h5"),
    "merge": Row("merge {sweep} {sweep} -o a.h5", True, "merge {sweep} {sweep} -o a.h5"),
    "schema": Row("schema"),
}
FIGURE = "-o . --width 84 --format pdf,png"
SCRIPTS = {
    "ablation": Row(f"{{learned}} {{models}} {FIGURE}", True),
    "balance": Row(f"{{steps}} {FIGURE}", True),
    "benchmark-data": Row("{sweep} -o .", True),
    "combinations": Row(f"{{sweep}} {FIGURE}", True),
    "compare": Row("{sweep} {sweep}"),
    "export": Row("{sweep} -o a.csv.gz", True),
    "front": Row(f"{{sweep}} {FIGURE}", True),
    "heatmap": Row(f"{{sweep}} --x scene.segments --y tolerance {FIGURE}", True),
    "integrators": Row(f"{{steps}} --columns scene.type {FIGURE}", True),
    "long-term": Row(f"{{closed}} {FIGURE}", True),
    "loss": Row(f"{{models}}/base.h5 {FIGURE}", True),
    "matrices": Row("{systems} -o .", True),
    "new": Row("guess mine.py", True),
    "paraview": Row("{sweep} --task 0 -o a.xdmf", True),
    "query": Row("{sweep}"),
    "render": Row("{sweep} --task 0 --size 32x24 -o a.png", True),
    "report": Row("{sweep} -o a.html", True),
    "score": Row(f"rod --root {{scored}} {FIGURE}", True, hdf5=False),
    "side-by-side": Row(f"{{closed}} {FIGURE}", True),
    "spatial": Row(f"{{sweep}} {FIGURE}", True),
    "summary": Row("{sweep}"),
    "temporal": Row(f"{{sweep}} {FIGURE}", True),
}
COMMANDS = {**PROGRAM, **SCRIPTS}


class Inputs:
    """Files for the rows, made once."""

    def __init__(self, folder):
        self.folder = folder
        (folder / "models").mkdir()
        for name, model in (("base", "rods"), ("deep", "rods-large")):
            shutil.copy(SOURCE / "network" / "pretrained" / f"{model}.h5", folder / "models" / f"{name}.h5")
        (folder / "text.h5").write_text("neither a job nor results")
        frames, rod = {"record": {"trajectory_every": 1}}, {**ROD, "segments": 6}
        self.job("job", **frames)
        self.job("longjob", scene={**ROD, "segments": {"grid": [5, 200]}}, samples=1, record={"solves": "summary"},
                 time={"step_s": 0.02, "steps": 100_000})
        solve = {"method": "cg", "tolerance": 1e-2, "preconditioner": {"grid": ["jacobi", "block_icc"]}}
        self.sweep("sweep", samples=1, solve=solve, **frames)
        self.sweep("closed", scene=rod, samples=1, evaluation="closed_loop", **frames)
        self.sweep("learned", samples=1, guesses=["zero", *({"copingnet": {"model": f"models/{name}.h5"}}
                                                            for name in ("base", "deep"))])
        self.sweep("steps", scene=rod, samples=1, solve={"method": "direct"}, guesses=[], **frames,
                   time={"duration_s": 0.08, "step_s": {"grid": [0.02, 0.01]}, "integrator": {"grid": ["euler", "bdf2"]},
                         "balance": {"grid": [False, True]}, "newton_iterations": 5})
        self.score(folder / "scored")
        rodsweep("systems", "sweep.h5", "0", "--first", "-o", "systems.h5", cwd=folder, check=True)
        stopped = started("run", "longjob.json", "-o", "stopped.h5", cwd=folder)
        while not (folder / "stopped.h5").exists():
            time.sleep(0.01)
        terminate(stopped)

    @staticmethod
    def score(root):
        """A scene and what was measured of it."""
        (root / "jobs" / "score").mkdir(parents=True)
        shutil.copy(SOURCE / "jobs" / "score" / "bending_rod_draws.json", root / "jobs" / "score" / "rod_draws.json")
        scene = scenes.Scene("rod", root)
        os.makedirs(os.path.dirname(scene.measured("")))
        some = [answers.Answer(0.01, kind, settings.direct(settings.Step(0.01 * time, "bdf2")), time, np.full((1, 5), 0.005),
                               0, 0, np.full((1, 3, 5), time)) for kind, time in (("direct solve", 1), ("CG, Jacobi", 2))]
        answers.Scored("rod", "rod", checksum(scene.job), "r", "2026-11-28", {}, {}, [0.01], {"rods": [1]},
                       some).write(scene.measured(".json"))

    def job(self, name, **changes):
        with contextlib.chdir(self.folder):
            shutil.move(write_job(name, **changes), name + ".json")

    def sweep(self, name, **changes):
        self.job(name, **changes)
        rodsweep("run", name + ".json", "-o", name + ".h5", cwd=self.folder, check=True)

    def path(self, name):
        return str(next(path for ending in (".h5", ".json", "") if (path := self.folder / (name + ending)).exists()))


def started(*words, **options):
    return subprocess.Popen([RODSWEEP, *words], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                            stderr=subprocess.PIPE, text=True, **options)


def terminate(process):
    process.terminate()
    return Ended(*reversed((process.communicate(timeout=60)[1], process.returncode)))


def catches(process, number):
    """Whether a process has a handler of this signal."""
    status = Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
    return int(re.search(r"SigCgt:\s*(\w+)", status)[1], 16) >> (number - 1) & 1


@contextlib.contextmanager
def empty_folder():
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        yield


def limited_to(size):
    """Limits the size of a process's files, as a full disk does."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


@dataclass
class Ended:
    code: int
    said: str    # on standard error


def forked(name, words, stdout, before, interrupt):
    """Runs a script in a fork, after before(). `interrupt`: the event of sys.addaudithook() at which it gets SIGTERM, or
    "read": when it has opened a file of HDF5."""
    ours, theirs = os.pipe()
    child = os.fork()
    if child == 0:
        code = 255
        try:
            if stdout is None:
                os.close(1)
            else:
                os.dup2(stdout, 1)
            os.dup2(theirs, 2)
            os.close(theirs)
            os.close(ours)
            before()
            code = as_script(name, words, interrupt)
        except BaseException:
            os.write(2, traceback.format_exc().encode())
        os._exit(code)
    os.close(theirs)
    with open(ours, encoding="utf-8") as said:
        text = said.read()
    return Ended(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), text)


def as_script(name, words, interrupt):
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    sys.stderr = io.TextIOWrapper(io.FileIO(2, "w", closefd=False), "utf-8", write_through=True)
    sys.stdout = sys.__stdout__ = None
    with contextlib.suppress(OSError):
        sys.stdout = sys.__stdout__ = io.TextIOWrapper(io.FileIO(1, "w", closefd=False), "utf-8")
    sys.argv = [str(ANALYSIS / (name.replace("-", "_") + ".py")), *words]
    matplotlib.figure.Figure.savefig = drawn
    if interrupt == "read":
        opened = h5py.File.__init__
        h5py.File.__init__ = lambda *given, **named: (opened(*given, **named), signal.raise_signal(signal.SIGTERM))[0]
    elif interrupt:
        sys.addaudithook(lambda event, _: signal.raise_signal(signal.SIGTERM) if event == interrupt else None)
    try:
        runpy.run_path(sys.argv[0], run_name="__main__")
    except SystemExit as left:
        return left.code or 0
    return 0


def drawn(_, path, **__):
    """Replaces Figure.savefig(), which takes a second."""
    with open(path, "wb") as out:
        out.write(b"drawn")


class Commands(Case):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.inputs = Inputs(Path(folder.name).resolve())
        cls.made = {}    # by command: {file: its size} after success
        for name in SCRIPTS:    # with all its libraries
            importlib.import_module(name.replace("-", "_"))

    def run_row(self, name, words, stdout=subprocess.DEVNULL, before=lambda: None, interrupt=""):
        """Runs a command to its end. `stdout`: None: closed."""
        if name in PROGRAM:
            done = rodsweep(*words, stdout=stdout, preexec_fn=lambda: (before(), stdout is None and os.close(1)))
            return Ended(done.returncode, done.stderr)
        with open(os.devnull, "wb") as nowhere:
            return forked(name, words, nowhere.fileno() if stdout == subprocess.DEVNULL else stdout, before, interrupt)

    def words(self, text, path=None):
        path = path or self.inputs.path
        return [INPUT.sub(lambda found: path(found[1]), word) for word in text.split()]

    def files(self):
        return {str(path): path.stat().st_size for path in sorted(Path(".").rglob("*")) if path.is_file()}

    def after_success(self, name):
        if name not in self.made:
            with empty_folder():
                done = self.run_row(name, self.words(COMMANDS[name].words))
                self.assertEqual((done.code, "Traceback" in done.said), (OK, False), done.said)
                self.made[name] = self.files()
        return self.made[name]

    def assert_whole_or_absent(self, name):
        """Each file is one that success leaves, with the same size, and a results file has all its tasks."""
        whole = self.after_success(name)
        for path, size in self.files().items():
            self.assertIn(path, whole)
            if not path.endswith(".h5"):
                self.assertEqual(size, whole[path], path)
                continue
            with h5py.File(path) as h5:
                self.assertTrue(h5.attrs["kind"] == b"systems" or (h5["tasks/state"][:] == 1).all(), path)

    def test_every_command_has_a_row_and_every_code_is_in_the_tables(self):
        helped = rodsweep("--help").stdout
        offered = re.findall(r"^  (\S+) ", helped.split("Subcommands:")[1].split("Examples:")[0], re.M)
        with open(ANALYSIS / "pyproject.toml", "rb") as file:
            scripts = [name.removeprefix("rodsweep-") for name in tomllib.load(file)["project"]["scripts"]]
        self.assertEqual(sorted(COMMANDS), sorted(offered + scripts))
        page = (SOURCE / "docs" / "running.md").read_text(encoding="utf-8").split("## Exit codes")[1].split("\n## ")[0]
        documented = {int(code) for code in re.findall(r"^\| (\d+) \|", page, re.M)}
        shown = {int(code) for code in re.findall(r"^  (\d+) ", helped.split("Exit codes:")[1], re.M)}
        self.assertEqual(shown, set(CODES.values()))
        self.assertEqual(documented - {128 + signal.SIGKILL}, set(CODES.values()))

    def test_success_leaves_files_and_nothing_else(self):
        for name, row in COMMANDS.items():
            with self.subTest(command=name):
                made = self.after_success(name)
                self.assertEqual(bool(made), row.writes, made)
                self.assertFalse([path for path in made if ".part" in path or ".unfinished" in path])

    def test_wrong_input_is_refused_in_words_and_leaves_nothing(self):
        for name, row in COMMANDS.items():
            wrong = [("no-such-option", self.words(row.words) + ["--no-such-option"])]
            if INPUT.search(row.words):
                wrong += [(path, self.words(row.words, lambda _, path=path: path))
                          for path in ("nowhere.h5", str(self.inputs.folder / "text.h5"))]
            for word, words in wrong:
                with self.subTest(words=[name, *words]), empty_folder():
                    done = self.run_row(name, words)
                    self.assertEqual(done.code, REFUSED, done.said)
                    self.assertIn(word, done.said)
                    self.assertNotIn("Traceback", done.said)
                    self.assertEqual(self.files(), {})

    def test_standard_output_that_is_full_is_told_and_files_are_whole(self):
        for name, row in COMMANDS.items():
            with self.subTest(command=name), empty_folder(), open("/dev/full", "wb") as full:
                done = self.run_row(name, self.words(row.words), full.fileno())
                self.assertEqual(done.code, OUTPUT_LOST, done.said)
                self.assertRegex(done.said, "standard output.*No space left")
                self.assert_whole_or_absent(name)

    def test_help_that_is_not_written_or_not_read(self):
        for name in COMMANDS:
            words = [name, "--help"] if name in PROGRAM else ["--help"]
            reader, writer = os.pipe()
            os.close(reader)
            left = -signal.SIGPIPE if name in PROGRAM else OK    # in both cases without a word
            with self.subTest(command=name), open(writer, "wb"), open("/dev/full", "wb") as full:
                self.assertEqual(self.run_row(name, words).code, OK)
                self.assertEqual(self.run_row(name, words, full.fileno()).code, OUTPUT_LOST)
                self.assertEqual(self.run_row(name, words, None).code, OUTPUT_LOST)
                self.assertEqual(self.run_row(name, words, writer), Ended(left, ""))

    def test_a_full_disk_leaves_nothing_that_is_incomplete(self):
        for name, row in COMMANDS.items():
            if row.writes:
                size = max(self.after_success(name).values()) // 2
                with self.subTest(command=name), empty_folder():
                    done = self.run_row(name, self.words(row.words), before=limited_to(size))
                    self.assertEqual(done.code, REFUSED, done.said)
                    self.assertRegex(done.said, "File too large|files of this size")
                    self.assert_whole_or_absent(name)

    def test_an_interrupted_command_leaves_what_it_finished(self):
        for name, row in PROGRAM.items():
            if row.long:
                with self.subTest(command=name), empty_folder():
                    process = started(*self.words(row.long))
                    while row.writes and process.poll() is None and not catches(process, signal.SIGTERM):
                        time.sleep(0.01)
                    done = terminate(process)
                    short = [OK] if row.long == row.words else []    # it may have ended before
                    self.assertIn(done.code, [STOPPED if row.writes else -signal.SIGTERM, *short], done.said)
                    if name == "run" and self.files():
                        self.ran("info", "a.h5", "--verify")    # it can be resumed
                    elif done.code != OK:
                        self.assertEqual(self.files(), {})

    def test_an_interrupted_script_leaves_what_it_finished(self):
        for name, row in SCRIPTS.items():
            for event in ["read"] * bool(row.hdf5 and INPUT.search(row.words)) + ["os.rename"] * row.writes:
                with self.subTest(command=name, event=event), empty_folder():
                    done = self.run_row(name, self.words(row.words), interrupt=event)
                    self.assertEqual(done.code, STOPPED, done.said)
                    self.assertIn("stopped by SIGTERM", done.said)
                    self.assert_whole_or_absent(name)


if __name__ == "__main__":
    unittest.main()
