"""Jobs from Python: makes, checks, plans and runs the jobs of docs/jobs.md with the program."""

import contextlib
import copy
import json
import os
import tempfile
import warnings

import numpy as np

from rodsweep import program
from rodsweep.program import JobError, JobWarning
from rodsweep.progress import line
from rodsweep.reading import job_paths, measures
from rodsweep.reading.errors import SweepFileError
from rodsweep.reading.sweepfile import SweepFile
from rodsweep.results import Results

FAILURES_SHOWN = 5                       # as many as the program prints


class Plan(dict):
    """Numbers of `rodsweep plan --json`. Prints one line for each."""

    def __repr__(self):
        shown = {key: ", ".join(map(str, value)) if isinstance(value, list) else value
                 for key, value in self.items() if key != "probes"}
        return "\n".join(f"{key:<25} {value}" for key, value in shown.items())


class Job:
    """A job of the program. The arguments are the keys of its JSON format; a key that is None is left out. Values may
    be sweeps (grid(), uniform(), ...), numbers and arrays of NumPy, and paths.

    Relative paths of input files start at the folder that is current when the job is made. Results go to
    results/NAME.h5 in the folder that is current when the job runs.
    """

    def __init__(self, name, kind="sweep", **keys):
        self._set({"name": name, "kind": kind, **keys}, os.getcwd())

    def _set(self, values, folder, path=None):
        self._values = {key: _plain(value) for key, value in values.items() if value is not None}
        self._folder, self._path = folder, path    # where relative paths start; the file that was read

    @classmethod
    def _of(cls, *settings):
        job = cls.__new__(cls)
        job._set(*settings)
        return job

    @classmethod
    def read(cls, path):
        """The job in a file. Relative paths in it start at the folder of the file, in copies by changed() too."""
        path = os.path.abspath(path)
        try:
            with open(path, encoding="utf-8-sig") as file:
                values = dict(json.load(file))
        except (OSError, ValueError, TypeError):
            program.call("validate", path, renamed={path: os.path.relpath(path)})    # raises the program's message
            raise
        return cls._of(values, os.path.dirname(path), path)

    def __repr__(self):
        return f"<rodsweep job {self.name}: {self._values.get('kind')}>"

    @property
    def name(self):
        return str(self._values.get("name"))

    @property
    def values(self):
        """A copy of the keys and values, as in the JSON file."""
        return copy.deepcopy(self._values)

    def changed(self, **keys):
        """A copy with other values of these keys; None removes a key. An object, such as `scene`, is replaced whole."""
        return self._of({**self.values, **keys}, self._folder)

    def write(self, path):
        """Writes the job to a file. Its relative paths then start at the folder of that file."""
        folder = os.path.dirname(os.path.abspath(path))
        text = self._text(lambda given: os.path.relpath(os.path.join(self._folder, given), folder))
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def validate(self, later=False):
        """Raises JobError if `run` would refuse the job. later: models and data sets need not exist yet."""
        with self._file() as (path, renamed):
            program.call("validate", path, *(["--later"] if later else []), renamed=renamed)

    def plan(self, workers=None, probe=True):
        """The Plan: tasks, bytes, core-hours. It tries a few tasks to estimate the time, unless probe=False."""
        words = ([] if workers is None else ["--workers", str(workers)]) + ([] if probe else ["--no-probe"])
        with self._file() as (path, renamed):
            plan = Plan(json.loads(program.call("plan", path, "--json", *words, renamed=renamed)[1]))
        del plan["job"]    # the temporary file
        return plan

    def run(self, workers=None, output=None, progress=True, **options):
        """Runs the job, continues it, or opens its complete file. Returns the Results of a sweep; of a data set or a
        training the path of its file. Failed tasks are a JobWarning.

        workers: number of cores. output: another file for the results. progress: show a bar. options: those of
        `rodsweep run`, with underscores: time_limit=3600, retry_failed=True. Ctrl-C stops the run; finished tasks are
        kept."""
        results = os.fspath(output or os.path.join("results", f"{self.name}.h5"))
        words = ["--resume"] if output is None else ["--resume", "--output", results]
        for option, value in {"workers": workers, **options}.items():
            if value is not None and value is not False:
                words += [f"--{option.replace('_', '-')}", *([] if value is True else [str(value)])]
        code = 0
        with self._file() as (path, renamed):
            if options or not self._is_complete(results, path):
                code, _ = program.call("run", path, *words, renamed=renamed, show=line() if progress else None,
                                       accepted=(0, program.TASKS_FAILED, program.DIVERGED))
        if code == program.DIVERGED:
            warnings.warn(f"{self.name}: the training diverged; {results} has its best model", JobWarning, stacklevel=2)
        if self._values["kind"] == "train":
            return results
        with SweepFile(results) as file:
            failed = _failures(file)
        if failed:
            warnings.warn(f"{results}: {failed}", JobWarning, stacklevel=2)
        return Results(results) if self._values["kind"] == "sweep" else results

    def _is_complete(self, results, path):
        """Whether a file holds all tasks of the job at `path`. False with input files: the program compares these."""
        try:
            with SweepFile(results) as file, open(path, "rb") as job:
                return not job_paths.given(self._values) and bool(file.complete.all()) and file.job_text() == job.read()
        except SweepFileError:
            return False

    @contextlib.contextmanager
    def _file(self):
        """The path of a job file for the program, and the changes to its messages. Paths in a temporary file are
        absolute."""
        if self._path:
            yield self._path, {self._path: os.path.relpath(self._path)}
            return
        with tempfile.TemporaryDirectory(prefix="rodsweep-") as folder:
            path = os.path.join(folder, "job.json")
            with open(path, "w", encoding="utf-8") as file:
                file.write(self._text(lambda given: os.path.join(self._folder, given)))
            yield path, {path: self.name, "the job file's folder": self._folder}

    def _text(self, place):
        """The JSON of the job, with place(path) for the paths of input files."""
        try:
            text = json.dumps(job_paths.placed(self._values, place), indent=2, ensure_ascii=False) + "\n"
            text.encode()
            return text
        except (TypeError, ValueError) as error:
            raise JobError(program.encodable(f"{self.name}: {error}")) from None


def _failures(file):
    """Counts of outcomes and the messages of the first failed tasks, as the program prints them; "" if none failed."""
    every = np.ones(file.task_count, dtype=bool)
    first, more = measures.failures(file, every, FAILURES_SHOWN)
    lines = [f"  task {task} {outcome}: {message}" for task, outcome, message in first]
    lines += [f"  and {more} more"] if more else []
    return "\n".join([measures.census(file, every).text(), *lines]) if first else ""


def _plain(value):
    """A value as JSON has it."""
    if isinstance(value, dict):
        return {str(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple, range)):
        return [_plain(inner) for inner in value]
    if hasattr(value, "tolist"):    # of NumPy or pandas
        return _plain(value.tolist())
    return os.fspath(value) if isinstance(value, os.PathLike) else value
