import errno
import os
from pathlib import Path

import pytest

from thbridge.files.disk.whole import new_folder, whole_file, write_whole
from thbridge.files.errors import BadFile


def test_a_file_is_there_once_it_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "new" / "file"
    with whole_file(path, folders=True) as file:
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
    told = r"it cannot be written \(No space left on device\)\. Check the folder and the disk\."
    with pytest.raises(BadFile, match=told), whole_file(path) as file:
        file.write(b"after")
    assert [each.read_bytes() for each in tmp_path.iterdir()] == [b"before"]


def test_an_exclusive_file_is_never_replaced(tmp_path: Path) -> None:
    path = tmp_path / "file"
    write_whole(path, b"first")
    with pytest.raises(FileExistsError), whole_file(path, exclusive=True) as file:
        file.write(b"second")
    assert [each.read_bytes() for each in tmp_path.iterdir()] == [b"first"]


def test_permissions_and_links_are_kept(tmp_path: Path) -> None:
    path, link = tmp_path / "file", tmp_path / "link"
    path.write_bytes(b"before")
    path.chmod(0o640)
    link.symlink_to(path)
    write_whole(link, b"after")
    assert link.is_symlink()
    assert (path.read_bytes(), path.stat().st_mode & 0o777) == (b"after", 0o640)
    write_whole(path, b"secret", mode=0o600)
    assert path.stat().st_mode & 0o777 == 0o600


def test_a_folder_is_there_once_it_is_complete(tmp_path: Path) -> None:
    folder = tmp_path / "above" / "new"
    with new_folder(folder) as new:
        (new / "file").write_bytes(b"all")
        assert not folder.exists()
    assert [path.name for path in folder.parent.rglob("*")] == ["new", "file"]
    with pytest.raises(BadFile, match="the folder already exists"), new_folder(folder):
        pass
    with pytest.raises(BadFile, match="this folder is not empty"), new_folder(folder, empty=True):
        pass


@pytest.mark.parametrize("there", [True, False])
def test_of_a_folder_that_cannot_be_filled_nothing_is_left(tmp_path: Path, there: bool) -> None:
    folder = tmp_path / "new"
    if there:
        folder.mkdir()
    with pytest.raises(BadFile) as fault, new_folder(folder, empty=True) as new:
        (new / "file").write_bytes(b"all")
        write_whole(new / "missing" / "file", b"all")
    assert fault.value.path == folder / "missing" / "file"
    assert [*tmp_path.rglob("*")] == ([folder] if there else [])


def test_an_empty_folder_is_filled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with new_folder(Path(), empty=True) as new:
        (new / "file").write_bytes(b"all")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
