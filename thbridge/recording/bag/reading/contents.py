"""The index of a bag: its publishers and the stamps of all messages. No message is read."""

from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thbridge.recording.bag.damage import damage_as_bad_file
from thbridge.recording.bag.reading.chunk_reader import entries_in
from thbridge.recording.bag.reading.reader import opened
from thbridge.recording.bag.ros2_storage import size_of


@dataclass(frozen=True, slots=True, eq=False)
class ConnectionStamps:
    """One connection of a bag, with the stamps of its messages.

    Attributes:
        topic: name of the topic.
        msgtype: for example "nav_msgs/Odometry".
        md5: md5 sum of the type.
        caller: name of the node; None if the name was not recorded.
        latched: True if late subscribers get the last message.
        stamps_ns: (n,) stamps of its messages, in ascending order.
    """

    topic: str
    msgtype: str
    md5: str
    caller: str | None
    latched: bool
    stamps_ns: NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class BagContents:
    """Contents of one file of a recording.

    Attributes:
        path: the file.
        size: bytes.
        compressions: number of chunks, by the name of the compression.
        publishers: the connections, in the order of the index.
    """

    path: Path
    size: int
    compressions: dict[str, int]
    publishers: tuple[ConnectionStamps, ...]


def contents(path: Path) -> BagContents:
    """Read the index of one bag, 12 bytes per message; messages are not read.

    Raises:
        BadFile: the file does not exist, is not a ROS 1 bag, or is cut off or damaged.
    """
    with opened(path) as (end, reader):
        compressions: dict[str, int] = {}
        entries: defaultdict[int, bytearray] = defaultdict(bytearray)
        for chunk in end.chunks:
            name = reader.compression_of(chunk)
            compressions[name] = compressions.get(name, 0) + 1
            for number, data in reader.index_of(chunk).items():
                entries[number] += data
        with damage_as_bad_file(path):
            publishers = tuple(
                ConnectionStamps(
                    connection.topic,
                    connection.msgtype,
                    connection.md5,
                    connection.caller,
                    connection.latching is True,
                    np.sort(entries_in(entries.pop(connection.number, bytearray()))[0], kind="stable"),
                )
                for connection in end.connections
            )
        return BagContents(path, size_of(path), compressions, publishers)
