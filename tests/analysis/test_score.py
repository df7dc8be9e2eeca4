"""score.py: settings are chosen on one file and measured on another, and its numbers are those of the files' rows."""

import json
import os
import shutil
import subprocess
import tempfile
import unittest

from running import Folder, run
import numpy as np
from rodsweep.reading import score
from rodsweep.reading.accuracy import Way, way_of
from rodsweep.reading.sweepfile import SweepFile

MODEL = os.path.join(os.environ["SOURCE_DIR"], "network", "pretrained", "rods.h5")


def runs(error, time_s):
    draws = np.arange(5)
    return score.Runs(draws, np.full(5, error), np.asarray(time_s) * np.ones(5), np.ones(5))


SEEDS = {"rods-2": "rods", "rods-3": "rods"}


def setting(guess="", preconditioner="jacobi", step_s=0.01, method="cg"):
    way = Way(method, 1, 0, 1e-2, preconditioner, guess) if guess else Way(method, 1)
    return score.Setting(way, "bdf2", step_s, seeds=SEEDS)


class Choice(unittest.TestCase):
    FOUND = {setting(method="direct"): runs(0.005, 7), setting("zero"): runs(0.05, 5),
             setting("previous", "learned rods"): runs(0.05, 6),
             setting("zero", "block_icc"): runs(0.005, 4), setting("previous"): runs(0.05, 4.5),
             setting("copingnet rods"): runs(0.05, 2), setting("previous", "icc"): runs(np.inf, 0.1),
             setting("copingnet rods", step_s=0.005): runs(0.008, [1, 2, 9, 9, 9])}

    def test_each_answer_is_the_fastest_of_its_kind_that_reaches_the_error(self):
        best = score.chosen(self.FOUND)
        self.assertEqual({answer: best.get((0.1, answer)) for answer in score.ANSWERS}, {
            "cheapest of all": setting("copingnet rods"), "direct solve": setting(method="direct"),
            "Gauss-Seidel": None, "your guess": None,
            "CG from zero": setting("zero", "block_icc"),
            "CG, classical guess": setting("previous"), "CG, learned guess": setting("copingnet rods"),
            "CG, learned preconditioner": setting("previous", "learned rods"),
            "CG, Jacobi": setting("copingnet rods")})
        self.assertEqual(best[0.01, "cheapest of all"], setting("zero", "block_icc"))
        self.assertEqual(best[0.01, "CG, Jacobi"], setting("copingnet rods", step_s=0.005))
        self.assertNotIn((0.01, "CG, classical guess"), best)
        self.assertFalse([level for level, _ in best if level < 0.005])

    def test_cg_that_reaches_an_error_by_chance_does_not_count(self):
        found = {setting(method="direct"): runs(0.2, 3), setting("zero"): runs(0.05, 2),
                 setting(method="direct", step_s=0.005): runs(0.05, 6), setting("zero", step_s=0.005): runs(0.05, 4)}
        best = score.chosen(found)
        self.assertEqual(best[0.1, "CG from zero"], setting("zero", step_s=0.005))
        self.assertEqual(best[0.1, "direct solve"], setting(method="direct", step_s=0.005))

    def test_a_quotient_is_the_median_over_draws_that_both_have(self):
        slow = score.Runs(np.arange(1, 7), np.zeros(6), 2.0 * np.arange(1, 7), np.ones(6))
        base = score.Runs(np.arange(6), np.zeros(6), np.arange(6) + 1.0, np.ones(6))
        factor = score.factor([slow], base)
        self.assertAlmostEqual(float(factor.value), np.median(2 * np.arange(1, 6) / np.arange(2, 7)))
        self.assertEqual(int(factor.count), 5)

    def test_learned_settings_have_the_median_of_their_trainings_and_the_interval_of_all(self):
        learned, base = setting("copingnet rods 5 lag 8"), runs(0, [1, 1, 1, 1, 1])
        found = {setting(f"copingnet rods{seed} 5 lag 8"): runs(0, [time] * 5)
                 for seed, time in (("", 2), ("-2", 5), ("-3", 4))}
        found |= {setting("copingnet rods-large 5 lag 8"): base, setting("copingnet rods-2 5 lag 9"): base,
                  setting("copingnet rods-32 5 lag 8"): base}
        factor = score.factor(score.trainings(learned, found), base)
        self.assertEqual([float(factor.value), float(factor.low), float(factor.high)], [4, 2, 5])

    def test_a_setting_is_chosen_by_one_training_and_shown_with_all(self):
        found = {setting(method="direct"): runs(0.005, 7), setting("zero"): runs(0.05, 5)}
        for seed, time in (("", 4), ("-2", 3), ("-3", 9)):
            found[setting("zero", f"learned rods{seed}")] = runs(0.05, time)
        best = score.chosen(found)[0.1, "CG, learned preconditioner"]
        self.assertEqual(best, setting("zero", "learned rods"))
        self.assertEqual(len(score.trainings(best, found)), 3)

    def test_seeds_are_the_models_in_the_folder_seeds_beside_one_of_the_job(self):
        names = ("rods", "rods-32", "seeds/rods-2", "seeds/net-2")
        guesses = [{"copingnet": {"model": f"models/{name}.h5"}} for name in names]
        solve = {"zip": [{"learned_preconditioner": {"model": "models/seeds/rods-3.h5"}}]}
        self.assertEqual(score.seeds_in({"guesses": guesses, "solve": solve}), SEEDS)


