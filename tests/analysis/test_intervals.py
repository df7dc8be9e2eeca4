"""Bootstrap intervals: their centre, their coverage, the units of resampling."""

import unittest

import synthetic  # noqa: F401  (makes analysis/ importable)
import numpy as np
from rodsweep.reading import intervals


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


if __name__ == "__main__":
    unittest.main()
