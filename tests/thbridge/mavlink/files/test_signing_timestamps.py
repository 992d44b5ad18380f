"""The file of timestamps beside a signing key."""

import pytest

from thbridge.mavlink.files.signing_timestamps import TimestampFile
from thbridge.mavlink.wire.frames.signing import KnownTimestamps

KNOWN = KnownTimestamps(700, {(0, 255, 190): 700, (3, 254, 190): 5})


def test_what_is_written_is_read_and_nobody_else_reads_it(tmp_path):
    file = TimestampFile(tmp_path / "my.key")
    assert file.read() is None
    file.write(KnownTimestamps(1, {}))
    file.write(KNOWN)
    assert TimestampFile(tmp_path / "my.key").read() == KNOWN
    assert [(each.name, each.stat().st_mode & 0o777) for each in tmp_path.iterdir()] == [("my.key.timestamps", 0o600)]


@pytest.mark.parametrize(
    "damaged",
    [
        "",
        "{",
        "[]",
        "[" * 100_000,
        '{"format": "thbridge signing timestamps 1", "latest": 5, "streams": [[0, 1, 2, 6]]}',
        '{"format": "thbridge signing timestamps 1", "latest": 5, "streams": [[0, 1, 2]]}',
        '{"format": "thbridge signing timestamps 1", "latest": -1, "streams": []}',
        '{"format": "thbridge signing timestamps 9", "latest": 5, "streams": []}',
        b"\xff\xfe",
    ],
)
def test_a_damaged_file_is_told_and_is_as_none(tmp_path, caplog, damaged):
    (tmp_path / "key.timestamps").write_bytes(damaged if isinstance(damaged, bytes) else damaged.encode())
    assert TimestampFile(tmp_path / "key").read() is None
    assert "cannot be used" in caplog.text


def test_a_folder_that_cannot_be_written_is_told_once(tmp_path, caplog):
    file = TimestampFile(tmp_path / "nowhere" / "key")
    file.write(KNOWN)
    file.write(KNOWN)
    assert len(caplog.records) == 1 and "cannot be written" in caplog.text
