"""Recordings of ROS 2, written by rosbags."""

from pathlib import Path

from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

TYPES = get_typestore(Stores.ROS2_HUMBLE)
TEXT = "std_msgs/msg/String"


def written(folder: Path, storage: StoragePlugin, mode: CompressionMode) -> Path:
    """Write a recording with three short messages; return its folder."""
    writer = Writer(folder, version=9, storage_plugin=storage)
    if mode is not CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection("/said", TEXT, typestore=TYPES)
        for number in range(3):
            message = TYPES.types[TEXT](data=f"word {number}")
            writer.write(connection, 10**9 + number, TYPES.serialize_cdr(message, TEXT))
    return folder
