"""`rodsweep systems` and matrices.py: the systems of a task are those that it solved, in every format."""

import contextlib
import csv
import io
import json
import os
import re
import subprocess

from running import Scripts, run
import h5py
import numpy as np
import rodsweep
import scipy.io
import scipy.sparse

ROD = {"type": "bending_rod", "segments": 9, "length_m": {"uniform": [1, 2]}, "radius_m": 0.05, "density_kg_m3": 1000,
       "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 1e6}


def cross(r):
    return np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])


def matrix_by_hand(system, held):
    """A of a chain whose rest shape is straight, by the formulas of docs/methods.md."""
    rod, joints = system.of, len(system.b) // 6
    jacobian = np.zeros((6 * joints, 6 * (joints + 1)))
    for k, (a, b) in enumerate(rod.segments):
        (wa, *va), (wb, *vb) = system.orientation[a], system.orientation[b]
        w = wa * wb + np.dot(va, vb)
        v = wa * np.array(vb) - wb * np.array(va) - np.cross(va, vb)
        w, v = (w, v) if w >= 0 else (-w, -v)
        length, half = (rod.length_m[a] + rod.length_m[b]) / 2, w * np.eye(3) + cross(v) + np.outer(v, v) / (1 + w)
        for segment, h, arm, sign in ((a, half.T, rod.length_m[a] / 2, 1), (b, half, -rod.length_m[b] / 2, -1)):
            rows = jacobian[6 * k:6 * k + 6, 6 * segment:6 * segment + 6]
            rows[:3, :3] = sign * h / length
            rows[:3, 3:] = -sign * h @ cross([0, 0, arm]) / length
            rows[3:, 3:] = -sign * (w * np.eye(3) - sign * cross(v))
    m, l, r = rod.mass_kg, rod.length_m, rod.radius_m
    turning = 1 / (m * l ** 2 / 12 + m * r ** 2 / 4)
    mobility = np.stack([1 / m, 1 / m, 1 / m, turning, turning, 2 / (m * r ** 2)], axis=1)
    mobility[held] = 0
    return jacobian * mobility.ravel() @ jacobian.T + np.diag(rod.compliance_per_j.ravel()) / system.dt_s ** 2


