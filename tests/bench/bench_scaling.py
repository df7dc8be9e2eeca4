#!/usr/bin/python3
"""Two workers against one: the same sweep with 3 and with 2 ranks in turns; target: at least 1.8 times as fast.

bench_scaling.py RODSWEEP MPIRUN [REPEATS]; it removes its files.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

JOB = {
    "name": "scaling", "kind": "sweep", "seed": 1, "samples": 60,
    "scene": {"type": "bending_rod", "segments": {"grid": [20, 30, 40]}, "length_m": {"uniform": [1, 5]},
              "radius_m": 0.05, "density_kg_m3": 1000, "youngs_modulus_pa": {"log_uniform": [1e4, 1e6]},
              "torsion_modulus_pa": 1e6},
    "time": {"step_s": 0.02, "steps": 60},
    "guesses": ["zero", "previous", "quadratic"],
}


def sweep_seconds(rodsweep, mpirun, ranks):
    """Wall time of the whole command, including the start of MPI and the file."""
    begin = time.monotonic()
    subprocess.run([mpirun, "-n", str(ranks), rodsweep, "run", "scaling.json", "-o", f"{ranks}.h5"], check=True,
                   stdin=subprocess.DEVNULL, capture_output=True)
    seconds = time.monotonic() - begin
    os.remove(f"{ranks}.h5")
    return seconds


def main():
    rodsweep, mpirun = sys.argv[1:3]
    repeats = int(sys.argv[3]) if len(sys.argv) > 3 else 5
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        with open("scaling.json", "w") as file:
            json.dump(JOB, file)
        times = {2: [], 3: []}
        for _ in range(repeats):
            for ranks in times:
                times[ranks].append(sweep_seconds(rodsweep, mpirun, ranks))
    one, two = (statistics.median(times[ranks]) for ranks in (2, 3))
    print(f"scaling: {one:.2f} s with one worker, {two:.2f} s with two, medians of {repeats}: "
          f"{one / two:.2f} times as fast (target 1.8)")


if __name__ == "__main__":
    main()
