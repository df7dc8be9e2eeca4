"""What is averaged and what is kept apart: panels by scene and gridded keys, points along x, bins."""

import unittest

import running
import numpy as np
from rodsweep.reading import groups, measures
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


if __name__ == "__main__":
    unittest.main()
