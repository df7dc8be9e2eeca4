#!/usr/bin/python3
"""Trains what a network could have been, to choose by validation alone: `make variants` calls it.

    analysis/results/variants.py PROGRAM RESULTS FAMILY

A family is a training job and its variants: the job for some epochs with one setting changed (of its processor, those
that belong to it), or from another seed. Their jobs and models are RESULTS/FAMILY_variants/NAME.json and .h5.
What is trained is left alone, what was stopped goes on.
"""

import json
import os
import subprocess
import sys

ITS_OWN = None    # epochs of the training job itself
SWEEPS = {"processor": "sweeps", "recurrence": "gated"}
LINEAR = {"processor": "sweeps", "recurrence": "linear"}
RODS = {
    "factors_16": {},
    "factors_32": {"latent": 32},
    "factors_64": {"latent": 64},
    "factors_16_none": {"base": "none"},
    "factors_16_pod": {"base": "pod", "base_size": 10},
    "factors_16_as_it_is": {"best_length": False},
    "linear_16": LINEAR,
    "linear_32": {**LINEAR, "latent": 32},
    "gated_16": SWEEPS,
    "gated_32": {**SWEEPS, "latent": 32},
    "factors_16_in_the_loop": {"loss": "in_the_loop"},
    "factors_16_rate_2e-3": {"rate": 2e-3},
    "factors_16_rate_8e-3": {"rate": 8e-3},
    "rods_seed_2": {"seed": 2, "epochs": ITS_OWN},
    "rods_seed_3": {"seed": 3, "epochs": ITS_OWN},
}
LATTICES = {
    "all_32": {},
    "all_16": {"latent": 16},
    "all_64": {"latent": 64},
    "all_32_none": {"base": "none"},
    "all_32_pod": {"base": "pod", "base_size": 10},
    "all_32_rate_4e-3": {"rate": 4e-3},
    "all_32_rate_16e-3": {"rate": 16e-3},
    "all_32_two_corrections": {"cg_steps": 2},
    "all_32_energy": {"loss": "energy"},
    "tree_32": {"couplings": "tree", "loss": "energy"},
    "all_32_seed_2": {"seed": 2},
    "all_32_seed_3": {"seed": 3},
}
# Of each family: its variants, and for how many epochs.
FAMILIES = {"rods": (RODS, 15), "lattices": (LATTICES, 5)}
TRAINING_KEYS = ("epochs", "loss", "rate", "cg_steps")


def job_of(family, name, changes, epochs):
    original = f"train_{family}"
    with open(os.path.join(os.path.dirname(__file__), f"../../jobs/{original}.json"), encoding="utf-8") as file:
        job = json.load(file)
    del job["$schema"]
    job.update(name=name, description=f"A variant of {original}.", data=f"../{family}_data.h5")
    for key, value in {"epochs": epochs, **changes}.items():
        if key == "seed":
            job["seed"] = value
        elif value is not ITS_OWN:
            job["training" if key in TRAINING_KEYS else "network"][key] = value
    if job["network"]["base"] == "none":
        job["network"].pop("base_size", None)
    if job["training"]["loss"] != "in_the_loop":
        job["training"].pop("cg_steps", None)
    return job


def main():
    program, results, family = sys.argv[1:]
    variants, epochs = FAMILIES[family]
    folder = os.path.join(results, f"{family}_variants")
    os.makedirs(folder, exist_ok=True)
    for name, changes in variants.items():
        path = os.path.join(folder, name)
        with open(path + ".json", "w", encoding="utf-8") as file:
            json.dump(job_of(family, name, changes, epochs), file, indent=2)
        subprocess.run([program, "run", path + ".json", "-o", path + ".h5", "--resume"], check=True)


if __name__ == "__main__":
    main()
