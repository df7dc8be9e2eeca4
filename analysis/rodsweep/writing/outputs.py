"""Output files of the scripts: replaced only with --force, and complete before they get their name."""

import contextlib
import os

from rodsweep.reading.errors import SweepFileError


def add_force(made):
    made.add_argument("--force", action="store_true", help="replace the output if it exists")


def check(path, options):
    """Raises SweepFileError if the file exists and options.force is not set, or if it is an input file."""
    if not os.path.exists(path):
        return
    sources = options.files if "files" in options else [options.file]
    source = any(os.path.exists(name) and os.path.samefile(path, name) for name in sources)
    if source or not options.force:
        raise SweepFileError(f"{path} already exists; give another name with -o" +
                             ("" if source else ", or --force to replace it"))


@contextlib.contextmanager
def whole(path):
    """A temporary name to write to, with the same ending, in a folder that is made if need be. It becomes `path` when the
    file is complete, and is removed after an error."""
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    stem, ending = os.path.splitext(path)
    part = f"{stem}.part{ending}"
    try:
        yield part
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)


def write(path, text):
    with whole(path) as part, open(part, "w", newline="", encoding="utf-8") as out:
        out.write(text)
