"""Two sweeps, task by task: common tasks, values that differ, CG ratios and times.

Two tasks are the same if everything that their results depend on is equal: seed, sample, every key that applies to
them, and in a closed loop the guess. Parameters of a guess count if both jobs have that guess. With by="parameters",
the seed and keys that neither job varies do not count. Two guesses are the same if their label and their entry in the
job are equal; with by="parameters" the label is enough. Models and data sets are identified by their path in the job.
"""

import json
import re
from dataclasses import dataclass

import h5py
import numpy as np

from rodsweep.reading import constants, intervals, unconverged
from rodsweep.reading.hdf5 import decoded

BY = ("everything", "parameters")
BLOCK_ROWS = 1 << 16
# Group: the columns of /tasks with a task's first row and its number of rows.
PLACES = {"/steps": ("first_step", "steps"), "/solves": ("first_solve", "solves"), "/systems": ("first_system", "systems"),
          "/systems/segments": ("first_system_segment", "system_segments"),
          "/systems/joints": ("first_system_joint", "system_joints")}
NOT_MEASURED = {f"/tasks/{name}" for name in ("state", "checksum", "message", "outcome", *constants.PLANNED)}
FRAMES = ("/trajectories/position_m", "/trajectories/orientation")
IGNORED_KEYS = ("name", "description", "$schema")
SWEEPS = {"grid", "zip", "uniform", "log_uniform", "integer"}


@dataclass
class Pairs:
    """Tasks in both files: a[i] of one is b[i] of the other. Its guess g is guess guesses[i][g] there, -1 for none."""
    a: np.ndarray
    b: np.ndarray
    guesses: np.ndarray
    only_a: int
    only_b: int


@dataclass
class ColumnDifference:
    path: str
    tasks: int = 0
    values: int = 0
    largest: float = 0.0    # infinite if a value is missing in one
    task: int = -1          # of A, with the largest difference


def key_differences(one, other):
    """[(key, value in one, value in the other)], None if a job does not have the key."""
    jobs = [_flat({key: value for key, value in file.job().items() if key not in IGNORED_KEYS}) for file in (one, other)]
    return [(key, jobs[0].get(key), jobs[1].get(key)) for key in dict.fromkeys([*jobs[0], *jobs[1]])
            if jobs[0].get(key) != jobs[1].get(key)]


def _flat(value, path=""):
    """{"scene.segments": ...}: objects except sweeps are flattened; each guess has its own key."""
    if path == "guesses" and isinstance(value, list):
        return {f"guesses.{_text(guess)}": guess for guess in value}
    if isinstance(value, dict) and not (len(value) == 1 and set(value) <= SWEEPS):
        found = {}
        for key, inner in value.items():
            found |= _flat(inner, f"{path}.{key}" if path else key)
        return found
    return {path: value}


def _text(value):
    return value if isinstance(value, str) else json.dumps(value)


def match(one, other, by):
    """The Pairs of two files."""
    keys = [_identities(file, by, one, other) for file in (one, other)]
    places = {}
    for task, key in enumerate(keys[1]):
        places.setdefault(key, []).append(task)
    a, b = [], []
    for task, key in enumerate(keys[0]):
        if places.get(key):
            a.append(task)
            b.append(places[key].pop(0))
    there = {key: place for place, key in enumerate(_guess_keys(other, by))}
    shared = np.array([there.get(key, -1) for key in _guess_keys(one, by)], dtype=int)
    guesses = np.tile(shared, (len(a), 1)) if len(shared) else np.empty((len(a), 0), dtype=int)
    for row, (i, k) in enumerate(zip(a, b)):
        if one.own_guess[i] >= 0:    # closed loop: only its own guess
            guesses[row] = -1
            guesses[row, one.own_guess[i]] = other.own_guess[k]
    return Pairs(np.array(a, dtype=int), np.array(b, dtype=int), guesses, one.task_count - len(a),
                 other.task_count - len(b))


