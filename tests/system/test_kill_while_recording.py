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


def play(folder: Path, compression: str, split: bool, rate: float) -> subprocess.Popen[bytes]:
    study = STUDY.format(compression=compression, split_size="0.5" if split else "null")
    (folder / "study.yaml").write_text(study)
    arguments = ["play", "study.yaml", "--port", "0", "--rate", str(rate), "--bag", "a.bag", "--json"]
    return subprocess.Popen(
        [sys.executable, "-c", SPIED_PLAY, *arguments], cwd=folder, stdout=subprocess.DEVNULL, start_new_session=True
    )


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Said]:
    """The hunt that nobody interrupts."""
    folder = tmp_path_factory.mktemp("whole")
    assert play(folder, "none", False, 0).wait(PATIENCE) == 0
    return by_stamp(folder / "a.bag")


def kill_and_recover(folder: Path, whole: dict[int, Said], case: int) -> tuple[str, float, float]:
    """Play, kill, recover; what was tried, and the seconds lost to our reindex and to ROS's."""
    chance = random.Random(case)
    compression = ("none", "lz4", "bz2")[case % 3]
    split = case // 3 % 2 == 1
    rate, longest = ((0, 4.0), (1, 6.0))[case // 6 % 2]
    process = play(folder, compression, split, rate)
    ticks = folder / "ticks"
    end = time.monotonic() + PATIENCE
    while not (ticks.exists() and ticks.stat().st_size):
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.01)
    time.sleep(chance.uniform(0.0, longest))
    process.send_signal(signal.SIGKILL)
    killed = time.monotonic()
    process.wait()
    recorded = recorded_ticks(ticks)
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
    return f"{compression}{', split' if split else ''}, rate {rate}", lost, lost_to_ros


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
