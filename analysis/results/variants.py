#!/usr/bin/python3
"""Trains what network/pretrained/rods.h5 could have been, to choose by validation alone: `make variants` calls it.

    analysis/results/variants.py PROGRAM RESULTS

Every variant is jobs/train_rods.json for EPOCHS epochs with one setting changed (of its processor, those that belong to
it), or all of it from another seed; its job and model are RESULTS/rods_variants/NAME.json and .h5. What is trained is
left alone, what was stopped goes on.
"""

import json
import os
import subprocess
import sys

EPOCHS = 15
SWEEPS = {"processor": "sweeps", "recurrence": "gated"}
LINEAR = {"processor": "sweeps", "recurrence": "linear"}
VARIANTS = {
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
    "rods_seed_2": {"seed": 2},
    "rods_seed_3": {"seed": 3},
}


def job_of(name, changes, data):
    with open(os.path.join(os.path.dirname(__file__), "../../jobs/train_rods.json"), encoding="utf-8") as file:
        job = json.load(file)
    del job["$schema"]
    job.update(name=name, description="A variant of train_rods.", data=data)
    if "seed" in changes:
        return {**job, **changes}
    job["training"]["epochs"] = EPOCHS
    for key, value in changes.items():
        job["training" if key in ("loss", "rate") else "network"][key] = value
    if job["network"]["base"] == "none":
        del job["network"]["base_size"]
    return job


def main():
    program, results = sys.argv[1:]
    folder = os.path.join(results, "rods_variants")
    os.makedirs(folder, exist_ok=True)
    for name, changes in VARIANTS.items():
        path = os.path.join(folder, name)
        with open(path + ".json", "w", encoding="utf-8") as file:
            json.dump(job_of(name, changes, "../rods_data.h5"), file, indent=2)
        subprocess.run([program, "run", path + ".json", "-o", path + ".h5", "--resume"], check=True)


if __name__ == "__main__":
    main()
