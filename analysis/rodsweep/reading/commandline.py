"""Shared by the scripts' command lines: choice of tasks, guesses and tolerances, and error messages."""

import argparse
import os
import re
import sys
import warnings

import numpy as np

from rodsweep.reading import conditions, measures, texts
from rodsweep.reading.errors import IgnoredData, KeyNotFound, UserError, not_found
from rodsweep.reading.task_columns import TaskColumns

USUAL_WARNING = warnings.formatwarning
DEFAULT_TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4)


def parser(description, epilog=None, tolerances="1e-1,1e-2,1e-3,1e-4", newton=True, files=False):
    """`tolerances`: default in the help, None: no --tolerance; newton: adds --newton; files: several files, not one."""
    made = argparse.ArgumentParser(description=description, epilog=examples(epilog or ""),
                                   formatter_class=argparse.RawDescriptionHelpFormatter)
    of_files = {"dest": "files", "nargs": "+", "metavar": "FILE"} if files else {"dest": "file"}
    made.add_argument(**of_files, help="results file of `rodsweep run` (results/NAME.h5); it may still be running")
    made.add_argument("--scene", metavar="TYPE", help="only this type of scene, e.g. bending_rod")
    made.add_argument("--select", metavar="CONDITION", action="append", default=[],
                      help=f"only tasks that meet the condition: a column of `rodsweep query`, {conditions.FORM}; may be "
                           "repeated")
    made.add_argument("--guess", metavar="LABEL,…", help="only these guesses (default: all)")
    if tolerances:
        made.add_argument("--tolerance", metavar="T,…",
                          help=f"tolerances that iterations are counted to, or `all` (default: {tolerances})")
    made.set_defaults(newton="first")
    if newton:
        made.add_argument("--newton", choices=list(measures.NEWTON), default="first",
                          help="Newton iterations that count: the first of every step (j = 0, default) or all")
    return made


def examples(text):
    """The examples with the script's name as it was called: analysis/summary.py, or rodsweep-summary if installed."""
    name = os.path.basename(sys.argv[0])
    return text if name.endswith(".py") else re.sub(r"analysis/\w+\.py", name, text)


def whole_number(text):
    """The type of an integer argument of at least 1."""
    value = int(text)
    if value < 1:
        raise ValueError
    return value


def _warning(message, category, *place):
    """The text of a warning: those about a file do not name a line of code."""
    if category is IgnoredData:
        return f"{os.path.basename(sys.argv[0])}: {message}\n"
    return USUAL_WARNING(message, category, *place)


def run(main):
    """Calls main(). A UserError gives one line on stderr and exit code 2. So do other errors, since a damaged file can
    make any line fail; `python3 -X dev SCRIPT` shows where."""
    warnings.formatwarning = _warning
    try:
        main()
        sys.stdout.flush()
    except UserError as error:
        _stop(error.args[0])
    except BrokenPipeError:  # the reader of the pipe closed it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        # h5py raises OSError without errno for unreadable rows
        _stop(f"{error.filename or 'output'}: {error.strerror}" if error.errno else f"the file is damaged: {error}")
    except MemoryError:
        _stop("there is not enough memory, or the file is damaged; check it with `rodsweep info FILE --verify`")
    except Exception as error:
        if sys.flags.dev_mode:
            raise
        words = " ".join(str(error).split())
        _stop(f"the file is damaged, or this script has a bug: {type(error).__name__}: {words}; "
              "check the file with `rodsweep info FILE --verify`")


def _stop(message):
    print(f"{os.path.basename(sys.argv[0])}: {message}", file=sys.stderr)
    sys.exit(2)


def chosen_tasks(file, arguments):
    """Mask of the tasks that --scene and --select choose, complete or not."""
    mask = TaskColumns(file).select(arguments.select)
    if arguments.scene:
        scenes = file.scene_types()
        if arguments.scene not in scenes:
            raise not_found("scene", arguments.scene, sorted(set(scenes.tolist())))
        mask &= scenes == arguments.scene
        if not mask.any():
            raise KeyNotFound(f"no task of scene {arguments.scene} meets all of " + ", ".join(arguments.select))
    return mask


def chosen_guesses(file, arguments):
    """Indices of the guesses to show, in the file's order."""
    if not arguments.guess:
        return list(range(len(file.guesses)))
    return sorted({file.guess_index(label.strip()) for label in texts.split_labels(arguments.guess)})


def chosen_tolerances(file, arguments):
    """Indices of the tolerances to show; all if the file has none of the default ones."""
    every = list(range(len(file.tolerances)))
    if arguments.tolerance == "all":
        return every
    if not arguments.tolerance:
        return [k for k in every if np.isclose(file.tolerances[k], DEFAULT_TOLERANCES, rtol=1e-6, atol=0).any()] or every
    try:
        values = [float(part) for part in arguments.tolerance.split(",")]
    except ValueError:
        raise KeyNotFound(f"--tolerance {arguments.tolerance}: give tolerances of the file, separated by commas, or "
                          "`all`") from None
    return [file.tolerance_index(value) for value in values]
