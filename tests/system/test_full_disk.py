"""Programs on a disk that fills up end loudly, with recordings that are whole and go on once there is room."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.disks.small_disk import SmallDisk, why_not
from tests.support.programs import processes
from tests.support.programs.ports import free_port
from thbridge.recording.bag.reading.reader import info
from thbridge.recording.journal import journal_path, read_journal


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[SmallDisk]:
    if (reason := why_not()) is not None:
        pytest.skip(reason)
    with SmallDisk(tmp_path / "disk", 1_500_000) as disk:
        yield disk


def test_a_hunt_on_a_full_disk_ends_with_a_bag_that_is_whole(tmp_path: Path, disk: SmallDisk) -> None:
    play = processes.Program(tmp_path, "play", "--port", "0", "--rate", "0", "--bag", "disk/a.bag", "--no-report")
    try:
        assert play.process.wait(200) == 1, play.text
    finally:
        play.close()
    assert "no space left on device" in play.text
    assert "Traceback" not in play.text
    found = info(disk.folder / "a.bag")
    assert found.duration > 1.0
    assert found.size > 1_000_000


@pytest.mark.slow
def test_a_server_whose_journal_has_no_room_ends_and_goes_on_with_the_game_later(
    tmp_path: Path, disk: SmallDisk
) -> None:
    with disk.read_only():
        refused = processes.Program(tmp_path, "server", "--port", "0", "--journal", "disk/journal")
        assert refused.process.wait(200) == 2, refused.text
        refused.close()
    assert "journals cannot be kept here (Read-only file system)" in refused.text
    port = str(free_port())
    running = [processes.Program(tmp_path, "server", "--port", port, "--journal", "disk/journal")]
    for role in (["simr", "--rate", "10"], ["hider"], ["tabui"]):
        running.append(processes.Program(tmp_path, *role, "--server", f"127.0.0.1:{port}"))
    path = journal_path(disk.folder / "journal", 1)
    try:
        with disk.full(4096):
            assert running[0].process.wait(200) == 1, running[0].text
        assert "cannot be written (No space left on device)" in running[0].text
        assert "Traceback" not in running[0].text
        told = read_journal(path)
        assert told.torn is None
        running.append(running[0].again())
        processes.until("the game to go on", lambda: len(read_journal(path).events) > len(told.events) + 3, running)
        assert read_journal(path).events[: len(told.events)] == told.events
    finally:
        for program in running:
            program.close()
