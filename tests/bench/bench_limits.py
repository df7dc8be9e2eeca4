#!/usr/bin/python3
"""Limits of one master and one file for very small tasks. docs/scale.md derives the saturation from them.

bench_limits.py RODSWEEP MPIRUN [MOST_TASKS]

  start   wall time of a sweep of one task, over the number of ranks
  begin   wall time until tasks begin (plan, file), and largest memory of master and worker, over the number of tasks; the
          same for --resume
  rate    tiny tasks per second, over the number of workers, and the master's processor time per task, which bounds
          the rate of assignment
  write   MB/s that workers write into the one file (/timing/tasks/write_s; into the page cache first), each and
          together, over the number of workers

With more ranks than cores, ranks wait for each other: their times are upper bounds.
"""

import json
import os
import subprocess
import sys
import tempfile
import time

import h5py

AS_RANK = "--as-rank"
JOB = {
    "name": "limits", "kind": "sweep", "seed": 1,
    "scene": {"type": "bending_rod", "segments": 2, "length_m": {"uniform": [1, 5]}, "radius_m": 0.05,
              "density_kg_m3": 1000, "youngs_modulus_pa": 1e5, "torsion_modulus_pa": 1e6},
    "time": {"step_s": 0.02, "steps": 1, "newton_iterations": 1},
    "guesses": ["zero", "previous"],
}
LARGE = {  # records of 11 MB with little work
    **{key: value for key, value in JOB.items() if key != "guesses"}, "scene": {**JOB["scene"], "segments": 2000},
    "time": {**JOB["time"], "steps": 100}, "solve": {"method": "direct"},
    "record": {"trajectory_every": 1, "solves": "summary"},
}


class Sweeps:
    def __init__(self, rodsweep, mpirun):
        self.rodsweep, self.mpirun = rodsweep, mpirun

    def run(self, ranks, tasks, *options, job=None):
        """Wall time; largest resident memory in MB and processor time of every rank. Keeps the last file."""
        if os.path.exists("out.h5") and "--resume" not in options:
            os.remove("out.h5")
        with open("job.json", "w") as file:
            json.dump({**(job or JOB), "samples": tasks}, file)
        begin = time.monotonic()
        done = subprocess.run([self.mpirun, "-n", str(ranks), sys.executable, os.path.abspath(__file__), AS_RANK,
                               self.rodsweep, "run", "job.json", "-o", "out.h5", *options],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True)
        seconds = time.monotonic() - begin
        if not os.path.exists("out.h5"):
            sys.exit(done.stderr)
        memory, processor = [], []
        for rank in range(ranks):
            with open(f"rank-{rank}.json") as file:
                usage = json.load(file)
            memory.append(usage["mb"])
            processor.append(usage["processor_s"])
        return seconds, memory, processor


def as_rank(command):
    """Runs a rank's command; writes its memory and its processor time to a file."""
    process = subprocess.Popen(command)
    _, _, usage = os.wait4(process.pid, 0)
    with open(f"rank-{os.environ['OMPI_COMM_WORLD_RANK']}.json", "w") as file:
        json.dump({"mb": usage.ru_maxrss / 1024, "processor_s": usage.ru_utime + usage.ru_stime}, file)
    sys.exit(0)  # so that mpirun lets the other ranks write their files


def main():
    if sys.argv[1] == AS_RANK:
        as_rank(sys.argv[2:])
    sweeps = Sweeps(*sys.argv[1:3])
    most = int(sys.argv[3]) if len(sys.argv) > 3 else 1_000_000
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for ranks in (2, 4, 8, 16, 32):
            print(f"limits: start of {ranks} ranks: {sweeps.run(ranks, 1)[0]:.2f} s", flush=True)
        tasks = 1000
        while tasks <= most:
            for how in ((), ("--resume",)):
                seconds, memory, _ = sweeps.run(3, tasks, "--time-limit", "0.001", *how)
                print(f"limits: begin of {tasks} tasks: {seconds:.2f} s, master {memory[0]:.0f} MB, workers "
                      f"{max(memory[1:]):.0f} MB{', resumed' if how else ''}", flush=True)
            tasks *= 10
        tasks = 20_000
        for ranks in (2, 3, 5, 9, 17):
            begin, _, idle = sweeps.run(ranks, tasks, "--time-limit", "0.001")
            end, _, busy = sweeps.run(ranks, tasks)
            print(f"limits: rate of {ranks - 1} workers: {tasks / (end - begin):.0f} tasks/s, "
                  f"{1e6 * (busy[0] - idle[0]) / tasks:.0f} us of the master's processor each", flush=True)
        for workers in (1, 2, 4, 8, 16):
            sweeps.run(workers + 1, 4 * workers, job=LARGE)
            with h5py.File("out.h5") as file:
                megabytes = sum(file[name].nbytes for name in ("trajectories/position_m", "trajectories/orientation")) / 1e6
                writing = float(file["timing/tasks/write_s"][:].sum())
            print(f"limits: write of {workers} workers: {megabytes / writing:.0f} MB/s each, "
                  f"{workers * megabytes / writing:.0f} MB/s together", flush=True)


if __name__ == "__main__":
    main()
