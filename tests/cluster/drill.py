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
import threading
import time

import numpy as np
from hosts import Hosts
from sweeps import KeptSweep, ranks_on, run_undisturbed, states

import h5py
from test_power_cut import Disk
from test_sweeps import STOPPED, TASKS_FAILED, job, rodsweep, status

TASKS, KILLER = 2000, 1999
RUN = ("--worker-timeout", "3")
KEEP = ("--pause", "0.5", "--silence", "20")
LIMITED = ("--time-limit", "12")  # of the first two times that the batch system gives


def drill_job():
    """Small tasks, each of its own, and one that is longer and the last in the file."""
    spread = [round(1 + 4 * n / TASKS, 6) for n in range(TASKS)]
    segments = [20 + n % 11 for n in range(KILLER)] + [300]
    rod = {"type": "bending_rod", "segments": {"zip": segments}, "length_m": {"zip": spread}, "radius_m": 0.05,
           "density_kg_m3": 1000, "youngs_modulus_pa": {"log_uniform": [1e4, 1e6]}, "torsion_modulus_pa": 1e6,
           "initial_angle_deg": {"uniform": [0, 45]}}
    return job("drill", samples=1, scene=rod, steps=60, guesses=["zero", "previous"],
               record={"solves": "summary", "norms": "one"})


class Killer(threading.Thread):
    """Ends whoever runs the task that is to blame."""

    def __init__(self, hosts, path, tell):
        super().__init__(daemon=True)
        self.hosts, self.path, self.tell, self.killed = hosts, path, tell, 0
        self.over = threading.Event()

    def run(self):
        before = 0
        while not self.over.wait(0.01):
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


class BatchSystem(threading.Thread):
    """Begins the job again where it stopped at its time limit, and where the power is back, until it is done."""

    def __init__(self, drill):
        super().__init__(daemon=True)
        self.drill, self.limits_met, self.code = drill, 0, None
        self.power = threading.Event()
        self.power.set()
        self.sweep = self.begin()
        self.start()

    def begin(self):
        limit = LIMITED if self.limits_met < 2 else ()
        drill = self.drill
        return KeptSweep(drill.hosts, drill.job, drill.path, run=(*RUN, *limit, "--resume"), keep=KEEP)

    def run(self):
        while True:
            code = self.sweep.end(seconds=1000)
            what = "the power was back"
            if code == STOPPED:
                self.limits_met += 1
                what = f"the time limit was met, the {self.limits_met}. time"
                self.drill.tell(what)
            elif self.power.is_set():
                self.code = code
                return
            self.power.wait()
            begin = time.monotonic()
            self.sweep = self.begin()
            self.drill.work_goes_on(what, begin)


