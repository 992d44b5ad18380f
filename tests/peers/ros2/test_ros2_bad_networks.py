"""A session and rclpy on two machines, with a bad network between them."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from sim.world.sensors import mount_of
from tests.peers.ros2.peer_process import FOLDER, PYTHON, ROS2, environment, padded
from tests.support.programs.bad_cable import HERE, BadCable, bad_cable
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.processes import Program, until
from thbridge.recording.bag.reading.reader import recorded
from thbridge.ros.publisher import TeamPublisher
from thbridge.ros.topics import RosMessage
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.topics import SessionTopics
from thbridge.study.built_in import STANDARD

DOMAIN = "110"  # Each cable has networks of its own.
DELAY, LOSS = 0.1, 0.2
NETWORK = "10.9.0.0/24"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (ROS2 / "installed").exists(), reason="not installed: ros2 (scripts/install_peers.sh)"),
]


@pytest.fixture
def cable() -> Iterator[BadCable]:
    with bad_cable() as made:
        yield made


def session(folder: Path, cable: BadCable, *options: str, open_to: str = NETWORK) -> Program:
    """Start robots on the near machine, and wait until they are on the graph."""
    graph = f"ros2: {{distribution: kilted, host: {HERE}, domain: {DOMAIN}}}\n"
    (folder / "study.yaml").write_text(graph + "recording: {detail: all}\n")
    arguments = ("simr", "study.yaml", "--server", "127.0.0.1:1", "--ros2", "--open-to", open_to, *options)
    program = Program(folder, *arguments, by=cable.here_by)
    until("the session to join", lambda: "ROS 2:" in program.text or program.process.poll() is not None, [program])
    assert program.process.poll() is None, program.text
    return program


def test_topics_arrive_over_a_slow_and_lossy_network(tmp_path: Path, cable: BadCable) -> None:
    publisher = TeamPublisher(2, mount_of(STANDARD.world.laser), 0.1)
    topics = SessionTopics(Distribution.of("kilted"), publisher.topics, 2)
    cable.set(DELAY, LOSS)
    robots = session(tmp_path, cable, "--bag", "run.bag")
    try:
        out = tmp_path / "heard.json"
        by = [*cable.there_by, PYTHON, FOLDER / "session_listener.py"]
        run_peer([*by, str(len(topics.all)), "15", out], env=environment(DOMAIN, "SUBNET"), timeout=200.0)
        robots.stop()
    finally:
        robots.close()
    heard = json.loads(out.read_text())
    sent: dict[str, list[tuple[int, bytes]]] = {}
    by_name = {topic.name: topic for topic in publisher.topics}
    for connection, stamp_ns, data in recorded(tmp_path / "run.bag"):
        message = RosMessage(by_name[connection.topic], stamp_ns, bytes(data))
        for target, convert in topics.targets[connection.topic]:
            sent.setdefault(target.name, []).append((stamp_ns, padded(convert(message))))
    shares: dict[str, float] = {}
    for topic in topics.all:
        got = [padded(bytes.fromhex(each)) for each in heard.get(topic.name, {"messages": []})["messages"]]
        if topic.name == "/clock" or not got:
            continue
        whole = [data for _, data in sent[topic.name]]
        places = [whole.index(data) for data in got] if len(set(whole)) == len(whole) else []
        if places:
            # They arrive in order, and at most once.
            assert places == sorted(set(places)), topic.name
            shares[topic.name] = len(places) / (places[-1] - places[0] + 1)
    print(json.dumps({name: round(share, 2) for name, share in sorted(shares.items())}))
    print({name: len(each["messages"]) for name, each in heard.items()})
    assert heard["/robot1/map"]["messages"]
    assert shares["/tf"] == shares["/robot1/tf"] == 1.0  # The publisher keeps 100 messages: two seconds.
    assert 0.4 < shares["/robot1/scan"] < 1.0  # Best effort: what is lost is lost.


def test_clients_command_robots_over_a_slow_and_lossy_network(tmp_path: Path, cable: BadCable) -> None:
    robots = session(tmp_path, cable)
    cable.set(DELAY, LOSS)
    try:
        by = [*cable.there_by, PYTHON, FOLDER / "session_client.py"]
        done = run_peer(by, env=environment(DOMAIN, "SUBNET"), timeout=280.0)
        robots.stop()
    finally:
        robots.close()
    assert done.returncode == 0, done.stderr + robots.text
    found = json.loads(done.stdout.splitlines()[-1])
    expected = {"reached": [True, 0], "replaced": True, "canceled": True, "value": 321, "map": 320, "Twist": True}
    assert {name: found[name] for name in expected} == expected


def test_machines_that_are_not_admitted_are_ignored(tmp_path: Path, cable: BadCable) -> None:
    robots = session(tmp_path, cable, open_to="10.8.0.0/24")
    try:
        by = [*cable.there_by, PYTHON, FOLDER / "session_listener.py"]
        out = tmp_path / "heard.json"
        run_peer([*by, "1", "1", out, "5"], env=environment(DOMAIN, "SUBNET"), timeout=60.0)
        until("the warning", lambda: "is not admitted" in robots.text, [robots])
        robots.stop()
    finally:
        robots.close()
    assert not json.loads(out.read_text())
