"""A session on a ROS 2 graph beside real nodes of rclpy."""

import asyncio
import json
import os
from collections import defaultdict
from itertools import pairwise
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from sim.common.observations import TICK
from sim.world.sensors import mount_of
from tests.peers.mavlink_hunter import Hunter
from tests.peers.ros2.peer_process import FOLDER, PYTHON, ROS2, environment, padded
from tests.peers.ros_programs import NEEDS_ROS, Ros
from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.ports import free_domain, free_port, free_udp_port
from tests.support.programs.processes import Program, until
from tests.support.studies.served_program import kill_workers, playing, port_for_browsers
from thbridge.app.compose.game import build_briefing
from thbridge.app.compose.setting import read_setting
from thbridge.recording.bag.reading.reader import recorded
from thbridge.ros import names
from thbridge.ros.messages import unpack
from thbridge.ros.publisher import TeamPublisher
from thbridge.ros.topics import RosMessage
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.topics import SessionTopics
from thbridge.study.built_in import STANDARD
from thbridge.study.study_file import load_study
from ui.web.pool.running_games import RunningGames

DOMAIN = str(free_domain())

pytestmark = pytest.mark.skipif(
    not (ROS2 / "installed").exists(), reason="not installed: ros2 (scripts/install_peers.sh)"
)


def test_rclpy_gets_what_the_bag_has(tmp_path: Path) -> None:
    publisher = TeamPublisher(2, mount_of(STANDARD.world.laser), 0.1)
    topics = SessionTopics(Distribution.of("kilted"), publisher.topics, 2)
    session = Program(
        tmp_path, "play", "--headless", "--ros2", "--ros2-domain", DOMAIN, "--rate", "1", "--bag", "run.bag",
        "--max-seconds", "60", "--no-report", "--with", "recording.detail=all", "--with", "ros2.distribution=kilted",
    )  # fmt: skip
    try:
        until("the session to join", lambda: "ROS 2:" in session.text, [session])
        out = tmp_path / "heard.json"
        listener = FOLDER / "session_listener.py"
        run_peer([PYTHON, listener, str(len(topics.all)), "6", out], env=environment(DOMAIN), timeout=120.0)
        session.stop()
    finally:
        session.close()
    heard = json.loads(out.read_text())
    sent = defaultdict(list)
    by_name = {topic.name: topic for topic in publisher.topics}
    for connection, stamp_ns, data in recorded(tmp_path / "run.bag"):
        message = RosMessage(by_name[connection.topic], stamp_ns, bytes(data))
        for target, convert in topics.targets[connection.topic]:
            sent[target.name].append(convert(message))
    assert {topic.name for topic in topics.all} <= set(heard)
    counts: dict[str, int] = {}
    for topic in topics.all:
        found = heard[topic.name]
        qos = {"reliable": topic.qos.reliability == 1, "latched": topic.qos.durability == 1, "depth": topic.qos.depth}
        support = Distribution.of("kilted").message(topic.type)
        got = [bytes.fromhex(each) for each in found.pop("messages")]
        assert found == {**qos, "type": topic.type, "hash": support.hash, "node": topic.node}
        counts[topic.name] = len(got)
        if topic.name == "/clock":
            times = [Distribution.of("kilted").decode(topic.type, each).clock for each in got]
            steps = [b.sec - a.sec + (b.nanosec - a.nanosec) / 1e9 for a, b in pairwise(times)]
            assert len(steps) > 100
            assert steps == pytest.approx([TICK] * len(steps))
        elif got:
            # In a window of time, nothing is missing, and nothing is different. A listener that is slow for a moment
            # loses messages of best-effort topics.
            whole, at = [padded(each) for each in sent[topic.name]], -1
            places = [at := whole.index(padded(each), at + 1) for each in got]
            missing = places[-1] - places[0] + 1 - len(places)
            assert missing == 0 or (not qos["reliable"] and missing < 0.1 * len(places)), topic.name
    assert counts["/robot1/odom"] > 100
    assert counts["/robot1/map"] == 1


def test_clients_of_rclpy_command_the_robots_and_a_replay_repeats_it(tmp_path: Path) -> None:
    session = Program(
        tmp_path, "simr", "--server", f"127.0.0.1:{free_port()}", "--ros2", "--ros2-domain", DOMAIN, "--bag", "run.bag",
        kilted_study(tmp_path),
    )  # fmt: skip
    try:
        until("the session to join", lambda: "ROS 2:" in session.text, [session])
        done = run_peer([PYTHON, FOLDER / "session_client.py"], env=environment(DOMAIN), timeout=240.0)
        session.stop()
    finally:
        session.close()
    assert done.returncode == 0, done.stderr + session.text
    found = json.loads(done.stdout.splitlines()[-1])
    reasons = found.pop("reasons")
    assert found.pop("seconds") > 1.0
    assert found == {
        "reached": [True, 0],
        "feedback": [True, True, True],
        "replaced": True,
        "canceling": 1,
        "canceled": True,
        "impossible": [True, found["impossible"][1], True],
        "tour": [True, 0],
        "described": [True, True],
        "set": [True, False, False],
        "value": 321,
        "map": 320,
        "state": "active",
        "Twist": True,
        "TwistStamped": True,
    }
    assert found["impossible"][1] > 0
    assert reasons[0] == ""
    assert "laser_model_type" in reasons[1] or "likelihood_field" in reasons[1]
    replayed = Program(tmp_path, "replay", "run.bag")
    assert replayed.process.wait(120) == 0, replayed.text
    assert "the same, bit for bit" in replayed.text
    replayed.close()


