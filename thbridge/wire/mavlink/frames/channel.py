"""One link's bytes: a stream or datagrams become frames that are whole and, where there is a key, verified; and back.

Without sockets and clocks.
"""

from dataclasses import dataclass

from thbridge.wire.mavlink.frames.frame import Frame
from thbridge.wire.mavlink.frames.framer import DiscardedBytes, FrameParser, frames_of
from thbridge.wire.mavlink.frames.signing import RejectedFrame, Signing


@dataclass(slots=True)
class ChannelCounts:
    """What has come in on a link.

    Attributes:
        frames: that were good.
        noise: bytes that were no good frame.
        refused: frames that were whole, but not signed as they must be.
    """

    frames: int = 0
    noise: int = 0
    refused: int = 0


class Channel:
    """One link.

    Args:
        signing: what signs and verifies; None: nothing is signed, and signatures are not looked at.
        datagrams: frames come whole, some to a datagram; or else in a stream.

    Attributes:
        tally: what has come in.
        spoiled: bytes that came since the last good frame.
        complaint: why something was not taken last; empty as long as nothing was not.
    """

    def __init__(self, signing: Signing | None, *, datagrams: bool) -> None:
        self.tally = ChannelCounts()
        self.spoiled = 0
        self.complaint = ""
        self._find = frames_of if datagrams else FrameParser().receive_data
        self._signing = signing

    def receive_data(self, data: bytes, now: float) -> list[Frame]:
        """What was in bytes that came in, without signatures.

        Args:
            data: a datagram, or any piece of a stream.
            now: seconds of Unix time, for signatures.
        """
        good: list[Frame] = []
        for found in self._find(data):
            if isinstance(found, DiscardedBytes):
                self.tally.noise += found.size
                self._spoil(found.size, found.reason)
                continue
            frame = found.unsigned() if self._signing is None else self._signing.unwrap(found, now)
            if isinstance(frame, RejectedFrame):
                self.tally.refused += 1
                self._spoil(len(found.payload), frame.reason)
                continue
            self.tally.frames += 1
            self.spoiled = 0
            good.append(frame)
        return good

    def bytes_of(self, frame: Frame, now: float) -> bytes:
        """A frame as it goes out, signed where that is wanted."""
        return frame.to_bytes() if self._signing is None else self._signing.wrap(frame, now)

    def _spoil(self, size: int, complaint: str) -> None:
        self.spoiled += size
        self.complaint = complaint
