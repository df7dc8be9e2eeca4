#!/usr/bin/python3
"""Law: however a sweep is run, its file is the same. The job has every guess, alone and in every guess that uses another,
values drawn with every sampling, and rods of unequal length; it runs on several ranks, in shards down to one task a
process, and with a sample more later.

Run by CTest in an empty folder, with RODSWEEP, MPIRUN, SOURCE_DIR and WATCHING_PLUGIN in the environment.
"""

import json
import os
import sys
import unittest
from pathlib import Path

SOURCE = Path(os.environ["SOURCE_DIR"])
sys.path.insert(0, str(SOURCE / "tests" / "mpi"))
from program import SweepCase, rodsweep, status  # noqa: E402

PARAMETERS = {    # of guesses that have no defaults for all
    "copingnet": {"model": str(SOURCE / "network" / "pretrained" / "rods.h5"), "corrections": 2, "lag_steps": 2},
    "knn": {"data": "data.h5", "k": 2},
    "guarded": {"threshold": 0.5},
    "plugin": {"library": os.environ["WATCHING_PLUGIN"]},
    "python": {"file": str(SOURCE / "tests" / "laws" / "mean_guess.py")},
    "ritz": {"size": 3, "collected": 5, "lag_steps": 1},
}
SCHEMA = json.loads(rodsweep(0, "schema").stdout)
GUESSES = {name: row["properties"] for kind in SCHEMA["definitions"]["guess"]["anyOf"]
           for name, row in kind.get("properties", {}).items() if "properties" in row}
SAMPLINGS = SCHEMA["properties"]["sampling"]["enum"]


def guesses():
    """All alone, and in each that uses another: one that keeps what it is given, and one that says what it misses."""
    def made(name, **more):
        return {name: {**PARAMETERS.get(name, {}), **more}}
    outer = [name for name, row in GUESSES.items() if "guess" in row]
    alone = [made(name) for name in GUESSES if name not in outer]
    return alone + [made(name, guess=inner) for name in outer for inner in ("quadratic", made("plugin"))]


class EveryRun(SweepCase):
    @classmethod
    def setUpClass(cls):
        Path("rods.csv").write_text("0,0,0\n1,0,0\n\n0,0,1\n0.6,0,1\n", encoding="utf-8")
        data = cls.job("data", kind="dataset", guesses=None, evaluation=None)
        assert rodsweep(0, "run", data, "-o", "data.h5").returncode == 0

    @staticmethod
    def job(name, **changes):
        values = {
            "name": name, "kind": "sweep", "samples": 3, "evaluation": "paired",
            "scene": {"type": "curves", "curves": "rods.csv", "segment_m": 0.1, "held_at_m": [[0, 0, 0], [0, 0, 1]],
                      "radius_m": {"uniform": [0.01, 0.02]}, "density_kg_m3": 1000,
                      "youngs_modulus_pa": {"log_uniform": [1e5, 1e6]}, "torsion_modulus_pa": 1e6},
            "time": {"step_s": 0.02, "steps": 4, "newton_iterations": 2},
            "guesses": guesses(), **changes}
        path = Path(name + ".json")
        path.write_text(json.dumps({key: value for key, value in values.items() if value is not None}), encoding="utf-8")
        return str(path)

    def merged(self, path, shards, *more):
        """The file of the shards."""
        files = [f"{path}-{number}.h5" for number in range(1, shards + 1)]
        for number, file in enumerate(files, 1):
            self.rodsweep(0, "run", path, "--shard", f"{number}/{shards}", "-o", file)
        self.rodsweep(0, "merge", *files, *more, "-o", path + "-merged.h5")
        return path + "-merged.h5"

    def test_ranks_shards_and_later_samples(self):
        for sampling in SAMPLINGS:
            for evaluation, shards in (("paired", 3), ("closed_loop", 4)):
                with self.subTest(sampling=sampling, evaluation=evaluation):
                    path = self.job(f"{sampling}-{evaluation}", sampling=sampling, evaluation=evaluation)
                    whole = path + ".h5"
                    self.rodsweep(0, "run", path, "-o", whole)
                    self.assertEqual(set(status(whole)["outcomes"]), {"ok"})
                    self.rodsweep(3, "run", path, "-o", path + "-ranks.h5")
                    self.assert_same_results(whole, path + "-ranks.h5")
                    self.assert_same_results(whole, self.merged(path, shards))

                    fewer = self.job(f"{sampling}-{evaluation}-fewer", sampling=sampling, evaluation=evaluation, samples=2)
                    self.rodsweep(2, "run", path, "--extend", self.merged(fewer, 2), "-o", path + "-later.h5")
                    self.assert_same_results(whole, path + "-later.h5")


if __name__ == "__main__":
    unittest.main()
