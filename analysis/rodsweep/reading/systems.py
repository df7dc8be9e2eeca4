"""The linear systems A x = b in a file of `rodsweep systems`. runner/file/systems_file.hpp has the layout."""

import json
from dataclasses import dataclass

import numpy as np
import scipy.sparse

from rodsweep.reading.errors import SweepFileError
from rodsweep.reading.hdf5 import UNREADABLE, as_text, opened


@dataclass(frozen=True)
class Rod:
    """What all systems of a rod share."""
    row_begin: np.ndarray          # [joints + 1] of A's blocks
    columns: np.ndarray            # [blocks]
    segments: np.ndarray           # [joints, 2] that a joint connects
    compliance_per_j: np.ndarray   # [joints, 6]
    length_m: np.ndarray           # [segments]
    radius_m: np.ndarray           # [segments]
    mass_kg: np.ndarray            # [segments]


@dataclass(frozen=True)
class System:
    """A x = b of one Newton iteration. A is symmetric and positive definite, in 6x6 blocks, one block row per joint. x are
    the increments of the multipliers: stretch and shear (3), bending and twisting (3), in the joint's frame."""
    rod: int
    step: int
    newton: int
    dt_s: float                    # of A: with bdf2 two thirds of the time step
    A: scipy.sparse.bsr_matrix
    b: np.ndarray                  # [6 joints]
    x: np.ndarray                  # [6 joints], the solution that moved the rod
    multipliers: np.ndarray        # [6 joints], before the solve
    position_m: np.ndarray         # [segments, 3], before the solve
    orientation: np.ndarray        # [segments, 4] (w, x, y, z)
    of: Rod

    @property
    def blocks(self):
        """[blocks, 6, 6] of A, by rows."""
        return self.A.data


class Systems:
    """The systems of a file, in the order in which they were solved. Each is read when it is asked for."""

    def __init__(self, path):
        self.path = path
        self.h5 = opened(path, "a file of `rodsweep systems`")
        kind = as_text(self.h5.attrs.get("kind", ""))
        if kind != "systems":
            self.h5.close()
            raise SweepFileError(f"{path} holds no linear systems: `rodsweep systems FILE TASK` writes those of a task")
        try:
            self.rods = {int(name): Rod(*(group[column][:] for column in Rod.__dataclass_fields__))
                         for name, group in self.h5["rods"].items()}
            places = [(step, newton, rod, k) for rod in self.rods
                      for k, (step, newton) in enumerate(zip(self._of(rod, "step")[:], self._of(rod, "newton")[:]))]
        except UNREADABLE as error:
            self.h5.close()
            raise SweepFileError(f"{path} is damaged: {error}") from error
        self._places = sorted(tuple(map(int, place)) for place in places)

    def _of(self, rod, name):
        return self.h5[f"rods/{rod}/{name}"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.h5.close()

    def __len__(self):
        return len(self._places)

    def __repr__(self):
        return f"<rodsweep systems: {len(self)} of {len(self.rods)} rods, {self.path}>"

    def __iter__(self):
        return (self[k] for k in range(len(self)))

    def __getitem__(self, index):
        step, newton, rod, k = self._places[index]
        shared = self.rods[rod]
        size = 6 * (len(shared.row_begin) - 1)
        a = scipy.sparse.bsr_matrix((self._of(rod, "blocks")[k], shared.columns, shared.row_begin), shape=(size, size))
        vectors = (self._of(rod, name)[k].ravel() for name in ("b", "x", "lambda"))
        poses = (self._of(rod, name)[k] for name in ("position_m", "orientation"))
        return System(rod, step, newton, float(self._of(rod, "dt_s")[k]), a, *vectors, *poses, shared)

    def job(self):
        """The parsed job of the task."""
        return json.loads(as_text(self.h5.attrs["job"]))
