#!/usr/bin/python3
"""The program under mpirun, from outside: the same results on any number of ranks and after any interruption, refusals, exit codes.

Run by CTest in an empty folder, with RODSWEEP, MPIRUN and FAILING_DISK in the environment.
"""

import hashlib
import json
import os
import signal
import subprocess
import time
import unittest

import h5py
import numpy as np

RODSWEEP = os.environ["RODSWEEP"]
MPIRUN = os.environ.get("MPIRUN", "mpirun")
ALL_DONE, USER_ERROR, TASKS_FAILED, STOPPED, TOO_LONG, LOST = 0, 2, 3, 4, 5, 6


def job(name="small", samples=3, segments=(6, 9), steps=6, **changes):
    """Writes NAME.json, a sweep of samples x segments tasks, and returns its path. A change to None takes a key away."""
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
    """The same as a data set."""
    return job(name, **{"kind": "dataset", "evaluation": None, "solve": None, "guesses": None,
                        "record": {"solves": "all", "systems": "all"}, **changes})


def long_job(name="long", samples=20):
    """Half a second of work in many tasks: long enough to be hit in the middle."""
    return job(name, samples=samples, segments=(15, 30), steps=40,
               record={"solves": "all", "trajectory_every": 2, "norms": "one"})


def command(ranks, *words):
    return ([MPIRUN, "-n", str(ranks)] if ranks else []) + [RODSWEEP, *words]


def rodsweep(ranks, *words):
    """Runs to the end: the completed process with its texts. ranks 0: without mpirun."""
    return subprocess.run(command(ranks, *words), stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)


