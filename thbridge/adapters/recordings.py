"""Where recordings lie: a bag, its journal beside it, and older ones of the same name."""

from pathlib import Path

from thbridge.adapters.bag_writer import ACTIVE


def journal_of(bag: Path) -> Path:
    """The folder of the journal that goes with a bag."""
    return bag.with_name(bag.name.removesuffix(".bag") + ".journal")


def make_room(bag: Path) -> Path | None:
    """Move an older recording of this name out of the way, with its journal; nothing recorded is overwritten.

    Returns:
        Where the older bag is now, or None when there was none.

    Raises:
        OSError: it cannot be moved.
    """
    journal, active = journal_of(bag), bag.with_name(bag.name + ACTIVE)
    if not any(path.exists() for path in (bag, journal, active)):
        return None
    stem = bag.name.removesuffix(".bag")
    number = next(n for n in range(1, 10**6) if not any(bag.parent.glob(f"{stem}-{n}.*")))
    moved = bag.with_name(f"{stem}-{number}.bag")
    for path, target in ((bag, moved), (active, moved.with_name(moved.name + ACTIVE)), (journal, journal_of(moved))):
        if path.exists():
            path.rename(target)
    return moved


def try_place(bag: Path) -> None:
    """See that a bag can be recorded there, before anything that takes time is done.

    Raises:
        OSError: it cannot.
    """
    active = bag.with_name(bag.name + ACTIVE)
    bag.parent.mkdir(parents=True, exist_ok=True)
    with active.open("xb"):
        active.unlink()
