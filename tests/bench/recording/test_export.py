"""How fast a bag becomes tables, beside rosbags' own reader that only makes objects of its messages."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from rosbags.rosbag1 import Reader

from tests.bench.budget import Budgets, cpu_seconds
from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from thbridge.analysis.export.folder import export_bag
from thbridge.files.ros.definitions import Definitions
from thbridge.files.tables.table_files import TableFormat
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.messages.types import typestore
from thbridge.ros.publisher import RosMessage, TeamPublisher

pytestmark = pytest.mark.bench

ROBOTS, TICKS = 3, 3000
TIMES = 3


def said() -> Iterator[RosMessage]:
    publisher = TeamPublisher(ROBOTS, MOUNT, SCAN_PERIOD)
    yield from publisher.opening(0, SESSION, arena())
    for snapshot in snapshots(ROBOTS, TICKS):
        yield from publisher.tick(snapshot, records(snapshot.tick))


def test_messages_a_second(tmp_path: Path, budgets: Budgets) -> None:
    bag = tmp_path / "drawn.bag"
    with BagWriter(bag, Definitions(())) as writer:
        for message in said():
            writer.write(message)
    messages = 0

    def make_objects() -> None:
        nonlocal messages
        store, messages = typestore(), 0
        with Reader(bag) as reader:
            for connection, _, data in reader.messages():
                store.deserialize_ros1(data, connection.msgtype)
                messages += 1

    for form in TableFormat:
        turns = [
            (cpu_seconds(partial(export_bag, bag, tmp_path / f"{form}{turn}", (form,))), cpu_seconds(make_objects))
            for turn in range(TIMES)
        ]
        taken, objects = (min(each) for each in zip(*turns, strict=True))
        print(f"{form}: {messages / taken:,.0f} messages a CPU second; {taken / objects:.2f} of rosbags' objects alone")
        budgets.ratio(f"export: {form}, beside rosbags' objects", taken / objects)