class Ways(Folder):
    def test_a_way_has_what_applies_to_its_method(self):
        file = self.open(scenes=("helix",), guesses=("zero", "previous"), samples=1, newton=2, closed_loop=True, grid={
            "solve.method": ["direct", "xpbd", "cg"], "solve.iterations": [5],
            "solve.forcing": ["fixed", "eisenstat_walker"]})
        ways = dict.fromkeys(way_of(file, task) for task in range(file.task_count))
        self.assertEqual(list(ways), [
            Way("direct", 2), Way("xpbd", iterations=5),
            *(Way("cg", 2, 0, 1e-2, "jacobi", guess, forcing) for forcing in (False, True) for guess in file.guesses)])
        texts = [way.text() for way in ways]
        self.assertEqual(texts[:3] + texts[-1:], [
            "direct, Newton 2", "xpbd 5", "CG jacobi from zero to 1e-2, Newton 2",
            "CG jacobi from previous to 1e-2 with forcing terms, Newton 2"])


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        models = os.path.join(cls.folder.name, "models")
        os.makedirs(os.path.join(models, "seeds"))
        for name in ("rods.h5", "seeds/rods-2.h5", "seeds/rods-large-2.h5"):
            shutil.copy(MODEL, os.path.join(models, name))
        steps = {"grid": [0.02, 0.01]}
        job = {"name": "rod_tuning", "kind": "sweep", "seed": 1, "samples": 2, "evaluation": "closed_loop",
               "scene": {"type": "bending_rod", "segments": 6, "length_m": {"uniform": [1, 2]}, "radius_m": 0.05,
                         "density_kg_m3": 1000, "youngs_modulus_pa": 1e7, "torsion_modulus_pa": 1e6, "damping_per_s": 2},
               "time": {"duration_s": 0.32, "step_s": {"zip": [0.0025, steps, steps]},
                        "integrator": {"zip": ["bdf2", {"grid": ["euler", "bdf2"]}, "bdf2"]},
                        "newton_iterations": {"zip": [20, 1, {"grid": [1, 2]}]}},
               "solve": {"zip": [{"method": "direct"}, {"method": "direct"},
                                 {"preconditioner": {"grid": ["jacobi", "block_icc", "learned"]}, "tolerance": 1e-2,
                                  "max_iterations": 500, "learned_preconditioner": {"model": "models/rods.h5"}}]},
               "guesses": ["zero", "previous", "linear", {"copingnet": {"model": "models/rods.h5"}}],
               "record": {"solves": "summary", "norms": "none", "trajectory_every": 4}}
        cls.tuning, cls.test = (os.path.join(cls.folder.name, f"rod_{which}.h5") for which in ("tuning", "test"))
        cls.run_job(job, cls.tuning)

    @staticmethod
    def run_job(job, results):
        path = results.replace(".h5", ".json")
        if job:
            with open(path, "w", encoding="utf-8") as file:
                json.dump(job, file)
        subprocess.run([os.environ["RODSWEEP"], "run", path, "-o", results], check=True, capture_output=True)

    def test_numbers_are_those_of_the_rows(self):
        with SweepFile(self.tuning) as file:
            found = score.runs(file)
            self.assertEqual(len(found), 4 + 2 * 2 * 3 * 4)
            rows, step = file.parameter("time.step_s").values, file.parameter("time.integrator").values
            direct = found[score.Setting(Way("direct", 1), "euler", 0.02)]
            task = next(task for task in range(file.task_count) if rows[task] == 0.02 and step[task] == "euler"
                        and file.own_guess[task] < 0 and file.sample[task] == 1)
            of = slice(file.first_step[task], file.first_step[task] + 16)
            seconds = (file.h5["/timing/steps/rest_s"][of] + file.h5["/timing/steps/solve_s"][of]).astype(float)
            self.assertAlmostEqual(direct.time_s[1], np.minimum(seconds, 5 * np.median(seconds)).sum() / 0.32, 6)
            order = {size: np.median(found[score.Setting(Way("direct", 1), "bdf2", size)].error) for size in (0.02, 0.01)}
            self.assertGreater(order[0.02], 2 * order[0.01])   # of second order
            self.assertEqual(direct.products.tolist(), [0, 0])

    def test_settings_are_measured_on_other_draws_and_shown(self):
        done = run("score.py", "--jobs", self.tuning)
        self.assertEqual(done.code, 0, done.stderr)
        self.run_job(None, self.test)
        with SweepFile(self.tuning) as tuning, SweepFile(self.test) as test:
            self.assertEqual(len(np.unique(test.sample)), 10)
            lengths = [set(file.parameter("scene.length_m").values.tolist()) for file in (tuning, test)]
            self.assertFalse(lengths[0] & lengths[1])
            found, chosen = score.runs(test), score.chosen(score.runs(tuning))
            self.assertLessEqual(set(chosen.values()), set(found))
            self.assertEqual({setting.text(): setting.solve for setting in chosen.values()},
                             {setting.text(): setting.solve for setting in found if setting in set(chosen.values())})
            self.assertEqual(chosen[0.1, "CG from zero"].solve["max_iterations"], 500)
            for answer in ("CG, learned guess", "CG, learned preconditioner"):
                way = chosen[0.1, answer].way    # which guess is the fastest with a preconditioner depends on the clock
                learned = way.guess.startswith("copingnet") + way.preconditioner.startswith("learned")
                self.assertEqual(len(score.trainings(chosen[0.1, answer], found)), 2**learned, way)
        done = run("score.py", self.tuning, "-o", self.folder.name, "--format", "png")
        self.assertEqual(done.code, 0, done.stderr)
        blocks = [block.splitlines() for block in done.stdout.split("\n\n\n")[0].split("\n\n")]
        self.assertEqual([block[0].split("  ")[0] for block in blocks], [
            *(f"bending rod, error {level} %" for level in ("10", "1", "0.1")),
            "bending rod, error 0.01 %: reached by no setting on the tuning draws", "model"])
        self.assertRegex(blocks[-1][1], r"^rods +[\d.]+ +120$")
        self.assertRegex(blocks[0][1], r"cheapest of all +[\d.]+ +1 +1 to 1 ")
        self.assertEqual([line.split("  ")[0] for line in blocks[0][1:]], list(score.ANSWERS[:-1]))
        self.assertIn(os.path.join(self.folder.name, "score.png"), done.stdout)

    def test_a_guess_in_python_has_its_row_beside_the_others(self):
        here = os.getcwd()
        self.addCleanup(os.chdir, here)
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            done = run("score.py", "--jobs", self.tuning, "-o", ".")
            self.assertEqual(done.code, 0, done.stderr)
            with open("half.py", "w", encoding="utf-8") as file:
                file.write("class Guess:\n    def __init__(self, rods, options): pass\n"
                           "    def propose(self, system): return 0 * system.b\n")
            done = run("score.py", "half.py", "rod_test.json", "--workers", "1")
            self.assertEqual(done.code, 0, done.stderr)
            size = 1e-6 * os.path.getsize("results/rod_test_half.h5")
            with SweepFile("results/rod_test_half.h5") as file:
                words = f"1 new file in results/ will have {file.task_count} tasks and take {size:.0f} MB"
            self.assertIn(words, done.stderr)
            block = done.stdout.split("\n\n")[0].splitlines()
            self.assertEqual([line.split("  ")[0] for line in block[1:]], list(score.ANSWERS))
            self.assertRegex(block[-1], r"^your guess +[\d.]+ .* from python half ")
            again = run("score.py", "half.py", "rod_test.json", "--workers", "1")
            self.assertEqual(again.stdout, done.stdout)    # of the same results
            self.assertNotIn("new file", again.stderr)
