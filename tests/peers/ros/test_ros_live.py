"""ROS 1's own tools beside a running session: rosnode, rostopic, rosparam, rosservice, actionlib, tf2, rosbag."""

import json
import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.peers.ros import rospy_scripts
from tests.peers.ros_programs import NEEDS_ROS, PATIENCE, Ros, session
from tests.support.programs.processes import until
from thbridge.recording.bag.reading.reader import RawMessage, messages

pytestmark = NEEDS_ROS

CORRIDOR = [[2.0, 0.0], [-2.0, 0.0]]


@pytest.fixture(scope="module")
def beside(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros]:
    with session(tmp_path_factory.mktemp("live")) as (ros, _):
        yield ros


def test_rosnode_sees_one_node_that_answers(beside: Ros) -> None:
    assert "/thbridge" in beside.says("rosnode", "list").split()
    assert "ping average" in beside.says("rosnode", "ping", "-c", "2", "/thbridge")
    told = beside.says("rosnode", "info", "/thbridge")
    assert "* /robot1/scan [sensor_msgs/LaserScan]" in told
    assert "* /robot1/move_base/make_plan" in told


def test_rostopic_hears_odometry_at_fifty_hertz_and_the_map_late(beside: Ros) -> None:
    with beside.running("rostopic", "hz", "-w", "200", "/robot1/odom") as process:
        assert process.stdout is not None
        told, end = "", time.monotonic() + PATIENCE
        while "window: 200" not in told:  # before, it is an average of few
            assert time.monotonic() < end, f"waited {PATIENCE} s for 200 messages; rostopic says {told}"
            line = process.stdout.readline()
            told = line if line.startswith("average rate") else told + line
    # By the session's clock, which is what rostopic goes by; the wall's may be slower than that on a busy machine.
    assert 45.0 < float(told.splitlines()[0].split()[-1]) < 55.0
    assert beside.says("rostopic", "echo", "-n", "1", "/map/info/width").split()[0] == "320"
    assert "robot2/base_laser" in beside.says("rostopic", "echo", "-n", "1", "/tf_static/transforms[3]/child_frame_id")


def test_time_is_the_sessions(beside: Ros) -> None:
    assert beside.says("rosparam", "get", "/use_sim_time").strip() == "true"
    first, second = (
        int(line) for line in beside.says("rostopic", "echo", "-n", "2", "/clock/clock/nsecs").split()[::2]
    )
    assert (second - first) % 1_000_000_000 == 20_000_000


def test_rosparam_finds_the_study_and_what_may_change_acts(beside: Ros) -> None:
    assert beside.says("rosparam", "get", "/robot2/move_base/base_global_planner").strip() == "navfn/NavfnROS"
    assert beside.says("rosparam", "get", "/thbridge/seed").strip() == "1"
    beside.says("rosparam", "set", "/robot2/amcl/min_particles", "321")
    beside.says("rosparam", "set", "/robot2/amcl/max_particles", "321")
    beside.says("rosservice", "call", "/robot2/request_nomotion_update")
    end = time.monotonic() + PATIENCE
    particles = 0
    while particles != 321 and time.monotonic() < end:
        beside.says("rosservice", "call", "/robot2/request_nomotion_update")
        said = beside.says("rostopic", "echo", "-n", "1", "/robot2/particlecloud/poses")
        particles = said.count("position:")
    assert particles == 321


def test_a_parameter_that_cannot_be_is_put_back(beside: Ros) -> None:
    before = beside.says("rosparam", "get", "/robot1/amcl/laser_model_type")
    beside.says("rosparam", "set", "/robot1/amcl/laser_model_type", "guess")
    end = time.monotonic() + PATIENCE
    while beside.says("rosparam", "get", "/robot1/amcl/laser_model_type") != before and time.monotonic() < end:
        time.sleep(0.1)
    assert beside.says("rosparam", "get", "/robot1/amcl/laser_model_type") == before


