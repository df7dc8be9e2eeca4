"""Shared by the scripts' command lines: choice of tasks, guesses and tolerances, and error messages."""

import argparse
import io
import os
import re
import signal
import sys
import warnings

import numpy as np

from rodsweep.reading import conditions, measures, texts
from rodsweep.reading.errors import IgnoredData, KeyNotFound, UserError, not_found
from rodsweep.reading.hdf5 import printable
from rodsweep.reading.task_columns import TaskColumns

USER_ERROR, STOPPED, OUTPUT_LOST = 2, 4, 7    # exit codes of the program
STDOUT = 1
USUAL_WARNING = warnings.formatwarning
DEFAULT_TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4)


def plain_parser(description, examples):
    """The examples have the script's name as it was called: analysis/summary.py, or rodsweep-summary if installed."""
    name = os.path.basename(sys.argv[0])
    examples = examples if name.endswith(".py") else re.sub(r"analysis/\w+\.py", name, examples)
    return argparse.ArgumentParser(description=description, epilog=examples,
                                   formatter_class=argparse.RawDescriptionHelpFormatter)


def parser(description, examples, tolerances="1e-1,1e-2,1e-3,1e-4", newton=True, files=False):
    """`tolerances`: default in the help, None: no --tolerance; newton: adds --newton; files: several files, not one."""
    made = plain_parser(description, examples)
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


class OutputLost(Exception):
    """Standard output could not be written."""


class _Output(io.FileIO):
    """Standard output, whose errors differ from those of other files."""

    def write(self, data):
        try:
            return super().write(data)
        except BrokenPipeError:
            raise
        except OSError as error:
            raise OutputLost(error.strerror) from None


def _open_output():
    """Makes standard output an _Output that writes what its encoding lacks as "?"."""
    if sys.stdout is not sys.__stdout__:    # redirected within Python
        return
    encoding, lines = "utf-8", False
    if sys.stdout:
        encoding, lines = sys.stdout.encoding, sys.stdout.line_buffering
    else:    # it is closed: writing to this fails
        os.dup2(os.open(os.devnull, os.O_RDONLY), STDOUT)
    sys.stdout = io.TextIOWrapper(io.BufferedWriter(_Output(STDOUT, "w", closefd=False)), encoding, "replace",
                                  line_buffering=lines)


def _interrupt(number, _):
    raise KeyboardInterrupt(signal.Signals(number).name)


def run(main):
    """Calls main(). A UserError gives one line on stderr and exit code 2. So do other errors, since a damaged file can
    make any line fail; `python3 -X dev SCRIPT` shows where. Ctrl-C, SIGTERM and SIGHUP are exceptions, so that no
    incomplete file is left."""
    warnings.formatwarning = _warning
    _open_output()
    for name in {"SIGINT", "SIGTERM", "SIGHUP"} & set(dir(signal)):    # Windows has two of them
        if signal.getsignal(getattr(signal, name)) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(getattr(signal, name), _interrupt)
    try:
        try:
            main()
        finally:    # also after --help, which exits
            sys.stdout.flush()
    except UserError as error:
        stop(error.args[0])
    except OutputLost as error:
        _discard_output()
        stop(f"writing to standard output failed: {error}", OUTPUT_LOST)
    except KeyboardInterrupt as interrupt:
        _discard_output()
        stop(f"stopped by {interrupt}", STOPPED)
    except BrokenPipeError:  # the reader of the pipe closed it
        _discard_output()
    except OSError as error:
        # h5py raises OSError without errno for unreadable rows
        stop(f"{error.filename or 'output'}: {error.strerror}" if error.errno else f"the file is damaged: {error}")
    except MemoryError:
        stop("there is not enough memory, or the file is damaged; check it with `rodsweep info FILE --verify`")
    except Exception as error:
        if sys.flags.dev_mode:
            raise
        words = " ".join(str(error).split())
        stop(f"the file is damaged, or this script has a bug: {type(error).__name__}: {words}; "
              "check the file with `rodsweep info FILE --verify`")


def _discard_output():
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def stop(message, code=USER_ERROR):
    print(f"{os.path.basename(sys.argv[0])}: {printable(message)}", file=sys.stderr)
    sys.exit(code)


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


def advanced_by(file, guesses):
    """Mask of the tasks that one of these guesses may advance: all but those of closed loops with another one."""
    return (file.own_guess < 0) | np.isin(file.own_guess, guesses)


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
