"""Signatures of MAVLink 2: only frames signed with the key are accepted, and each frame is accepted only once.

Source: the MAVLink developer guide, "Message Signing".

Differs: no unsigned frame is accepted. Other programs accept RADIO_STATUS, which radios send without a key. Here there
is no radio between robots and stations. A frame forwarded with our signature would look as if the key's owner had sent
it. Keys are never accepted from the network (SETUP_SIGNING). Timestamps from the last few months of the 48-bit range
are refused, because no later frame could have a newer timestamp.
"""

import hashlib
import hmac
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Final

from thbridge.mavlink.wire.frames.frame import SIGNED, V2, Frame

KEY_SIZE = 32

UNITS_PER_SECOND = 100_000
"""A timestamp counts 10 microseconds."""

EPOCH = 1_420_070_400
"""Unix time from which timestamps count: 1 January 2015."""

FIRST_TIMESTAMP_TOLERANCE = 60 * UNITS_PER_SECOND
"""Largest number of units by which the first timestamp of a stream may be behind ours."""

LATEST = (1 << 48) - (1 << 40)
"""Latest timestamp that is accepted. At 100,000 frames per second, the rest of the range lasts four months."""

MAX_STREAMS = 1024
"""Largest number of senders with stored timestamps."""

_HEX_KEY = re.compile(r"[0-9a-fA-F]{64}")
_STAMP_SIZE = 6
_DIGEST_SIZE = 6


@dataclass(frozen=True, slots=True)
class SigningKey:
    """Secret that both sides of a link share; `repr` does not show it.

    Raises:
        ValueError: it does not have 32 bytes.
    """

    secret: bytes = field(repr=False)

    def __post_init__(self) -> None:
        if len(self.secret) != KEY_SIZE:
            raise ValueError(f"a signing key has {KEY_SIZE} bytes, not {len(self.secret)}")


@dataclass(frozen=True, slots=True)
class InvalidKey:
    """Content of a key file that is not a key.

    Attributes:
        problem: the reason, as a clause without a full stop.
    """

    problem: str


class SignatureFault(StrEnum):
    """Reason why a frame is rejected; completes the log message "refused: ..."."""

    UNSIGNED = "it is not signed"
    WRONG = "its signature is wrong"
    REPEATED = "its timestamp is not newer than the last of its sender"
    OLD = "its sender is new, and its timestamp more than a minute old"
    BEFORE = "it was signed before this program started, and earlier timestamps are unknown"
    FAR_AHEAD = "its timestamp is too near the end of the range of timestamps"
    CROWDED = f"there are {MAX_STREAMS} other senders already"


@dataclass(frozen=True, slots=True)
class RejectedFrame:
    """Frame rejected because of its signature."""

    reason: SignatureFault


def parse_key(content: bytes) -> SigningKey | InvalidKey:
    """Return the key in a file: 32 raw bytes, 64 hexadecimal digits, or a passphrase.

    A line of text is a passphrase, and its SHA-256 is the key, as in MAVProxy and Mission Planner. Since 2025,
    QGroundControl derives keys from passphrases differently, but shows the keys as 64 digits.

    Args:
        content: whole content of the file. Printable characters are text, with or without a line end.
    """
    try:
        text = content.decode().removesuffix("\n").removesuffix("\r")
    except UnicodeDecodeError:
        text = ""
    if text.isprintable() and text.strip():
        if _HEX_KEY.fullmatch(text):
            return SigningKey(bytes.fromhex(text))
        return SigningKey(hashlib.sha256(text.encode()).digest())
    if len(content) == KEY_SIZE:
        return SigningKey(content)
    if not content.strip():
        return InvalidKey("it is empty")
    return InvalidKey(f"it is neither one line of text nor {KEY_SIZE} bytes, but {len(content)} bytes")


@dataclass(frozen=True, slots=True)
class KnownTimestamps:
    """Timestamps of an earlier run with the same key, at its end.

    Attributes:
        latest: the latest timestamp, including our own.
        streams: last accepted timestamp of each stream (link, system, component).
    """

    latest: int
    streams: Mapping[tuple[int, int, int], int]


