"""Robots that rclpy plays, commanded by our programs."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.peers.ros2.action_scripts import NEEDS_RCLPY
from tests.peers.ros2.peer_process import PYTHON, environment
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.ports import free_domain
from tests.support.programs.processes import Program, journal, port_of, until
from thbridge.recording.bag.reading import reader as bag_reader
from thbridge.ros.messages import unpack

pytestmark = [NEEDS_RCLPY, pytest.mark.slow]
DOMAIN = free_domain()
STUDY = f"""\
robots_from: ros2
robots: 2
ros2: {{distribution: kilted, domain: {DOMAIN}}}
fleet: {{robot: {{odom_frame: odom, base_frame: base_link}}}}
"""


def robots(*arguments: str) -> subprocess.Popen[bytes]:
    script = Path(__file__).with_name("nav2_robots.py")
    return subprocess.Popen([PYTHON, script, *arguments], env=environment(DOMAIN), stderr=sys.stderr)


def test_a_whole_hunt_with_nav2_robots_of_rclpy(tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text(STUDY)
    playing = [robots("3.0", "1", "2")]
    server = Program(tmp_path, "server", "--port", "0")
    programs = [server]
    try:
        at = f"127.0.0.1:{port_of(server, programs)}"
        simr = Program(tmp_path, "simr", "--study", "study.yaml", "--server", at, "--bag", "real.mcap")
        programs.append(simr)
        until("all robots to be found", lambda: "All robots have been found" in simr.text, programs)
        programs.append(Program(tmp_path, "hider", "--server", at))
        player = Program(tmp_path, "tabui", "--server", at, "--json")
        programs.append(player)
        until("the game to be over", lambda: player.process.poll() is not None, programs, 280.0)
        assert json.loads(player.text.splitlines()[-1])["rooms_visited"] == 8
        assert simr.stop() == 0
    finally:
        for program in programs:
            program.close()
        for each in playing:
            each.kill()
            each.wait()
    arrived = [event for event in journal(tmp_path) if event["event"] == "arrived"]
    (failed,) = [event for event in journal(tmp_path) if event["event"] == "failed"]
    assert failed["reason"] == "The map has no path there from where robot 1 believes it is."
    results = [f"/robot{number}/navigate_to_pose/result" for number in (1, 2)]
    ends = list(bag_reader.messages(tmp_path / "real.mcap", results))
    assert len(arrived) == 8
    statuses = [unpack.move_base_result(end.data).status for end in ends]
    assert sorted(statuses) == [3] * 8 + [4]
    recorded = {topic.name: topic.messages for topic in bag_reader.info(tmp_path / "real.mcap").topics}
    assert all(recorded[f"/robot{number}/{word}"] > 50 for number in (1, 2) for word in ("odom", "tf", "amcl_pose"))
    assert recorded["/thbridge_fleet/parameter_updates"] == 1


def moves(folder: Path, kind: str) -> list[dict[str, object]]:
    return [event for event in journal(folder) if event["event"] == kind and event["robot"] == 1]


def test_robots_that_are_killed_and_started_again_continue(tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text(STUDY)
    playing = [robots("3.0", "1"), robots("0.5", "2")]
    server = Program(tmp_path, "server", "study.yaml", "--port", "0")
    programs = [server]
    try:
        at = f"127.0.0.1:{port_of(server, programs)}"
        simr = Program(tmp_path, "simr", "--study", "study.yaml", "--server", at)
        programs.append(simr)
        until("the robots to be found", lambda: "All robots have been found" in simr.text, programs)
        programs += [Program(tmp_path, "hider", "--server", at), Program(tmp_path, "tabui", "--server", at, "--json")]
        until("the robot to drive", lambda: any(moves(tmp_path, "departed")), programs)
        playing[1].kill()
        playing[1].wait()
        until("the silence", lambda: "robot 2: it is silent: no more odometry" in simr.text, programs)
        playing[1] = robots("3.0", "2")
        until("the robot again", lambda: "its odometry is back" in simr.text, programs)
        until("an arrival", lambda: any(moves(tmp_path, "arrived")), programs)
        assert simr.stop() == 0
    finally:
        for program in programs:
            program.close()
        for each in playing:
            each.kill()
            each.wait()


TUNER = """
import json, rclpy
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient

rclpy.init()
node = rclpy.create_node("tuner")
client = AsyncParameterClient(node, "/thbridge_fleet")
assert client.wait_for_services(60.0)

def wait(future):
    rclpy.spin_until_future_complete(node, future, timeout_sec=30.0)
    return future.result()

def get():
    values = wait(client.get_parameters(["odom_time_offset", "use_sim_time"])).values
    return [parameter_value_to_python(value) for value in values]

names = wait(client.list_parameters([], 10)).result.names
before = get()
results = wait(client.set_parameters([Parameter("odom_time_offset", value=each) for each in (11.0, 0.2)])).results
print(json.dumps([sorted(names), before, [each.successful for each in results], get()]))
"""


def test_the_time_offset_is_a_parameter_and_a_second_fleet_is_refused(tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text(STUDY.replace("fleet: {", "fleet: {odom_time_offset: 0.05, "))
    fleet = Program(tmp_path, "simr", "study.yaml", "--server", "127.0.0.1:9")
    second: Program | None = None
    try:
        until("the fleet to join", lambda: "robot 1 is not ready yet" in fleet.text, [fleet])
        done = run_peer([PYTHON, "-c", TUNER], env=environment(DOMAIN), timeout=120.0)
        assert done.returncode == 0, done.stderr + fleet.text
        names, before, results, after = json.loads(done.stdout.splitlines()[-1])
        assert names == ["odom_time_offset", "use_sim_time"]
        assert (before, results, after) == ([0.05, False], [False, True], [0.2, False])
        assert "/thbridge_fleet/odom_time_offset is 0.2 s now" in fleet.text
        second = Program(tmp_path, "simr", "study.yaml", "--server", "127.0.0.1:9", "--bag", "second.bag")
        assert second.process.wait(60) == 2
        message = "ROS 2: another program in this domain already has the node /thbridge_fleet. Stop that program first."
        assert message in second.text
        assert not (tmp_path / "second.bag").exists()
        assert fleet.stop() == 0
    finally:
        for program in (fleet, second):
            if program is not None:
                program.close()
