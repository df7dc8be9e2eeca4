"""What the user can put right: a message for him, which commandline.run() prints."""

import difflib
import importlib
import re

LISTED = 12       # names that a message lists
CLOSE = 0.7       # difflib's measure: one letter of four, or a third of a long word, may be wrong
CONTAINED = 4     # letters that are found within a name
NUMBER = re.compile(r"[+-]?[\d.]+(e[+-]?\d+)?")


class UserError(Exception):
    """The one argument is the message."""


class SweepFileError(UserError):
    """A file that cannot be read as a rodsweep results file."""


class KeyNotFound(UserError):
    """A name or value that the user asked for and that the file does not have."""


def library(name):
    """The module of a library that only some of the package needs; a UserError that says how to install it."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise UserError(f"{name} is not installed: apt-get install python3-{name}, or pip install {name}") from None


def not_found(what, name, known, all_by=""):
    """A KeyNotFound of one line, with the nearest known name, and the known ones where they are few or none is near."""
    known = [str(k) for k in known]
    near = nearest(str(name), known)
    if near:
        hint = f"did you mean {near}?" + (f" Known: {listed(known)}" if len(known) <= LISTED else "")
    else:
        hint = f"known: {listed(known, all_by)}"
    return KeyNotFound(f"{what} {name!r} is not in the file; {hint}")


def listed(names, all_by=""):
    """The first ones, how many more there are, and where all are told."""
    shown, more = ", ".join(names[:LISTED]) or "none", len(names) - LISTED
    return shown if more <= 0 else f"{shown} and {more} more" + (f" ({all_by})" if all_by else "")


def nearest(word, known):
    """The known name that a mistyped one is meant for, "" where none is near. As in the program (runner/text/nearest.hpp)
    case does not count, and where none is spelled alike one that holds the word is near ("length": "length_m"). Here the
    last part alone is a name too ("segments": "scene.segments"), and no number is near to another."""
    typed = word.lower()
    if NUMBER.fullmatch(typed):
        return ""
    forms = {k.rpartition(".")[2].lower(): k for k in reversed(known)} | {k.lower(): k for k in reversed(known)}
    close = difflib.get_close_matches(typed, forms, 1, CLOSE)
    if close:
        return forms[close[0]]
    return next((k for k in known if len(typed) >= CONTAINED and typed in k.lower()), "")
