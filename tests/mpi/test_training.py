#!/usr/bin/python3
"""Training under mpirun: equal bits on any number of ranks, after a stop and after a kill; refusals and messages.

Run by CTest in an empty folder, with RODSWEEP and MPIRUN in the environment.
"""

import json
import os
import re
import signal
import time
import unittest

import h5py
import numpy as np
from program import DIVERGED, STOPPED, SweepCase, USER_ERROR, checksum, data_job, kill_all, ranks_of, rodsweep, start, status


def train_job(name="train", **changes):
    """A small training of a second."""
    training = {"epochs": 3, "batch": 8, "shards": 4, "ratio_every_epochs": 2, "ratio_simulations": 5}
    values = {"name": name, "kind": "train", "seed": 5, "data": "data.h5", "validation_simulations": 6,
              "network": {"base_size": 3, "latent": 16}, **changes}
    values["training"] = {**training, **changes.get("training", {})}
    with open(name + ".json", "w", encoding="utf-8") as file:
        json.dump(values, file)
    return name + ".json"


class TrainingCase(SweepCase):
    def setUp(self):
        if not os.path.exists("data.h5"):
            self.rodsweep(0, "run", data_job(samples=12, steps=10, record={"systems": "first"}), "-o", "data.h5")

    def start(self, ranks, path, results, epochs):
        """Starts a training; returns its process after this many epochs."""
        process = start(ranks, "run", path, "-o", results)
        for _ in range(600):
            if os.path.exists(results) and status(results)["epochs"] >= epochs:
                return process
            self.assertIsNone(process.poll())
            time.sleep(0.02)
        self.fail(f"{results} never got {epochs} epochs")

    def assert_finished(self, path):
        self.assertTrue(status(path)["ended"])
        with h5py.File(path) as file:
            self.assertNotIn("checkpoint", file)
        self.assertEqual([name for name in os.listdir(".") if "unfinished" in name], [])


class Learning(TrainingCase):
    def test_models_are_the_same_on_1_2_4_and_6_ranks(self):
        for name, changes in (
                ("factors", {}),
                ("hops", {"network": {"encoding": "paper_residual", "processor": "message_passing", "base": "none",
                                      "latent": 16, "steps": 2, "best_length": False, "moves": True},
                          "training": {"loss": "mse"}})):
            path = train_job(name, **changes)
            alone = self.rodsweep(0, "run", path, "-o", f"{name}.h5")
            self.assertRegex(alone.stdout, r"3 epochs.*epoch \d(.*\n)*.*\b5 validation simulations")
            for ranks in (2, 4, 6) if name == "factors" else (3,):
                with self.subTest(name=name, ranks=ranks):
                    self.rodsweep(ranks, "run", path, "-o", f"{name}{ranks}.h5")
                    self.assert_same_results(f"{name}.h5", f"{name}{ranks}.h5")
                    self.assert_finished(f"{name}{ranks}.h5")
                    self.assertEqual(status(f"{name}{ranks}.h5")["runs"][0]["ranks"], ranks)

    def test_what_a_model_file_tells(self):
        self.rodsweep(0, "run", train_job("told"))
        with h5py.File("results/told.h5") as file:
            self.assertEqual(file.attrs["kind"], b"model")
            self.assertEqual(file["training/training_loss"].shape, (3,))
            ratios = file["training/cg_ratio"][:]
            self.assertEqual(np.isnan(ratios[:, 0]).tolist(), [True, False, True])
            self.assertTrue((file["validation/cg_ratio"][:] > 0).all())
            self.assertEqual(file["model/weights/encode.weight"].shape[0], 16)
            self.assertTrue((file["timing/epoch_processor_s"][:] > 0).all())
            for path in ("training/rate", "timing/epoch_s", "validation/base_cg_ratio"):
                self.assertTrue(file[path].attrs["meaning"])
        told = json.loads(rodsweep(0, "info", "results/told.h5", "--json").stdout)
        self.assertEqual((told["kind"], told["epochs"], told["network"]["latent"]), ("model", 3, 16))


class Stopping(TrainingCase):
    """A training of one to two seconds, interrupted in the middle."""

    def setUp(self):
        super().setUp()
        self.job = train_job("long", training={"epochs": 600, "batch": 60, "ratio_every_epochs": 100})
        if not os.path.exists("whole.h5"):
            self.rodsweep(2, "run", self.job, "-o", "whole.h5")

    def interrupt(self, path, ranks, hit):
        process = self.start(ranks, self.job, path, 3)
        hit(process)
        stdout, stderr = process.communicate(timeout=600)
        self.assertFalse(status(path)["ended"], "the training is too short to be interrupted")
        return process.returncode, stdout, stderr

    def resume(self, path, ranks):
        resumed = self.rodsweep(ranks, "run", self.job, "-o", path, "--resume")
        self.assertIn("continued after step", resumed.stderr)
        self.assert_same_results("whole.h5", path)
        self.assertTrue(status(path)["ended"])
        self.assertEqual(len(status(path)["runs"]), 2)

    def test_after_a_signal_to_one_rank(self):
        for name, ranks, hit in (("one", 3, lambda p: os.kill(ranks_of(p)[2], signal.SIGTERM)),
                                 ("alone", 0, lambda p: p.send_signal(signal.SIGINT))):
            with self.subTest(name=name):
                code, stdout, stderr = self.interrupt(f"{name}.h5", ranks, hit)
                self.assertEqual(code, STOPPED, stderr)
                self.assertIn(" of 600 epochs", stdout)
                self.assertIn(f"-o {name}.h5 --resume", stderr)
                self.assertEqual(status(f"{name}.h5")["runs"][0]["exit_code"], STOPPED)
                self.resume(f"{name}.h5", 3 if name == "one" else 1)

    def test_after_all_ranks_are_killed(self):
        self.interrupt("killed.h5", 2, kill_all)
        self.assertIsNone(status("killed.h5")["runs"][0]["end"])
        self.resume("killed.h5", 2)


