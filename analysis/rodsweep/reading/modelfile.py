"""Reads model files (HDF5, schema version 2; layout in runner/training/model_file.hpp)."""

import json
import os
from dataclasses import dataclass

import numpy as np

from rodsweep.reading.errors import SweepFileError
from rodsweep.reading.hdf5 import UNREADABLE, as_text, opened, require_version

SCHEMA_VERSION = 2


@dataclass(frozen=True)
class Training:
    """Training history and CG ratios of a model. Rows are epochs, columns of ratios are tolerances."""
    path: str
    name: str
    ended: bool
    tolerances: np.ndarray
    training_loss: np.ndarray
    validation_loss: np.ndarray
    rate: np.ndarray
    cg_ratio: np.ndarray        # [epoch, tolerance], NaN where it was not measured
    best_epoch: int             # the epoch of the model's weights, from 1; 0: none yet
    kept_ratio: np.ndarray      # [tolerance], of the model; NaN until the training has ended
    base_ratio: np.ndarray      # of its base guess alone
    simulations: int            # number of validation simulations for the ratios
    seconds: float              # wall time
    processor_seconds: float    # of all ranks; NaN if an earlier version trained it
    scenes: dict                # {type of scene: (kept_ratio, base_ratio)}, if there are several
    job: dict                   # as it was written
    network: dict               # settings, with defaults
    learned_from: int           # number of training simulations
    parameters: int

    @property
    def epochs(self):
        return np.arange(1, len(self.training_loss) + 1)

    @property
    def best_loss(self):
        return self.validation_loss[self.best_epoch - 1]


def read(path):
    """The training in a model file, ended or running. Raises SweepFileError."""
    with opened(path, "a model file") as h5:
        try:
            require_version(h5, path, SCHEMA_VERSION)
            kind = as_text(h5.attrs.get("kind", "sweep"))
            if kind != "model":
                raise SweepFileError(f"{path} holds the results of a {kind}, not a model: give the file of a job of kind "
                                     '"train"')
            training = h5["training"]
            found = Training(os.fspath(path), as_text(h5["job"].attrs["name"]), as_text(training.attrs["ending"]) != "none",
                             h5["axes/tolerance"][:], training["training_loss"][:], training["validation_loss"][:],
                             training["rate"][:], training["cg_ratio"][:], int(training.attrs["best_epoch"]),
                             h5["validation/cg_ratio"][:], h5["validation/base_cg_ratio"][:],
                             int(h5["validation"].attrs["simulations"]), float(h5["timing/epoch_s"][:].sum()),
                             _sum(h5, "timing/epoch_processor_s"),
                             _scenes(h5["validation"]), json.loads(as_text(h5["job/text"][0])),
                             json.loads(as_text(h5["model/settings"][0])), int(h5["data"].attrs["training_simulations"]),
                             sum(weights.size for weights in h5["model/weights"].values()))
        except UNREADABLE as error:
            raise SweepFileError(f"{path} is damaged: {error}") from error
    if not len(found.training_loss):
        raise SweepFileError(f"{path} has nothing to show yet: no epoch has ended")
    return found


def _sum(h5, path):
    return float(h5[path][:].sum()) if path in h5 else float("nan")


def _scenes(validation):
    if "scenes" not in validation:
        return {}
    of = validation["scenes"]
    return dict(zip(map(as_text, of["type"][:]), zip(of["cg_ratio"][:], of["base_cg_ratio"][:])))
