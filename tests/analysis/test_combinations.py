"""combinations.py: the cheapest combination of preconditioner and guess of each kind, and its speedup."""

import h5py
import numpy as np

import running

JOINTS = {10: 60, 40: 240}


class Combinations(running.Scripts):
    def write(self, **settings):
        """icc takes half of Jacobi's time and iterations; a net has six times as many joints as segments."""
        super().write(**{"scenes": ("net",), "samples": 5, "random": {},
                         "grid": {"scene.segments": list(JOINTS), "solve.preconditioner": ["jacobi", "icc"]},
                         **settings})
        with h5py.File(self.path, "a") as h5:
            segments = h5["tasks/parameters/scene.segments"][:]
            h5["tasks/joints"] = np.array([JOINTS[n] for n in segments])
            icc = h5["tasks/parameters/solve.preconditioner"][:] == b"icc"
            of_row = np.repeat(icc, h5["tasks/solves"][:])
            for path, rows in (("timing/solves/cg_s", of_row), ("tasks/iterations_sum", icc)):
                values = h5[path][:]
                values[rows] = values[rows] / 2
                h5[path][...] = values

    def blocks(self, *arguments, files=False):
        """{joints: lines with single blanks}"""
        said = self.run_script("combinations.py", self.path, "--x", "scene.segments", *arguments, files=files)
        self.assertEqual(said.stderr, "")
        found, lines = {}, []
        for line in said.stdout.splitlines():
            if " joints, 5 simulations" in line:
                lines = found.setdefault(int(line.split(": ")[1].split()[0]), [])
            lines.append(" ".join(line.split()))
        return found

    def test_the_cheapest_of_each_kind_and_its_speedups_over_those_of_the_others(self):
        self.write()
        found = self.blocks(files=True)
        self.assertEqual(list(found), [60, 240])
        # at 10 segments: zero 10 us with Jacobi and 5 with icc, quadratic 2.5 / 1.25 and a guess of 1, direct 8
        lines = {line.split(" [")[0] for line in found[60]}
        for expected in ("direct direct 8", "from zero icc from zero 5", "classical guess icc from quadratic 2.25",
                         "free oracle icc from oracle(0.1) 0.5"):
            self.assertIn(expected, lines)
        self.assertIn("classical guess icc from quadratic 9", {line.split(" [")[0] for line in found[240]})
        oracle = next(line for line in found[60] if line.startswith("free oracle"))
        values = [part.split(" ")[-1] for part in oracle.split(" [")[:-1]]
        self.assertEqual(values, ["0.5", "4.5", "10", "16"])   # 2.25, 5 and 8 us over 0.5 us

    def test_only_the_chosen_guesses_are_combined(self):
        self.write()
        lines = " ".join(self.blocks("--guess", "zero,oracle(0.1)")[60])
        self.assertIn("oracle(0.1)", lines)
        self.assertNotIn("quadratic", lines)

    def test_iterations_and_ratios_are_those_of_the_same_preconditioner(self):
        self.write()
        lines = self.blocks("--tolerance", "1e-2")[60]
        row = next(line for line in lines if line.startswith("icc from quadratic"))
        self.assertIn("] 25.0 0.248 [", row)   # a quarter of 202 is 50; icc halves it

    def test_closed_loops_have_whole_steps(self):
        self.write(closed_loop=True, guesses=("zero", "quadratic"))
        line = next(line for line in self.blocks()[60] if line.startswith("icc from zero"))
        # Three systems a step with 2 us of assembly each; CG takes 5 us first, then 2.5 us each; the rest takes 3 us.
        self.assertEqual(line.split()[3], "19")

    def test_a_combination_that_failed_once_is_not_the_cheapest(self):
        self.write(failed={5: "torn"})   # the first task of icc at 10 segments
        lines = {line.split(" [")[0] for line in self.blocks()[60]}
        self.assertIn("from zero jacobi from zero 10", lines)

    def torn(self, which):
        """Writes a closed loop with torn tasks: those where which(tasks' preconditioners, guesses, samples)."""
        settings = {"closed_loop": True, "guesses": ("zero", "quadratic")}
        self.write(**settings)
        with h5py.File(self.path) as h5:
            of = which(h5["tasks/parameters/solve.preconditioner"][:], h5["tasks/own_guess"][:], h5["tasks/sample"][:])
        self.write(failed={int(task): "torn" for task in np.flatnonzero(of)}, **settings)

    def test_where_all_of_a_kind_failed_once_the_fastest_says_so(self):
        self.torn(lambda preconditioner, guess, sample: (guess == 0) & (sample == 2))
        lines = self.blocks()[60]
        self.assertTrue([line for line in lines if line.startswith("from zero icc from zero 19 (4 of 5)")])
        self.assertTrue([line for line in lines if line.startswith("classical guess") and "of 5" not in line])

    def test_a_preconditioner_that_always_failed_from_zero_has_no_ratios(self):
        self.torn(lambda preconditioner, guess, sample: (preconditioner == b"icc") & (guess == 0))
        lines = self.blocks()[60]
        self.assertFalse([line for line in lines if line.startswith("icc from zero")])
        self.assertIn(" - - ", next(line for line in lines if line.startswith("icc from quadratic")))
