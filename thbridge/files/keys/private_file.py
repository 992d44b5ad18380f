"""Check that a file with a secret is its owner's alone."""

import os
import shlex
import stat
import tempfile
from pathlib import Path

from thbridge.files.errors import BadFile

_OTHERS = 0o077


def check_private(path: Path) -> None:
    """Check that no other account may read or write a file; where file systems have no modes, nothing is checked.

    Raises:
        BadFile: others may. A file that is not there is for its reader to complain of.
    """
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):
        return
    if stat.S_ISREG(mode) and mode & _OTHERS and _has_modes(path.parent):
        problem = f"other accounts may read or write this key (its mode is {mode & 0o777:o})"
        raise BadFile(path, problem, f"run: chmod 600 {shlex.quote(str(path))}")


def _has_modes(folder: Path) -> bool:
    """Return True unless a new file of ours is open to others all the same, as on FAT."""
    try:
        with tempfile.TemporaryFile(dir=folder) as file:
            return not os.fstat(file.fileno()).st_mode & _OTHERS
    except OSError:
        return True
