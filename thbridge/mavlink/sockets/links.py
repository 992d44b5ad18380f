"""Links from a session to ground stations over any transport. They pass frames to the session and answers to stations.

Everything runs on the thread of one event loop. This module parses frames and checks
signatures. The session gets complete, verified frames without signatures.
"""

import asyncio
import logging
import time
from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from sim.common.observations import TICK
from sim.common.robot_numbers import number_of
from thbridge.mavlink.wire.dialect import crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.channel import Channel
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.signing import KnownTimestamps, SignatureTimestamps, Signing, SigningKey
from thbridge.mavlink.wire.links import HubLink
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.mavlink.wire.traffic import FrameOutcome, OutgoingFrame
from thbridge.sockets.warn_once import WarnOnce

GARBAGE_LIMIT = 16 * 1024
"""After this number of consecutive bytes without a valid frame, a peer is disconnected (TCP) or ignored for a while."""

LINK_FRAMES = 128
"""Maximum number of frames that are processed per tick and link. With the shortest frames that stations send, this is
1 Mbit/s."""

WORK_SECONDS = 0.004
"""Maximum time for processing frames per tick, seconds. Then no further frame of any link is processed in the tick."""

TICK_ANSWERS = 100
"""After this number of answers in a tick, no further frame is processed. There is a limit, because recording answers
takes time."""

MOST_WAITING = 2048
"""Maximum number of waiting frames of a link. Further frames are dropped."""

_STORE_SECONDS = 0.1
"""Seconds between two writes of the timestamps."""

_log = logging.getLogger(__name__)


class MavlinkSession(Protocol):
    """Session with vehicles. It calls `MavlinkLinks.transmit` to send frames that are not answers."""

    def open_link(self, name: str, robot: int | None = None) -> LinkId:
        """Open a link of this name. If `robot` is an index, the link is to this robot only."""

    def close_link(self, link: LinkId) -> None:
        """Close a link."""

    def link(self, link: LinkId) -> HubLink | None:
        """Return the state of an open link, or None."""

    def receive_frame(self, link: LinkId, frame: Frame) -> FrameOutcome:
        """Process a received frame. It may be dropped or answered."""


class TimestampStore(Protocol):
    """Store that keeps timestamps of signatures between runs of the program."""

    def read(self) -> KnownTimestamps | None:
        """Return the timestamps of earlier runs, or None if they are unknown."""

    def write(self, known: KnownTimestamps) -> None:
        """Replace the stored timestamps."""


class FrameSender(Protocol):
    """Transport of one link."""

    def send_frames(self, frames: Sequence[bytes]) -> int:
        """Send frames in order. Return the number of frames that could not be sent."""


@dataclass(frozen=True, slots=True)
class FrameTotals:
    """Frame counts of all links together.

    Attributes:
        received: frames received.
        sent: frames sent.
        unsent: frames that could not be sent.
        dropped: frames and unread datagrams that were dropped because too many arrived.
    """

    received: int
    sent: int
    unsent: int
    dropped: int = 0


@dataclass(slots=True)
class _Link:
    """Open link. `taken` is the number of its frames that were processed in this tick."""

    name: str
    channel: Channel
    carrier: FrameSender
    waiting: deque[Frame] = field(default_factory=deque)
    taken: int = 0
    dropped: int = 0


