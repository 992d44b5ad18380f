"""Recording beside rosbags' writer and ROS's own Python, with the same messages in the same minute."""

import os
import shutil
import subprocess
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import median

import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys.msg import normalize_msgtype

from sim.sensors import mount_of
from sim.team import TeamSnapshot
from tests.bench.test_bench_session import drive
from thbridge.adapters.bag_records import Compression
from thbridge.adapters.bag_writer import BagWriter, Recorder
from thbridge.adapters.ros_definitions import Definitions
from thbridge.app.compose import Setting, read_setting
from thbridge.app.config import Study
from thbridge.ros.publisher import Message, Publisher
from thbridge.ros.records import Session

pytestmark = pytest.mark.bench

SECONDS = 60
TIMES = 5

ROS_WRITES = """
import sys, time
import rosbag

messages = [(topic, raw, stamp) for topic, raw, stamp in rosbag.Bag(sys.argv[1]).read_messages(raw=True)]
for _ in range(int(sys.argv[3])):
    with rosbag.Bag(sys.argv[2], "w") as bag:
        began = time.process_time()
        for topic, raw, stamp in messages:
            bag.write(topic, raw, stamp, raw=True)
    print(time.process_time() - began)
"""
"""ROS's own writer in Python, given the bytes of messages, as we are."""


class Drive:
    """Snapshots and messages of a real team that drives."""

    def __init__(self, robots: int) -> None:
        self.setting: Setting = read_setting(replace(Study(), map="warehouse12", robots=robots), Path())
        self.snapshots: list[TeamSnapshot] = []
        drive(self.setting.team(), [room.goal for room in self.setting.place.rooms], SECONDS, self.snapshots.append)
        publisher = self.publisher()
        self.messages: list[Message] = publisher.opening(0, Session("", 1, {}), self.setting.place.grid)
        for snapshot in self.snapshots:
            self.messages += publisher.tick(snapshot)

    def publisher(self) -> Publisher:
        laser = self.setting.study.world.laser
        return Publisher(self.setting.study.robots, mount_of(laser), 1.0 / laser.rate)


def per_second(count: int, path: Path, write: Callable[[Path], float]) -> float:
    """Messages per CPU second, all threads together; the median of some runs."""
    took = []
    for _ in range(TIMES):
        path.unlink(missing_ok=True)
        took.append(write(path))
    return count / median(took)


@pytest.mark.parametrize("robots", [3, 10])
def test_messages_per_cpu_second(tmp_path, robots, capsys):
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
        recorder = Recorder(
            BagWriter(path, definitions), session.publisher(), Session("", 1, {}), session.setting.place.grid
        )
        began = time.process_time()
        with recorder:
            for snapshot in session.snapshots:
                recorder.record(snapshot)
        return time.process_time() - began

    def rosbags(path: Path) -> float:
        began = time.process_time()
        with Writer(path) as writer:
            connections = {
                topic: writer.add_connection(
                    topic.name,
                    normalize_msgtype(topic.msgtype),
                    msgdef=definitions.of(topic.msgtype).text,
                    md5sum=definitions.of(topic.msgtype).md5,
                )
                for topic in dict.fromkeys(message.topic for message in said)
            }
            for message in said:
                writer.write(connections[message.topic], message.stamp_ns, message.data)
        return time.process_time() - began

    figures = {
        "ours": per_second(len(said), tmp_path / "ours.bag", ours),
        "ours, lz4": per_second(len(said), tmp_path / "lz4.bag", lambda path: ours(path, Compression.LZ4)),
        "ours, bz2": per_second(len(said), tmp_path / "bz2.bag", lambda path: ours(path, Compression.BZ2)),
        "ours, from snapshots": per_second(len(said), tmp_path / "recorded.bag", ours_from_snapshots),
        "rosbags": per_second(len(said), tmp_path / "rosbags.bag", rosbags),
    }
    if shutil.which("rosbag"):
        kept = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        run = ["/usr/bin/python3", "-c", ROS_WRITES, tmp_path / "ours.bag", tmp_path / "ros.bag", str(TIMES)]
        done = subprocess.run(run, env=kept, capture_output=True, text=True, check=True)
        figures["Debian's rosbag, Python"] = len(said) / median(float(line) for line in done.stdout.split())
    sizes = {name: (tmp_path / f"{name}.bag").stat().st_size for name in ("ours", "lz4", "bz2")}
    with capsys.disabled():
        print(f"\n{robots} robots, {len(said)} messages of {sum(len(m.data) for m in said) / len(said):.0f} bytes:")
        for name, value in figures.items():
            print(f"{name:>25}: {value:9,.0f} messages per CPU s, {value / figures['rosbags']:5.1f} times rosbags")
        print(f"{'size with lz4 and bz2':>25}: {sizes['lz4'] / sizes['ours']:.0%}, {sizes['bz2'] / sizes['ours']:.0%}")
