"""tests/conditions.json, and a results file with its columns: what both readers of conditions are held to."""

import json
import os

import synthetic
import numpy as np

with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "conditions.json"), encoding="utf-8") as text:
    CASES = json.load(text)


def planted(path):
    """A file of six tasks with the columns of the table among its parameters."""
    synthetic.Sweep(scenes=("helix",), grid={"scene.segments": [10, 20, 40]}, samples=2, steps=1, newton=1).write(path)
    with synthetic.h5py.File(path, "r+") as h5:
        for name, column in CASES["columns"].items():
            (kind, values), = column.items()
            dtype, absent = {"whole": (np.int64, -1), "real": (np.float64, np.nan), "text": ("S32", "")}[kind]
            item = h5.create_dataset(f"tasks/parameters/{name}",
                                     data=np.array([absent if v is None else v for v in values], dtype=dtype))
            item.attrs.update({"unit": "", "meaning": f"the {name}", "swept": False})
    return path
