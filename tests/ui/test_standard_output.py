"""`-` means standard output: the file alone is there, and it is the file that would have been written."""

import subprocess
import sys
from pathlib import Path

import pytest
import yaml

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
    done = subprocess.run([sys.executable, "-c", PROGRAM, *arguments], cwd=folder, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert set(folder.iterdir()) == before
    return done.stdout


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
    assert "--json: standard output is for the file already." in done.stderr
    assert done.stdout == ""
