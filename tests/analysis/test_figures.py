"""The figures: planted numbers are drawn, no text overlaps another or leaves the page, styles identify guesses."""

import argparse
import itertools
import types
import unittest

import synthetic
import heatmap
import numpy as np
import spatial
from rodsweep.drawing import figures, style
from matplotlib import colors, pyplot
from rodsweep.reading import texts, timings
from running import Folder


class Drawn(Folder):
    def study(self, width=174, newton="first", x="scene.segments", **settings):
        """The study of a planted sweep, and its times."""
        self.addCleanup(pyplot.close, "all")
        file = self.open(**{"steps": 2, **settings})
        options = argparse.Namespace(select=[], scene=None, guess=None, x=x, newton=newton, width=width)
        study = spatial.make_study(file, options)
        return study, timings.times(study.file, study.sims)

    @staticmethod
    def pages(study, times, tolerances):
        return (figures.ratio_figure(study, tolerances), figures.speedup_figure(study, times),
                figures.time_figure(study, times))

    def page_texts(self, page):
        """All texts of a page, separated by single blanks."""
        return " ".join(word for text in page.figure.findobj(match=pyplot.Text) for word in text.get_text().split())

    def line(self, axes, guess_style):
        """The drawn lines of a guess: those with its colour, its marker and more than one point."""
        return [line for line in axes.lines if line.get_color() == guess_style.colour and len(line.get_xdata()) > 1
                and line.get_marker() == guess_style.marker]

    def legible(self, page):
        """No two texts overlap (except in the space around letters) and none leaves the page."""
        figure = page.figure
        figure.draw_without_rendering()
        renderer = figure.canvas.get_renderer()
        width, height = figure.bbox.width, figure.bbox.height
        texts = [*figure.texts, *(text for legend in figure.legends for text in legend.get_texts())]
        for axes in figure.axes:
            texts += [axes.title, axes.yaxis.label]
            for axis in (axes.xaxis, axes.yaxis):
                low, high = sorted(axis.get_view_interval())
                texts += [tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
        boxes = [(text.get_text(), text.get_window_extent(renderer)) for text in texts
                 if text.get_visible() and text.get_text().strip()]
        self.assertGreater(len(boxes), 10)
        for text, box in boxes:
            self.assertGreater(min(box.x0, box.y0, width - box.x1, height - box.y1), -1, text)
        for (one, a), (other, b) in itertools.combinations(boxes, 2):
            across, along = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
            self.assertFalse(across > 1 and along > 2, f"{one!r} overlaps {other!r}")


class Values(Drawn):
    def test_ratios_are_drawn_where_they_were_planted_with_one_marked(self):
        study, _ = self.study()
        page = figures.ratio_figure(study, [0, 1])
        self.assertEqual(np.shape(page.axes), (2, 2))
        for axes in np.ravel(page.axes):
            line, = self.line(axes, study.styles["previous"])
            np.testing.assert_allclose(line.get_ydata(), 0.5, atol=0.01)
            np.testing.assert_allclose(line.get_xdata(), [10, 20, 40], rtol=0.15)
            self.assertTrue(any(np.allclose(other.get_ydata(), 1) for other in axes.lines))
            self.assertEqual(axes.get_ylim()[0], 0)

    def test_every_figure_says_what_it_is_of(self):
        study, times = self.study(failed={0: "diverged"}, pending=(1,), guesses=("zero", "previous"), samples=7)
        for timed, page in enumerate(self.pages(study, times, [1])):
            said = self.page_texts(page)
            self.assertTrue("tolerance 1e-2" in said or not timed)
            for words in ("first Newton iteration (j = 0)", "‖b − Ax‖₂", "jacobi", "5–7 simulations per point",
                          "40 of 42 tasks ok, failed: 1 diverged, 1 pending", "95 %", "Bending rod", "Helix"):
                self.assertIn(words, said)

    def test_points_with_unreached_solves_have_open_markers(self):
        plant = synthetic.Plant(reached=lambda guess, tolerance, newton, segments, draw: segments < 40)
        study, _ = self.study(plant=plant)
        page = figures.ratio_figure(study, [1])
        marks = [line for line in page.axes[0][0].lines if line.get_markerfacecolor() == "white"]
        self.assertEqual([len(mark.get_xdata()) for mark in marks], [1, 1, 1])
        self.assertIn("missed the tolerance", self.page_texts(page))

    def test_times_of_oversubscribed_runs_carry_a_warning(self):
        for oversubscribed in (False, True):
            study, times = self.study(oversubscribed=oversubscribed, scenes=("helix",), guesses=("zero", "previous"))
            warned = ["more MPI ranks than cores" in self.page_texts(page) for page in self.pages(study, times, [1])]
            self.assertEqual(warned, [False, oversubscribed, oversubscribed])

    def test_speedups_with_the_direct_solve_beside_them_and_bars_that_stack_to_the_time_of_a_solve(self):
        study, times = self.study(scenes=("helix",))
        page = figures.speedup_figure(study, times)
        line, = self.line(page.axes[0][0], study.styles["quadratic"])
        np.testing.assert_allclose(line.get_ydata(), 4, rtol=1e-5)
        direct, = self.line(page.axes[0][0], style.DIRECT)
        np.testing.assert_allclose(direct.get_ydata(), np.array([10, 20, 40]) / 8, rtol=1e-5)
        page = figures.time_figure(study, times)
        bars = [(patch.get_y(), patch.get_height()) for patch in page.axes[0][1].patches]
        tops = sorted(y + height for y, height in bars)[-3:]
        assembly, guess, cg = 2 / 10, 0.1, 0.5  # of "previous" per segment at N = 10, where assembly is largest
        self.assertAlmostEqual(max(tops), assembly + guess + cg, places=3)
        self.assertEqual(len(bars), 9)

    def test_the_four_curves_of_a_learned_guess_and_of_no_other(self):
        plant = synthetic.Plant(quality={**synthetic.Plant.quality, "copingnet net": 0.2})
        guesses = ("zero", "quadratic", "copingnet net")
        study, times = self.study(scenes=("helix",), plant=plant, guesses=guesses)
        page = figures.four_curves_figure(study, times)
        self.assertEqual(np.shape(page.axes), (1, 1))
        drawn = {name: self.line(page.axes[0][0], look)[0].get_ydata() for name, look in style.FOUR_CURVES.items()}
        np.testing.assert_allclose(drawn["ratio"], 0.2, atol=0.01)
        np.testing.assert_allclose(drawn["share"], 0.1 / 0.2, rtol=1e-5)
        np.testing.assert_allclose(drawn["guess_cg"], 1 / (0.1 + 0.2), rtol=1e-5)
        self.assertTrue((drawn["step"] < drawn["guess_cg"]).all())
        self.legible(page)
        study, times = self.study(scenes=("helix",), guesses=("zero", "quadratic"))
        self.assertIsNone(figures.four_curves_figure(study, times))

    def test_figures_come_in_the_formats_asked_for_with_their_notes_or_without(self):
        study, _ = self.study(scenes=("helix",), guesses=("zero", "previous"))
        sizes = []
        for caption in (True, False):
            path, = figures.ratio_figure(study, [1]).save(self.folder, f"figure{caption}", ("svg",), caption)
            with open(path, encoding="utf-8") as file:
                head = next(line for line in file if line.startswith("<svg"))
            sizes.append(float(head.split('height="')[1].split("pt")[0]))
        self.assertGreater(sizes[0] - sizes[1], 10)


class Legibility(Drawn):
    GUESSES = ("zero", "previous", "linear", "quadratic", "oracle(0.1)", "oracle(0.01)")

    def test_on_a_page_and_in_a_column(self):
        for width, scenes in ((174, ("helix",)), (84, ("bending_rod", "helix"))):
            study, times = self.study(width=width, scenes=scenes, guesses=self.GUESSES, samples=2,
                               grid={"scene.segments": [10, 20, 30, 40, 55]})
            for page in self.pages(study, times, range(4)):
                self.assertAlmostEqual(page.figure.get_size_inches()[0] * 25.4, width)
                self.legible(page)

    def test_with_decades_words_bins_and_one_point_along_x(self):
        one = {"grid": {"scene.segments": [10]}}
        for x, settings in (("scene.segments", {"grid": {"scene.segments": [10, 30, 100, 300, 1000]}}),
                            ("scene.type", {**one, "scenes": ("bending_rod", "helix")}),
                            ("scene.youngs_modulus_pa", {**one, "samples": 16}), ("scene.segments", {**one, "samples": 1})):
            for page in self.pages(*self.study(x=x, **{"samples": 2, "scenes": ("helix",), **settings}), range(4)):
                self.legible(page)
                self.assertEqual("1 simulation per point; too few for intervals" in self.page_texts(page),
                                 settings.get("samples") == 1)

    def test_a_grid_over_decades_has_a_logarithmic_axis_and_others_a_linear_one(self):
        for segments, scale in (([10, 55], "linear"), ([10, 100, 500], "log")):
            study, _ = self.study(grid={"scene.segments": segments}, samples=2)
            self.assertEqual(figures.ratio_figure(study, [0]).axes[0][0].get_xscale(), scale)


def linear_light(colour):
    return np.array([c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in colors.to_rgb(colour)])


def seen_by(colour, deficiency):
    """A colour in linear light as seen with full deuteranopia or protanopia (Machado, Oliveira and Fernandes 2009)."""
    matrices = {"deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
                                 [-0.011820, 0.042940, 0.968881]],
                "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
                               [-0.003882, -0.048116, 1.051998]]}
    return np.clip(np.array(matrices[deficiency]) @ linear_light(colour), 0, 1)


