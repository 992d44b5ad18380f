"""Exports that a study knows, and the people in each, so that withdrawals can delete their data there."""

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
"""Largest manifest in bytes: a million people."""


def register_export(folder: ExperimentFolder, export: Path) -> None:
    """Record in a study's folder where an export is about to be written.

    Raises:
        BadFile: the list of exports cannot be read or written.
    """
    folder.exports_known.add(export)


def known_exports(folder: ExperimentFolder) -> tuple[Path, ...]:
    """Return the folders where exports of a study were written, and those in its folder that have a manifest.

    Raises:
        BadFile: the list of exports cannot be read.
    """
    found = [path.parent for path in sorted(folder.root.rglob(MANIFEST))]
    return tuple({path.resolve(): None for path in (*folder.exports_known.paths(), *found)})


def exports_with(folder: ExperimentFolder, participant: str) -> tuple[Path, ...]:
    """Return the existing folders of exports that have data of a person, or may have.

    An export without a readable manifest may have data of any person.

    Raises:
        BadFile: the list of exports cannot be read.
    """
    return tuple(path for path in known_exports(folder) if path.is_dir() and _may_hold(path, participant))


def missing_exports(folder: ExperimentFolder) -> tuple[Path, ...]:
    """Return the folders of exports that no longer exist: moved, renamed or deleted.

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
    """Return the number of the last event of the log in an export, or None if no manifest states it."""
    last = _contents(export).get("events")
    return last if isinstance(last, int) else None


def people_of(export: Path) -> frozenset[str] | None:
    """Return the ids of the people in an export, or None if no manifest states them."""
    people = _contents(export).get("participants")
    return frozenset(map(str, people)) if isinstance(people, list) else None


def _contents(export: Path) -> Mapping[str, object]:
    """Return the contents of a manifest; empty if it does not exist or is damaged."""
    try:
        contents = json_of(text_of(export / MANIFEST, content_of(export / MANIFEST, _LARGEST)))
        # An id with one wrong letter would match no person, and a withdrawn person's data would stay. Older files have
        # no checksum.
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
    # The folder may have been emptied, or used again for something else.
    return any(export.iterdir()) if people is None else participant in people
