"""Guesses and preconditioners in Python: those of `rodsweep new` are as good as the same of the program, they see the
systems that `rodsweep systems` writes, and their errors reach the user."""

import json
import os
import re
import subprocess
import sys
import unittest

import h5py
from program import InAFolder

ANALYSIS = os.path.join(os.environ["SOURCE_DIR"], "analysis")

# Keeps what it sees of each system.
KEEPING = """
import numpy as np
class Guess:
    def __init__(self, rods, options):
        self.file, self.seen = options, {}
    def propose(self, system):
        self.now = dict(A=system.A.toarray(), b=system.b, multipliers=system.multipliers, position_m=system.position_m,
                        orientation=system.orientation, dt_s=system.dt_s, of=system.of.compliance_per_j)
        return np.zeros(system.b.shape).reshape(-1, 6)
    def accept(self, system, x):
        self.now["x"] = x
        place = f"{system.step} {system.newton} {system.rod} "
        self.seen |= {place + name: value for name, value in self.now.items()}
        np.savez(self.file, **self.seen)
"""


def guess(body):
    return f"import numpy as np\nclass Guess:\n    def __init__(self, rods, options): pass\n    {body}\n"


class Python(InAFolder):
    def write(self, name, text):
        with open(name, "w", encoding="utf-8") as file:
            file.write(text)

    def job(self, *guesses, **keys):
        job = {"name": "s", "kind": "sweep", "scene": {"type": "bending_rod", "segments": 9, "length_m": 1,
               "radius_m": 0.05, "density_kg_m3": 1000, "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 1e6},
               "time": {"step_s": 0.02, "steps": 10, "newton_iterations": 2}, "guesses": ["zero", *guesses], **keys}
        self.write("s.json", json.dumps(job))
        return "s.json"

    def error(self, text, code=3):
        """What the user is told of a guess with this text."""
        self.write("mine.py", text)
        if code == 2:
            return self.ran("validate", self.job({"python": {"file": "mine.py"}}), code=2).stderr
        for left in filter(os.path.exists, ["s.h5"]):
            os.remove(left)
        self.ran("run", self.job({"python": {"file": "mine.py"}}), "-o", "s.h5", code=3)
        with h5py.File("s.h5") as file:
            return file["/tasks/message"][0].decode()

    def new(self, kind, name):
        subprocess.run([os.path.join(ANALYSIS, "new.py"), kind, name], check=True, capture_output=True)

    def test_an_exception_without_a_text_is_named(self):
        rude = "\nclass Rude(Exception):\n    def __str__(self): return 1 / 0\n"
        said = self.error(guess("def propose(self, system): raise Rude") + rude)
        self.assertRegex(said, r"mine\.py: Rude: .*__str__ failed.* \(mine\.py:4 in propose\)")
        said = self.error(guess(r"def propose(self, system): raise ValueError('\ud800 \x1b[31m')"))
        self.assertIn(r"ValueError: ? \x1b[31m (mine.py", said)

    def test_the_mean_of_one_solution_is_the_previous_one(self):
        self.new("guess", "mine.py")
        mean = {"python": {"file": "mine.py", "options": "1"}}
        self.ran("run", self.job("previous", mean, {"python": {"file": "mine.py", "options": "3"}}), "-o", "s.h5", "-n", "2")
        with h5py.File("s.h5") as file:
            iterations = file["/tasks/iterations_sum"][0]
            self.assertEqual(iterations[2].tolist(), iterations[1].tolist())
            self.assertNotEqual(iterations[3].tolist(), iterations[1].tolist())
            self.assertEqual(file["/axes/guess"][2], b"python mine 1")

    def test_the_diagonal_takes_the_iterations_of_jacobi(self):
        self.new("preconditioner", "mine.py")
        self.ran("run", self.job("previous", solve={"method": "cg", "preconditioner": {"grid": ["jacobi", "python"]},
                                                        "python_preconditioner": {"file": "mine.py"}}), "-o", "s.h5")
        with h5py.File("s.h5") as file:
            jacobi, own = file["/tasks/iterations_sum"][:]
            self.assertGreater(jacobi.min(), 0)
            self.assertEqual(own.tolist(), jacobi.tolist())

    def test_the_jobs_of_new_run(self):
        for kind in ("guess", "preconditioner"):
            self.new(kind, f"my_{kind}.py")
            self.ran("validate", f"my_{kind}.json")
            again = subprocess.run([os.path.join(ANALYSIS, "new.py"), kind, f"my_{kind}.py"], capture_output=True, text=True)
            self.assertEqual(again.returncode, 2)
            self.assertIn(f"my_{kind}.py already exists", again.stderr)

    def test_it_sees_the_systems_that_are_written(self):
        sys.path.insert(0, ANALYSIS)
        import numpy as np
        import rodsweep
        self.write("mine.py", KEEPING)
        self.ran("run", self.job({"python": {"file": "mine.py", "options": os.path.abspath("seen.npz")}}), "-o", "s.h5")
        seen = np.load("seen.npz")
        self.ran("systems", "s.h5", "0", "--every", "1", "-o", "all.h5")
        with rodsweep.systems("all.h5") as systems:
            self.assertGreaterEqual(len(systems), 10)
            self.assertEqual(len(seen.files), 8 * len(systems))
            for system in systems:
                own = {name: seen[f"{system.step} {system.newton} {system.rod} {name}"]
                       for name in ("A", "of", "dt_s", "b", "x", "multipliers", "position_m", "orientation")}
                np.testing.assert_array_equal(own.pop("A"), system.A.toarray())
                np.testing.assert_array_equal(own.pop("of"), system.of.compliance_per_j)
                for name, value in own.items():
                    np.testing.assert_array_equal(value, getattr(system, name))

    def test_exceptions_are_the_outcome_of_the_task_with_file_and_line(self):
        self.assertEqual(self.error(guess("def propose(self, system): return 1 / 0")),
                         "mine.py: ZeroDivisionError: division by zero (mine.py:4 in propose)")
        self.assertIn("mine.py: proposed a guess that is not finite",
                      self.error(guess("def propose(self, system): return np.nan * system.b")))

    def test_arrays_of_another_shape_or_type_are_refused_with_what_is_expected(self):
        self.assertEqual(self.error(guess("def propose(self, system): return np.zeros(3)")),
                         "mine.py: propose() returned an array of (3,); must be of (48,) or (8, 6)")
        self.assertEqual(self.error(guess("def propose(self, system): return np.zeros(48, int)")),
                         "mine.py: propose() returned an array of int64; must be of float64 or float32")
        self.assertIn("array of <U4;", self.error(guess("def propose(self, system): return 'zero'")))

    def test_a_system_that_is_kept_cannot_be_read_later(self):
        text = guess("def propose(self, system):\n        old, self.old = getattr(self, 'old', None), system\n"
                     "        return old.b if old else None")
        self.assertIn("RuntimeError: a system can be read during the call that it is passed to", self.error(text))

    def test_mistakes_in_a_file_are_found_before_the_run(self):
        for text, words in (("class Guess:\n  def propose(", "SyntaxError: '(' was never closed (mine.py, line 2)"),
                            ("import no_such_module\n", "ModuleNotFoundError: No module named 'no_such_module'"),
                            ("def propose(system): pass\n", "mine.py: has no class Guess with propose()")):
            error = self.error(text, code=2)
            self.assertIn("s.json: guesses[1].python.file: ", error)
            self.assertIn(words, error)

    def test_products_are_counted_and_printed_text_is_not_in_the_output(self):
        self.write("mine.py", guess("def propose(self, system):\n        print('hello')\n        return 0 * system.b, 2"))
        done = self.ran("run", self.job({"python": {"file": "mine.py"}}), "-o", "s.h5")
        self.assertIn("hello", done.stderr)
        self.assertNotIn("hello", done.stdout)
        with h5py.File("s.h5") as file:
            self.assertEqual(set(file["/solves/start_matvecs"][:, 1]), {3})    # and the first residual

    def test_a_sweep_is_not_resumed_with_another_file(self):
        self.new("guess", "mine.py")
        self.ran("run", self.job({"python": {"file": "mine.py"}}), "-o", "s.h5")
        with open("mine.py", "a", encoding="utf-8") as file:
            file.write("# changed\n")
        self.assertIn("input files of the job have changed", self.ran("run", "s.json", "-o", "s.h5", "--resume", code=2).stderr)

    @unittest.skipUnless(os.environ.get("TRAINING"), "takes a minute and needs python3-torch")
    def test_the_network_of_the_page_saves_iterations(self):
        with open(os.path.join(os.environ["SOURCE_DIR"], "docs", "own-guess.md"), encoding="utf-8") as page:
            text = page.read()
        for name, code in zip(("net.py", "train.py", "net_guess.py"), re.findall(r"```python\n(.*?)```", text, re.DOTALL)):
            self.write(name, code)
        self.new("guess", "my_guess.py")
        folder = os.path.dirname(os.environ["RODSWEEP"])
        paths = {"PATH": f"{folder}:{os.environ['PATH']}", "PYTHONPATH": ANALYSIS}
        for commands in re.findall(r"```sh\n(.*?)```", text, re.DOTALL)[2:]:
            subprocess.run(["bash", "-euo", "pipefail", "-c", commands.replace("python3", "/usr/bin/python3")], check=True,
                           env={**os.environ, **paths}, stdout=subprocess.DEVNULL)
        with h5py.File("results/net_guess.h5") as file:
            labels = file["/axes/guess"][:].tolist()
            ratio = file["/tasks/cg_ratio"][:, labels.index(b"python net_guess"), 0].mean()
        self.assertLess(ratio, 0.7)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + ["-v"])
