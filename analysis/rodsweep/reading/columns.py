"""The columns of a results file: its datasets with a row per task, solve or step, and what the file says about them. So
columns of later versions are included. task_columns.py and tidy.py flatten them.
"""

from typing import NamedTuple

import numpy as np

from rodsweep.reading import constants
from rodsweep.reading.hdf5 import as_text, is_column

FIRST_ROWS = tuple(name for name in constants.PLANNED if name.startswith("first_"))    # of a task in other groups


class Dataset(NamedTuple):
    path: str
    axes: tuple     # after the row: (), ("guess",), ("guess", "tolerance"), ("component",) of at most four, or ("other",)
    unit: str
    meaning: str
    dtype: np.dtype
    planned: bool   # known before a task runs


def datasets(file, folder, rows):
    """{name: Dataset} of those in a group that have this many rows."""
    found = {}
    for name, item in file.h5[folder].items() if folder in file.h5 else ():
        if is_column(item, rows) and item.size:
            unit, meaning = (as_text(item.attrs.get(key, "")) for key in ("unit", "meaning"))
            planned = folder == "/tasks" and name in constants.PLANNED
            found[name] = Dataset(f"{folder}/{name}", _axes(file, folder, item.shape[1:]), unit, meaning, item.dtype, planned)
    return found


def _axes(file, folder, lengths):
    """Names of the axes, derived from their lengths."""
    known = {(len(file.guesses),): ("guess",), (len(file.guesses), len(file.tolerances)): ("guess", "tolerance")}
    if lengths in known and not folder.endswith("/steps"):
        return known[lengths]
    return () if not lengths else ("component",) if len(lengths) == 1 and lengths[0] <= 4 else ("other",)
