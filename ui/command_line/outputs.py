"""Paths and permissions of the files that commands write."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from thbridge.files.errors import BadFile
from thbridge.recording.bag.options import Compression, Readers
from thbridge.recording.bag.recording_names import problem_of
from thbridge.recording.recordings import reserve
from ui.command_line.terminal import BAD_INPUT, fail

STANDARD_OUTPUT = Path("-")

_umask_of_account: list[int] = []


def keep_to_owner() -> None:
    """Make new files readable only by their owner, because they contain data about people and hidden treasures."""
    _umask_of_account.append(os.umask(Readers.OWNER.umask))


def share_outputs() -> None:
    """Use the account's umask for new files: they contain no data about people, or the user named them with --to."""
    if _umask_of_account:
        os.umask(_umask_of_account[-1])


@contextmanager
def destination(path: Path, suffix: str = "") -> Iterator[Path]:
    """Yield the path of the file to write. For `-`, yield a temporary file; copy it to standard output at the end."""
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
        fail(BAD_INPUT, "--json: standard output is already used for the file. Omit --json, or choose another file.")


def make_ready(bag: Path, compression: Compression, option: str = "--bag") -> None:
    """Check that a session can be recorded at a path, and claim the path. An older recording stays in place."""
    if (problem := problem_of(bag, compression)) is not None:
        fail(BAD_INPUT, f"{option}: {problem}")
    try:
        reserve(bag)
    except BadFile as taken:
        fail(BAD_INPUT, f"{option}: {taken}")
    except OSError as error:
        fail(BAD_INPUT, f"{bag}: the bag cannot be written ({error.strerror}). Choose another file with {option}.")


def make_copy_ready(copy: Path, recording: Path, compression: Compression) -> None:
    """Check that a replay can write its bag to the path of --to, and that this is not the replayed recording."""
    if copy.resolve() == recording.resolve():
        fail(BAD_INPUT, f"--to: {copy} is the recording itself. Choose another file name.")
    make_ready(copy, compression, "--to")
