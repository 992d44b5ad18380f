"""Writers: a history of samples, and the state of each matched reader.

Source: DDSI-RTPS 2.3, section 8.4.9. A writer never waits: it keeps `depth` samples, and a reliable reader that is too
slow gets a gap instead of the others.
"""

from collections.abc import KeysView, Sequence, Set
from dataclasses import dataclass

from thbridge.ros2.qos import DeliveryReliability, Durability, QosProfile
from thbridge.ros2graph.wire.rtps.guids import UNKNOWN, Guid
from thbridge.ros2graph.wire.rtps.outbox import Destination, Outbox
from thbridge.ros2graph.wire.rtps.submessages import (
    READER_AT,
    Acknowledgment,
    FragmentRequest,
    encode_data,
    encode_fragments,
    encode_gap,
    encode_heartbeat,
)

MOST_READERS = 1024
"""Maximum number of matched readers of a writer."""
_FIRST_PAUSE_NS, _LONGEST_PAUSE_NS = 20_000_000, 1_000_000_000
"""Pauses between two heartbeats for a reader that does not acknowledge."""
_UNBOUNDED = 1 << 30


@dataclass(slots=True)
class _Kept:
    """Kept sample.

    Attributes:
        pieces: the sample as one submessage, or its fragments.
        stamp_ns: its time, nanoseconds since 1970.
        only: prefixes of the participants that get it. If None, all get it.
    """

    pieces: Sequence[bytes]
    stamp_ns: int
    only: Set[bytes] | None


@dataclass(slots=True)
class _MatchedReader:
    """State of a matched reader.

    Attributes:
        id: id of the reader inside of its participant.
        destination: where it receives.
        reliable: whether it acknowledges samples.
        start: number of the first sample that it gets.
        has_begun: whether it knows where it starts. A reader of Cyclone DDS skips all samples of its first heartbeat,
            so until it answers, heartbeats end before its first sample. Readers of a latched writer skip nothing.
        acknowledged: number up to which it has all samples.
        counted: count of its last acknowledgment.
        counted_fragments: count of its last request of fragments.
        pause_ns: pause until the next heartbeat.
        due_ns: time of the next heartbeat; None until the next tick decides.
    """

    id: bytes
    destination: Destination
    reliable: bool
    start: int
    has_begun: bool
    acknowledged: int
    counted: int = -1
    counted_fragments: int = -1
    pause_ns: int = _FIRST_PAUSE_NS
    due_ns: int | None = None


