#!/usr/bin/python3
"""Messages for a mistyped command, and for a valid job whose values or files need attention."""

import fcntl
import json
import os
import pty
import re
import select
import shutil
import struct
import subprocess
import termios
import unittest

from program import ALL_DONE, DATA, ROD, RODSWEEP, USER_ERROR, Case, rodsweep, sweep, write_job

SOURCE_DIR = os.environ["SOURCE_DIR"]


class Mistyped(Case):
    def test_a_command_or_option_that_is_none_is_answered_with_the_nearest(self):
        for words, *texts in ((("valdate", "a.json"), '"valdate"', "rodsweep-valdate", 'did you mean "validate"?'),
                              (("frobnicate",), '"frobnicate"', "rodsweep-frobnicate"),
                              (("run", "a.json", "--resme"), "--resme", 'did you mean "--resume"?'),
                              (("run", "a.json", "--otput=x.h5"), "--otput", 'did you mean "--output"?'),
                              (("--verson",), "--verson", 'did you mean "--version"?')):
            with self.subTest(words=words):
                self.assert_refused(words, "--help", *texts)
        self.assertNotIn("did you mean", rodsweep("frobnicate").stderr)

    def test_numbers_must_be_finite(self):
        for option in ("--memory-limit-gb", "--time-limit", "--task-time-limit", "--worker-timeout"):
            for value in ("nan", "inf", "-inf"):
                with self.subTest(option=option, value=value):
                    self.assert_refused(("run", write_job("small"), f"{option}={value}"), f"{option}: {value} is not allowed")

    def test_petsc_options_without_effect_are_named(self):
        done = rodsweep("run", write_job("petsc"), env={**os.environ, "PETSC_OPTIONS": "-pc_type lu -log_view :log.txt"})
        self.assertEqual(done.returncode, ALL_DONE, done.stderr)
        self.assertIn("PETSC_OPTIONS: -pc_type has no effect", done.stderr)
        self.assertTrue(os.path.exists("log.txt"))


