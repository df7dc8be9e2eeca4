"""Programs beside Python that some scripts need."""

import shutil

from rodsweep.reading.errors import UserError


class ToolError(UserError):
    """A program that is missing, or that failed."""


def needed(program, purpose):
    """Refuses to begin without a program; its Debian package has the same name."""
    if shutil.which(program) is None:
        raise ToolError(f"there is no {program} on the PATH, {purpose}: install the Debian package {program} "
                        "(make pictures)")
