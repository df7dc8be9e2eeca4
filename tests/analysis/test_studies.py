"""All numbers of temporal, heatmap and long_term against planted ones; missing values are excluded."""

import argparse
import csv
import io
import unittest

import synthetic
import heatmap
import long_term
import numpy as np
import temporal
from rodsweep.reading import along_time, envelopes, groups, heat, intervals
from running import Scripts

EVERYTHING = {"select": [], "scene": None, "guess": None, "tolerance": None, "newton": "first", "width": "174"}


class Studies(Scripts):
    def table(self, *words):
        """The rows of a script's --csv output, by method."""
        rows = csv.DictReader(io.StringIO(self.run_script(*words, "--csv").stdout))
        return {row["method"]: row for row in rows}

    def options(self, **settings):
        return argparse.Namespace(**{**EVERYTHING, **settings})


class Fading(synthetic.Plant):
    """A guess that is good in the first half of a run and useless in the second; draws differ in size and quality."""

    def zero_iterations(self, segments, tolerance):
        return 100

    def ratio(self, guess, tolerance, newton, segments, draw):
        return 1.0 if guess == "zero" else 0.2 + 0.1 * draw if newton == 0 else 0.9

    def at_step(self, guess, step):
        return np.ones(len(step)) if guess == "zero" else np.where(step < 10, 1, 2)


class Temporal(Studies):
    TEMPORAL = {"scenes": ("helix",), "grid": {"scene.segments": [10]}, "steps": 20, "newton": 2, "samples": 4,
                "counts_in_rows": True}

    def windows(self, newton="first", width=1, tolerances=(0,), **settings):
        """File, simulations, windows and estimated ratio of a planted sweep."""
        file, sims = self.simulations(**{**self.TEMPORAL, "plant": Fading(), **settings})
        found = along_time.windows(file, sims, newton, [0, 1], list(tolerances), width)
        return file, sims, found, temporal.estimate(sims, found, 0, relative=True)

    def test_the_curve_is_the_planted_ratio_of_sums_before_and_after_the_change(self):
        for closed_loop in (False, True):
            _, _, found, e = self.windows(tolerances=(0, 1), closed_loop=closed_loop, samples=5)
            self.assertEqual((found.width, e.value.shape), (1, (20, 2, 2)))
            np.testing.assert_allclose(found.centre, np.arange(1, 21))
            np.testing.assert_allclose(e.value[:, 0], 1)
            np.testing.assert_allclose(e.value[:10, 1], 0.4)
            np.testing.assert_allclose(e.value[10:, 1], 0.8)
            self.assertTrue((e.low[:, 1] < e.value[:, 1]).all() and (e.value[:, 1] < e.high[:, 1]).all())
            self.assertGreaterEqual(e.low[0, 1].min(), 0.2 - 1e-9)   # the best draw
            self.assertLessEqual(e.high[0, 1].max(), 0.6 + 1e-9)

    def test_all_newton_iterations_and_iterations_per_solve(self):
        _, sims, found, e = self.windows("all")
        np.testing.assert_allclose(e.value[:10, 1, 0], (0.35 + 0.9) / 2)
        np.testing.assert_allclose(temporal.estimate(sims, found, 0, False).value[:, 0, 0], 100)
        np.testing.assert_array_equal(found.solves[:, :, 0], 2)

    def test_a_window_is_a_sum_over_its_steps(self):
        _, _, found, e = self.windows(width=5)
        self.assertEqual(found.width, 5)
        np.testing.assert_allclose(e.value[10, 1, 0], 0.35 * (2 * 1 + 3 * 2) / 5)    # steps 8 … 12
        np.testing.assert_array_equal(found.solves[0, [0, 1, 2, 19], 0], [3, 4, 5, 3])

    def test_solves_that_missed_the_tolerance_count_what_they_used(self):
        plant = Fading(reached=lambda guess, tolerance, newton, segments, draw: guess == "zero" or draw > 0)
        file, sims, found, _ = self.windows(plant=plant)
        sums = file.results("iterations_sum", sims.any_task)[:, 1, 0]
        np.testing.assert_allclose(found.iterations[:, :, 1, 0].sum(axis=1), sums)
        np.testing.assert_allclose(found.iterations[0, :, 1, 0], 0.2 * 100 * 1.5)  # the mean of 20 and 40
        np.testing.assert_array_equal(found.unreached[:, 1, 0], 1)

    def test_failed_and_pending_tasks_are_in_no_curve(self):
        one_bad = Fading(ratio=lambda guess, tolerance, newton, segments, draw: 50.0 if draw == 1 and guess != "zero" else
                         Fading().ratio(guess, tolerance, newton, segments, draw))
        _, _, _, e = self.windows(plant=one_bad, failed={1: "diverged"}, pending=(3,))
        np.testing.assert_allclose(e.value[0, 1, 0], (0.2 + 0.4) / 2)
        np.testing.assert_array_equal(e.count, 2)

    def test_long_runs_are_binned_and_keep_their_sums(self):
        file, sims, found, _ = self.windows(steps=1000, samples=2)
        self.assertLessEqual(len(found.centre), along_time.MOST_WINDOWS)
        whole = along_time.windows(file, sims, "first", [0, 1], [0], width=2000)
        np.testing.assert_allclose(whole.iterations[:, :, 0, 0], 100 * 1000)

    def test_figures_with_a_window_in_their_name_and_caption(self):
        self.write(plant=Fading(), **self.TEMPORAL)
        printed = self.run_script("temporal.py", "sweep.h5", "--window", "4", "--tolerance", "1e-2",
                                  files=True).stdout.split()
        self.assertEqual(printed[0], "figures/sweep-cg-ratio-in-time-window4.pdf")
        self.assertEqual(len(printed), 4)


