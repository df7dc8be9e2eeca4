#!/usr/bin/python3
"""A report of one or several sweeps: one page of HTML that opens in any browser, without network.

First come the results in sentences and a table: which guess saves how many iterations and how much time, how the
direct solve compares, what failed. Charts show any measure over any parameter that the job sweeps, with 95 % bootstrap
intervals over simulations. Then come animations of recorded trajectories, and how the sweep was run. The numbers are
those of summary.py and spatial.py. A sweep may still be running.
"""

import contextlib
import os
import sys

from rodsweep.reading import commandline
from rodsweep.reading.errors import KeyNotFound, SweepFileError, not_found
from rodsweep.reading.sweepfile import ALL_BY, SweepFile
from rodsweep.report import axes, page, sweep
from rodsweep.writing import outputs

EXAMPLES = """examples:
  analysis/report.py results/demo.h5
  analysis/report.py results/*.h5 --skip -o all.html
  analysis/report.py results/demo.h5 --scene helix --x scene.torsion_modulus_pa --tolerance all -o helix.html --force"""
ESTIMATES = 120_000         # per page, about 15 bytes each
ANIMATIONS = 2_000_000      # bytes per page


def arguments():
    made = commandline.parser(__doc__, EXAMPLES, newton=False, files=True)
    made.add_argument("-o", "--output", metavar="FILE", help="page to write (default: NAME.html beside a single file, "
                                                             "report.html beside the first of several)")
    made.add_argument("--x", metavar="KEY", action="append", default=[],
                      help="only this parameter along x; may be repeated (default: all that the job sweeps, as far as "
                           "the page stays small)")
    made.add_argument("--title", metavar="TEXT", help="title of the page")
    made.add_argument("--skip", action="store_true", help="leave out files that are not sweeps, such as models, and "
                                                          "files without a chosen task")
    outputs.add_force(made)
    return made.parse_args()


def main():
    options = arguments()
    path = options.output or default_output(options.files)
    outputs.check(path, options)
    check_axes(options)
    sweeps, room = [], (axes.Budget(ESTIMATES), axes.Budget(ANIMATIONS))
    for left, name in zip(range(len(options.files), 0, -1), options.files):
        try:
            with SweepFile(name) as file:
                sweeps.append(sweep.made(file, options, *(budget.share(left) for budget in room)))
        except (SweepFileError, KeyNotFound) as error:
            if not options.skip:
                raise
            print(f"left out: {error.args[0]}", file=sys.stderr)
    if not sweeps:
        raise KeyNotFound("nothing to report: no file is a sweep with a chosen task")
    text = page.html(sweeps, options.title or ", ".join(one.name for one in sweeps[:3]) +
                     (f" and {len(sweeps) - 3} more" if len(sweeps) > 3 else ""))
    outputs.write(path, text)
    print(path)


def check_axes(options):
    """Raises KeyNotFound if an --x is not a parameter of any file, before results are read."""
    known = {}
    for name in options.files if options.x else []:
        with contextlib.suppress(SweepFileError), SweepFile(name) as file:
            known.update(file.parameters)
    for key in options.x:
        if key not in known:
            raise not_found("parameter", key, known, ALL_BY)


def default_output(files):
    if len(files) == 1:
        return os.path.splitext(files[0])[0] + ".html"
    return os.path.join(os.path.dirname(files[0]), "report.html")


if __name__ == "__main__":
    commandline.run(main)
