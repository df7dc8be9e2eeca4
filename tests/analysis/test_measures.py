"""Derived numbers against planted ones: CG ratios, times, speedups, steps; paired and closed loop; excluded rows."""

import synthetic
import numpy as np
from rodsweep.reading import measures, timings
from running import Folder

CG, GUESS, REST = "timing/solves/cg_s", "timing/solves/guess_s", "timing/steps/rest_s"
ONE_SIZE = {"grid": {"scene.segments": [20]}, "scenes": ("helix",), "steps": 5, "newton": 3}


class Varied(synthetic.Plant):
    """Qualities that differ between simulations, so that a ratio of sums differs from a mean of ratios."""

    def zero_iterations(self, segments, tolerance):
        return 100 * segments

    def ratio(self, guess, tolerance, newton, segments, draw):
        if guess == "zero":
            return 1.0
        return (0.2 + 0.1 * draw) if newton == 0 else 0.8


class Ratios(Folder):
    def test_planted_qualities_come_back_at_the_first_newton_iteration(self):
        file, sims = self.simulations()
        ratios = measures.cg_counts(file, sims, "first")
        self.assertEqual(ratios.ratio.shape, (24, 4, 8))
        for g, quality in enumerate((1, 0.5, 0.25, 0.1)):
            np.testing.assert_allclose(ratios.ratio[:, g], quality, rtol=0.01)  # iterations are whole numbers
        ten_segments = file.parameter("scene.segments").values[sims.any_task] == 10
        np.testing.assert_allclose(ratios.per_solve[ten_segments, 0, 0], 220)

    def test_all_newton_iterations_are_a_ratio_of_sums(self):
        file, sims = self.simulations(plant=Varied(), newton=3)
        ratios = measures.cg_counts(file, sims, "all")
        draws = sims.sample
        np.testing.assert_allclose(ratios.ratio[:, 1, 0], (0.2 + 0.1 * draws + 0.8 + 0.8) / 3)
        self.assertTrue(np.isnan(ratios.solves).all())

    def test_failed_and_pending_tasks_are_left_out_and_counted(self):
        file, sims = self.simulations(pending=(0, 7), failed={1: "diverged", 2: "diverged", 9: "timed_out"})
        census = measures.census(file, np.ones(24, dtype=bool))
        self.assertEqual(len(sims), 24 - 5)
        self.assertEqual(census.text(), "19 of 24 tasks ok, failed: 2 diverged, 1 timed_out, 2 pending")

    def test_solves_that_missed_the_tolerance_are_counted(self):
        plant = synthetic.Plant(reached=synthetic.unless("previous", 1e-3))
        file, sims = self.simulations(plant=plant, steps=5, newton=3)
        first, every = (measures.cg_counts(file, sims, newton).unreached for newton in ("first", "all"))
        np.testing.assert_array_equal(first[0, 1], [0, 0, 5, 5, 5, 5, 5, 5])
        np.testing.assert_array_equal(every[0, 1, 2], 15)
        np.testing.assert_array_equal(first[:, [0, 2, 3]], 0)

    def test_a_zero_guess_without_iterations_makes_no_ratio(self):
        plant = synthetic.Plant(zero_iterations=lambda segments, tolerance: 0 if segments == 10 else 50)
        file, sims = self.simulations(plant=plant)
        ratio = measures.cg_counts(file, sims, "first").ratio
        none = file.parameter("scene.segments").values[sims.any_task] == 10
        self.assertTrue(np.isnan(ratio[none]).all())
        self.assertTrue(np.isfinite(ratio[~none]).all())


