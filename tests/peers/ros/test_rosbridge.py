"""Dashboards: roslibpy and roslibjs on the graph of a session, through rosbridge_suite."""

import json
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from tests.peers.node import NEEDS_NODE, run_script
from tests.peers.ros.rosbridge import NEEDS_ROSBRIDGE, ROSLIBPY, rosbridge
from tests.peers.ros_programs import NEEDS_ROS, session
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.ports import free_port

pytestmark = [NEEDS_ROS, NEEDS_ROSBRIDGE]

BY_ROSLIBPY = """
import json, sys, threading
import roslibpy
from roslibpy.ros1.actionlib import ActionClient, Goal

ros = roslibpy.Ros("127.0.0.1", int(sys.argv[1]))
ros.run(timeout=30)
heard, enough = {}, threading.Event()

def hear(name, kind):
    def take(message):
        heard.setdefault(name, message)
        if len(heard) == 5:
            enough.set()
    roslibpy.Topic(ros, name, kind).subscribe(take)

hear("/map", "nav_msgs/OccupancyGrid")
hear("/robot1/scan", "sensor_msgs/LaserScan")
hear("/robot1/amcl_pose", "geometry_msgs/PoseWithCovarianceStamped")
hear("/tf", "tf2_msgs/TFMessage")
hear("/clock", "rosgraph_msgs/Clock")
assert enough.wait(60), sorted(heard)
empty = roslibpy.ServiceRequest()
plan = roslibpy.Service(ros, "/static_map", "nav_msgs/GetMap").call(empty)
client = ActionClient(ros, "/robot1/move_base", "move_base_msgs/MoveBaseAction")
here = heard["/robot1/amcl_pose"]["pose"]["pose"]
there = {"position": {**here["position"], "x": here["position"]["x"] + 1.0}, "orientation": here["orientation"]}
goal = Goal(client, roslibpy.Message({"target_pose": {"header": {"frame_id": "map"}, "pose": there}}))
goal.send()
goal.wait(60)
print(json.dumps({
    "map": [heard["/map"]["info"]["width"], len(heard["/map"]["data"]), plan["map"]["info"]["width"]],
    "beams": len(heard["/robot1/scan"]["ranges"]),
    "topics": ros.get_topics(),
    "particles": ros.get_param("/robot1/amcl/max_particles"),
    "status": goal.status["status"],
}))
ros.terminate()
"""

BY_ROSLIBJS = """
import * as ROSLIB from "roslib";

const ros = new ROSLIB.Ros({ url: `ws://127.0.0.1:${process.argv[2]}` });
const next = (name, messageType) => new Promise((heard) => {
  const topic = new ROSLIB.Topic({ ros, name, messageType });
  topic.subscribe((message) => { topic.unsubscribe(); heard(message); });
});
await new Promise((connected, failed) => { ros.on("connection", connected); ros.on("error", failed); });
const map = await next("/map", "nav_msgs/OccupancyGrid");
const scan = await next("/robot2/scan", "sensor_msgs/LaserScan");
const stamped = "geometry_msgs/PoseStamped";
const goals = new ROSLIB.Topic({ ros, name: "/robot2/move_base_simple/goal", messageType: stamped });
const pose = (await next("/robot2/amcl_pose", "geometry_msgs/PoseWithCovarianceStamped")).pose.pose;
const current = next("/robot2/move_base/current_goal", stamped);
const position = { ...pose.position, y: pose.position.y + 0.5 };
// The first may be said before the session has heard of the publisher.
setInterval(() => goals.publish({ header: { frame_id: "map" }, pose: { ...pose, position } }), 200);
const taken = await current;
console.log(JSON.stringify({ map: [map.info.width, map.data.length], beams: scan.ranges.length,
                             asked: position.y, taken: taken.pose.position.y }));
process.exit(0);
"""


@pytest.fixture(scope="module")
def port(tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    folder, port = tmp_path_factory.mktemp("rosbridge"), free_port()
    with ExitStack() as running:
        ros, _ = running.enter_context(session(folder))
        running.enter_context(rosbridge(ros, folder, port))
        yield port


@pytest.mark.skipif(not ROSLIBPY.exists(), reason="roslibpy is not installed (see scripts/install_peers.sh)")
def test_roslibpy_hears_asks_and_drives(port: int) -> None:
    command = [str(ROSLIBPY), "-c", BY_ROSLIBPY, str(port)]
    done = run_peer(command, timeout=200)
    assert done.returncode == 0, done.stdout + done.stderr
    said = json.loads(done.stdout.splitlines()[-1])
    assert said["map"] == [320, 320 * 240, 320]
    assert (said["beams"], said["particles"], said["status"]) == (181, 1000, 3)
    assert {"/robot1/move_base/goal", "/robot2/scan", "/tf"} <= set(said["topics"])


@NEEDS_NODE
def test_roslibjs_hears_and_sends_a_goal(port: int) -> None:
    said = json.loads(run_script(BY_ROSLIBJS, str(port)).splitlines()[-1])
    assert said["map"] == [320, 320 * 240]
    assert said["beams"] == 181
    assert said["taken"] == pytest.approx(said["asked"])
