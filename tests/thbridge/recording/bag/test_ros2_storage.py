"""Recordings of rosbag2 by others: what is packed, computed or repeated in them stays within bounds."""

import os
import sqlite3
from functools import cache
from pathlib import Path

import pytest
import zstandard
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from tests.support.bags.ros2_bags import written
from thbridge.files.errors import BadFile
from thbridge.recording.bag import ros2_storage
from thbridge.recording.bag.reading.reader import recorded
from thbridge.recording.recordings import METADATA

BOTH = pytest.mark.parametrize("storage", StoragePlugin)
MODES = [CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE]


@cache
def bomb(size: int) -> bytes:
    """Zeros, packed."""
    packer = zstandard.ZstdCompressor(level=1).compressobj()
    piece = bytes(1 << 20)
    return b"".join([*(packer.compress(piece) for _ in range(size >> 20)), packer.flush()])


@BOTH
@pytest.mark.parametrize("mode", MODES)
def test_packed_recordings_are_read_as_those_that_are_not(
    tmp_path: Path, storage: StoragePlugin, mode: CompressionMode
) -> None:
    folder = written(tmp_path / "said", storage, mode)
    texts = [data[4:] for _, _, data in recorded(folder)]
    assert texts == [b"word 0", b"word 1", b"word 2"]


@BOTH
def test_a_file_of_kilobytes_that_unpacks_to_half_a_gigabyte_is_refused(
    tmp_path: Path, storage: StoragePlugin, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = written(tmp_path / "said", storage, CompressionMode.FILE)
    (packed,) = folder.glob("*.zstd")
    packed.write_bytes(packed.read_bytes() + bomb(1 << 29))
    assert packed.stat().st_size < 1 << 17
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with pytest.raises(BadFile, match=r"the unpacked size is above the limit of \d+ bytes"):
        list(recorded(folder))
    kept = [path for path in tmp_path.rglob("*") if path.is_file() and path.parent != folder]
    assert kept == []


def test_a_message_of_kilobytes_that_unpacks_to_half_a_gigabyte_is_refused(tmp_path: Path) -> None:
    folder = written(tmp_path / "said", StoragePlugin.SQLITE3, CompressionMode.MESSAGE)
    with sqlite3.connect(folder / "said.db3") as database:
        database.execute("UPDATE messages SET data = ?", (bomb(1 << 29),))
    with pytest.raises(BadFile, match=r"the unpacked size is above the limit of \d+ bytes"):
        list(recorded(folder))


def compute_messages(folder: Path, size: int) -> None:
    """Let the database compute its messages, each of so many bytes, instead of holding them."""
    computed = f"data BLOB GENERATED ALWAYS AS (zeroblob({size})) VIRTUAL"
    with sqlite3.connect(folder / "said.db3") as database:
        database.executescript(f"""
            ALTER TABLE messages RENAME TO old;
            CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, {computed});
            INSERT INTO messages(id, topic_id, timestamp) SELECT id, topic_id, timestamp FROM old;
        """)


def test_messages_that_a_table_computes_are_no_more_than_its_file(tmp_path: Path) -> None:
    folder = written(tmp_path / "said", StoragePlugin.SQLITE3, CompressionMode.NONE)
    compute_messages(folder, 1_000_000)
    with pytest.raises(BadFile, match="more data than a recording of this size can contain"):
        list(recorded(folder))


def test_a_computed_message_of_a_gigabyte_is_not_even_made(tmp_path: Path) -> None:
    folder = written(tmp_path / "said", StoragePlugin.SQLITE3, CompressionMode.NONE)
    compute_messages(folder, 900_000_000)
    with pytest.raises(BadFile, match="the database expands"):
        list(recorded(folder))


def test_a_database_takes_no_more_steps_than_its_size_needs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = written(tmp_path / "said", StoragePlugin.SQLITE3, CompressionMode.NONE)
    monkeypatch.setattr(ros2_storage, "_STEPS_ALWAYS", 0)
    monkeypatch.setattr(ros2_storage, "_STEPS_BYTE", 0)
    monkeypatch.setattr(ros2_storage, "_STEPS_ONCE", 1)
    with pytest.raises(BadFile, match="the database expands"):
        list(recorded(folder))


def test_metadata_whose_aliases_multiply_are_refused(tmp_path: Path) -> None:
    folder = written(tmp_path / "said", StoragePlugin.MCAP, CompressionMode.NONE)
    levels = [f"a{number}: &a{number} [{', '.join([f'*a{number - 1}'] * 9)}]" for number in range(1, 12)]
    text = (folder / METADATA).read_text()
    laughs = "\n".join(["a0: &a0 [x]", *levels, text.replace("storage_identifier: mcap", "storage_identifier: *a11")])
    (folder / METADATA).write_text(laughs)
    with pytest.raises(BadFile, match="more than 1048576 values"):
        list(recorded(folder))


@pytest.mark.parametrize("mode", [CompressionMode.NONE, CompressionMode.FILE])
def test_a_pipe_in_the_place_of_a_file_is_not_waited_for(tmp_path: Path, mode: CompressionMode) -> None:
    folder = written(tmp_path / "said", StoragePlugin.MCAP, mode)
    (stored,) = folder.glob("said*.mcap*")
    stored.unlink()
    os.mkfifo(stored)
    with pytest.raises(BadFile, match="this is a pipe, not a file"):
        list(recorded(folder))
