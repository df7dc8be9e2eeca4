"""rodsweep.Job with the program (RODSWEEP): runs, resumed runs, messages of the command line."""

import io
import json
import os
import signal
import subprocess
import sys
import time
import types
import unittest
import unittest.mock
from pathlib import Path

import synthetic
import numpy as np
import rodsweep
from rodsweep import jobs, program, progress
from rodsweep.reading import job_paths
from running import Scripts

ROD = {"type": "bending_rod", "segments": 6, "length_m": rodsweep.uniform(1, 5), "radius_m": 0.05,
       "density_kg_m3": 1000, "youngs_modulus_pa": 1e5, "torsion_modulus_pa": 1e6}
TIME = {"step_s": 0.02, "steps": 4}
LEARNED = {"network": {"encoding": "linear_system", "processor": "factors", "latent": 16},
           "training": {"epochs": 1, "batch": 4, "shards": 2}}


def tiny(name="tiny", **changes):
    keys = {"seed": 7, "samples": 3, "scene": ROD, "time": TIME, "guesses": ["zero", "previous"]}
    return rodsweep.Job(name, **{**keys, **changes})


def exit_codes(results):
    """Of all runs of the file."""
    return [run["exit_code"] for run in results.file.runs()]


class Bar(io.StringIO):
    def isatty(self):
        return True


class WithJobs(Scripts):
    def run_job(self, job, **options):
        results = job.run(**{"progress": False, **options})
        self.addCleanup(results.close)
        return results

    def interrupted(self, job, **options):
        """Runs the job until it shows its first progress, and presses Ctrl-C."""
        def show(text):
            if text:
                signal.raise_signal(signal.SIGINT)

        with unittest.mock.patch.object(jobs, "line", lambda: show), self.assertRaises(KeyboardInterrupt):
            job.run(**options)


