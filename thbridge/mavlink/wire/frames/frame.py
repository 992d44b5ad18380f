"""MAVLink frame: one message on the wire, with header and checksum.

Source: the MAVLink developer guide, "Packet Serialization" and "Message Signing".
"""

import struct
from dataclasses import dataclass, replace

import fastcrc

V1, V2 = 0xFE, 0xFD
"""First byte (magic) of frames of version 1, and of version 2."""

SIGNED = 0x01
"""Bit of `incompat_flags` that means that a signature follows the checksum."""

CHECKSUM_SIZE = 2
SIGNATURE_SIZE = 13

HEADER_V1 = struct.Struct("<6B")
"""Fields: magic, length of the payload, sequence, system, component, message."""

HEADER_V2 = struct.Struct("<7BHB")
"""Fields: magic, payload length, incompat flags, compat flags, sequence, system, component, message (16 + 8 bits)."""

LARGEST = HEADER_V2.size + 255 + CHECKSUM_SIZE + SIGNATURE_SIZE
"""Size of the longest frame in bytes."""


@dataclass(frozen=True, slots=True)
class Frame:
    """MAVLink frame. Its checksum is not a field, because bytes with a wrong checksum are not a frame.

    Attributes:
        system: system id of the sender, 1 to 255.
        component: component id of the sender.
        sequence: the sender's frame count on this link, 0 to 255.
        message_id: type of the message.
        payload: encoded fields.
        seed: CRC_EXTRA byte of the message, which the checksum includes (see `dialect.crc_extra`).
        version: `V1` or `V2`.
        incompat_flags: flags of version 2. A receiver drops a frame with a flag that it does not support.
        compat_flags: flags of version 2 that a receiver may ignore.
        signature: link, timestamp and signature, 13 bytes. Empty if the frame is not signed.
    """

    system: int
    component: int
    sequence: int
    message_id: int
    payload: bytes
    seed: int
    version: int = V2
    incompat_flags: int = 0
    compat_flags: int = 0
    signature: bytes = b""

    @property
    def size(self) -> int:
        """Size on the wire, bytes."""
        header = HEADER_V1.size if self.version == V1 else HEADER_V2.size
        return header + len(self.payload) + CHECKSUM_SIZE + len(self.signature)

    @property
    def head(self) -> bytes:
        """Header and payload. The checksum covers all of it except the first byte."""
        length = len(self.payload)
        if self.version == V1:
            head = (V1, length, self.sequence, self.system, self.component, self.message_id)
            return HEADER_V1.pack(*head) + self.payload
        low, high = self.message_id & 0xFFFF, self.message_id >> 16
        flags = (self.incompat_flags, self.compat_flags)
        head_v2 = (V2, length, *flags, self.sequence, self.system, self.component, low, high)
        return HEADER_V2.pack(*head_v2) + self.payload

    @property
    def checksum(self) -> int:
        """CRC-16/MCRF4XX of the header without its first byte, the payload and the seed."""
        return checksum_of(self.head, self.seed)

    def to_bytes(self) -> bytes:
        """Encode the frame.

        Raises:
            struct.error: a number is out of range.
        """
        head = self.head
        return head + checksum_of(head, self.seed).to_bytes(2, "little") + self.signature

    def unsigned(self) -> "Frame":
        """Return the same frame without its signature."""
        return replace(self, incompat_flags=self.incompat_flags & ~SIGNED, signature=b"")


def checksum_of(head: bytes, seed: int) -> int:
    """Return the checksum of a frame's header and payload, without the first byte."""
    checksum: int = fastcrc.crc16.mcrf4xx(head[1:] + bytes((seed,)))
    return checksum


def missing_between(last: int, sequence: int) -> int:
    """Count the frames that are missing between two sequence numbers (0 to 255) of one sender.

    If the second number is up to 128 behind the first, its frame came late or twice. Then no frame is missing.
    """
    gap = (sequence - last - 1) % 256
    return gap if gap < 128 else 0
