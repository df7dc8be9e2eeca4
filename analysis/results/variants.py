#!/usr/bin/python3
"""Trains variants of a network with one setting changed at a time, and the networks of the score: `jobs/studies.py
variants`, `ablation` and `score_networks` call it.

    analysis/results/variants.py PROGRAM RESULTS FAMILY

A family is a training job with common changes (such as fewer epochs), and its variants with one more change each.
Jobs, models and data sets that are not in jobs/ are RESULTS/FOLDER/NAME.json and .h5; NAME.log has the program's
output. Complete runs are kept, stopped ones are resumed. Each core trains one variant at a time, since two threads of
one training wait for each other.

All variants of an ablation have the same number of optimiser steps: fewer examples are seen more often.
"""

import json
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

JOBS = os.path.join(os.path.dirname(__file__), "../../jobs/networks")
ITS_OWN = None    # the value of the training job itself
SOME_FAILED = 3    # the program's exit code for a complete data set that lacks the simulations that failed

RODS = {
    "factors_16": {},
    "factors_32": {"network.latent": 32},
    "factors_64": {"network.latent": 64},
    "factors_16_none": {"network.base": "none"},
    "factors_16_subspace": {"network.base": "subspace", "network.base_size": 10},
    "factors_16_as_it_is": {"network.best_length": False},
    "factors_16_in_the_loop": {"training.loss": "in_the_loop"},
    "factors_16_rate_2e-3": {"training.rate": 2e-3},
    "factors_16_rate_8e-3": {"training.rate": 8e-3},
    "rods_seed_2": {"seed": 2, "training.epochs": ITS_OWN},
    "rods_seed_3": {"seed": 3, "training.epochs": ITS_OWN},
}
LATTICES = {
    "all_32": {},
    "all_16": {"network.latent": 16},
    "all_64": {"network.latent": 64},
    "all_32_none": {"network.base": "none"},
    "all_32_subspace": {"network.base": "subspace", "network.base_size": 10},
    "all_32_rate_2e-3": {"training.rate": 2e-3},
    "all_32_rate_8e-3": {"training.rate": 8e-3},
    "all_32_two_corrections": {"training.cg_steps": 2},
    "all_32_energy": {"training.loss": "energy"},
    "tree_32": {"network.couplings": "tree", "training.loss": "energy"},
    "all_32_seed_1": {"seed": 1},
    "all_32_seed_3": {"seed": 3},
    "all_32_100_steps": {"data": "100_steps", "training.epochs": 26},    # as many steps of the optimiser as lattices.h5
}


SEEDS = {"": 1, "-2": 2, "-3": 3}    # the first ones, whatever comes of them


