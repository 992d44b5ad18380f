"""SIGKILL while a real hunt is recorded: at most a second is lost, all before it is what an uninterrupted hunt says.

Every case is recovered by our `reindex` and, where it is installed, by ROS's.
"""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path

import pytest

from tests.support.programs.peer_programs import run_peer
from tests.system.cut_recordings import PATIENCE, SPIED_PLAY, STUDY, Said, by_stamp, lost_seconds, recorded_ticks
from thbridge.recording.bag.repair import reindex
from thbridge.recording.recordings import ACTIVE, parts_of


def play(folder: Path, compression: str, split: bool, rate: float, name: str = "a.bag") -> subprocess.Popen[bytes]:
    study = STUDY.format(compression=compression, split_size="0.5" if split else "null")
    (folder / "study.yaml").write_text(study)
    arguments = ["play", "study.yaml", "--port", "0", "--rate", str(rate), "--bag", name, "--json"]
    return subprocess.Popen(
        [sys.executable, "-c", SPIED_PLAY, *arguments], cwd=folder, stdout=subprocess.DEVNULL, start_new_session=True
    )


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Said]:
    """The hunt that nobody interrupts."""
    folder = tmp_path_factory.mktemp("whole")
    assert play(folder, "none", False, 0).wait(PATIENCE) == 0
    return by_stamp(folder / "a.bag")


@pytest.fixture(scope="module")
def whole_of_ros2(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Said]:
    """The same hunt as an MCAP file; its messages lack what ROS 2 does not have."""
    folder = tmp_path_factory.mktemp("whole")
    assert play(folder, "none", False, 0, "a.mcap").wait(PATIENCE) == 0
    return by_stamp(folder / "a.mcap")


def killed_play(folder: Path, case: int, name: str, packed: str) -> tuple[str, dict[int, float], float]:
    """Play, and kill; what was tried, the times of the recorded ticks, and the time of the kill."""
    chance = random.Random(case)
    compression = ("none", "lz4", packed)[case % 3]
    split = case // 3 % 2 == 1
    rate, longest = ((0, 4.0), (1, 6.0))[case // 6 % 2]
    process = play(folder, compression, split, rate, name)
    ticks = folder / "ticks"
    end = time.monotonic() + PATIENCE
    while not (ticks.exists() and ticks.stat().st_size):
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.01)
    time.sleep(chance.uniform(0.0, longest))
    process.send_signal(signal.SIGKILL)
    killed = time.monotonic()
    process.wait()
    return f"{name}, {compression}{', split' if split else ''}, rate {rate}", recorded_ticks(ticks), killed


def kill_and_recover(folder: Path, whole: dict[int, Said], case: int) -> tuple[str, float, float]:
    """Play, kill, recover; what was tried, and the seconds lost to our reindex and to ROS's."""
    told, recorded, killed = killed_play(folder, case, "a.bag", "bz2")
    active = [*folder.glob(f"a*{ACTIVE}")]
    theirs = folder / "theirs"
    theirs.mkdir()
    for path in [*parts_of(folder / "a.bag"), *active]:
        if path.exists():
            shutil.copy(path, theirs / path.name.removesuffix(ACTIVE))
    for path in active:
        reindex(path)
    lost = lost_seconds(folder / "a.bag", whole, recorded, killed)
    lost_to_ros = 0.0
    if shutil.which("rosbag"):
        for path in active:
            environment = {**os.environ, "HOME": str(folder)}
            environment.pop("PYTHONPATH", None)
            broken = theirs / path.name.removesuffix(ACTIVE)
            run_peer(["rosbag", "reindex", "-q", str(broken)], env=environment).check_returncode()
        lost_to_ros = lost_seconds(theirs / "a.bag", whole, recorded, killed)
    return told, lost, lost_to_ros


def kill_and_recover_ros2(folder: Path, whole: dict[int, Said], case: int) -> tuple[str, float]:
    """Play into an MCAP file or a folder, kill, recover; what was tried, and the seconds lost."""
    name = ("a.mcap", "a")[case % 2]
    told, recorded, killed = killed_play(folder, case, name, "zstd")
    for path in [folder / "a"] if name == "a" else [*folder.glob(f"a*{ACTIVE}")]:
        reindex(path)
    return told, lost_seconds(folder / name, whole, recorded, killed)


@pytest.mark.parametrize("case", [pytest.param(case, marks=pytest.mark.slow) for case in (1, 3, 8)])
def test_at_most_a_second_is_lost(tmp_path, whole, case, capsys):
    told, lost, lost_to_ros = kill_and_recover(tmp_path, whole, case)
    with capsys.disabled():
        print(f"\nkilled ({told}): {lost:.2f} s lost, {lost_to_ros:.2f} s to rosbag reindex")
    assert max(lost, lost_to_ros) <= 1.0


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_at_most_a_second_is_lost_fifty_times(tmp_path, whole, capsys):
    losses = defaultdict(list)
    for case in range(50):
        folder = tmp_path / str(case)
        folder.mkdir()
        told, *lost = kill_and_recover(folder, whole, case)
        losses[told].append(lost)
        shutil.rmtree(folder)
    with capsys.disabled():
        print()
        for told, cases in losses.items():
            ours, theirs = (max(lost) for lost in zip(*cases, strict=True))
            print(f"{told}: {len(cases)} kills, at most {ours:.2f} s lost, {theirs:.2f} s to rosbag reindex")
    assert max(lost for cases in losses.values() for pair in cases for lost in pair) <= 1.0


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_at_most_a_second_is_lost_of_twenty_recordings_of_ros_2(tmp_path, whole_of_ros2, capsys):
    losses = defaultdict(list)
    for case in range(20):
        folder = tmp_path / str(case)
        folder.mkdir()
        told, lost = kill_and_recover_ros2(folder, whole_of_ros2, case)
        losses[told].append(lost)
        shutil.rmtree(folder)
    with capsys.disabled():
        print()
        for told, cases in losses.items():
            print(f"{told}: {len(cases)} kills, at most {max(cases):.2f} s lost")
    assert max(lost for cases in losses.values() for lost in cases) <= 1.0