class SignatureTimestamps:
    """Timestamps that we and other senders have used so far, on all links with one key.

    The links share them so that a frame from one link is not accepted again on another.

    Args:
        known: timestamps of an earlier run.
        not_before: seconds of Unix time before which no frame is accepted. If nothing is known, this is the start of
            the program, because an earlier run may have accepted older frames.
    """

    def __init__(self, known: KnownTimestamps | None = None, not_before: float = 0.0) -> None:
        self._latest = 0 if known is None else known.latest
        self._streams: dict[tuple[int, int, int], int] = {}
        if known is not None:
            # If there are too many senders, drop senders whose frames would be refused even if they were new senders.
            kept = 0 if len(known.streams) <= MAX_STREAMS // 2 else known.latest - FIRST_TIMESTAMP_TOLERANCE
            self._streams = {stream: last for stream, last in known.streams.items() if last >= kept}
        self._not_before = _timestamp_at(not_before)

    @property
    def known(self) -> KnownTimestamps:
        """Current timestamps, for the next run."""
        return KnownTimestamps(self._latest, dict(self._streams))

    def next(self, now: float) -> int:
        """Return a timestamp for signing; it is newer than all earlier timestamps, both our own and accepted ones."""
        self._latest = max(self._latest + 1, _timestamp_at(now))
        return self._latest

    def check(self, stream: tuple[int, int, int], timestamp: int, now: float) -> SignatureFault | None:
        """Return the reason to reject a timestamp of a stream (link, system, component), or None to accept it."""
        if timestamp > LATEST:
            return SignatureFault.FAR_AHEAD
        last = self._streams.get(stream)
        if last is not None:
            return SignatureFault.REPEATED if timestamp <= last else None
        if timestamp + FIRST_TIMESTAMP_TOLERANCE < max(self._latest, _timestamp_at(now)):
            return SignatureFault.OLD
        if timestamp < self._not_before:
            return SignatureFault.BEFORE
        return SignatureFault.CROWDED if len(self._streams) >= MAX_STREAMS else None

    def accept(self, stream: tuple[int, int, int], timestamp: int) -> None:
        """Store the timestamp of a frame with a valid signature."""
        self._streams[stream] = timestamp
        self._latest = max(self._latest, timestamp)


class Signing:
    """Signer of the outgoing frames of a link, and verifier of the incoming frames.

    Args:
        key: key of both sides.
        link_id: our number of this link, 0 to 255; part of the signature.
        timestamps: timestamps of all links with this key.
    """

    def __init__(self, key: SigningKey, link_id: int, timestamps: SignatureTimestamps) -> None:
        self._key: Final = key
        self._link_id: Final = link_id
        self._timestamps: Final = timestamps

    def verify(self, frame: Frame, now: float) -> Frame | RejectedFrame:
        """Return the frame without its signature if the signature is valid and new.

        Args:
            frame: frame as received.
            now: seconds of Unix time.
        """
        if not frame.signature:
            return RejectedFrame(SignatureFault.UNSIGNED)
        stamped, digest = frame.signature[:-_DIGEST_SIZE], frame.signature[-_DIGEST_SIZE:]
        if not hmac.compare_digest(digest, self._digest(_sealed(frame) + stamped)):
            return RejectedFrame(SignatureFault.WRONG)
        stream = (stamped[0], frame.system, frame.component)
        timestamp = int.from_bytes(stamped[1:], "little")
        reason = self._timestamps.check(stream, timestamp, now)
        if reason is not None:
            return RejectedFrame(reason)
        self._timestamps.accept(stream, timestamp)
        return frame.unsigned()

    def sign(self, frame: Frame, now: float) -> bytes:
        """Sign and encode a frame; version 1 becomes version 2, because only version 2 can be signed.

        Args:
            frame: unsigned frame.
            now: seconds of Unix time.
        """
        signed = replace(frame, version=V2, incompat_flags=frame.incompat_flags | SIGNED, signature=b"")
        stamp = self._timestamps.next(now).to_bytes(_STAMP_SIZE, "little")
        stamped = signed.to_bytes() + bytes((self._link_id,)) + stamp
        return stamped + self._digest(stamped)

    def _digest(self, stamped: bytes) -> bytes:
        return hashlib.sha256(self._key.secret + stamped).digest()[:_DIGEST_SIZE]


def _sealed(frame: Frame) -> bytes:
    """Return header, payload and checksum of a frame, as received."""
    return replace(frame, signature=b"").to_bytes()


def _timestamp_at(now: float) -> int:
    return min(max(int((now - EPOCH) * UNITS_PER_SECOND), 0), LATEST)
