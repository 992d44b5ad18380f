"""Attachment of each message, request and response: its number, its time and the gid of its sender.

Source: rmw_zenoh, attachment_helpers.cpp, since version 0.2.4.
"""

import struct
from dataclasses import dataclass

_LAYOUT = struct.Struct("<qqB16s")
_GID_BYTES = 16


@dataclass(frozen=True, slots=True)
class Attachment:
    """Attachment of a message. A response repeats number and gid of its request.

    Attributes:
        number: number of the message or request of its sender, from 1.
        time_ns: time at which it was sent, nanoseconds since 1970.
        gid: gid of the publisher or client, 16 bytes.
    """

    number: int
    time_ns: int
    gid: bytes

    def write(self) -> bytes:
        """Return the attachment as bytes."""
        return _LAYOUT.pack(self.number, self.time_ns, _GID_BYTES, self.gid)

    @classmethod
    def read(cls, data: bytes) -> "Attachment | None":
        """Return the attachment in these bytes. If they are invalid, return None."""
        if len(data) != _LAYOUT.size:
            return None
        number, time_ns, size, gid = _LAYOUT.unpack(data)
        return cls(number, time_ns, gid) if size == _GID_BYTES else None
