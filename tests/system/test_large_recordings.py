"""Recordings of any length are looked into in bounded memory."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from thbridge.files.ros.definitions import Definitions
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.publisher import TeamPublisher

ROBOTS, TICKS = 2, 3000
MEGABYTES = 12.0
OTHERS = (
    ("bag", "info", "{}"),
    ("bag", "check", "{}"),
    ("bag", "cut", "{}", "--to", "{}.part"),
    ("bag", "to-mcap", "{}"),
    ("report", "{}"),
)


def write(bag: Path, ticks: int) -> Path:
    publisher = TeamPublisher(ROBOTS, MOUNT, SCAN_PERIOD)
    with BagWriter(bag, Definitions(())) as writer:
        for message in publisher.opening(0, SESSION, arena()):
            writer.write(message)
        for snapshot in snapshots(ROBOTS, ticks):
            for message in publisher.tick(snapshot, records(snapshot.tick)):
                writer.write(message)
    return bag


@pytest.fixture(scope="module")
def bags(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("large")
    return write(folder / "long.bag", TICKS), write(folder / "longer.bag", 2 * TICKS)


def peak(arguments: Sequence[object]) -> float:
    """Maximum memory of the program, MB."""
    program = [sys.executable, "-c", "from ui.cli import main; main()", *map(str, arguments)]
    started = subprocess.Popen(program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(started.pid, 0)
    started.returncode = os.waitstatus_to_exitcode(status)
    assert started.returncode == 0
    return used.ru_maxrss / 1024.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    [
        ("bag", "export", "{}", "--to", "{}.tables", "--format", "both"),
        *OTHERS,
    ],
    ids=lambda words: words[0 if words[0] == "report" else 1],
)
def test_twice_the_recording_takes_no_more_memory(command: Sequence[str], bags: tuple[Path, Path]) -> None:
    long, longer = (peak([word.format(bag) for word in command]) for bag in bags)
    assert longer - long < MEGABYTES
