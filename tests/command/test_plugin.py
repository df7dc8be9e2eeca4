"""A guess from a shared library in a job: as good as the same guess of the program, and its errors reach the user."""

import json
import os
import shutil
import subprocess
import sys
import unittest

import h5py
from program import InAFolder


class Plugin(InAFolder):
    def setUp(self):
        super().setUp()
        shutil.copy(os.environ["PLUGIN_EXAMPLE"], "mine.so")

    def job(self, *guesses):
        with open("s.json", "w", encoding="utf-8") as file:
            json.dump({"name": "s", "kind": "sweep", "scene": {"type": "bending_rod", "segments": 9, "length_m": 1,
                       "radius_m": 0.05, "density_kg_m3": 1000, "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 1e6},
                       "time": {"step_s": 0.02, "steps": 10}, "guesses": ["zero", *guesses]}, file)
        return "s.json"

    def test_it_saves_what_the_same_guess_of_the_program_saves(self):
        self.ran("run", self.job("previous", {"plugin": {"library": "mine.so"}}), "-o", "s.h5")
        with h5py.File("s.h5") as file:
            iterations = file["/tasks/iterations_sum"][0]
            self.assertEqual(iterations[2].tolist(), iterations[1].tolist())
            self.assertLess(iterations[1, 1], iterations[0, 1])
            self.assertEqual([label.decode() for label in file["/axes/guess"]], ["zero", "previous", "plugin mine"])

    def test_the_example_of_the_page_works(self):
        source = os.environ["SOURCE_DIR"]
        with open(os.path.join(source, "docs", "extending.md"), encoding="utf-8") as page:
            code = page.read().split("```c\n")[1].split("```")[0]
        with open("half.c", "w", encoding="utf-8") as file:
            file.write(code)
        os.makedirs("include/rodsweep")
        shutil.copy(os.path.join(source, "solver", "plugin", "plugin.h"), "include/rodsweep")
        subprocess.run(["cc", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-I", "include", "half.c", "-o", "half.so"],
                       check=True)
        self.ran("run", self.job({"plugin": {"library": "half.so"}}), "-o", "s.h5")
        with h5py.File("s.h5") as file:
            iterations = file["/tasks/iterations_sum"][0]
            self.assertLess(iterations[1, 0], iterations[0, 0])

    def test_its_error_is_that_of_the_task(self):
        self.ran("run", self.job({"plugin": {"library": "mine.so", "options": "propose"}}), "-o", "s.h5", code=3)
        with h5py.File("s.h5") as file:
            self.assertEqual(file["/tasks/outcome"][0].rstrip(b"\0"), b"error")
            self.assertIn(b"plug-in mine.so: no guess in step 0", file["/tasks/message"][0])

    def test_a_library_that_was_cut_off_anywhere_is_refused(self):
        with open("mine.so", "rb") as file:
            whole = file.read()
        for size in (0, 30, 64, 1000, len(whole) // 4, len(whole) // 2, len(whole) - 1):
            with self.subTest(size=size):
                with open("cut.so", "wb") as file:
                    file.write(whole[:size])
                error = self.ran("validate", self.job({"plugin": {"library": "cut.so"}}), code=2).stderr
                self.assertRegex(error, "cut.so: (is incomplete: it has|cannot be loaded: )")

    def test_its_text_reaches_no_terminal_and_no_file_raw(self):
        with open("rude.c", "w", encoding="utf-8") as file:
            file.write(r"""
#include "rodsweep/plugin.h"
#include <string.h>
static void* create(const char* o, const rodsweep_rod* r, int n, char* e) { static int one; return &one; }
static void destroy(void* p) {}
static int propose(void* p, const rodsweep_system* s, double* x, int* n, char* e) {
  strcpy(e, "\x1b]0;mine\a\x1b[31mred \xff\xc2\x9b"); return -1;
}
const rodsweep_plugin_functions* rodsweep_plugin(void) {
  static const rodsweep_plugin_functions all = {RODSWEEP_PLUGIN_VERSION, create, destroy, propose, 0, 0, 0};
  return &all;
}
""")
        os.makedirs("include/rodsweep")
        shutil.copy(os.path.join(os.environ["SOURCE_DIR"], "solver", "plugin", "plugin.h"), "include/rodsweep")
        subprocess.run(["cc", "-shared", "-fPIC", "-I", "include", "rude.c", "-o", "rude.so"], check=True)
        text = "plug-in rude.so: \\x1b]0;mine\\x07\\x1b[31mred \ufffd\\x9b"
        self.assertIn(text, self.ran("run", self.job({"plugin": {"library": "rude.so"}}), "-o", "s.h5", code=3).stdout)
        with h5py.File("s.h5") as file:
            self.assertEqual(file["/tasks/message"][0].decode(), text)
        self.assertIn(text, self.said("status", "s.h5"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + ["-v"])