def kilted_study(folder: Path) -> str:
    """Write a study for this distribution, and return its name."""
    (folder / "study.yaml").write_text("ros2: {distribution: kilted}\n")
    return "study.yaml"


async def command_beside_a_browser(port: int) -> CompletedProcess[str]:
    """Run the client of rclpy while a person is at a page; they have chosen a room, and refused it in a dialogue."""
    browser = await BrowserClient.arrived(port)
    await browser.press_button()
    await playing(browser)
    await browser.until(lambda: browser.tree["tiles"][0]["choose"]["enabled"])
    await asyncio.sleep(0.4)  # The page ignores earlier acts.
    await browser.act(browser.tree["tiles"][0]["choose"]["act"])
    await browser.until(lambda: browser.tree["dialogue"] and len(browser.tree["dialogue"]["choices"]) > 1, 120)
    await asyncio.sleep(0.4)
    choice = browser.tree["dialogue"]["choices"][-1]
    await browser.act(choice["act"])
    await browser.until(lambda: choice["label"] in {each["text"] for each in browser.tree["history"]})
    client = FOLDER / "session_client.py"
    done = await asyncio.to_thread(run_peer, [PYTHON, client], env=environment(DOMAIN), timeout=240.0)
    assert browser.is_connected
    await browser.close()
    return done


@pytest.mark.slow
@NEEDS_ROS
def test_a_replay_repeats_a_session_with_all_kinds_of_clients_at_once(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    running = tmp_path_factory.mktemp("t")
    (tmp_path / "study.yaml").write_text("robots: 3\nros2: {distribution: kilted}\nmavlink: {lost_after: 60}\n")
    setting = read_setting(load_study(tmp_path / "study.yaml").value, tmp_path)
    goals = {number: (room.goal.x, room.goal.y) for number, room in enumerate(setting.map.rooms, 1)}
    station_port, watch_port, master_port = free_udp_port(), free_port(), free_port()
    address = f"127.0.0.1:{free_port()}"
    session = Program(
        tmp_path, "play", "study.yaml", "--headless", "--outside", "TabUI", "--port", address.partition(":")[2],
        "--bag", "run.bag", "--no-report", "--rate", "1", "--ros", "--ros-master",
        f"http://127.0.0.1:{master_port}", "--ros2", "--ros2-domain", DOMAIN, "--mavlink", "--udp",
        f"127.0.0.1:{station_port}", "--watch", str(watch_port), "--foxglove", "0",
    )  # fmt: skip
    programs = [session]
    try:
        beginnings = ("ROS 2:", "Foxglove", f"join at {address}")
        until("the session to join", lambda: all(each in session.text for each in beginnings), programs)
        windows = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
        programs.append(Program(tmp_path, "watch", f"127.0.0.1:{watch_port}", environment=windows))
        served = {**os.environ, "TMPDIR": str(running)}
        programs.append(
            Program(tmp_path, "serve", "study.yaml", "--server", address, "--port", "0", environment=served)
        )
        page = port_for_browsers(programs[-1])
        ros = Ros(master_port, tmp_path)
        with Hunter(station_port, goals, build_briefing(setting).names) as station:
            station.lead(3, (5, 2))
            command = ("/robot3/cmd_vel", "geometry_msgs/Twist", "{angular: {z: 0.4}}")
            with ros.running("rostopic", "pub", "-r", "5", *command):
                done = asyncio.run(command_beside_a_browser(page))
        session.stop()
    finally:
        for program in programs:
            program.close()
        for games in running.glob("thbridge-serve-*/*"):
            kill_workers(RunningGames(games))
    assert done.returncode == 0, done.stderr + session.text
    inputs = [
        unpack.outside_input(bytes(data))
        for connection, _, data in recorded(tmp_path / "run.bag")
        if connection.topic == names.INPUTS
    ]
    senders = {record.sender for record in inputs}
    assert "/session_client" in senders
    assert any(sender.startswith("/rostopic") for sender in senders)
    assert "TabUI" in senders
    assert "framed" in {record.kind for record in inputs}
    replayed = Program(tmp_path, "replay", "run.bag")
    assert replayed.process.wait(120) == 0, replayed.text
    assert "the same, bit for bit" in replayed.text
    replayed.close()