class ClosedLoop(Folder):
    def test_guesses_are_paired_with_the_zero_task_of_their_point(self):
        file, sims = self.simulations(closed_loop=True, plant=Varied())
        self.assertTrue(sims.closed_loop)
        self.assertEqual((len(sims), file.task_count), (24, 96))
        ratio = measures.cg_counts(file, sims, "first").ratio
        np.testing.assert_allclose(ratio[:, 2, 3], 0.2 + 0.1 * sims.sample)
        np.testing.assert_allclose(ratio[:, 0], 1)

    def test_it_says_the_same_as_a_paired_sweep_of_the_same_numbers(self):
        found = []
        for closed_loop in (False, True):
            file, sims = self.simulations(closed_loop=closed_loop)
            by_newton = timings.times(file, sims)
            found.append([measures.cg_counts(file, sims, "all").ratio, *timings.speedups(by_newton, "first").values(),
                          *timings.speedups(by_newton, "all", "direct").values()])
        for paired, closed in zip(*found):
            np.testing.assert_allclose(closed, paired)

    def test_without_its_zero_task_a_point_has_no_ratio_and_without_one_guess_only_that_one_lacks(self):
        file, sims = self.simulations(closed_loop=True, failed={0: "diverged", 5: "diverged"})
        ratio = measures.cg_counts(file, sims, "first").ratio
        self.assertTrue(np.isnan(ratio[0]).all())
        np.testing.assert_array_equal(np.isnan(ratio[1, :, 0]), [False, True, False, False])
        self.assertTrue(np.isfinite(ratio[2:]).all())
        speedup = timings.speedups(timings.times(file, sims), "first")["cg"]
        np.testing.assert_array_equal(np.isnan(speedup), np.isnan(ratio[..., 0]))


class Times(Folder):
    def setUp(self):
        super().setUp()
        file, self.sims = self.simulations(grid={"scene.segments": [20]}, steps=5, newton=3)
        self.by_newton = timings.times(file, self.sims)

    def test_sums_over_the_first_and_over_all_newton_iterations(self):
        times = self.by_newton["first"]
        np.testing.assert_array_equal(times.solves, 5)
        np.testing.assert_allclose(times.cg_s[0], 5 * 20e-6 * np.array([1, 0.5, 0.25, 0.1]), rtol=1e-6)
        np.testing.assert_allclose(times.guess_s[0], 5 * 2e-6 * np.array([0, 1, 1, 1]), rtol=1e-6)
        np.testing.assert_allclose(times.zero_cg_s[0], 5 * 20e-6, rtol=1e-6)
        np.testing.assert_allclose(times.direct_s[0], 5 * 8e-6, rtol=1e-6)
        times = self.by_newton["all"]
        np.testing.assert_array_equal(times.solves, 15)
        np.testing.assert_allclose(times.cg_s[0, 0], 5 * 20e-6 * (1 + 0.5 + 0.5), rtol=1e-6)
        np.testing.assert_allclose(times.rest_s[0], 5 * 3e-6, rtol=1e-6)

    def test_three_speedups_over_zero_guess_cg_and_over_the_direct_solve(self):
        found = timings.speedups(self.by_newton, "first")
        self.assertAlmostEqual(found["cg"][0, 1], 20 / 10, places=5)
        self.assertAlmostEqual(found["guess_cg"][0, 1], 20 / (10 + 2), places=5)
        zero_step, guess_step = 3 * 2 + 20 * 2 + 3, 3 * 2 + 3 * 2 + 10 * 2 + 3  # us per step: assemble, guess, CG, rest
        self.assertAlmostEqual(found["step"][0, 1], zero_step / guess_step, places=5)
        for values in found.values():
            np.testing.assert_allclose(values[:, 0], 1, rtol=1e-6)
        found = timings.speedups(self.by_newton, "first", "direct")
        self.assertAlmostEqual(found["cg"][0, 3], 8 / 2, places=5)
        self.assertAlmostEqual(found["guess_cg"][0, 3], 8 / (2 + 2), places=5)
        self.assertAlmostEqual(found["step"][0, 3], (3 * 2 + 3 * 8 + 3) / (3 * 2 + 3 * 2 + 2 * 2 + 3), places=5)
        direct = timings.direct_speedups(self.by_newton, "first", 0)
        self.assertAlmostEqual(direct["cg"][0], 20 / 8, places=5)

    def test_the_whole_step_has_all_newton_iterations_in_either_choice(self):
        first, every = (timings.speedups(self.by_newton, newton) for newton in ("first", "all"))
        np.testing.assert_array_equal(first["step"], every["step"])
        self.assertFalse(np.allclose(first["guess_cg"][:, 1], every["guess_cg"][:, 1]))


class Changes(Folder):
    """Times before and after changes to rows of single solves."""

    def times(self, *changes, **settings):
        file, self.sims = self.simulations(**{**ONE_SIZE, **settings})
        return timings.times(file, self.sims), timings.times(self.changed(*changes), self.sims)

    @staticmethod
    def not_run(rows, guesses):
        return [(path, (rows, guesses), np.nan) for path in (GUESS, CG)]


