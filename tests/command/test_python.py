"""Guesses and preconditioners in Python: those of `rodsweep new` are as good as the same of the program, they see the
systems that `rodsweep systems` writes, their errors reach the user, and what they do to the process stays with them."""

import os
import re
import signal
import subprocess
import sys
import time
import unittest

import h5py
from program import RODSWEEP, STOPPED, TASKS_FAILED, InAFolder

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


class WithPython(InAFolder):
    def error(self, text, code=3):
        """What the user is told of a guess with this text."""
        self.write("mine.py", text)
        if code == 2:
            return self.ran("validate", self.job({"python": {"file": "mine.py"}}), code=2).stderr
        for left in filter(os.path.exists, ["s.h5"]):
            os.remove(left)
        self.ran("run", self.job({"python": {"file": "mine.py"}}), "-o", "s.h5", code=3)
        return self.message()

    def message(self, outcome="error"):
        """That of the first task in s.h5."""
        with h5py.File("s.h5") as file:
            self.assertEqual(file["/tasks/outcome"][0].rstrip(b"\0").decode(), outcome)
            return file["/tasks/message"][0].decode()

    def new(self, kind, name):
        subprocess.run([os.path.join(ANALYSIS, "new.py"), kind, name], check=True, capture_output=True)


class Python(WithPython):
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

    def test_errors_are_the_outcome_of_the_task_with_file_line_and_what_is_expected(self):
        rude = "raise Rude\nclass Rude(Exception):\n    def __str__(self): return 1 / 0"
        kept = "\n        old, self.old = getattr(self, 'old', None), system\n        return old.b if old else None"
        for body, *words in (
                ("return 1 / 0", "mine.py: ZeroDivisionError: division by zero (mine.py:4 in propose)"),
                (rude, "mine.py: Rude: ", "__str__ failed", " (mine.py:4 in propose)"),
                (r"raise ValueError('\ud800 \x1b[31m')", r"ValueError: ? \x1b[31m (mine.py"),
                ("return np.nan * system.b", "mine.py: proposed a guess that is not finite"),
                ("return np.zeros(3)", "mine.py: propose() returned an array of (3,); must be of (48,) or (8, 6)"),
                ("return np.zeros(48, int)", "propose() returned an array of int64; must be of float64 or float32"),
                ("return 'zero'", "array of <U4;"),
                (kept, "RuntimeError: a system can be read during the call that it is passed to"),
                ("return 0 * system.b, -5", "mine.py: counted -5 products with A; must be from 0 to 32000"),
                ("return 0 * system.b, 2 ** 70", "must be from 0 to 32000"),
                ("return 0 * system.b, 'x'", "propose() returned (x0, 'x'); the second must be the number of products with A")):
            with self.subTest(body=body):
                said = self.error(guess("def propose(self, system): " + body))
                for word in words:
                    self.assertIn(word, said)

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

    def test_a_guess_with_two_answers_for_a_system_is_named_in_a_warning(self):
        self.write("mine.py", guess("def propose(self, system): return np.random.rand(len(system.b))"))
        done = self.ran("run", self.job({"python": {"file": "mine.py"}}, "previous"), "-o", "s.h5")
        self.assertIn('; the guess "python mine" gave two different answers for the same system', done.stderr)
        with h5py.File("s.h5") as file:
            self.assertEqual(file["/tasks/outcome"][0].rstrip(b"\0"), b"ok")
            self.assertIn(b'the guess "python mine" gave two', file["/tasks/message"][0])

    def test_within_totals_it_gets_the_sum_of_a_step(self):
        last = guess("def propose(self, system): return self.last.get((system.rod, system.newton))\n"
                     "    def accept(self, system, x): self.last[system.rod, system.newton] = x\n"
                     "    def accept_total(self, rod, step, x): self.last[rod, 0] = x")
        self.write("mine.py", last.replace("options): pass", "options): self.last = {}"))
        own = {"python": {"file": "mine.py"}}
        self.ran("run", self.job("previous", own, {"totals": {"guess": "previous"}}, {"totals": {"guess": own}},
                                 evaluation="closed_loop"), "-o", "s.h5")
        with h5py.File("s.h5") as file:
            sums = {file["/axes/guess"][guess].decode(): file["/tasks/iterations_sum_all"][task, guess].tolist()
                    for task, guess in enumerate(file["/tasks/own_guess"]) if guess >= 0}
        self.assertEqual(sums["python mine"], sums["previous"])
        self.assertEqual(sums["totals python mine"], sums["totals previous"])
        self.assertNotEqual(sums["totals previous"], sums["previous"])

    def test_a_file_that_is_opened_but_not_named_is_told_once_with_the_key_to_write(self):
        self.write("helper.py", "ONE = 1.0\n")
        self.write("other.txt", "1")
        self.write("mine.py", "import json, helper\nfrom multiprocessing import shared_memory\n" + guess(
            "def propose(self, system):\n"
            "        with open('made.txt', 'w') as file: file.write('1')\n"
            "        for name in ('made.txt', 'weights.txt', '/etc/passwd'): open(name).close()\n        return None"))
        self.write("weights.txt", "1")
        helper = 'warning: mine.py opened helper.py, which the job does not name: .*"inputs": \\["helper.py"\\]'
        weights = 'warning: mine.py opened weights.txt, which .*"inputs": \\["helper.py", "weights.txt"\\]'
        for inputs, told in (([], (helper, weights)), (["helper.py"], (weights, )),
                             (["./helper.py", "weights.txt", "other.txt"], ())):
            for ranks in ((), ("-n", "2")):
                job = self.job({"python": {"file": "mine.py", "inputs": inputs}},
                               time={"step_s": {"grid": [0.01, 0.02]}, "steps": 5})
                said = self.ran("run", job, *ranks, "-o", f"{len(inputs)}-{len(ranks)}.h5").stderr
                self.assertEqual(said.count("warning"), len(told), said)
                for words in told:
                    self.assertRegex(said, words)

    def test_a_preconditioner_and_a_plug_in_have_inputs_too(self):
        self.write("mine.py", "class Preconditioner:\n    def __init__(self, rods, options): pass\n"
                   "    def apply(self, r): return float(open('weights.txt').read()) * r\n")
        self.write("weights.txt", "1")
        for inputs in ([], ["weights.txt"]):
            solve = {"preconditioner": "python", "python_preconditioner": {"file": "mine.py", "inputs": inputs}}
            said = self.ran("run", self.job(solve=solve), "-o", f"{len(inputs)}.h5").stderr
            self.assertEqual("mine.py opened weights.txt" in said, not inputs, said)
        job = self.job({"plugin": {"library": "weights.txt", "inputs": ["none.txt"]}})
        said = self.ran("validate", job, code=2).stderr
        self.assertIn('guesses[1].plugin.inputs[0]: "none.txt" is not allowed: none.txt was not found', said)

    def test_an_environment_of_another_python_is_named_with_both_versions(self):
        self.write("mine.py", guess("def propose(self, system): pass"))
        job = self.job({"python": {"file": "mine.py"}})
        own = f"python{sys.version_info[0]}.{sys.version_info[1]}"    # the program embeds the Python of the tests
        for folder, version in (("lib/python3.1/site-packages", "3.1.4"), (f"lib/{own}/site-packages", "")):
            os.makedirs(f"env/{folder}")
            self.write("env/pyvenv.cfg", f"home = /usr/bin\nversion = {version}\n")
            said = self.ran("validate", job, env={**os.environ, "VIRTUAL_ENV": os.path.abspath("env")}).stderr
            words = f"env, of Python 3.1.4: its packages are not found by rodsweep's P{own[1:6]} {own[6:]}; make"
            self.assertEqual(words in said, bool(version), said)

    def test_a_file_is_executed_once_and_each_task_has_an_instance(self):
        self.write("mine.py", "import numpy as np\nlog = open('log', 'a')\nprint('file', file=log, flush=True)\n"
                              "class Guess:\n    def __init__(self, rods, options): print('task', file=log, flush=True)\n"
                              "    def propose(self, system): return None\n")
        self.ran("run", self.job({"python": {"file": "mine.py"}}, **THREE_TASKS), "-o", "s.h5")
        with open("log", encoding="utf-8") as log:
            self.assertEqual(log.read().split(), ["file", "task", "task", "task"])

    @unittest.skipUnless(os.environ.get("TRAINING"), "takes a minute")
    def test_the_modes_of_the_page_save_more_iterations_than_as_many_solutions(self):
        with open(os.path.join(os.environ["SOURCE_DIR"], "docs", "own-guess.md"), encoding="utf-8") as page:
            text = page.read().partition("## A guess that learned")[2].partition("\n## ")[0]
        for name, code in zip(("train.py", "modes_guess.py"), re.findall(r"```python\n(.*?)```", text, re.DOTALL)):
            self.write(name, code)
        self.new("guess", "my_guess.py")
        folder = os.path.dirname(os.environ["RODSWEEP"])
        paths = {"PATH": f"{folder}:{os.environ['PATH']}", "PYTHONPATH": ANALYSIS}
        for commands in re.findall(r"```sh\n(.*?)```", text, re.DOTALL):
            subprocess.run(["bash", "-euo", "pipefail", "-c", commands], check=True,
                           env={**os.environ, **paths}, stdout=subprocess.DEVNULL)
        with h5py.File("results/modes_guess.h5") as file:
            labels = [label.decode() for label in file["/axes/guess"]]
            ratios = dict(zip(labels, file["/tasks/cg_ratio"][:, :, 1].mean(axis=0)))    # to 1e-2
        self.assertLess(ratios["python modes_guess"], 0.8 * ratios["subspace 30"])
        self.assertLess(ratios["subspace 30"], ratios["regression 6"])