class Refused(TrainingCase):
    def test_what_a_training_does_not_touch(self):
        path = train_job("first")
        self.rodsweep(0, "run", path, "-o", "first.h5")
        before = checksum("first.h5")
        other = train_job("other", training={"rate": 0.01})
        for ranks, says, *words in (
                (2, "first.h5 exists already", "run", path, "-o", "first.h5"),
                (2, ("first.h5", "other.json", "training.rate was 0.002 and is 0.01"),
                 "run", other, "-o", "first.h5", "--resume"),
                (0, "--extend", "run", path, "-o", "new.h5", "--extend", "data.h5"),
                (0, ("lost.json: data: nowhere.h5", "dataset"), "run", train_job("lost", data="nowhere.h5")),
                (0, "first.h5 holds a trained model", "run", data_job("data"), "-o", "first.h5", "--resume"),
                (0, "first.h5", "rerun", "first.h5", "0")):
            with self.subTest(words=words):
                self.assert_refused_once(ranks, *words, says=says)
        self.assertIn("first.h5", self.rodsweep(0, "query", "first.h5", code=USER_ERROR).stderr)
        self.assertEqual(checksum("first.h5"), before)
        again = self.rodsweep(2, "run", path, "-o", "first.h5", "--resume")
        self.assertIn("already ended", again.stderr)
        self.assertEqual(checksum("first.h5"), before)
        self.assertFalse(os.path.exists("results/lost.h5"))

    def stopped_training(self, name):
        """An unfinished training in NAME.h5; returns its job."""
        path = train_job(name, training={"epochs": 1000000})
        process = self.start(0, path, f"{name}.h5", 1)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=600)
        self.assertEqual(process.returncode, STOPPED)
        return path

    def test_another_data_set_is_no_continuation(self):
        self.stopped_training("moved")
        other = data_job("other_data", samples=12, steps=10, seed=99, record={"systems": "first"})
        self.rodsweep(0, "run", other, "-o", "other_data.h5")
        path = train_job("moved", data="other_data.h5", training={"epochs": 1000000})
        self.assert_refused_once(2, "run", path, "-o", "moved.h5", "--resume", says=("moved.h5", "other_data.h5"))
        longer = train_job("moved", training={"epochs": 900000})
        self.assert_refused_once(2, "run", longer, "-o", "moved.h5", "--resume",
                                 says=("training.epochs was 1000000 and is 900000", "another number begins anew"))

    def test_a_training_that_diverges_says_so_and_keeps_what_it_has(self):
        path = self.stopped_training("wild")
        kept = json.loads(rodsweep(0, "info", "wild.h5", "--json").stdout)
        with h5py.File("wild.h5", "r+") as file:
            file["checkpoint/weights"][:] *= np.float32(1e30)
        ran = self.rodsweep(2, "run", path, "-o", "wild.h5", "--resume", code=DIVERGED)
        self.assertIn("not finite", ran.stdout)
        now = json.loads(rodsweep(0, "info", "wild.h5", "--json").stdout)
        self.assertEqual((now["hash"], now["best_epoch"]), (kept["hash"], kept["best_epoch"]))
        self.assertEqual(now["runs"][1]["exit_code"], DIVERGED)

    def test_plan_and_validate(self):
        path = train_job("planned")
        planned = json.loads(rodsweep(0, "plan", path, "--json").stdout)
        self.assertEqual([planned[key] for key in ("training_simulations", "epochs", "most_training_examples", "most_steps")],
                         [18, 3, 180, 66])
        ran = self.rodsweep(0, "run", path, "-o", "planned.h5").stderr
        examples, each = map(int, re.search(r"(\d+) examples from 18 simulations, (\d+) steps in each", ran).groups())
        self.assertLessEqual(examples, 180)
        self.assertLessEqual(3 * each, 66)
        said = rodsweep(3, "plan", path)
        self.assertEqual(said.stdout.count("parameters"), 1, said.stdout)
        self.assertIn("planned.json: ", self.rodsweep(0, "validate", path).stdout)


if __name__ == "__main__":
    unittest.main()
