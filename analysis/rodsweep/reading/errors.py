"""What the user can put right: a message for him, which commandline.run() prints."""

import difflib


class UserError(Exception):
    """The one argument is the message."""


class SweepFileError(UserError):
    """A file that cannot be read as a rodsweep results file."""


class KeyNotFound(UserError):
    """A name or value that the user asked for and that the file does not have."""


def not_found(what, name, known):
    known = [str(k) for k in known]
    close = difflib.get_close_matches(str(name), known, 1, 0.4)
    by_last_part = [k for k in known if k.rsplit(".", 1)[-1] == name]
    hint = f"; did you mean {(by_last_part or close)[0]}?" if by_last_part or close else ""
    listed = ", ".join(known) if known else "none"
    return KeyNotFound(f"{what} {name!r} is not in the file{hint} Known: {listed}" if hint else
                       f"{what} {name!r} is not in the file; known: {listed}")
