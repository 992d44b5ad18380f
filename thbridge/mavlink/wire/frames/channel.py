"""Frame codec of one link. It converts bytes of a stream or of datagrams to complete frames and back.

With a key, it also signs and verifies frames. It uses no sockets and no clocks.
"""

from dataclasses import dataclass

from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.framer import DiscardedBytes, FrameParser, parse_datagram
from thbridge.mavlink.wire.frames.signing import RejectedFrame, Signing


@dataclass(slots=True)
class ChannelCounts:
    """Counts of received data on a link.

    Attributes:
        frames: number of valid frames.
        discarded_bytes: number of bytes that are not part of a valid frame.
        refused: number of complete frames without a valid signature.
    """

    frames: int = 0
    discarded_bytes: int = 0
    refused: int = 0


class Channel:
    """Frame codec of one link.

    Args:
        signing: signs and verifies frames. If None, frames are not signed, and signatures are ignored.
        datagrams: True for datagrams, which contain complete frames. False for a stream.

    Attributes:
        counts: counts of the data received so far.
        bytes_since_good: number of bytes received since the last valid frame.
        last_fault: reason for the latest rejection. Empty if nothing was rejected.
    """

    def __init__(self, signing: Signing | None, *, datagrams: bool) -> None:
        self.counts = ChannelCounts()
        self.bytes_since_good = 0
        self.last_fault = ""
        self._find = parse_datagram if datagrams else FrameParser().receive_data
        self._signing = signing

    def receive_data(self, data: bytes, now: float) -> list[Frame]:
        """Return the valid frames in received bytes, without signatures.

        Args:
            data: a datagram, or any piece of a stream.
            now: seconds of Unix time, for signatures.
        """
        good: list[Frame] = []
        for found in self._find(data):
            if isinstance(found, DiscardedBytes):
                self.counts.discarded_bytes += found.size
                self._spoil(found.size, found.reason)
                continue
            frame = found.unsigned() if self._signing is None else self._signing.verify(found, now)
            if isinstance(frame, RejectedFrame):
                self.counts.refused += 1
                self._spoil(len(found.payload), frame.reason)
                continue
            self.counts.frames += 1
            self.bytes_since_good = 0
            good.append(frame)
        return good

    def encode(self, frame: Frame, now: float) -> bytes:
        """Return a frame's bytes, signed if there is a key."""
        return frame.to_bytes() if self._signing is None else self._signing.sign(frame, now)

    def _spoil(self, size: int, complaint: str) -> None:
        self.bytes_since_good += size
        self.last_fault = complaint
