"""A sweep's results as pandas frames and xarray datasets. Both libraries are imported when first needed.

Rows of incomplete tasks are left out; `missing` counts these tasks. A value that was not measured or not reached is
NaN; in frames, counts that may be missing are of pandas' type Int64 (missing: NA). Units and meanings come from the
file. They are in the `attrs` of a frame ({"unit": {column: ...}, "meaning": {column: ...}, "missing": ...}) and of every
variable of a dataset ("units", "long_name").
"""

import numpy as np

from rodsweep.reading import blocks, groups, measures, tidy, trajectory
from rodsweep.reading.errors import SweepFileError, UserError, library, not_found
from rodsweep.reading.hdf5 import as_text
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.reading.tidy import Column

ROWS = 100_000
TOLERANCE = "cg_tolerance"    # name of the axis; xarray's sel() has a parameter `tolerance`


class Results:
    """Use as `with rodsweep.open(path) as results:`, or close() it.

    `columns` are names, by default all measured ones and the swept parameters; columns() lists them. `where` is one
    condition or a list of them, as for `rodsweep query`: "scene.segments>=20", "guess=zero,quadratic".
    """

    def __init__(self, path):
        self.file = SweepFile(path)
        kind = as_text(self.file.h5.attrs.get("kind", "sweep"))
        if kind != "sweep":
            self.close()
            raise SweepFileError(f"{self.file.path} is a {kind}, not the results of a sweep; h5py reads its /systems")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.file.h5.close()

    def __repr__(self):
        return f"<rodsweep results {self.file.path}: {self.census().text()}>"

    @property
    def job(self):
        """The job of the sweep."""
        return self.file.job()

    @property
    def guesses(self):
        return list(self.file.guesses)

    @property
    def tolerances(self):
        return self.file.tolerances.tolist()

    @property
    def missing(self):
        """Pending and failed tasks: "2 pending, 1 diverged of 24 tasks"; "" if there are none."""
        census = self.census()
        said = [f"{census.pending} pending"] if census.pending else []
        said += [f"{count} {outcome}" for outcome, count in sorted(census.failed.items())]
        return f"{', '.join(said)} of {census.total} tasks" if said else ""

    def census(self):
        """Number of tasks in each state."""
        return measures.census(self.file, np.ones(self.file.task_count, dtype=bool))

    def columns(self, level="tasks"):
        """Names, units and meanings of all columns of a level: "tasks", "solves" or "steps"."""
        table = self._table(level)
        return library("pandas").DataFrame([(name, *table.about(name)) for name in table.names],
                                   columns=["column", "unit", "meaning"]).set_index("column")

    def tasks(self, columns=None, where=()):
        """A row per task, guess and tolerance."""
        return self._frame("tasks", columns, where)

    def solves(self, columns=None, where=()):
        """A row per linear solve and guess. Use blocks() if they do not fit into memory."""
        return self._frame("solves", columns, where)

    def steps(self, columns=None, where=()):
        """A row per time step."""
        return self._frame("steps", columns, where)

    def trajectory(self, task):
        """The recorded frames of a task, with the forces of its joints (rodsweep.reading.trajectory)."""
        return trajectory.of_task(self.file, task)

    def blocks(self, level, columns=None, where=(), rows=ROWS):
        """Yields the same frame in parts of about `rows` rows, so memory use does not grow with the file."""
        table, names, tests = self._asked(level, columns, where)
        return self._parts(table, names, tests, rows)

    def dataset(self, level="tasks", columns=None, where=()):
        """An xarray.Dataset with the axes `task`, or `row` of solves and steps, `guess`, `cg_tolerance` and `xyz`.
        `columns` are names of datasets in the file ("iterations") and of parameters, which become coordinates."""
        table = self._table(level)
        tests = [table.condition(text) for text in _listed(where)]
        measured = [name for name, column in table.datasets.items()
                    if "other" not in column.axes and table.shared(name) is None]
        of_tasks = [*tidy.OF_TASKS, *self.file.parameters]
        usual = [name for name in table.default_names() if name in self.file.parameters or name == "outcome"]
        if columns is not None:
            for name in _listed(columns):
                if name not in (*measured, *of_tasks):
                    raise not_found("dataset or parameter", name, (*measured, *of_tasks))
            usual, measured = ([name for name in _listed(columns) if name in known] for known in (of_tasks, measured))
        owners, guesses, tolerances, found = table.arrays(measured, tests)
        return self._dataset(table, owners, guesses, tolerances, found, usual)

    def summary(self, by=None, newton="first", where=()):
        """The numbers of `rodsweep-summary`, a row each, with 95 % intervals: CG ratios, speedups, times, results of
        the steps. `by`: a parameter whose values split the numbers. `newton`: "first" or "all" iterations."""
        if newton not in measures.NEWTON:
            raise UserError(f"newton={newton!r}: choose one of {', '.join(measures.NEWTON)}")
        table = self._table("tasks")
        tasks, guesses, tolerances, left = table.narrowed([table.condition(text) for text in _listed(where)])
        if left:
            raise UserError(f"{left[0].text}: {left[0].column} has a value for every guess or tolerance; cg_ratio.GUESS "
                            "and other columns of `rodsweep query` choose simulations")
        sims = measures.simulations(self.file, np.isin(np.arange(self.file.task_count), tasks))
        if by is not None and len(sims):
            sims = sims.subset(groups.applicable(self.file, sims, by, without=True))
        own, records = [] if by is None else [by], []
        for block in blocks.blocks(self.file, sims, by, newton):
            settings = {name: block.settings[name] for name in own}
            for record in blocks.records(self.file, block, guesses, tolerances, newton):
                absent = {name: np.nan for name in ("guess", "tolerance", "unreached_solves") if record[name] == ""}
                records.append(settings | record | absent)
        frame = library("pandas").DataFrame(records, columns=[*own, *blocks.COLUMNS])
        frame = frame.astype({"tolerance": float, "unreached_solves": "Int64"})
        if by is not None and self.file.parameter(by).numeric:
            frame[by] = library("pandas").to_numeric(frame[by])
        frame.attrs["missing"] = self.missing
        return frame

    def _table(self, level):
        if level not in tidy.LEVELS:
            raise UserError(f"level {level!r} is unknown; choose one of {', '.join(tidy.LEVELS)}")
        tidy.require_rows(self.file, level)
        return tidy.Tidy(self.file, level, np.flatnonzero(self.file.complete), range(len(self.file.guesses)),
                         range(len(self.file.tolerances)))

    def _asked(self, level, columns, where):
        table = self._table(level)
        names = table.default_names() if columns is None else _listed(columns)
        table.check(names)
        return table, names, [table.condition(text) for text in _listed(where)]

    def _frame(self, level, columns, where):
        table, names, tests = self._asked(level, columns, where)
        return self._part(table, names, list(table.blocks(names, tests)))

    def _parts(self, table, names, tests, rows):
        gathered, count = [], 0
        for block in table.blocks(names, tests):
            gathered.append(block)
            count += len(block[names[0]])
            if count >= rows:
                yield self._part(table, names, gathered)
                gathered, count = [], 0
        if gathered:
            yield self._part(table, names, gathered)

    def _part(self, table, names, gathered):
        made, about = frame(table, names, gathered), {name: table.about(name) for name in names}
        made.attrs = {"unit": {name: unit for name, (unit, _) in about.items() if unit},
                      "meaning": {name: meaning for name, (_, meaning) in about.items() if meaning},
                      "missing": self.missing}
        return made

    def _dataset(self, table, owners, guesses, tolerances, found, parameters):
        row = "task" if table.level == "tasks" else "row"

        def variable(name, axes, values):
            unit, meaning = table.about(name)
            said = {"units": unit, "long_name": meaning}
            return axes, values, {key: text for key, text in said.items() if text}

        coordinates = {name: variable(name, (row,), _present(table.shared(name))[owners])
                       for name in dict.fromkeys(["task", "sample", *parameters])}
        if table.by_guess:
            coordinates["guess"] = variable("guess", ("guess",), table.labels[guesses])
            _, values, attributes = variable("tolerance", (), self.file.tolerances[tolerances])
            coordinates[TOLERANCE] = (TOLERANCE, values, attributes)
        variables = {}
        for name, values in found.items():
            axes = tuple(TOLERANCE if axis == "tolerance" else axis for axis in table.datasets[name].axes)
            if axes == ("component",):
                axes = (f"{name}_component",) if values.shape[1] != 3 else ("xyz",)
                coordinates.update({"xyz": list("xyz")} if axes == ("xyz",) else {})
            variables[name] = variable(name, (row, *axes), _measured(values, name))
        attributes = {"missing": self.missing, "job": self.job.get("name", ""), "file": self.file.path}
        return library("xarray").Dataset(variables, coordinates, attributes)