class Holes(Changes):
    def test_rows_that_were_not_run_count_for_nobody(self):
        """Newton converged early: the row of every guess is NaN."""
        _, times = self.times(*self.not_run(slice(2, 15, 3), slice(None)))
        np.testing.assert_array_equal(times["all"].solves[0], 10)
        np.testing.assert_allclose(timings.speedups(times, "all")["cg"][0, 1], 2, rtol=1e-5)

    def test_a_row_without_one_guess_is_no_row_of_zero_for_it(self):
        _, times = self.times(*self.not_run(slice(0, 6, 3), 1))
        np.testing.assert_array_equal(times["first"].solves[0], [5, 3, 5, 5])
        np.testing.assert_allclose(times["first"].zero_cg_s[0], 20e-6 * np.array([5, 3, 5, 5]), rtol=1e-6)


class Interruptions(Changes):
    def test_a_solve_that_the_system_interrupted_is_left_out_and_counted(self):
        before, after = self.times((CG, (3, 1), 4e-3), ("timing/solves/assemble_s", 20, 2e-3), (REST, 7, 3e-3))
        for newton in ("first", "all"):
            for against in ("zero", "direct"):
                found = (timings.speedups(times, newton, against).values() for times in (before, after))
                for one, other in zip(*found):
                    np.testing.assert_allclose(other, one, rtol=1e-5)
        np.testing.assert_allclose(after["first"].cg_s, before["first"].cg_s, rtol=1e-6)
        np.testing.assert_allclose(after["all"].rest_s, before["all"].rest_s, rtol=1e-6)
        np.testing.assert_array_equal(after["all"].interrupted[:, 0], [1, 1, 0, 0])
        self.assertEqual(timings.interruptions(before["all"], self.sims), "")
        self.assertIn("2 of 60 solves", timings.interruptions(after["all"], self.sims))

    def test_a_solve_that_needed_many_iterations_is_not_one(self):
        many = 14 * (10 + timings.FIXED) - timings.FIXED
        times = self.times((CG, (0, 0), 14 * 20e-6), ("solves/iterations", (0, 0), many))[1]["first"]
        self.assertEqual(times.interrupted.sum(), 0)
        np.testing.assert_allclose(times.cg_s[0, 0], (4 + 14) * 20e-6, rtol=1e-5)

    def test_a_solve_that_renews_a_lagged_factor_is_not_one(self):
        renewed = np.zeros((60, 4), dtype="i1")
        renewed[[0, 6, 12]] = 1     # the first Newton iterations of steps 0, 2 and 4
        rows = [0, 6, 12, 9]        # and the first one of step 3
        times = self.times(("solves/renewed", None, renewed), (CG, (rows, 0), lambda cg: cg + 1e-3))[1]["all"]
        np.testing.assert_array_equal(times.interrupted[0], 1)
        np.testing.assert_allclose(times.cg_s[0, 0], (3e-3 + 4 * 20e-6) * 5 / 4 + 10 * 10e-6, rtol=1e-5)

    def test_a_guess_that_is_slow_at_the_first_newton_iteration_loses_nothing_there(self):
        """Like k nearest neighbours of a data set of first iterations: the first iteration takes 40 times as long."""
        before, after = self.times((GUESS, (slice(0, None, 3), 2), lambda guess: 40 * guess),
                                   (GUESS, (3, 2), 4e-3), steps=40)    # interrupted as well
        self.assertEqual(after["all"].interrupted[:, 0].sum(), 1)
        np.testing.assert_allclose(after["first"].cg_s, before["first"].cg_s, rtol=1e-6)
        np.testing.assert_allclose(after["first"].guess_s[:, 2], 40 * before["first"].guess_s[:, 2], rtol=1e-6)
        self.assertNotIn("trusted", timings.interruptions(after["all"], self.sims))

    def test_a_guess_that_is_slow_where_its_factors_are_made_anew_loses_nothing_there(self):
        renewed, anew = np.zeros((480, 4), dtype="i1"), (slice(0, 120, 24), 2)
        renewed[anew] = 1
        before, after = self.times(("solves/renewed", None, renewed), (GUESS, anew, lambda guess: 40 * guess),
                                   (GUESS, (3, 2), 4e-3),      # an interruption without renewal
                                   (GUESS, (24, 2), 40e-3),    # and one with renewal
                                   steps=40)
        self.assertEqual(after["all"].interrupted[0, 0], 2)
        np.testing.assert_allclose(after["first"].cg_s, before["first"].cg_s, rtol=1e-6)
        ratio = after["first"].guess_s[0, 2] / before["first"].guess_s[0, 2]
        np.testing.assert_allclose(ratio, (4 * 40 + 34) / 38, rtol=1e-6)  # scaled from 38 rows; 4 of them are slow

    def test_an_iteration_that_few_steps_reach_is_judged_by_the_one_before_it(self):
        """All third iterations of the first task, except one, were not run."""
        changes = [*self.not_run(slice(5, 60, 3), slice(None)), (CG, (2, 1), 4e-3)]
        self.assertEqual(self.times(*changes, steps=20)[1]["all"].interrupted[0, 0], 1)

    def test_more_than_a_tenth_of_the_time_lost_is_said_to_be_too_much(self):
        _, after = self.times(*((CG, (slice(15 * guess, None, 60), guess), 4e-3) for guess in range(4)), steps=20)
        self.assertRegex(timings.interruptions(after["all"], self.sims), r"(?s)16 of 240 solves.* took 88% .*trusted")

    def test_a_guess_that_is_often_slow_while_nothing_else_is_counts_as_it_is(self):
        """Like a search of nearest neighbours, whose time depends on where the rod is."""
        before, after = self.times((GUESS, (slice(0, None, 15), 2), lambda guess: 40 * guess), (CG, (7, 1), 4e-3), steps=20)
        self.assertIn("1 of 240 solves", timings.interruptions(after["all"], self.sims))
        np.testing.assert_allclose(after["all"].guess_s[1:, 2], (1 + 39 / 15) * before["all"].guess_s[1:, 2], rtol=1e-6)

    def test_a_step_of_many_newton_iterations_is_not_an_interruption(self):
        iterations = np.tile([0, 9, 0, 3], 20)
        rest = 10e-6 * (iterations + 1)
        _, after = self.times(("steps/newton_iterations", slice(None), iterations), (REST, slice(None), rest), steps=20)
        np.testing.assert_allclose(after["all"].rest_s[0, 0], rest[:20].sum(), rtol=1e-5)

    def test_in_a_closed_loop_every_guess_loses_its_own_rows(self):
        before, after = self.times((CG, (15, 1), 4e-3), closed_loop=True)  # first solve of the second guess's task
        found = [timings.speedups(times, "first")["guess_cg"] for times in (after, before)]
        np.testing.assert_allclose(*found, rtol=1e-5)
        self.assertIn("1 of 240 solves", timings.interruptions(after["all"], self.sims))


