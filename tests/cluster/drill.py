#!/usr/bin/python3
"""The drill: a sweep of 2,000 tasks over three hosts, with all that can happen to it, left alone until it is done.

    make drill

A worker is killed, one is stopped, a host is cut off, the master is killed, the disk is full for a while, the power is cut, the
time limit is met twice, and one task ends every worker that runs it. What stands for the batch system begins the job again where
it ended at its time limit, or died with the power, with the same line. In the end the file must be that of an undisturbed run,
bit for bit, but for the rows of the task that is to blame, which must be named. The results are on a file system of their own,
which is cut off as in tests/mpi/test_power_cut.py.

It prints what happened when, and for each fault how long it took until work went on. Needs root; within alone.sh.
"""

import json
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
from hosts import Hosts
from sweeps import KeptSweep, ranks_on, run_undisturbed, states

import h5py
from test_power_cut import Disk
from test_sweeps import ALL_DONE, STOPPED, TASKS_FAILED, job, rodsweep, status

TASKS, KILLER = 2000, 1999
RUN = ("--worker-timeout", "2")
KEEP = ("--pause", "0.5", "--silence", "10")
LIMITED = ("--time-limit", "20")  # of the first two times that the batch system gives


def drill_job():
    """Small tasks, each of its own, and one that is longer and the last in the file."""
    spread = [round(1 + 4 * n / TASKS, 6) for n in range(TASKS)]
    segments = [20 + n % 11 for n in range(KILLER)] + [300]
    rod = {"type": "bending_rod", "segments": {"zip": segments}, "length_m": {"zip": spread}, "radius_m": 0.05,
           "density_kg_m3": 1000, "youngs_modulus_pa": {"log_uniform": [1e4, 1e6]}, "torsion_modulus_pa": 1e6,
           "initial_angle_deg": {"uniform": [0, 45]}}
    return job("drill", samples=1, scene=rod, steps=40, guesses=["zero", "previous"],
               record={"solves": "summary", "norms": "one"})


class Killer(threading.Thread):
    """Ends whoever runs the task that is to blame."""

    def __init__(self, hosts, path, tell):
        super().__init__(daemon=True)
        self.hosts, self.path, self.tell, self.killed = hosts, path, tell, 0

    def run(self):
        before = 0
        while True:
            time.sleep(0.01)
            try:
                with h5py.File(self.path, "r", locking=False) as file:
                    starts, rank = int(file["timing/tasks/starts"][KILLER]), int(file["timing/tasks/rank"][KILLER])
                    host = file["timing/tasks/host"][KILLER].decode()
            except (OSError, KeyError):
                continue
            if starts > before:
                pid = next((ranks_on(h).get(rank) for h in self.hosts if h.name == host), None)
                if pid:
                    os.kill(pid, signal.SIGKILL)
                    self.killed += 1
                    self.tell(f"task {KILLER} ends rank {rank} on {host}, the {self.killed}. time")
            before = starts


