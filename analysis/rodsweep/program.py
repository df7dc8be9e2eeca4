"""Calls the program `rodsweep`. Its errors become exceptions with the same text, its warnings become warnings.

The program writes its messages to a pseudo terminal, because on a terminal it shows its progress ten times a second.
This is also its controlling terminal: when Python ends, the program gets SIGHUP and stops. Without pseudo terminals, as
in some containers, a pipe replaces it.
"""

import codecs
import os
import re
import shutil
import signal
import subprocess
import tempfile
import warnings
from pathlib import Path

from rodsweep import reading
from rodsweep.reading.errors import UserError

TASKS_FAILED, DIVERGED = 3, 9    # exit codes of a run with results
CLEAR = "\x1b[K"
STATUS = re.compile(re.escape(CLEAR) + r"\[[#.]+\] ")    # written by runner/terminal/progress.cpp


class JobError(UserError):
    """The program refused a job or a file, or stopped early. The text is that of the program, with the job's name in
    place of its file. `code` is the exit code; None if the program did not start."""

    def __init__(self, message, code=None):
        super().__init__(message)
        self.code = code


class JobWarning(UserWarning):
    """A warning of the program, or failed tasks."""


def path():
    """Path of the program: $RODSWEEP, or on the PATH, or with the package in a source tree or an installation."""
    given, root = os.environ.get("RODSWEEP"), Path(__file__).resolve().parent.parent.parent
    places = [given] if given else ["rodsweep", root / "build" / "rodsweep", root / ".." / ".." / "bin" / "rodsweep"]
    found = next(filter(None, map(shutil.which, places)), None)
    if not found:
        raise JobError(f"the program {given or 'rodsweep'} was not found: build it, and set the environment variable "
                       "RODSWEEP to its path")
    return found


def call(*words, renamed, show=None, accepted=(0,)):
    """Exit code and output of the program. `renamed` maps texts in its messages to others. `show` gets its progress,
    then "". Ctrl-C stops a run, which keeps finished tasks. Raises JobError unless the exit code is accepted."""
    show = show or (lambda text: None)
    try:
        command = [os.fsencode(word) for word in (path(), *words)]
    except UnicodeEncodeError as error:
        raise JobError(f"{encodable(error.object)}: {error.reason}") from None
    ours, theirs, terminal = _channel()
    if terminal:
        # The first process of a session gets the first terminal that it opens to read and write as controlling terminal.
        command = ["sh", "-c", 'exec "$@" 2<>"$0"', terminal, *command]
    with tempfile.TemporaryFile("w+", encoding="utf-8") as output:
        with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output, stderr=theirs, start_new_session=True,
                              env=_environment()) as process:
            os.close(theirs)
            try:
                said = _messages(ours, show)
            except BaseException:
                process.send_signal(signal.SIGUSR1)    # after SIGINT, mpirun kills its ranks within a second
                _messages(ours, lambda text: None)
                raise
            finally:
                os.close(ours)    # SIGHUP, if a second Ctrl-C leads here
                show("")
        for old, new in renamed.items():
            said = said.replace(old, new)
        _check(process.returncode, said, accepted)
        output.seek(0)
        return process.returncode, output.read()


def encodable(text):
    """The text with "\\udc80" and so on for what UTF-8 does not have."""
    return text.encode("utf-8", "backslashreplace").decode()


def _channel():
    """Descriptors to read and write the program's messages, and the name of the terminal; "": there are no pseudo
    terminals, so this is a pipe. Then progress comes in the program's sparse lines, which are not shown."""
    import pty    # not on Windows, where only results are read
    import tty

    try:
        ours, theirs = pty.openpty()
        tty.setraw(theirs)    # line ends stay as they are
        return ours, theirs, os.ttyname(theirs)
    except OSError:
        return *os.pipe(), ""


def _environment():
    found = {**os.environ, "TERM": "xterm", "NO_COLOR": "1"}
    if reading.LOCKING is None:    # only readers do without locks
        found.pop("HDF5_USE_FILE_LOCKING", None)
    return found


def _messages(terminal, show):
    """Reads to the end: shows progress, and returns the other lines."""
    decode = codecs.getincrementaldecoder("utf-8")("replace").decode
    said, rest = [], ""
    while block := _read(terminal):
        *ended, rest = re.split(r"[\r\n]", rest + decode(block))
        if STATUS.match(rest):
            show(rest.removeprefix(CLEAR))
        said += [piece.removeprefix(CLEAR) for piece in ended if not STATUS.match(piece)]
    return "\n".join((*said, rest.removeprefix(CLEAR)))


def _read(terminal):
    try:
        return os.read(terminal, 1 << 16)
    except OSError:    # EIO: the program has ended
        return b""


def _check(code, said, accepted):
    """Raises the errors, or warns of the warnings, of a program that ended with this code."""
    messages = [text.strip() for text in re.split(r"^rodsweep: ", said, flags=re.M)]
    for text in messages:
        if text.startswith("warning: "):
            warnings.warn(text.removeprefix("warning: "), JobWarning, stacklevel=4)
    if code not in accepted:
        errors = [text.removeprefix("error: ") for text in messages if text.startswith("error: ")]
        last = messages[-1].partition(" To continue")[0]    # what follows is for a shell
        raise JobError("\n".join(errors) or f"{last or 'the program ended'} (exit code {code})", code)