def _identities(file, by, one, other):
    """A text for every task, equal if the tasks are the same."""
    if by == "parameters":
        names = sorted({name for one_of in (one, other) for name in one_of.swept()})
        head = ""
    else:
        names = sorted({*one.parameters, *other.parameters})
        head = f"{file.job().get('seed')} "
    guesses, shared = _guess_keys(file, by), {*_guess_keys(one, by)} & {*_guess_keys(other, by)}
    parts = [[f"{head}{sample} {guesses[own] if own >= 0 else ''}"] for sample, own in zip(file.sample, file.own_guess)]
    for name in names:
        parameter = file.parameters.get(name)
        if parameter is None:
            continue
        guess, key = _of_guess(name)
        if guess is not None:
            key = guesses[guess] + key
        for part, own, value, applies in zip(parts, file.own_guess, parameter.values.tolist(), parameter.applies()):
            if applies and (guess in (None, own) or (own < 0 and guesses[guess] in shared)):
                part.append(f"{key}={value!r}")
    return ["\n".join(sorted(part)) for part in parts]


def _of_guess(name):
    """(index of the guess that a parameter belongs to, None without one; its name without that index)."""
    found = re.fullmatch(r"guesses\[(\d+)\](.*)", name)
    return (int(found.group(1)), found.group(2)) if found else (None, name)


def _guess_keys(file, by):
    """Identity of each guess: its label and, unless by="parameters", its entry in the job's list of guesses, if any."""
    listed = file.job().get("guesses")
    if by == "parameters" or not isinstance(listed, list) or len(listed) != len(file.guesses):
        return file.guesses
    return [f"{label} {json.dumps(entry, sort_keys=True)}" for label, entry in zip(file.guesses, listed)]


