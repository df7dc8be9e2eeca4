"""The rows of export.py: blocks of a results file as flat columns, one array per column, all of one length.

A row of the level `tasks` is one task x guess x tolerance, of `solves` one solve x guess (a column per tolerance of
what has that axis), of `steps` one step. Every dataset of the level is a column by its name, with those of /timing after
them, so that columns of later versions come along. Sentinels of whole numbers (-1: not reached, not run) and NaN are
empty fields. Blocks have at most BLOCK_ROWS rows of the file, whatever its size.
"""

import h5py
import numpy as np

from rodsweep.reading import measures, texts
from rodsweep.reading.errors import KeyNotFound, not_found
from rodsweep.reading.hdf5 import decoded

LEVELS = ("tasks", "solves", "steps")
BLOCK_ROWS = 1 << 13
COUNTED = ("newton", "step", "rod")                 # whole numbers whose -1 says that the row was never reached
INTERNAL = ("first_step", "first_solve", "first_frame_row", "first_segment_row", "first_system", "first_system_segment",
            "first_system_joint", "state", "checksum", "segments_total")
COMPONENTS = ("x", "y", "z")


class Tidy:
    """Columns of a level. names: all there are; blocks(): chosen columns of complete tasks, as {name: values}."""

    def __init__(self, file, level, tasks, guesses, tolerances):
        self.file, self.level, self.tasks = file, level, np.asarray(tasks)
        self.guesses, self.tolerances = list(guesses), list(tolerances)
        self.datasets = {}
        for folder in (f"/{level}", f"/timing/{level}"):
            for name, item in (file.h5[folder].items() if folder in file.h5 else []):
                if isinstance(item, h5py.Dataset) and item.size and name not in INTERNAL:
                    self.datasets.setdefault(name, f"{folder}/{name}")
        self.shape = {name: self._axes(path) for name, path in self.datasets.items()}
        self.by_guess = bool(file.guesses) and level != "steps" and any("guess" in axes for axes in self.shape.values())
        self.by_tolerance = level == "tasks" and any("tolerance" in axes for axes in self.shape.values())
        self.swept = [name for name in file.swept() if name != "guess"]
        self.names = self._names()

    def _axes(self, path):
        """Names of the axes after the row, from their lengths."""
        lengths = self.file.h5[path].shape[1:]
        known = {(): (), (len(self.file.guesses),): ("guess",),
                 (len(self.file.guesses), len(self.file.tolerances)): ("guess", "tolerance")}
        if self.level == "steps" or lengths not in known:
            return () if not lengths else ("component",) if len(lengths) == 1 and lengths[0] <= 4 else ("other",)
        return known[lengths]

    def _names(self):
        names = ["task"] if self.level != "tasks" else ["task", "outcome"]
        names += ["scene.type"] if "scene.type" in self.file.parameters else []
        names += ["sample", *(name for name in self.swept if name != "scene.type")]
        names += ["guess"] if self.by_guess else []
        names += ["tolerance"] if self.by_tolerance else []
        for name in self.datasets:
            axes = self.shape[name]
            if "other" in axes or name in names:
                continue
            if axes == ("component",):
                count = self.file.h5[self.datasets[name]].shape[1]
                names += [f"{name}_{COMPONENTS[k] if count == 3 else k}" for k in range(count)]
            elif "tolerance" in axes and not self.by_tolerance:
                names += [f"{name}_{self._label(t)}" for t in self.tolerances]
            else:
                names.append(name)
        return names + [name for name in self.file.parameters if name not in names and name != "guess"]

    def default_names(self):
        """All but the parameters that are the same for every task."""
        fixed = {name for name, p in self.file.parameters.items() if name not in self.swept and name != "scene.type"}
        return [name for name in self.names if name not in fixed]

    def _label(self, t):
        return texts.tolerance_label(self.file.tolerances[t])

    def check(self, names):
        for name in names:
            if name not in self.names:
                raise not_found("column", name, self.names)

    def blocks(self, names):
        """Yields {name: array} of the columns `names`, rows in the order of the file."""
        for tasks, rows in self._row_blocks():
            for g, t in self._combinations():
                own = self.file.own_guess[tasks]
                kept = np.ones(len(tasks), dtype=bool) if g is None else (own < 0) | (own == g)
                if g is not None and self.level == "tasks":
                    kept &= measures.has_guesses(self.file)[tasks]
                if not kept.any():
                    continue
                yield {name: self._column(name, tasks[kept], rows, kept, g, t) for name in names}

    def _combinations(self):
        guesses = self.guesses if self.by_guess else [None]
        return [(g, t) for g in guesses for t in (self.tolerances if self.by_tolerance else [None])]

    def _row_blocks(self):
        """(task of every row, {dataset: rows}) with rows that were never reached left out."""
        paths = list(self.datasets.values())
        if self.level == "tasks":
            for begin in range(0, len(self.tasks), BLOCK_ROWS):
                some = self.tasks[begin:begin + BLOCK_ROWS]
                low, high = some.min(), some.max() + 1
                yield some, {path: decoded(self.file.h5[path][low:high][some - low]) for path in paths}
            return
        read = self.file.solve_blocks if self.level == "solves" else self.file.step_blocks
        for owners, starts, rows in read(self.tasks, paths, BLOCK_ROWS):
            count = len(rows[paths[0]])
            tasks = np.repeat(owners, np.diff(np.append(starts, count)))
            reached = self._reached(rows, count)
            if reached.any():
                yield tasks[reached], {path: values[reached] for path, values in rows.items()}

    def _reached(self, rows, count):
        for mark in ("newton", "newton_iterations", "time_s"):
            if f"/{self.level}/{mark}" in rows:
                values = rows[f"/{self.level}/{mark}"]
                return np.isfinite(values) if values.dtype.kind == "f" else values >= 0
        return np.ones(count, dtype=bool)

    def _column(self, name, tasks, rows, kept, g, t):
        """Values of one column; parameters go by the task, datasets by the row."""
        file = self.file
        if name == "task":
            return tasks
        if name in ("sample", "outcome", "own_guess", "point"):
            return getattr(file, name)[tasks]
        if name == "guess":
            return np.full(len(tasks), file.guesses[g])
        if name == "tolerance":
            return np.full(len(tasks), file.tolerances[t])
        if name in file.parameters and name not in self.datasets:
            parameter = file.parameters[name]
            return parameter.values[tasks] if parameter.values.ndim == 1 else np.array(
                [parameter.text(task) for task in tasks])
        base, index = self._source(name)
        values = rows[self.datasets[base]][kept]
        axes = self.shape[base]
        if axes == ("component",):
            return values[:, index]
        if axes == ("guess", "tolerance"):
            return values[:, g, t if index is None else index]
        return values[:, g] if axes == ("guess",) else values

    def _source(self, name):
        """The dataset of a column and the index of its component or tolerance."""
        if name in self.datasets:
            return name, None
        base, _, last = name.rpartition("_")
        if self.shape[base] == ("component",):
            return base, COMPONENTS.index(last) if last in COMPONENTS else int(last)
        return base, next(t for t in self.tolerances if self._label(t) == last)


