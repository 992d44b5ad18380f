"""Exports that a study knows of, so that those which hold somebody who withdraws can be found and deleted."""

import json
import os
from collections.abc import Iterable
from pathlib import Path

from thbridge.batch.whole_files import whole_file
from thbridge.experiment.folder import ExperimentFolder
from thbridge.files.errors import BadFile, reason_of

MANIFEST = "manifest.json"
"""File of an export that says of which people it has data."""


def register_export(folder: ExperimentFolder, export: Path) -> None:
    """Note in a study's folder where an export is about to be written; it names nobody.

    Raises:
        BadFile: the list of exports cannot be read or written.
    """
    known = [*_listed(folder)]
    if (path := _told(folder, export)) not in known:
        with whole_file(folder.exports_list) as file:
            file.write((json.dumps([*known, path], indent=1, ensure_ascii=False) + "\n").encode())


def known_exports(folder: ExperimentFolder) -> tuple[Path, ...]:
    """Return where exports of a study were written, and where manifests lie in its folder.

    Raises:
        BadFile: the list of exports cannot be read.
    """
    noted = [folder.root / path for path in _listed(folder)]
    found = [path.parent for path in sorted(folder.root.rglob(MANIFEST))]
    return tuple({path.resolve(): None for path in (*noted, *found)})


def exports_with(folder: ExperimentFolder, participant: str) -> tuple[Path, ...]:
    """Return the folders of exports that are there and have data of a person, or may have.

    One that was not finished, or whose manifest cannot be read, may have data of anybody.

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
    told = {"title": title, "participants": sorted(participants), "events": events}
    return json.dumps(told, indent=1, ensure_ascii=False) + "\n"


def _may_hold(export: Path, participant: str) -> bool:
    try:
        people = json.loads((export / MANIFEST).read_text(encoding="utf-8"))["participants"]
    except FileNotFoundError:
        # Somebody may have emptied the folder, or begun anew with it.
        return any(export.iterdir())
    except (OSError, ValueError, KeyError, TypeError):
        return True
    return not isinstance(people, list) or participant in people


def _listed(folder: ExperimentFolder) -> list[str]:
    try:
        told = json.loads(folder.exports_list.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return []
    except OSError as error:
        raise BadFile(folder.exports_list, f"cannot be read ({reason_of(error)})", _REMEDY) from None
    except ValueError:
        told = None
    if not isinstance(told, list):
        raise BadFile(folder.exports_list, "is no list of exports", _REMEDY)
    return [str(path) for path in told]


_REMEDY = "Bring it back from a backup, or find the exports yourself and move this file away"


def _told(folder: ExperimentFolder, export: Path) -> str:
    """Path within the study's folder, which may be moved with all that is in it; else an absolute one."""
    path, root = export.resolve(), folder.root.resolve()
    return os.fspath(path.relative_to(root) if path.is_relative_to(root) else path)
