"""The index of a bag: its publishers and the stamps of all messages, without reading any message."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag1.reader import decompressors
from rosbags.typesys.msg import denormalize_msgtype

from thbridge.recording.bag.reader import opened

_PACKING = {unpack: name for name, unpack in decompressors.items()}


@dataclass(frozen=True, slots=True, eq=False)
class ConnectionStamps:
    """One connection of a bag, with the stamps of its messages.

    Attributes:
        topic: its name.
        msgtype: for example "nav_msgs/Odometry".
        md5: md5 sum of the type.
        caller: name of the node; None where it was not recorded.
        latched: True when late subscribers get the last message.
        stamps_ns: (n,) stamps of its messages, rising.
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
        compressions: number of chunks by the name of their compression.
        publishers: the connections, in the order of the index.
    """

    path: Path
    size: int
    compressions: dict[str, int]
    publishers: tuple[ConnectionStamps, ...]


def contents(path: Path) -> BagContents:
    """Read the index of one bag.

    Raises:
        BadFile: there is no such file, it is not a ROS 1 bag, or it is cut off or damaged.
    """
    with opened(path) as reader:
        compressions: dict[str, int] = {}
        for chunk in reader.chunks.values():
            name = _PACKING[chunk.decompressor]
            compressions[name] = compressions.get(name, 0) + 1
        publishers = tuple(
            ConnectionStamps(
                connection.topic,
                denormalize_msgtype(connection.msgtype),
                connection.digest,
                getattr(connection.ext, "callerid", None),
                getattr(connection.ext, "latching", None) == 1,
                np.fromiter((entry.time for entry in reader.indexes[connection.id]), np.int64),
            )
            for connection in reader.connections
        )
        return BagContents(path, path.stat().st_size, compressions, publishers)
