"""Paths inside a folder, made from names that a person, a file or another program supplied."""

import os
from pathlib import Path

from thbridge.files.errors import BadFile, visible

LONGEST_NAME = 240
"""Longest name, in bytes of UTF-8. File systems accept 255 bytes; 15 of these are needed while a file is being
written."""
LONGEST_PATH = 4095
"""Longest path, in bytes, as in Linux."""

_REMEDY = f"Give a name of 1 to {LONGEST_NAME} bytes, without slashes, backslashes and control characters"


def path_inside(folder: Path, *names: str) -> Path:
    """Return the path of a file or folder inside a folder.

    Args:
        folder: the trusted folder, which does not have to exist. Its path may contain a link.
        names: one untrusted name for each level below the folder.

    Raises:
        BadFile: a name is not valid (see `fault_of_name`), or a link leads out of the folder.
    """
    for name in names:
        if problem := fault_of_name(name):
            raise BadFile(folder, problem, _REMEDY, key=repr(name))
    path = folder.joinpath(*names)
    if not Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder)):
        raise BadFile(path, f"a link leads out of {folder}", "Delete the link, or replace the link by its target")
    return path


def relative_inside(folder: Path, path: str) -> Path:
    """Return the path of a file or folder inside a folder, from a relative path with slashes between names.

    Raises:
        BadFile: the path is absolute, or `path_inside` refuses one of its names.
    """
    if path.startswith("/"):
        raise BadFile(folder, "this is an absolute path", f"Give a path inside {folder}", key=repr(path))
    return path_inside(folder, *path.split("/"))


def fault_of_path(path: str) -> str:
    """Return the fault, as a clause, of a path that may lead out of its folder; empty if the path is valid."""
    if not path.strip():
        return "this path is empty" if not path else "this path has only blanks"
    if visible(path) != path:
        return "this path has a control character"
    if len(path.encode()) > LONGEST_PATH or any(len(name.encode()) > LONGEST_NAME for name in path.split("/")):
        return f"this path is too long: {LONGEST_PATH} bytes are allowed, and {LONGEST_NAME} for each name in it"
    return ""


def fault_of_name(name: str) -> str:
    """Return the fault, as a clause, of the name of one file or folder; empty if the name is valid."""
    if not name.strip():
        return "this name is empty" if not name else "this name has only blanks"
    if name in (".", ".."):
        return "this name leads to another folder"
    if visible(name) != name:
        return "this name has a control character"
    if "/" in name or "\\" in name:
        return "this name has a slash or a backslash"
    if (size := len(name.encode())) > LONGEST_NAME:
        return f"this name has {size} bytes, but {LONGEST_NAME} are allowed"
    return ""