class Surroundings(Case):
    """What the program finds around it: environment, launcher, encodings."""

    def test_petsc_options_that_cannot_be_read_are_a_users_error(self):
        job = write_job("unread")
        for words in (("run", job), ("run", job, "-n", 2), ("plan", job)):
            with self.subTest(words=words):
                done = rodsweep(*words, env={**os.environ, "PETSC_OPTIONS": "-options_file nowhere.txt"})
                self.assertEqual(done.returncode, USER_ERROR, done.stderr)
                first, *others = done.stderr.splitlines()
                self.assertTrue(first.startswith("rodsweep: error: PETSc did not start; correct PETSC_OPTIONS: "), first)
                self.assertIn("nowhere.txt", first)
                self.assertFalse([line for line in others if "rodsweep" in line and "prterun" not in line], others)

    def test_a_user_without_home_and_name_can_run(self):
        job = write_job("nameless", samples=1)
        nameless = {name: value for name, value in os.environ.items() if name != "HOME"} | {"TMPDIR": os.getcwd()}
        strange = ["unshare", "--user", "--map-user=4242"]
        if subprocess.run([*strange, "true"], stderr=subprocess.DEVNULL, check=False).returncode != 0:
            self.skipTest("user namespaces are not allowed here")
        for words in (("plan", job), ("run", job), ("run", job, "-n", "2", "-o", "two.h5")):
            with self.subTest(words=words):
                done = subprocess.run([*strange, RODSWEEP, *words], env=nameless, capture_output=True, text=True,
                                      timeout=600, check=False)
                self.assertEqual(done.returncode, ALL_DONE, done.stderr)

    def test_processes_that_do_not_know_of_each_other_learn_why_the_file_exists(self):
        job = write_job("alone", samples=1)
        step = {**os.environ, "SLURM_STEP_NUM_TASKS": "3"}
        self.assertNotIn("do not know of each other", rodsweep("run", job, env=step).stderr)
        refused = rodsweep("run", job, env=step)
        self.assertEqual(refused.returncode, USER_ERROR)
        self.assertIn("alone.h5 exists already", refused.stderr)
        self.assertIn("3 processes were started, but they do not know of each other", refused.stderr)
        self.assertIn("srun --mpi=pmix", refused.stderr)

    def test_a_message_holds_no_raw_bytes(self):
        with open(write_job("odd"), encoding="utf-8") as file:
            text = file.read()
        odd = {"utf16": text.encode("utf-16"), "latin1": text.replace("odd", "öd").encode("latin-1"),
               "elf": b"\x7fELF\x02\x01\x01\x1b[31m" + bytes(range(128, 256))}
        for name, content in odd.items():
            with self.subTest(file=name):
                with open(name + ".json", "wb") as file:
                    file.write(content)
                done = rodsweep("validate", name + ".json")
                self.assertEqual(done.returncode, USER_ERROR)
                self.assertTrue(all(c.isprintable() or c == "\n" for c in done.stderr), done.stderr)

    def test_scripts_print_in_any_encoding(self):
        path = sweep("plain")
        for encoding in ("latin-1", "ascii"):
            said = subprocess.run([RODSWEEP, "summary", path], env={**os.environ, "PYTHONIOENCODING": encoding},
                                  stdin=subprocess.DEVNULL, capture_output=True, check=False)
            self.assertEqual((said.returncode, said.stderr), (ALL_DONE, b""))
            self.assertIn("?b", said.stdout.decode(encoding))    # of the norm of b
        self.assertIn("‖b", self.said("summary", path))

    def test_a_progress_line_fits_its_terminal(self):
        job = write_job("narrow", samples=40, time={"step_s": 0.02, "steps": 60})
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("4H", 24, 30, 0, 0))
        for words in (("-o", "narrow-1.h5"), ("-n", "2", "-o", "narrow-2.h5")):
            with subprocess.Popen([RODSWEEP, "run", job, *words], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                  stderr=theirs, env={**os.environ, "TERM": "xterm"}) as process:
                shown = b""
                while process.poll() is None:
                    while select.select([ours], [], [], 0.05)[0]:
                        shown += os.read(ours, 4096)
            lines = [line for line in re.split(r"\r\x1b\[K|\r?\n", shown.decode()) if " of 80 tasks" in line]
            lines = [line for line in lines if not line.startswith("rodsweep: ")]
            self.assertTrue(lines, shown)
            self.assertLess(max(map(len, lines)), 30)
        os.close(ours)
        os.close(theirs)

    def test_a_path_that_is_not_utf8_is_still_json(self):
        path = os.fsdecode(b"odd-\xff.h5")
        rodsweep("run", write_job("small"), "-o", path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.assertIn("odd-\ufffd.h5", self.shown("status", path)["file"])


class Planned(Case):
    def test_what_nobody_can_store_or_wait_for_is_named(self):
        time = {"step_s": 0.02, "steps": 10_000_000}
        huge = write_job("huge", scene={**ROD, "segments": 200}, samples=5_000, time=time)
        warnings = self.shown("plan", huge)["warnings"]
        self.assertEqual(len(warnings), 2)
        self.assertRegex(warnings[0], r"needs [\d.]+ [TP]B, but .* free")
        self.assertRegex(warnings[1], r"\d years with \d+ workers?: fewer samples")
        self.assertEqual(self.shown("plan", write_job("small"))["warnings"], [])

    def test_slurms_line_needs_no_folder(self):
        job = os.path.abspath(write_job("batch"))
        os.makedirs("elsewhere", exist_ok=True)
        said = self.said("plan", job, cwd="elsewhere")
        program, script = re.search(r"RODSWEEP=(\S+) sbatch .*? (/\S+) " + re.escape(job), said).groups()
        self.assertTrue(os.path.isabs(program) and os.access(program, os.X_OK))
        self.assertTrue(os.path.isfile(script))


class Unconverged(Case):
    def test_the_end_of_a_run_counts_the_solves_of_the_whole_file_that_missed_the_tolerance(self):
        solve = {"preconditioner": "none", "max_iterations": 2}
        job = write_job("short", samples=1, guesses=["zero", "previous"], solve=solve)
        first = self.said("run", job)
        self.assertRegex(first, r"\n(\d+) of \1 solves missed the tolerance: their guesses have no times")
        again = self.said("run", job, "--resume")
        self.assertIn(re.search(r"\n.*missed.*\n", first)[0], again)
        self.assertNotIn("missed", self.said("run", write_job("enough", samples=1)))


class Validate(Case):
    """For missing files and JSON see tests/runner/inputs/test_input_files.cpp and test_job_refusals.cpp."""

    def validated(self, *words):
        said = rodsweep("validate", *words)
        self.assertEqual(said.returncode, ALL_DONE, said.stderr)
        return said.stdout.splitlines(), said.stderr.splitlines()

    def test_a_scene_that_cannot_be_built_is_refused_by_all_in_the_same_words(self):
        light = write_job("light", scene={**ROD, "density_kg_m3": 1e-308})
        for command in ("validate", "plan", "run"):
            with self.subTest(command=command):
                self.assert_refused((command, light), "light.json: scene: segment 1: mass is ", "large enough to be inverted")

    def test_a_file_that_is_not_there_is_refused_unless_a_job_beside_makes_it(self):
        use = write_job("use", guesses=["zero", {"copingnet": {"model": "../results/net.h5"}}])
        data = write_job("few", **DATA)
        train = "jobs/net.json"
        with open(train, "w", encoding="utf-8") as file:
            json.dump({"name": "net", "kind": "train", "data": "../results/few.h5", "validation_simulations": 1}, file)
        key = "jobs/use.json: guesses[1].copingnet.model: "
        self.assert_refused(("validate", use), key, '"../results/net.h5"', "jobs/../results/net.h5", "--later")
        results, notes = self.validated(use, train, data)
        self.assertEqual([line.split(": ")[0] for line in results], [use, train, data])
        self.assertEqual(len(notes), 2)
        for note, *texts in ((notes[0], key, "results/net.h5", train),
                             (notes[1], "jobs/net.json: data: ", "results/few.h5", data)):
            for text in texts:
                self.assertIn(text, note)
        results, notes = self.validated("--later", use)
        self.assertEqual((len(results), len(notes)), (1, 1))
        self.assertIn(key + "jobs/../results/net.h5", notes[0])

    def test_a_skeleton_that_is_not_there_is_refused_whatever_comes_later(self):
        tree = write_job("tree", samples=1, scene={"type": "skeleton", "skeleton": "aple_tree.swc",
                         "density_kg_m3": 800, "youngs_modulus_pa": 1e9, "torsion_modulus_pa": 4e8})
        shutil.copy(os.path.join(SOURCE_DIR, "jobs", "apple_tree.swc"), "jobs")
        self.assert_refused(("validate", tree), "jobs/tree.json: scene.skeleton: ", "jobs/aple_tree.swc",
                            'did you mean "apple_tree.swc"?')
        self.assert_refused(("validate", "--later", tree), "jobs/tree.json: scene.skeleton: ", "jobs/aple_tree.swc")

    def test_a_data_set_that_does_not_do_is_refused_as_run_refuses_it(self):
        sweep("some", **DATA)
        with open("jobs/greedy.json", "w", encoding="utf-8") as file:
            json.dump({"name": "greedy", "kind": "train", "data": "../results/some.h5"}, file)
        self.assert_refused(("validate", "jobs/greedy.json"), "validation_simulations: 100 ", "results/some.h5",
                            "4 simulations")

    def test_a_likely_slip_of_units_is_told_by_validate_and_run_and_stops_nothing(self):
        thick = write_job("thick", samples=1, scene={**ROD, "segments": 5, "length_m": 2, "radius_m": 5},
                          time={"step_s": 0.02, "steps": 1})
        (_, (warning,)), run = self.validated(thick), rodsweep("run", thick, "-o", "thick.h5")
        self.assertRegex(warning, r"warning: jobs/thick\.json: scene\.radius_m: 5 m.*\b2 m\b.*\b5 mm.*\b0\.005\b")
        self.assertEqual(run.stderr.count(warning), 1)


if __name__ == "__main__":
    unittest.main()
