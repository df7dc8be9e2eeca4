"""Opens the program's HDF5 files and decodes their texts. Raises SweepFileError if a file cannot be opened."""

import os
import re

import h5py
import numpy as np

from rodsweep.reading.errors import SweepFileError

PROGRAM = "rodsweep"
CONTROL = re.compile("[\\x00-\\x08\\x0b-\\x1f\\x7f-\\x9f]")
UNREADABLE = (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError)  # exceptions from bad bytes


def opened(path, what):
    """The h5py.File of a path; `what` describes the expected file in messages."""
    if not os.path.exists(path):
        raise SweepFileError(f"{path}: file not found")
    if os.path.isdir(path):
        raise SweepFileError(f"{path} is a folder; give {what}")
    try:
        return h5py.File(path, "r")
    except OSError as error:
        if not os.access(path, os.R_OK):
            raise SweepFileError(f"{path}: no permission to read it") from error
        raise SweepFileError(f"{path} is " + (
            "damaged or incomplete; use a copy of it, or make it again" if h5py.is_hdf5(path) else
            "not an HDF5 file; give a file written by `rodsweep run`")) from error


def require_version(h5, path, version):
    """Raises SweepFileError for a file of another program, or of another version of ours."""
    program = as_text(h5.attrs.get("program", ""))
    if program != PROGRAM:
        found = f"its root attribute `program` is {program!r}" if program else "it has no root attribute `program`"
        raise SweepFileError(f"{path} is an HDF5 file, but not one of {PROGRAM}: {found}")
    found = int(h5.attrs.get("schema_version", 0))
    if found != version:
        raise SweepFileError(f"{path} has schema version {found}, these scripts read {version}; "
                             "use the analysis folder of the rodsweep that wrote it")


def is_column(item, rows):
    """Whether an object in a group of columns is one: a user may keep data of another length there."""
    return isinstance(item, h5py.Dataset) and item.shape[:1] == (rows,)


def as_text(value):
    return value.decode("utf-8", "replace").rstrip("\0") if isinstance(value, bytes) else str(value)


def printable(text):
    """Control characters other than newline and tab as "\\x1b" and so on, since a terminal would obey them; they can
    come from a plug-in's message or a label."""
    return text if text.isprintable() else CONTROL.sub(lambda found: f"\\x{ord(found[0]):02x}", text)


def decoded(values):
    """Fixed or variable strings of HDF5 as an array of printable str; other types unchanged."""
    if values.dtype.kind in "SO":
        return np.array([printable(as_text(v)) for v in values.ravel()], dtype=str).reshape(values.shape)
    return values