def frame(table, names, blocks):
    """Blocks of a tidy.Tidy as a frame."""
    return library("pandas").DataFrame({name: _column(table, name, [block[name] for block in blocks]) for name in names})


def _column(table, name, columns):
    """Values of a frame's column."""
    dtype, shared = table.dtype(name), table.shared(name)
    parts = _texts(columns) if dtype.kind == "U" else [column.array() for column in columns]
    values = np.concatenate(parts or [np.empty(0, dtype=dtype)])
    if dtype.kind == "i" and (name not in tidy.COUNTED if shared is None else (shared == -1).any()):
        return _counts(values)
    return values


def _texts(columns):
    """The rows of columns of texts, as objects; missing texts are NaN. Equal texts share an object, so that a row takes
    8 bytes. They are not categories: groupby() has groups without rows of those, unless it is told otherwise."""
    made = {}
    for values in {id(column.values): column.values for column in columns}.values():    # blocks share them
        texts, codes = np.unique(values, return_inverse=True)
        made[id(values)] = np.where(texts == "", np.nan, texts.astype(object))[codes]
    return [Column(made[id(column.values)], column.index).array() for column in columns]


def _counts(values):
    """Integers that may be missing, for a frame: of pandas' type Int64, even if none is missing."""
    return library("pandas").arrays.IntegerArray(values.astype(np.int64), values == -1)


def _measured(values, name):
    """Integers that may be missing become floating-point numbers, even if none is missing."""
    if values.dtype.kind == "i" and name not in tidy.COUNTED:
        return np.where(values == -1, np.nan, values)
    return values.astype(object) if values.dtype.kind == "U" else values


def _present(values):
    """Integers per task become floating-point numbers if one is missing."""
    return np.where(values == -1, np.nan, values) if values.dtype.kind == "i" and (values == -1).any() else values


def _listed(texts):
    return [texts] if isinstance(texts, str) else list(texts)
