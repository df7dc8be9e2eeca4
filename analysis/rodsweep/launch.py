"""Entry point of the installed `rodsweep-summary` and so on: runs the script of that name in analysis/."""

import importlib
import os
import sys

from rodsweep.reading import commandline


def run():
    name = os.path.basename(sys.argv[0]).removeprefix("rodsweep-").replace("-", "_")
    commandline.run(importlib.import_module(f"rodsweep.scripts.{name}").main)