class Exported(Scripts):
    def program(self, *words, code=0):
        done = subprocess.run([os.environ["RODSWEEP"], *words], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def swept(self, **keys):
        """The file of a job."""
        job = {"name": "s", "kind": "sweep", "samples": 2, "scene": ROD, "guesses": ["zero", "previous"],
               "time": {"step_s": 0.02, "steps": 11, "newton_iterations": 3, "integrator": "euler", "balance": False},
               **keys}
        with open("s.json", "w", encoding="utf-8") as file:
            json.dump({key: value for key, value in job.items() if value is not None}, file)
        self.program("run", "s.json", "-o", "s.h5")
        return "s.h5"

    def test_the_matrix_can_be_made_by_hand(self):
        self.program("systems", self.swept(), "0", "--every", "2", "-o", "a.h5")
        with rodsweep.systems("a.h5") as systems:
            for system in systems:
                error = matrix_by_hand(system, held=[0]) - system.A.toarray()
                self.assertLess(abs(error).max(), 1e-12 * abs(system.A).max())

    def test_a_sweeps_systems_are_those_that_it_counted(self):
        file = self.swept()
        said = self.program("systems", file, "1", "--every", "5", "--first", "-o", "a.h5").stdout
        self.assertIn("3 systems: a.h5", said)
        self.assertEqual(run("matrices.py", "a.h5", "--format", "petsc", "-o", "petsc").code, 0)
        with rodsweep.systems("a.h5") as systems, h5py.File(file) as results:
            self.assertEqual([(system.step, system.newton, system.rod) for system in systems],
                             [(0, 0, 0), (5, 0, 0), (10, 0, 0)])
            self.assertEqual(systems.job()["name"], "s")
            rows = slice(results["/tasks/first_solve"][1], results["/tasks/first_solve"][1] + results["/tasks/solves"][1])
            step, newton = results["/solves/step"][rows], results["/solves/newton"][rows]
            counted = results["/solves/iterations"][rows][(newton == 0) & (step % 5 == 0), 0, 1]    # zero, to 1e-2
            found = [int(subprocess.check_output([os.environ["PETSC_SOLVE"],
                                                  f"petsc/step-{system.step}_newton-0_rod-0.petsc"])) for system in systems]
            self.assertEqual(found, counted.tolist())
            for system in systems:
                self.assertLess(np.linalg.norm(system.b - system.A @ system.x), 1e-11 * np.linalg.norm(system.b))
                self.assertLess(abs(system.A - system.A.T).max(), 1e-12 * abs(system.A).max())

    def test_all_newton_iterations_of_a_closed_loop_with_the_solution_that_moved_the_rod(self):
        file = self.swept(evaluation="closed_loop", solve={"tolerance": 1e-2},
                          time={"step_s": 0.02, "steps": 11, "newton_iterations": 3, "balance": False})
        self.program("systems", file, "0", "-o", "a.h5")
        with rodsweep.systems("a.h5") as systems:
            self.assertEqual(len(systems), 6)
            residuals = [np.linalg.norm(system.b - system.A @ system.x) / np.linalg.norm(system.b) for system in systems]
            self.assertTrue(all(1e-5 < residual <= 1e-2 for residual in residuals), residuals)
            self.assertEqual([round(system.dt_s, 9) for system in systems], [0.02] * 3 + [round(0.04 / 3, 9)] * 3)
            first, second = systems[0], systems[1]
            np.testing.assert_allclose(second.multipliers, first.multipliers + first.x)

    def test_a_data_sets_systems_have_its_solutions_and_poses(self):
        file = self.swept(kind="dataset", guesses=None, record={"systems": "all"})
        self.program("systems", file, "1", "--every", "1", "-o", "a.h5")
        with rodsweep.systems("a.h5") as systems, h5py.File(file) as data:
            first, joints = data["/tasks/first_system"][1], 8
            rows = data["/systems/step"][first:first + 33] >= 0
            self.assertEqual(len(systems), np.count_nonzero(rows))
            solutions = data["/systems/joints/solution"][:].reshape(2, 33, 6 * joints)[1][rows]
            positions = data["/systems/segments/position_m"][:].reshape(2, 33, 9, 3)[1][rows]
            for system, solution, position in zip(systems, solutions, positions):
                np.testing.assert_allclose(system.x, solution, atol=1e-9 * abs(solution).max())
                np.testing.assert_allclose(system.position_m, position, atol=1e-12)
                self.assertLess(np.linalg.norm(system.b - system.A @ solution), 1e-10 * np.linalg.norm(system.b))

    def test_formats_hold_the_same_numbers(self):
        self.program("systems", self.swept(), "0", "--first", "-o", "a.h5")
        for form in ("matrix-market", "npz"):
            self.assertEqual(run("matrices.py", "a.h5", "--format", form, "-o", form).code, 0)
        refused = run("matrices.py", "a.h5", "--format", "npz", "-o", "npz")
        self.assertIn("exists", refused.stderr)
        with rodsweep.systems("a.h5") as systems:
            system = systems[1]
            stem = f"step-{system.step}_newton-0_rod-0"
            read = scipy.io.mmread(f"matrix-market/{stem}.mtx").toarray()
            lower = np.tril(system.A.toarray())
            self.assertEqual(abs(np.tril(read) - lower).max(), 0)
            self.assertEqual(scipy.io.mmread(f"matrix-market/{stem}_b.mtx").ravel().tolist(), system.b.tolist())
            with np.load(f"npz/{stem}.npz") as npz:
                made = scipy.sparse.bsr_matrix((npz["data"], npz["indices"], npz["indptr"]))
                self.assertEqual(abs(made - system.A).max(), 0)
                self.assertEqual(npz["mass_kg"].tolist(), system.of.mass_kg.tolist())

    def test_benchmark_data_of_a_finished_run_have_reference_counts_and_checksums_and_name_failed_tasks(self):
        file = self.swept(samples=3, solve={"preconditioner": {"grid": ["jacobi", "block_icc"]}})
        with h5py.File(file, "a") as results:
            results["/tasks/state"][1] = 0
        done = run("benchmark_data.py", file, "-o", "data")
        self.assertEqual((done.code, os.path.exists("data")), (2, False))
        self.assertIn("s.h5 is not finished (5 of 6 tasks ok, none failed, 1 pending): continue", done.stderr)
        with h5py.File(file, "a") as results:
            results["/tasks/state"][1], results["/tasks/outcome"][1] = 1, b"diverged"
        for _ in range(2):    # the second one keeps the files
            done = run("benchmark_data.py", file, "-o", "data")
            self.assertEqual(done.code, 0, done.stderr)
        names = ["bending_rod-8-test-0", "bending_rod-8-tuning-0", "bending_rod-8-tuning-1"]
        self.assertEqual(sorted(os.listdir("data")), ["README.md", "SHA256SUMS", *(f"{name}.h5" for name in names),
                                                      "reference.csv"])
        subprocess.run(["sha256sum", "--check", "--quiet", "SHA256SUMS"], cwd="data", check=True)
        with open("data/reference.csv", encoding="utf-8", newline="") as table, h5py.File(file) as results:
            rows = list(csv.reader(table))
            self.assertEqual(rows[0][:6], ["systems", "preconditioner", "guess", "start_products", "0.1", "0.01"])
            self.assertEqual(len(rows), 1 + 5 * 2)
            self.assertEqual([int(count) for count in rows[1][4:]], results["/tasks/iterations_sum"][0, 0].tolist())
            self.assertEqual([row[3] for row in rows[1:3]], ["0", "10"])    # zero, previous
        with rodsweep.systems("data/bending_rod-8-test-0.h5") as systems:
            self.assertEqual(len(systems), 11)
            self.assertLess(np.linalg.norm(systems[5].b - systems[5].A @ systems[5].x), 1e-10 * np.linalg.norm(systems[5].b))
        with open("data/README.md", encoding="utf-8") as card:
            said = card.read()
        self.assertIn("33 systems A x = b of 3 simulations: bending rod, steps of 0.02 s", said)
        self.assertRegex(said, r"1 of 6 tasks failed and are left out: bending_rod-8-t\S+ with \w+ \(diverged\)\.")

    def test_the_code_of_the_benchmarks_card_counts_as_the_program_does(self):
        self.assertEqual(run("benchmark_data.py", self.swept(samples=3), "-o", "data").code, 0)
        with open("data/README.md", encoding="utf-8") as card:
            code = re.search(r"```python\n(.*?)```", card.read(), re.DOTALL)[1]
        os.chdir("data")
        names = {}
        with contextlib.redirect_stdout(io.StringIO()) as said:
            exec(code, names)
        self.assertRegex(said.getvalue(), r"guess +own +previous +zero\n")
        rows = names["rows"].set_index("guess")
        self.assertEqual(set(rows.systems), {"bending_rod-8-test-0"})
        own, program = rows.loc["own"], rows.loc["previous"]
        self.assertEqual(own.start_products, program.start_products)
        for tolerance in ("0.1", "0.01", "0.001", "0.0001"):
            self.assertAlmostEqual(own[tolerance], program[tolerance], delta=2)    # rounding in 11 systems
        self.assertGreater(program["0.01"], 20)

        class Solved:
            """Knows the next solution, of two products with A; accepts nothing."""

            def __init__(self, rods, options):
                self.rods = rods

            def propose(self, system):
                assert self.rods[0] is system.of and system.blocks.shape[1:] == (6, 6)
                return system.x.reshape(-1, 6), 2

        own = rodsweep.benchmark(Solved, ".", "tuning").query("guess == 'own'")
        self.assertEqual(own[["start_products", "0.0001"]].values.tolist(), 2 * [[11 * 3, 0]])
        with self.assertRaisesRegex(rodsweep.UserError, r"^\. has no files \*-tests-\*.h5 of benchmark_data.py$"):
            rodsweep.benchmark(Solved, ".", "tests")

    def test_what_is_no_system_is_refused(self):
        file = self.swept()
        self.assertIn("must be from 0 to 1", self.program("systems", file, "2", code=2).stderr)
        self.program("systems", file, "0")
        self.assertIn("exists", self.program("systems", file, "0", code=2).stderr)
        self.assertIn("holds linear systems, not results", self.program("info", "s-systems-0.h5", code=2).stderr)
        with self.assertRaisesRegex(rodsweep.UserError, "holds no linear systems"):
            rodsweep.systems(file)
        for path in ("s-systems-0.h5", "s.h5"):
            os.remove(path)
        alone = self.swept(evaluation="closed_loop", guesses=None, solve={"method": "xpbd"})
        self.assertIn("solves no linear system", self.program("systems", alone, "0", code=2).stderr)
