"""Bags with few messages."""

from pathlib import Path

from thbridge.files.ros.definitions import Definitions
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.publisher import RosMessage, Topic

PLAIN = Definitions(())
CHATTER = Topic("/chatter", "std_msgs/String")
MAP = Topic("/news", "std_msgs/String", latched=True)
HELLO = b"\x05\x00\x00\x00hello"


def write_four_messages(path: Path) -> Path:
    with BagWriter(path, PLAIN) as writer:
        writer.write(RosMessage(MAP, 1_000_000_000, HELLO))
        for second in range(1, 4):
            writer.write(RosMessage(CHATTER, second * 1_000_000_000, HELLO))
    return path


def write_hundred_messages(path: Path) -> bytes:
    with BagWriter(path, PLAIN) as writer:
        for tick in range(100):
            writer.write(RosMessage(CHATTER, 1_000_000_000 + tick * 20_000_000, HELLO))
    return path.read_bytes()