class RtpsWriter:
    """Writer of one topic.

    Attributes:
        readers: GUIDs of the matched readers.
        returned: number of times that a reader has lost us, and has found us again.

    Args:
        guid: its GUID.
        qos: its quality of service.
        outbox: gets what it sends.
        fragment_size: samples above this number of bytes are sent in fragments of this size.
        keep_all: keep all samples until `forget`, instead of the last `qos.depth`.
    """

    def __init__(
        self, guid: Guid, qos: QosProfile, outbox: Outbox, fragment_size: int, *, keep_all: bool = False
    ) -> None:
        self.guid = guid
        self.id = guid[-4:]
        self.qos = qos
        self.returned = 0
        self._depth = _UNBOUNDED if keep_all else qos.depth
        self._outbox = outbox
        self._fragment_size = fragment_size
        self._history: dict[int, _Kept] = {}
        self._last = self._last_of_tick = 0
        self._count = 0
        self._readers: dict[Guid, _MatchedReader] = {}
        self.readers: KeysView[Guid] = self._readers.keys()
        self._routes: list[tuple[Destination, bool]] | None = None

    @property
    def next(self) -> int:
        """Sequence number of the next sample."""
        return self._last + 1

    def knows(self, reader: Guid) -> bool:
        """Return True if a reader is matched."""
        return reader in self._readers

    def has_acknowledged(self, reader: Guid, sequence: int) -> bool:
        """Return True if a reader has all samples up to a number."""
        matched = self._readers.get(reader)
        return matched is not None and matched.acknowledged >= sequence

    def match(self, reader: Guid, qos: QosProfile, destination: Destination) -> bool:
        """Begin to send to a reader. Return False if there are too many readers."""
        if reader in self._readers:
            return True
        if len(self._readers) >= MOST_READERS:
            return False
        latched = qos.durability == self.qos.durability == Durability.TRANSIENT_LOCAL
        start = 1 if latched else self._last + 1
        reliable = qos.reliability == self.qos.reliability == DeliveryReliability.RELIABLE
        matched = _MatchedReader(reader[-4:], destination, reliable, start, latched, start - 1)
        self._readers[reader] = matched
        self._routes = None
        if reliable:
            self._announce(matched, final=False)
        return True

    def unmatch(self, reader: Guid) -> None:
        """Stop sending to a reader."""
        if self._readers.pop(reader, None) is not None:
            self._routes = None

    def write(
        self, payload: bytes, stamp_ns: int, inline: bytes = b"", *, key: bool = False, only: Set[bytes] | None = None
    ) -> int:
        """Send a sample to all matched readers, and keep it. Return its sequence number.

        Args:
            payload: message with its CDR header.
            stamp_ns: time of the message, nanoseconds since 1970.
            inline: inline quality of service.
            key: whether the payload is only the key of a disposed sample.
            only: prefixes of the participants that get the sample. If None, all get it.
        """
        self._last = sequence = self._last + 1
        pieces: Sequence[bytes]
        if len(payload) <= self._fragment_size:
            pieces = (encode_data(self.id, sequence, payload, stamp_ns, inline, key=key),)
        else:
            pieces = encode_fragments(self.id, sequence, payload, stamp_ns, self._fragment_size, inline)
        if self.qos.reliability == DeliveryReliability.RELIABLE:
            self._history[sequence] = _Kept(pieces, stamp_ns, only)
            if len(self._history) > self._depth:
                del self._history[next(iter(self._history))]
        # Only readers that miss something answer a final heartbeat.
        heartbeat = self._heartbeat(UNKNOWN, self._first(), sequence, final=True)
        for destination, with_heartbeat in self._route():
            if only is not None and destination.prefix not in only:
                pieces_here: Sequence[bytes] = (encode_gap(UNKNOWN, self.id, (sequence,)),)
            else:
                pieces_here = pieces
            for piece in pieces_here:
                self._outbox.add(destination, piece)
            if with_heartbeat:
                self._outbox.add(destination, heartbeat)
        return sequence

    def forget(self, sequence: int) -> None:
        """Do not keep a sample any longer."""
        self._history.pop(sequence, None)

    def on_acknowledgment(self, message: Acknowledgment, stamp_ns: int) -> None:
        """Process an acknowledgment: send the requested samples, or gaps in their place."""
        reader = self._readers.get(message.reader)
        if reader is None or not reader.reliable or message.base > self._last + 1:
            return
        # Counts are not compared for equality: a reader that has lost us, and finds us again, counts from the start.
        self.returned += message.count < reader.counted
        reader.counted = message.count
        begins = not reader.has_begun and message.base >= reader.start and not message.requests_heartbeat
        if begins:
            reader.has_begun = True
            self._routes = None
        acknowledged = max(message.base, reader.start) - 1
        if begins or acknowledged > reader.acknowledged:
            reader.pause_ns, reader.due_ns = _FIRST_PAUSE_NS, None
        reader.acknowledged = acknowledged
        if not message.missing:
            if begins or not message.final:
                self._announce(reader, final=reader.has_begun)
            return
        gone: list[int] = []
        is_complete = True
        for sequence in message.missing:
            if sequence > self._last:
                break
            kept = self._kept_for(reader, sequence, stamp_ns)
            if kept is None:
                gone.append(sequence)
                continue
            is_complete = all(self._resend(reader, piece) for piece in kept.pieces)
            if not is_complete:
                break
        if gone:
            self._outbox.add(reader.destination, encode_gap(reader.id, self.id, gone))
        if is_complete:
            # The answer acknowledges them, or requests the next ones. Otherwise, the next tick asks for an answer.
            self._announce(reader, final=False)

    def on_fragment_request(self, message: FragmentRequest, stamp_ns: int) -> None:
        """Process a request of fragments: send them again."""
        reader = self._readers.get(message.reader)
        if reader is None or not reader.reliable or message.count == reader.counted_fragments:
            return
        reader.counted_fragments = message.count
        kept = self._kept_for(reader, message.sequence, stamp_ns)
        if kept is None:
            if message.sequence <= self._last:
                self._outbox.add(reader.destination, encode_gap(reader.id, self.id, (message.sequence,)))
            return
        pieces = (kept.pieces[number - 1] for number in message.missing if 0 < number <= len(kept.pieces))
        if all(self._resend(reader, piece) for piece in pieces):
            self._announce(reader, final=False)

    def ask(self, reader: Guid) -> None:
        """Request an acknowledgment from a reader."""
        if reader in self._readers:
            self._announce(self._readers[reader], final=False)

    def tick(self, now_ns: int) -> bool:
        """Send heartbeats to readers that have not begun, or have not acknowledged all samples.

        New samples had heartbeats, so readers that have begun need others only after the last of several samples.

        Returns:
            False if there are no such readers.
        """
        waiting = False
        has_written, self._last_of_tick = self._last > self._last_of_tick, self._last
        for reader in self._readers.values():
            if not reader.reliable or (reader.has_begun and reader.acknowledged >= self._last):
                continue
            waiting = True
            if reader.due_ns is None or (has_written and reader.has_begun):
                reader.due_ns = now_ns + reader.pause_ns
            elif now_ns >= reader.due_ns:
                reader.pause_ns = min(2 * reader.pause_ns, _LONGEST_PAUSE_NS)
                reader.due_ns = now_ns + reader.pause_ns
                self._announce(reader, final=False)
        return waiting

    def _kept_for(self, reader: _MatchedReader, sequence: int, stamp_ns: int) -> _Kept | None:
        """Return a sample that a reader may get."""
        kept = self._history.get(sequence)
        if kept is None or sequence < reader.start:
            return None
        if kept.only is not None and reader.destination.prefix not in kept.only:
            return None
        if self.qos.lifespan_ns is not None and stamp_ns - kept.stamp_ns > self.qos.lifespan_ns:
            return None
        return kept

    def _resend(self, reader: _MatchedReader, piece: bytes) -> bool:
        """Send a sample or fragment again. Return False if too much was sent again in this tick."""
        if not self._outbox.may_resend(len(piece)):
            return False
        self._outbox.add(reader.destination, piece[:READER_AT] + reader.id + piece[READER_AT + 4 :])
        return True

    def _first(self) -> int:
        return next(iter(self._history), self._last + 1)

    def _announce(self, reader: _MatchedReader, *, final: bool) -> None:
        first, last = max(self._first(), reader.start), self._last
        if not reader.has_begun:
            first, last = reader.start, reader.start - 1
        self._outbox.add(reader.destination, self._heartbeat(reader.id, first, last, final=final))

    def _heartbeat(self, reader: bytes, first: int, last: int, *, final: bool) -> bytes:
        self._count += 1
        return encode_heartbeat(reader, self.id, first, last, self._count, final=final)

    def _route(self) -> list[tuple[Destination, bool]]:
        """Return the destinations of live samples, one for each participant, and whether they get a heartbeat.

        It is for all readers of the participant, so all of its reliable ones must have begun.
        """
        if self._routes is None:
            routes: dict[Destination, bool | None] = {}
            for each in self._readers.values():
                begun = routes.setdefault(each.destination, None)
                if each.reliable:
                    routes[each.destination] = each.has_begun and begun is not False
            self._routes = [(destination, bool(begun)) for destination, begun in routes.items()]
        return self._routes
