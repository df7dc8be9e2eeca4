"""External programs that some scripts need."""

import shutil

from rodsweep.reading.errors import UserError


class ToolError(UserError):
    """A program is missing or failed."""


def needed(program, purpose):
    """Raises ToolError if a program is missing. Its Debian package has the same name."""
    if shutil.which(program) is None:
        raise ToolError(f"{program} is not on the PATH ({purpose}): install the Debian package {program} "
                        "(jobs/studies.py pictures)")
