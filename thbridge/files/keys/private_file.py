"""Check that only the owner can access a file with a secret."""

import os
import shlex
import stat
import tempfile
from pathlib import Path

from thbridge.files.errors import BadFile

_OTHERS = 0o077


def check_private(path: Path) -> None:
    """Check that no other account may read or write a file. Files on file systems without permissions are not checked.

    Raises:
        BadFile: other accounts may read or write it. A missing file is not reported here, but by the function that
            reads it.
    """
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):
        return
    if stat.S_ISREG(mode) and mode & _OTHERS and _has_modes(path.parent):
        problem = f"other accounts may read or write this key (its mode is {mode & 0o777:o})"
        raise BadFile(path, problem, f"run: chmod 600 {shlex.quote(str(path))}")


def _has_modes(folder: Path) -> bool:
    """Return False on file systems, such as FAT, where other accounts can open all our new files."""
    try:
        with tempfile.TemporaryFile(dir=folder) as file:
            return not os.fstat(file.fileno()).st_mode & _OTHERS
    except OSError:
        return True
