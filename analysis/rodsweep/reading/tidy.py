"""Flat columns of a results file, block by block, for export.py and the frames of rodsweep.open().

A row of the level `tasks` is one task x guess x tolerance; of `steps`, one step. A row of `solves` is a solve x guess,
with a column per tolerance of datasets that have this axis. Every dataset of the level is a column with its name,
followed by those of /timing, so that columns of later versions are included. `step` of the level `steps` is not in the
file: it follows from the place of the row. -1 of integers (not reached, not run), NaN
and empty texts are missing values. Blocks have at most BLOCK_ROWS rows of the file.
"""

import itertools
from collections import ChainMap
from dataclasses import dataclass

import numpy as np

from rodsweep.reading import conditions, measures, texts
from rodsweep.reading.errors import KeyNotFound, not_found
from rodsweep.reading.hdf5 import decoded
from rodsweep.reading.sweepfile import ROW
from rodsweep.reading.task_columns import FIRST_ROWS, Dataset, TaskColumns, datasets

LEVELS = ("tasks", "solves", "steps")
BLOCK_ROWS = 1 << 13
INTERNAL = ("state", "checksum", *FIRST_ROWS)
COMPONENTS = ("x", "y", "z")
OF_TASKS = ("task", "outcome", "sample", "own_guess", "point")    # loaded for every task
OWN_MEANING = {"guess": "label of the initial guess",
               "tolerance": "residual that CG has to reach, relative to the right-hand side's"}
COUNTED = ("step", "newton", "rod", "newton_iterations")    # integers that every reached row has
# In the message for an unknown name.
ALL_BY = "export.py --list and results.columns() list all, `rodsweep query FILE --columns help` lists those of tasks"
MARKS = ("newton", "newton_iterations", "time_s")    # the first one in the file tells which rows were reached


@dataclass(frozen=True)
class Column:
    """A column's rows: values, or values[index]. Rows and blocks share one array of values, to work on it only once."""
    values: np.ndarray
    index: np.ndarray = None

    def __len__(self):
        return len(self.values if self.index is None else self.index)

    def array(self):
        return self.values if self.index is None else self.values[self.index]

    def at(self, rows, made):
        """The Column of some rows. `made` caches the index for all columns of a block, which mostly share it."""
        if id(self.index) not in made:
            made[id(self.index)] = rows if self.index is None else self.index[rows]
        return Column(self.values, made[id(self.index)])


def mark_of(file, level):
    """The path of the column that tells which rows of a level were reached; None if the file has no rows of it."""
    return next((f"/{level}/{name}" for name in MARKS if file.has(f"/{level}/{name}")), None)


def require_rows(file, level):
    """Raises KeyNotFound if a file has no rows of a level."""
    if level != "tasks" and not mark_of(file, level):
        raise KeyNotFound(f"{file.path} has no rows of {level} (/{level} is empty, for example since record.solves of "
                          "the job is \"summary\")")


