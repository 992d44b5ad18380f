"""Search for maps and template sets by path or name, independent of the current folder."""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from thbridge.files.disk.inside import fault_of_path
from thbridge.files.disk.regular_files import as_on_disk, is_regular
from thbridge.files.errors import BadFile

ResourceKind = Literal["maps", "templates"]

PACKAGE = Path(__file__).resolve().parent.parent
"""The folder of the package thbridge, in a wheel or in a checkout."""

_MARKS: Mapping[ResourceKind, str] = {"maps": "map.yaml", "templates": "DialogueText"}
"""The file that every folder of a kind has."""
_WORDS: Mapping[ResourceKind, str] = {"maps": "map", "templates": "set of templates"}


@dataclass(frozen=True, slots=True)
class Resources:
    """The folder of the built-in maps and templates.

    Attributes:
        root: the folder that contains `maps/` and `templates/`.
    """

    root: Path

    def names(self, kind: ResourceKind) -> tuple[str, ...]:
        """Return the names of the built-in maps or template sets, in alphabetical order."""
        return tuple(sorted(mark.parent.name for mark in (self.root / kind).glob(f"*/{_MARKS[kind]}")))

    def find(self, kind: ResourceKind, wanted: str, beside: Path) -> Path:
        """Return the folder of a map or a template set.

        Args:
            kind: map or template set.
            wanted: a name, or a path, which contains a slash.
            `beside`: folder for relative paths: the folder of the study file, or the current folder.

        Raises:
            BadFile: the folder does not exist.
        """
        mark, word = _MARKS[kind], _WORDS[kind]
        if wanted and (problem := fault_of_path(wanted)):
            raise BadFile(self.root / kind, problem, f"The names are: {self._listed(kind)}")
        if "/" in wanted or "\\" in wanted:
            try:
                folder = as_on_disk(beside / Path(wanted).expanduser())
            except RuntimeError:
                problem = f"no user of this machine has the folder {wanted.partition('/')[0]}"
                remedy = f"Give the path of a {word} without ~, or one of: {self._listed(kind)}"
                raise BadFile(Path(wanted), problem, remedy) from None
            if is_regular(folder / mark):
                return folder
            problem = f"this folder has no {mark}" if folder.is_dir() else "there is no such folder"
            raise BadFile(folder, problem, f"Give the path of a {word}, or one of: {self._listed(kind)}")
        names = self.names(kind)
        if wanted in names:
            return self.root / kind / wanted
        near = difflib.get_close_matches(wanted, names, n=1)
        remedy = f"The nearest name is {near[0]}" if near else f"The names are: {self._listed(kind)}"
        remedy += f"; write a slash in your own path, as in ./{wanted or 'folder'}"
        raise BadFile(self.root / kind, f"no {word} has this name", remedy, key=wanted or None)

    def _listed(self, kind: ResourceKind) -> str:
        return ", ".join(self.names(kind)) or "none"


def shipped() -> Resources:
    """Return the built-in maps and templates: inside a wheel, or next to the packages in a checkout."""
    data = PACKAGE / "data"
    return Resources(data if data.is_dir() else PACKAGE.parent)
