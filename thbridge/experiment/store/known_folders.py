"""Lists of folders that a study knows of, outside of it as well: where its exports and its backups lie."""

import json
import os
from pathlib import Path

from thbridge.files.disk.inside import fault_of_name, fault_of_path
from thbridge.files.disk.json_files import read_json
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile

_REMEDY = "Correct it: a JSON list of paths. Or move it away, and look yourself after what is in those folders"


class KnownFolders:
    """A list in a file; it names nobody.

    Args:
        list_: the file, which need not be there.
        root: the study's folder, which may be moved with all that is in it.
        what: they are, for messages.
    """

    def __init__(self, list_: Path, root: Path, what: str) -> None:
        self._list = list_
        self._root = root
        self._what = what

    def add(self, folder: Path) -> None:
        """Note a folder, before anything is written there.

        Raises:
            BadFile: the list cannot be read or written.
        """
        known, path = self._noted(), self._told(folder)
        if path not in known:
            self._write([*known, path])

    def remove(self, folder: Path) -> bool:
        """Forget a folder that is gone for good; return False if the list does not have it.

        Raises:
            BadFile: the list cannot be read or written.
        """
        known, path = self._noted(), self._told(folder)
        if path not in known:
            return False
        self._write([each for each in known if each != path])
        return True

    def paths(self) -> list[Path]:
        """Return all of them, whether they are still there or not.

        Raises:
            BadFile: the list cannot be read.
        """
        return [self._root / path for path in self._noted()]

    def _write(self, folders: list[str]) -> None:
        write_whole(self._list, (json.dumps(folders, indent=1, ensure_ascii=False) + "\n").encode())

    def _told(self, folder: Path) -> str:
        """Path within the study's folder, if it is there; else an absolute one."""
        path, root = folder.resolve(), self._root.resolve()
        return os.fspath(path.relative_to(root) if path.is_relative_to(root) else path)

    def _noted(self) -> list[str]:
        noted = read_json(self._list, list[str], f"is no list of {self._what}", _REMEDY) or []
        for path in noted:
            # They may be anywhere; those in the study's folder have no way out of it.
            names = [] if path.startswith("/") or path == "." else path.split("/")
            if problem := fault_of_path(path) or next(filter(None, map(fault_of_name, names)), ""):
                raise BadFile(self._list, problem, _REMEDY, key=repr(path))
        return noted
