"""Files that commands write: their places and permissions."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from thbridge.files.errors import BadFile
from thbridge.recording.bag.options import Readers
from thbridge.recording.claims import release
from thbridge.recording.recordings import make_room, try_place
from ui.command_line.terminal import BAD_INPUT, fail, note

STANDARD_OUTPUT = Path("-")

_umask_of_account: list[int] = []


def keep_to_owner() -> None:
    """Make new files readable only by their owner: they contain data about people, and treasures not yet found."""
    _umask_of_account.append(os.umask(Readers.OWNER.umask))


def share_outputs() -> None:
    """Create new files with the account's umask: they contain no data about people, or the user named them by --to."""
    if _umask_of_account:
        os.umask(_umask_of_account[-1])


@contextmanager
def destination(path: Path, suffix: str = "") -> Iterator[Path]:
    """Yield the path of the file to write; for `-` a temporary file, copied to standard output once it is complete."""
    if path != STANDARD_OUTPUT:
        yield path
        return
    with TemporaryDirectory(prefix="thbridge-") as folder:
        file = Path(folder) / f"output{suffix}"
        yield file
        sys.stdout.flush()
        sys.stdout.buffer.write(file.read_bytes())
        sys.stdout.buffer.flush()


def share_no_output(path: Path | None, as_json: bool) -> None:
    """Check that --json and a file do not both use standard output."""
    if path == STANDARD_OUTPUT and as_json:
        fail(BAD_INPUT, "--json: standard output is already used for the file. Omit --json, or name a file.")


def make_ready(bag: Path, option: str = "--bag") -> None:
    """Check that a bag can be recorded at a path, and rename an older bag there."""
    if bag.suffix != ".bag" or bag.is_dir():
        fail(BAD_INPUT, f"{option}: {bag} is not the name of a bag. Write a file name that ends in .bag.")
    try:
        moved = make_room(bag)
        try_place(bag)
    except BadFile as taken:
        fail(BAD_INPUT, f"{option}: {taken}")
    except OSError as error:
        release(bag)
        fail(BAD_INPUT, f"{bag}: cannot record there ({error.strerror}). Choose another file with {option}.")
    if moved is not None:
        note(f"The older recording was renamed to {moved}.")


def make_copy_ready(copy: Path, recording: Path) -> None:
    """Check that --to names a place for the bag of a replay that is not the replayed recording."""
    if copy.resolve() == recording.resolve():
        fail(BAD_INPUT, f"--to: {copy} is the recording itself. Write another name.")
    make_ready(copy, "--to")
