"""A fleet whose robot is one of ROS's own making: rospy, tf2, and actionlib's SimpleActionServer and client."""

import asyncio
import json
import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.inputs import CancelGoal, DriveManually, SendGoal
from sim.parameters import live_parameters
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, NoPath
from tests.peers.ros_programs import knows
from tests.support.programs.peer_programs import run_peer, skipping_if_crashed
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros import names
from thbridge.ros.messages.goal_owners import GoalOwner
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.ros.reconfigure import described
from thbridge.ros.remote.robot import RemoteRobot
from thbridge.rosgraph.files.real_robots import FleetRecorder
from thbridge.rosgraph.sockets.fleet import Fleet
from thbridge.rosgraph.sockets.joining import GraphAddress
from thbridge.rosgraph.sockets.master_server import MasterServer
from thbridge.rosgraph.sockets.node import NodeStarted
from thbridge.sockets.addresses import ListeningAddress
from thbridge.study.real_robots import FleetNames, FleetSection

PYTHON = "/usr/bin/python3"
HIDDEN = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV")
CLEAN = {name: value for name, value in os.environ.items() if name not in HIDDEN}

ROBOT = """
import math
import actionlib, rospy, tf2_ros
from geometry_msgs.msg import Twist, TransformStamped
from move_base_msgs.msg import MoveBaseAction, MoveBaseFeedback, MoveBaseResult
from nav_msgs.msg import Odometry

rospy.init_node("kobuki")
x, y = 0.0, 0.0
out = rospy.Publisher("/kobuki/odom", Odometry, queue_size=10)
frames = tf2_ros.TransformBroadcaster()
tick = 0.05

def speak(event):
    said = Odometry()
    said.header.stamp, said.header.frame_id, said.child_frame_id = rospy.Time.now(), "odom", "base_link"
    said.pose.pose.position.x, said.pose.pose.position.y, said.pose.pose.orientation.w = x, y, 1.0
    out.publish(said)
    frame = TransformStamped()
    frame.header.stamp, frame.header.frame_id, frame.child_frame_id = said.header.stamp, "map", "odom"
    frame.transform.translation.x, frame.transform.rotation.w = 10.0, 1.0
    frames.sendTransform(frame)

def by_hand(told):
    global x
    x += told.linear.x * tick

def drive(goal):
    global x, y
    there = goal.target_pose.pose.position
    if there.x > 50:
        server.set_aborted(MoveBaseResult(), "Failed to find a valid plan. Even after executing recovery behaviors.")
        return
    while True:
        left = math.hypot(there.x - 10 - x, there.y - y)
        if left < 0.05:
            server.set_succeeded(MoveBaseResult(), "Goal reached.")
            return
        if server.is_preempt_requested():
            server.set_preempted()
            return
        step = min(1.0, 1.5 * tick / left)
        x, y = x + step * (there.x - 10 - x), y + step * (there.y - y)
        server.publish_feedback(MoveBaseFeedback(goal.target_pose))
        rospy.sleep(tick)

rospy.Subscriber("/kobuki/cmd_vel", Twist, by_hand)
server = actionlib.SimpleActionServer("/kobuki/move_base", MoveBaseAction, drive, False)
server.start()
timer = rospy.Timer(rospy.Duration(tick), speak)
rospy.spin()
"""

CLIENT = """
import sys
import actionlib, rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
rospy.init_node("rviz")
client = actionlib.SimpleActionClient("/kobuki/move_base", MoveBaseAction)
client.wait_for_server(rospy.Duration(60))
print("ready", flush=True)
sys.stdin.readline()
goal = MoveBaseGoal()
goal.target_pose.header.frame_id = "map"
goal.target_pose.pose.position.x, goal.target_pose.pose.orientation.w = 11.0, 1.0
client.send_goal_and_wait(goal, rospy.Duration(60))
print(client.get_state())
"""

READER = """
import json, sys
import rosbag
with rosbag.Bag(sys.argv[1]) as bag:
    told = [[topic, message._type, connection["callerid"].decode()]
            for topic, message, _, connection in bag.read_messages(return_connection_header=True)]
print(json.dumps(sorted(set(map(tuple, told[1:]))) + [told[0]]))
"""


pytestmark = pytest.mark.skipif(
    shutil.which("rosbag") is None or not knows("rospy", "actionlib", "tf2_ros", "move_base_msgs", "rosbag"),
    reason="not installed: rosbag, python3-actionlib, python3-tf2-ros (see scripts/install_peers.sh)",
)


@contextmanager
def ros(script: str, uri: str, folder: Path) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        [PYTHON, "-c", script],
        env={**CLEAN, "ROS_MASTER_URI": uri, "ROS_IP": "127.0.0.1", "ROS_LOG_DIR": str(folder)},
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        with skipping_if_crashed("rospy", process):
            yield process
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait(10)
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                stream.close()


