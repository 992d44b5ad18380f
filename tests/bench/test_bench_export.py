"""How fast a bag becomes tables, beside rosbags' own reader that only makes objects of its messages."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from rosbags.rosbag1 import Reader

from tests.thbridge.ros.drive import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from thbridge.analysis.export.folder import export_bag
from thbridge.files.ros.definitions import Definitions
from thbridge.files.table_files import TableFormat
from thbridge.recording.bag.writer import BagWriter
from thbridge.ros.messages.types import typestore
from thbridge.ros.publisher import RosMessage, TeamPublisher

pytestmark = pytest.mark.bench

ROBOTS, TICKS = 3, 3000


def said() -> Iterator[RosMessage]:
    publisher = TeamPublisher(ROBOTS, MOUNT, SCAN_PERIOD)
    yield from publisher.opening(0, SESSION, arena())
    for snapshot in snapshots(ROBOTS, TICKS):
        yield from publisher.tick(snapshot, records(snapshot.tick))


def test_messages_a_second(tmp_path: Path) -> None:
    bag = tmp_path / "drawn.bag"
    with BagWriter(bag, Definitions(())) as writer:
        for message in said():
            writer.write(message)
    seconds = {}
    for form in TableFormat:
        started = time.process_time()
        export_bag(bag, tmp_path / form, (form,))
        seconds[form] = time.process_time() - started
    started = time.process_time()
    store, messages = typestore(), 0
    with Reader(bag) as reader:
        for connection, _, data in reader.messages():
            store.deserialize_ros1(data, connection.msgtype)
            messages += 1
    objects = time.process_time() - started
    for form, taken in seconds.items():
        print(f"{form}: {messages / taken:,.0f} messages a CPU second; {taken / objects:.2f} of rosbags' objects alone")
