"""Results of rodsweep in Python. `rodsweep.open("results/demo.h5")` has them as pandas frames and xarray datasets.

`reading` has files and all numbers made of them, `writing` their rows in other formats, `drawing` figures, pictures and
films; the scripts of analysis/, installed as `rodsweep-summary` and so on, are made of these.
"""

try:
    from rodsweep.reading.errors import UserError
    from rodsweep.results import Results
except ModuleNotFoundError as error:
    if error.name.startswith("rodsweep"):
        raise
    raise ImportError(f"rodsweep needs {error.name}: apt-get install python3-h5py python3-scipy, or pip install h5py scipy",
                      name=error.name) from None

__version__ = "1.0.0"    # that of CMakeLists.txt (tested)
__all__ = ["Results", "UserError", "open"]


def open(path):
    """The results of a sweep, finished or not, as Results. Raises UserError for a file that holds none."""
    return Results(path)