class Drill:
    def __init__(self):
        self.begin = time.monotonic()
        self.table = []
        self.hosts = Hosts("hosts")
        self.disk = Disk("disk", megabytes=64)
        self.path = os.path.join(self.disk.folder, "drill.h5")
        self.job = drill_job()
        self.sweep, self.limits_met = None, 0

    def tell(self, text):
        done = "" if self.sweep is None else f"{self.done():5} tasks  "
        print(f"{time.monotonic() - self.begin:6.1f} s  {done}{text}", flush=True)

    def done(self):
        found = states(self.path)
        return 0 if found is None else int(found.sum())

    def submit(self):
        """What a batch system does with a job, again and again."""
        limit = LIMITED if self.limits_met < 2 else ()
        self.sweep = KeptSweep(self.hosts, self.job, self.path, run=(*RUN, *limit, "--resume"), keep=KEEP)

    def watch(self):
        """The batch system's part: is it to be begun again? True: it was."""
        if self.sweep.runs():
            return False
        if self.sweep.end() != STOPPED:
            return False
        self.limits_met += 1
        self.tell(f"the time limit is met, the {self.limits_met}. time")
        at = time.monotonic()
        self.submit()
        self.recovered("the time limit", at)
        return True

    def wait_for(self, count):
        deadline = time.monotonic() + 600
        while self.done() < count:
            self.watch()
            assert self.sweep.runs() and time.monotonic() < deadline, self.sweep.text()
            time.sleep(0.05)

    def recovered(self, what, since, text="work goes on"):
        before = self.done()
        while self.done() <= before:
            assert time.monotonic() - since < 300, self.sweep.text()
            if not self.sweep.runs() and self.sweep.end() != STOPPED:
                break
            time.sleep(0.02)
        self.note(what, since, text)

    def note(self, what, since, text):
        seconds = time.monotonic() - since
        self.table.append((what, seconds))
        self.tell(f"{text}, {seconds:.1f} s after {what}")

    def given_to_others(self, what, since, ranks):
        """Until what these ranks had in hand is in others', or another start has it."""
        start = self.sweep.begin + 0
        at = since - start
        while not all(self.sweep.said(rf"rank {rank} on .* was not heard", at) for rank in ranks):
            assert time.monotonic() - since < 300, self.sweep.text()
            if self.watch() or not self.sweep.runs():
                break
            time.sleep(0.05)
        self.note(what, since, "others have its tasks")

    # ---- what happens

    def kill_a_worker(self):
        rank, pid = max(ranks_on(self.hosts[1]).items())
        self.tell(f"rank {rank} on {self.hosts[1].name} is killed")
        os.kill(pid, signal.SIGKILL)
        self.given_to_others("a worker was killed", time.monotonic(), [rank])

    def stop_a_worker(self):
        rank, pid = max(ranks_on(self.hosts[0]).items())
        self.tell(f"rank {rank} on {self.hosts[0].name} is stopped")
        os.kill(pid, signal.SIGSTOP)
        self.given_to_others("a worker was stopped", time.monotonic(), [rank])

    def cut_off_a_host(self):
        host = self.hosts[2]
        ranks = list(ranks_on(host))
        self.tell(f"{host.name} is cut off, with ranks {ranks}")
        host.cut_off()
        self.given_to_others("a host was cut off", time.monotonic(), ranks)

    def kill_the_master(self):
        self.tell("the master is killed")
        os.kill(ranks_on(self.hosts[0])[0], signal.SIGKILL)
        self.recovered("the master was killed", time.monotonic())

    def fill_the_disk(self):
        self.tell("the disk is full")
        full = os.path.join(self.disk.folder, "other")
        with open(full, "wb", buffering=0) as file:
            for size in (1 << 20, 1 << 12):
                try:
                    while True:
                        file.write(bytes(size))
                except OSError:
                    pass
        time.sleep(10)
        os.remove(full)
        self.tell("there is room again")
        self.recovered("there was room again", time.monotonic())

    def cut_the_power(self):
        self.tell("the power is cut, while the disk is being written to")
        writing = threading.Thread(target=subprocess.run, args=(["sync", "-f", self.disk.folder],),
                                   kwargs={"capture_output": True, "check": False})
        writing.start()
        self.disk.cut()
        self.sweep.process.kill()
        for host in self.hosts:
            host.die()
        self.sweep.process.wait()
        writing.join()
        self.disk.unmount()
        self.disk.mount()
        for host in self.hosts:
            host.up()
        self.tell("the power is back")
        at = time.monotonic()
        self.submit()
        self.recovered("the power was back", at)

    def run(self):
        run_undisturbed(self.job, "whole.h5")
        self.tell("the undisturbed run is done")
        self.submit()
        killer = Killer(self.hosts, self.path, self.tell)
        killer.start()
        for count, happens in ((100, self.kill_a_worker), (250, self.stop_a_worker), (400, self.kill_the_master),
                               (650, self.fill_the_disk), (900, self.cut_off_a_host), (1200, self.cut_the_power)):
            self.wait_for(count)
            happens()
            if happens == self.cut_the_power:
                continue
        self.hosts[2].reconnect()
        while self.sweep.runs() or self.watch():
            time.sleep(0.1)
        self.tell(f"it ended with {self.sweep.end()}")
        assert self.sweep.end() == TASKS_FAILED, self.sweep.text()
        self.check(killer)

    def check(self, killer):
        after = status(self.path)
        print(json.dumps(after["outcomes"]), json.dumps(after["failures"]))
        assert after["outcomes"] == {"ok": TASKS - 1, "crashed": 1}, after["outcomes"]
        assert [f["task"] for f in after["failures"]] == [KILLER], after["failures"]
        assert killer.killed == 3, killer.killed
        assert self.limits_met >= 2, self.limits_met
        same = compare("whole.h5", self.path)
        verified = json.loads(rodsweep(0, "info", self.path, "--verify", "--json").stdout)["verified"]
        assert verified == {"checked": TASKS, "damaged": []}, verified
        print(f"{same} data sets are those of the undisturbed run, but for the rows of task {KILLER}; all checksums hold")
        print(f"{len(after['starts'])} starts; work went on:")
        for what, seconds in self.table:
            print(f"  {seconds:5.1f} s after {what}")


def compare(whole, path):
    """Bit for bit, up to the rows of the last task. Returns how many data sets there are."""
    compared = 0
    with h5py.File(whole) as one, h5py.File(path) as other:
        ends = {TASKS: KILLER}
        for kind in ("solve", "step"):
            if f"tasks/first_{kind}" in one:
                first, count = (one[f"tasks/{name}"] for name in (f"first_{kind}", f"{kind}s"))
                ends[int(first[KILLER] + count[KILLER])] = int(first[KILLER])

        def visit(name, item):
            nonlocal compared
            if not isinstance(item, h5py.Dataset) or name.startswith(("timing", "runs")):
                return
            end = ends.get(item.shape[0], item.shape[0]) if item.shape else None
            ours, theirs = (np.asarray(d[:end] if end is not None else d[()]) for d in (item, other[name]))
            assert ours.tobytes() == theirs.tobytes(), f"{name} differs"
            compared += 1

        one.visititems(visit)
    return compared


if __name__ == "__main__":
    drill = Drill()
    try:
        drill.run()
    finally:
        if drill.sweep is not None and drill.sweep.runs():
            print(drill.sweep.text())
    sys.exit(ALL_DONE)
