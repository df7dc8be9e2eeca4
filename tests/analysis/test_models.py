"""loss.py and ablation.py: planted losses and CG ratios of models in figures and tables; the settings that models change."""

import json
import os
import types
from dataclasses import replace

import synthetic
import ablation
import h5py
import loss
import numpy as np
from matplotlib import pyplot
from rodsweep.reading import modelfile
from running import Scripts
from test_figures import Drawn

EPOCHS = 12
NETWORK = {"encoding": "paper", "processor": "message_passing", "base": "none", "base_size": 10, "latent": 32,
           "best_length": False, "steps": 6, "globals": False, "moves": True}


def plant(path, name="net", ending="complete", epochs=EPOCHS, factor=1.0, job=None, network=None, simulations=256):
    """A model file for loss.py: losses fall except in the last epoch, every third epoch has ratios."""
    number = np.arange(1, epochs + 1)
    ratio = np.full((epochs, 4), np.nan)
    ratio[2::3] = factor * np.array([0.1, 0.2, 0.4, 0.8]) * (1 + 1 / number[2::3, None])
    validation = factor * 0.5 / number
    validation[-1:] *= 2
    with h5py.File(path, "w") as h5:
        h5.attrs.update({"program": np.bytes_("rodsweep"), "kind": np.bytes_("model"), "schema_version": np.int32(2)})
        h5.create_group("job").attrs["name"] = np.bytes_(name)
        h5["axes/tolerance"] = [1e-1, 1e-2, 1e-3, 1e-4]
        h5["training/training_loss"] = factor * 0.6 / number
        h5["training/validation_loss"] = validation
        h5["training/rate"] = 2e-3 * (1 - (number - 1) / epochs)
        h5["training/cg_ratio"] = ratio
        h5["training"].attrs.update({"ending": np.bytes_(ending), "best_epoch": np.int32(max(0, epochs - 1))})
        known = ending != "none"
        h5["validation/cg_ratio"] = factor * np.array([0.1, 0.2, 0.4, 0.8]) if known else np.full(4, np.nan)
        h5["validation/base_cg_ratio"] = [0.3, 0.4, 0.6, 0.9] if known else np.full(4, np.nan)
        h5["validation"].attrs["simulations"] = np.int32(50)
        h5["timing/epoch_s"] = np.full(epochs, 2.5)
        h5["job/text"] = np.array([json.dumps({"data": "data.h5", "network": {}, "training": {}, **(job or {})})], dtype="S")
        h5["model/settings"] = np.array([json.dumps(network or NETWORK)], dtype="S")
        h5["model/weights/a"], h5["model/weights/b"] = np.zeros((3, 4)), np.zeros((3, 1))
        h5.create_group("data").attrs["training_simulations"] = np.int64(simulations)
    return path


