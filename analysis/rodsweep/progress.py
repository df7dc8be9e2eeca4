"""Shows the progress of a run: in a notebook, or in the last line of a terminal."""

import os
import shutil
import sys


def line():
    """A function that shows a text in place of the previous one; "" removes it. Elsewhere it shows nothing."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    if hasattr(shell, "kernel"):
        return _in_notebook()
    if sys.stderr.isatty() and os.environ.get("TERM", "dumb") != "dumb":
        return _in_terminal
    return lambda text: None


def _in_terminal(text):
    columns = shutil.get_terminal_size().columns    # a terminal wraps after the last one
    print(f"\r\x1b[K{text[:columns - 1]}", end="", file=sys.stderr, flush=True)


def _in_notebook():
    from IPython.display import display

    output = display({"text/plain": ""}, raw=True, display_id=True)
    return lambda text: output.update({"text/plain": text}, raw=True)
