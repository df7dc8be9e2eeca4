"""Runs the program under mpirun from tests: RODSWEEP and MPIRUN are their paths. Files are in the current folder."""

import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import time
import unittest

import h5py

RODSWEEP = os.environ["RODSWEEP"]
MPIRUN = os.environ.get("MPIRUN", "mpirun")
ALL_DONE, USER_ERROR, TASKS_FAILED, STOPPED, TOO_LONG, LOST, DIVERGED = 0, 2, 3, 4, 5, 6, 9


def job(name="small", samples=3, segments=(6, 9), steps=6, **changes):
    """Writes NAME.json, a sweep of samples x segments tasks; returns its path. A change to None removes a key."""
    values = {
        "name": name, "kind": "sweep", "seed": 5, "samples": samples, "evaluation": "paired",
        "scene": {"type": "bending_rod", "segments": {"grid": list(segments)}, "length_m": {"uniform": [1, 5]},
                  "radius_m": 0.05, "density_kg_m3": 1000, "youngs_modulus_pa": {"log_uniform": [1e4, 1e6]},
                  "torsion_modulus_pa": 1e6, "initial_angle_deg": {"uniform": [0, 45]}},
        "time": {"step_s": 0.02, "steps": steps},
        "solve": {"method": "cg", "preconditioner": "jacobi", "tolerance": 1e-2},
        "guesses": ["zero", "previous", "quadratic", {"oracle": {"error": 0.1}}],
        "record": {"solves": "all", "trajectory_every": 2},
    }
    values.update(changes)
    path = name + ".json"
    with open(path, "w") as file:
        json.dump({key: value for key, value in values.items() if value is not None}, file, indent=2)
    return path


def data_job(name="data", **changes):
    """The same job as a data set."""
    return job(name, **{"kind": "dataset", "evaluation": None, "solve": None, "guesses": None,
                        "record": {"solves": "all", "systems": "all"}, **changes})


def long_job(name="long", samples=20):
    """Half a second of work in many tasks, enough to interrupt it in the middle."""
    return job(name, samples=samples, segments=(15, 30), steps=40,
               record={"solves": "all", "trajectory_every": 2, "norms": "one"})


def command(ranks, *words):
    recovers = os.environ.get("OMPI_MCA_orte_enable_recovery") == "1" and shutil.which("prterun")    # Open MPI 5
    launcher = [MPIRUN, *(["--enable-recovery"] if recovers else []), "-n", str(ranks)]
    return (launcher if ranks else []) + [RODSWEEP, *words]


def rodsweep(ranks, *words, timeout=600):
    """Runs the program to its end; returns the completed process with its output. ranks 0: without mpirun."""
    return subprocess.run(command(ranks, *words), stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=timeout)


def start(ranks, *words):
    # The program gets default signal actions, as in an interactive or batch shell.
    return subprocess.Popen(command(ranks, *words), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def status(path):
    return json.loads(rodsweep(0, "status", path, "--json").stdout)


def wait_for_tasks(process, path, count):
    """Waits until `count` tasks are in the file; the sweep must still run then. Reads the file itself, which is faster
    than a start of the program, so that even a short sweep is interrupted in the middle."""
    deadline = time.monotonic() + 600
    while time.monotonic() < deadline:
        if os.path.exists(path):
            with h5py.File(path) as file:
                done = file["tasks/state"][:] != 0
            if done.sum() >= count:
                assert (~done).sum() > count and process.poll() is None, "the sweep is too short to be interrupted"
                return
        assert process.poll() is None, process.communicate()
        time.sleep(0.005)
    raise AssertionError(f"{path} never got {count} tasks")


def ranks_of(mpirun):
    """PIDs of mpirun's ranks, by rank."""
    ranks = {}
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{entry}/stat") as file:
                parent = int(file.read().rsplit(")", 1)[1].split()[1])
            if parent == mpirun.pid:
                ranks[rank_of(entry)] = int(entry)
        except (FileNotFoundError, ProcessLookupError, PermissionError):
            continue
    ranks.pop(None, None)
    return ranks


def rank_of(pid):
    """The rank of a process under mpirun, or None."""
    with open(f"/proc/{pid}/environ", encoding="utf-8", errors="replace") as file:
        found = re.search(r"\0OMPI_COMM_WORLD_RANK=(\d+)\0", "\0" + file.read())
    return int(found[1]) if found else None


def kill_all(mpirun):
    for pid in [mpirun.pid, *ranks_of(mpirun).values()]:
        os.kill(pid, signal.SIGKILL)


def checksum(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


class SweepCase(unittest.TestCase):
    def rodsweep(self, ranks, *words, code=ALL_DONE):
        """Runs the program, which must exit with this code; returns the completed process."""
        process = rodsweep(ranks, *words)
        self.assertEqual(process.returncode, code, f"{process.stdout}\n{process.stderr}")
        return process

    def assert_refused_once(self, ranks, *words, says):
        process = self.rodsweep(ranks, *words, code=USER_ERROR)
        self.assertEqual(process.stderr.count("rodsweep: error:"), 1, process.stderr)
        self.assertNotIn("Primary job", process.stderr)  # mpirun does not repeat it in twelve lines
        self.assertEqual(process.stdout, "")
        for text in (says,) if isinstance(says, str) else says:
            self.assertIn(text, process.stderr)

    def assert_same_results(self, one, other):
        diff = subprocess.run(["h5diff", "--exclude-path", "/timing", "--exclude-path", "/runs", one, other],
                              capture_output=True, text=True)
        self.assertEqual((diff.returncode, diff.stdout), (0, ""))

    def assert_whole(self, path):
        info = json.loads(rodsweep(0, "info", path, "--verify", "--json").stdout)
        self.assertEqual(info["pending"], 0)
        self.assertEqual(info["verified"], {"checked": info["tasks"], "damaged": []})
