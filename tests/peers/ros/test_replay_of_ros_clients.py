"""What ROS's own clients did to running robots is done again by a replay, to the last bit."""

from pathlib import Path

import pytest

from tests.peers.ros import rospy_scripts
from tests.peers.ros_programs import NEEDS_ROS, session
from tests.support.hunts.recorded_hunts import replay_again
from thbridge.app.replay.replay import ticks_of
from thbridge.app.session.inputs import ClientRequest

pytestmark = NEEDS_ROS


@pytest.mark.slow
def test_robots_do_again_what_they_did_for_ros_clients(tmp_path: Path) -> None:
    with session(tmp_path, "--bag", "live.bag") as (ros, robots):
        assert ros.script(rospy_scripts.ASKING)
        assert robots.stop() == 0
    inputs = [item for tick in ticks_of(tmp_path / "live.bag") for item in tick.inputs]
    asked = {type(item.request).__name__ for item in inputs if isinstance(item, ClientRequest)}
    kinds = {
        "SimpleGoal",
        "InitialPose",
        "VelocityCommand",
        "SetParameters",
        "GlobalLocalization",
        "ClearCostmaps",
        "CancelRequest",
    }
    assert asked == kinds
    done = replay_again(tmp_path / "live.bag")
    assert done.finished
    assert done.difference is None
