"""What the program says about its files: constants.json, which `make schema` writes of `rodsweep schema`."""

import json
import os

with open(os.path.join(os.path.dirname(__file__), "constants.json"), encoding="utf-8") as _file:
    _said = json.load(_file)

SCHEMA_VERSION = _said["schema_version"]
OUTCOMES = _said["outcomes"]    # of tasks
PLANNED = _said["planned"]      # columns of /tasks that are known before a task runs
PATHS = _said["paths"]          # keys of jobs whose values are paths
WITH_FLOOR = _said["with_floor"]    # types of scenes that have a floor y = 0 of their own
GAUSS_SEIDEL_ITERATIONS = _said["gauss_seidel_iterations"]    # of solve.iterations, which has no column if no task sets it