class Steps(Folder):
    def test_largest_drift_and_gap_and_mean_newton_iterations(self):
        file, sims = self.simulations(pending=(3,))
        figures = measures.step_figures(file, sims)
        np.testing.assert_allclose(figures["length_drift"], 1e-3)  # planted negative: the magnitude is measured
        np.testing.assert_allclose(figures["joint_gap"], 2e-3)
        np.testing.assert_allclose(figures["newton_iterations"], 3)
        self.assertTrue(np.isnan(figures["penetration"]).all())
        self.assertTrue(np.isnan(figures["contact_residual"]).all())

    def test_penetration_of_the_simulations_that_have_contact(self):
        file, sims = self.simulations(plant=synthetic.Plant(penetration=0.01))
        file = self.changed(("steps/penetration", slice(0, 5), np.nan))
        found = measures.step_figures(file, sims)["penetration"]
        self.assertTrue(np.isnan(found[0]).all())
        np.testing.assert_allclose(found[1:], 0.01)

    def test_a_direct_simulation_has_steps_and_nothing_to_compare(self):
        file, sims = self.simulations(method="direct")
        self.assertEqual(len(sims), 24)
        self.assertFalse(measures.has_guesses(file).any())
        np.testing.assert_allclose(measures.step_figures(file, sims)["joint_gap"], 2e-3)
        self.assertTrue(np.isnan(timings.direct_times(file, sims)["direct_us"]).all())