def text_of(values):
    """Fields of a column: the shortest digits that give the same number, empty for NaN and for -1 of whole numbers."""
    if values.dtype.kind in "iu":
        fields = values.astype(str)
        return np.where(values == -1, "", fields) if values.dtype.kind == "i" else fields
    if values.dtype.kind == "f":
        return np.where(np.isnan(values), "", values.astype(str))
    return values.astype(str)


def conditions(texts):
    """(column, test) of COLUMN=VALUE, COLUMN=A,B or COLUMN=LOW:HIGH; a test takes the column's values to a mask."""
    found = []
    for text in texts:
        column, equals, wanted = text.partition("=")
        if not equals or not wanted:
            raise KeyNotFound(f"--where {text!r}: write COLUMN=VALUE, COLUMN=A,B or COLUMN=LOW:HIGH")
        found.append((column, _test(column, wanted)))
    return found


def _test(column, wanted):
    def number(text, empty):
        try:
            return float(text) if text.strip() else empty
        except ValueError:
            raise KeyNotFound(f"--where {column}={wanted}: {text!r} is not a number, as the column is") from None

    def test(values):
        if values.dtype.kind not in "iuf":
            return np.isin(values.astype(str), [wanted, *texts.split_labels(wanted)])
        if ":" in wanted:
            low, _, high = wanted.partition(":")
            return (values >= number(low, -np.inf)) & (values <= number(high, np.inf))
        return np.any([np.isclose(values, number(part, np.nan), rtol=1e-6) for part in wanted.split(",")], axis=0)

    return test
