"""What is averaged and what is kept apart: panels by scene and gridded keys, points along x, bins. Bootstrap intervals:
their centre, their coverage, the units of resampling."""

import unittest

import running
import numpy as np
from rodsweep.reading import groups, intervals, measures
from rodsweep.reading.errors import KeyNotFound

SIZES_AND_STEPS = {"scene.segments": [10, 20], "time.step_s": [0.01, 0.02]}


class Groups(running.Folder):
    def simulations(self, **settings):
        return super().simulations(**{"steps": 1, **settings})

    def test_a_panel_per_scene_and_a_point_per_number_of_segments(self):
        file, sims = self.simulations()
        panels = groups.panels(file, sims, "scene.segments")
        self.assertEqual([panel.title() for panel in panels], ["Bending rod", "Helix"])
        points = groups.points(file, sims, panels[1], "scene.segments")
        self.assertEqual(list(points.position), [10, 20, 40])
        self.assertEqual([len(rows) for rows in points.index], [4, 4, 4])
        for value, rows in zip((10, 20, 40), points.index):
            self.assertEqual(set(file.parameter("scene.segments").values[sims.any_task[rows]]), {value})
            self.assertEqual(set(file.scene_types()[sims.any_task[rows]]), {"helix"})

    def test_what_does_without_a_key_stands_beside_what_has_it(self):
        key = "scene.contact.friction"
        file, sims = self.simulations(grid={"scene.segments": [10, 20], key: [float("nan"), 0.3]}, scenes=("helix",))
        self.assertEqual(len(groups.applicable(file, sims, key)), len(sims) // 2)
        both = sims.subset(groups.applicable(file, sims, key, without=True))
        self.assertEqual(len(both), len(sims))
        panel, = groups.panels(file, both, key, pooled="scene.")
        points = groups.points(file, both, panel, key)
        self.assertEqual(points.text, ["0.3", "none"])
        self.assertEqual([len(rows) for rows in points.index], [len(sims) // 2] * 2)

    def test_random_keys_are_averaged_over_and_gridded_ones_kept_apart(self):
        file, sims = self.simulations(grid=SIZES_AND_STEPS, scenes=("helix",))
        self.assertEqual(groups.gridded_keys(file, sims.any_task, "scene.segments"), ["time.step_s"])
        panels = groups.panels(file, sims, "scene.segments")
        self.assertEqual([panel.title() for panel in panels],
                         ["Helix, time.step_s = 0.01", "Helix, time.step_s = 0.02"])
        self.assertEqual([len(panel.index) for panel in panels], [8, 8])
        table = groups.panels(file, sims, None, pooled="scene.")
        self.assertEqual([panel.settings for panel in table], [{"time.step_s": "0.01"}, {"time.step_s": "0.02"}])

    def test_guesses_that_vary_are_never_averaged(self):
        file, sims = self.simulations(grid={"scene.segments": [10], "guesses[1]": ["previous", "oracle"],
                                     "guesses[1].oracle.error": [np.nan, 0.1, 0.2]}, scenes=("helix",), samples=2)
        tasks = file.parameter("guesses[1]").values == "previous"
        keep = tasks == np.isnan(file.parameter("guesses[1].oracle.error").values)  # "previous" has no error parameter
        sims = sims.subset(np.flatnonzero(keep[sims.any_task]))
        for panels in (groups.panels(file, sims, "scene.segments"), groups.panels(file, sims, None, pooled="scene.")):
            self.assertEqual([panel.settings for panel in panels],
                             [{"guesses[1]": "previous"}, {"guesses[1]": "oracle", "guesses[1].oracle.error": "0.1"},
                              {"guesses[1]": "oracle", "guesses[1].oracle.error": "0.2"}])
        rows = groups.applicable(file, sims, "guesses[1].oracle.error")
        self.assertEqual(set(file.parameter("guesses[1]").values[sims.any_task[rows]]), {"oracle"})

    def test_direct_tasks_stand_beside_every_setting_of_the_solver_and_no_other_grid(self):
        grid = {"scene.segments": [10], "solve.tolerance": [0.1, 0.01], "time.step_s": [0.01, 0.02]}
        file, sims = self.simulations(grid=grid, scenes=("helix",), samples=2)
        direct = file.parameter("solve.tolerance").values[sims.any_task] == 0.01
        sims = measures.Simulations(sims.task, sims.any_task, sims.sample, ~direct)
        panels = groups.with_direct(sims, groups.panels(file, sims))
        self.assertEqual([panel.settings for panel in panels], [{"solve.tolerance": "0.1", "time.step_s": "0.01"},
                                                                {"solve.tolerance": "0.1", "time.step_s": "0.02"}])
        for panel in panels:
            self.assertEqual(sorted(direct[panel.index].tolist()), [False, False, True, True])
            self.assertEqual(len(set(file.parameter("time.step_s").values[sims.any_task[panel.index]])), 1)
        self.assertEqual(groups.short_titles(panels), ["tolerance 0.1, time step 0.01", "tolerance 0.1, time step 0.02"])

    def test_keys_in_step_with_x_and_the_guess_of_a_closed_loop_make_no_panels(self):
        file, sims = self.simulations(grid={"scene.segments": [10, 20]}, scenes=("helix",), samples=2)
        self.assertEqual(groups.gridded_keys(file, sims.any_task, "scene.segments"), [])
        file, sims = self.simulations(closed_loop=True, failed={3: "diverged"}, samples=2)
        self.assertEqual([panel.settings for panel in groups.panels(file, sims, "scene.segments")], [{}, {}])

    def test_too_many_panels_ask_for_a_choice(self):
        file, sims = self.simulations(grid={"scene.segments": [10, 20], "time.step_s": [0.01 * k for k in range(1, 5)]})
        with self.assertRaisesRegex(KeyNotFound, r"8 panels.*at most 6.*time.step_s.*--select"):
            groups.panels(file, sims, "scene.segments")

    def test_many_values_of_x_are_binned_with_equal_counts(self):
        file, sims = self.simulations(grid={"scene.segments": [10]}, samples=24, scenes=("helix",))
        panel, = groups.panels(file, sims, "scene.youngs_modulus_pa")
        points = groups.points(file, sims, panel, "scene.youngs_modulus_pa")
        self.assertTrue(points.binned)
        self.assertEqual([len(rows) for rows in points.index], [3] * groups.BINS)
        self.assertTrue((np.diff(points.position) > 0).all())
        self.assertEqual(sorted(np.concatenate(points.index)), list(range(24)))

    def test_text_parameters_are_categories_in_order_of_appearance(self):
        file, sims = self.simulations(scenes=("helix", "bending_rod"), grid={"scene.segments": [10]})
        panel, = groups.panels(file, sims, "scene.type")
        points = groups.points(file, sims, panel, "scene.type")
        self.assertTrue(points.categorical)
        self.assertEqual(points.text, ["helix", "bending_rod"])

    def test_a_key_without_meaning_for_a_scene_leaves_it_out(self):
        file, sims = self.simulations(samples=2)
        rows = groups.applicable(file, sims, "scene.length_m")
        self.assertEqual(set(file.scene_types()[sims.any_task[rows]]), {"bending_rod"})
        helices = sims.subset(file.scene_types()[sims.any_task] == "helix")
        with self.assertRaisesRegex(KeyNotFound, "'scene.length_m'"):
            groups.applicable(file, helices, "scene.length_m")


class Centres(unittest.TestCase):
    def test_mean_and_median_of_each_column(self):
        values = np.array([[1.0, 5], [2, 5], [6, 5], [7, 8]])
        np.testing.assert_allclose(intervals.mean(values).value, [4, 5.75])
        np.testing.assert_allclose(intervals.median(values).value, [4, 5])

    def test_nan_is_left_out_and_counted_out(self):
        estimate = intervals.mean(np.array([[1.0, np.nan], [3, np.nan], [np.nan, np.nan]]))
        self.assertEqual(estimate.value[0], 2)
        self.assertEqual(list(estimate.count), [2, 0])
        self.assertTrue(np.isnan([estimate.value[1], estimate.low[1], estimate.high[1]]).all())

    def test_shapes_follow_the_values(self):
        estimate = intervals.mean(np.ones((3, 4, 2)))
        self.assertEqual(estimate.value.shape, (4, 2))
        self.assertEqual(estimate[1, 0].value, 1)
        self.assertEqual(intervals.median(np.ones((0, 4))).count.shape, (4,))


class Intervals(unittest.TestCase):
    def test_medians_of_several_are_those_of_each(self):
        generator = np.random.default_rng(3)
        values = {"flat": generator.normal(size=9), "deep": generator.normal(size=(9, 2, 3)),
                  "gaps": np.where(generator.random((9, 4)) < 0.3, np.nan, 1.0) * generator.normal(size=(9, 4))}
        draws = np.array([0, 0, 1, 2, 3, 4, 5, 5, 6])
        together = intervals.medians(values, draws)
        self.assertEqual(list(together), list(values))
        for name, of in values.items():
            alone = intervals.median(of, draws)
            for part in ("value", "low", "high", "count"):
                np.testing.assert_array_equal(getattr(together[name], part), getattr(alone, part), name)
        self.assertEqual(intervals.medians({}), {})

    def test_without_resamples_there_is_a_value_and_no_interval_and_equal_values_have_one_of_no_width(self):
        estimate = intervals.mean(np.arange(8.0), resamples=0)
        self.assertEqual(float(estimate.value), 3.5)
        self.assertTrue(np.isnan([estimate.low, estimate.high]).all())
        estimate = intervals.mean(np.full(5, 0.5))
        self.assertEqual((estimate.low, estimate.high), (0.5, 0.5))

    def test_fewer_than_five_draws_have_no_interval(self):
        values = np.arange(8.0)
        for draws in (1, 4):
            self.assertTrue(np.isnan(intervals.mean(values[:draws]).low))
            self.assertTrue(np.isnan(intervals.mean(values, draws=np.arange(8) % draws).low))
        self.assertLess(intervals.mean(values[:5]).low, 2)

    def test_simulations_of_one_draw_are_resampled_together(self):
        """Ten copies of each draw give the same interval as one copy."""
        values = np.random.default_rng(3).normal(size=6)
        single = intervals.mean(values)
        self.assertEqual(single.low, intervals.mean(values).low)    # reproducible
        copied = intervals.mean(np.repeat(values, 10), draws=np.repeat(np.arange(6), 10))
        independent = intervals.mean(np.repeat(values, 10))
        np.testing.assert_allclose([copied.low, copied.high], [single.low, single.high])
        self.assertLess(independent.high - independent.low, 0.5 * (copied.high - copied.low))

    def test_intervals_of_means_cover_the_truth_as_often_as_they_say(self):
        """Five simulations reach 90 %, plain percentiles 83 %."""
        generator = np.random.default_rng(5)
        for n, least in ((5, 0.88), (20, 0.925)):
            values = 0.4 + 0.1 * generator.normal(size=(n, 600))
            estimate = intervals.mean(values, resamples=1500)
            covered = np.mean((estimate.low <= 0.4) & (0.4 <= estimate.high))
            self.assertGreater(covered, least, f"n = {n}")
            self.assertLess(covered, 0.985, f"n = {n}")

    def test_intervals_of_medians_cover_the_truth(self):
        values = np.exp(np.random.default_rng(6).normal(size=(15, 300)))
        estimate = intervals.median(values, resamples=1000)
        covered = np.mean((estimate.low <= 1) & (1 <= estimate.high))
        self.assertGreater(covered, 0.92)

    def test_more_simulations_narrow_the_interval_as_the_square_root(self):
        generator = np.random.default_rng(7)
        widths = [np.mean(e.high - e.low) for n in (20, 80)
                  for e in [intervals.mean(generator.normal(size=(n, 100)), resamples=1000)]]
        self.assertAlmostEqual(widths[0] / widths[1], 2, delta=0.3)


class Trainings(unittest.TestCase):
    def test_where_all_trainings_agree_the_interval_is_that_of_simulations(self):
        values = np.random.default_rng(3).normal(1, 0.2, (20, 1)).repeat(3, axis=1)
        alone, together = intervals.mean(values[:, 0]), intervals.mean_over_trainings(values)
        np.testing.assert_allclose([together.value, together.low, together.high],
                                   [alone.value, alone.low, alone.high], rtol=1e-12)

    def test_where_all_simulations_agree_it_is_students_over_the_trainings(self):
        values = np.tile([0.9, 1.0, 1.2], (20, 1))
        found = intervals.mean_over_trainings(values)
        half = 4.302652729911275 * np.std([0.9, 1.0, 1.2], ddof=1) / np.sqrt(3)   # t of two degrees of freedom
        np.testing.assert_allclose([found.value, found.low, found.high], [31 / 30, 31 / 30 - half, 31 / 30 + half], rtol=1e-9)

    def test_it_covers_what_both_kinds_of_chance_leave_of_the_mean(self):
        generator, hits = np.random.default_rng(7), 0
        for _ in range(200):
            values = generator.normal(0, 0.3, (12, 1)) + generator.normal(0, 0.2, (1, 3))
            found = intervals.mean_over_trainings(values)
            hits += bool(found.low <= 0 <= found.high)
        self.assertGreater(hits, 180)
