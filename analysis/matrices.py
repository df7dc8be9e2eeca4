#!/usr/bin/python3
"""Linear systems of a simulation for other programs, from a file of `rodsweep systems`.

  matrix-market   NAME.mtx, NAME_b.mtx, NAME_x.mtx
  petsc           NAME.petsc: A, b and x, for MatLoad and VecLoad
  npz             NAME.npz: A in blocks (scipy.sparse.bsr_matrix), b, x, and the rod's state

NAME is step-STEP_newton-ITERATION_rod-ROD. x is the solution that moved the rod.
"""

import os

from rodsweep.reading import commandline
from rodsweep.reading.systems import Systems
from rodsweep.writing import matrices, outputs

EXAMPLES = """examples:
  rodsweep systems results/demo.h5 12 --first             # results/demo-systems-12.h5
  analysis/matrices.py results/demo-systems-12.h5 --format petsc -o systems"""


def arguments():
    made = commandline.plain_parser(__doc__, EXAMPLES)
    made.add_argument("file", metavar="FILE", help="file of `rodsweep systems`")
    made.add_argument("--format", choices=matrices.FORMATS, default="matrix-market", help="default: matrix-market")
    made.add_argument("-o", "--output", metavar="FOLDER", required=True, help="folder for the files")
    outputs.add_force(made)
    return made.parse_args()


def main():
    options = arguments()
    ending, write = matrices.FORMATS[options.format]
    with Systems(options.file) as systems:
        for system in systems:
            stem = os.path.join(options.output, f"step-{system.step}_newton-{system.newton}_rod-{system.rod}")
            outputs.check(stem + ending, options)
            print("\n".join(write(system, stem)))


if __name__ == "__main__":
    commandline.run(main)
