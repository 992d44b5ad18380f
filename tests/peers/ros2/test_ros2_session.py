"""A session on a ROS 2 graph beside real nodes of rclpy."""

import json
import os
from collections import defaultdict
from itertools import pairwise
from pathlib import Path

import pytest

from sim.common.observations import TICK
from sim.world.sensors import mount_of
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.ports import free_port
from tests.support.programs.processes import Program, until
from tests.support.project import ROOT
from thbridge.recording.bag.reading.reader import recorded
from thbridge.ros.publisher import TeamPublisher
from thbridge.ros.topics import RosMessage
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.topics import SessionTopics
from thbridge.study.built_in import STANDARD

ROS2 = ROOT / ".peers" / "ros2"
PYTHON = ROS2 / "bin" / "python"
FOLDER = Path(__file__).parent
DOMAIN = str(81 + os.getpid() % 20)

pytestmark = pytest.mark.skipif(
    not (ROS2 / "installed").exists(), reason="not installed: ros2 (scripts/install_peers.sh)"
)


def environment() -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if name not in {"PYTHONPATH", "PYTHONHOME"}}
    return {**kept, "ROS_DOMAIN_ID": DOMAIN, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}


def padded(message: bytes) -> bytes:
    """DDS transports messages in words of four bytes."""
    return message + bytes(-len(message) % 4)


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
        run_peer([PYTHON, listener, str(len(topics.all)), "6", out], env=environment(), timeout=120.0)
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
            # In a window of time, nothing is missing, and nothing is different.
            whole = [padded(each) for each in sent[topic.name]]
            start = whole.index(padded(got[0]))
            assert [padded(each) for each in got] == whole[start : start + len(got)], topic.name
    assert counts["/robot1/odom"] > 100
    assert counts["/robot1/map"] == 1


def test_clients_of_rclpy_command_the_robots_and_a_replay_repeats_it(tmp_path: Path) -> None:
    session = Program(
        tmp_path, "simr", "--server", f"127.0.0.1:{free_port()}", "--ros2", "--ros2-domain", DOMAIN, "--bag", "run.bag",
        kilted_study(tmp_path),
    )  # fmt: skip
    try:
        until("the session to join", lambda: "ROS 2:" in session.text, [session])
        done = run_peer([PYTHON, FOLDER / "session_client.py"], env=environment(), timeout=240.0)
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