@pytest.mark.slow
def test_rosparam_dumps_and_loads_all_parameters_and_nothing_changes(beside: Ros, tmp_path: Path) -> None:
    first, second = tmp_path / "first.yaml", tmp_path / "second.yaml"
    beside.says("rosparam", "dump", str(first))
    beside.says("rosparam", "load", str(first))
    beside.says("rosparam", "dump", str(first.with_name("robot2.yaml")), "/robot2")
    beside.says("rosparam", "load", str(first.with_name("robot2.yaml")), "/robot2")
    beside.says("rosparam", "dump", str(second))
    assert second.read_text() == first.read_text()


def test_a_clients_view_of_every_parameter_is_one_that_a_real_node_can_start_from(beside: Ros) -> None:
    told = beside.script(rospy_scripts.PARAMETERS, "/robot1")
    assert isinstance(told, dict)
    assert told["/robot1/move_base/global_costmap/robot_base_frame"] == "robot1/base_footprint"
    assert len(told["/robot1/move_base/local_costmap/footprint"]) >= 3
    assert {each["type"] for each in told["/robot1/move_base/local_costmap/plugins"]} >= {"costmap_2d::ObstacleLayer"}
    assert len(told) > 150
    # An empty list or nothing at all stops a real costmap or planner at its start.
    assert [name for name, value in told.items() if value in ([], "", None)] == []


def test_amcls_set_map_takes_the_pose_and_refuses_another_map(beside: Ros) -> None:
    assert beside.script(rospy_scripts.SET_MAP, "0") == {"success": True}
    assert beside.script(rospy_scripts.SET_MAP, "1") == {"success": False}


@pytest.mark.slow
def test_levels_of_logs_are_asked_and_set(beside: Ros) -> None:
    assert 'name: "thbridge"' in beside.says("rosservice", "call", "/thbridge/get_loggers")
    beside.says("rosservice", "call", "/thbridge/set_logger_level", "{logger: sim, level: debug}")
    told = beside.says("rosservice", "call", "/thbridge/get_loggers").splitlines()
    at = next(number for number, line in enumerate(told) if 'name: "sim"' in line)
    assert 'level: "debug"' in told[at + 1]


@pytest.mark.slow
def test_the_goal_under_way_is_said_by_itself_too(beside: Ros) -> None:
    with beside.running("rostopic", "echo", "-n", "1", "/robot2/move_base/current_goal") as listener:
        goal = "{header: {frame_id: map}, pose: {position: {x: -2.0, y: 0.0}, orientation: {w: 1.0}}}"
        command = ("rostopic", "pub", "-r", "1", "/robot2/move_base_simple/goal", "geometry_msgs/PoseStamped", goal)
        with beside.running(*command):
            listener.wait(PATIENCE)
        assert listener.stdout is not None
        told = listener.stdout.read()
    assert 'frame_id: "map"' in told
    assert "x: -2.0" in told
    assert (
        beside.says("rostopic", "type", "/robot2/move_base/recovery_status").strip() == "move_base_msgs/RecoveryStatus"
    )


@pytest.mark.slow
def test_services_answer(beside: Ros) -> None:
    assert "width: 320" in beside.says("rosservice", "call", "/static_map")
    assert beside.says("rosservice", "type", "/robot1/global_localization").strip() == "std_srvs/Empty"
    beside.says("rosservice", "call", "/robot1/move_base/clear_costmaps")
    question = "{goal: {header: {frame_id: map}, pose: {position: {x: 2.0, y: 0.0}, orientation: {w: 1.0}}}}"
    assert beside.says("rosservice", "call", "/robot1/move_base/make_plan", question).count('frame_id: "map"') > 10


def test_tf2_finds_every_robots_laser_in_the_map(beside: Ros) -> None:
    pairs = ["map,robot1/base_laser", "map,robot2/base_laser", "robot1/base_link,robot2/base_link"]
    found = beside.script(rospy_scripts.TF_LISTENER, *pairs)
    assert isinstance(found, dict)
    assert set(found) == set(pairs)
    assert all(abs(value) < 10.0 for place in found.values() for value in place)


