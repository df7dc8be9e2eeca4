"""The score: its statistics cover what they say, its settings are of their kinds, its search finds the cheapest, and its
numbers are those of the files. A small scene goes through all of it; the grid is cut to a few values for that."""

import itertools
import json
import os
import re
import shutil
import tempfile
import unittest
from dataclasses import replace
from unittest import mock

import numpy as np
from running import run

import rodsweep
from rodsweep.reading import accuracy
from rodsweep.reading.errors import KeyNotFound, SweepFileError
from rodsweep.reading.job_paths import checksum
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.scoring import answers, scenes, search, settings, sitting, verdicts
from rodsweep.scoring.runs import Measured, Runs
from rodsweep.scoring.settings import KINDS, OF_CG, OWN, Setting, Step

PRETRAINED = os.path.join(os.environ["SOURCE_DIR"], "network", "pretrained")
CG = (settings.ZERO, settings.CALL)
FEW = {"INTEGRATORS": ("bdf2",), "STEPS_S": (0.02, 0.01), "NEWTON": (1,), "TOLERANCES": (1e-2, 1e-3), "LAGS": (0, 4),
       "SWEEPS": (1,), "STOPS": (1,)}
SCENE = {"name": "rod", "kind": "sweep", "seed": 1, "samples": 5, "evaluation": "closed_loop",
         "scene": {"type": "bending_rod", "segments": 6, "length_m": {"uniform": [1, 2]}, "radius_m": 0.05,
                   "density_kg_m3": 1000, "youngs_modulus_pa": 1e7, "torsion_modulus_pa": 1e6, "damping_per_s": 2},
         "time": {"duration_s": 0.32, "step_s": {"grid": [0.0025, 0.00125]}, "integrator": "bdf2", "balance": True,
                  "newton_iterations": 20},
         "solve": {"method": "direct"}, "record": {"solves": "summary", "norms": "none", "trajectory_every": 32}}


def planted(folder):
    """A root with one small scene, and shipped models as its networks."""
    for part in ("jobs/score", "network/pretrained/score"):
        os.makedirs(os.path.join(folder, part))
    with open(os.path.join(folder, "jobs/score/rod_draws.json"), "w", encoding="utf-8") as file:
        json.dump(SCENE, file)
    for name, end in itertools.product(("rods", "rods-large"), ("", "-2", "-3")):
        shutil.copy(os.path.join(PRETRAINED, f"{name}.h5"), os.path.join(folder, f"network/pretrained/score/{name}{end}.h5"))
    shutil.copy(os.path.join(PRETRAINED, "bending-paper-best.h5"), os.path.join(folder, "network/pretrained"))