class LossFigures(Drawn):
    def setUp(self):
        super().setUp()
        self.addCleanup(pyplot.close, "all")

    def read(self, **settings):
        folder = os.path.join(self.folder, str(len(os.listdir(self.folder))))
        os.mkdir(folder)
        return modelfile.read(plant(os.path.join(folder, "model.h5"), **settings))

    def test_planted_values_are_drawn(self):
        training = self.read()
        page = loss.figure([training], 174)
        losses, first, *_, rate = page.axes[0]
        np.testing.assert_allclose(losses.lines[0].get_ydata(), 0.6 / np.arange(1, EPOCHS + 1))
        np.testing.assert_allclose(losses.lines[1].get_ydata()[-2:], [0.5 / 11, 2 * 0.5 / 12])
        self.assertEqual(losses.lines[2].get_xdata()[0], EPOCHS - 1)  # the epoch of the saved model
        np.testing.assert_array_equal(first.lines[0].get_xdata(), [3, 6, 9, 12])
        np.testing.assert_allclose(first.lines[0].get_ydata()[0], 0.1 * (1 + 1 / 3))
        self.assertEqual(first.lines[1].get_ydata()[0], 0.3)  # the base guess alone
        self.assertEqual(first.lines[2].get_ydata()[0], 0.1)
        self.assertEqual(rate.lines[0].get_ydata()[0], 2e-3)
        self.assertIn("mean over 50 validation simulations", self.page_texts(page))

    def test_figures_are_legible_for_one_and_several_models_wide_and_narrow(self):
        trainings = [self.read(name="net"), self.read(name="faithful", factor=3.0),
                     self.read(name="unfinished", ending="none", epochs=4)]
        for width in (174, 84):
            for shown in (trainings[:1], trainings):
                with self.subTest(width=width, models=len(shown)):
                    self.legible(loss.figure(shown, width))

    def test_models_have_styles_of_their_own_and_the_names_of_their_files_where_jobs_share_one(self):
        shown = [self.read(), self.read()]
        colours = {line.get_color() for line in loss.figure(shown, 174).axes[0][-1].lines}
        self.assertEqual(len(colours), 2)
        self.assertEqual(loss.labels([types.SimpleNamespace(name="a", path="x/one.h5"),
                                      types.SimpleNamespace(name="a", path="x/two.h5")]), ["one", "two"])
        self.assertEqual(loss.labels([self.read(name="a"), self.read(name="b")]), ["a", "b"])

    def test_a_training_that_runs_is_shown_as_far_as_it_is(self):
        for epochs in (1, 2, 4):
            page = loss.figure([self.read(ending="none", epochs=epochs)], 174)
            self.legible(page)
            self.assertIn("running: net.", self.page_texts(page))


class Loss(Scripts):
    def plant(self, file, **settings):
        plant(os.path.join(self.folder, file), **settings)

    def test_figure_and_table(self):
        self.plant("net.h5")
        self.plant("other.h5", name="other", ending="none")
        said = self.run_script("loss.py", "net.h5", files=True).stdout
        self.assertEqual(said.split()[-2:], ["figures/net-loss.pdf", "figures/net-loss.png"])
        net, base = (line.split() for line in said.splitlines()[1:3])
        self.assertEqual(net, ["net", "12", "11", "0.04545", "30", "0.100", "0.200", "0.400", "0.800"])
        self.assertEqual(base[-4:], ["0.300", "0.400", "0.600", "0.900"])
        said = self.run_script("loss.py", "net.h5", "other.h5", "-o", "out", "--width", "84").stdout
        self.assertEqual(said.split()[-1], "out/net-and-1-more-loss-84mm.png")
        self.assertIn("other (has not ended)", said)

    def test_the_table_has_a_row_for_every_kind_of_scene(self):
        path = plant(os.path.join(self.folder, "several.h5"))
        with h5py.File(path, "a") as h5:
            h5["validation/scenes/type"] = np.array([b"helix", b"falling_rods"])
            h5["validation/scenes/cg_ratio"] = [[0.11, 0.2, 0.3, 0.4], [0.5, 0.6, 0.7, 0.8]]
            h5["validation/scenes/base_cg_ratio"] = [[0.12, 0.2, 0.3, 0.4], [0.5, 0.6, 0.7, np.nan]]
        rows = [line.split() for line in loss.table([modelfile.read(path)])]
        self.assertEqual(rows[3], ["helix", "0.110", "0.200", "0.300", "0.400"])
        self.assertEqual(rows[6], ["falling", "rods,", "base", "0.500", "0.600", "0.700", "-"])

    def test_what_is_no_model_is_refused(self):
        self.write(samples=2)
        self.plant("begun.h5", ending="none", epochs=0)
        self.plant("old.h5")
        with h5py.File("old.h5", "r+") as h5:
            h5.attrs["schema_version"] = 7
        self.plant("hole.h5")
        with h5py.File("hole.h5", "r+") as h5:
            del h5["training/rate"]
        for name, words in (("sweep.h5", "holds the results of a sweep"), ("begun.h5", "no epoch"), ("hole.h5", "damaged"),
                            ("old.h5", "schema version 7, these scripts read 2")):
            self.assertIn(name, self.refused("loss.py", name, words=words))
        self.refused("spatial.py", "hole.h5", words="hole.h5 is a rodsweep file of kind model")


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
