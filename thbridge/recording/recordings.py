"""Paths of recordings: a bag or its parts, the journal next to it, and older recordings of the same name."""

import hashlib
import re
from pathlib import Path

from thbridge.files.disk.regular_files import open_regular
from thbridge.files.disk.synced import make_folder, sync_folder
from thbridge.recording.claims import claim

ACTIVE = ".active"
"""Suffix of a bag that is being written, as with rosbag."""


_LEAST = 1 << 16
"""Smallest free disk space for starting a recording, in bytes."""


def active_of(bag: Path) -> Path:
    """Return the path of a bag while it is being written."""
    return bag.with_name(bag.name + ACTIVE)


def unfinished_of(bag: Path) -> Path | None:
    """Return the unfinished file, or first unfinished part, of a bag; None if there is none.

    A bag is unfinished while it is being written, and after its writer was killed.
    """
    parts = (path for _, path in _numbered(bag, bag.suffix + ACTIVE))
    return active_of(bag) if active_of(bag).exists() else next(parts, None)


def part_of(bag: Path, number: int) -> Path:
    """Return the path of one part of a split recording, counted from 0: `NAME_0.bag`, as with rosbag."""
    return bag.with_name(f"{bag.stem}_{number}{bag.suffix}")


def parts_of(bag: Path) -> tuple[Path, ...]:
    """Return the files of a recording, in order.

    If the file `NAME.bag` exists, it is the complete recording. Otherwise the files are `NAME_0.bag`, `NAME_1.bag`,
    ..., without a part that is being written.

    Args:
        bag: name of the recording, or a file; returned unchanged if there are no parts.
    """
    if bag.exists():
        return (bag,)
    return tuple(path for _, path in _numbered(bag, bag.suffix)) or (bag,)


def digest_of(bag: Path) -> str:
    """Return the SHA-256 of a recording's file, or of the joined files of a split recording.

    Raises:
        BadFile: the path is a pipe or a device.
        OSError: the file does not exist, or cannot be read.
    """
    digest = hashlib.sha256()
    for part in parts_of(bag):
        with open_regular(part) as file:
            while piece := file.read(1 << 20):
                digest.update(piece)
    return digest.hexdigest()


def journal_of(bag: Path) -> Path:
    """Return the path of the journal folder that belongs to a bag."""
    return bag.with_name(bag.name.removesuffix(".bag") + ".journal")


def tlog_of(bag: Path) -> Path:
    """Return the path of the telemetry log that belongs to a bag."""
    return bag.with_name(bag.name.removesuffix(".bag") + ".tlog")


def make_room(bag: Path) -> Path | None:
    """Rename an older recording of this name, with its journal and telemetry log; nothing is overwritten.

    The name is then claimed by this program.

    Returns:
        The new path of the older bag, or None if there was none.

    Raises:
        BadFile: another running program records there.
        OSError: the older recording cannot be renamed.
    """
    if bag.parent.is_dir():
        claim(bag)
    old = [path for path in (bag, active_of(bag), journal_of(bag), tlog_of(bag)) if path.exists()]
    old += [path for ending in ("", ACTIVE) for _, path in _numbered(bag, bag.suffix + ending)]
    if not old:
        return None
    number = next(n for n in range(1, 10**6) if not any(bag.parent.glob(f"{bag.stem}-{n}[._]*")))
    moved = bag.with_name(f"{bag.stem}-{number}{bag.suffix}")
    for path in old:
        path.rename(path.with_name(moved.stem + path.name.removeprefix(bag.stem)))
    sync_folder(bag.parent)
    return moved


def try_place(bag: Path) -> None:
    """Check that a bag can be started at this path, before any slow step.

    Raises:
        OSError: no bag can be started there.
    """
    active = active_of(bag)
    make_folder(bag.parent)
    with active.open("xb", buffering=0) as file:
        try:
            file.write(bytes(_LEAST))
        finally:
            active.unlink()


def _numbered(bag: Path, ending: str) -> list[tuple[int, Path]]:
    """Return the existing parts with their numbers, in order."""
    pattern = re.compile(rf"{re.escape(bag.stem)}_(0|[1-9][0-9]*){re.escape(ending)}")
    siblings = bag.parent.iterdir() if bag.parent.is_dir() else ()
    matches = ((pattern.fullmatch(path.name), path) for path in siblings)
    return sorted((int(match[1]), path) for match, path in matches if match)
