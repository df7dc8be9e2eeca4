"""Sweeps over the hosts of hosts.py, observed from outside: ranks of each host, time of each printed line, task states.
Times are seconds since the start of the sweep."""

import os
import re
import subprocess
import sys
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "mpi"))

import h5py  # noqa: E402
from program import ALL_DONE, MPIRUN, RODSWEEP, rank_of, rodsweep  # noqa: E402


def run_undisturbed(job, path, ranks=5):
    done = rodsweep(ranks, "run", job, "-o", path, timeout=900)
    assert done.returncode == ALL_DONE, done.stderr


def processes_on(host, name):
    """PIDs of the host's processes with this name."""
    space, found = os.readlink(f"/proc/{host.first}/ns/pid"), []
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{entry}/comm", encoding="ascii") as file:
                if file.read() == name + "\n" and os.readlink(f"/proc/{entry}/ns/pid") == space:
                    found.append(int(entry))
        except (FileNotFoundError, ProcessLookupError):
            continue
    return found


def ranks_on(host):
    """PIDs of the program's ranks on the host, by rank."""
    ranks = {}
    for pid in processes_on(host, "rodsweep"):
        try:
            ranks[rank_of(pid)] = pid
        except (FileNotFoundError, ProcessLookupError):
            continue
    ranks.pop(None, None)
    return ranks


def states(path):
    """Whether each task is done; None while there is no file."""
    try:
        with h5py.File(path, "r", locking=False) as file:
            return file["tasks/state"][:] != 0
    except OSError:
        return None


class HostSweep:
    """A sweep with the master on the first host and two workers on each host. A dead rank does not end the others."""

    def __init__(self, hosts, job, path, run=(), slots=2):
        self.path, self.begin, self.lines = path, time.monotonic(), []
        ranks = slots * len(hosts) + 1
        words = [MPIRUN, "--mca", "orte_enable_recovery", "1", "--hostfile", hosts.file, "--map-by", "node", "--oversubscribe",
                 "-n", str(ranks), RODSWEEP, "run", job, "-o", path, *run]
        self.process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        text=True, errors="replace")
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        with self.process.stdout as lines:
            for line in lines:
                self.lines.append((self.now(), line.rstrip("\n")))

    def now(self):
        return time.monotonic() - self.begin

    def runs(self):
        return self.process.poll() is None

    def said(self, pattern, since=0.0):
        """Time of the first line that matches, or None."""
        return next((when for when, line in list(self.lines) if when >= since and re.search(pattern, line)), None)

    def text(self):
        return "\n".join(f"{when:6.1f} {line}" for when, line in list(self.lines))

    def done(self):
        found = states(self.path)
        return 0 if found is None else int(found.sum())

    def wait_until(self, what, ready, seconds=300):
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            found = ready()
            if found:
                return found
            assert self.runs(), f"it ended before {what}:\n{self.text()}"
            time.sleep(0.02)
        raise AssertionError(f"{what}: not within {seconds} s:\n{self.text()}")

    def wait_for_tasks(self, count, seconds=300):
        self.wait_until(f"{count} tasks", lambda: self.done() >= count, seconds)

    def kill(self):
        if self.runs():
            self.process.kill()
        self.process.wait()

    def end(self, seconds=600):
        try:
            self.process.wait(timeout=seconds)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"not done within {seconds} s:\n{self.text()}") from None
        self.reader.join(timeout=10)
        return self.process.returncode
