import os
import socket
from collections.abc import Callable
from pathlib import Path

import pytest

from thbridge.files.disk.new_file import new_file
from thbridge.files.disk.regular_files import content_of, is_regular
from thbridge.files.disk.text_files import read_text
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile
from thbridge.files.image_files import read_image
from thbridge.files.resources import shipped
from thbridge.files.template_lines import numbered_lines
from thbridge.mavlink.files.signing_key import read_signing_key
from thbridge.recording.bag.damage import check_is_bag
from thbridge.recording.journal import read_journal

READERS: list[Callable[[Path], object]] = [
    read_text,
    read_image,
    numbered_lines,
    read_signing_key,
    check_is_bag,
    read_journal,
]


@pytest.mark.parametrize("read", READERS)
def test_a_pipe_in_a_files_place_is_refused_and_not_waited_for(read: Callable[[Path], object], tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(BadFile, match="this is a pipe, not a file"):
        read(tmp_path / "pipe")


@pytest.mark.parametrize("read", READERS)
def test_a_device_that_never_ends_is_refused(read: Callable[[Path], object]) -> None:
    with pytest.raises(BadFile, match="this is a device, not a file"):
        read(Path("/dev/zero"))


@pytest.mark.parametrize("read", READERS)
def test_a_nul_in_a_name_is_a_fault_of_the_name(read: Callable[[Path], object]) -> None:
    with pytest.raises(BadFile, match="cannot contain a NUL"):
        read(Path("a\0b"))


@pytest.mark.parametrize("read", READERS)
def test_a_name_that_is_too_long_is_a_fault_of_the_name(read: Callable[[Path], object]) -> None:
    with pytest.raises(BadFile, match=r"(?i)file name too long"):
        read(Path("x" * 300))


def test_a_socket_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind("socket")
        with pytest.raises(BadFile, match="this is a socket, not a file"):
            content_of(Path("socket"))


def test_names_that_no_file_can_have_are_no_files(tmp_path: Path) -> None:
    assert not any(is_regular(tmp_path / name) for name in ("a\0b", "x" * 300, "none"))
    (tmp_path / "a").touch()
    assert is_regular(tmp_path / "a")


@pytest.mark.parametrize("wanted", ["x" * 500_000, "./" + "x" * 500_000, "./" + "x" * 300, "./a\0b", "a\0b"])
def test_a_map_of_a_name_that_none_can_have_is_refused_shortly(wanted: str) -> None:
    with pytest.raises(BadFile) as raised:
        shipped().find("maps", wanted, Path())
    assert len(str(raised.value)) < 2500


def test_a_nul_in_a_text_is_told_with_its_line(tmp_path: Path) -> None:
    file = tmp_path / "a"
    file.write_bytes(b"one\ntwo\0")
    for read in (read_text, numbered_lines):
        with pytest.raises(BadFile, match=r"line 2: the file contains a NUL"):
            read(file)


def test_a_device_is_written_to_and_never_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_whole(tmp_path / "pipe", b"page")
        assert os.read(reader, 10) == b"page"
    finally:
        os.close(reader)
    with (
        pytest.raises(BadFile, match="not a regular file"),
        new_file(tmp_path / "pipe", tmp_path / "bag", overwrite=True),
    ):
        pass
    assert (tmp_path / "pipe").is_fifo()
