"""Signatures of MAVLink 2. Only frames that are signed with the key are accepted, and each frame only once.

Source: the MAVLink developer guide, "Message Signing".

Differences from the source: no unsigned frame is accepted. Other programs accept RADIO_STATUS, which radios send
without a key. Here there is no radio between robots and stations. If such a frame were forwarded with our signature, it
would seem to come from the key's owner. Keys from the network (SETUP_SIGNING) are never accepted. Timestamps in the
last months of the 48-bit range are refused, because no later frame could have a newer timestamp.
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
"""Units of timestamps per second. A unit is 10 microseconds."""

EPOCH = 1_420_070_400
"""Unix time of timestamp 0: 1 January 2015."""

FIRST_TIMESTAMP_TOLERANCE = 60 * UNITS_PER_SECOND
"""Maximum number of units by which the first timestamp of a stream may be older than our timestamp."""

LATEST = (1 << 48) - (1 << 40)
"""Latest accepted timestamp. At 100,000 frames per second, the rest of the range is enough for four months."""

MAX_STREAMS = 1024
"""Maximum number of senders whose timestamps are stored."""

_HEX_KEY = re.compile(r"[0-9a-fA-F]{64}")
_STAMP_SIZE = 6
_DIGEST_SIZE = 6


@dataclass(frozen=True, slots=True)
class SigningKey:
    """Secret that both ends of a link have. `repr` does not show it.

    Raises:
        ValueError: the secret does not have 32 bytes.
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
    """Reason why a frame is rejected. It completes a log message after a colon."""

    UNSIGNED = "it is not signed"
    WRONG = "its signature is wrong"
    REPEATED = "its timestamp is not newer than the last timestamp of its sender"
    OLD = "its sender is new, and its timestamp is more than a minute old"
    BEFORE = "it was signed before this program started, and earlier timestamps are unknown"
    FAR_AHEAD = "its timestamp is too near the end of the range of timestamps"
    CROWDED = f"there are already {MAX_STREAMS} other senders"


@dataclass(frozen=True, slots=True)
class RejectedFrame:
    """Rejection of a frame because of its signature."""

    reason: SignatureFault


def parse_key(content: bytes) -> SigningKey | InvalidKey:
    """Return the key in a file: 32 raw bytes, 64 hexadecimal digits, or a passphrase.

    A line of text is a passphrase. Its SHA-256 is the key, as in MAVProxy and Mission Planner. Since 2025,
    QGroundControl derives keys from passphrases differently, but it shows the keys as 64 digits.

    Args:
        content: complete content of the file. Printable characters are text, with or without a line end.
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
    """Timestamps at the end of an earlier run with the same key.

    Attributes:
        latest: the latest timestamp, including our own timestamps.
        streams: last accepted timestamp of each stream (link, system, component).
    """

    latest: int
    streams: Mapping[tuple[int, int, int], int]


class SignatureTimestamps:
    """Timestamps that we and other senders have used so far on all links with one key.

    The links share these timestamps, so that a frame from one link is not accepted again on another link.

    Args:
        known: timestamps of an earlier run.
        not_before: Unix time in seconds before which no frame is accepted. Without timestamps of an earlier run, this
            is the start of the program, because an earlier run may have accepted older frames.
    """

    def __init__(self, known: KnownTimestamps | None = None, not_before: float = 0.0) -> None:
        self._latest = 0 if known is None else known.latest
        self._streams: dict[tuple[int, int, int], int] = {}
        if known is not None:
            # If there are many senders, forget those whose old frames would be refused even from an unknown sender.
            kept = 0 if len(known.streams) <= MAX_STREAMS // 2 else known.latest - FIRST_TIMESTAMP_TOLERANCE
            self._streams = {stream: last for stream, last in known.streams.items() if last >= kept}
        self._not_before = _timestamp_at(not_before)

    @property
    def known(self) -> KnownTimestamps:
        """Current timestamps, for the next run."""
        return KnownTimestamps(self._latest, dict(self._streams))

    def next(self, now: float) -> int:
        """Return a timestamp for signing. It is newer than all our earlier timestamps and all accepted timestamps."""
        # Timestamps must increase even if several frames are signed at once, or the clock is set back.
        self._latest = max(self._latest + 1, _timestamp_at(now))
        return self._latest

    def check(self, stream: tuple[int, int, int], timestamp: int, now: float) -> SignatureFault | None:
        """Return the reason to reject a timestamp of a stream (link, system, component), or None to accept it."""
        if timestamp > LATEST:
            return SignatureFault.FAR_AHEAD
        last = self._streams.get(stream)
        if last is not None:
            return SignatureFault.REPEATED if timestamp <= last else None
        # By the standard, the first timestamp of a stream may be at most one minute old.
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
        key: key of both ends of the link.
        link_id: our number of this link, 0 to 255. It is part of the signature.
        timestamps: timestamps of all links with this key.
    """

    def __init__(self, key: SigningKey, link_id: int, timestamps: SignatureTimestamps) -> None:
        self._key: Final = key
        self._link_id: Final = link_id
        self._timestamps: Final = timestamps

    def verify(self, frame: Frame, now: float) -> Frame | RejectedFrame:
        """Return the frame without its signature if the signature is valid and new.

        Args:
            frame: received frame.
            now: seconds of Unix time.
        """
        if not frame.signature:
            return RejectedFrame(SignatureFault.UNSIGNED)
        stamped, digest = frame.signature[:-_DIGEST_SIZE], frame.signature[-_DIGEST_SIZE:]
        # `compare_digest` takes the same time for all digests, so that senders cannot guess a digest byte by byte.
        if not hmac.compare_digest(digest, self._digest(_sealed(frame) + stamped)):
            return RejectedFrame(SignatureFault.WRONG)
        # By the standard, each link, system and component has its own sequence of timestamps.
        stream = (stamped[0], frame.system, frame.component)
        timestamp = int.from_bytes(stamped[1:], "little")
        reason = self._timestamps.check(stream, timestamp, now)
        if reason is not None:
            return RejectedFrame(reason)
        self._timestamps.accept(stream, timestamp)
        return frame.unsigned()

    def sign(self, frame: Frame, now: float) -> bytes:
        """Sign and encode a frame. Version 1 becomes version 2, because only version 2 can be signed.

        Args:
            frame: unsigned frame.
            now: seconds of Unix time.
        """
        signed = replace(frame, version=V2, incompat_flags=frame.incompat_flags | SIGNED, signature=b"")
        stamp = self._timestamps.next(now).to_bytes(_STAMP_SIZE, "little")
        stamped = signed.to_bytes() + bytes((self._link_id,)) + stamp
        return stamped + self._digest(stamped)

    def _digest(self, stamped: bytes) -> bytes:
        # By the standard, a signature consists of the first 48 bits of SHA-256.
        return hashlib.sha256(self._key.secret + stamped).digest()[:_DIGEST_SIZE]


def _sealed(frame: Frame) -> bytes:
    """Return the header, payload and checksum of a frame, as received."""
    return replace(frame, signature=b"").to_bytes()


def _timestamp_at(now: float) -> int:
    return min(max(int((now - EPOCH) * UNITS_PER_SECOND), 0), LATEST)