class Drill:
    def __init__(self):
        self.begin = time.monotonic()
        self.table = []
        self.disk = Disk("disk", megabytes=64)  # before the hosts, which see what is mounted when they come up
        self.hosts = Hosts("hosts")
        self.path = os.path.join(self.disk.folder, "drill.h5")
        self.job = drill_job()

    def tell(self, text):
        print(f"{time.monotonic() - self.begin:6.1f} s  {self.done():5} tasks  {text}", flush=True)

    def done(self):
        found = states(self.path)
        return 0 if found is None else int(found.sum())

    def wait_until(self, ready, seconds=600):
        """Or until the sweep is over."""
        deadline = time.monotonic() + seconds
        while not ready() and self.batch.is_alive():
            assert time.monotonic() < deadline, self.batch.sweep.text()
            time.sleep(0.02)

    def note(self, text, what, since):
        seconds = time.monotonic() - since
        self.table.append((what, seconds))
        self.tell(f"{text}, {seconds:.1f} s after {what}")

    def work_goes_on(self, what, since, restarted=False):
        if restarted:  # workers without a master end what they have in hand
            sweep, at = self.batch.sweep, self.batch.sweep.now()
            self.wait_until(lambda: self.batch.sweep is not sweep or sweep.said("tasks of drill are left to do", at))
        before, sweep = self.done(), self.batch.sweep
        self.wait_until(lambda: self.done() > before or not sweep.runs())
        if self.done() > before:
            self.note("work goes on", what, since)

    def others_have_its_tasks(self, what, ranks):
        """They are missed by their master, or another start has begun."""
        since, sweep = time.monotonic(), self.batch.sweep
        at = sweep.now()
        self.wait_until(lambda: self.batch.sweep is not sweep
                        or all(sweep.said(rf"rank {rank} on .* was not heard", at) for rank in ranks)
                        or sweep.said("tasks of drill are left to do", at))
        self.note("others have its tasks", what, since)

    # ---- what happens

    def kill_a_worker(self):
        rank, pid = max(ranks_on(self.hosts[1]).items())
        self.tell(f"rank {rank} on {self.hosts[1].name} is killed")
        os.kill(pid, signal.SIGKILL)
        self.others_have_its_tasks("a worker was killed", [rank])

    def stop_a_worker(self):
        rank, pid = max(ranks_on(self.hosts[0]).items())
        self.tell(f"rank {rank} on {self.hosts[0].name} is stopped")
        os.kill(pid, signal.SIGSTOP)
        self.others_have_its_tasks("a worker was stopped", [rank])

    def cut_off_a_host(self):
        host = self.hosts[2]
        ranks = list(ranks_on(host))
        self.tell(f"{host.name} is cut off, with ranks {ranks}")
        host.cut_off()
        self.others_have_its_tasks("a host was cut off", ranks)

    def kill_the_master(self):
        self.tell("the master is killed")
        os.kill(ranks_on(self.hosts[0])[0], signal.SIGKILL)
        self.work_goes_on("the master was killed", time.monotonic(), restarted=True)

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
        begin = time.monotonic()
        time.sleep(5)
        self.work_goes_on("the disk was full", begin)  # the file has had its room from the start
        os.remove(full)
        self.tell("there is room again")

    def cut_the_power(self):
        self.tell("the power is cut, while the disk is being written to")
        writing = threading.Thread(target=subprocess.run, args=(["sync", "-f", self.disk.folder],),
                                   kwargs={"capture_output": True, "check": False})
        writing.start()
        self.batch.power.clear()
        self.disk.cut()
        self.batch.sweep.kill()
        for host in self.hosts:
            host.die()
        writing.join()
        self.disk.unmount()
        self.disk.mount()
        for host in self.hosts:
            host.up()
        self.tell("the power is back")
        self.batch.power.set()

    def run(self):
        if not os.path.exists("whole.h5"):
            run_undisturbed(self.job, "whole.h5")
        self.tell("the undisturbed run is done")
        self.batch = BatchSystem(self)
        killer = Killer(self.hosts, self.path, self.tell)
        killer.start()
        for tasks, happens in ((100, self.kill_a_worker), (300, self.stop_a_worker), (500, self.kill_the_master),
                               (800, self.cut_off_a_host), (1100, self.cut_the_power), (1300, self.fill_the_disk)):
            self.wait_until(lambda tasks=tasks: self.done() >= tasks)
            happens()
        self.batch.join(timeout=1000)
        killer.over.set()  # a thread that reads a file keeps the interpreter from ending
        killer.join()
        self.tell(f"it ended with {self.batch.code}")
        assert self.batch.code == TASKS_FAILED, self.batch.sweep.text()
        self.check(killer)

    def check(self, killer):
        after = status(self.path)
        print(json.dumps(after["outcomes"]), json.dumps(after["failures"]))
        assert after["outcomes"] == {"ok": TASKS - 1, "crashed": 1}, after["outcomes"]
        assert [f["task"] for f in after["failures"]] == [KILLER], after["failures"]
        assert killer.killed == 3, killer.killed
        assert self.batch.limits_met >= 2, self.batch.limits_met
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
    Drill().run()
