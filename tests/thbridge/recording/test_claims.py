"""A recording's name belongs to one running program."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from thbridge.files.errors import BadFile
from thbridge.recording.bag.writing.disk import BagNotWritten
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.recording.claims import lock_of
from thbridge.recording.recordings import active_of, make_room

RECORDS = """
import sys
from pathlib import Path
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.recording.recordings import make_room
make_room(Path(sys.argv[1]))
with BagWriter(Path(sys.argv[1])):
    print("recording", flush=True)
    sys.stdin.read()
"""


@contextmanager
def another_program(bag: Path) -> Iterator[subprocess.Popen[str]]:
    """A program that records until its input ends."""
    process = subprocess.Popen(
        [sys.executable, "-c", RECORDS, str(bag)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    try:
        assert process.stdout.readline() == "recording\n"
        yield process
    finally:
        process.kill()
        process.communicate()


def test_who_comes_second_is_told_by_whom_and_moves_nothing(tmp_path: Path) -> None:
    bag = tmp_path / "run.bag"
    with another_program(bag) as first:
        for begin in (make_room, BagWriter):
            with pytest.raises(
                (BadFile, BagNotWritten), match=rf"process {first.pid} .*, since 2.* is recording there"
            ):
                begin(bag)
        assert active_of(bag).exists()
        first.communicate("")
    assert bag.exists()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.bag"], "nothing is left of the lock"


def test_a_program_that_was_killed_has_nothing_any_more(tmp_path: Path) -> None:
    bag = tmp_path / "run.bag"
    with another_program(bag) as first:
        os.kill(first.pid, signal.SIGKILL)
        first.wait()
    assert lock_of(bag).exists()
    make_room(bag)
    with BagWriter(bag):
        pass
    assert bag.exists()
    assert not lock_of(bag).exists()


def test_one_program_records_under_a_name_again_and_again(tmp_path: Path) -> None:
    for _ in range(3):
        make_room(tmp_path / "run.bag")
        with BagWriter(tmp_path / "run.bag"):
            pass
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run-1.bag", "run-2.bag", "run.bag"]
