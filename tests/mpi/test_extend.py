#!/usr/bin/python3
"""run --extend writes the same file as a run of the larger job from scratch, without repeating the smaller one's tasks.

Run by CTest in an empty folder, with RODSWEEP and MPIRUN in the environment.
"""

import os
import re
import shutil
import signal
import tempfile
import unittest

import h5py
import numpy as np
from program import SweepCase, TASKS_FAILED, USER_ERROR, checksum, data_job, job, kill_all, rodsweep, start, status, \
    wait_for_tasks

ROD = {"type": "bending_rod", "length_m": {"uniform": [1, 5]}, "radius_m": 0.05, "density_kg_m3": 1000,
       "youngs_modulus_pa": {"log_uniform": [1e4, 1e6]}, "torsion_modulus_pa": 1e6}
OLD_GUESSES = ["zero", "previous", {"oracle": {"error": 0.1}}]


class ExtendCase(SweepCase):
    def setUp(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(tempfile.mkdtemp(dir="."))

    def old(self, name="old", **changes):
        """Runs a sweep of 4 tasks; returns its file."""
        path = self.new(name, **changes)
        self.rodsweep(0, "run", path, "-o", f"{name}.h5")
        return f"{name}.h5"

    def new(self, name="new", **changes):
        return job(name, **{"samples": 2, "segments": (6, 9), "steps": 5, "guesses": OLD_GUESSES, **changes})

    def extend(self, path, old, shared, ranks=(3,)):
        """Extends `old` to the job with these counts of tasks, compares with a fresh run; returns the last file."""
        name = path.replace(".json", "")
        self.rodsweep(0, "run", path, "-o", f"{name}-fresh.h5")
        before = checksum(old)
        for count in ranks:
            file = f"{name}-{count}.h5"
            ran = self.rodsweep(count, "run", path, "-o", file, "--extend", old)
            self.assert_shared(ran, old, shared)
            self.assertNotIn("warning", ran.stderr)
            self.assert_same_results(f"{name}-fresh.h5", file)
            self.assert_whole(file)
        self.assertEqual(checksum(old), before)
        return file

    def assert_shared(self, ran, old, shared):
        """The message has the numbers of all tasks, of copies, and of tasks to run."""
        said = re.search(rf"\b(\d+) tasks: (\d+) .*{re.escape(old)}, (\d+) ", ran.stderr)
        self.assertIsNotNone(said, ran.stderr)
        self.assertEqual(tuple(map(int, said.groups())), shared)


class Extending(ExtendCase):
    def test_more_grid_values_inserted_and_a_plain_value_that_becomes_a_grid(self):
        path = self.new("values", segments=(12, 6, 7, 9), record={"trajectory_every": 2, "solves": "all"},
                        time={"step_s": {"grid": [0.01, 0.02]}, "steps": {"grid": [5, 11]}})
        self.extend(path, self.old(), (32, 4, 28), ranks=(0, 3))

    def test_all_at_once_without_rows_of_solves_and_again_from_the_extended_file(self):
        record = {"solves": "summary", "trajectory_every": 1}
        old = self.old("short", record=record)
        more = self.new("more", record=record, samples=3, segments=(9, 6, 12))
        file = self.extend(more, old, (9, 4, 5))
        most = self.new("most", record=record, samples=4, segments=(9, 6, 12))
        last = self.extend(most, file, (12, 9, 3))
        starts = status(last)["runs"]
        self.assertEqual([s["source"] for s in starts], [old, file, ""])
        self.assertEqual([s["tasks"] for s in starts], [4, 5, 3])
        with h5py.File(last) as h5:
            self.assertEqual(h5["timing/tasks/source_task"][:].tolist(), [0, 1, 2, -1, 3, 4, 5, -1, 6, 7, 8, -1])
            self.assertEqual(h5["timing/tasks/run"][:].tolist(), [0, 0, 1, 2] * 2 + [1, 1, 1, 2])

    def test_a_data_set_with_more_samples(self):
        small = {"segments": (6, 9), "steps": 5}
        path = data_job("few", samples=2, **small)
        self.rodsweep(0, "run", path, "-o", "few.h5")
        self.extend(data_job("many", samples=4, **small), "few.h5", (8, 4, 4))

    def test_an_unfinished_file_and_failures(self):
        solve = {"method": "cg", "preconditioner": "none", "tolerance": 1e-8, "max_iterations": 2}
        path = self.new("hard", evaluation="closed_loop", solve=solve)
        self.rodsweep(0, "run", path, "-o", "hard.h5", code=TASKS_FAILED)
        with h5py.File("hard.h5", "r+") as h5:
            h5["tasks/state"][:2] = 0
            h5["tasks/outcome"][2] = b"timed_out"
        ran = self.rodsweep(3, "run", path, "-o", "harder.h5", "--extend", "hard.h5", code=TASKS_FAILED)
        self.assert_shared(ran, "hard.h5", (12, 9, 3))
        self.rodsweep(0, "run", path, "-o", "fresh.h5", code=TASKS_FAILED)
        self.assert_same_results("fresh.h5", "harder.h5")

    def test_provenance_is_kept(self):
        path = self.new("kept", samples=3)
        self.extend(path, self.old(), (6, 4, 2), ranks=(0,))
        first, second = status("kept-0.h5")["runs"]
        original, = status("old.h5")["runs"]
        self.assertEqual({**first, "source": ""}, original)
        self.assertEqual((first["source"], first["tasks"], second["source"], second["tasks"]), ("old.h5", 4, "", 2))
        self.assertIn("run 0 (copied from old.h5): ", rodsweep(0, "info", "kept-0.h5").stdout)
        with h5py.File("old.h5") as old, h5py.File("kept-0.h5") as new:
            for name in ("rank", "host", "elapsed_s", "write_s"):
                np.testing.assert_array_equal(old[f"timing/tasks/{name}"][:], new[f"timing/tasks/{name}"][:][[0, 1, 3, 4]])


class Damage(ExtendCase):
    def test_a_damaged_task_is_run_again_with_a_warning(self):
        old = self.old()
        with h5py.File(old, "r+") as h5:
            h5["solves/iterations"][int(h5["tasks/first_solve"][1]), 0, 0] += 1
            h5["steps/joint_gap"][int(h5["tasks/first_step"][2])] *= 1.5
        path = self.new("copied", samples=3)
        self.rodsweep(0, "run", path, "-o", "fresh.h5")
        for ranks in (0, 3):
            file = f"copied-{ranks}.h5"
            ran = self.rodsweep(ranks, "run", path, "-o", file, "--extend", old)
            self.assertEqual(ran.stderr.count("warning"), 2, ran.stderr)
            for task in (1, 2):
                self.assertIn(f"task {task} of old.h5 is damaged", ran.stderr)
            self.assert_same_results("fresh.h5", file)
            with h5py.File(file) as h5:
                self.assertEqual(sorted(t for t in h5["timing/tasks/source_task"][:] if t >= 0), [0, 3])

    def test_killed_and_resumed(self):
        changes = {"steps": 40, "samples": 12, "segments": (15, 30)}
        old = self.old("base", **changes)
        path = self.new("killed", **{**changes, "samples": 30})
        self.rodsweep(3, "run", path, "-o", "unkilled.h5")
        process = start(3, "run", path, "-o", "killed.h5", "--extend", old)
        wait_for_tasks(process, "killed.h5", 4)
        kill_all(process)
        process.communicate(timeout=600)
        self.assertGreater(status("killed.h5")["pending"], 0)
        self.rodsweep(3, "run", path, "-o", "killed.h5", "--extend", old, "--resume")
        self.assert_same_results("unkilled.h5", "killed.h5")
        self.assert_whole("killed.h5")
        self.assertEqual([s["source"] for s in status("killed.h5")["runs"]], [old, "", ""])

    def test_stopped_it_says_how_to_go_on(self):
        changes = {"steps": 40, "samples": 2, "segments": (15, 30)}
        old = self.old("base2", **changes)
        path = self.new("stopped", **{**changes, "samples": 40})
        process = start(0, "run", path, "-o", "stopped.h5", "--extend", old)
        wait_for_tasks(process, "stopped.h5", 4)
        process.send_signal(signal.SIGTERM)
        _, stderr = process.communicate(timeout=600)
        self.assertIn(f"run {path} -o stopped.h5 --extend {old} --resume", stderr)


class Elsewhere(ExtendCase):
    """The job names a model next to it; the results are in another folder."""

    def setUp(self):
        super().setUp()
        os.makedirs("jobs/models")
        os.makedirs("far/away")
        shutil.copy(os.path.join(os.environ["SOURCE_DIR"], "network", "pretrained", "rods.h5"), "jobs/models/net.h5")
        guesses = ["zero", {"copingnet": {"model": "models/net.h5"}}]
        for name, samples in (("old", 1), ("new", 2)):
            shutil.move(self.new(name, samples=samples, guesses=guesses), "jobs")
        self.rodsweep(0, "run", "jobs/old.json", "-o", "far/away/old.h5")

    def assert_same_again(self, path):
        self.rodsweep(0, "rerun", path, "1")
        self.rodsweep(0, "compare", path, path.replace(".h5", "-task-1.h5"))

    def assert_extended(self, path, ranks):
        ran = self.rodsweep(ranks, "run", path, "-o", f"new-{ranks}.h5", "--extend", "far/away/old.h5")
        self.assert_shared(ran, "far/away/old.h5", (4, 2, 2))
        self.rodsweep(0, "run", path, "-o", f"fresh-{ranks}.h5")
        self.assert_same_results(f"fresh-{ranks}.h5", f"new-{ranks}.h5")

    def test_its_paths_begin_where_its_job_was_or_where_the_new_one_is(self):
        self.assert_extended("jobs/new.json", 3)
        shutil.move("jobs", "moved")
        self.assert_extended("moved/new.json", 0)

    def test_a_path_to_the_same_bytes_is_the_same_model(self):
        with open("jobs/new.json", encoding="utf-8") as file:
            moved = file.read().replace("models/net.h5", "jobs/models/net.h5")
        with open("adapted.json", "w", encoding="utf-8") as file:
            file.write(moved)
        self.assert_extended("adapted.json", 0)
        shutil.copy("jobs/models/net.h5", "jobs/models/other.h5")
        with h5py.File("jobs/models/other.h5", "r+") as h5:
            h5.attrs["remark"] = "not the same bytes"
        with open("adapted.json", "w", encoding="utf-8") as file:
            file.write(moved.replace("models/net.h5", "models/other.h5"))
        extending = ("-o", "no.h5", "--extend", "far/away/old.h5")
        refused = self.rodsweep(0, "run", "adapted.json", *extending, code=USER_ERROR)
        self.assertIn("guesses", refused.stderr)

    def test_a_model_that_is_another_now_or_nowhere_is_no_reason_to_copy(self):
        with h5py.File("jobs/models/net.h5", "r+") as h5:
            h5.attrs["remark"] = "not the same bytes"
        extending = ("-o", "no.h5", "--extend", "far/away/old.h5")
        refused = self.rodsweep(0, "run", "jobs/new.json", *extending, code=USER_ERROR)
        self.assertIn("plan_hash", refused.stderr)
        os.remove("jobs/models/net.h5")
        for words in (("rerun", "far/away/old.h5", "0"), ("merge", "far/away/old.h5", "-o", "merged.h5")):
            refused = self.rodsweep(0, *words, code=USER_ERROR)
            self.assertRegex(refused.stderr, r'copingnet\.model: "models/net\.h5" is not allowed.*jobs/models/net\.h5')

    def test_rerun_and_merge_find_the_model_and_resume_takes_that_of_its_own_job(self):
        self.assert_same_again("far/away/old.h5")
        self.rodsweep(0, "merge", "far/away/old.h5", "-o", "far/merged.h5")
        self.assert_same_again("far/merged.h5")
        with h5py.File("far/away/old.h5", "r+") as h5:
            h5["tasks/state"][1] = 0
        shutil.move("jobs", "moved")
        self.rodsweep(0, "run", "moved/old.json", "-o", "far/away/old.h5", "--resume")


class Refusing(ExtendCase):
    def assert_refused(self, job, output, old, *words, says):
        self.assert_refused_once(3, "run", job, "-o", output, "--extend", old, *words, says=says)

    def test_jobs_that_differ_otherwise_and_wrong_files(self):
        """For the words of refusals see tests/runner/file/test_extension.cpp."""
        old = self.old()
        for changes, *says in (({"seed": 6}, "seed: 6 here, 5 in old.h5"),
                               ({"segments": (6, 7)}, "scene.segments: ", "[6,7]", "9 in old.h5"),
                               ({"guesses": [*OLD_GUESSES, "linear"]}, "guesses: ", "without --extend")):
            with self.subTest(changes=changes):
                says = ("other.json: ", "--extend", *says)
                self.assert_refused(self.new("other", **changes), "no.h5", old, says=says)
                self.assertFalse(os.path.exists("no.h5"))
        path = self.new("fine", samples=3)
        self.assert_refused(path, "no.h5", "none.h5", says="none.h5: file not found")
        self.assert_refused(path, "old.h5", "old.h5", says=("old.h5", "-o FILE"))
        self.rodsweep(3, "run", path, "-o", "fine.h5")
        self.assert_refused(path, "fine.h5", old, says="fine.h5 exists already")
        self.assert_refused(path, "fine.h5", old, "--resume", says="fine.h5 was not started with --extend old.h5")


if __name__ == "__main__":
    unittest.main()