class Runs(WithJobs):
    def test_a_sweep_is_checked_planned_and_run_with_the_values_of_numpy(self):
        scene = {**ROD, "segments": rodsweep.grid(np.array([6, 9])), "density_kg_m3": np.float64(900),
                 "gravity_m_s2": np.array([0, -9.81, 0])}
        job = tiny(seed=np.int64(7), scene=scene, solve={"tolerance": np.float32(0.5)})
        job.validate()
        plan = job.plan(workers=2)
        self.assertEqual((plan["tasks"], plan["workers"], plan["steps"]), (6, 2, 24))
        self.assertGreater(plan["core_hours"], 0)
        self.assertIn("\nswept                     scene.segments, scene.length_m\n", str(plan))
        results = self.run_job(job)
        self.assertEqual(results.job, job.values)
        solves = results.solves()
        self.assertEqual({*solves["scene.segments"]}, {6, 9})
        self.assertEqual({*results.tasks(["scene.density_kg_m3"])["scene.density_kg_m3"]}, {900})
        self.assertTrue((solves[solves.guess == "zero"]["iterations_1e-2"] > 0).all())

    def test_a_complete_file_is_opened_and_not_touched(self):
        first = self.run_job(tiny())
        before = os.stat("results/tiny.h5")
        again = self.run_job(tiny())
        self.assertEqual(os.stat("results/tiny.h5").st_mtime_ns, before.st_mtime_ns)
        self.assertTrue(first.steps().equals(again.steps()))

    def test_an_interrupted_run_is_resumed(self):
        for workers in (1, 2):
            with self.subTest(workers=workers):
                job = tiny(f"long{workers}", samples=200, time={"step_s": 0.02, "steps": 40})
                self.interrupted(job, workers=workers)
                with rodsweep.open(f"results/{job.name}.h5") as part:
                    self.assertGreater(part.census().pending, 0)
                    self.assertEqual(exit_codes(part), [4])
                results = self.run_job(job, workers=workers)
                self.assertEqual((results.census().ok, results.missing), (200, ""))
                self.assertEqual(exit_codes(results), [4, 0])

    def test_a_run_stops_when_python_is_killed(self):
        Path("endless.py").write_text("class Guess:\n    def __init__(self, rods, options): pass\n"
                                      "    def propose(self, system):\n        while True: pass\n", encoding="utf-8")
        for guess in ("previous", {"python": {"file": "endless.py"}}):
            with self.subTest(guess=guess):
                job = tiny(samples=1000, time={"step_s": 0.02, "steps": 100}, guesses=["zero", guess])
                job.write("job.json")
                code = ("import os; from rodsweep import jobs; jobs.line = lambda: lambda text: os.kill(os.getpid(), 9); "
                        "jobs.Job.read('job.json').run()")
                killed = subprocess.run([sys.executable, "-B", "-c", code], check=False,
                                        env={**os.environ, "PYTHONPATH": synthetic.ANALYSIS})
                self.assertEqual(killed.returncode, -signal.SIGKILL)
                begin, ended = time.monotonic(), [-1]
                while ended != [4] and time.monotonic() < begin + 60:
                    with rodsweep.open("results/tiny.h5") as part:
                        ended = exit_codes(part)
                self.assertEqual(ended, [4])
                os.remove("results/tiny.h5")

    def test_it_runs_where_there_are_no_pseudo_terminals(self):
        with unittest.mock.patch("pty.openpty", side_effect=OSError("out of pty devices")):
            self.assertEqual(self.run_job(tiny(), workers=2).census().ok, 3)
            with self.assertRaisesRegex(rodsweep.JobError, "seed"):
                tiny(seed=-1).validate()

    def test_a_data_set_a_training_and_the_use_of_its_model(self):
        data = tiny("data", kind="dataset", guesses=None).run(progress=False)
        net = rodsweep.Job("net", kind="train", seed=1, data=data, validation_simulations=1, **LEARNED)
        self.assertEqual(net.plan(probe=False)["training_simulations"], 2)
        model = net.run(progress=False)
        self.assertEqual((data, model), ("results/data.h5", "results/net.h5"))
        self.assertEqual(net.run(progress=False), model)
        use = tiny("use", guesses=["zero", {"copingnet": {"model": Path(model)}}])
        self.assertEqual(self.run_job(use, output=Path("used.h5")).census().ok, 3)
        os.chdir("results")    # the path still starts where the job was made
        self.assertEqual(self.run_job(use, output="../used.h5").missing, "")
        use.write("use.json")
        self.assertEqual(json.loads(Path("use.json").read_text())["guesses"][1], {"copingnet": {"model": "net.h5"}})
        os.chdir("..")
        self.assertEqual(self.run_job(rodsweep.Job.read("results/use.json").changed(name="other")).census().ok, 3)