class Statistics(unittest.TestCase):
    def test_a_bound_is_above_the_median_as_often_as_it_says(self):
        generator = np.random.default_rng(1)
        for draws in (4, 5, 8, 40):
            found = [verdicts.upper_bound(of) >= 0 for of in generator.normal(size=(4000, draws))]
            self.assertGreater(np.mean(found), verdicts.BOUND - 0.015, draws)
        self.assertEqual(verdicts.upper_bound([1, 2, 3]), np.inf)

    def test_what_is_admitted_and_what_a_few_draws_leave_open(self):
        errors = np.full((1, 40), 0.008)

        def with_some(value, count):
            made = errors.copy()
            made[0, :count] = value
            return made

        for failed, admitted, kept in ((0, True, True), (1, True, True), (2, False, True), (3, False, False)):
            self.assertEqual(verdicts.admitted(with_some(np.inf, failed), 0.01), admitted)
            self.assertEqual(verdicts.kept(with_some(np.inf, failed), 0.01), kept)
        self.assertTrue(verdicts.admitted(with_some(0.02, 15), 0.01))
        few = with_some(0.02, 17)    # the 25th smallest bounds
        self.assertEqual([verdicts.admitted(few, 0.01), verdicts.kept(few, 0.01)], [False, True])
        one_fails = np.concatenate([errors, errors, np.full((1, 40), np.inf)])
        self.assertFalse(verdicts.admitted(one_fails, 0.01))    # although the others out-vote it
        for errors, stays in (([0.02] * 5 + [0.009] * 3, False), ([0.02] * 4 + [0.009] * 4, True),
                              ([0.009] * 7 + [np.inf], True), ([0.009] * 6 + [np.inf] * 2, False)):
            self.assertEqual(verdicts.may_keep(np.array(errors), 0.01), stays, errors)

    def test_an_interval_covers_the_factor_as_often_as_it_says(self):
        generator = np.random.default_rng(2)
        for sizes, deviations in (((3, 3, 40), (0.2, 0.02, 0.1)), ((1, 3, 40), (0, 0.05, 0.01)), ((1, 3, 5), (0, 0, 0.2)),
                                  ((3, 3, 5), (0.1, 0.1, 0.1)), ((1, 3, 40), (0, 0, 0.3))):
            covered, of_alike = 0, 0
            for _ in range(300):
                base = np.exp(generator.normal(size=(1, sizes[1], sizes[2])))
                parts = [d * generator.normal(size=tuple(n if k == axis else 1 for k, n in enumerate(sizes)))
                         for axis, d in enumerate(deviations)]
                of = verdicts.factor(1.2 * base * np.exp(sum(parts)), base)
                covered += of.low <= 1.2 <= of.high
                of_alike += verdicts.factor(base * np.exp(sum(parts)), base).p < 0.05
            self.assertGreater(covered, 0.9 * 300, (sizes, deviations))
            self.assertLess(of_alike, 0.1 * 300, (sizes, deviations))

    def test_a_factor_is_that_of_the_draws_that_both_have(self):
        base = np.exp(np.random.default_rng(3).normal(size=(1, 3, 40)))
        times = 1.5 * base
        times[0, 1, 7] = np.nan
        base[0, 0, 9], times[0, 0, 9] = np.nan, 99
        self.assertAlmostEqual(verdicts.factor(times, base).value, 1.5)
        self.assertEqual([verdicts.factor(f * base[..., :5], base[..., :5]).equal() for f in (1.01, 1.06)], [True, False])
        self.assertTrue(np.isnan(verdicts.factor(np.full((1, 3, 4), np.nan), base[..., :4]).value))

    def test_probabilities_are_corrected_as_by_holm(self):
        self.assertEqual(verdicts.holm({"a": 0.01, "b": 0.04, "c": 0.03}), {"a": 0.03, "c": 0.06, "b": 0.06})


