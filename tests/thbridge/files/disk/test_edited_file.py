from pathlib import Path

import pytest

from thbridge.files.disk.edited_file import TextOnDisk, read_edited, write_edited
from thbridge.files.errors import BadFile


def test_a_text_is_read_and_written_to_the_byte(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    data = b"\xef\xbb\xbfmap: arena8\r\nrobots: 2\n"
    path.write_bytes(data)
    read = read_edited(path)
    assert read == TextOnDisk("map: arena8\r\nrobots: 2\n", exists=True, marked=True)
    assert write_edited(path, read.text, read.marked) == read
    assert path.read_bytes() == data


def test_a_missing_file_is_empty_and_a_missing_folder_is_told(tmp_path: Path) -> None:
    assert read_edited(tmp_path / "a.yaml") == TextOnDisk("", exists=False)
    with pytest.raises(BadFile, match=r"folder .* does not exist"):
        read_edited(tmp_path / "none" / "a.yaml")


def test_permissions_and_links_stay(tmp_path: Path) -> None:
    path, link = tmp_path / "a.yaml", tmp_path / "link.yaml"
    path.write_text("robots: 2\n")
    path.chmod(0o640)
    link.symlink_to(path)
    write_edited(link, "robots: 3\n", marked=False)
    assert link.is_symlink()
    assert path.read_text() == "robots: 3\n"
    assert path.stat().st_mode & 0o777 == 0o640


def test_what_cannot_be_written_is_told_and_leaves_nothing_behind(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("robots: 2\n")
    with pytest.raises(BadFile, match="cannot be written"):
        write_edited(path, "map: \ud800\n", marked=False)
    assert path.read_text() == "robots: 2\n"
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(BadFile, match="cannot be written"):
        write_edited(tmp_path / "none" / "a.yaml", "", marked=False)
