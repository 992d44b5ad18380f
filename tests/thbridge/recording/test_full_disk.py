"""Real disks without room: small ones in memory, which only root can mount."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from thbridge.app.session.broadcast import Broadcast
from thbridge.files.ros.definitions import Definitions
from thbridge.recording.bag.options import Compression, SplitLimits
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.writing.disk import BagNotWritten
from thbridge.recording.bag.writing.writer import WHOLE, BagWriter
from thbridge.recording.recordings import parts_of
from thbridge.ros.publisher import TeamPublisher

PLAIN = Definitions(())
TICKS = 600


@pytest.fixture(params=[500, 700])
def disk(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Path]:
    """A disk of so many KiB."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={request.param}k", "none", str(folder)]
    if shutil.which("mount") is None or os.getuid() != 0 or subprocess.run(mount, check=False).returncode:
        pytest.skip("cannot mount a disk here")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


def record(path: Path, compression: Compression, splitting: SplitLimits) -> None:
    writer = BagWriter(path, PLAIN, compression=compression, splitting=splitting)
    with writer:
        recorder = Broadcast(TeamPublisher(2, MOUNT, SCAN_PERIOD), SESSION, arena(), [writer])
        for snapshot in snapshots(2, TICKS):
            recorder.record(snapshot, records(snapshot.tick))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The recording that has the room it needs."""
    path = tmp_path_factory.mktemp("whole") / "a.bag"
    record(path, Compression.NONE, WHOLE)
    return path


@pytest.mark.parametrize("splitting", [WHOLE, SplitLimits(size=300_000)])
@pytest.mark.parametrize("compression", [Compression.NONE, Compression.LZ4])
def test_a_recording_on_a_full_disk_is_complete_but_for_its_end(
    disk: Path, whole: Path, compression: Compression, splitting: SplitLimits
) -> None:
    with pytest.raises(BagNotWritten, match=r"no space left.*everything except the last second") as raised:
        record(disk / "a.bag", compression, splitting)
    assert raised.value.path in parts_of(disk / "a.bag")
    assert not list(disk.glob("*.active"))
    said = [message.data for message in messages(whole)]
    kept = [message.data for message in messages(disk / "a.bag")]
    assert kept == said[: len(kept)]
    used = sum(len(data) for data in kept)
    if compression is Compression.NONE:
        # Full but for a chunk, the index, and what a file system itself takes.
        assert used > 0.4 * shutil.disk_usage(disk).total
    else:
        assert used > shutil.disk_usage(disk).total
