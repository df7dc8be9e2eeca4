"""Files that scripts write: never one of the user's replaced unasked, never half a file under its name."""

import contextlib
import os

from rodsweep.reading.errors import SweepFileError


def add_force(made):
    made.add_argument("--force", action="store_true", help="replace the output if it is there")


def check(path, options):
    """Refuses to replace a file, without options.force; a results file (options.file or files) never."""
    if not os.path.exists(path):
        return
    sources = options.files if "files" in options else [options.file]
    source = any(os.path.exists(name) and os.path.samefile(path, name) for name in sources)
    if source or not options.force:
        raise SweepFileError(f"{path} is there already; give another name with -o" +
                             ("" if source else ", or --force to replace it"))


@contextlib.contextmanager
def whole(path):
    """A name to write to, which becomes `path` when all is written and is removed when it isn't."""
    part = f"{path}.part"
    try:
        yield part
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)
