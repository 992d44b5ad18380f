"""Paths of recordings: a bag or its parts, the journal next to it, and older recordings of the same name.

The name of a recording decides its format: `NAME.bag` is a bag of ROS 1, `NAME.mcap` is an MCAP file of ROS 2, and a
name without ending is a folder of rosbag2, with the file `NAME/NAME_0.mcap`, and `metadata.yaml` when it is complete.
"""

import glob
import hashlib
import re
from pathlib import Path
from tempfile import TemporaryFile

from thbridge.files.disk.regular_files import open_regular
from thbridge.files.disk.synced import make_folder, sync_folder
from thbridge.files.errors import BadFile
from thbridge.recording.claims import claim, release

ACTIVE = ".active"
"""Suffix of a bag that is being written, as with rosbag."""


BAG, MCAP = ".bag", ".mcap"
"""Endings of the names of recordings of ROS 1 and of ROS 2."""
METADATA = "metadata.yaml"
"""File that makes a folder a recording of rosbag2."""

_LEAST = 1 << 16
"""Smallest free disk space for starting a recording, in bytes."""


def is_folder(bag: Path) -> bool:
    """Return True if the name of a recording means a folder of rosbag2."""
    return not bag.suffix


def is_of_ros2(bag: Path) -> bool:
    """Return True if the name of a recording means a format of ROS 2."""
    return bag.suffix == MCAP or is_folder(bag)


def active_of(bag: Path) -> Path:
    """Return the path of a bag while it is being written; of a folder, the path of its first file."""
    file = part_of(bag, 0) if is_folder(bag) else bag
    return file.with_name(file.name + ACTIVE)


def unfinished_of(bag: Path) -> Path | None:
    """Return the unfinished file, or first unfinished part, of a bag; None if there is none.

    A bag is unfinished while it is being written, and after its writer was killed.
    """
    if bag.is_dir():
        parts = (path for _, path in files_in(bag, MCAP + ACTIVE))
        return next(parts, None)
    parts = (path for _, path in _numbered(bag, bag.suffix + ACTIVE))
    return active_of(bag) if active_of(bag).exists() else next(parts, None)


def part_of(bag: Path, number: int) -> Path:
    """Return the path of one part of a split recording, counted from 0: `NAME_0.bag`, as with rosbag."""
    if is_folder(bag):
        return bag / f"{bag.name}_{number}{MCAP}"
    return bag.with_name(f"{bag.stem}_{number}{bag.suffix}")


def finished_of(bag: Path) -> tuple[Path, ...]:
    """Return the complete files of the recording of this name, in order."""
    if is_folder(bag):
        return tuple(path for _, path in files_in(bag, MCAP))
    return tuple(path for path in parts_of(bag) if path.exists())


def parts_of(bag: Path) -> tuple[Path, ...]:
    """Return the files of a recording, in order.

    If the file `NAME.bag` exists, it is the complete recording. Otherwise the files are `NAME_0.bag`, `NAME_1.bag`,
    ..., without a part that is being written. The files of a folder of rosbag2 are `STEM_0.mcap`, ...; a folder with
    other files is returned unchanged.

    Args:
        bag: name of the recording, or a file; returned unchanged if there are no parts.
    """
    if bag.is_dir():
        files = files_in(bag, MCAP) if (bag / METADATA).is_file() else []
        return tuple(path for _, path in files) or (bag,)
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
    """Return the path of the journal folder that belongs to a bag; of a folder, it is inside."""
    if is_folder(bag):
        return bag / f"{bag.name}.journal"
    return bag.with_name(bag.name.removesuffix(".bag") + ".journal")


def tlog_of(bag: Path) -> Path:
    """Return the path of the telemetry log that belongs to a bag; of a folder, it is inside."""
    if is_folder(bag):
        return bag / f"{bag.name}.tlog"
    return bag.with_name(bag.name.removesuffix(".bag") + ".tlog")


def reserve(bag: Path) -> None:
    """Claim the name of a recording, and check that a bag can be started there. An older recording stays in place.

    Raises:
        BadFile: another running program records there, or the folder is not a recording.
        OSError: no bag can be started there.
    """
    _claim(bag)
    try:
        with TemporaryFile(dir=bag.parent, buffering=0) as file:
            file.write(bytes(_LEAST))
    except OSError:
        release(bag)
        raise


def make_room(bag: Path) -> Path | None:
    """Rename an older recording of this name, with its journal and telemetry log; nothing is overwritten.

    The name is then claimed by this program. Call this when nothing else can prevent the new recording.

    Returns:
        The new path of the older bag, or None if there was none.

    Raises:
        BadFile: another running program records there, or the folder is not a recording.
        OSError: the older recording cannot be renamed.
    """
    old = _claim(bag)
    if not old:
        return None
    number = next(n for n in range(1, 10**6) if not _is_taken(bag, f"{bag.stem}-{n}"))
    moved = bag.with_name(f"{bag.stem}-{number}{bag.suffix}")
    for path in old:
        path.rename(path.with_name(moved.stem + path.name.removeprefix(bag.stem)))
    sync_folder(bag.parent)
    return moved


def _claim(bag: Path) -> list[Path]:
    """Claim the name of a recording, and return the files of an older one. Raises BadFile, OSError: see `reserve`."""
    make_folder(bag.parent)
    claim(bag)
    try:
        return _older(bag)
    except BadFile:
        release(bag)
        raise


def _older(bag: Path) -> list[Path]:
    """Return the files of an older recording. Raises BadFile: the folder is not a recording."""
    if not is_folder(bag):
        old = [path for path in (bag, active_of(bag), journal_of(bag), tlog_of(bag)) if path.exists()]
        return old + [path for ending in ("", ACTIVE) for _, path in _numbered(bag, bag.suffix + ending)]
    ours = (bag / METADATA, journal_of(bag), tlog_of(bag), *bag.glob(f"*{MCAP}*"))
    if not bag.exists() or _is_empty(bag):
        return []
    if not any(path.exists() for path in ours):
        raise BadFile(bag, "something other than a recording has this name", "choose another name")
    return [bag]


def _is_empty(folder: Path) -> bool:
    return folder.is_dir() and not any(folder.iterdir())


def _is_taken(bag: Path, stem: str) -> bool:
    """Return True if there is a recording with this stem, or a part or journal of one, next to a bag."""
    return (bag.parent / stem).exists() or any(bag.parent.glob(f"{glob.escape(stem)}[._]*"))


def files_in(folder: Path, ending: str) -> list[tuple[int, Path]]:
    """Return the files `STEM_NUMBER` with this ending in a folder, with their numbers, in order; none if stems differ.

    The stem is the folder's name, unless the folder was renamed.
    """
    pattern = re.compile(rf"(.+)_(0|[1-9][0-9]*){re.escape(ending)}")
    files = folder.iterdir() if folder.is_dir() else ()
    found = [(match, path) for path in files if (match := pattern.fullmatch(path.name))]
    if len({match[1] for match, _ in found}) != 1:
        return []
    return sorted((int(match[2]), path) for match, path in found)


def _numbered(bag: Path, ending: str) -> list[tuple[int, Path]]:
    """Return the existing parts with their numbers, in order."""
    pattern = re.compile(rf"{re.escape(bag.stem)}_(0|[1-9][0-9]*){re.escape(ending)}")
    siblings = bag.parent.iterdir() if bag.parent.is_dir() else ()
    matches = ((pattern.fullmatch(path.name), path) for path in siblings)
    return sorted((int(match[1]), path) for match, path in matches if match)