class MavlinkLinks:
    """Transfer of frames between links and a session.

    It uses only a part of each tick. The session needs the rest of the tick.

    Links take turns. When the time is used up, further frames wait for the next tick.

    Args:
        key: key to sign and verify frames, or None.
        clock: returns seconds of Unix time, for signatures.
        stopwatch: returns seconds. It measures processing times.
        store: keeps timestamps of signatures between runs. If None, a run accepts only frames that were signed after
            its start.
    """

    def __init__(
        self,
        key: SigningKey | None,
        clock: Callable[[], float] = time.time,
        stopwatch: Callable[[], float] = time.monotonic,
        store: TimestampStore | None = None,
    ) -> None:
        self.complaints = WarnOnce(_log)
        self._key = key
        known = None if store is None else store.read()
        self._timestamps = SignatureTimestamps(known, clock() if known is None else 0.0)
        self._store = store
        self._stored = 0.0
        self._clock = clock
        self._exchange: MavlinkSession | None = None
        self._links: dict[LinkId, _Link] = {}
        self._met = 0
        self._received = self._sent = self._unsent = self._dropped = 0
        self._stopwatch = stopwatch
        self._window = -1
        self._spent = 0.0
        self._answers = 0
        # Both contain links with waiting frames. Links in `_turns` still have a turn in this tick. Links in `_served`
        # have used their share.
        self._turns: deque[LinkId] = deque()
        self._served: deque[LinkId] = deque()
        self._timer: asyncio.TimerHandle | None = None

    @property
    def totals(self) -> FrameTotals:
        """Frame counts so far."""
        return FrameTotals(self._received, self._sent, self._unsent, self._dropped)

    def serve(self, exchange: MavlinkSession) -> None:
        """Connect the links to a session. From now on, links can be opened."""
        self._exchange = exchange

    def channel(self, *, datagrams: bool) -> Channel:
        """Return a channel for a new peer. The peer may become a link later."""
        self._met += 1
        # In MAVLink, the id of a signed link is one byte.
        signing = None if self._key is None else Signing(self._key, self._met % 256, self._timestamps)
        return Channel(signing, datagrams=datagrams)

    def open(self, name: str, channel: Channel, carrier: FrameSender, robot: int | None = None) -> LinkId | None:
        """Open a link. If `robot` is an index, the link is to this robot only. Without a session, return None."""
        if self._exchange is None:
            return None
        link = self._exchange.open_link(name, robot)
        self._links[link] = _Link(name, channel, carrier)
        return link

    def close(self, link: LinkId) -> None:
        """Close a link. Closing it again has no effect."""
        closed = self._links.pop(link, None)
        if closed is not None and self._exchange is not None:
            _log.info("MAVLink: %s; %d dropped because too many arrived", self._exchange.link(link), closed.dropped)
            self._exchange.close_link(link)

    def frames_in(self, name: str, channel: Channel, data: bytes) -> list[Frame]:
        """Return the valid frames in received bytes. Log each fault of a peer once."""
        frames = channel.receive_data(data, self._clock())
        self._received += len(frames)
        if frames and self._stopwatch() - self._stored > _STORE_SECONDS:
            self.store_timestamps()
        if channel.last_fault:
            self.complaints.warn(f"MAVLink: {name}: bytes were discarded: {channel.last_fault}")
        return frames

    def store_timestamps(self) -> None:
        """Store the timestamps of accepted frames, so that the next run rejects repeated frames."""
        self._stored = self._stopwatch()
        if self._store is not None and self._key is not None:
            self._store.write(self._timestamps.known)

    def receive(self, link: LinkId, frames: Iterable[Frame]) -> None:
        """Process frames that a link received, now or when there is time, and send the answers."""
        there = self._links.get(link)
        if there is None:
            return
        given = list(frames)
        # A link with waiting frames already is in one of the two queues.
        if given and not there.waiting:
            (self._turns if there.taken < LINK_FRAMES else self._served).append(link)
        room = MOST_WAITING - len(there.waiting)
        there.waiting += given[:room]
        if len(given) > room:
            self.drop(link, len(given) - room)
        self._work()

    def has_room(self, link: LinkId) -> bool:
        """Return True if at most half of the allowed frames of a link wait. Otherwise the link parses no more bytes."""
        there = self._links.get(link)
        return there is None or len(there.waiting) <= MOST_WAITING // 2

    def drop(self, link: LinkId, count: int) -> None:
        """Count frames that are dropped because too many arrived. Report only the first case."""
        there = self._links[link]
        self._dropped += count
        there.dropped += count
        if there.dropped == count:
            # Only once for each link, because the warnings would add to the flood.
            self.complaints.warn(f"MAVLink: {there.name} sends too many frames; some frames are dropped")
            self.transmit([OutgoingFrame(link, self._flood_warning(link))])

    def _flood_warning(self, link: LinkId) -> Frame:
        """Return a text for the station. Its sender is a bridge component, because vehicles do not detect floods."""
        state = None if self._exchange is None else self._exchange.link(link)
        robot = 0 if state is None or state.robot is None else state.robot
        text = mav.MAVLink_statustext_message(mav.MAV_SEVERITY_WARNING, b"Too many frames: some are dropped.", 0, 0)
        number = text.get_msgId()
        return Frame(number_of(robot), mav.MAV_COMP_ID_UDP_BRIDGE, 0, number, payload_of(text), crc_extra(number) or 0)

    def _work(self) -> None:
        """Process waiting frames, link after link, while there is time."""
        window = int(self._stopwatch() / TICK)
        # The limits are for each tick of real time, which may differ from the steps of the session.
        if window != self._window:
            self._window, self._spent, self._answers = window, 0.0, 0
            self._turns += self._served
            self._served.clear()
            for there in self._links.values():
                there.taken = 0
        answers: list[OutgoingFrame] = []
        while self._turns and self._spent < WORK_SECONDS and self._answers < TICK_ANSWERS:
            begun = self._stopwatch()
            link = self._turns.popleft()
            if link in self._links:
                replies = self._handle_next(link, self._links[link])
                self._answers += len(replies)
                answers += replies
            self._spent += self._stopwatch() - begun
        self.transmit(answers)
        if (self._turns or self._served) and self._timer is None:
            self._timer = asyncio.get_running_loop().call_later(TICK, self._go_on)

    def _go_on(self) -> None:
        self._timer = None
        self._work()

    def _handle_next(self, link: LinkId, there: _Link) -> Sequence[OutgoingFrame]:
        if self._exchange is None:
            return ()
        outcome = self._exchange.receive_frame(link, there.waiting.popleft())
        if outcome.dropped is not None:
            self.complaints.warn(f"MAVLink: {there.name}: a frame was dropped: {outcome.dropped}")
        there.taken += 1
        if there.waiting:
            (self._turns if there.taken < LINK_FRAMES else self._served).append(link)
        return outcome.replies

    def transmit(self, sent: Sequence[OutgoingFrame]) -> None:
        """Send frames, each on its link."""
        now = self._clock()
        waiting: defaultdict[LinkId, list[bytes]] = defaultdict(list)
        # Frames of a link are collected, because UDP packs several frames into a datagram.
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
                self.complaints.warn(f"MAVLink: {there.name}: some frames could not be sent and are lost")
