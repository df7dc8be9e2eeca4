"""ablation.py: the setting that a model changes, panels in order of values, planted ratios in table and figure."""

import os
from dataclasses import replace

import synthetic
import ablation
from rodsweep.reading import modelfile
from running import Scripts
from test_loss import NETWORK, plant

MSE = {"training": {"loss": "mse"}}
MODELS = {   # name: job, network, simulations
    "base": (MSE, NETWORK, 256),
    "few": (MSE, NETWORK, 8),
    "more": (MSE, NETWORK, 64),
    "deep": (MSE, {**NETWORK, "steps": 12}, 256),
    "energy": ({"training": {"loss": "energy"}}, {**NETWORK, "moves": False}, 256),
    "factors": (MSE, {key: value for key, value in {**NETWORK, "processor": "factors"}.items()
                     if key not in ("steps", "globals", "moves")}, 256),
    "all": ({"training": {"loss": "mse", "systems": "all"}}, NETWORK, 256),
    "both": ({"training": {"loss": "energy"}}, {**NETWORK, "globals": True, "moves": False}, 256),
}
GUESSES = ("zero", "previous", *(f"copingnet {name}" for name in MODELS))


class Planted(synthetic.Plant):
    quality = {"zero": 1, "previous": 0.8, "copingnet none": 1,
               **{f"copingnet {name}": 0.1 + 0.05 * k for k, name in enumerate(MODELS)}}


class Ablation(Scripts):
    def setUp(self):
        super().setUp()
        os.mkdir(os.path.join(self.folder, "models"))
        for name, (job, network, simulations) in MODELS.items():
            plant(os.path.join(self.folder, "models", f"{name}.h5"), name=name, job=job, network=network,
                  simulations=simulations)

    def read(self, name):
        return modelfile.read(os.path.join(self.folder, "models", f"{name}.h5"))

    def test_a_model_differs_in_what_was_changed_and_not_in_what_comes_with_it(self):
        base = self.read("base")
        changed = {name: ablation.differences(self.read(name), base) for name in MODELS}
        self.assertEqual(changed["base"], {})
        self.assertEqual(changed["few"], {"training simulations": 8})
        self.assertEqual(changed["deep"], {"message-passing steps": 12})
        self.assertEqual(changed["energy"], {"loss": "energy"})
        self.assertEqual(changed["factors"], {"processor": "factors"})
        self.assertEqual(changed["both"], {"loss": "energy", "global state": "on"})
        # The base's job does not name the iterations that it learned from.
        self.assertEqual(changed["all"], {"Newton iterations learned": "all"})

    def test_networks_that_differ_in_their_seed_alone_are_trainings_of_one(self):
        base = self.read("base")
        other_seed = replace(base, job={**base.job, "seed": 2})
        models = {3: base, 4: self.read("deep"), 6: other_seed}
        self.assertEqual(ablation.trained_again(models), [[3, 6]])

    def test_panels_have_the_base_among_its_variants_by_value(self):
        models = {k: self.read(name) for k, name in enumerate(MODELS)}
        number = list(MODELS).index
        panels = ablation.panels_of(models, 0)
        self.assertEqual(panels["training simulations"], [("8", number("few")), ("64", number("more")), ("256", 0)])
        self.assertEqual(panels["message-passing steps"], [("6", 0), ("12", number("deep"))])
        self.assertEqual(panels["loss"], [("mse of both", 0), ("energy", number("energy"))])
        self.assertEqual(panels[ablation.SEVERAL], [("energy, global", number("both"))])

    def test_the_table_has_every_model_and_the_other_guesses_and_the_figure_is_written(self):
        self.write(scenes=("helix",), grid={"scene.segments": [20]}, samples=5, guesses=GUESSES, plant=Planted())
        printed = self.run_script("ablation.py", "sweep.h5", "models", "--tolerance", "1e-2", files=True).stdout
        rows = {line.split("  ")[1]: line for line in reversed(printed.splitlines()) if line.startswith("  ")}
        self.assertIn("  0.099 [", rows["base"])
        self.assertIn("  0.250 [", rows["message-passing steps: 12"])
        self.assertIn("  0.800 [", rows["previous"])
        self.assertRegex(printed, r"message-passing steps: 12 +15 +")   # weights
        self.assertEqual(printed.split()[-2:], ["figures/sweep-ablation.pdf", "figures/sweep-ablation.png"])

    def test_mistakes_are_named(self):
        self.write(scenes=("helix",), guesses=("zero", "previous"), solves=False)
        self.refused("ablation.py", "sweep.h5", "models", words='no guess "copingnet base" with a model in models')
        self.write(scenes=("helix",), guesses=("zero", "copingnet none"), plant=Planted(), solves=False)
        self.refused("ablation.py", "sweep.h5", "models", "--base", "none", words='no guess "copingnet none" with a model')


if __name__ == "__main__":
    import unittest
    unittest.main()