class Comparison:
    """compared: number of pairs done in both; columns: {path: ColumnDifference}; differing: {index of the pair:
    paths}; left_out: paths that are missing in one file, have another shape or are of other times.
    damaged: tasks of A whose values contradict a checksum, in A or B: those with equal checksums and other values, and, of
    equal jobs, those with other checksums or row counts and equal values. A task's number is part of its checksum."""

    def __init__(self, one, other, pairs):
        self.one, self.other = one, other
        both = one.complete[pairs.a] & other.complete[pairs.b]
        self.pending = int((~both).sum())
        self.a, self.b, self.guesses = pairs.a[both], pairs.b[both], pairs.guesses[both]
        self.compared = len(self.a)
        self.columns, self.differing, self.left_out = {}, {}, []
        for place in np.flatnonzero(one.outcome[self.a] != other.outcome[self.b]):
            self.differing[int(place)] = []
        for path in _datasets(one) | _datasets(other):
            self._compare(path)
        self.differing = dict(sorted(self.differing.items()))
        self.damaged = self._damaged()

    def _damaged(self):
        sums = [file.h5["/tasks/checksum"][:] if file.has("/tasks/checksum") else None for file in (self.one, self.other)]
        if any(of is None for of in sums):
            return []
        whole = not (key_differences(self.one, self.other) or _datasets(self.one).keys() ^ _datasets(self.other).keys())
        found = []
        for place in np.flatnonzero(self.a == self.b):
            task = int(self.a[place])
            equal = sums[0][task] == sums[1][task]
            differs = int(place) in self.differing or (whole and self._rows(self.one, task) != self._rows(self.other, task))
            if (equal and differs) or (whole and not equal and not differs):
                found.append(task)
        return found

    @staticmethod
    def _rows(file, task):
        return [int(file.h5[f"/tasks/{count}"][task]) for _, count in PLACES.values() if f"/tasks/{count}" in file.h5]

    def ratios(self):
        """Yields (guess's label, tolerance, Estimates of the ratio in one, in the other and of the difference)."""
        ok = self._both_ok()
        found = [file.results("cg_ratio", tasks) for file, tasks in ((self.one, self.a[ok]), (self.other, self.b[ok]))]
        if not ok.any() or found[0] is None or found[1] is None or found[0].shape[2] != found[1].shape[2]:
            return
        places = self.guesses[ok]
        there = np.take_along_axis(found[1], np.maximum(places, 0)[:, :, None], axis=1)
        valid = (places >= 0)[:, :, None] & np.isfinite(found[0]) & np.isfinite(there)
        here, there = np.where(valid, found[0], np.nan), np.where(valid, there, np.nan)
        draws = self.one.sample[self.a[ok]]
        estimates = [intervals.mean(values, draws) for values in (here, there, there - here)]
        for g, label in enumerate(self.one.guesses):
            for t, tolerance in enumerate(self.one.tolerances):
                if label != "zero" and estimates[2].count[g, t] > 0:
                    yield label, float(tolerance), *(estimate[g, t] for estimate in estimates)

    def times(self):
        """Yields (what, median of one, median of the other, median of the tasks' quotients, number of tasks)."""
        ok = self._both_ok()
        a, b = self.a[ok], self.b[ok]
        elapsed = "/timing/tasks/elapsed_s"
        columns = [("whole task", self._per_task(self.one, elapsed, a), self._per_task(self.other, elapsed, b)),
                   ("direct solve", *(self._of_solves(file, tasks, ["direct_s"])
                                      for file, tasks in ((self.one, a), (self.other, b))))]
        for g, label in enumerate(self.one.guesses):
            places = self.guesses[ok][:, g] if len(a) else np.empty(0, dtype=int)
            if (places >= 0).any():
                columns.append((f"guess and CG, {label}", self._of_guess(self.one, a, g),
                                self._of_guess(self.other, b, int(places.max()))))
        for what, here, there in columns:
            with np.errstate(invalid="ignore"):
                both = (here > 0) & (there > 0)
            if both.any():
                yield (what, float(np.median(here[both])), float(np.median(there[both])),
                       float(np.median(there[both] / here[both])), int(both.sum()))

    def _both_ok(self):
        return self.one.ok[self.a] & self.other.ok[self.b]

    @staticmethod
    def _per_task(file, path, tasks):
        return file.h5[path][:][tasks].astype(float) if file.has(path) else np.full(len(tasks), np.nan)

    def _of_guess(self, file, tasks, guess):
        """Without tasks in which a solve missed the tolerance."""
        found = self._of_solves(file, tasks, ["guess_s", "cg_s"], guess)
        return np.where(unconverged.solves(file, "missed")[tasks, guess] > 0, np.nan, found)

    @staticmethod
    def _of_solves(file, tasks, names, guess=None):
        """Every task's median over its solves of the sum of some columns."""
        found = np.full(len(tasks), np.nan)
        paths = [f"/timing/solves/{name}" for name in names]
        if all(file.has(path) for path in paths):
            for k, task in enumerate(tasks):
                values = sum(file.rows(path, task).astype(float) for path in paths)
                values = values if guess is None else values[:, guess]
                values = values[np.isfinite(values)]
                found[k] = np.median(values) if len(values) else np.nan
        return found

    def _compare(self, path):
        if not (self.one.has(path) and self.other.has(path)):
            if self.one.has(path) or self.other.has(path):
                self.left_out.append(path)
            return
        one, other = self.one.h5[path], self.other.h5[path]
        by_guess = path.startswith(("/tasks/", "/solves/")) and all(
            len(file.guesses) and column.ndim > 1 and column.shape[1] == len(file.guesses)
            for file, column in ((self.one, one), (self.other, other)))
        if one.dtype.kind != other.dtype.kind or one.shape[2 if by_guess else 1:] != other.shape[2 if by_guess else 1:]:
            self.left_out.append(path)
            return
        group = path.rpartition("/")[0]
        places = _places(self.one, group, self.a), _places(self.other, group, self.b)
        same = places[0] is not None and places[1] is not None and places[0][1] == places[1][1]
        if path in FRAMES:
            same = same & self._same_frame_times()
        if not np.all(same):
            self.left_out.append(path)
        if np.any(same):
            comparable = np.flatnonzero(same)
            for pairs in _blocks(places[0][1][comparable]):
                self._compare_block(path, comparable[pairs], places, by_guess)

    def _same_frame_times(self):
        """Whether two tasks have their second frame at the same time."""
        here, there = (file.h5["/trajectories/time_s"][:, 1:2][tasks]
                       for file, tasks in ((self.one, self.a), (self.other, self.b)))
        return np.all((here == there) | (np.isnan(here) & np.isnan(there)), axis=1)

    def _compare_block(self, path, pairs, places, by_guess):
        rows = [_rows(first[pairs], count[pairs]) for first, count in places]
        here, there = (_read(file.h5[path], index) for file, index in zip((self.one, self.other), rows))
        owners = np.repeat(pairs, places[0][1][pairs])
        if by_guess:
            guesses = self.guesses[owners]
            index = np.maximum(guesses, 0).reshape(guesses.shape + (1,) * (there.ndim - 2))
            there = np.take_along_axis(there, np.broadcast_to(index, guesses.shape + there.shape[2:]), axis=1)
            ignored = np.broadcast_to((guesses < 0).reshape(index.shape), there.shape)
        else:
            ignored = np.zeros(here.shape, dtype=bool)
        if here.dtype.kind in "iuf":
            differs = (here != there) & ~((here != here) & (there != there)) & ~ignored
            with np.errstate(invalid="ignore"):
                size = np.abs(there.astype(float) - here.astype(float))
            size = np.where(np.isnan(size), np.inf, size)
        else:
            differs = (decoded(here) != decoded(there)) & ~ignored
            size = np.where(differs, np.inf, 0)
        differs, size = differs.reshape(len(owners), -1), np.where(differs, size, 0).reshape(len(owners), -1)
        row_values = differs.sum(axis=1)
        if not row_values.any():
            return
        found = self.columns.setdefault(path, ColumnDifference(path))
        found.values += int(row_values.sum())
        tasks = np.unique(owners[row_values > 0])
        found.tasks += len(tasks)
        for place in tasks:
            self.differing.setdefault(int(place), []).append(path)
        largest = size.max(axis=1)
        if largest.max() > found.largest or found.task < 0:
            found.largest, found.task = float(largest.max()), int(self.a[owners[np.argmax(largest)]])


