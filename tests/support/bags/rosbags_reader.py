"""Reader of bags that uses rosbags, and none of the code under test."""

from pathlib import Path

from rosbags.rosbag1 import Reader


def messages(bag: Path) -> list[tuple[str, int, bytes]]:
    with Reader(bag) as reader:
        return [(connection.topic, stamp, bytes(data)) for connection, stamp, data in reader.messages()]
