#!/usr/bin/python3
"""The same sweep with 1, 2, 4, ... workers, up to one on each core, in turns; target: two workers at least 1.8 times as
fast as one.

bench_scaling.py RODSWEEP MPIRUN [REPEATS [SAMPLES]]; it removes its files. SAMPLES: a third of the tasks, by default 60
a core. Times are those of whole commands, with the start of MPI and the file.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

JOB = {
    "name": "scaling", "kind": "sweep", "seed": 1,
    "scene": {"type": "bending_rod", "segments": {"grid": [20, 30, 40]}, "length_m": {"uniform": [1, 5]},
              "radius_m": 0.05, "density_kg_m3": 1000, "youngs_modulus_pa": {"log_uniform": [1e4, 1e6]},
              "torsion_modulus_pa": 1e6},
    "time": {"step_s": 0.02, "steps": 60},
    "guesses": ["zero", "previous", "quadratic"],
}


def sweep_seconds(rodsweep, mpirun, workers):
    begin = time.monotonic()
    subprocess.run([mpirun, "-n", str(workers + 1), rodsweep, "run", "scaling.json", "-o", "x.h5"],
                   check=True, stdin=subprocess.DEVNULL, capture_output=True)
    seconds = time.monotonic() - begin
    os.remove("x.h5")
    return seconds


def main():
    rodsweep, mpirun = sys.argv[1:3]
    repeats = int(sys.argv[3]) if len(sys.argv) > 3 else 5
    cores = len(os.sched_getaffinity(0))
    samples = int(sys.argv[4]) if len(sys.argv) > 4 else 60 * cores
    times = {workers: [] for workers in sorted({2**k for k in range(cores.bit_length())} | {cores}) if workers <= cores}
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        with open("scaling.json", "w") as file:
            json.dump({**JOB, "samples": samples}, file)
        for _ in range(repeats):
            for workers, seconds in times.items():
                seconds.append(sweep_seconds(rodsweep, mpirun, workers))
    print(f"scaling, {3 * samples} tasks, medians of {repeats}:")
    one = statistics.median(times[1])
    for workers, seconds in times.items():
        here = statistics.median(seconds)
        print(f"{workers:5} workers {here:8.2f} s, {one / here:5.2f} times as fast")


if __name__ == "__main__":
    main()