class HeatScale(unittest.TestCase):
    def test_colours_end_where_the_data_do_and_say_the_same_of_the_same_factor(self):
        def scale(*values):
            cells = types.SimpleNamespace(value=np.array([values]))
            return heatmap.scale(types.SimpleNamespace(better=1), [types.SimpleNamespace(cells=cells)])

        norm, colormap = scale(0.5, 20)
        self.assertEqual((norm.vmin, norm.vmax), (0.5, 20))
        np.testing.assert_allclose(colormap(norm(1.0))[:3], style.DIVERGING.reversed()(0.5)[:3], atol=0.03)
        mirrored, other = scale(0.05, 20)
        for value in (0.5, 2, 20):
            np.testing.assert_allclose(colormap(norm(value))[:3], other(mirrored(value))[:3], atol=0.03)


class Styles(unittest.TestCase):
    def test_a_guess_looks_the_same_whatever_else_is_in_the_file(self):
        some = style.guess_styles(["zero", "quadratic"])
        others = style.guess_styles(["previous", "copingnet", "quadratic"])
        self.assertEqual(some["quadratic"], others["quadratic"])

    def test_marker_and_dash_tell_all_kinds_apart_without_colour(self):
        labels = [*style.KINDS, "oracle(0.01)", "oracle(0.001)", "mine", "yours"]
        styles = style.guess_styles([label for label in labels if label != "zero"])
        looks = {(s.marker, s.dash) for s in styles.values()}
        self.assertEqual(len(looks), len(styles))
        self.assertEqual(len({s.marker for s in styles.values()}), len(styles))

    def test_neighbours_in_the_demo_stay_apart_for_the_colour_blind(self):
        kinds = ("zero", "previous", "linear", "quadratic", "oracle", "guarded", "copingnet")
        for deficiency in ("deuteranopia", "protanopia"):
            seen = {kind: seen_by(style.KINDS[kind][0], deficiency) ** (1 / 2.2) for kind in kinds}
            for a, b in itertools.combinations(kinds, 2):
                self.assertGreater(np.linalg.norm(seen[a] - seen[b]), 0.1, f"{a} and {b} with {deficiency}")

    def test_lines_stand_out_from_white_paper(self):
        for label, guess_style in style.guess_styles(list(style.KINDS)).items():
            luminance = np.dot(linear_light(guess_style.colour), [0.2126, 0.7152, 0.0722])
            self.assertGreater(1.05 / (luminance + 0.05), 2.8, label)

    def test_names_of_parameters_with_their_units(self):
        for name, unit, label in (("scene.youngs_modulus_pa", "Pa", "Young's modulus (Pa)"),
                                  ("time.step_s", "s", "time step (s)"),
                                  ("scene.density_kg_m3", "kg/m^3", "density (kg/m^3)"),
                                  ("scene.damping_per_s", "1/s", "damping (1/s)"),
                                  ("scene.segments", "", "number of segments N")):
            self.assertEqual(texts.parameter_label(name, unit), label)
