"""Where recordings lie: a bag or the parts of one, its journal beside it, and older ones of the same name."""

import re
from pathlib import Path

ACTIVE = ".active"
"""Ending of a bag that is being written, after rosbag's custom."""


def active_of(bag: Path) -> Path:
    """What a bag is called while it is written."""
    return bag.with_name(bag.name + ACTIVE)


def part_of(bag: Path, number: int) -> Path:
    """One part of a split recording, from 0; `NAME_0.bag`, as rosbag calls them."""
    return bag.with_name(f"{bag.stem}_{number}{bag.suffix}")


def parts_of(bag: Path) -> tuple[Path, ...]:
    """The files of a recording, in order.

    A file that is there is all of it. Else these are `NAME_0.bag`, `NAME_1.bag`, ..., as far as they are complete.

    Args:
        bag: the recording's name, or a file; it is returned where there are no parts.
    """
    if bag.exists():
        return (bag,)
    return tuple(path for _, path in _numbered(bag, bag.suffix)) or (bag,)


def journal_of(bag: Path) -> Path:
    """The folder of the journal that goes with a bag."""
    return bag.with_name(bag.name.removesuffix(".bag") + ".journal")


def tlog_of(bag: Path) -> Path:
    """The telemetry log that goes with a bag."""
    return bag.with_name(bag.name.removesuffix(".bag") + ".tlog")


def make_room(bag: Path) -> Path | None:
    """Move an older recording of this name out of the way, with all that goes with it; nothing is overwritten.

    Returns:
        Where the older bag is now, or None when there was none.

    Raises:
        OSError: it cannot be moved.
    """
    old = [path for path in (bag, active_of(bag), journal_of(bag), tlog_of(bag)) if path.exists()]
    old += [path for ending in ("", ACTIVE) for _, path in _numbered(bag, bag.suffix + ending)]
    if not old:
        return None
    number = next(n for n in range(1, 10**6) if not any(bag.parent.glob(f"{bag.stem}-{n}[._]*")))
    moved = bag.with_name(f"{bag.stem}-{number}{bag.suffix}")
    for path in old:
        path.rename(path.with_name(moved.stem + path.name.removeprefix(bag.stem)))
    return moved


def try_place(bag: Path) -> None:
    """See that a bag can be recorded there, before anything that takes time is done.

    Raises:
        OSError: it cannot.
    """
    active = active_of(bag)
    bag.parent.mkdir(parents=True, exist_ok=True)
    with active.open("xb"):
        active.unlink()


def _numbered(bag: Path, ending: str) -> list[tuple[int, Path]]:
    """The parts that there are, in order, with their numbers."""
    pattern = re.compile(rf"{re.escape(bag.stem)}_(0|[1-9][0-9]*){re.escape(ending)}")
    siblings = bag.parent.iterdir() if bag.parent.is_dir() else ()
    matches = ((pattern.fullmatch(path.name), path) for path in siblings)
    return sorted((int(match[1]), path) for match, path in matches if match)
