"""How QGroundControl reads a vehicle's files: its `FTPManager::download`, as its sources publish it (master of 2026).

Nothing is copied: this is a model. It opens a file once, lets it come in bursts, notes what is missing, asks for that
piece by piece, each four times at most with a second between, and closes all sessions.
"""

import re
import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from thbridge.mavlink.wire.dialect import Message, mav

HEAD = struct.Struct("<HBBBBBxI")
DATA, PAYLOAD = 239, 251
TIMEOUT, RETRIES = 1.0, 3
RESET, OPEN, READ, BURST, ACK, NAK = 2, 4, 5, 15, 128, 129
END = 6
AUTOPILOT = 1


@dataclass(frozen=True, slots=True)
class Reply:
    """An answer of the vehicle's."""

    sequence: int
    session: int
    opcode: int
    asked: int
    ends: bool
    offset: int
    data: bytes

    @property
    def error(self) -> int:
        return self.data[0] if self.opcode == NAK else 0


def reply_of(message: Message) -> Reply:
    payload = bytes(message.payload)
    sequence, session, opcode, size, asked, ends, offset = HEAD.unpack_from(payload)
    return Reply(sequence, session, opcode, asked, bool(ends), offset, payload[HEAD.size : HEAD.size + size])


class Station(Protocol):
    """Whoever reads."""

    def say(self, message: Message) -> None:
        """Say something to the vehicle."""

    def wait(self, seconds: float, kinds: str, wanted: Callable[[Message], bool]) -> Message | None:
        """The next message of this kind that is wanted."""


class FileNotReadError(Exception):
    """What the file could not be read for; QGroundControl then goes on without it."""


def path_of(uri: str) -> str:
    """The path in an address of MAVLink's file transfer."""
    scheme = "mftp://"
    assert uri.lower().startswith(scheme), "it would ask the internet"
    return "/" + re.sub(r"^\[;comp=\d+\]", "", uri[len(scheme) :])


class Files:
    """The files of one vehicle."""

    def __init__(self, station: Station, system: int) -> None:
        self.station = station
        self.system = system
        self.expected = 0

    def download(self, uri: str) -> bytes:
        """The whole of a file; FileNotReadError if it does not come."""
        opened = self.asks(OPEN, data=path_of(uri).encode())
        told = self.hears(OPEN)
        if told is None:
            raise FileNotReadError("silence")
        if told.opcode != ACK or len(told.data) != 4:
            raise FileNotReadError(f"refused {told.error}")
        size, session = int.from_bytes(told.data, "little"), told.session
        assert opened == (told.sequence - 1) & 0xFFFF
        content = bytearray(size)
        missing = self.bursts(session, content)
        for start, stop in missing:
            self.reads(session, content, start, stop)
        self.asks(RESET)
        self.hears(RESET)  # Whether it is answered does not matter.
        return bytes(content)

    def bursts(self, session: int, content: bytearray) -> list[tuple[int, int]]:
        """Bursts until the end is told; from where to where something is missing."""
        missing: list[tuple[int, int]] = []
        offset, retries = 0, 0
        self.asks(BURST, session, offset, DATA)
        while True:
            told = self.hears(BURST, session, in_burst=True)
            if told is None:
                retries += 1
                if retries > RETRIES:
                    raise FileNotReadError("silence")
                self.expected -= 2
                self.asks(BURST, session, offset, DATA)
                continue
            if told.opcode == NAK:
                if told.error != END:
                    raise FileNotReadError(f"refused {told.error}")
                if told.sequence == self.expected:
                    return missing
                self.expected, retries = told.sequence, 0
                self.asks(BURST, session, offset, DATA)
            elif told.offset >= offset:
                if told.offset > offset:
                    missing.append((offset, told.offset))
                offset = told.offset + len(told.data)
                content[told.offset : offset] = told.data
                if told.ends:
                    self.expected, retries = told.sequence, 0
                    self.asks(BURST, session, offset, DATA)
                else:
                    self.expected = told.sequence + 1

    def reads(self, session: int, content: bytearray, start: int, stop: int) -> None:
        """What is missing, piece by piece."""
        retries = 0
        while start < stop:
            size = min(DATA, stop - start)
            self.asks(READ, session, start, size)
            told = self.hears(READ, session)
            if told is None or (told.opcode == ACK and told.offset != start):
                retries += 1
                if retries > RETRIES:
                    raise FileNotReadError("silence")
                self.expected -= 2
                continue
            if told.opcode == NAK:
                raise FileNotReadError(f"refused {told.error}")
            content[start : start + len(told.data)] = told.data
            start, retries = start + len(told.data), 0

    def asks(self, opcode: int, session: int = 0, offset: int = 0, size: int = 0, data: bytes = b"") -> int:
        """Send a request; its sequence number."""
        sequence = (self.expected + 1) & 0xFFFF
        self.expected = (self.expected + 2) & 0xFFFF
        payload = (HEAD.pack(sequence, session, opcode, size or len(data), 0, 0, offset) + data).ljust(PAYLOAD, b"\0")
        self.station.say(mav.MAVLink_file_transfer_protocol_message(0, self.system, AUTOPILOT, list(payload)))
        return sequence

    def hears(self, opcode: int, session: int | None = None, *, in_burst: bool = False) -> Reply | None:
        """The answer to such a request; None: none came in time. Old ones are passed over."""

        def wanted(message: Message) -> bool:
            told = reply_of(message)
            is_old = (self.expected - 1 - told.sequence) & 0xFFFF < 0x7FFF
            if is_old or told.asked != opcode or (session is not None and told.session != session):
                return False
            return in_burst or told.sequence == self.expected

        message = self.station.wait(TIMEOUT, "FILE_TRANSFER_PROTOCOL", wanted)
        return None if message is None else reply_of(message)