def test_somebody_tells_a_robot_where_it_is(beside: Ros) -> None:
    x, y = beside.script(rospy_scripts.LOCALIZED, "[1.0, 0.5]")
    assert abs(x - 1.0) < 0.5
    assert abs(y - 0.5) < 0.5


@pytest.mark.slow
def test_somebody_drives_by_hand_and_the_robot_stops_by_itself(beside: Ros) -> None:
    def tells(field: str) -> float:
        return float(beside.says("rostopic", "echo", "-n", "1", f"/robot2/odom/{field}").split()[0])

    start = tells("pose/pose/orientation/z")
    beside.says("rostopic", "pub", "--once", "/robot2/cmd_vel", "geometry_msgs/Twist", "{angular: {z: 1.0}}")
    until("it to turn", lambda: abs(tells("pose/pose/orientation/z") - start) >= 0.05, [])
    until("it to stand", lambda: abs(tells("twist/twist/angular/z")) < 0.1, [])


@pytest.mark.slow
def test_an_action_client_drives_cancels_and_is_replaced(tmp_path: Path) -> None:
    with session(tmp_path, "--robots", "1") as (ros, _):
        said = ros.script(rospy_scripts.ACTION_CLIENT, "/robot1", json.dumps(CORRIDOR))
    preempted, succeeded, aborted = 2, 3, 4
    assert isinstance(said, dict)
    assert said["found"]
    state, feedback, frames = said["arrived"]
    assert (state, frames) == (succeeded, ["map"])
    assert feedback > 5
    assert said["cancelled"] == preempted
    assert said["replaced"] == preempted
    assert said["replacing"] == succeeded
    assert said["impossible"][0] == aborted
    assert said["impossible"][1]


@pytest.mark.slow
def test_rosbag_records_the_same_messages_live(tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours.bag", tmp_path / "theirs.bag"
    wanted = {"/tf", "/robot1/scan", "/robot2/odom", "/robot1/move_base/status", "/map", "/tf_static"}
    study = tmp_path / "study.yaml"
    study.write_text("recording: {detail: all}\n")
    with session(tmp_path, "--study", str(study), "--bag", str(ours), "--rate", "3") as (ros, robots):
        record = ("rosbag", "record", "-a", "-O", str(theirs), "__name:=recorder")
        with ros.running(*record, cwd=tmp_path) as recorder:

            def connected() -> bool:
                told = ros.says("rosnode", "info", "/recorder")
                return all(f"* topic: {topic}\n" in told for topic in {*wanted, "/robot1/odom"})

            until("it to hear", connected, [robots])
            ros.says("rostopic", "echo", "-n", "300", "/robot1/odom/header/seq")
            os.killpg(recorder.pid, signal.SIGINT)
            recorder.wait(90)
        robots.stop()
    heard, said = of_topics(theirs), of_topics(ours)
    assert wanted <= heard.keys()
    everybodys = {"/rosout", "/rosout_agg"}
    for topic, received in heard.items():
        if topic in said and topic not in everybodys:
            recorded = [message.data for message in said[topic]]
            first = recorded.index(received[0].data)
            assert [message.data for message in received] == recorded[first : first + len(received)], topic
            assert received[0].md5 == said[topic][0].md5
    only_live = {topic for topic in heard if topic.endswith(("/parameter_descriptions", "/parameter_updates"))}
    assert heard.keys() - said.keys() <= {"/clock", *everybodys, *only_live}
    assert len(heard["/robot1/odom"]) > 200


def of_topics(path: Path) -> dict[str, list[RawMessage]]:
    found: dict[str, list[RawMessage]] = {}
    for message in messages(path):
        found.setdefault(message.topic, []).append(message)
    return found
