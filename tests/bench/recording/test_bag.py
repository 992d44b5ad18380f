"""Recording beside rosbags' writer and ROS's own Python, with the same messages in the same minute."""

import os
import shutil
import subprocess
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys.msg import normalize_msgtype

from sim.snapshot import TeamSnapshot
from sim.world.sensors import mount_of
from tests.bench.budget import Budgets
from tests.support.bags.drawn_team import SESSION
from tests.support.robots.robots_under_way import drive
from thbridge.app.compose.robots import build_team
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.session.broadcast import Broadcast
from thbridge.files.ros.definitions import Definitions
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.messages.types import typestore
from thbridge.ros.publisher import RosMessage, TeamPublisher, Topic
from thbridge.study.study_file import Study

pytestmark = pytest.mark.bench

SECONDS = 30
TIMES = 5

ROS_WRITES = """
import sys, time
import rosbag

for raw in (True, False):
    messages = list(rosbag.Bag(sys.argv[1]).read_messages(raw=raw))
    for _ in range(int(sys.argv[3])):
        began = time.process_time()
        with rosbag.Bag(sys.argv[2], "w") as bag:
            for topic, message, stamp in messages:
                bag.write(topic, message, stamp, raw=raw)
        print(time.process_time() - began)
"""
"""ROS's own writer in Python: given the bytes of messages, and given its objects."""


PEERS = {"ours": "rosbags", "ours, from snapshots": "rosbags, from objects"}
"""What each of our writers is judged by."""


class Drive:
    """Snapshots and messages of a real team that drives."""

    def __init__(self, robots: int) -> None:
        self.setting: StudySetting = read_setting(replace(Study(), map="warehouse12", robots=robots), Path())
        self.snapshots: list[TeamSnapshot] = []
        drive(build_team(self.setting), [room.goal for room in self.setting.map.rooms], SECONDS, self.snapshots.append)
        publisher = self.publisher()
        self.messages: list[RosMessage] = publisher.opening(0, SESSION, self.setting.map.grid)
        for snapshot in self.snapshots:
            self.messages += publisher.tick(snapshot)

    def publisher(self) -> TeamPublisher:
        laser = self.setting.study.world.laser
        return TeamPublisher(self.setting.study.robots, mount_of(laser), 1.0 / laser.rate)


def best_of_each(writers: dict[str, Callable[[Path], float]], folder: Path) -> dict[str, float]:
    """CPU seconds of each writer, all threads together: the best of some runs, in turn."""
    best = dict.fromkeys(writers, float("inf"))
    for _ in range(TIMES):
        for name, write in writers.items():
            path = folder / f"{name}.bag"
            path.unlink(missing_ok=True)
            best[name] = min(best[name], write(path))
    return best


@pytest.mark.parametrize("robots", [3, 10])
def test_messages_per_cpu_second(tmp_path, robots, budgets: Budgets, capsys):
    session = Drive(robots)
    said = session.messages
    definitions = Definitions()
    for message in said:
        definitions.of(message.topic.msgtype)

    def ours(path: Path, compression: Compression = Compression.NONE) -> float:
        began = time.process_time()
        with BagWriter(path, definitions, compression=compression) as writer:
            for message in said:
                writer.write(message)
        return time.process_time() - began

    def ours_from_snapshots(path: Path) -> float:
        writer = BagWriter(path, definitions)
        recorder = Broadcast(session.publisher(), SESSION, session.setting.map.grid, [writer])
        began = time.process_time()
        with writer:
            for snapshot in session.snapshots:
                recorder.record(snapshot)
        return time.process_time() - began

    def rosbags(path: Path, said: list[tuple[Topic, int, object]]) -> float:
        began = time.process_time()
        with Writer(path) as writer:
            connections = {
                topic: writer.add_connection(
                    topic.name,
                    normalize_msgtype(topic.msgtype),
                    msgdef=definitions.of(topic.msgtype).text,
                    md5sum=definitions.of(topic.msgtype).md5,
                )
                for topic in dict.fromkeys(topic for topic, _, _ in said)
            }
            for topic, stamp_ns, what in said:
                connection = connections[topic]
                data = what if isinstance(what, bytes) else store.serialize_ros1(what, connection.msgtype)
                writer.write(connection, stamp_ns, data)
        return time.process_time() - began

    store = typestore()
    given: list[tuple[Topic, int, object]] = [(m.topic, m.stamp_ns, m.data) for m in said]
    objects = [(m.topic, m.stamp_ns, store.deserialize_ros1(m.data, normalize_msgtype(m.topic.msgtype))) for m in said]
    count = len(said)
    writers: dict[str, Callable[[Path], float]] = {
        "ours": ours,
        "ours, lz4": lambda path: ours(path, Compression.LZ4),
        "ours, bz2": lambda path: ours(path, Compression.BZ2),
        "rosbags": lambda path: rosbags(path, given),
        "ours, from snapshots": ours_from_snapshots,
        "rosbags, from objects": lambda path: rosbags(path, objects),
    }
    figures = best_of_each(writers, tmp_path)
    if shutil.which("rosbag") is not None:
        kept = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        run = ["/usr/bin/python3", "-c", ROS_WRITES, tmp_path / "ours.bag", tmp_path / "ros.bag", str(TIMES)]
        done = subprocess.run(run, env=kept, capture_output=True, text=True, check=True)
        took = [float(line) for line in done.stdout.split()]
        figures["Debian's rosbag, Python"] = min(took[:TIMES])
        figures["the same, from objects"] = min(took[TIMES:])
    size, lz4, bz2 = ((tmp_path / f"{name}.bag").stat().st_size for name in ("ours", "ours, lz4", "ours, bz2"))
    with capsys.disabled():
        print(f"\n{robots} robots, {len(said)} messages of {sum(len(m.data) for m in said) / len(said):.0f} bytes:")
        for name, seconds in figures.items():
            print(f"{name:>25}: {count / seconds:9,.0f} messages per CPU s")
        print(f"{'size with lz4 and bz2':>25}: {lz4 / size:.0%}, {bz2 / size:.0%}")
    assert bz2 < lz4 < 0.4 * size
    for name, peer in PEERS.items():
        if peer in figures:
            budgets.ratio(f"bag: {name}, {robots} robots, beside {peer}", figures[name] / figures[peer])
    for packed in ("ours, lz4", "ours, bz2"):
        budgets.time(f"bag: {packed}, a message of {robots} robots", figures[packed] / count)