ENDLESS = guess("def propose(self, system):\n        if system.step == 2:\n            open('begun', 'w').close()\n"
                "            {}\n        return None")
LOOP, SLEEP = ENDLESS.format("while True: pass"), ENDLESS.format("__import__('time').sleep(1000)")
DEAF = ENDLESS.format("sum(__import__('itertools').repeat(0))")    # in compiled code
THREE_TASKS = {"time": {"step_s": 0.02, "steps": {"grid": [2, 3, 4]}}}


class Calls(WithPython):
    """What a user's code may do to the program that calls it."""

    def begun(self, *words):
        """The program with the guess in mine.py, once that is in its endless call."""
        process = subprocess.Popen([RODSWEEP, "run", self.job({"python": {"file": "mine.py"}}), "-o", "s.h5", *words],
                                   stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + 60
        while not os.path.exists("begun") and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertTrue(os.path.exists("begun"))
        os.remove("begun")
        return process

    def test_the_time_limit_of_the_task_ends_an_endless_call_and_its_line_is_named(self):
        for text in (LOOP, SLEEP):
            self.write("mine.py", text)
            self.ran("run", self.job({"python": {"file": "mine.py"}}), "-o", "s.h5", "--task-time-limit", "3",
                     code=TASKS_FAILED)
            self.assertIn("step 2: the time limit of 3 s has passed (task_time_limit_s or --task-time-limit) "
                          "in mine.py (mine.py:7 in propose)", self.message("timed_out"))
            os.remove("s.h5")

    def test_a_signal_ends_an_endless_call(self):
        for text, number, words, code in ((LOOP, signal.SIGINT, [], STOPPED), (SLEEP, signal.SIGTERM, [], STOPPED),
                                          (LOOP, signal.SIGTERM, ["-n", "2"], 1)):
            with self.subTest(number=number, words=words):
                self.write("mine.py", text)
                process = self.begun(*words)
                process.send_signal(number)
                self.assertEqual(process.wait(60), code)    # of mpirun: 1
                with h5py.File("s.h5") as file:
                    self.assertEqual(file["/runs/exit_code"][0], STOPPED)
                os.remove("s.h5")

    def test_a_second_signal_ends_a_process_whose_call_goes_on(self):
        self.write("mine.py", DEAF)
        process = self.begun()
        process.send_signal(signal.SIGINT)
        while process.poll() is None:
            time.sleep(1)
            process.send_signal(signal.SIGINT)
        self.assertEqual(process.returncode, -signal.SIGINT)

    def test_a_worker_in_a_long_call_is_alive(self):
        self.write("mine.py", guess("def propose(self, system): return None").replace("pass", "__import__('time').sleep(5)"))
        ran = self.ran("run", self.job({"python": {"file": "mine.py"}}), "-o", "s.h5", "-n", "2", "--worker-timeout", "2")
        self.assertNotIn("timed out", ran.stderr)

    def test_no_task_has_the_time_in_which_a_file_is_loaded(self):
        self.write("mine.py", "__import__('time').sleep(4)\n" + guess("def propose(self, system): return None"))
        self.ran("run", self.job({"python": {"file": "mine.py"}}, **THREE_TASKS), "-o", "s.h5", "-n", "2",
                 "--task-time-limit", "3")

    def test_a_process_that_user_code_ends_is_an_error_with_its_name(self):
        for end in ("__import__('os')._exit(0)", "__import__('ctypes').CDLL(None).exit(0)"):
            for words in ([], ["-n", "2"]):
                with self.subTest(end=end, words=words):
                    self.write("mine.py", guess(f"def propose(self, system): {end}"))
                    ran = self.ran("run", self.job({"python": {"file": "mine.py"}}), "-o", "s.h5", *words, code=STOPPED)
                    self.assertIn("rodsweep: error: mine.py ended this process (exit status 0); it must return", ran.stderr)
                    os.remove("s.h5")

    def test_it_may_go_to_another_folder_which_is_its_own(self):
        os.makedirs("code/weights")
        self.write("code/weights/file", "text")
        self.write("code/mine.py", "import os\nos.chdir(os.path.dirname(__file__))\nclass Guess:\n"
                                   "    def __init__(self, rods, options): os.chdir('weights')\n"
                                   "    def propose(self, system): open('file').close()\n")
        for words in ([], ["-n", "2"]):
            self.ran("run", self.job({"python": {"file": "code/mine.py"}}, **THREE_TASKS), *words)
            os.remove("results/s.h5")

    def test_it_may_use_the_processes_of_multiprocessing(self):
        self.write("mine.py", """
import multiprocessing, sys, time
def plus_one(x): return x + 1
class Guess:
    def __init__(self, rods, options):
        version = "import sys; print(sys.version)"
        assert __import__("subprocess").check_output([sys.executable, "-c", version], text=True).strip() == sys.version
        with multiprocessing.Pool(2) as pool: assert pool.map(plus_one, [1, 2]) == [2, 3]
        sleeps = multiprocessing.Process(target=time.sleep, args=(1000,))
        sleeps.start()
        sleeps.terminate()
        sleeps.join()
        assert sleeps.exitcode == -15
    def propose(self, system): return None
""")
        other = os.path.abspath("bin")    # another python3 on the PATH
        os.makedirs(other)
        os.symlink("/bin/false", os.path.join(other, "python3"))
        self.ran("run", self.job({"python": {"file": "mine.py"}}), "-o", "s.h5",
                 env={**os.environ, "PATH": f"{other}:{os.environ['PATH']}"})


if __name__ == "__main__":
    unittest.main()
