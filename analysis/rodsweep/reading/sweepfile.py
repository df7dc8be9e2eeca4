"""Reads rodsweep results files (HDF5, schema version 2; layout in runner/file/columns.cpp).

A SweepFile has the tasks of a sweep, their parameters and the axes of guesses and tolerances. /tasks/state masks all
results: rows of incomplete tasks are never returned, since unwritten bytes look like perfect results. Rows of /solves,
/steps and /timing come in blocks of bounded size. Datasets that a job did not request may be empty or absent. Raises
SweepFileError if a file is missing, foreign or damaged. Raises KeyNotFound if it does not have a requested parameter,
guess or tolerance.
"""

import json
import os
import warnings

import h5py
import numpy as np

from rodsweep.reading.constants import SCHEMA_VERSION
from rodsweep.reading.errors import IgnoredData, SweepFileError, listed, not_found
from rodsweep.reading.hdf5 import UNREADABLE, as_text, decoded, is_column, opened, require_version
from rodsweep.reading.parameters import Parameter

BLOCK_ROWS = 1 << 17
ROW = "row"    # in blocks of rows, a column of their numbers
ALL_BY = "rodsweep query FILE --columns help lists all"    # in the message for an unknown column of the tasks
LOADED = ("point", "sample", "own_guess", "first_step", "steps", "first_solve", "solves")    # of /tasks, as attributes


