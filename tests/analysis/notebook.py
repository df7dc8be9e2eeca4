"""Runs the code of a notebook, cell by cell, in this process and without Jupyter: what each cell shows is a value."""

import ast
import json


def cells(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)["cells"]


def shown(path):
    """Values of the last expressions of all cells of code, None where a cell ends in something else."""
    names, values = {"__name__": "__main__"}, []
    for k, cell in enumerate(cell for cell in cells(path) if cell["cell_type"] == "code"):
        tree = ast.parse("".join(cell["source"]), f"{path}, code {k}")
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, f"{path}, code {k}", "exec"), names)
        values.append(eval(compile(ast.Expression(last.value), f"{path}, code {k}", "eval"), names) if last else None)
    return values
