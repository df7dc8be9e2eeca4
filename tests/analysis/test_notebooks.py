"""The notebooks run unchanged with the program (RODSWEEP), their numbers agree with each other and with statics, and they
are stored without outputs."""

import ast
import json
import os

import synthetic
import matplotlib
import rodsweep
from running import Scripts

NOTEBOOKS = os.path.join(synthetic.ANALYSIS, "notebooks")


def cells(name):
    with open(os.path.join(NOTEBOOKS, name), encoding="utf-8") as file:
        return json.load(file)["cells"]


class Notebooks(Scripts):
    def shown(self, name):
        """Runs the code cells in this process without Jupyter; returns the value that each shows, or None."""
        matplotlib.use("agg")
        names, values = {"__name__": "__main__"}, []
        for cell in cells(name):
            if cell["cell_type"] == "code":
                tree = ast.parse("".join(cell["source"]))
                last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
                exec(compile(tree, name, "exec"), names)
                values.append(eval(compile(ast.Expression(last.value), name, "eval"), names) if last else None)
        return values

    def test_a_sweeps_frames_datasets_and_blocks_have_the_same_numbers(self):
        opened, missing, tasks, about, ratio, figure, means, blocks, _ = self.shown("sweep.ipynb")
        self.assertIn("25 of 25 tasks ok", repr(opened))
        self.assertEqual(missing, "nothing is missing")
        self.assertEqual(len(tasks), 5)
        self.assertIn("CG iterations", about[0])
        self.assertEqual(about[1]["scene.length_m"], "m")
        self.assertEqual(len(ratio), 3 * (3 + 2))
        self.assertTrue(((ratio.low <= ratio.value) & (ratio.value <= ratio.high)).all())
        for (scene, guess), rows in ratio.groupby(["scene", "guess"]):
            self.assertAlmostEqual(means[guess][scene], rows.value.mean(), delta=0.005)    # as many tasks a row
        self.assertTrue((ratio[ratio.guess == "subspace 10"].value < 0.5).all())
        self.assertEqual([len(axes.containers) for axes in figure.axes], [3, 3])
        self.assertEqual(blocks.shape, (5, 4))
        with rodsweep.open("results/notebook_sweep.h5") as results:
            first = results.solves(where=["newton=0", "step=0", "guess=zero"])
        self.assertAlmostEqual(blocks["zero"][0], first["iterations_1e-2"].mean())

    def test_the_scaled_solution_takes_fewer_iterations_than_the_last_one(self):
        *_, opened, table, figure, _ = self.shown("own_guess.ipynb")
        self.assertIn("5 of 5 tasks ok", repr(opened))
        ratios, products = table.cg_ratio, table.cg_ratio_products
        self.assertLess(ratios["python scaled"], ratios["previous"])
        self.assertGreater(products["python scaled"], ratios["python scaled"])
        self.assertEqual(len(figure.axes[0].lines), 5)

    def test_the_reactions_of_the_cable_are_its_weight_and_load(self):
        *_, tasks, figure, steps, _ = self.shown("own_rod.ipynb")
        self.assertEqual(set(tasks.outcome), {"ok"})
        self.assertLess(tasks.steps_done.max(), 4000)
        self.assertEqual(len(steps), 3)
        self.assertLess(abs(steps.clamp_force_n_y / steps.weight_and_load_n - 1).max(), 1e-4)
        self.assertGreater(steps.weight_and_load_n[0], 1)
        tensions = [line.get_ydata().max() for line in figure.axes[1].lines]
        self.assertEqual(tensions, sorted(tensions))

    def test_they_are_notebooks_without_outputs(self):
        for name in sorted(os.listdir(NOTEBOOKS)):
            with self.subTest(notebook=name), open(os.path.join(NOTEBOOKS, name), encoding="utf-8") as file:
                whole = json.load(file)
                self.assertEqual((whole["nbformat"], whole["metadata"]["kernelspec"]["name"]), (4, "python3"))
                self.assertEqual(len({cell["id"] for cell in whole["cells"]}), len(whole["cells"]))
                self.assertIn("`pip install 'analysis/[frames]'`", "".join(whole["cells"][0]["source"]))    # pandas too
                for cell in whole["cells"]:
                    if cell["cell_type"] == "code":
                        self.assertEqual((cell["outputs"], cell["execution_count"]), ([], None))