class SweepFile:
    """Use as `with SweepFile(path) as file:`. Task numbers index all per-task columns."""

    def __init__(self, path):
        self.path = os.fspath(path)
        self.h5 = opened(self.path, "a results file (results/NAME.h5)")
        try:
            self._open()
        except SweepFileError:
            self.h5.close()
            raise
        except UNREADABLE as error:
            self.h5.close()
            raise SweepFileError(f"{self.path} is damaged: {error}") from error

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.h5.close()

    def _open(self):
        require_version(self.h5, self.path, SCHEMA_VERSION)
        if not self.has("/tasks/state"):
            kind = as_text(self.h5.attrs.get("kind", ""))
            raise SweepFileError(f"{self.path} is a rodsweep file{f' of kind {kind}' if kind else ''} "
                                 "without tasks (/tasks/state): not the results of a sweep")
        states = self.h5["/tasks/state"][:]
        if (states > 1).any():
            task = int(np.argmax(states > 1))
            raise SweepFileError(f"{self.path} is damaged: /tasks/state of task {task} is {states[task]}; must be 0 or 1. Run "
                                 "its job with --resume to verify all tasks and repeat damaged ones")
        self.complete = states == 1
        self.task_count = len(self.complete)
        self.outcome = np.full(self.task_count, "pending", dtype="U32")
        self.outcome[self.complete] = decoded(self._required("/tasks/outcome")[:])[self.complete]
        self.ok = self.complete & (self.outcome == "ok")
        for name in LOADED:
            setattr(self, name, self._required(f"/tasks/{name}")[:])
        self.guesses = [str(g) for g in decoded(self.h5["/axes/guess"][:])] if self.has("/axes/guess") else []
        self.tolerances = self.h5["/axes/tolerance"][:] if self.has("/axes/tolerance") else np.empty(0)
        self.zero = self.guesses.index("zero") if "zero" in self.guesses else None
        self.parameters = self._read_parameters()
        ignored = self._ignored()
        if ignored:
            warnings.warn(f"{self.path}: ignored {listed(ignored)}: not a row per task, solve or step", IgnoredData)

    def _required(self, path):
        if path not in self.h5:
            raise SweepFileError(f"{self.path} is damaged or incomplete: {path} is missing")
        return self.h5[path]

    def _read_parameters(self):
        parameters = {}

        def add(name, item):
            if is_column(item, self.task_count):
                key = name.replace("/", ".")
                parameters[key] = Parameter(key, as_text(item.attrs.get("unit", "")),
                                            as_text(item.attrs.get("meaning", "")),
                                            bool(item.attrs.get("swept", False)), decoded(item[:]))

        if "/tasks/parameters" in self.h5:
            self.h5["/tasks/parameters"].visititems(add)
        return parameters

    def _ignored(self):
        """Paths in the groups of columns that are not columns: a user may keep other data there."""
        found = []
        for level, rows in (("tasks", self.task_count), ("solves", self.solves.sum()), ("steps", self.steps.sum())):
            for group in (f"/{level}", f"/timing/{level}"):
                def add(name, item, group=group, sizes=((rows,), (0,))):    # 0: not recorded
                    if isinstance(item, h5py.Dataset) and item.shape[:1] not in sizes:
                        found.append(f"{group}/{name}")

                if group in self.h5:
                    self.h5[group].visititems(add)
        return found

    def has(self, path):
        """Whether a dataset exists and is not empty."""
        return path in self.h5 and isinstance(self.h5[path], h5py.Dataset) and self.h5[path].size > 0

    def parameter(self, name):
        if name not in self.parameters:
            raise not_found("parameter", name, self.parameters, ALL_BY)
        return self.parameters[name]

    def values(self, name, otherwise):
        """A parameter's value for every task; `otherwise` if the file does not have it."""
        return self.parameters[name].values if name in self.parameters else np.full(self.task_count, otherwise)

    def swept(self):
        """Names of the parameters that vary over the job."""
        return [p.name for p in self.parameters.values() if p.swept]

    def scene_types(self):
        """The scene type of every task; "scene" if the file does not have it."""
        if "scene.type" in self.parameters:
            return self.parameters["scene.type"].values
        return np.full(self.task_count, "scene")

    def guess_index(self, label):
        if label not in self.guesses:
            raise not_found("guess", label, self.guesses)
        return self.guesses.index(label)

    def tolerance_index(self, value):
        match = np.flatnonzero(np.isclose(self.tolerances, value, rtol=1e-6, atol=0))
        if not len(match):
            raise not_found("tolerance", f"{value:g}", [f"{t:g}" for t in self.tolerances])
        return int(match[0])

    def results(self, name, tasks):
        """/tasks/<name> for task numbers that must be complete. None if the file does not have the column."""
        path = f"/tasks/{name}"
        tasks = np.asarray(tasks, dtype=np.int64)
        if not self.complete[tasks].all():
            raise ValueError(f"{path} was asked for tasks that are not complete")
        return decoded(self.h5[path][:])[tasks] if self.has(path) else None

    def runs(self):
        """One dictionary per start of the runner (rows of /runs that were used)."""
        if "/runs" not in self.h5:
            return []
        columns = {name: decoded(item[:]) for name, item in self.h5["/runs"].items() if isinstance(item, h5py.Dataset)}
        begins = columns.get("begin", np.empty(0, dtype=str))
        return [{name: values[row] for name, values in columns.items() if row < len(values)}
                for row in np.flatnonzero(begins != "")]

    def oversubscribed(self, tasks):
        """Whether any of these tasks was timed in a run with more ranks than cores."""
        runs = self.runs()
        marked = [bool(run.get("oversubscribed", 0)) for run in runs]
        numbers = self.h5["/timing/tasks/run"][:][tasks] if self.has("/timing/tasks/run") else None
        if numbers is None:
            return any(marked)
        return any(0 <= n < len(marked) and marked[n] for n in set(numbers.tolist()))

    def job_text(self):
        """The job as it was given, in bytes; empty if the file does not have it."""
        if "/job/text" not in self.h5:
            return b""
        text = np.asarray(self.h5["/job/text"][()])    # one string, or an array of characters or of bytes
        return text.tobytes().rstrip(b"\0")

    def job(self):
        """The parsed job; empty if it cannot be parsed."""
        try:
            parsed = json.loads(self.job_text().decode("utf-8-sig", "replace"))
        except ValueError:
            return {}
        return parsed if isinstance(parsed, dict) else {}

    def rows(self, path, task):
        """The rows of a complete task in a dataset of solves or steps."""
        first, count = (self.first_step, self.steps) if "/steps/" in path else (self.first_solve, self.solves)
        return self.h5[path][first[task]:first[task] + count[task]]

    def solve_blocks(self, tasks, columns, limit=BLOCK_ROWS):
        """Yields (tasks of the block, start of each within it, {column: rows}) over the tasks' rows of /solves."""
        return self._blocks(tasks, self.first_solve, self.solves, columns, limit)

    def step_blocks(self, tasks, columns, limit=BLOCK_ROWS):
        """The same over rows of /steps. A task longer than `limit` comes in several blocks."""
        return self._blocks(tasks, self.first_step, self.steps, columns, limit)

    def _blocks(self, tasks, first, count, columns, limit):
        tasks = np.asarray(tasks, dtype=np.int64)
        if not self.complete[tasks].all():
            raise ValueError("rows were asked for tasks that are not complete")
        tasks = tasks[np.argsort(first[tasks], kind="stable")]
        owners, starts, begin, end = [], [], 0, 0
        for task in tasks[count[tasks] > 0]:
            row, last = int(first[task]), int(first[task] + count[task])
            while row < last:
                if owners and (row != end or end - begin >= limit):
                    yield self._block(owners, starts, begin, end, columns)
                    owners, starts = [], []
                if not owners:
                    begin = end = row
                take = min(last - row, limit - (end - begin))
                owners.append(int(task))
                starts.append(row - begin)
                row += take
                end = row
        if owners:
            yield self._block(owners, starts, begin, end, columns)

    def _block(self, owners, starts, begin, end, columns):
        found = {path: np.arange(begin, end) if path == ROW else self.h5[path][begin:end] for path in columns}
        return np.array(owners), np.array(starts), found