class Settings(unittest.TestCase):
    def test_every_way_of_every_kind_is_of_it_has_its_own_text_and_comes_back_from_json(self):
        texts = {}
        for name, kind in itertools.product(scenes.names(), OF_CG):
            axes = scenes.Scene(name).axes(kind)
            ways = [axes.first(), *axes.beside(axes.first()), *axes.screened()]
            self.assertGreater(len(ways), 8)
            for way, newton in itertools.product(ways, (1, 3)):
                setting = way.setting(Step(0.02, "bdf2", newton))
                self.assertIn(kind, setting.kinds())
                self.assertNotIn(OWN, setting.kinds())
                for stop in re.findall(r'"stop_at": ([^,}]+)', setting.guess):
                    self.assertIn(round(float(stop) / json.loads(setting.solve)["tolerance"], 6), settings.STOPS)
                self.assertEqual(Setting.from_json(json.loads(json.dumps(setting.as_json()))), setting)
                self.assertEqual(texts.setdefault(setting.text(), setting), setting)
                self.assertEqual(setting.of_training(2).of_training(1), setting)
                self.assertEqual(len(setting.trainings()), 3 if "/score/" in setting.solve + setting.guess else 1)

    def test_what_is_kept_for_some_steps_is_renewed_about_as_often_as_in_the_long_run(self):
        scene, cholesky = scenes.Scene("bending_rod"), settings.Way('{"preconditioner": "lagged_cholesky"}', 1e-2, '"zero"')
        kept = {name: settings.Way(f'{{"lag_steps": {lag}, "preconditioner": "block_icc"}}', 1e-2, '"zero"')
                for name, lag in (("8", 8), ("32", 32))}
        guess = settings.Way('{"preconditioner": "jacobi"}', 1e-2, '{"copingnet": {"lag_steps": 32, "model": "x.h5"}}')
        for step_s, of in ((0.08, "8"), (0.04, "8 32 guess cholesky"), (0.005, "8 32 guess cholesky")):
            ways = {**kept, "guess": guess, "cholesky": cholesky}
            found = [name for name, way in ways.items() if scene.renews(way.setting(Step(step_s, "bdf2")))]
            self.assertEqual(" ".join(found), of, step_s)
        self.assertTrue(scene.renews(settings.direct(Step(0.08, "bdf2"))))

    def test_a_way_of_another_kind_is_crossed_with_guesses_of_this_kind_alone(self):
        axes = {kind: scenes.Scene("bending_rod").axes(kind) for kind in OF_CG}
        way = settings.Way('{"preconditioner": "lagged_cholesky"}', 1e-3, '"zero"')
        for kind in OF_CG:
            found = axes[kind].crossed(way, axes[kind].guesses)
            self.assertEqual(bool(found), kind != settings.JACOBI)
            for other in found:
                self.assertIn(kind, other.setting(Step(0.02, "bdf2")).kinds())
                self.assertEqual((other.preconditioner, other.tolerance), (way.preconditioner, way.tolerance))

    def test_frames_of_all_steps_are_at_the_instants_of_the_reference(self):
        for name in scenes.names():
            scene = scenes.Scene(name)
            instants = round(scene.job["time"]["duration_s"] / scene.instant_s, 9)
            self.assertEqual(instants, int(instants), name)
            self.assertGreaterEqual(instants, 5)
            every, of_gauss_seidel = scene.steps()
            self.assertEqual({step.step_s for step in every}, {step.step_s for step in of_gauss_seidel})
            self.assertIn(settings.STEPS_S[0], {step.step_s for step in every})
            self.assertGreaterEqual(len({step.step_s for step in every}), 4)

    def test_the_program_takes_every_way_of_every_scene_and_names_its_guess_alike(self):
        with tempfile.TemporaryDirectory() as folder:
            planted(folder)
            scene = scenes.Scene("rod", folder)
            for kind in OF_CG:
                axes = scene.axes(kind)
                some = [way.setting(Step(0.02, "bdf2", 2)) for way in [axes.first(), *axes.beside(axes.first())]]
                job = scene.job_of(some, scenes.TUNING, 1)
                job["time"]["duration_s"] = 0.32
                guesses = job["guesses"][0]["zip"]
                listed = {**job, "guesses": list({json.dumps(guess): guess for guess in guesses}.values())}
                self.assertEqual(rodsweep.Job(**job).plan(probe=False)["tasks"], len(some))
                plain = rodsweep.Job(**{**listed, "time": {"step_s": 0.02, "steps": 1}, "solve": {"method": "cg"}})
                own = {settings.guess_text(guess) for guess in listed["guesses"]}
                self.assertEqual(sorted(plain.plan(probe=False)["guesses"]), sorted(own))


class OneSitting(unittest.TestCase):
    SAME = {"host": "a", "revision": "r", "versions": "v", "petsc_options": ""}
    RUNS = [{**SAME, "begin": "2026-11-28T10:00:00Z", "end": "2026-11-28T10:20:00Z"},
            {**SAME, "begin": "2026-11-28T10:21:00Z", "end": "2026-11-28T10:40:00Z"}]

    def test_times_of_different_sittings_are_refused(self):
        sitting.require_one(self.RUNS)
        for key, value in (*((name, "other") for name in sitting.SAME), ("end", "2026-11-28T11:00:01Z")):
            with self.assertRaisesRegex(SweepFileError, "times of different sittings are not compared"):
                sitting.require_one([self.RUNS[0], {**self.RUNS[1], key: value}])


