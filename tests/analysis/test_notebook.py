"""analysis/example.ipynb runs unchanged on a planted file, shows the planted numbers, and is stored without outputs."""

import ast
import json
import os
import unittest

import synthetic
import matplotlib
from running import Scripts

PATH = os.path.join(synthetic.ANALYSIS, "example.ipynb")


class Notebook(Scripts):
    def setUp(self):
        super().setUp()
        with open(PATH, encoding="utf-8") as file:
            self.whole = json.load(file)

    def shown(self):
        """Runs the code cells in this process without Jupyter; returns the value that each shows, or None."""
        names, values = {"__name__": "__main__"}, []
        for cell in self.whole["cells"]:
            if cell["cell_type"] == "code":
                tree = ast.parse("".join(cell["source"]))
                last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
                exec(compile(tree, PATH, "exec"), names)
                values.append(eval(compile(ast.Expression(last.value), PATH, "eval"), names) if last else None)
        return values

    def test_all_cells_run_and_show_the_planted_numbers(self):
        matplotlib.use("agg")
        os.mkdir("results")
        synthetic.Sweep(steps=2, samples=6, pending=(2,), counts_in_rows=True).write("results/demo.h5")
        with synthetic.h5py.File("results/demo.h5", "r+") as h5:
            h5["tasks/iterations_sum"].attrs["meaning"] = "planted"
        opened, missing, tasks, units, ratio, figure, means, blocks, _ = self.shown()
        self.assertIn("35 of 36 tasks ok", repr(opened))
        self.assertEqual(missing, "1 pending of 36 tasks")
        self.assertEqual(len(tasks), 5)
        self.assertEqual(units[0], "planted")
        self.assertEqual(units[1]["scene.youngs_modulus_pa"], "Pa")
        for guess, quality in (("previous", 0.5), ("quadratic", 0.25), ("oracle(0.1)", 0.1)):
            values = ratio[ratio.guess == guess]
            self.assertEqual(len(values), 2 * 3)
            self.assertTrue((abs(values.value - quality) < 0.01).all())
            self.assertTrue(((values.low <= values.value) & (values.value <= values.high)).all())
            self.assertTrue((abs(means[guess] - quality) < 0.01).all())
        self.assertEqual(len(figure.axes), 2)
        self.assertEqual(len(figure.axes[0].containers), 3)
        self.assertEqual(blocks.shape, (2, 4))
        self.assertAlmostEqual(blocks["quadratic"][0] / blocks["zero"][0], 0.25, delta=0.01)

    def test_it_is_a_notebook_without_outputs(self):
        whole = self.whole
        self.assertEqual((whole["nbformat"], whole["metadata"]["kernelspec"]["name"]), (4, "python3"))
        self.assertEqual(len({cell["id"] for cell in whole["cells"]}), len(whole["cells"]))
        self.assertIn("`pip install 'analysis/[frames]'`", "".join(whole["cells"][0]["source"]))    # pandas and xarray too
        for cell in whole["cells"]:
            if cell["cell_type"] == "code":
                self.assertEqual((cell["outputs"], cell["execution_count"]), ([], None))


if __name__ == "__main__":
    unittest.main()
