"""A guess from a shared library in a job: that of the page saves iterations, and errors reach the user."""

import os
import shutil
import subprocess
import sys
import unittest

import h5py
from program import InAFolder

SOURCE = os.environ["SOURCE_DIR"]


class Plugin(InAFolder):
    def setUp(self):
        super().setUp()
        shutil.copy(os.environ["PLUGIN_EXAMPLE"], "mine.so")

    def compile(self, name, code, *flags):
        """Makes NAME.so, with the header where it is installed."""
        os.makedirs("include/rodsweep")
        shutil.copy(os.path.join(SOURCE, "solver", "plugin", "plugin.h"), "include/rodsweep")
        self.write(name + ".c", code)
        subprocess.run(["cc", *flags, "-shared", "-fPIC", "-I", "include", name + ".c", "-o", name + ".so"], check=True)

    def test_the_example_of_the_page_works(self):
        with open(os.path.join(SOURCE, "docs", "extending.md"), encoding="utf-8") as page:
            code = page.read().split("```c\n")[1].split("```")[0]
        self.compile("half", code, "-Wall", "-Wextra", "-Werror")
        self.ran("run", self.job({"plugin": {"library": "half.so"}}), "-o", "s.h5")
        with h5py.File("s.h5") as file:
            iterations = file["/tasks/iterations_sum"][0]
            self.assertLess(iterations[1, 0], iterations[0, 0])
            self.assertEqual(file["/axes/guess"][1], b"plugin half")

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
        self.compile("rude", r"""
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
        text = "plug-in rude.so: \\x1b]0;mine\\x07\\x1b[31mred \ufffd\\x9b"
        self.assertIn(text, self.ran("run", self.job({"plugin": {"library": "rude.so"}}), "-o", "s.h5", code=3).stdout)
        with h5py.File("s.h5") as file:
            self.assertEqual(file["/tasks/message"][0].decode(), text)
        self.assertIn(text, self.said("status", "s.h5"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + ["-v"])
