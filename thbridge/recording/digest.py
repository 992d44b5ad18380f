"""Digest of a recording's messages: equal when two sessions said the same, whichever machines recorded them.

It is a SHA-256 over all messages but the session's own record, oldest first, those of one stamp in the order of
recording. Each adds its topic and type (UTF-8) and its data, each of these after its length in bytes, and between type
and data its stamp in nanoseconds. Lengths and stamps are unsigned, of 8 bytes, little endian. Compression, parts,
chunks, definitions and publishers do not count.
"""

import struct
from hashlib import sha256
from pathlib import Path

from thbridge.recording.bag.reading.reader import recorded
from thbridge.ros.messages.types import SESSION

_NUMBER = struct.Struct("<Q")


class MessageDigest:
    """The digest of messages that are added one by one, as while a session runs."""

    def __init__(self) -> None:
        self._hash = sha256()

    def add(self, topic: str, msgtype: str, stamp_ns: int, data: bytes) -> None:
        """Add a message; the session's own record, which tells machine and versions, is left out."""
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
        """The digest of all messages so far, 64 hexadecimal digits."""
        return self._hash.hexdigest()


def digest_of(bag: Path) -> str:
    """The digest of a recording's messages, 64 hexadecimal digits; memory does not grow with its length.

    Args:
        bag: a bag, or the name of a split recording.

    Raises:
        BadFile: there is no such file, it is not a ROS 1 bag, or it is cut off or damaged.
    """
    digest = MessageDigest()
    for publisher, stamp_ns, data in recorded(bag):
        digest.add(publisher.topic, publisher.msgtype, stamp_ns, data)
    return digest.hexdigest()
