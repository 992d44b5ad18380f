import errno
import os
from pathlib import Path

import pytest

from thbridge.batch.whole_files import whole_file
from thbridge.files.errors import BadFile


def test_a_file_is_there_once_it_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "new" / "file"
    with whole_file(path) as file:
        file.write(b"all")
        assert not path.exists()
    assert path.read_bytes() == b"all"


def test_a_full_disk_leaves_the_file_that_was_there_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    path = tmp_path / "file"
    path.write_bytes(b"before")
    monkeypatch.setattr(os, "fsync", full)
    told = r"it cannot be written \(No space left on device\)\. Make room, then go on\."
    with pytest.raises(BadFile, match=told), whole_file(path) as file:
        file.write(b"after")
    assert [each.read_bytes() for each in tmp_path.iterdir()] == [b"before"]


def test_of_two_who_begin_at_once_the_first_counts(tmp_path: Path) -> None:
    path = tmp_path / "file"
    for content in (b"first", b"second"):
        with whole_file(path, exclusive=True) as file:
            file.write(content)
    assert [each.read_bytes() for each in tmp_path.iterdir()] == [b"first"]
