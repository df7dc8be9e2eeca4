"""Errors that the user can correct. commandline.run() prints their message."""

import difflib
import importlib
import re
import shutil

LISTED = 12       # names that a message lists
CLOSE = 0.7       # difflib's cutoff: one letter of four, or a third of a long word, may be wrong
CONTAINED = 4     # fewest letters to find within a name
NUMBER = re.compile(r"[+-]?[\d.]+(e[+-]?\d+)?")


class UserError(Exception):
    """The one argument is the message."""


class ToolError(UserError):
    """A program that a script needs is missing or failed."""


class SweepFileError(UserError):
    """A file that cannot be read as a rodsweep results file."""


class IgnoredData(UserWarning):
    """Datasets in a results file that are not columns, such as a user's own."""


class KeyNotFound(UserError):
    """A name or value that the user gave and that the file does not have."""


def library(name):
    """The module of an optional library. Raises a UserError that gives the command to install it."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise UserError(f"{name} is not installed: apt-get install python3-{name}, or pip install {name}") from None


def require_program(name, purpose):
    """Raises ToolError if a program is missing. Its Debian package has the same name."""
    if shutil.which(name) is None:
        raise ToolError(f"{name} is not on the PATH ({purpose}): install the Debian package {name} "
                        "(jobs/studies.py pictures)")


def not_found(what, name, known, all_by=""):
    """A KeyNotFound with the nearest known name. Lists the known names if they are few or none is near."""
    known = [str(k) for k in known]
    near = nearest(str(name), known)
    if near:
        hint = f"did you mean {near}?" + (f" Known: {listed(known)}" if len(known) <= LISTED else "")
    else:
        hint = f"known: {listed(known, all_by)}"
    return KeyNotFound(f"{what} {name!r} is not in the file; {hint}")


def listed(names, all_by=""):
    """The first names, the number of others, and the command that lists all."""
    shown, more = ", ".join(names[:LISTED]) or "none", len(names) - LISTED
    return shown if more <= 0 else f"{shown} and {more} more" + (f" ({all_by})" if all_by else "")


def nearest(word, known):
    """The known name that a mistyped word is meant for; "" if none is near. As in the program
    (runner/text/nearest.hpp), case does not count, and a name may also contain the word ("length": "length_m"). Here,
    the last part of a name matches too ("segments": "scene.segments"), and numbers have no near name."""
    typed = word.lower()
    if NUMBER.fullmatch(typed):
        return ""
    forms = {k.rpartition(".")[2].lower(): k for k in reversed(known)} | {k.lower(): k for k in reversed(known)}
    close = difflib.get_close_matches(typed, forms, 1, CLOSE)
    if close:
        return forms[close[0]]
    return next((k for k in known if len(typed) >= CONTAINED and typed in k.lower()), "")