def _datasets(file):
    """{path: None} of all results, in order, without times, row numbers, parameters and provenance."""
    found = {}

    def add(name, item):
        path = "/" + name
        if isinstance(item, h5py.Dataset) and path.startswith(("/tasks/", "/steps/", "/solves/", "/systems/", *FRAMES)) and \
                not path.startswith("/tasks/parameters/") and path not in NOT_MEASURED:
            found[path] = None
    file.h5.visititems(add)
    return found


def _places(file, group, tasks):
    """(first row, number of rows) of some tasks in a group; None if the file does not have them."""
    if group == "/tasks":
        return tasks, np.ones(len(tasks), dtype=int)
    if group == "/trajectories":
        return (file.h5["/tasks/first_frame_row"][:][tasks].astype(int),
                (file.h5["/tasks/frames"][:] * file.h5["/tasks/segments"][:])[tasks].astype(int))
    if group not in PLACES or not all(f"/tasks/{name}" in file.h5 for name in PLACES[group]):
        return None
    return tuple(file.h5[f"/tasks/{name}"][:][tasks].astype(int) for name in PLACES[group])


def _blocks(counts):
    """Indices of pairs, in blocks of bounded numbers of rows."""
    ends = np.cumsum(counts)
    return [block for block in np.split(np.arange(len(counts)), np.flatnonzero(np.diff(ends // BLOCK_ROWS)) + 1)
            if len(block)]


def _rows(first, count):
    """The row numbers of all ranges, concatenated."""
    if not count.sum():
        return np.empty(0, dtype=int)
    return np.repeat(first - np.concatenate([[0], np.cumsum(count)[:-1]]), count) + np.arange(count.sum())


def _read(dataset, rows):
    if not len(rows):
        return dataset[:0]
    begin, end = int(rows.min()), int(rows.max()) + 1
    if end - begin <= 4 * len(rows):
        return dataset[begin:end][rows - begin]
    order = np.argsort(rows, kind="stable")
    return dataset[rows[order]][np.argsort(order)]
