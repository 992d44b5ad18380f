"""Readers: the state of each matched writer, the order of samples, and the reassembly of fragments.

Source: DDSI-RTPS 2.3, section 8.4.12. Samples of a reliable writer are delivered in order; a best-effort reader drops
samples that arrive late.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from thbridge.ros2.qos import DeliveryReliability, Durability, QosProfile
from thbridge.ros2graph.wire.rtps.discovery import is_disposed
from thbridge.ros2graph.wire.rtps.guids import Guid
from thbridge.ros2graph.wire.rtps.outbox import Destination, Outbox
from thbridge.ros2graph.wire.rtps.parameters import Parameter
from thbridge.ros2graph.wire.rtps.submessages import (
    MOST_BITS,
    Data,
    DataFragment,
    Heartbeat,
    HeartbeatFragment,
    SampleGap,
    encode_acknowledgment,
    encode_fragment_request,
)

MOST_WRITERS = 1024
"""Maximum number of matched writers of a reader."""
LARGEST_SAMPLE = 32 << 20
"""Maximum number of bytes of a sample."""
MOST_FRAGMENTS = 1 << 15
"""Maximum number of fragments of a sample. Cyclone DDS sends fragments of 1344 bytes."""
MOST_EARLY = 256
"""Maximum number of samples per writer that wait for an earlier one."""
MOST_INCOMPLETE = 8
"""Maximum number of samples per writer in reassembly."""
HELD_BYTES = 128 << 20
"""Maximum number of bytes that a participant holds in samples that wait for others, or for their fragments."""
MOST_LEFT = 64
"""Maximum number of lost writers whose position a reader remembers."""
_OVERHEAD = 128
"""Bytes that a held sample or fragment needs in addition to its content."""
_PAUSE_NS, _LONGEST_PAUSE_NS = 100_000_000, 1_600_000_000
"""Pauses before and between two requests that no heartbeat has asked for."""


class HeldBytes:
    """Bytes that all readers of a participant hold, and their limit."""

    def __init__(self, limit: int = HELD_BYTES) -> None:
        self._limit = limit
        self.held = 0

    def take(self, size: int) -> bool:
        """Reserve bytes. Return False if there are too few left."""
        if self.held + size > self._limit:
            return False
        self.held += size
        return True

    def free(self, size: int) -> None:
        """Release bytes."""
        self.held -= size


@dataclass(frozen=True, slots=True)
class ReceivedSample:
    """Sample that a reader delivers.

    Attributes:
        writer: GUID of the writer.
        sequence: its number at the writer.
        payload: message with its CDR header; empty or a key if `disposed`.
        inline: inline quality of service.
        disposed: whether the writer says that the object of the sample is gone.
    """

    writer: Guid
    sequence: int
    payload: bytes
    inline: Sequence[Parameter]
    disposed: bool


OnSample: TypeAlias = Callable[[ReceivedSample], None]


@dataclass(slots=True)
class _Incomplete:
    """Sample in reassembly."""

    size: int
    fragment_size: int
    inline: Sequence[Parameter]
    pieces: dict[int, bytes] = field(default_factory=dict)
    held: int = 0
    first_missing: int = 1

    @property
    def total(self) -> int:
        return -(-self.size // self.fragment_size)

    def missing(self) -> list[int]:
        """Return the missing fragments that one request can name."""
        while self.first_missing in self.pieces:
            self.first_missing += 1
        end = min(self.first_missing + MOST_BITS, self.total + 1)
        return [number for number in range(self.first_missing, end) if number not in self.pieces]


@dataclass(slots=True)
class _MatchedWriter:
    """State of a matched writer.

    Attributes:
        guid: its GUID.
        destination: where it receives acknowledgments.
        reliable: whether it sends lost samples again.
        anyone: base of the acknowledgment that requests a first heartbeat.
        next: number of the next sample to deliver; None until a heartbeat says which samples there are.
        early: samples that wait for an earlier one; None for a sample that will not come.
        incomplete: samples in reassembly.
        last: number of the last sample that a heartbeat has announced.
        heartbeats: count of the last heartbeat.
        asked: number of the next sample at the last request that no heartbeat has asked for.
        pause_ns: pause until the next such request.
        due_ns: time of the next such request; None until the next tick decides.
    """

    guid: Guid
    destination: Destination
    reliable: bool
    anyone: int
    next: int | None
    early: dict[int, ReceivedSample | None] = field(default_factory=dict)
    incomplete: dict[int, _Incomplete] = field(default_factory=dict)
    last: int = 0
    heartbeats: int = -1
    asked: int | None = None
    pause_ns: int = _PAUSE_NS
    due_ns: int | None = None

    @property
    def waits(self) -> bool:
        """True if its first heartbeat is missing, or something that it has announced or sent before something else."""
        return self.reliable and (self.next is None or self.next <= self.last or bool(self.early or self.incomplete))


class RtpsReader:
    """Reader of one topic.

    Attributes:
        expects: whether its writers are asked from time to time if they have sent something.

    Args:
        guid: its GUID.
        qos: its quality of service.
        outbox: gets its acknowledgments.
        held: limit of the bytes that wait.
        on_sample: called with each sample.
    """

    def __init__(self, guid: Guid, qos: QosProfile, outbox: Outbox, held: HeldBytes, on_sample: OnSample) -> None:
        self.guid = guid
        self.id = guid[-4:]
        self.qos = qos
        self.expects = False
        self._outbox = outbox
        self._held = held
        self._on_sample = on_sample
        self._writers: dict[Guid, _MatchedWriter] = {}
        self._left: dict[Guid, int] = {}
        # A writer that is matched again may remember the last count, and ignores lower ones.
        self._count = 0

    @property
    def writers(self) -> Sequence[Guid]:
        """GUIDs of the matched writers."""
        return list(self._writers)

    def match(self, writer: Guid, qos: QosProfile, destination: Destination, first_request: int) -> bool:
        """Begin to receive from a writer. Return False if there are too many writers.

        Args:
            writer: its GUID.
            qos: its quality of service.
            destination: where it receives acknowledgments.
            first_request: base of the acknowledgment that requests a first heartbeat: 0 for Fast DDS, 1 for others.
        """
        if writer in self._writers:
            return True
        if len(self._writers) >= MOST_WRITERS:
            return False
        reliable = qos.reliability == self.qos.reliability == DeliveryReliability.RELIABLE
        start = self._left.pop(writer, None) if reliable else 1
        matched = _MatchedWriter(writer, destination, reliable, first_request, start)
        self._writers[writer] = matched
        if reliable:
            self._request_heartbeat(matched)
        return True

    def unmatch(self, writer: Guid) -> None:
        """Stop receiving from a writer."""
        matched = self._writers.pop(writer, None)
        if matched is None:
            return
        self._discard(matched, 1 << 62)
        if matched.reliable and matched.next is not None and self.qos.durability is Durability.VOLATILE:
            # If the writer did not notice that we lost it, it offers samples again that were already delivered.
            self._left[writer] = matched.next
            if len(self._left) > MOST_LEFT:
                del self._left[next(iter(self._left))]

    def on_data(self, message: Data) -> None:
        """Process a sample."""
        writer = self._writers.get(message.writer)
        if writer is not None and self._is_new(writer, message.sequence):
            self._accept(writer, _received(message.writer, message.sequence, message.payload, message.inline))

    def on_fragment(self, message: DataFragment) -> None:
        """Process a fragment of a sample."""
        writer = self._writers.get(message.writer)
        if writer is None or not self._is_new(writer, message.sequence):
            return
        incomplete = self._incomplete(writer, message)
        if incomplete is None:
            return
        if message.inline:
            incomplete.inline = message.inline
        for at in range(message.count):
            number, start = message.first + at, at * message.fragment_size
            size = min(message.fragment_size, message.size - (number - 1) * message.fragment_size)
            piece = message.payload[start : start + size]
            if size <= 0 or len(piece) < size:
                break
            if number not in incomplete.pieces and self._held.take(size + _OVERHEAD):
                incomplete.pieces[number] = piece
                incomplete.held += size + _OVERHEAD
        if len(incomplete.pieces) == incomplete.total:
            payload = b"".join(incomplete.pieces[number] for number in range(1, incomplete.total + 1))
            self._drop_incomplete(writer, message.sequence)
            self._accept(writer, _received(message.writer, message.sequence, payload, incomplete.inline))

    def on_heartbeat(self, message: Heartbeat) -> None:
        """Process a heartbeat: deliver what waits only for lost samples, and request missing samples."""
        writer = self._writers.get(message.writer)
        if writer is None or not writer.reliable or message.count == writer.heartbeats:
            return
        writer.heartbeats, writer.last = message.count, message.last
        if writer.next is None:
            writer.next = message.first
            self._discard(writer, message.first)
        elif writer.next < message.first:
            self._skip_to(writer, message.first)
        self._deliver(writer)
        self._acknowledge(writer, message.last, answer=not message.final)

    def on_fragment_heartbeat(self, message: HeartbeatFragment) -> None:
        """Process an announcement of fragments: request those that are missing."""
        writer = self._writers.get(message.writer)
        if writer is not None and writer.reliable:
            self._request_fragments(writer, message.sequence, message.last)

    def on_gap(self, message: SampleGap) -> None:
        """Process a gap: do not wait for these samples."""
        writer = self._writers.get(message.writer)
        if writer is None or not writer.reliable or writer.next is None:
            return
        if message.first <= writer.next < message.base:
            self._skip_to(writer, message.base)
        end = min(message.base, writer.next + MOST_EARLY)
        for sequence in (*range(max(message.first, writer.next), end), *message.others):
            if writer.next <= sequence < writer.next + MOST_EARLY:
                self._drop_incomplete(writer, sequence)
                if sequence not in writer.early:
                    self._hold(writer, sequence, None)
        self._deliver(writer)

    def waits_for(self, writer: Guid) -> bool:
        """Return True if something of a writer is missing."""
        matched = self._writers.get(writer)
        return matched is not None and matched.waits

    def tick(self, now_ns: int) -> bool:
        """Request first heartbeats, and what is missing or expected: Fast DDS sends heartbeats only every 3 s.

        Returns:
            False if nothing is missing or expected.
        """
        waiting = self.expects
        for writer in self._writers.values():
            if not (writer.waits or (self.expects and writer.reliable)):
                writer.due_ns, writer.pause_ns = None, _PAUSE_NS
                continue
            waiting = True
            if writer.due_ns is None:
                writer.due_ns = now_ns + writer.pause_ns
            elif now_ns >= writer.due_ns:
                is_stuck = writer.next is not None and writer.next == writer.asked
                writer.pause_ns = min(2 * writer.pause_ns, _LONGEST_PAUSE_NS) if is_stuck else _PAUSE_NS
                self._request(writer)
                writer.asked, writer.due_ns = writer.next, now_ns + writer.pause_ns
        return waiting

    def _is_new(self, writer: _MatchedWriter, sequence: int) -> bool:
        if writer.next is None:
            return sequence not in writer.early
        if not writer.reliable:
            return sequence >= writer.next
        return writer.next <= sequence < writer.next + MOST_EARLY and sequence not in writer.early

    def _accept(self, writer: _MatchedWriter, sample: ReceivedSample) -> None:
        """Deliver a sample, or hold it until the samples before it have come."""
        if not writer.reliable:
            writer.next = sample.sequence + 1
            for sequence in [each for each in writer.incomplete if each <= sample.sequence]:
                self._drop_incomplete(writer, sequence)
            self._on_sample(sample)
        elif sample.sequence == writer.next:
            writer.next += 1
            self._on_sample(sample)
            self._deliver(writer)
        else:
            self._hold(writer, sample.sequence, sample)

    def _hold(self, writer: _MatchedWriter, sequence: int, sample: ReceivedSample | None) -> None:
        if len(writer.early) < MOST_EARLY and self._held.take(_held_size(sample)):
            writer.early[sequence] = sample

    def _release(self, writer: _MatchedWriter, sequence: int) -> ReceivedSample | None:
        sample = writer.early.pop(sequence)
        self._held.free(_held_size(sample))
        return sample

    def _deliver(self, writer: _MatchedWriter) -> None:
        """Deliver held samples whose turn has come."""
        while writer.next in writer.early:
            sample = self._release(writer, writer.next)
            writer.next += 1
            if sample is not None:
                self._on_sample(sample)

    def _skip_to(self, writer: _MatchedWriter, sequence: int) -> None:
        """Deliver all held samples before a number, and continue there."""
        for early in sorted(each for each in writer.early if each < sequence):
            sample = self._release(writer, early)
            if sample is not None:
                self._on_sample(sample)
        self._discard(writer, sequence)
        writer.next = sequence

    def _discard(self, writer: _MatchedWriter, end: int) -> None:
        """Discard held samples and fragments before a number."""
        for sequence in [each for each in writer.early if each < end]:
            self._release(writer, sequence)
        for sequence in [each for each in writer.incomplete if each < end]:
            self._drop_incomplete(writer, sequence)

    def _incomplete(self, writer: _MatchedWriter, message: DataFragment) -> _Incomplete | None:
        """Return the sample of a fragment. None if it is too large, or does not fit earlier fragments."""
        known = writer.incomplete.get(message.sequence)
        if known is not None:
            fits = (known.size, known.fragment_size) == (message.size, message.fragment_size)
            return known if fits else None
        incomplete = _Incomplete(message.size, message.fragment_size, message.inline)
        if message.size > LARGEST_SAMPLE or incomplete.total > MOST_FRAGMENTS:
            return None
        if len(writer.incomplete) >= MOST_INCOMPLETE:
            if writer.reliable:
                return None  # It is requested later.
            self._drop_incomplete(writer, min(writer.incomplete))
        writer.incomplete[message.sequence] = incomplete
        return incomplete

    def _drop_incomplete(self, writer: _MatchedWriter, sequence: int) -> None:
        incomplete = writer.incomplete.pop(sequence, None)
        if incomplete is not None:
            self._held.free(incomplete.held)

    def _acknowledge(self, writer: _MatchedWriter, last: int, *, answer: bool) -> None:
        """Acknowledge all samples before `next`, and request the missing ones up to `last`."""
        writer.due_ns = None
        base = writer.next or 1
        wanted = [each for each in range(base, min(last + 1, base + MOST_BITS)) if each not in writer.early]
        missing = [each for each in wanted if each not in writer.incomplete]
        if not (wanted or answer):
            return
        self._count += 1
        # It is final: Fast DDS delays its next heartbeat by 3 s if it has nothing to send again for one that is not.
        acknowledgment = encode_acknowledgment(self.id, writer.guid[-4:], base, missing, self._count, final=True)
        self._outbox.add(writer.destination, acknowledgment)
        for sequence in wanted:
            self._request_fragments(writer, sequence, MOST_FRAGMENTS)

    def _request_fragments(self, writer: _MatchedWriter, sequence: int, last: int) -> None:
        """Request the missing fragments of a sample in reassembly, up to a number."""
        incomplete = writer.incomplete.get(sequence)
        missing = () if incomplete is None else [each for each in incomplete.missing() if each <= last]
        if missing:
            self._count += 1
            request = encode_fragment_request(self.id, writer.guid[-4:], sequence, missing, self._count)
            self._outbox.add(writer.destination, request)

    def _request(self, writer: _MatchedWriter) -> None:
        """Request a heartbeat, or what was announced, or sent before the newest sample or fragment that has arrived."""
        if writer.next is None or not writer.waits:
            self._request_heartbeat(writer)
            return
        newest = max((*writer.early, *writer.incomplete), default=0)
        self._acknowledge(writer, max(writer.last, newest - 1), answer=False)
        if newest > writer.last and newest in writer.incomplete:
            self._request_fragments(writer, newest, max(writer.incomplete[newest].pieces, default=0))

    def _request_heartbeat(self, writer: _MatchedWriter) -> None:
        self._count += 1
        # Fast DDS answers only an acknowledgment of 0 at once.
        base = writer.anyone and (writer.next or writer.anyone)
        request = encode_acknowledgment(self.id, writer.guid[-4:], base, (), self._count, final=False)
        self._outbox.add(writer.destination, request)


def _received(writer: Guid, sequence: int, payload: bytes, inline: Sequence[Parameter]) -> ReceivedSample:
    return ReceivedSample(writer, sequence, payload, inline, is_disposed(inline))


def _held_size(sample: ReceivedSample | None) -> int:
    return _OVERHEAD + (0 if sample is None else len(sample.payload))
