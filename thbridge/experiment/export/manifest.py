"""List of a study's exports and the people in each export, so that withdrawals can delete their data."""

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import cast

from thbridge.experiment.folder import ExperimentFolder
from thbridge.files.disk.regular_files import content_of
from thbridge.files.disk.text_files import text_of
from thbridge.files.errors import BadFile
from thbridge.json_text import json_of

MANIFEST = "manifest.json"
"""File of an export that lists the people in it."""
_LARGEST = 1 << 24
"""Largest size of a manifest, in bytes. This is enough for a million people."""


def register_export(folder: ExperimentFolder, export: Path) -> None:
    """Add the folder of an export to the study's list. Call this before writing the export.

    Raises:
        BadFile: the list of exports cannot be read or written.
    """
    folder.exports_known.add(export)


def known_exports(folder: ExperimentFolder) -> tuple[Path, ...]:
    """Return the folders of a study's exports: the folders in its list, and folders inside the study with a manifest.

    Raises:
        BadFile: the list of exports cannot be read.
    """
    found = [path.parent for path in sorted(folder.root.rglob(MANIFEST))]
    return tuple({path.resolve(): None for path in (*folder.exports_known.paths(), *found)})


def exports_with(folder: ExperimentFolder, participant: str) -> tuple[Path, ...]:
    """Return the existing folders of exports that may have data of a person.

    An export without a readable manifest may have data of any person.

    Raises:
        BadFile: the list of exports cannot be read.
    """
    return tuple(path for path in known_exports(folder) if path.is_dir() and _may_hold(path, participant))


def missing_exports(folder: ExperimentFolder) -> tuple[Path, ...]:
    """Return the paths of moved, renamed or deleted exports.

    Raises:
        BadFile: the list of exports cannot be read.
    """
    return tuple(path for path in known_exports(folder) if not path.is_dir())


def manifest_text(title: str, participants: Iterable[str], events: int) -> str:
    """Return the text of a manifest.

    Args:
        title: title of the experiment.
        participants: ids of the people in the export.
        events: number of the last event in the log.
    """
    contents: dict[str, object] = {"title": title, "participants": sorted(participants), "events": events}
    return json.dumps({**contents, "sum": _sum(contents)}, indent=1, ensure_ascii=False) + "\n"


def last_event_of(export: Path) -> int | None:
    """Return the number of the last event in an export, or None if the manifest is missing or damaged."""
    last = _contents(export).get("events")
    return last if isinstance(last, int) else None


def people_of(export: Path) -> frozenset[str] | None:
    """Return the ids of the people in an export, or None if the manifest is missing or damaged."""
    people = _contents(export).get("participants")
    return frozenset(map(str, people)) if isinstance(people, list) else None


def _contents(export: Path) -> Mapping[str, object]:
    """Return the contents of a manifest. If it is missing or damaged, return an empty mapping."""
    try:
        contents = json_of(text_of(export / MANIFEST, content_of(export / MANIFEST, _LARGEST)))
        # If an id has one wrong letter, a withdrawal would not find this person's data. Older manifests have no
        # checksum.
        if "sum" in contents and contents.pop("sum") != _sum(contents):
            return {}
    except (OSError, BadFile, ValueError, TypeError, AttributeError):
        return {}
    return cast(Mapping[str, object], contents) if isinstance(contents, dict) else {}


def _sum(contents: Mapping[str, object]) -> str:
    """Return a checksum of a manifest's contents."""
    return hashlib.sha256(json.dumps(contents, sort_keys=True).encode()).hexdigest()


def _may_hold(export: Path, participant: str) -> bool:
    people = people_of(export)
    # A user may have emptied the folder, or may use it for other files.
    return any(export.iterdir()) if people is None else participant in people