def of_the_paper(epochs):
    """Variants of the paper's network: `epochs` times 256 simulations of 50 steps, or as many steps on other data."""
    every = {"training.systems": "all", "training.epochs": epochs // 4}
    return {
        "base": {},
        **{f"size_{n}": {"training_simulations": n, "training.epochs": epochs * 256 // n} for n in (8, 16, 32, 64, 128)},
        **{f"steps_{n}": {"network.steps": n} for n in (1, 2, 4, 8, 12)},
        **{f"latent_{n}": {"network.latent": n} for n in (16, 64)},
        **{f"hidden_layers_{n}": {"network.hidden_layers": n} for n in (2, 3)},
        "rate_5e-4": {"training.rate": 5e-4},
        "rate_5e-3": {"training.rate": 5e-3},
        "turned_1": {"training.turned_copies": 1, "training.epochs": epochs // 2},
        "turned_3": {"training.turned_copies": 3, "training.epochs": epochs // 4},
        "loss_multipliers": {"network.moves": False},
        "loss_energy": {"network.moves": False, "training.loss": "energy"},
        "loss_in_the_loop": {"network.moves": False, "training.loss": "in_the_loop"},
        "best_length": {"network.best_length": True},
        "globals": {"network.globals": True},
        "globals_energy": {"network.globals": True, "network.moves": False, "training.loss": "energy"},
        "globals_in_the_loop": {"network.globals": True, "network.moves": False, "training.loss": "in_the_loop"},
        "base_extrapolation": {"network.base": "extrapolation"},
        "base_regression": {"network.base": "regression", "network.base_size": 6},
        "base_subspace": {"network.base": "subspace", "network.base_size": 10},
        "encoding_linear_system": {"network.moves": False, "training.loss": "energy",    # no moves, only this loss
                                   "network.encoding": "linear_system"},
        "all_paper": every,
        "all_paper_residual": {**every, "network.encoding": "paper_residual"},
        "data_100_steps": {"data": "100", "training.epochs": epochs // 2},
        "data_0.01_s": {"data": "0.01_s"},
        "data_0.005_s": {"data": "0.005_s"},
        "seed_2": {"seed": 2},
        "seed_3": {"seed": 3},
        **{name: {"network.globals": True, "network.moves": False, "training.loss": "energy", "data": "100",
                  "training.epochs": epochs // 2, "seed": seed}
           for seed, name in ((1, "best"), (2, "best_seed_2"), (3, "best_seed_3"))},
    }


def damped(scenes):
    """The scenes of the score are damped."""
    return [scene if "damping_per_s" in scene else {**scene, "damping_per_s": {"uniform": [0, 3]}} for scene in scenes]


def on_every_step(samples, steps):
    """The steps of the score (docs/score.md), each sample with both integrators, with and without balance."""
    return {"samples": samples, "scene.zip": damped, "time.steps": steps, "time.step_s": {"log_uniform": [0.0005, 0.08]},
            "time.integrator": {"grid": ["euler", "bdf2"]}, "time.balance": {"grid": [False, True]}}


# Data sets other than that of jobs/SCENE_data.json: the changes to that job; None: a job of jobs/.
DATA = {
    "100": None,
    "0.01_s": {"time.step_s": 0.01},
    "0.005_s": {"time.step_s": 0.005},
    "100_steps": {"time.steps": 100, "record.systems": "first"},
    "every_step_of_rods": on_every_step(16, 40),    # the last two are for validation
    "every_step_of_more_rods": on_every_step(32, 20),    # with fewer, rods-large.h5 learns the rings by heart
    "every_step_of_lattices": on_every_step(30, 10),    # the last four are
}


class Family(NamedTuple):
    job: str                # in jobs/
    folder: str             # within the results
    changes: dict           # common to all variants
    variants: dict
    data: str = ""          # job in jobs/ that DATA changes


def ablation(scene, epochs, without=()):
    changes = {"network.latent": 32, "training.epochs": epochs}
    variants = {name: value for name, value in of_the_paper(epochs).items() if name not in without}
    return Family(f"train_{scene}_paper", f"ablation_{scene}", changes, variants, f"{scene}_data")


# On bending rods these give the same as similar variants; helices have twice as many segments and take twice as long.
NOT_ON_HELICES = {"size_16", "size_64", "steps_2", "steps_8", "hidden_layers_3", "rate_5e-4", "turned_3", "best_length",
                  "globals_in_the_loop", "base_extrapolation", "encoding_linear_system", "all_paper"}


def of_the_score(name, data, changes=None, which=""):
    """Three trainings of a network. Large ones need few epochs: an eighth of those of rods.h5 leaves 6 % more iterations
    at 1e-2 (rods_variants.txt)."""
    variants = {name.replace("_", "-") + suffix: {"seed": seed, "data": f"every_step_of_{which}{data}"}
                for suffix, seed in SEEDS.items()}
    return Family(f"train_{name}", f"score_{data}", changes or {}, variants, f"{data}_data")


FAMILIES = {
    "score_rods": of_the_score("rods", "rods"),
    "score_rods_large": of_the_score("rods_large", "rods", {"training.epochs": 30}, "more_"),
    "score_lattices": of_the_score("lattices", "lattices", {"training.epochs": 8, "validation_simulations": 128}),
    "rods": Family("train_rods", "rods_variants", {"training.epochs": 15}, RODS),
    "lattices": Family("train_lattices", "lattices_variants", {"training.epochs": 5}, LATTICES, "lattices_data"),
    "ablation_bending": ablation("bending", 10),
    "ablation_helix": ablation("helix", 5, NOT_ON_HELICES),
}


def changed(original, name, changes):
    """The job `original` of jobs/ with another name and changed values, {path: value or its function of the old one}."""
    with open(os.path.join(JOBS, original + ".json"), encoding="utf-8") as file:
        job = json.load(file)
    del job["$schema"]
    job.update(name=name, description=f"A variant of {original}.")
    for path, value in changes.items():
        *parts, last = path.split(".")
        of = job
        for part in parts:
            of = of.setdefault(part, {})
        of[last] = value(of[last]) if callable(value) else value
    return job


def training(family, name):
    """The job of a variant, without keys that its other values make useless."""
    changes = {**family.changes, **family.variants[name]}
    data = changes.pop("data", None)
    job = changed(family.job, name, {key: value for key, value in changes.items() if value is not ITS_OWN})
    if data and DATA[data]:
        job["data"] = f"set_{data}.h5"
    else:
        job["data"] = os.path.join("..", f"{family.data}_{data}.h5" if data else job["data"].removeprefix("../../results/"))
    network = job["network"]
    if network.get("base") in ("none", "extrapolation"):
        network.pop("base_size", None)
    if network["processor"] != "message_passing":
        for key in ("steps", "moves", "globals", "hidden_layers"):
            network.pop(key, None)
    if job["training"]["loss"] != "in_the_loop":
        job["training"].pop("cg_steps", None)
    return job


def run(program, folder, job):
    """Runs a job; True if it is complete."""
    path = os.path.join(folder, job["name"])
    with open(path + ".json", "w", encoding="utf-8") as file:
        json.dump(job, file, indent=2)
    began = time.monotonic()
    with open(path + ".log", "a", encoding="utf-8") as log:
        code = subprocess.run([program, "run", path + ".json", "-o", path + ".h5", "--resume"], check=False, stdout=log,
                              stderr=log, stdin=subprocess.DEVNULL, env={**os.environ, "OMP_NUM_THREADS": "1"}).returncode
    complete = code in (0, SOME_FAILED)
    print(f"  {job['name']}: " + (f"{time.monotonic() - began:.0f} s" if complete else f"exit code {code}, see {path}.log"),
          flush=True)
    return complete


def main():
    program, results, name = sys.argv[1:]
    family = FAMILIES[name]
    folder = os.path.join(results, family.folder)
    os.makedirs(folder, exist_ok=True)
    data = dict.fromkeys(changes["data"] for changes in family.variants.values() if DATA.get(changes.get("data")))
    sets = [changed(family.data, "set_" + which, DATA[which]) for which in data]
    trainings = [training(family, variant) for variant in family.variants]
    meant = {json.dumps({**job, "name": "", "description": ""}): job["name"] for job in trainings}
    if len(meant) < len(trainings):
        sys.exit(f"{name}: some variants are the same training: only {', '.join(meant.values())} differ")
    print(f"{name}: {len(trainings)} trainings", flush=True)
    for jobs in (sets, trainings):
        with ThreadPoolExecutor(os.cpu_count()) as cores:
            if not all(list(cores.map(lambda job: run(program, folder, job), jobs))):
                sys.exit(1)


if __name__ == "__main__":
    main()