class Judged(unittest.TestCase):
    @staticmethod
    def answer(kind, time, error=0.005, failed=0, tuning=None):
        errors = np.append(np.full(40 - failed, error), np.full(failed, np.inf))[None]
        setting = Setting(Step(0.02, "bdf2"), f'{{"method": "{kind}"}}')
        noise = np.exp(0.05 * np.random.default_rng(int(1e3 * time)).normal(size=(1, 3, 40)))
        return answers.Answer(0.01, kind, setting, tuning or time, errors, 0, 0, time * noise)

    def test_a_kind_has_a_factor_if_it_keeps_to_the_error_on_the_draws_for_testing(self):
        found = answers.judged({a.kind: a for a in (
            self.answer("a", 1), self.answer("b", 1.005), self.answer("c", 2), self.answer("d", 0.5, error=0.02),
            self.answer("e", 0.5, failed=3))})
        self.assertEqual({kind: answer.verdict for kind, answer in found.items()},
                         {"a": "the base", "b": "equal", "c": "slower", "d": "", "e": ""})
        self.assertAlmostEqual(found["c"].factor.value, 2, delta=0.05)
        self.assertEqual(answers.judged({"d": found["d"]}), {"d": found["d"]})

    def test_a_setting_of_two_kinds_is_one_test(self):
        some = {a.kind: a for a in (self.answer("a", 1), self.answer("b", 1.03), self.answer("c", 1.5))}
        shared = {**some, "d": replace(some["b"], kind="d"), "e": replace(some["b"], kind="e")}
        with mock.patch.object(verdicts, "holm", side_effect=verdicts.holm) as holm:
            verdict = {kind: answer.verdict for kind, answer in answers.judged(shared).items()}
        self.assertEqual(len(holm.call_args.args[0]), 2)
        self.assertEqual({verdict[kind] for kind in "bde"}, {answers.judged(some)["b"].verdict})

    def test_a_guess_of_the_user_is_no_base(self):
        found = answers.judged({a.kind: a for a in (self.answer(OWN, 1, tuning=0.1), self.answer("b", 1.5))})
        self.assertEqual({kind: answer.verdict for kind, answer in found.items()}, {OWN: "faster", "b": "the base"})

    def test_the_base_is_the_cheapest_on_the_draws_for_tuning(self):
        found = answers.judged({a.kind: a for a in (self.answer("a", 1, tuning=0.4), self.answer("b", 0.5))})
        self.assertEqual({kind: answer.verdict for kind, answer in found.items()}, {"a": "the base", "b": "faster"})


