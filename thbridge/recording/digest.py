"""Digest of a recording's messages: equal for sessions that sent the same messages, even on different machines.

The digest is a SHA-256 over all messages except the session's own record, oldest first. Messages with equal stamps are
in the order of recording. For each message, the following data are hashed: topic (UTF-8), type (UTF-8), stamp in
nanoseconds, data. Topic, type and data are preceded by their length in bytes. Lengths and stamps are unsigned
little-endian integers of 8 bytes. Compression, parts, chunks, definitions and publishers do not affect the digest.
Messages of ROS 2 have no sequence numbers, so their digest differs from that of the bag of ROS 1.
"""

import struct
from hashlib import sha256
from pathlib import Path

from thbridge.recording.bag.reading.reader import recorded
from thbridge.ros.messages.types import SESSION

_NUMBER = struct.Struct("<Q")


class MessageDigest:
    """Digest of messages that are added one by one, for example while a session runs."""

    def __init__(self) -> None:
        self._hash = sha256()

    def add(self, topic: str, msgtype: str, stamp_ns: int, data: bytes) -> None:
        """Add a message; the session's own record is left out, because it contains machine and versions."""
        if msgtype == SESSION:
            return
        for text in (topic.encode(), msgtype.encode()):
            self._add(text)
        self._hash.update(_NUMBER.pack(stamp_ns))
        self._add(data)

    def _add(self, data: bytes) -> None:
        self._hash.update(_NUMBER.pack(len(data)))
        self._hash.update(data)

    def hexdigest(self) -> str:
        """Return the digest of all messages so far, 64 hexadecimal digits."""
        return self._hash.hexdigest()


def digest_of(bag: Path) -> str:
    """Return the digest of a recording's messages, 64 hexadecimal digits, in constant memory.

    Args:
        bag: a bag, or the name of a split recording.

    Raises:
        BadFile: the file does not exist, is not a ROS 1 bag, or is cut off or damaged.
    """
    digest = MessageDigest()
    for publisher, stamp_ns, data in recorded(bag):
        digest.add(publisher.topic, publisher.msgtype, stamp_ns, data)
    return digest.hexdigest()