class Cells(synthetic.Plant):
    """previous is best at 10 segments, quadratic at 40; the oracle beats both; the draw shifts all a little."""

    def zero_iterations(self, segments, tolerance):
        return 1000 if tolerance > 0.05 else 2000

    def ratio(self, guess, tolerance, newton, segments, draw):
        quality = {"zero": 1, "previous": 0.3 if segments < 20 else 0.6, "quadratic": 0.5, "oracle(0.1)": 0.1}[guess]
        return quality + (0.01 * (draw - 2) if guess != "zero" else 0)


class Heatmap(Studies):
    HEAT = {"scenes": ("helix",), "samples": 5, "steps": 2,
            "grid": {"scene.segments": [10, 40], "time.step_s": [0.01, 0.02, 0.04]}}

    def planes(self, measure, x, y, **settings):
        """The planes of the open file."""
        options = self.options(measure=measure, x=x, y=y, each=False, **settings)
        shown, tolerances, guesses = heatmap.chosen(self.file, options)
        return heat.planes(shown, measure, x, y, guesses, tolerances)

    def test_a_cell_has_the_best_guess_its_ratio_and_an_interval_that_covers_it(self):
        self.open(plant=Cells(), **self.HEAT)
        plane, = self.planes("ratio", "time.step_s", "scene.segments")
        np.testing.assert_allclose(plane.cells.value, [[0.3] * 3, [0.5] * 3])
        self.assertEqual(plane.guess.tolist(), [[1] * 3, [2] * 3])   # the oracle is excluded
        self.assertTrue(((plane.cells.low <= plane.cells.value) & (plane.cells.value <= plane.cells.high)).all())
        self.assertTrue((plane.cells.high - plane.cells.low < 0.04).all())
        np.testing.assert_array_equal(plane.cells.count, 5)
        named, = self.planes("ratio", "time.step_s", "scene.segments", guess="oracle(0.1)")
        np.testing.assert_allclose(named.cells.value, 0.1)

    def test_the_ladder_of_tolerances_is_an_axis(self):
        self.open(plant=Cells(), **{**self.HEAT, "grid": {"scene.segments": [10, 40]}})
        plane, = self.planes("iterations", "scene.segments", "tolerance")
        self.assertEqual(plane.y.text, ["1e-4", "1e-3", "1e-2", "1e-1"])
        np.testing.assert_allclose(plane.cells.value[:, 0], [2000, 2000, 2000, 1000])
        ratio, = self.planes("ratio", "scene.segments", "tolerance")
        np.testing.assert_allclose(ratio.cells.value, [[0.3, 0.5]] * 4)

    def test_every_other_grid_is_a_panel(self):
        self.open(plant=Cells(), **self.HEAT)
        planes = self.planes("ratio", "scene.segments", "tolerance")
        self.assertEqual([plane.panel.settings for plane in planes],
                         [{"time.step_s": text} for text in ("0.01", "0.02", "0.04")])

    def test_speedups_of_three_kinds_and_residuals(self):
        self.open(grid={"scene.segments": [10, 20], "time.step_s": [0.01, 0.02]}, scenes=("helix",), steps=2)
        # us at j = 0 of N = 20: CG 20 from zero, 5 with quadratic; guess 2; step: 3 assemblies of 2, rest 3
        for measure, value in (("speedup-cg", 4), ("speedup-guess-cg", 20 / 7),
                               ("speedup-step", (6 + 40 + 3) / (6 + 6 + 10 + 3))):
            plane, = self.planes(measure, "time.step_s", "scene.segments")
            np.testing.assert_allclose(plane.cells.value[1], value, rtol=1e-5)
            self.assertEqual(plane.guess[1].tolist(), [2, 2])
        plane, = self.planes("newton-residual", "time.step_s", "scene.segments")
        np.testing.assert_allclose(plane.cells.value, 1e-10)

    def test_cells_without_a_simulation_are_empty_and_missed_tolerances_counted(self):
        plant = Cells(reached=lambda guess, tolerance, newton, segments, draw: segments < 20 or guess != "quadratic")
        failed = {task: "diverged" for task in range(5)}    # all draws of the first cell
        self.open(plant=plant, failed=failed, pending=(5,), **self.HEAT)
        plane, = self.planes("ratio", "time.step_s", "scene.segments")
        self.assertTrue(np.isnan(plane.cells.value[0, 0]))
        self.assertEqual(plane.cells.count.tolist(), [[0, 4, 5], [5, 5, 5]])
        self.assertEqual(plane.unreached.tolist(), [[0, 0, 0], [20 // 10 * 5] * 3])   # 2 steps x 5 draws

    def test_figures(self):
        self.write(plant=Cells(), **self.HEAT)
        where = ("--x", "time.step_s", "--y", "scene.segments")
        printed = self.run_script("heatmap.py", "sweep.h5", *where, files=True).stdout.split()
        self.assertEqual(printed[1], "figures/sweep-heatmap-ratio-step_s-segments-1e-2.png")
        self.run_script("heatmap.py", "sweep.h5", *where, "--measure", "speedup-step", "--each", "--width", "84")


class Drifting(synthetic.Plant):
    """Drift grows by a known amount per step, faster for quadratic; one step has a spike in its middle."""
    per_step = {"zero": 1e-6, "previous": 1e-6, "quadratic": 3e-6, "oracle(0.1)": 1e-6, "": 5e-7}

    def length_drift(self, step, steps, draw, guess):
        drift = -self.per_step[guess] * (1 + 0.1 * draw) * step
        drift[len(step) // 2] = 0.25 if draw == 2 and guess == "quadratic" else drift[len(step) // 2]
        return drift


class LongTerm(Studies):
    LONG = {"scenes": ("helix",), "grid": {"scene.segments": [10]}, "steps": 1200, "newton": 1, "samples": 3,
            "solves": False, "closed_loop": True}
    ONE = {"scenes": ("helix",), "grid": {"scene.segments": [10]}, "steps": 50}    # one group of simulations

    def test_slopes_largest_and_final_values_are_the_planted_ones(self):
        file, sims = self.simulations(plant=Drifting(), **self.LONG)
        found = envelopes.histories(file, sims.tasks())
        at = found.rows(sims.task[:, 0])
        np.testing.assert_allclose(found.slope[at], -1e-3 * (1 + 0.1 * sims.sample), rtol=1e-9)
        np.testing.assert_allclose(found.largest["length_drift"][at], 1199e-6 * (1 + 0.1 * sims.sample))
        spiked = found.rows(sims.task[2, 2])
        self.assertEqual(found.largest["length_drift"][spiked], 0.25)
        self.assertEqual((found.high["length_drift"][spiked] == 0.25).sum(), 1)   # the envelope keeps the spike
        self.assertAlmostEqual(found.final["length_drift"][spiked], -3e-6 * 1.2 * 1199)
        np.testing.assert_allclose(found.low["momentum_kg_m_s"][at], 5)
        np.testing.assert_allclose(found.first["energy_j"], 3)
        np.testing.assert_allclose(found.final["energy_j"], 2.5)

    def methods(self, file):
        shown = long_term.make_study(file, self.options())
        panel, = groups.panels(file, shown.sims, ("solve.method",))
        return shown, long_term.methods(shown, panel)

    def test_the_fit_begins_where_it_is_told_to(self):
        transient = Drifting(length_drift=lambda step, *_: np.where(step < 100, 1.0, 1e-6 * step))
        file, sims = self.simulations(plant=transient, **self.LONG)
        np.testing.assert_allclose(envelopes.histories(file, sims.tasks(), begin=100).slope, 1e-3, rtol=1e-6)

    def test_tasks_of_several_blocks_of_rows_come_out_the_same(self):
        file, sims = self.simulations(plant=Drifting(), **self.LONG)
        whole = envelopes.histories(file, sims.tasks())
        blocks = file.step_blocks
        file.step_blocks = lambda tasks, columns: blocks(tasks, columns, 500)
        parts = envelopes.histories(file, sims.tasks())
        np.testing.assert_allclose(parts.slope, whole.slope)
        for name in envelopes.recorded(file):
            np.testing.assert_array_equal(parts.low[name], whole.low[name])
            np.testing.assert_array_equal(parts.final[name], whole.final[name])

    def test_the_table_has_every_method_its_interval_and_its_failures(self):
        self.write(plant=Drifting(), failed={1: "diverged"}, pending=(3,), **{**self.LONG, "samples": 5})
        rows = self.table("long_term.py", "sweep.h5", "--after", "0")
        self.assertEqual(list(rows), list(synthetic.GUESSES))
        self.assertEqual([int(row["simulations"]) for row in rows.values()], [5, 5, 5, 4])
        self.assertEqual([int(row["failed"]) for row in rows.values()], [0, 1, 0, 0])
        zero = {key: float(value) for key, value in rows["zero"].items() if key.startswith("drift")}
        self.assertAlmostEqual(zero["drift_per_1000_steps"], -1.2e-3)
        self.assertLessEqual(zero["drift_per_1000_steps_low"], -1.2e-3)
        self.assertGreaterEqual(zero["drift_per_1000_steps_high"], -1.2e-3)
        self.assertEqual(float(rows["quadratic"]["length_drift_largest"]), 0.25)
        self.assertAlmostEqual(float(rows["zero"]["length_drift_final"]), -1199e-6 * 1.4)

    def test_a_method_that_always_failed_is_shown_up_to_its_end(self):
        def blowing_up(step, steps, draw, guess):
            drift = Drifting().length_drift(step, steps, draw, guess)
            return np.where(step < 300 + draw, drift, np.nan) if guess == "previous" else drift

        own = [t for t in range(12) if t % 4 == 1]
        settings = {"plant": Drifting(length_drift=blowing_up), "failed": {t: "diverged" for t in own}, **self.LONG}
        self.write(**settings)
        rows = self.table("long_term.py", "sweep.h5")
        failed = rows["previous"]
        self.assertEqual((failed["simulations"], failed["failed"], failed["drift_per_1000_steps"]), ("3", "3", ""))
        self.assertAlmostEqual(float(failed["length_drift_final"]), -1.2e-6 * 301)
        self.assertEqual(rows["zero"]["failed_after_steps"], "")
        file, sims = self.simulations(**settings)
        _, methods = self.methods(file)
        found = envelopes.histories(file, np.array(own))
        self.assertIn("previous", methods)
        low, high, line = long_term._envelope(found, "length_drift", "previous", methods["previous"][1], {})
        self.assertTrue(np.isfinite(line[0]) and np.isnan(line[-1]))
        self.assertEqual(len(sims), 3)     # complete simulations

    def test_figure_with_either_time_axis_and_of_a_paired_sweep(self):
        self.write(plant=Drifting(), **self.LONG)
        said = self.run_script("long_term.py", "sweep.h5", files=True).stdout
        self.assertIn("drift per 1000 steps", said)
        self.assertTrue(said.rstrip().endswith("figures/sweep-long-term.png"))
        self.assertIn("sweep-long-term-log-time.png", self.run_script("long_term.py", "sweep.h5", "--log-time").stdout)
        self.write(**{**self.LONG, "closed_loop": False, "steps": 50})
        self.assertIn("  direct", self.run_script("long_term.py", "sweep.h5").stdout)

    def test_networks_are_methods_by_the_names_of_their_models_and_gauss_seidel_by_its_iterations(self):
        for method, settings in (("end_to_end bending", {"model": "../models/bending.h5", "failed": {1: "diverged"}}),
                                 ("xpbd 20", {"grid": {"solve.iterations": (20,)}})):
            self.write(**{**self.ONE, "method": method.split()[0], **settings})
            said = self.run_script("long_term.py", "sweep.h5").stdout
            self.assertIn(f"  {method} ", said)
            self.assertNotIn("direct", said)

    def test_energies_are_relative_to_the_first_step_and_the_largest_kinetic_energy(self):
        file, sims = self.simulations(plant=Drifting(), **self.LONG)
        shown, methods = self.methods(file)
        found = envelopes.histories(file, sims.tasks())
        scales = long_term._scales(found, methods, shown)
        low, high, line = long_term._envelope(found, "energy_j", "zero", methods["zero"][1], scales)
        self.assertAlmostEqual(float(low[-1]), -0.5 / 2, places=6)
        self.assertAlmostEqual(float(high[0]), 0, places=6)


class RatiosOfSums(unittest.TestCase):
    def test_simulations_without_either_number_are_left_out(self):
        e = intervals.ratio_of_sums([[1.0], [3], [np.nan], [5]], [[2.0], [4], [9], [np.nan]])
        self.assertAlmostEqual(float(e.value[0]), 4 / 6)
        self.assertEqual(int(e.count[0]), 2)

    def test_the_interval_covers_the_truth_as_often_as_it_says(self):
        generator, inside = np.random.Generator(np.random.PCG64(1)), 0
        for _ in range(100):
            below = generator.uniform(50, 150, size=20)
            above = below * generator.uniform(0.3, 0.7, size=20)
            e = intervals.ratio_of_sums(above[:, None], below[:, None], resamples=400)
            inside += bool(e.low[0] <= 0.5 <= e.high[0])
        self.assertGreaterEqual(inside, 88)