class Small(unittest.TestCase):
    """One small scene, from the search to the table."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.enterClassContext(mock.patch.multiple(settings, **FEW))
        cls.enterClassContext(mock.patch.object(search, "OF_CG", CG))
        cls.enterClassContext(mock.patch.multiple(sitting, PARTS=2, REPETITIONS=2))
        planted(cls.folder.name)
        cls.scene = scenes.Scene("rod", cls.folder.name)
        cls.work = os.path.join(cls.folder.name, "work")
        cls.search = search.Search(Runs(cls.scene, cls.work, 1))
        cls.candidates = cls.search.run()
        cls.held = sitting.Sitting(cls.scene, cls.work).hold(cls.candidates)
        chosen, times = sitting.chosen_and_times(json.loads(json.dumps(cls.held)))
        cls.search.runs.measure(times, scenes.TEST)
        minutes = answers.training_minutes(cls.folder.name, [setting for setting, _ in chosen.values()])
        cls.scored = answers.Scored("rod", "rod", checksum(cls.scene.job), "r", "2026-11-28", cls.search.reference,
                                    cls.search.tried(), cls.search.levels, minutes,
                                    answers.answers_of(chosen, times, cls.search.runs))

    def test_errors_are_distances_from_the_finer_reference_at_fixed_instants(self):
        some = [settings.direct(Step(step, "bdf2")) for step in (0.02, 0.01)]
        with SweepFile(os.path.join(self.work, "rod_reference_tuning.h5")) as file:
            fine = np.flatnonzero(file.parameter("time.step_s").values == 0.00125)
            exact = [accuracy.frames(file, task) for task in fine]
            self.assertEqual(sorted(exact[0])[::2], [0, 80, 160, 240, 320])
        for setting in some:
            path = os.path.join(self.folder.name, f"{setting.step.step_s}.h5")
            with rodsweep.Job(**self.scene.job_of([setting], scenes.TUNING, 5)).run(output=path, workers=1) as results:
                file = results.file
                own = [accuracy.frames(file, task) for task in range(5)]
                self.assertEqual(list(own[0]), [0, 80, 160, 240, 320])
                size = np.linalg.norm(np.ptp(exact[1][0], axis=0))
                error = max(np.sqrt(((own[1][t] - exact[1][t]) ** 2).sum(1).mean()) / size for t in own[1])
                self.assertAlmostEqual(self.search.runs.results(setting, samples=2).error[1] / error, 1, 3)
        coarse, fine = (np.median(self.search.runs.results(setting, samples=2).error) for setting in some)
        self.assertGreater(coarse, 2 * fine)    # of second order

    def test_the_draws_for_testing_are_others(self):
        lengths = []
        for draws in scenes.DRAWS:
            self.search.runs.reference(draws)
            with SweepFile(os.path.join(self.work, f"rod_reference_{draws}.h5")) as file:
                lengths.append(set(file.parameter("scene.length_m").values.tolist()))
        self.assertEqual(len(set().union(*lengths)), 15)

    def test_candidates_are_admitted_and_no_cheaper_one_was_found(self):
        self.assertEqual(self.search.levels, [1e-1, 1e-2, 1e-3])
        for (level, kind), some in self.candidates.items():
            for setting in some:
                self.assertIn(kind, setting.kinds())
                self.assertTrue(verdicts.admitted(self.search.errors(setting), level))
                for training in setting.trainings():
                    self.assertEqual(len(self.search.runs.results(training).error), 5)
            known = self.search.admitted(level, kind)
            self.assertEqual(some, known[:len(some)])
            self.assertLessEqual(len(some), search.FINALISTS)
        self.assertTrue(all(self.candidates[1e-2, kind] for kind in (settings.DIRECT, *CG)))
        coarse, fine = (self.search.admitted(level, settings.DIRECT) for level in (1e-1, 1e-3))
        self.assertLessEqual(set(fine), set(coarse))    # what keeps to a small error keeps to a larger one
        self.assertEqual(list(self.search.tried()), [kind for kind in KINDS if kind != OWN])
        self.assertEqual(self.search.tried()[settings.DIRECT], 4)

    def test_what_is_known_is_not_simulated_again_and_a_line_that_was_being_written_is(self):
        shown = []
        copied = os.path.join(self.folder.name, "copied")
        shutil.copytree(self.work, copied)
        known = Runs(self.scene, copied, 1, shown.append)
        self.assertLessEqual(set(self.search.runs.known), set(known.known))
        self.assertEqual(search.Search(known).run(), self.candidates)
        self.assertEqual([line for line in shown if "settings" in line], [])
        with open(known.path, "r+", encoding="utf-8") as file:
            text = file.read()
            file.truncate(len(text) - 9)
        cut = Runs(self.scene, copied, 1)
        self.assertEqual(len(cut.known), len(known.known) - 1)
        last = next(iter(set(known.known) - set(cut.known)))
        known.publish()
        self.addCleanup(os.remove, self.scene.measured(".jsonl.xz"))
        elsewhere = Runs(self.scene, os.path.join(self.folder.name, "elsewhere"), 1)
        self.assertEqual(set(elsewhere.known), set(cut.known))    # of the file as it is now
        cut.measure([last[0]], *last[1:])
        np.testing.assert_array_equal(cut.results(*last).error, known.results(*last).error)

    def test_what_was_measured_belongs_to_its_job_its_models_and_its_program(self):
        root = os.path.join(self.folder.name, "changed")
        for part in ("jobs", "network"):
            shutil.copytree(os.path.join(self.folder.name, part), os.path.join(root, part))
        work = os.path.join(root, "work")
        shutil.copytree(self.work, work)
        scene = scenes.Scene("rod", root)
        with open(os.path.join(root, "network/pretrained/score/rods-2.h5"), "ab") as file:
            file.write(b"another")
        known = Runs(scene, work, 1)
        lost = set(self.search.runs.known) - set(known.known)
        self.assertTrue(lost)
        self.assertEqual({"rods-2" in setting.guess for setting, _, _ in lost}, {True})

        with mock.patch("rodsweep.scoring.runs.made_by", lambda: "another program"):
            other = Runs(scene, work, 1)
            before = {key: of.time_s.copy() for key, of in other.known.items()}
            new = settings.direct(Step(0.02, "bdf2", 3))
            other.measure([new], samples=2)
            with open(other.path, encoding="utf-8") as file:
                scale = json.loads(file.readlines()[-2])["scale"]
            again = Runs(scene, work, 1)
            key = next(iter(set(before) - {(new, scenes.TUNING, 2)}))
            np.testing.assert_allclose(again.known[key].time_s, scale * before[key], rtol=1e-12)
            self.assertEqual({key: list(of.time_s) for key, of in again.known.items()},
                             {key: list(of.time_s) for key, of in other.known.items()})
        with open(other.path, encoding="utf-8") as file:
            lines = [json.loads(line) for line in file]
        for entry in lines:
            entry["error"] = [value and 1.01 * value for value in entry.get("error", [])]
        with open(other.path, "w", encoding="utf-8") as file:
            file.writelines(json.dumps(entry) + "\n" for entry in lines)
        with self.assertRaisesRegex(SweepFileError, "has other errors than this program gives"):
            Runs(scene, work, 1).measure([settings.direct(Step(0.01, "bdf2", 3))], samples=2)
        scene.job["seed"] += 1
        with self.assertRaisesRegex(SweepFileError, "is of another jobs/score/rod_draws.json: restore that, or remove"):
            Runs(scene, work, 1)

    def test_times_are_not_taken_before_the_search_is_complete(self):
        runs = Runs(self.scene, os.path.join(self.folder.name, "nothing"), 1, complete=True)
        with self.assertRaisesRegex(KeyNotFound, "the search of rod is not complete: run score.py --errors rod"):
            search.Search(runs).run()

    def test_candidates_are_near_the_cheapest(self):
        some = {settings.direct(Step(step, "bdf2")): Measured(np.full(5, 0.001), np.full(5, time), np.zeros(5), np.zeros(5))
                for step, time in ((2, 2.1), (3, 4), (4, 4.3))}
        found = search.Search.__new__(search.Search)
        found.runs = mock.Mock(results=lambda setting: some[setting])
        self.assertEqual([setting.step.step_s for setting in found.near(list(some))], [2, 3])

    def test_a_large_scene_tries_what_was_the_cheapest_on_a_smaller_one(self):
        best = {kind: search.best(self.search.runs, 1e-2, kind) for kind in CG}
        for kind, some in best.items():
            self.assertTrue(some)
            self.assertEqual(some[0], search.promising(self.search.runs, 1e-2, kind)[0])
            for part in (Setting.preconditioner, lambda setting: setting.guess):
                self.assertGreaterEqual(len({part(setting) for setting in some}), 1 if kind == settings.ZERO else 2)
        with mock.patch.multiple(search, BEST=2, LEVELS=(1e-2,)):
            large = search.Search(Runs(self.scene, os.path.join(self.folder.name, "large"), 1), self.search.runs)
            found = large.run()
        ways = {(setting.solve, setting.guess) for kind in CG for setting in best[kind]}
        tried = {(s.solve, s.guess) for s in search.tried(large.runs) if s.kinds() & set(CG)}
        self.assertTrue(tried)
        self.assertLessEqual(tried, ways)
        self.assertTrue(found[1e-2, settings.ZERO])

    def test_a_smaller_scene_has_the_same_networks(self):
        for large, small in scenes.SMALLER.items():
            self.assertEqual(scenes.Scene(large).axes(settings.CALL).guesses, scenes.Scene(small).axes(settings.CALL).guesses)

    def test_the_table_comes_back_from_its_file_and_has_every_kind(self):
        path = os.path.join(self.folder.name, "analysis/results/score/rod.json")
        os.makedirs(os.path.dirname(path), exist_ok=True)
        self.scored.write(path)
        done = run("score.py", "rod", "--root", self.folder.name, "-o", self.folder.name, "--format", "png")
        self.assertEqual(done.code, 0, done.stderr)
        self.assertEqual(done.stdout.splitlines()[:-2], answers.table(self.scored))
        blocks = done.stdout.split("\n\n")
        for block, level in zip(blocks, ("10", "1", "0.1")):
            lines = block.splitlines()
            self.assertTrue(lines[0].startswith(f"rod, error {level} % "), lines[0])
            self.assertEqual([line.split("  ")[0] for line in lines[1:]], [kind for kind in KINDS if kind != OWN])
            self.assertIn(sum(" the base " in line for line in lines[1:]), (0, 1) if level == "0.1" else (1,))    # 0.08 %
        self.assertRegex(blocks[3], r"rods +- - -")    # models that an earlier version trained
        self.assertRegex(blocks[4], rf"^rod: version {answers.PROTOCOL} of the rules, program \w+(-dirty)?, 20")
        self.assertIn(os.path.join(self.folder.name, "score.png"), done.stdout)
        self.own_guess()
        self.again()

    def again(self):
        done = run("score.py", "rod", "--again", "--root", self.folder.name, "--work", self.work)
        self.assertEqual(done.code, 0, done.stderr)
        rows = [line.split("  ")[0] for line in done.stdout.splitlines()[1:]]
        factors = [kind for level in self.scored.levels for kind, answer in self.scored.at(level).items()
                   if answer.factor and answer.verdict != answers.BASE]
        self.assertEqual(rows, factors)
        self.assertRegex(done.stdout, r" (within|apart|intervals overlap)(, [\\w, -]+ does not keep)*\n")

    def own_guess(self):
        guess = os.path.join(self.folder.name, "none.py")
        with open(guess, "w", encoding="utf-8") as file:
            file.write("class Guess:\n    def __init__(self, rods, options): pass\n"
                       "    def propose(self, system): return 0 * system.b\n")
        done = run("score.py", guess, "rod", "--root", self.folder.name, "--samples", "4", "--work", self.work)
        self.assertEqual(done.code, 0, done.stderr)
        lines = done.stdout.splitlines()
        self.assertEqual([line.split("  ")[0] for line in lines[1:9]], list(KINDS))
        self.assertRegex(lines[8], "^your guess +[0-9.]+ .* from python none to ")

    def test_a_scene_without_results_says_how_to_measure_it(self):
        root = os.path.join(self.folder.name, "unmeasured")
        shutil.copytree(os.path.join(self.folder.name, "jobs"), os.path.join(root, "jobs"))
        done = run("score.py", "rod", "--root", root)
        self.assertEqual(done.code, 2)
        self.assertIn("rod was not measured: run score.py --errors rod, then --times rod", done.stderr)
        with self.assertRaisesRegex(KeyNotFound, "rod comes first: run score.py --errors rod, then --times rod"):
            Runs(scenes.Scene("rod", root), self.work, 1).require_timed()    # before a scene that uses what is known of it
        self.assertIn("scene 'trees'", run("score.py", "trees").stderr)
