"""Exports that a study knows of, and of whom they have data, so that nothing of who withdraws stays in one."""

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
"""File of an export that says of which people it has data."""
_LARGEST = 1 << 24
"""Largest manifest in bytes: a million people."""


def register_export(folder: ExperimentFolder, export: Path) -> None:
    """Note in a study's folder where an export is about to be written.

    Raises:
        BadFile: the list of exports cannot be read or written.
    """
    folder.exports_known.add(export)


def known_exports(folder: ExperimentFolder) -> tuple[Path, ...]:
    """Return where exports of a study were written, and where manifests lie in its folder.

    Raises:
        BadFile: the list of exports cannot be read.
    """
    found = [path.parent for path in sorted(folder.root.rglob(MANIFEST))]
    return tuple({path.resolve(): None for path in (*folder.exports_known.paths(), *found)})


def exports_with(folder: ExperimentFolder, participant: str) -> tuple[Path, ...]:
    """Return the folders of exports that are there and have data of a person, or may have.

    One whose manifest is missing or cannot be read may have data of anybody.

    Raises:
        BadFile: the list of exports cannot be read.
    """
    return tuple(path for path in known_exports(folder) if path.is_dir() and _may_hold(path, participant))


def missing_exports(folder: ExperimentFolder) -> tuple[Path, ...]:
    """Return where exports were written that are not there any more: moved, renamed or deleted.

    Raises:
        BadFile: the list of exports cannot be read.
    """
    return tuple(path for path in known_exports(folder) if not path.is_dir())


def manifest_text(title: str, participants: Iterable[str], events: int) -> str:
    """Return the text of a manifest.

    Args:
        title: of the experiment.
        participants: ids of the people of whom the export has data.
        events: number of the last event in the log.
    """
    told: dict[str, object] = {"title": title, "participants": sorted(participants), "events": events}
    return json.dumps({**told, "sum": _sum(told)}, indent=1, ensure_ascii=False) + "\n"


def last_event_of(export: Path) -> int | None:
    """Return the number of the last event of the log that is in an export; None where no manifest says it."""
    last = _told(export).get("events")
    return last if isinstance(last, int) else None


def people_of(export: Path) -> frozenset[str] | None:
    """Return the ids of those of whom an export has data; None where no manifest says it."""
    people = _told(export).get("participants")
    return frozenset(map(str, people)) if isinstance(people, list) else None


def _told(export: Path) -> Mapping[str, object]:
    """Return what a manifest says; nothing where there is none, or where it is damaged."""
    try:
        told = json_of(text_of(export / MANIFEST, content_of(export / MANIFEST, _LARGEST)))
        # An id with another letter would be of nobody, and data of who withdraws would stay. Older ones have no sum.
        if "sum" in told and told.pop("sum") != _sum(told):
            return {}
    except (OSError, BadFile, ValueError, TypeError, AttributeError):
        return {}
    return cast(Mapping[str, object], told) if isinstance(told, dict) else {}


def _sum(told: Mapping[str, object]) -> str:
    """Return a checksum of what a manifest says."""
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


def _may_hold(export: Path, participant: str) -> bool:
    people = people_of(export)
    # Somebody may have emptied the folder, or begun anew with it.
    return any(export.iterdir()) if people is None else participant in people
