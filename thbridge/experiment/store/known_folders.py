"""Lists of folders with a study's exports and backups. These folders may be outside the study's folder."""

import json
import os
from pathlib import Path

from thbridge.files.disk.inside import fault_of_name, fault_of_path
from thbridge.files.disk.json_files import read_json
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile

_REMEDY = "Correct the file: it must be a JSON list of paths. Or move the file away, and check the folders yourself"


class KnownFolders:
    """A list of folders in a file. The file contains no names of people.

    Args:
        list_: path of the file. The file may not exist.
        root: the study's folder, which may be moved with its contents.
        what: kind of the folders, for messages.
    """

    def __init__(self, list_: Path, root: Path, what: str) -> None:
        self._list = list_
        self._root = root
        self._what = what

    def add(self, folder: Path) -> None:
        """Add a folder. Call this before writing into the folder.

        Raises:
            BadFile: the list cannot be read or written.
        """
        known, path = self._stored(), self._stored_path(folder)
        if path not in known:
            self._write([*known, path])

    def remove(self, folder: Path) -> bool:
        """Remove a folder that no longer exists. Return False if it is not in the list.

        Raises:
            BadFile: the list cannot be read or written.
        """
        known, path = self._stored(), self._stored_path(folder)
        if path not in known:
            return False
        self._write([each for each in known if each != path])
        return True

    def paths(self) -> list[Path]:
        """Return all folders, including folders that no longer exist.

        Raises:
            BadFile: the list cannot be read.
        """
        return [self._root / path for path in self._stored()]

    def _write(self, folders: list[str]) -> None:
        write_whole(self._list, (json.dumps(folders, indent=1, ensure_ascii=False) + "\n").encode())

    def _stored_path(self, folder: Path) -> str:
        """Return the path in the list: relative to the study's folder for a folder inside, otherwise absolute."""
        path, root = folder.resolve(), self._root.resolve()
        return os.fspath(path.relative_to(root) if path.is_relative_to(root) else path)

    def _stored(self) -> list[str]:
        noted = read_json(self._list, list[str], f"this is not a list of {self._what}", _REMEDY) or []
        for path in noted:
            # Relative paths must not lead out of the study's folder.
            names = [] if path.startswith("/") or path == "." else path.split("/")
            if problem := fault_of_path(path) or next(filter(None, map(fault_of_name, names)), ""):
                raise BadFile(self._list, problem, _REMEDY, key=repr(path))
        return noted