class Tidy:
    """Columns of a level, of complete tasks. names: names of all columns; blocks(): their rows."""

    def __init__(self, file, level, tasks, guesses, tolerances):
        self.file, self.level, self.tasks = file, level, np.asarray(tasks)
        self.guesses, self.tolerances = list(guesses), list(tolerances)
        self.labels, self.guessing = np.array(file.guesses, dtype=str), measures.has_guesses(file)
        self.datasets, self.parts, self.whole, self.of_tasks = {}, {}, {}, TaskColumns(file)
        if level == "steps":
            self.datasets["step"] = Dataset(ROW, (), "1", "time step, from 0", np.dtype(np.int64), False)
        mark = mark_of(file, level)
        rows = file.task_count if level == "tasks" else len(file.h5[mark]) if mark else 0
        for folder in (f"/{level}", f"/timing/{level}"):
            for name, column in datasets(file, folder, rows).items():
                if name not in INTERNAL:
                    self.datasets.setdefault(name, column)
        axes = {axis for column in self.datasets.values() for axis in column.axes}
        self.by_guess = "guess" in axes
        self.by_tolerance = level == "tasks" and "tolerance" in axes
        self.swept = [name for name in file.swept() if name != "guess"]
        self.names = self._names()

    def _names(self):
        names = ["task"] if self.level != "tasks" else ["task", "outcome"]
        names += ["scene.type"] if "scene.type" in self.file.parameters else []
        names += ["sample", *(name for name in self.swept if name != "scene.type")]
        names += ["guess"] if self.by_guess else ["own_guess"] if (self.file.own_guess >= 0).any() else []
        names += ["tolerance"] if self.by_tolerance else []
        for name, column in self.datasets.items():
            if "other" in column.axes or name in names:
                continue
            parts = {}    # one column for each, and its index
            if column.axes == ("component",):
                count = self.file.h5[column.path].shape[1]
                parts = {COMPONENTS[k] if count == 3 else k: k for k in range(count)}
            elif "tolerance" in column.axes and not self.by_tolerance:
                parts = {texts.tolerance_label(self.file.tolerances[t]): t for t in self.tolerances}
            self.parts.update({f"{name}_{part}": (column, index) for part, index in parts.items()})
            names += [f"{name}_{part}" for part in parts] or [name]
        return names + [name for name in self.file.parameters if name not in names and name != "guess"]

    def default_names(self):
        """All names except parameters that are the same for every task."""
        fixed = set(self.file.parameters) - {*self.swept, "scene.type", "guess"}
        return [name for name in self.names if name not in fixed]

    def check(self, names):
        for name in names:
            if name not in self.names:
                raise not_found("column", name, self.names, ALL_BY)

    def dtype(self, name):
        """The type of a column's values."""
        if not self._is_measured(name):
            return self.shared(name).dtype
        stored = self._source(name)[0].dtype
        return stored if stored.kind in "iuf" else np.dtype(str)

    def about(self, name):
        """(unit, meaning) of a column, from the file."""
        if name in OWN_MEANING:
            return "", OWN_MEANING[name]
        if not self._is_measured(name) and name in self.file.parameters:
            return self.file.parameters[name].unit, self.file.parameters[name].meaning
        if name in OF_TASKS:
            return self.of_tasks[name].unit, self.of_tasks[name].meaning
        column, index = self._source(name)
        part = "" if index is None else name.rpartition("_")[2]
        return column.unit, "; ".join(filter(None, [column.meaning, part]))

    def condition(self, text):
        """Parses a condition on a column of these rows or of their tasks; see conditions.py."""
        of_rows = {name: conditions.Column(self.dtype(name).kind in "iuf",
                                           tuple(self.file.guesses) if name == "guess" else ())
                   for name in self.names if self._in_rows(name) or name in conditions.OF_ROWS}
        made = conditions.parse(text, ChainMap(of_rows, self.of_tasks), ALL_BY)
        if made.column not in of_rows:
            return self.of_tasks.checked(made)
        if made.column == "guess":
            conditions.require_met(made, self.labels[self.guesses], "guess")
        elif made.column == "tolerance":
            conditions.require_met(made, self.file.tolerances[self.tolerances], "tolerance")
        return made

    def blocks(self, names, where=()):
        """Yields {name: Column} with the rows that meet all conditions, in the file's order."""
        tasks, guesses, tolerances, conditions_left = self.narrowed(where)
        needed = list(dict.fromkeys([*names, *(condition.column for condition in conditions_left)]))
        guesses = guesses if self.by_guess else [None]
        tolerances = tolerances if self.by_tolerance else [None]
        for some, rows in self._row_blocks(tasks, self._paths(needed)):
            parts = {}
            for g, t in itertools.product(guesses, tolerances):
                kept = self._belongs(some, g)
                block = {name: self._column(name, some, rows, parts, g, t) for name in needed}
                for condition in conditions_left:
                    kept &= condition.met(block[condition.column].values)
                if kept.all():
                    yield {name: block[name] for name in names}
                elif kept.any():
                    rows_kept, made = np.flatnonzero(kept), {}
                    yield {name: block[name].at(rows_kept, made) for name in names}

    def arrays(self, names, where=()):
        """(task of every row, indices of guesses, of tolerances, {dataset: rows}) of whole datasets with their axes.
        Raises KeyNotFound for a condition on a column with several values in a row."""
        tasks, guesses, tolerances, conditions_left = self.narrowed(where)
        for condition in conditions_left:
            if condition.column not in self.datasets or self.datasets[condition.column].axes:
                raise KeyNotFound(f"{condition.text}: {condition.column} has a value for every guess or tolerance, so "
                                  "it cannot choose rows; use where() of the dataset")
        needed = list(dict.fromkeys([*names, *(condition.column for condition in conditions_left)]))
        owners, found, paths = [], {name: [] for name in names}, self._paths(needed)
        nothing = {path: np.empty(0, np.int64) if path == ROW else decoded(self.file.h5[path][:0]) for path in paths}
        for some, rows in itertools.chain([(tasks[:0], nothing)], self._row_blocks(tasks, paths)):
            kept = np.ones(len(some), dtype=bool)
            for condition in conditions_left:
                kept &= condition.met(rows[self.datasets[condition.column].path])
            owners.append(some[kept])
            for name in names:
                values, axes = rows[self.datasets[name].path][kept], self.datasets[name].axes
                values = values[:, guesses] if "guess" in axes else values
                found[name].append(values[:, :, tolerances] if "tolerance" in axes else values)
        whole = {name: np.concatenate(parts) for name, parts in found.items()}
        return np.concatenate(owners), guesses, tolerances, whole

    def narrowed(self, where):
        """The tasks, guesses and tolerances that meet the conditions, and the remaining conditions, which are on
        rows."""
        tasks, guesses, tolerances, left = self.tasks, self.guesses, self.tolerances, []
        for condition in where:
            name = condition.column
            if name == "guess":
                guesses = [g for g in guesses if condition.met(self.labels)[g]]
            elif name == "tolerance":
                tolerances = [t for t in tolerances if condition.met(self.file.tolerances)[t]]
            elif self._in_rows(name):
                left.append(condition)
            else:
                tasks = tasks[self.of_tasks.met(condition)[tasks]]
        if self.by_guess and not guesses or self.by_tolerance and not tolerances:
            tasks = tasks[:0]
        return tasks, guesses, tolerances, left

    def _belongs(self, tasks, g):
        """Mask of the rows with a guess: in a closed loop each task has only its own."""
        if g is None:
            return np.ones(len(tasks), dtype=bool)
        own = self.file.own_guess[tasks]
        mask = (own < 0) | (own == g)
        return mask & self.guessing[tasks] if self.level == "tasks" else mask

    def _paths(self, names):
        return list(dict.fromkeys(self._source(name)[0].path for name in names if self._is_measured(name)))

    def _row_blocks(self, chosen, paths):
        """Yields (task of every row, {dataset: rows}) without rows that were never reached."""
        if self.level == "tasks":
            for begin in range(0, len(chosen), BLOCK_ROWS):
                some = chosen[begin:begin + BLOCK_ROWS]
                low, high = some.min(), some.max() + 1
                yield some, {path: decoded(self.file.h5[path][low:high][some - low]) for path in paths}
            return
        read = self.file.solve_blocks if self.level == "solves" else self.file.step_blocks
        mark = mark_of(self.file, self.level)
        for owners, starts, rows in read(chosen, list(dict.fromkeys([*paths, mark])), BLOCK_ROWS):
            tasks = np.repeat(owners, np.diff(np.append(starts, len(rows[mark]))))
            if ROW in rows:    # the step
                rows[ROW] = rows[ROW] - self.file.first_step[tasks]
            reached = np.isfinite(rows[mark]) if rows[mark].dtype.kind == "f" else rows[mark] >= 0
            if reached.all():
                yield tasks, rows
            elif reached.any():
                yield tasks[reached], {path: values[reached] for path, values in rows.items()}

    def shared(self, name):
        """The array of a column's values for all blocks; None if every block has its own."""
        if name in ("guess", "tolerance"):
            return self.labels if name == "guess" else self.file.tolerances
        return None if self._is_measured(name) else self._of_tasks(name)

    def _is_measured(self, name):
        """Whether a column is read in blocks; others depend only on the task, the guess or the tolerance."""
        return name not in (*OF_TASKS, "guess", "tolerance") and (name in self.datasets or
                                                                  name not in self.file.parameters)

    def _in_rows(self, name):
        """Whether a column may differ between the rows of a task."""
        return name in self.names and self._is_measured(name) and (
            self.level != "tasks" or bool(self._source(name)[0].axes))

    def _column(self, name, tasks, rows, parts, g, t):
        """The Column of a name. `parts` caches a block's columns, so that guesses share an array if it is equal for
        them."""
        if not self._is_measured(name):
            index = {"guess": g, "tolerance": t}
            return Column(self.shared(name), np.full(len(tasks), index[name]) if name in index else tasks)
        column, index = self._source(name)
        axes = column.axes
        where = () if not axes else (index,) if axes == ("component",) else \
            (g,) if axes == ("guess",) else (g, t if index is None else index)
        if (name, where) not in parts:
            parts[name, where] = rows[column.path][(slice(None), *where)]
        return Column(parts[name, where])

    def _of_tasks(self, name):
        """A value for every task of the file, in a cached array."""
        if name not in self.whole:
            self.whole[name] = self.of_tasks.values(self.of_tasks[name]) if name in OF_TASKS else \
                self.file.parameters[name].flat()
        return self.whole[name]

    def _source(self, name):
        """The Dataset of a column and the index of its component or tolerance."""
        return self.parts[name] if name in self.parts else (self.datasets[name], None)