def start(ranks, *words):
    # As in any interactive or batch shell, the program gets signals at their defaults.
    return subprocess.Popen(command(ranks, *words), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def status(path):
    return json.loads(rodsweep(0, "status", path, "--json").stdout)


def wait_for_tasks(process, path, count):
    """Until `count` tasks are in the file; the sweep must still be running then. Reads the file, which is done sooner than
    starting a program that does: a short sweep is hit in its middle too."""
    deadline = time.monotonic() + 60
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
    """Process numbers of mpirun's ranks, by rank."""
    ranks = {}
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{entry}/stat") as file:
                parent = int(file.read().rsplit(")", 1)[1].split()[1])
            if parent != mpirun.pid:
                continue
            with open(f"/proc/{entry}/environ") as file:
                for variable in file.read().split("\0"):
                    if variable.startswith("OMPI_COMM_WORLD_RANK="):
                        ranks[int(variable.split("=")[1])] = int(entry)
        except (FileNotFoundError, ProcessLookupError, PermissionError):
            continue
    return ranks


def kill_all(mpirun):
    for pid in [mpirun.pid, *ranks_of(mpirun).values()]:
        os.kill(pid, signal.SIGKILL)


def checksum(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


class SweepCase(unittest.TestCase):
    def assert_exit(self, process, code):
        self.assertEqual(process.returncode, code, f"{process.stdout}\n{process.stderr}")

    def assert_same_results(self, one, other):
        diff = subprocess.run(["h5diff", "--exclude-path", "/timing", "--exclude-path", "/runs", one, other],
                              capture_output=True, text=True)
        self.assertEqual((diff.returncode, diff.stdout), (0, ""))

    def assert_whole(self, path):
        info = json.loads(rodsweep(0, "info", path, "--verify", "--json").stdout)
        self.assertEqual(info["pending"], 0)
        self.assertEqual(info["verified"], {"checked": info["tasks"], "damaged": []})


class RankCounts(SweepCase):
    def test_results_are_the_same_on_1_2_and_5_ranks(self):
        path = job()
        self.assert_exit(rodsweep(0, "run", path, "-o", "alone.h5"), ALL_DONE)
        self.assert_whole("alone.h5")
        for ranks in (1, 2, 5):
            with self.subTest(ranks=ranks):
                self.assert_exit(rodsweep(ranks, "run", path, "-o", f"{ranks}.h5"), ALL_DONE)
                self.assert_same_results("alone.h5", f"{ranks}.h5")

    def test_results_are_the_same_in_a_closed_loop(self):
        path = job("closed", evaluation="closed_loop")
        for ranks in (1, 3):
            self.assert_exit(rodsweep(ranks, "run", path, "-o", f"closed{ranks}.h5"), ALL_DONE)
        self.assert_same_results("closed1.h5", "closed3.h5")

    def test_a_data_set_is_the_same_on_1_2_and_3_ranks(self):
        path = data_job()
        for ranks in (1, 2, 3):
            self.assert_exit(rodsweep(ranks, "run", path, "-o", f"data{ranks}.h5"), ALL_DONE)
            self.assert_whole(f"data{ranks}.h5")
            self.assert_same_results("data1.h5", f"data{ranks}.h5")


class InterruptedCase(SweepCase):
    def setUp(self):
        self.sweep(long_job())

    def sweep(self, path):
        """The job to interrupt, and what it gives when nothing interrupts it."""
        self.job, self.whole = path, path.replace(".json", "-whole.h5")
        if not os.path.exists(self.whole):
            self.assert_exit(rodsweep(3, "run", path, "-o", self.whole), ALL_DONE)

    def interrupt(self, path, ranks, hit):
        """Starts the sweep, calls hit(process) in the middle of it, and returns exit code and texts."""
        process = start(ranks, "run", self.job, "-o", path)
        wait_for_tasks(process, path, 4)
        hit(process)
        stdout, stderr = process.communicate(timeout=30)
        return process.returncode, stdout, stderr

    def resume(self, path, ranks):
        before = status(path)
        self.assertGreater(before["done"], 0)
        self.assertGreater(before["pending"], 0)
        self.assert_exit(rodsweep(ranks, "run", self.job, "-o", path, "--resume"), ALL_DONE)
        self.assert_same_results(self.whole, path)
        self.assert_whole(path)
        starts = status(path)["starts"]
        self.assertEqual([s["tasks"] for s in starts], [before["done"], before["pending"]])
        return starts


class Interrupted(InterruptedCase):
    def test_after_a_worker_is_killed(self):
        code, _, stderr = self.interrupt("worker.h5", 3, lambda p: os.kill(ranks_of(p)[2], signal.SIGKILL))
        self.assertEqual(code, 128 + signal.SIGKILL)
        self.assertRegex(stderr, r"mpirun \(SIGTERM\).*--resume")
        self.assertIsNone(self.resume("worker.h5", 2)[0]["end"])

    def test_after_all_ranks_are_killed(self):
        self.interrupt("all.h5", 3, kill_all)
        self.assertIsNone(self.resume("all.h5", 3)[0]["end"])

    def test_a_data_set_after_all_ranks_are_killed(self):
        # Newton iterations that only take time: the file stays small.
        self.sweep(data_job("long_data", samples=160, segments=(20,), record={"solves": "summary"},
                            time={"step_s": 0.02, "steps": 60, "newton_iterations": 60, "newton_tolerance": 0}))

        self.interrupt("killed_data.h5", 3, kill_all)
        self.resume("killed_data.h5", 2)

    def test_after_a_worker_finds_the_disk_full(self):
        preload = {"LD_PRELOAD": os.environ["FAILING_DISK"], "FAIL_RANK": "2", "FAIL_FILE": os.path.abspath("full")}
        os.environ.update(preload)
        try:
            code, _, stderr = self.interrupt("full.h5", 3, lambda p: open("full", "w").close())
        finally:
            for name in preload:
                del os.environ[name]
        self.assertEqual(code, STOPPED, stderr)
        self.assertEqual(stderr.count("cannot go on: H5Dwrite failed"), 1, stderr)
        self.assertIn("error: rank 2 on", stderr)
        self.assertIn("what was finished is kept in the file; once the cause is gone, this continues: ", stderr)
        self.assertIn("-o full.h5 --resume", stderr)
        self.resume("full.h5", 3)


class Signalled(InterruptedCase):
    def assert_stopped(self, code, stdout, stderr, path):
        self.assertEqual(code, STOPPED, stderr)
        self.assertIn("left to do", stdout)
        self.assertIn("nothing is lost. To continue:", stderr)
        self.assertEqual(self.resume(path, 3)[0]["exit_code"], STOPPED)

    def test_after_a_signal_to_one_rank(self):
        for rank, number in ((0, signal.SIGTERM), (1, signal.SIGUSR1)):
            with self.subTest(rank=rank):
                path = f"rank{rank}.h5"
                result = self.interrupt(path, 3, lambda p: os.kill(ranks_of(p)[rank], number))
                self.assert_stopped(*result, path)

    def test_after_a_signal_that_mpirun_forwards(self):
        result = self.interrupt("forwarded.h5", 3, lambda p: p.send_signal(signal.SIGUSR1))
        self.assert_stopped(*result, "forwarded.h5")

    def test_after_sigterm_to_mpirun_which_kills_soon_after(self):
        self.sweep(long_job("longer", 100))  # mpirun takes a second to pass it on
        for name, number in (("term.h5", signal.SIGTERM), ("typed.h5", signal.SIGINT)):  # the second as Ctrl-C sends it
            _, _, stderr = self.interrupt(name, 3, lambda p: p.send_signal(number))
            self.assertRegex(stderr, r"mpirun \(SIGTERM\).*--resume")
            self.resume(name, 3)  # mpirun may kill the ranks before they note how the run ended

    def test_without_mpirun_ctrl_c_is_called_that(self):
        result = self.interrupt("typed-alone.h5", 0, lambda p: p.send_signal(signal.SIGINT))
        self.assert_stopped(*result, "typed-alone.h5")
        self.assertIn("stopped early by Ctrl-C (SIGINT); nothing is lost", result[2])

    def test_without_mpirun_and_with_a_second_signal_during_the_stop(self):
        def twice(process):
            process.send_signal(signal.SIGINT)
            process.send_signal(signal.SIGTERM)

        result = self.interrupt("alone.h5", 0, twice)
        self.assert_stopped(*result, "alone.h5")


class Killers(SweepCase):
    """A task that ends its worker whenever it runs, as one that takes all memory does."""

    def test_a_killer_is_tried_last_then_alone_and_then_named(self):
        # Many short tasks, and one that is longer and comes first.
        killer = 100
        path = job("killer", samples=1, segments=[20 + n // 50 for n in range(killer)] + [200], steps=40,
                   record={"solves": "summary", "norms": "one"})
        self.assert_exit(rodsweep(3, "run", path, "-o", "undisturbed.h5"), ALL_DONE)

        done, accused = [], []
        for attempt in range(3):
            process = start(3, "run", path, "-o", "killer.h5", "--resume")
            self.kill_who_runs(process, "killer.h5", killer)
            process.communicate(timeout=30)
            with h5py.File("killer.h5") as file:
                starts = file["/timing/tasks/tries"][:]
                self.assertEqual(starts[killer], attempt + 1)
                accused.append(np.flatnonzero(starts))
                done.append(int(file["/tasks/state"][:].sum()))
        self.assertLess(done[0], killer // 2)     # tried first when nothing was known of it,
        self.assertGreater(done[1], killer // 2)  # then last, perhaps beside the last of the others,
        self.assertEqual(list(accused[2]), [killer])  # then alone: no other task has lost a worker and is not done

        last = rodsweep(3, "run", path, "-o", "killer.h5", "--resume")
        self.assert_exit(last, TASKS_FAILED)
        after = status("killer.h5")
        self.assertEqual(after["outcomes"], {"ok": killer, "crashed": 1})
        self.assertEqual([(f["task"], f["outcome"]) for f in after["failures"]], [(killer, "crashed")])
        self.assertIn("each of its 3 tries", after["failures"][0]["message"])
        self.assertIn("--retry-failed", last.stdout)
        self.assert_whole("killer.h5")

        # Left alone it is a task like any other.
        self.assert_exit(rodsweep(3, "run", path, "-o", "killer.h5", "--resume", "--retry-failed"), ALL_DONE)
        self.assert_same_results("undisturbed.h5", "killer.h5")

    def kill_who_runs(self, process, path, task):
        """Waits until a worker has begun the task, once more than before, and kills it."""
        deadline = time.monotonic() + 30
        before = None
        while time.monotonic() < deadline and process.poll() is None:
            try:
                with h5py.File(path, "r", locking=False) as file:
                    starts, rank = int(file["/timing/tasks/tries"][task]), int(file["/timing/tasks/rank"][task])
            except OSError:
                starts, rank = 0, 0
            if before is None:
                before = starts
            elif starts > before:
                os.kill(ranks_of(process)[rank], signal.SIGKILL)
                return
            time.sleep(0.01)
        self.fail(f"task {task} was not begun")


class Watching(SweepCase):
    def test_status_tells_a_running_sweep_from_a_dead_one_and_what_runs_where(self):
        path = job("watched", samples=200, segments=(40,), steps=200, record={"solves": "summary"})
        process = start(3, "run", path, "-o", "watched.h5")
        wait_for_tasks(process, "watched.h5", 2)
        now = status("watched.h5")
        self.assertEqual((now["being_written"], now["alive"]), (True, True))
        self.assertLess(now["silent_s"], 30)
        self.assertIn(len(now["running"]), (1, 2))
        self.assertEqual({r["host"] for r in now["running"]}, {os.uname().nodename})
        self.assertLessEqual({r["rank"] for r in now["running"]}, {1, 2})
        self.assertRegex(rodsweep(0, "status", "watched.h5").stdout, r"tasks/s, .* left\n  task \d+ runs on .*, rank [12]\n"
                         r"(.*\n)?start 0: .*; runs still, last sign of life \S+ m?s ago\n$")

        now = status("watched.h5")
        self.assertAlmostEqual(now["left_s"], now["pending"] / now["tasks_per_s"])

        watch = start(0, "status", "watched.h5", "--watch", "0.2")
        self.assertIn("left", watch.stdout.readline())
        kill_all(process)
        process.communicate(timeout=30)
        rest, _ = watch.communicate(timeout=30)  # ends by itself
        self.assertIn("was killed", rest)
        dead = status("watched.h5")
        self.assertEqual((dead["being_written"], dead["alive"], dead["running"]), (False, False, []))
        self.assertEqual((dead["silent_s"], dead["tasks_per_s"], dead["left_s"]), (None, None, None))

    def test_a_run_that_hangs_is_told_by_its_silence(self):
        path = job("hung", samples=200, segments=(40,), steps=200, record={"solves": "summary"})
        process = start(3, "run", path, "-o", "hung.h5")
        wait_for_tasks(process, "hung.h5", 2)
        ranks = ranks_of(process)
        for pid in ranks.values():
            os.kill(pid, signal.SIGSTOP)
        before = time.time() - 200
        os.utime("hung.h5", (before, before))  # as if it had been so for long
        said = rodsweep(0, "status", "hung.h5").stdout
        for pid in [process.pid, *ranks.values()]:
            os.kill(pid, signal.SIGKILL)
        process.communicate(timeout=30)
        self.assertRegex(said, r"runs still, but shows no sign of life for 3 min \d\d s: it may hang, or a disk does\n")


class Refusals(SweepCase):
    def assert_refused_once(self, process, text):
        self.assert_exit(process, USER_ERROR)
        self.assertEqual(process.stderr.count(text), 1, process.stderr)
        self.assertEqual(process.stderr.count("rodsweep: error:"), 1, process.stderr)
        self.assertNotIn("Primary job", process.stderr)  # nor does mpirun say it again, in twelve lines
        self.assertEqual(process.stdout, "")

    def test_an_existing_file_stays_as_it_is(self):
        path = job()
        self.assert_exit(rodsweep(2, "run", path, "-o", "mine.h5"), ALL_DONE)
        before = checksum("mine.h5")
        self.assert_refused_once(rodsweep(3, "run", path, "-o", "mine.h5"), "mine.h5 exists already")
        self.assertEqual(checksum("mine.h5"), before)

    def test_a_file_of_another_job_is_not_continued(self):
        self.assert_exit(rodsweep(2, "run", job("first"), "-o", "first.h5"), ALL_DONE)
        before = checksum("first.h5")
        self.assert_refused_once(rodsweep(3, "run", job("second", steps=7), "-o", "first.h5", "--resume"),
                                 "first.h5 holds the results of another job")
        self.assertEqual(checksum("first.h5"), before)

    def test_where_there_are_no_locks_a_file_that_is_being_written_is_known_by_its_time(self):
        os.environ.update({"LD_PRELOAD": os.environ["FAILING_DISK"], "FAIL_LOCKS": "1"})
        self.addCleanup(lambda: [os.environ.pop(name) for name in ("LD_PRELOAD", "FAIL_LOCKS")])
        path = long_job("longer", 200)  # the second run is to find the first one at work
        first = start(3, "run", path, "-o", "unlocked.h5")
        wait_for_tasks(first, "unlocked.h5", 1)
        self.assert_refused_once(rodsweep(2, "run", path, "-o", "unlocked.h5", "--resume"), "unlocked.h5 seems to be written by "
                                 "another run, which showed a sign of life")
        _, stderr = first.communicate(timeout=60)
        self.assertEqual((first.returncode, stderr.count("is on a file system without locks")), (ALL_DONE, 1), stderr)
        with h5py.File("unlocked.h5", "r+") as file:
            file["runs/end"][0] = b""  # killed, then
        before = time.time() - 31
        os.utime("unlocked.h5", (before, before))
        self.assert_exit(rodsweep(2, "run", path, "-o", "unlocked.h5", "--resume"), ALL_DONE)

    def test_a_foreign_file_is_not_continued(self):
        with open("notes.h5", "w") as file:
            file.write("not HDF5 at all")
        before = checksum("notes.h5")
        self.assert_refused_once(rodsweep(3, "run", job(), "-o", "notes.h5", "--resume"), "notes.h5")
        self.assertEqual(checksum("notes.h5"), before)

    def test_a_bad_job_is_refused_once_and_nothing_is_created(self):
        path = job("bad", time={"step_s": 0.02, "steps": -4})
        self.assert_refused_once(rodsweep(3, "run", path, "-o", "bad.h5"), "time.steps")
        self.assertFalse(os.path.exists("bad.h5"))

    def test_a_missing_job_is_refused_once(self):
        self.assert_refused_once(rodsweep(3, "run", "nowhere.json"), "nowhere.json")
        self.assertFalse(os.path.exists("results"))

    def test_a_place_where_no_file_can_be_is_refused_once(self):
        path = job()
        self.assert_refused_once(rodsweep(3, "run", path, "-o", path + "/out.h5"), path + "/out.h5 cannot be created")


class Outcomes(SweepCase):
    def test_failed_tasks_are_data_and_make_exit_code_3_also_when_resumed(self):
        path = job("hard", evaluation="closed_loop",
                   solve={"method": "cg", "preconditioner": "none", "tolerance": 1e-8, "max_iterations": 2})
        first = rodsweep(3, "run", path)
        self.assert_exit(first, TASKS_FAILED)
        self.assertIn("iteration_limit", first.stdout)
        self.assertIn("and 19 more", first.stdout)
        self.assert_exit(rodsweep(3, "run", path, "--resume"), TASKS_FAILED)
        now = status("results/hard.h5")
        self.assertEqual((now["failed"], now["pending"]), (24, 0))
        self.assertEqual([s["exit_code"] for s in now["starts"]], [TASKS_FAILED, TASKS_FAILED])

    def test_a_limit_belongs_to_a_start_and_not_to_the_results(self):
        path = job("limited", samples=1, segments=[6, 3000], solve={"reference": "cg"}, guesses=["zero"],
                   time={"step_s": 0.02, "steps": 1, "newton_iterations": 1})
        short = rodsweep(2, "run", path, "--task-time-limit", "0.1")
        self.assert_exit(short, TASKS_FAILED)
        self.assertIn("time limit of 0.1 s has passed", short.stdout)
        self.assertEqual(status("results/limited.h5")["outcomes"], {"ok": 1, "timed_out": 1})
        self.assert_exit(rodsweep(2, "run", path, "--resume", "--retry-failed"), ALL_DONE)
        self.assert_exit(rodsweep(2, "run", path, "-o", "unlimited.h5"), ALL_DONE)
        self.assert_same_results("unlimited.h5", "results/limited.h5")

    def test_a_task_that_no_start_has_time_for_is_named_and_ends_the_sweep_once_the_others_are_done(self):
        path = job("lengthy", samples=1, segments=[6, 8, 2000], guesses=["zero"], record={"solves": "summary"},
                   time={"step_s": 0.001, "steps": 1000})
        limit = ("--time-limit", "5")    # ten times what the short ones take
        self.assert_exit(rodsweep(2, "run", path, *limit), STOPPED)  # it comes first, and nothing is known of it
        second = rodsweep(2, "run", path, *limit, "--resume")
        self.assert_exit(second, TOO_LONG)
        self.assertEqual(status("results/lengthy.h5")["outcomes"], {"ok": 2})
        self.assertIn("no task that is left would end within a time limit of 5.0 s: task 2, the longest, would take about",
                      second.stderr)
        self.assertRegex(rodsweep(0, "status", "results/lengthy.h5").stdout, "what is left needs a longer time limit")
        bounded = rodsweep(2, "run", path, *limit, "--resume", "--task-time-limit", "1")
        self.assert_exit(bounded, TASKS_FAILED)
        self.assertEqual(status("results/lengthy.h5")["outcomes"], {"ok": 2, "timed_out": 1})

    def test_a_task_beyond_its_share_of_memory_is_an_error_and_no_death(self):
        path = job("large", samples=1, segments=[6, 300000], guesses=["zero"], record={"solves": "summary"},
                   time={"step_s": 0.02, "steps": 1, "newton_iterations": 1})
        bounded = rodsweep(2, "run", path, "--memory-limit-gb", "0.4")
        self.assert_exit(bounded, TASKS_FAILED)
        self.assertEqual(status("results/large.h5")["outcomes"], {"ok": 1, "error": 1})
        self.assertIn("more than the 400 MB that this process may have", bounded.stdout)

    def test_a_bound_on_memory_below_what_the_program_needs_is_refused(self):
        refused = rodsweep(0, "run", job("tiny"), "--memory-limit-gb", "0.005")
        self.assert_exit(refused, USER_ERROR)
        self.assertIn("--memory-limit-gb", refused.stderr)

    def test_tasks_whose_results_do_not_fit_into_memory_are_left_out_and_named(self):
        path = job("record", samples=1, segments=[6, 4000], guesses=["zero"],
                   time={"step_s": 0.02, "steps": 2000, "newton_iterations": 1},
                   record={"solves": "summary", "trajectory_every": 1})  # of 460 MB, of which none is written
        bounded = rodsweep(2, "run", path, "--memory-limit-gb", "0.3")
        self.assert_exit(bounded, TOO_LONG)
        self.assertRegex(bounded.stderr, r"task 1 keeps 4\d\d MB of results in memory until it ends, and a rank has "
                                         r"2\d\d MB left: it is left out\. fewer ranks on a host leave each more")
        self.assertIn("To continue with more: ", bounded.stderr)
        now = status("results/record.h5")
        self.assertEqual((now["outcomes"], now["pending"]), ({"ok": 1}, 1))
        plan = json.loads(rodsweep(0, "plan", path, "--json").stdout)
        self.assertGreater(plan["probes"][-1]["memory_bytes"], 448e6)
        self.assertRegex(rodsweep(0, "plan", path).stdout, r"memory   [45]\d\d MB at most of the tasks tried, a process each; "
                                                           r"this host has room for \d+\n")

    def test_resume_starts_a_sweep_that_has_no_file_and_does_nothing_to_a_finished_one(self):
        path = job("fresh")
        self.assert_exit(rodsweep(2, "run", path, "--resume"), ALL_DONE)
        self.assert_exit(rodsweep(3, "run", path, "--resume"), ALL_DONE)
        self.assertEqual([s["tasks"] for s in status("results/fresh.h5")["starts"]], [6, 0])

    def test_more_workers_than_cores_are_warned_of_and_marked(self):
        ranks = len(os.sched_getaffinity(0)) + 2
        crowded = rodsweep(ranks, "run", job("crowded"))
        self.assert_exit(crowded, ALL_DONE)
        self.assertEqual(crowded.stderr.count("warning"), 1, crowded.stderr)
        self.assertTrue(status("results/crowded.h5")["starts"][0]["oversubscribed"])
        self.assert_exit(rodsweep(2, "run", job("roomy")), ALL_DONE)
        self.assertFalse(status("results/roomy.h5")["starts"][0]["oversubscribed"])


class Speaking(SweepCase):
    def test_commands_that_need_no_ranks_speak_once_under_mpirun(self):
        path = job()
        for words, text in ((("validate", path), "sound, 6 tasks"), (("--version",), "Open MPI"),
                            (("plan", path), "core-hours"), (("plan", path, "--no-probe"), "tasks    6"),
                            (("run", "--help"), "Exit codes:")):
            with self.subTest(words=words):
                said = rodsweep(3, *words)
                self.assert_exit(said, 0)
                self.assertEqual(said.stdout.count(text), 1, said.stdout)

    def test_commands_on_files_work_and_speak_once_under_mpirun(self):
        self.assert_exit(rodsweep(2, "run", job("files")), ALL_DONE)
        path = "results/files.h5"
        for words, text in ((("query", path), "cg_ratio.previous"), (("schema",), '"rodsweep job"'),
                            (("pack", path), "6 finished tasks verified"), (("rerun", path, "3"), "identical to task 3")):
            with self.subTest(words=words):
                said = rodsweep(3, *words)
                self.assert_exit(said, ALL_DONE)
                self.assertEqual(said.stdout.count(text), 1, said.stdout)
        made = sorted(name for name in os.listdir("results") if name.startswith("files"))
        self.assertEqual(made, ["files-packed.h5", "files-task-3.h5", "files.h5"])

    def test_results_go_to_stdout_and_progress_to_stderr_without_colours(self):
        ran = rodsweep(2, "run", job("said"))
        self.assert_exit(ran, ALL_DONE)
        self.assertIn("6 tasks: 6 ok", ran.stdout)
        self.assertIn("next: ", ran.stdout)
        self.assertNotIn("\x1b", ran.stdout + ran.stderr)
        self.assertNotIn("\r", ran.stderr)


class Alone(SweepCase):
    def test_the_job_comes_back_byte_for_byte(self):
        path = job("kept")
        self.assert_exit(rodsweep(0, "run", path), ALL_DONE)
        with open(path) as file:
            self.assertEqual(rodsweep(0, "info", "results/kept.h5", "--job").stdout, file.read())

    def test_a_plan_tells_programs_what_it_tells_people(self):
        plan = json.loads(rodsweep(0, "plan", job("planned"), "--json").stdout)
        self.assertEqual((plan["tasks"], plan["steps"]), (6, 36))
        self.assertGreater(plan["core_hours"], 0)
        self.assert_exit(rodsweep(0, "run", "planned.json"), ALL_DONE)
        size = os.path.getsize("results/planned.h5")
        self.assertLess(abs(plan["file_bytes"] - size), 0.2 * size)

    def test_a_plan_of_summaries_tells_their_smaller_size(self):
        sizes = []
        for solves in ("all", "summary"):
            path = job(solves, steps=40, record={"solves": solves})
            sizes.append(json.loads(rodsweep(0, "plan", path, "--json", "--no-probe").stdout)["file_bytes"])
            self.assert_exit(rodsweep(0, "run", path), ALL_DONE)
            size = os.path.getsize(f"results/{solves}.h5")
            self.assertLess(abs(sizes[-1] - size), 0.2 * size)
        self.assertLess(sizes[1], 0.6 * sizes[0])


if __name__ == "__main__":
    unittest.main()
