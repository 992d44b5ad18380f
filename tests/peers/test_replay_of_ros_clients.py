"""What ROS's own clients did to running robots is done again by a replay, to the last bit."""

import json
import subprocess
from pathlib import Path

from tests.peers.beside import NEEDS_ROS, session
from tests.system.programs import THBRIDGE
from thbridge.app.inputs import Asked
from thbridge.app.replay import ticks_of

pytestmark = NEEDS_ROS

AT = "{position: {x: 0.5, y: 0.5}, orientation: {w: 1.0}}"
PLACE = f"{{header: {{frame_id: map}}, pose: {AT}}}"
BELIEF = (
    f"{{header: {{frame_id: map}}, pose: {{pose: {AT}, covariance: {[0.1 * (i in (0, 7, 35)) for i in range(36)]}}}}}"
)


def test_robots_do_again_what_they_did_for_ros_clients(tmp_path: Path) -> None:
    with session(tmp_path, "--bag", "live.bag") as (ros, robots):
        ros.says("rostopic", "pub", "-1", "/robot1/move_base_simple/goal", "geometry_msgs/PoseStamped", PLACE)
        ros.says("rostopic", "pub", "-1", "/robot2/initialpose", "geometry_msgs/PoseWithCovarianceStamped", BELIEF)
        ros.says("rostopic", "pub", "-1", "/robot2/cmd_vel", "geometry_msgs/Twist", "{angular: {z: 0.3}}")
        ros.says("rosparam", "set", "/robot1/amcl/max_particles", "444")
        ros.says("rosservice", "call", "/robot2/global_localization")
        ros.says("rosservice", "call", "/robot1/move_base/clear_costmaps")
        ros.says("rostopic", "pub", "-1", "/robot1/move_base/cancel", "actionlib_msgs/GoalID", "{}")
        assert robots.stop() == 0
    inputs = [item for tick in ticks_of(tmp_path / "live.bag") for item in tick.inputs]
    asked = {type(item.request).__name__ for item in inputs if isinstance(item, Asked)}
    kinds = {
        "SimpleGoal",
        "InitialPose",
        "VelocityCommand",
        "SetParameters",
        "Globalize",
        "ClearCostmaps",
        "CancelRequest",
    }
    assert asked == kinds
    done = subprocess.run(
        [*THBRIDGE, "replay", "live.bag", "--json"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert json.loads(done.stdout)["equal"]
