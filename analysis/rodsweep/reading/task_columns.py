"""The columns of a results file: its datasets with a row per task, solve or step, and what the file says about them. So
columns of later versions are included. The tasks as flat columns, a value per task, each read when it is needed:

  task, state ("done", "pending"), outcome, message
  scene.segments, scene.gravity_m_s2.x, ...   /tasks/parameters
  sample, point, own_guess (its label), ...   /tasks
  cg_ratio.LABEL[@TOLERANCE], ...             /tasks, of one guess; default tolerance: that of `headline`
  elapsed_s, rank, host, run, ...             /timing/tasks

A missing value (a key that does not apply, a result of a pending task, -1 of integers) is NaN or "". Conditions on the
tasks are conditions on these columns, in every command and in Python.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from rodsweep.reading import conditions, constants, texts
from rodsweep.reading.errors import KeyNotFound, not_found
from rodsweep.reading.hdf5 import as_text, decoded, is_column
from rodsweep.reading.sweepfile import ALL_BY

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


@dataclass(frozen=True)
class TaskColumn:
    name: str
    path: str = ""        # of the dataset, or the name of the parameter; "" of computed columns
    index: tuple = ()     # of the value within a row
    unit: str = ""
    meaning: str = ""
    numeric: bool = True
    whole: bool = False
    swept: bool = False
    parameter: bool = False
    result: bool = False    # not known before the task is done
    guess: str = ""
    by_tolerance: bool = False
    words: tuple = ()       # all texts that it can hold, if known


class TaskColumns:
    """A mapping of names to columns for conditions.parse(), with any tolerance. `names`: of all columns, in order."""

    def __init__(self, file):
        self.file = file
        self.headline = self._headline()
        self.closed_loop = bool((file.own_guess >= 0).any())
        self.columns = {}
        self._add(TaskColumn("task", meaning="number of the task: its row in /tasks", whole=True))
        self._add(TaskColumn("state", meaning='"done" or "pending"', numeric=False, result=True,
                             words=("done", "pending")))
        self._add_datasets("/tasks")
        for _, parameter in sorted(file.parameters.items()):
            self._add_parameter(parameter)
        self._add_datasets("/timing/tasks")
        self.names = list(self.columns)

    def __iter__(self):
        return iter(self.names)

    def __contains__(self, name):
        try:
            return bool(self[name])
        except KeyNotFound:
            return False

    def __getitem__(self, name):
        """The column of a name, which may end in @TOLERANCE. Raises KeyNotFound if there is none."""
        if name in self.columns:
            return self.columns[name]
        base, at, tolerance = name.rpartition("@")
        if at and base in self.columns and self.columns[base].by_tolerance:
            try:
                place = self.file.tolerance_index(float(tolerance))
            except ValueError:
                raise not_found("tolerance", tolerance, self.tolerances()) from None
            column = self.columns[base]
            return replace(column, name=name, index=(*column.index[:-1], place))
        raise not_found("column", name, self.names, ALL_BY)

    def condition(self, text):
        """A condition on a column of this table."""
        return self.checked(conditions.parse(text, self, ALL_BY))

    def checked(self, condition):
        """The condition. Raises KeyNotFound if none of the tasks can meet it, whatever their results are."""
        column = self[condition.column]
        if not column.result:
            conditions.require_met(condition, self.values(column), "task")
        return condition

    def met(self, condition):
        """Mask of the tasks that meet a condition."""
        return condition.met(self.values(self[condition.column]))

    def select(self, wanted):
        """Mask of the tasks that meet all conditions, given as texts. Raises KeyNotFound if there is none."""
        mask = np.ones(self.file.task_count, dtype=bool)
        for text in wanted:
            mask &= self.met(self.condition(text))
        if not mask.any():
            raise KeyNotFound(f"no task meets {'all of ' * (len(wanted) > 1)}{', '.join(wanted)}")
        return mask

    def values(self, column):
        """An array with a value per task."""
        if column.name == "task":
            return np.arange(self.file.task_count)
        if column.name == "state":
            return np.where(self.file.complete, "done", "pending")
        if column.path == "/tasks/outcome":
            return self.file.outcome
        if column.parameter:
            parameter = self.file.parameters[column.path]
            values = parameter.values[(slice(None), *column.index)] if column.index else parameter.flat()
        else:
            values = decoded(self.file.h5[column.path][(slice(None), *column.index)])
        if column.path == "/tasks/own_guess":
            return np.array([self.file.guesses[k] if k >= 0 else "" for k in values], dtype=str)
        missing = conditions.absent(values)
        if column.result:
            missing = missing | ~self.file.complete
        if not column.numeric:
            return np.where(missing, "", values)
        return np.where(missing, np.nan, values) if missing.any() else values

    def tolerances(self):
        return [texts.tolerance_label(value) for value in self.file.tolerances]

    def _headline(self):
        """Index of the tolerance of the timed solves, if all tasks have one and the file has it; else of 1e-2."""
        wanted = 1e-2
        if "solve.tolerance" in self.file.parameters:
            used = np.unique(self.file.parameters["solve.tolerance"].values)
            if len(used) == 1 and np.isclose(self.file.tolerances, used[0], rtol=1e-6, atol=0).any():
                wanted = used[0]
        found = np.flatnonzero(np.isclose(self.file.tolerances, wanted, rtol=1e-6, atol=0))
        return int(found[0]) if len(found) else 0

    def _add(self, column):
        self.columns[column.name] = column

    def _add_datasets(self, group):
        for name, column in datasets(self.file, group, self.file.task_count).items():
            if group != "/tasks" or name not in ("state", "checksum"):
                self._add_dataset(name, column)

    def _add_parameter(self, parameter):
        """A vector is a text, and a number per component."""
        made = TaskColumn(parameter.name, parameter.name, (), without_one(parameter.unit), parameter.meaning,
                          parameter.numeric, parameter.numeric and parameter.values.dtype.kind in "iu",
                          parameter.swept, True)
        self._add(made)
        for k, letter in enumerate("xyz") if parameter.values.shape[1:] == (3,) else ():
            self._add(replace(made, name=f"{made.name}.{letter}", index=(k,), numeric=True))

    def _add_dataset(self, name, column):
        made = TaskColumn(name, column.path, (), without_one(column.unit), column.meaning, column.dtype.kind in "iuf",
                          column.dtype.kind in "iu", result=not column.planned,
                          words=tuple(constants.OUTCOMES) if name == "outcome" else ())
        if name == "own_guess":
            made = replace(made, meaning="the guess that advances the rods; none: another method does", numeric=False,
                           whole=False, words=tuple(self.file.guesses))
        if not column.axes:
            self._add(made)
        elif "guess" in column.axes:
            by_tolerance = "tolerance" in column.axes
            for k, label in enumerate(self.file.guesses):
                self._add(replace(made, name=f"{name}.{label}", index=(k, self.headline) if by_tolerance else (k,),
                                  guess=label, by_tolerance=by_tolerance))


def without_one(unit):
    return "" if unit == "1" else unit