class Ticks:
    """Steps a fleet, and records it."""

    def __init__(self, fleet: Fleet, recorder: FleetRecorder) -> None:
        self.fleet = fleet
        self.recorder = recorder

    async def there(self) -> None:
        while self.fleet.missing():
            self.recorder.flush()
            await asyncio.sleep(0.02)

    async def tick(self, *inputs: object):
        self.snapshot = self.fleet.step(inputs)
        self.recorder.record(self.snapshot, ())
        await asyncio.sleep(0.02)
        return self.snapshot.robots[0].navigation

    async def until_active(self) -> None:
        while (await self.tick()).state != "controlling":
            pass

    async def ended(self) -> object:
        while (result := (await self.tick()).result) is None:
            pass
        return result


async def _drive(folder: Path, bag: Path) -> None:
    named = FleetNames(namespace="/kobuki", odom_frame="odom", base_frame="base_link", recorded=())
    master = MasterServer(port=0)
    assert isinstance(await master.start(), ListeningAddress)
    with BagWriter(bag, caller=names.FLEET) as writer:
        recorder = FleetRecorder(writer, SessionRecord("", 1, {}, "simr", ("SimR",), ""))
        robots = [RemoteRobot(0, named.names(1), names.FLEET, np.zeros((0, 2)))]
        (offset,) = live_parameters(FleetSection)
        fleet = Fleet(GraphAddress(master.uri), robots, recorder, described(offset))
        assert isinstance(await fleet.start(), NodeStarted)
        ticks = Ticks(fleet, recorder)
        there, far = Goal(1, Pose2(12.0, 1.0, 0.0)), Goal(2, Pose2(16.0, 0.0, 0.0))
        with ros(ROBOT, master.uri, folder) as robot:
            await ticks.there()
            await ticks.tick(SendGoal(0, there))
            assert await ticks.ended() == GoalReached(there)
            here = ticks.snapshot.robots[0].estimate.base_in_map
            assert here.distance(there.base_in_map) < 0.2
            nowhere = Goal(3, Pose2(99.0, 0.0, 0.0))
            await ticks.tick(SendGoal(0, nowhere))
            end = await ticks.ended()
            assert isinstance(end, NoPath)
            assert end.reason == "no_way"
            await ticks.tick(SendGoal(0, far))
            await ticks.until_active()
            await ticks.tick(CancelGoal(0))
            assert await ticks.ended() == Cancelled(far)
            before = ticks.snapshot.robots[0].estimate.base_in_map.x
            await ticks.tick(DriveManually(0, Twist(1.0, 0.0), 25))
            while ticks.snapshot.robots[0].estimate.base_in_map.x <= before + 0.1:
                await ticks.tick()
            with ros(CLIENT, master.uri, folder) as client:
                assert client.stdin is not None and client.stdout is not None
                ready = asyncio.ensure_future(asyncio.to_thread(client.stdout.readline))
                while not ready.done():
                    await ticks.tick()
                assert ready.result() == "ready\n"
                await ticks.tick(SendGoal(0, far))
                await ticks.until_active()
                print(file=client.stdin, flush=True)
                assert await ticks.ended() == Cancelled(far)
                # Who cancelled it is told by another connection than what for.
                while (theirs := (await ticks.tick()).goal) is None:
                    pass
                assert theirs == Goal(0, Pose2(11.0, 0.0, 0.0), GoalOwner.STRANGER)
                while (await ticks.tick()).goal is not None:
                    pass
                assert await asyncio.to_thread(client.communicate) == ("3\n", None)
            await ticks.tick(SendGoal(0, far))
            await ticks.until_active()
            os.killpg(robot.pid, signal.SIGKILL)
            robot.wait()
        with ros(ROBOT, master.uri, folder):
            assert await ticks.ended() == GoalReached(far)
        await fleet.stop()
        recorder.flush()
    await master.stop()


def test_a_robot_of_ross_own_is_commanded_and_its_bag_read_by_ros(tmp_path: Path):
    bag = tmp_path / "real.bag"

    async def patient() -> None:
        async with asyncio.timeout(120):
            await _drive(tmp_path, bag)

    asyncio.run(patient())
    info = run_peer(["rosbag", "info", bag], env=CLEAN)
    assert "/kobuki/move_base/goal" in info.stdout, info.stderr
    read = run_peer([PYTHON, "-c", READER, str(bag)], env=CLEAN)
    assert read.returncode == 0, read.stderr
    *told, first = map(tuple, json.loads(read.stdout))
    assert first == ("/thbridge/session", "thbridge_msgs/Session", names.FLEET)
    assert ("/kobuki/odom", "nav_msgs/Odometry", "/kobuki") in told
    assert ("/tf", "tf2_msgs/TFMessage", "/kobuki") in told
    assert ("/kobuki/move_base/goal", "move_base_msgs/MoveBaseActionGoal", names.FLEET) in told
    assert ("/kobuki/move_base/goal", "move_base_msgs/MoveBaseActionGoal", "/rviz") in told
    assert ("/kobuki/move_base/result", "move_base_msgs/MoveBaseActionResult", "/kobuki") in told
    assert ("/kobuki/cmd_vel", "geometry_msgs/Twist", names.FLEET) in told
