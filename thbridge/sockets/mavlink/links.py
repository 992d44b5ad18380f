"""Links of a session to ground stations over any transport: received frames go to the session, its answers go out.

Everything runs on the thread of one event loop. Framing and signatures end here: the session gets complete, verified
frames without their signature.
"""

import logging
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

from thbridge.protocols.mavlink.frames.channel import Channel
from thbridge.protocols.mavlink.frames.frame import Frame
from thbridge.protocols.mavlink.frames.signing import SignatureTimestamps, Signing, SigningKey
from thbridge.protocols.mavlink.links import HubLink
from thbridge.protocols.mavlink.outgoing import LinkId
from thbridge.protocols.mavlink.traffic import FrameOutcome, OutgoingFrame
from thbridge.sockets.warn_once import WarnOnce

GARBAGE_LIMIT = 16 * 1024
"""Bytes in a row without a good frame after which a peer is ignored, for some time at least."""

_log = logging.getLogger(__name__)


class MavlinkSession(Protocol):
    """Session behind the links, with its vehicles.

    Attributes:
        transmit: sends frames that are no answers; set by the links.
    """

    transmit: Callable[[Sequence[OutgoingFrame]], None]

    def open_link(self, name: str, robot: int | None = None) -> LinkId:
        """Open a link of this name, to this robot alone if one is given, from 0."""

    def close_link(self, link: LinkId) -> None:
        """Close a link."""

    def link(self, link: LinkId) -> HubLink | None:
        """Return the state of an open link; None when there is no such link."""

    def receive_frame(self, link: LinkId, frame: Frame) -> FrameOutcome:
        """Handle a received frame: it is dropped, or answered."""


class FrameSender(Protocol):
    """Transport of one link."""

    def send_frames(self, frames: Sequence[bytes]) -> int:
        """Send frames, in order; return how many of them could not be sent."""


@dataclass(frozen=True, slots=True)
class FrameTotals:
    """Frame counts of all links together.

    Attributes:
        received: frames received.
        sent: frames sent.
        unsent: frames that could not be sent.
    """

    received: int
    sent: int
    unsent: int


@dataclass(frozen=True, slots=True)
class _Link:
    name: str
    channel: Channel
    carrier: FrameSender


class MavlinkLinks:
    """Passes frames between links and a session.

    Args:
        key: key to sign and verify frames; None for none.
        clock: returns seconds of Unix time, for signatures.
    """

    def __init__(self, key: SigningKey | None, clock: Callable[[], float] = time.time) -> None:
        self.complaints = WarnOnce(_log)
        self._key = key
        self._timestamps = SignatureTimestamps()
        self._clock = clock
        self._exchange: MavlinkSession | None = None
        self._links: dict[LinkId, _Link] = {}
        self._met = 0
        self._received = self._sent = self._unsent = 0

    @property
    def totals(self) -> FrameTotals:
        """Frame counts until now."""
        return FrameTotals(self._received, self._sent, self._unsent)

    def serve(self, exchange: MavlinkSession) -> None:
        """Connect the links to a session; links can be opened from now on."""
        self._exchange = exchange
        exchange.transmit = self.transmit

    def channel(self, *, datagrams: bool) -> Channel:
        """Return a channel for a new peer, which may become a link."""
        self._met += 1
        signing = None if self._key is None else Signing(self._key, self._met % 256, self._timestamps)
        return Channel(signing, datagrams=datagrams)

    def open(self, name: str, channel: Channel, carrier: FrameSender, robot: int | None = None) -> LinkId | None:
        """Open a link, to this robot alone if one is given, from 0; None as long as there is no session."""
        if self._exchange is None:
            return None
        link = self._exchange.open_link(name, robot)
        self._links[link] = _Link(name, channel, carrier)
        return link

    def close(self, link: LinkId) -> None:
        """Close a link; no effect on a closed one."""
        if self._links.pop(link, None) is not None and self._exchange is not None:
            _log.info("MAVLink: %s", self._exchange.link(link))
            self._exchange.close_link(link)

    def frames_in(self, name: str, channel: Channel, data: bytes) -> list[Frame]:
        """Return the good frames in received bytes; the log gets one warning for each peer and fault."""
        frames = channel.receive_data(data, self._clock())
        self._received += len(frames)
        if channel.last_fault:
            self.complaints.warn(f"MAVLink: {name}: thrown away: {channel.last_fault}")
        return frames

    def receive(self, link: LinkId, frames: Iterable[Frame]) -> None:
        """Handle frames received on a link, and send the answers."""
        if self._exchange is None:
            return
        answers: list[OutgoingFrame] = []
        for frame in frames:
            outcome = self._exchange.receive_frame(link, frame)
            if outcome.dropped is not None:
                self.complaints.warn(f"MAVLink: {self._links[link].name}: a frame goes nowhere: {outcome.dropped}")
            answers += outcome.replies
        self.transmit(answers)

    def transmit(self, sent: Sequence[OutgoingFrame]) -> None:
        """Send frames, each on its link."""
        now = self._clock()
        waiting: defaultdict[LinkId, list[bytes]] = defaultdict(list)
        for one in sent:
            there = self._links.get(one.link)
            if there is not None:
                waiting[one.link].append(there.channel.encode(one.frame, now))
        for link, frames in waiting.items():
            there = self._links[link]
            unsent = there.carrier.send_frames(frames)
            self._sent += len(frames) - unsent
            self._unsent += unsent
            if unsent:
                self.complaints.warn(f"MAVLink: {there.name}: frames could not be sent and are lost")
