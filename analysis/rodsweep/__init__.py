"""Jobs and results of rodsweep in Python. `rodsweep.Job(...).run()` runs a job and opens its results;
`rodsweep.open("results/demo.h5")` gives pandas frames and xarray datasets.

`reading` reads files and computes all numbers, `writing` writes rows in other formats, `drawing` makes figures,
pictures and films. The scripts of analysis/ use them; they are installed as `rodsweep-summary` and so on.
"""

try:
    from rodsweep.benchmarking import benchmark
    from rodsweep.jobs import Job, Plan
    from rodsweep.program import JobError, JobWarning
    from rodsweep.reading.errors import UserError
    from rodsweep.reading.systems import Systems
    from rodsweep.results import Results
    from rodsweep.sweeps import grid, integer, log_uniform, uniform, zip
except ModuleNotFoundError as error:
    if error.name.startswith("rodsweep"):
        raise
    raise ImportError(f"rodsweep needs {error.name}: apt-get install python3-h5py python3-scipy, or pip install h5py scipy",
                      name=error.name) from None

__version__ = "2.0.0"    # that of CMakeLists.txt (tested)
__all__ = ["Job", "JobError", "JobWarning", "Plan", "Results", "Systems", "UserError", "benchmark", "grid", "integer",
           "log_uniform", "open", "systems", "uniform", "zip"]


def open(path):
    """Results of a sweep, which may still be running. Raises UserError if the file is not a sweep."""
    return Results(path)


def systems(path):
    """The linear systems in a file of `rodsweep systems`: a sequence, read on demand. Raises UserError for other files."""
    return Systems(path)