class Messages(WithJobs):
    def refused(self, call):
        with self.assertRaises(rodsweep.JobError) as caught:
            call()
        self.assertIsInstance(caught.exception, rodsweep.UserError)
        return str(caught.exception)

    def command_line(self, job, *words):
        """The program's error for the job in a file; its name is replaced as rodsweep.Job does."""
        job.write("x.json")
        said = subprocess.run([program.path(), *words], capture_output=True, text=True, check=False)
        self.assertEqual(said.returncode, 2)
        return said.stderr.partition("rodsweep: error: ")[2].rstrip("\n").replace("x.json", job.name)

    def test_errors_are_those_of_the_command_line(self):
        self.run_job(tiny())
        wrong = tiny(samplees=3, scene={**ROD, "radius_m": -1})
        said = self.command_line(wrong, "validate", "x.json")
        self.assertRegex(said, "^tiny: scene.radius_m: -1 is not allowed; must be a number above 0 .*\n"
                               r'tiny: samplees: unknown key; did you mean "samples"\?$')
        for call in (wrong.validate, wrong.plan, wrong.run, lambda: wrong.run(workers=2)):
            self.assertEqual(self.refused(call), said)
        nan = tiny(samples=np.nan)
        self.assertEqual(self.refused(nan.validate), self.command_line(nan, "validate", "x.json"))
        other = tiny(seed=8)
        said = self.command_line(other, "run", "x.json", "-o", "results/tiny.h5", "--resume")
        self.assertEqual(self.refused(other.run), said)
        self.assertIn("holds the results of another job than tiny: seed was 7 and is 8", said)
        self.assertEqual(self.refused(rodsweep.Job.read("x.json").run), said.replace("than tiny", "than x.json"))
        said = self.refused(lambda: rodsweep.Job.read("none.json"))
        self.assertEqual(said, "none.json: cannot be read: No such file or directory")
        said = self.refused(lambda: tiny().run(retry_faild=True))
        self.assertIn('unknown option --retry-faild; did you mean "--retry-failed"?', said)
        self.assertEqual(self.refused(tiny(seed={1}).validate), "tiny: Object of type set is not JSON serializable")

    def test_what_utf8_does_not_have_is_refused(self):
        for job in (tiny("\ud800"), tiny(description="\ud800"), tiny(**{"\ud800": 1})):
            with self.subTest(job=job.values), self.assertRaisesRegex(rodsweep.JobError, "surrogates not allowed") as raised:
                job.run()
            str(raised.exception).encode()
        with self.assertRaisesRegex(rodsweep.JobError, r"^\\ud800.h5: surrogates not allowed$"):
            tiny().run(output="\ud800.h5")

    def test_a_missing_file_is_named_with_the_folder_where_its_path_starts(self):
        said = self.refused(tiny(guesses=["zero", {"copingnet": {"model": "m/none.h5"}}]).run)
        self.assertIn(f"{self.folder}/m/none.h5 was not found; the path is relative to {self.folder}", said)

    def test_failed_tasks_and_warnings_of_the_program_are_warnings(self):
        with self.assertWarnsRegex(rodsweep.JobWarning, "^results/tiny.h5: 0 of 3 tasks ok, failed: 3 timed_out\n"
                                   "  task 0 timed_out: step 0: the time limit of 1e-09 s has passed .*\n"
                                   "  task 1 timed_out: .*\n  task 2 timed_out: .*$"):
            self.run_job(tiny(), task_time_limit=1e-9)
        with self.assertWarnsRegex(rodsweep.JobWarning, "3 timed_out"):
            self.run_job(tiny())
        with self.assertWarnsRegex(rodsweep.JobWarning, "^results/tiny.h5: 3 tasks .* are run again"):
            self.assertEqual(self.run_job(tiny(), retry_failed=True).missing, "")
        with self.assertWarnsRegex(rodsweep.JobWarning, "^tiny: scene.radius_m: 50 m is outside") as caught:
            tiny(scene={**ROD, "radius_m": 50}).validate()
        self.assertEqual(caught.filename, __file__)    # the line of the user

    def test_a_warning_of_failed_tasks_has_the_lines_that_the_program_prints(self):
        Path("g.py").write_text("class Guess:\n    def __init__(self, rods, options): pass\n"
                                "    def propose(self, system): return 1 / 0\n")
        job = tiny(samples=12, guesses=["zero", {"python": {"file": "g.py"}}])
        with self.assertWarns(rodsweep.JobWarning) as caught:
            self.run_job(job)
        job.write("x.json")
        said = subprocess.run([program.path(), "run", "x.json", "-o", "x.h5"], capture_output=True, text=True, check=False)
        printed = [line for line in said.stdout.splitlines() if line.startswith("  ")]
        self.assertEqual(str(caught.warning).splitlines()[1:], printed)
        self.assertIn("  task 4 error: g.py: ZeroDivisionError: division by zero (g.py:3 in propose)", printed)
        self.assertEqual(printed[-1], "  and 7 more")

    def test_retrained_weights_do_not_give_the_results_of_old_ones(self):
        Path("g.py").write_text("class Guess:\n"
                                "    def __init__(self, rods, options): self.w = float(open('w.txt').read())\n"
                                "    def propose(self, system): return self.w * system.b\n")
        Path("w.txt").write_text("0")

        def job(**keys):
            return tiny(guesses=["zero", {"python": {"file": "g.py", **keys}}])

        with self.assertWarnsRegex(rodsweep.JobWarning, r'^g.py opened w.txt, .* "inputs": \["w.txt"\]$'):
            self.run_job(job(), output="unnamed.h5")
        self.run_job(job(inputs=["w.txt"]))
        Path("w.txt").write_text("1e-9")
        self.assertRegex(self.refused(job(inputs=["w.txt"]).run),
                         "input files of the job have changed: .*/g.py, .*/w.txt")

    def test_a_run_that_stops_early_says_why(self):
        words = r"^no task ended within the time limit of .*\. \(exit code 5\)$"
        with self.assertRaisesRegex(rodsweep.JobError, words) as caught:
            tiny(time={"step_s": 0.02, "steps": 10000}).run(time_limit=1e-9)
        self.assertEqual(caught.exception.code, 5)

    def test_a_missing_program_is_named(self):
        with unittest.mock.patch.dict(os.environ, RODSWEEP="/nowhere/rodsweep"):
            self.assertIn("the program /nowhere/rodsweep was not found", self.refused(tiny().validate))
        Path("rodsweep").touch(mode=0o755)
        with unittest.mock.patch.dict(os.environ, PATH=self.folder):
            del os.environ["RODSWEEP"]
            self.assertEqual(program.path(), f"{self.folder}/rodsweep")


