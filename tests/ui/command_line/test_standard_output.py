"""`-` means standard output: the file alone is there, and it is the file that would have been written."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from tests.support.programs.commands import thbridge
from tests.support.slow import slow
from thbridge.recording.bag.reading.reader import info
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.topics import RosMessage, Topic

PROGRAM = "from ui.cli import main; main()"


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    path = tmp_path / "a.bag"
    with BagWriter(path) as writer:
        for second in (1, 2):
            writer.write(RosMessage(Topic("/chatter", "std_msgs/String"), second * 10**9, b"\x01\x00\x00\x00a"))
    return path


def written(folder: Path, *arguments: str) -> bytes:
    before = set(folder.iterdir())
    done = thbridge(folder, *arguments)
    assert done.exit_code == 0, done.stderr
    assert set(folder.iterdir()) == before
    return done.stdout_bytes


def test_a_study_goes_to_standard_output(tmp_path: Path) -> None:
    assert yaml.safe_load(written(tmp_path, "study", "init", "-"))["map"] == "arena8"


def test_a_cut_goes_to_standard_output(tmp_path: Path, bag: Path) -> None:
    data = written(tmp_path, "bag", "cut", str(bag), "--until", "0.5", "--to", "-")
    (tmp_path / "b.bag").write_bytes(data)
    assert info(tmp_path / "b.bag").messages == 1


def test_an_mcap_file_goes_to_standard_output(tmp_path: Path, bag: Path) -> None:
    data = written(tmp_path, "bag", "to-mcap", str(bag), "--to", "-")
    assert data.startswith(b"\x89MCAP0\r\n") and data.endswith(b"\x89MCAP0\r\n")


def test_a_report_goes_to_standard_output(tmp_path: Path, bag: Path) -> None:
    assert written(tmp_path, "report", str(bag), "--to", "-").rstrip().endswith(b"</html>")


def test_the_configuration_of_rviz_goes_to_standard_output(tmp_path: Path) -> None:
    assert written(tmp_path, "ros", "rviz", "--to", "-") == written(tmp_path, "ros", "rviz")


def test_standard_output_is_not_shared_with_json(tmp_path: Path, bag: Path) -> None:
    command = [sys.executable, "-c", PROGRAM, "bag", "cut", str(bag), "--to", "-", "--json"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, check=False, text=True)
    assert done.returncode == 2
    assert "--json: standard output is already used for the file." in done.stderr
    assert done.stdout == ""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
@pytest.mark.parametrize(
    ("words", "unbuffered"),
    [
        (("study", "init", "-"), ""),
        (("study", "init", "-"), "1"),
        *slow((("maps", "check", "arena8"), ""), (("maps", "check", "arena8"), "1")),
    ],
)
def test_a_result_that_has_no_room_is_told_once(tmp_path: Path, words: tuple[str, ...], unbuffered: str) -> None:
    with Path("/dev/full").open("w") as full:
        command = [sys.executable, "-c", PROGRAM, *words]
        # Without a buffer the command itself fails, with one the end of the program.
        environment = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
        done = subprocess.run(
            command, cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, check=False, text=True, env=environment
        )
    assert done.returncode == 2
    assert done.stderr == "the disk: no space left on device. Check the name, the folder and the disk.\n"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
def test_messages_that_have_no_room_change_nothing(tmp_path: Path) -> None:
    for words, code in ((("study", "init", "a.yaml"), 0), (("study", "init", "a.yaml"), 2)):
        with Path("/dev/full").open("w") as full:
            command = [sys.executable, "-c", PROGRAM, *words]
            done = subprocess.run(command, cwd=tmp_path, stderr=full, check=False)
        assert done.returncode == code
    assert yaml.safe_load((tmp_path / "a.yaml").read_text())["map"] == "arena8"


def test_whoever_reads_the_beginning_alone_is_no_fault(tmp_path: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-c", PROGRAM, "study", "init", "-"]
    done = subprocess.run(command, cwd=tmp_path, stdout=writing, stderr=subprocess.PIPE, check=False, text=True)
    os.close(writing)
    assert (done.returncode, done.stderr) == (1, "")
