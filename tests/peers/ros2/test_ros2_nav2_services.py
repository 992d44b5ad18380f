"""A client of rclpy calls Nav2's services of a session; what changes robots is recorded, and a replay repeats it."""

import json
from pathlib import Path

import pytest

from sim.inputs import TEAM_INPUTS, ClearCostmapRegion, GlobalLocalization, NomotionUpdate, SetPoseEstimate
from tests.peers.ros2.peer_process import environment
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.ports import free_domain, free_port
from tests.support.programs.processes import Program, until
from tests.support.project import ROOT
from thbridge.recording.bag.reading.reader import recorded
from thbridge.ros.names import INPUTS

ROS2 = ROOT / ".peers" / "ros2"
DOMAIN = str(free_domain())
SUCCEEDED, ABORTED = 4, 6

pytestmark = [
    pytest.mark.skipif(not (ROS2 / "interfaces" / "made_from").exists(), reason="not installed: interfaces of ROS 2"),
    pytest.mark.slow,
]


def test_services_of_nav2(tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text("ros2: {distribution: kilted}\n")
    session = Program(
        tmp_path, "simr", "--server", f"127.0.0.1:{free_port()}", "--ros2", "--ros2-domain", DOMAIN, "--bag", "run.bag",
        "study.yaml",
    )  # fmt: skip
    try:
        until("the session to join", lambda: "ROS 2:" in session.text, [session])
        client = Path(__file__).parent / "nav2_services_client.py"
        done = run_peer([ROS2 / "bin" / "python", client], env=environment(DOMAIN), timeout=180.0)
        session.stop()
    finally:
        session.close()
    assert done.returncode == 0, done.stderr + session.text
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["states"] == ["active"] * 5
    assert found["same lifecycle"]
    assert not found["deactivated"]
    assert found["managers"] == [[True, False]] * 2
    assert found["valid"] == [True, False, False, False]
    assert found["global_costmap"] == [[254.0, 254.0], False]
    assert found["local_costmap"] == [[254.0, 254.0], False]
    assert found["footprint"] == [[254.0], True]
    assert (found["map"], found["load"]) == (320, 255)
    assert found["costmap"] == [320, True]
    assert found["lethal"]
    assert found["path"] == [SUCCEEDED, 0, False]
    assert found["ends"] == [[1.0, 0.0], [3.0, 0.0]]
    assert found["outside"] == [ABORTED, 204, True]
    assert found["planner"] == [ABORTED, 201, True]
    replayed = Program(tmp_path, "replay", "run.bag")
    assert replayed.process.wait(120) == 0, replayed.text
    assert "the same, bit for bit" in replayed.text
    replayed.close()
    inputs = [bytes(data) for topic, _, data in recorded(tmp_path / "run.bag") if topic.topic == INPUTS]
    for request, count in ((ClearCostmapRegion, 3), (GlobalLocalization, 1), (NomotionUpdate, 1), (SetPoseEstimate, 1)):
        name = next(name for name, kind in TEAM_INPUTS.items() if kind is request)
        assert sum(f'"{name}"'.encode() in each for each in inputs) == count, name