class Parts(WithJobs):
    def test_sweeps_are_those_of_the_job_format(self):
        grids = [rodsweep.grid(1, "a"), rodsweep.grid([1, 2]), rodsweep.grid([0, 1], [1, 0]), rodsweep.grid("ab")]
        self.assertEqual([sweep["grid"] for sweep in grids], [[1, "a"], [1, 2], [[0, 1], [1, 0]], ["ab"]])
        self.assertEqual(rodsweep.zip(range(2)), {"zip": [0, 1]})
        for word in ("uniform", "log_uniform", "integer"):
            self.assertEqual(getattr(rodsweep, word)(1, 2), {word: [1, 2]})

    def test_a_changed_job_leaves_the_first_as_it_was(self):
        job = tiny()
        other = job.changed(seed=8, guesses=None)
        other.values["seed"] = 9
        self.assertEqual((job.values["seed"], other.values["seed"], "guesses" in other.values), (7, 8, False))

    def test_keys_of_input_files_are_found_in_guesses(self):
        guesses = [{"python": {"file": "a", "inputs": ["b", "c"]}},
                   {"plugin": {"library": "d", "inputs": {"grid": [["e"], []]}}},
                   {"knn": {"data": "f", "inputs": {"grid": ["all", "shape"]}}}]
        self.assertEqual(job_paths.given({"guesses": guesses}), list("abcdef"))

    def test_the_bar_fits_its_terminal(self):
        narrow = unittest.mock.patch.dict(os.environ, {"TERM": "xterm", "COLUMNS": "20"})
        with unittest.mock.patch("sys.stderr", Bar()) as shown, narrow:
            progress.line()("x" * 40)
        self.assertEqual(shown.getvalue(), "\r\x1b[K" + "x" * 19)

    def test_a_terminal_and_a_notebook_show_the_bar(self):
        with unittest.mock.patch.dict(os.environ, TERM="xterm"), unittest.mock.patch("sys.stderr", Bar()) as terminal:
            tiny(samples=200, time={"step_s": 0.02, "steps": 40}).run().close()
        self.assertRegex(terminal.getvalue(), r"^(\r\x1b\[K\[[#.]{24}\] \d+ of 200 tasks [^\r]*)+\r\x1b\[K$")
        output = unittest.mock.Mock()
        notebook = types.SimpleNamespace(get_ipython=lambda: types.SimpleNamespace(kernel=1),
                                         display=lambda *_, **__: output)
        with unittest.mock.patch.dict(sys.modules, {"IPython": notebook, "IPython.display": notebook}):
            progress.line()("[#] 1")
        output.update.assert_called_once_with({"text/plain": "[#] 1"}, raw=True)
        with unittest.mock.patch("sys.stderr", io.StringIO()) as log:
            progress.line()("[#] 1")
        self.assertEqual(log.getvalue(), "")
