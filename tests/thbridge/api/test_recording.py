"""Recordings through `thbridge.api`."""

from pathlib import Path

import numpy as np
import pytest

from thbridge import api


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("recording") / "hunt.bag"
    study = api.HuntStudy(robots=2, seed=3, game={"energy": 20})
    with api.HuntSession(study, participant="nearest", record=path) as session:
        session.play()
    return path


def test_tables_and_arrays_hold_what_was_recorded(bag: Path) -> None:
    recording = api.HuntRecording(bag)
    odometry = recording.table("/robot2/odom")
    assert odometry.num_rows == recording.topics["/robot2/odom"]
    poses = recording.arrays("poses")
    assert set(poses["robot"]) == {"robot1", "robot2"}
    assert np.nanmax(poses["error_m"]) < 0.5
    statuses = recording.table("robot1_move_base_status.status_list")
    assert statuses.num_rows > 0


def test_messages_have_their_ros_names(bag: Path) -> None:
    found = list(api.HuntRecording(bag).messages("/robot1/odom", "/hunt/score"))
    assert {topic for _, topic, _ in found} == {"/robot1/odom", "/hunt/score"}
    assert found == sorted(found, key=lambda each: each[0])


def test_what_if_goes_to_the_end_and_is_compared(bag: Path, tmp_path: Path) -> None:
    done = api.HuntRecording(bag).replay({"seed": 4}, participant="random", to=tmp_path / "other.bag")
    assert not done.equal and done.difference is not None and done.difference.startswith("message ")
    assert done.recording is not None and done.recording.study.seed == 4
    assert done.recording.participant == "random"
    row = done.recording.figures().to_pylist()[0]
    assert row["robot"] == "robot1" and row["error_mean_m"] > 0.0


def test_faults_are_told(bag: Path, tmp_path: Path) -> None:
    recording = api.HuntRecording(bag)
    with pytest.raises(api.HuntError, match="no topic is called /odom"):
        recording.table("/odom")
    with pytest.raises(api.HuntError, match="no table is called odometry"):
        recording.table("odometry")
    with pytest.raises(api.HuntError, match="is the recording itself"):
        recording.replay(to=bag)
    with pytest.raises(api.HuntError, match="unknown key"):
        recording.replay({"sed": 4})
    with pytest.raises(api.HuntError, match="no strategy"):
        recording.replay(participant="clever")  # type: ignore[arg-type]
    with pytest.raises(api.HuntError, match="no such file"):
        api.HuntRecording(tmp_path / "nowhere.bag")
    (tmp_path / "text.bag").write_text("no bag")
    with pytest.raises(api.HuntError, match="not a ROS 1 bag"):
        api.HuntRecording(tmp_path / "text.bag")
