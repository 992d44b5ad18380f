"""Participant of a DDS domain: finds other participants, matches endpoints, and hands submessages to them.

The caller passes datagrams and times, and sends what `Outbox.drain` returns. All times are nanoseconds: `now_ns` of a
monotonic clock, `stamp_ns` since 1970.

Source: DDSI-RTPS 2.3, section 8.5 (discovery).
"""

from collections import defaultdict, deque
from collections.abc import Callable, Iterator, Sequence, Set
from dataclasses import dataclass, field
from itertools import islice
from typing import TypeAlias

from thbridge.ros2.qos import Durability, QosProfile
from thbridge.ros2graph.wire.rtps import guids
from thbridge.ros2graph.wire.rtps.discovery import (
    LEASE_NS,
    EndpointData,
    ParticipantData,
    disposal,
    disposed_guid,
    is_disposed,
)
from thbridge.ros2graph.wire.rtps.guids import PREFIX_SIZE, Guid
from thbridge.ros2graph.wire.rtps.outbox import Destination, Outbox, Outgoing
from thbridge.ros2graph.wire.rtps.parameters import UdpAddress
from thbridge.ros2graph.wire.rtps.postponed import PostponedMessage, PostponedMessages
from thbridge.ros2graph.wire.rtps.readers import HeldBytes, OnSample, ReceivedSample, RtpsReader
from thbridge.ros2graph.wire.rtps.submessages import (
    EPROSIMA_VENDOR,
    VENDOR,
    Acknowledgment,
    Data,
    DataFragment,
    FragmentRequest,
    Heartbeat,
    HeartbeatFragment,
    SampleGap,
    Submessage,
    decode_datagram,
    encode_data,
)
from thbridge.ros2graph.wire.rtps.writers import RtpsWriter

MOST_PEERS = 128
"""Maximum number of other participants."""
MOST_ENDPOINTS = 16_384
"""Maximum number of endpoints of all other participants."""
MOST_PEER_ENDPOINTS = MOST_ENDPOINTS // 2
"""Maximum number of endpoints of one participant."""
LONGEST_LEASE_NS = 300_000_000_000
"""Maximum time without announcement after which a participant counts as gone, even if it wants a longer time."""
GOODBYE_NS = 500_000_000
"""Time without a sign of life after which a participant that has said goodbye counts as gone."""
MOST_SUBMESSAGES = 512
"""Maximum number of submessages of a datagram. Further ones are dropped, as if their datagram was lost."""
MOST_DISPOSALS = 256
"""Number of our last disposals that are kept for slow peers."""
TICK_NS = 25_000_000
"""Recommended time between two ticks."""

_ANNOUNCEMENT_NS = 1_000_000_000
_FIRST_ANNOUNCEMENTS = 5
_FIRST_ANNOUNCEMENT_NS = 100_000_000
_USER_DATA = b"enclave=/;"
_ANNOUNCED = QosProfile(durability=Durability.TRANSIENT_LOCAL)

Reach: TypeAlias = Callable[[Sequence[UdpAddress], str], UdpAddress | None]
"""Function that selects one of a participant's addresses. Its second argument is the host that sent the announcement.
None if no address can be reached."""


@dataclass(slots=True)
class _Peer:
    """Other participant, and its endpoints."""

    data: ParticipantData
    source: str
    metatraffic: Destination
    default: Destination
    expires_ns: int
    endpoints: dict[Guid, EndpointData] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _Own:
    """Own endpoint with its announcement. `announced` is the number of the sample that announces it."""

    endpoint: RtpsWriter | RtpsReader
    data: EndpointData
    announced: int


class RtpsParticipant:
    """Our participant. It calls `on_change` after other participants or endpoints have come or gone.

    Args:
        prefix: 12 bytes, unique among all participants.
        reach: selects addresses of other participants.
        datagram_size: maximum number of bytes of a datagram.
    """

    def __init__(
        self,
        prefix: bytes,
        reach: Reach,
        datagram_size: int,
    ) -> None:
        self.prefix = prefix
        self.guid = prefix + guids.PARTICIPANT
        self.outbox = Outbox(datagram_size)
        self.on_change: Callable[[], None] = lambda: None
        self.held = HeldBytes()
        self._fragment_size = datagram_size - 200
        self._reach = reach
        self._announcement = b""
        self._initial: list[Destination] = []
        self._announcements = 0
        self._fault: str | None = None
        self._postponed = PostponedMessages()
        self._stamp_ns = 0
        self._due_ns: int | None = None
        self._peers: dict[bytes, _Peer] = {}
        self._known = 0
        self._by_topic: dict[str, dict[Guid, EndpointData]] = defaultdict(dict)
        self._numbers = 0
        self._own: dict[bytes, _Own] = {}
        self._own_by_topic: dict[str, list[_Own]] = defaultdict(list)
        self._writers: dict[bytes, RtpsWriter] = {}
        self._readers: dict[bytes, RtpsReader] = {}
        self._readers_of: dict[Guid, list[RtpsReader]] = defaultdict(list)
        self._busy: dict[RtpsWriter | RtpsReader, None] = {}
        self._publications = self._announcer(guids.PUBLICATIONS_WRITER)
        self._subscriptions = self._announcer(guids.SUBSCRIPTIONS_WRITER)
        self._disposals: deque[tuple[RtpsWriter, int]] = deque()
        for each in (guids.PUBLICATIONS_READER, guids.SUBSCRIPTIONS_READER):
            self._readers[each] = RtpsReader(prefix + each, _ANNOUNCED, self.outbox, self.held, self._on_announcement)

    def start(self, metatraffic: UdpAddress, default: UdpAddress, initial: Sequence[UdpAddress]) -> None:
        """Begin to announce ourselves at the next tick.

        Args:
            metatraffic: our address for discovery.
            default: our address for messages.
            initial: addresses of possible participants, which get announcements.
        """
        data = ParticipantData(self.guid, VENDOR, [metatraffic], [default], LEASE_NS, _USER_DATA)
        self._announcement = encode_data(guids.SPDP_WRITER, 1, data.encode(), 0)
        self._initial = [Destination(each, self.prefix) for each in initial if each != metatraffic]

    def add_writer(self, topic: str, type_name: str, qos: QosProfile, user_data: bytes, stamp_ns: int) -> RtpsWriter:
        """Announce a writer of a topic."""
        self._numbers += 1
        guid = self.prefix + guids.writer_id(self._numbers)
        writer = RtpsWriter(guid, qos, self.outbox, self._fragment_size)
        self._writers[writer.id] = writer
        self._add(writer, EndpointData(guid, topic, type_name, qos, user_data), stamp_ns)
        return writer

    def add_reader(
        self, topic: str, type_name: str, qos: QosProfile, user_data: bytes, on_sample: OnSample, stamp_ns: int
    ) -> RtpsReader:
        """Announce a reader of a topic."""
        self._numbers += 1
        guid = self.prefix + guids.reader_id(self._numbers)
        reader = RtpsReader(guid, qos, self.outbox, self.held, on_sample)
        self._readers[reader.id] = reader
        self._add(reader, EndpointData(guid, topic, type_name, qos, user_data), stamp_ns)
        return reader

    def remove(self, endpoint: RtpsWriter | RtpsReader, stamp_ns: int) -> None:
        """Remove an endpoint, and announce it."""
        own = self._own.pop(endpoint.id, None)
        if own is None:
            return
        self._own_by_topic[own.data.topic].remove(own)
        for guid in endpoint.writers if isinstance(endpoint, RtpsReader) else ():
            self._unmatch(own, guid)
        self._writers.pop(endpoint.id, None)
        self._readers.pop(endpoint.id, None)
        self._busy.pop(endpoint, None)
        announcer = self._announcer_of(own.data)
        announcer.forget(own.announced)
        inline, key = disposal(own.data.guid)
        self._disposals.append((announcer, announcer.write(key, stamp_ns, inline, key=True)))
        self._busy[announcer] = None
        if len(self._disposals) > MOST_DISPOSALS:
            announcer, oldest = self._disposals.popleft()
            announcer.forget(oldest)

    def write(
        self,
        writer: RtpsWriter,
        payload: bytes,
        stamp_ns: int,
        inline: bytes = b"",
        only: Set[bytes] | None = None,
    ) -> int:
        """Send a message. See `RtpsWriter.write`."""
        self._busy[writer] = None
        return writer.write(payload, stamp_ns, inline, only=only)

    def expect(self, reader: RtpsReader, *, expects: bool) -> None:
        """Ask a reader's writers from time to time if they have sent something, or cease to do so."""
        reader.expects = expects
        self._busy[reader] = None

    def leave(self) -> None:
        """Announce that we leave."""
        inline, key = disposal(self.guid)
        goodbye = encode_data(guids.SPDP_WRITER, 2, key, 0, inline, key=True)
        for destination in (*(each.metatraffic for each in self._peers.values()), *self._initial):
            self.outbox.add(destination, goodbye)

    def receive(self, datagram: bytes, source: str, now_ns: int, stamp_ns: int) -> str | None:
        """Process a datagram. Return the fault if it is invalid.

        Args:
            datagram: received bytes.
            source: host that sent them.
            now_ns: monotonic time, nanoseconds.
            stamp_ns: nanoseconds since 1970.
        """
        self._fault = None
        self._stamp_ns = stamp_ns
        try:
            _, prefix, submessages = decode_datagram(datagram, self.prefix)
            if prefix == self.prefix:
                return None
            peer = self._peers.get(prefix)
            if peer is not None:
                peer.expires_ns = now_ns + _lease_ns(peer.data)
            for each in islice(submessages, MOST_SUBMESSAGES):
                self._process(each, source, now_ns)
        except ValueError as fault:
            self._fault = str(fault)
        return self._fault

    def tick(self, now_ns: int) -> None:
        """Announce ourselves, repeat what was not acknowledged, and forget participants that are silent."""
        self.outbox.renew()
        if self._due_ns is None or now_ns >= self._due_ns:
            self._announcements += 1
            first = self._announcements <= _FIRST_ANNOUNCEMENTS
            self._due_ns = now_ns + (_FIRST_ANNOUNCEMENT_NS if first else _ANNOUNCEMENT_NS)
            known = {each.metatraffic.address for each in self._peers.values()}
            for destination in (
                *(each.metatraffic for each in self._peers.values()),
                *(each for each in self._initial if each.address not in known),
            ):
                self._announce(destination)
            for prefix, peer in self._peers.items():
                # Cyclone DDS announces itself only once before its lease ends. One that has said goodbye is not asked.
                if GOODBYE_NS < peer.expires_ns - now_ns < _lease_ns(peer.data) / 2:
                    self._publications.ask(prefix + guids.PUBLICATIONS_READER)
        for endpoint in list(self._busy):
            if not endpoint.tick(now_ns):
                self._busy.pop(endpoint, None)
        for prefix in [each for each, peer in self._peers.items() if now_ns > peer.expires_ns]:
            self._lose(prefix)

    def drain(self) -> list[Outgoing]:
        """Answer heartbeats and requests, and return the datagrams that are to be sent."""
        for message in self._postponed.take():
            self._answer(message)
        return self.outbox.drain()

    def is_known_to(self, prefix: bytes, endpoint: RtpsWriter | RtpsReader) -> bool:
        """Return True if another participant has confirmed that it knows one of our endpoints."""
        own = self._own.get(endpoint.id)
        if own is None:
            return False
        reader = guids.PUBLICATIONS_READER if own.data.is_writer else guids.SUBSCRIPTIONS_READER
        return self._announcer_of(own.data).has_acknowledged(prefix + reader, own.announced)

    def vendor_of(self, guid: Guid) -> bytes:
        """Return the vendor of an endpoint's participant; empty if it is unknown."""
        peer = self._peers.get(guid[:PREFIX_SIZE])
        return b"" if peer is None else peer.data.vendor

    def endpoint(self, guid: Guid) -> EndpointData | None:
        """Return an endpoint of another participant."""
        peer = self._peers.get(guid[:PREFIX_SIZE])
        return None if peer is None else peer.endpoints.get(guid)

    def endpoints(self) -> Iterator[EndpointData]:
        """Yield the endpoints of other participants."""
        for peer in self._peers.values():
            yield from peer.endpoints.values()

    def has_peer(self, prefix: bytes) -> bool:
        """Return True if a participant is known."""
        return prefix in self._peers

    def _announcer(self, entity: bytes) -> RtpsWriter:
        writer = RtpsWriter(self.prefix + entity, _ANNOUNCED, self.outbox, self._fragment_size, keep_all=True)
        self._writers[entity] = writer
        return writer

    def _announcer_of(self, data: EndpointData) -> RtpsWriter:
        return self._publications if data.is_writer else self._subscriptions

    def _announce(self, destination: Destination) -> None:
        self.outbox.add(destination, self._announcement)

    def _add(self, endpoint: RtpsWriter | RtpsReader, data: EndpointData, stamp_ns: int) -> None:
        announcer = self._announcer_of(data)
        own = _Own(endpoint, data, announcer.write(data.encode(), stamp_ns))
        self._busy[announcer] = None
        self._own[endpoint.id] = own
        self._own_by_topic[data.topic].append(own)
        for other in list(self._by_topic[data.topic].values()):
            self._match(own, other)

    def _process(self, message: Submessage, source: str, now_ns: int) -> None:
        if isinstance(message, Acknowledgment | FragmentRequest):
            writer = self._writers.get(message.writer)
            if writer is not None and writer.knows(message.reader):
                self._postponed.add(message)
            return
        if message.writer[PREFIX_SIZE:] == guids.SPDP_WRITER:
            if isinstance(message, Data):
                self._on_participant(message, source, now_ns)
            return
        if isinstance(message, Heartbeat | HeartbeatFragment):
            if message.writer in self._readers_of:
                self._postponed.add(message)
            return
        for reader in self._receivers(message.writer, message.reader):
            match message:
                case Data():
                    reader.on_data(message)
                case DataFragment():
                    reader.on_fragment(message)
                case SampleGap():
                    reader.on_gap(message)
            if reader.waits_for(message.writer):
                self._busy[reader] = None

    def _answer(self, message: PostponedMessage) -> None:
        match message:
            case Acknowledgment() | FragmentRequest():
                writer = self._writers.get(message.writer)
                if writer is None:
                    return
                self._busy[writer] = None
                if isinstance(message, Acknowledgment):
                    writer.on_acknowledgment(message, self._stamp_ns)
                else:
                    writer.on_fragment_request(message, self._stamp_ns)
            case Heartbeat():
                for reader in self._receivers(message.writer, message.reader):
                    reader.on_heartbeat(message)
            case HeartbeatFragment():
                for reader in self._receivers(message.writer, message.reader):
                    reader.on_fragment_heartbeat(message)

    def _receivers(self, writer: Guid, reader: bytes) -> list[RtpsReader]:
        """Return our readers that a submessage of a writer is for."""
        return [each for each in self._readers_of.get(writer, ()) if reader in {guids.UNKNOWN, each.id}]

    def _on_participant(self, message: Data, source: str, now_ns: int) -> None:
        if is_disposed(message.inline):
            peer = self._peers.get(message.writer[:PREFIX_SIZE])
            if peer is not None and disposed_guid(message.inline, message.payload) == peer.data.guid:
                # Anybody can send a goodbye in its name. If it is alive, it stays.
                peer.expires_ns = now_ns + GOODBYE_NS
            return
        data = ParticipantData.decode(message.payload)
        prefix = data.guid[:PREFIX_SIZE]
        expires_ns = now_ns + _lease_ns(data)
        known = self._peers.get(prefix)
        if known is not None:
            known.expires_ns = expires_ns
            return
        if prefix != message.writer[:PREFIX_SIZE] or prefix == self.prefix:
            return
        metatraffic = self._reach(data.metatraffic, source)
        default = self._reach(data.default, source)
        if metatraffic is None or default is None:
            raise ValueError("a participant has no address that can be reached")
        if len(self._peers) >= MOST_PEERS:
            silent = next((known for known, each in self._peers.items() if not each.endpoints), None)
            if silent is None:
                raise ValueError(f"there are more than {MOST_PEERS} participants")
            self._lose(silent)
        peer = _Peer(
            data,
            source,
            Destination(metatraffic, self.prefix, prefix),
            Destination(default, self.prefix, prefix),
            expires_ns,
        )
        self._peers[prefix] = peer
        # The peer may not know us yet, and drops what participants send that it does not know.
        self._announce(peer.metatraffic)
        first_request = _first_request(data.vendor)
        for writer, reader in (
            (guids.PUBLICATIONS_WRITER, guids.PUBLICATIONS_READER),
            (guids.SUBSCRIPTIONS_WRITER, guids.SUBSCRIPTIONS_READER),
        ):
            self._writers[writer].match(prefix + reader, _ANNOUNCED, peer.metatraffic)
            self._readers[reader].match(prefix + writer, _ANNOUNCED, peer.metatraffic, first_request)
            self._readers_of[prefix + writer].append(self._readers[reader])
            self._busy[self._writers[writer]] = None
            self._busy[self._readers[reader]] = None
        self.on_change()

    def _lose(self, prefix: bytes) -> None:
        peer = self._peers.pop(prefix, None)
        if peer is None:
            return
        for data in peer.endpoints.values():
            self._forget_endpoint(data)
        for writer, reader in (
            (guids.PUBLICATIONS_WRITER, guids.PUBLICATIONS_READER),
            (guids.SUBSCRIPTIONS_WRITER, guids.SUBSCRIPTIONS_READER),
        ):
            self._writers[writer].unmatch(prefix + reader)
            self._readers[reader].unmatch(prefix + writer)
            self._readers_of.pop(prefix + writer, None)
        self.on_change()

    def _on_announcement(self, sample: ReceivedSample) -> None:
        """Process an announcement of an endpoint. If it is invalid, those after it are still processed."""
        try:
            self._on_endpoint(sample)
        except ValueError as fault:
            self._fault = str(fault)

    def _on_endpoint(self, sample: ReceivedSample) -> None:
        peer = self._peers.get(sample.writer[:PREFIX_SIZE])
        if peer is None:
            return
        if sample.disposed:
            gone = peer.endpoints.pop(disposed_guid(sample.inline, sample.payload), None)
            if gone is not None:
                self._forget_endpoint(gone)
                self.on_change()
            return
        data = EndpointData.decode(sample.payload)
        if peer.endpoints.get(data.guid) == data:
            return
        if data.prefix != sample.writer[:PREFIX_SIZE]:
            raise ValueError("a participant announced an endpoint of another participant")
        if data.guid in peer.endpoints:
            self._forget_endpoint(peer.endpoints.pop(data.guid))
        if self._known >= MOST_ENDPOINTS:
            raise ValueError(f"there are more than {MOST_ENDPOINTS} endpoints")
        if len(peer.endpoints) >= MOST_PEER_ENDPOINTS:
            raise ValueError(f"a participant has more than {MOST_PEER_ENDPOINTS} endpoints")
        self._known += 1
        peer.endpoints[data.guid] = data
        self._by_topic[data.topic][data.guid] = data
        for own in self._own_by_topic.get(data.topic, ()):
            self._match(own, data)
        self.on_change()

    def _forget_endpoint(self, data: EndpointData) -> None:
        self._known -= 1
        others = self._by_topic[data.topic]
        others.pop(data.guid, None)
        if not others:
            del self._by_topic[data.topic]
        for own in self._own_by_topic.get(data.topic, ()):
            self._unmatch(own, data.guid)

    def _match(self, own: _Own, other: EndpointData) -> None:
        """Connect an own endpoint and one of another participant if topic, type and quality of service fit."""
        endpoint, peer = own.endpoint, self._peers[other.prefix]
        if own.data.is_writer == other.is_writer or own.data.type != other.type:
            return
        destination = peer.default
        if other.addresses:
            address = self._reach(other.addresses, peer.source)
            if address is not None and address != destination.address:
                destination = Destination(address, self.prefix, other.prefix)
        if isinstance(endpoint, RtpsWriter):
            if endpoint.qos.satisfies(other.qos):
                endpoint.match(other.guid, other.qos, destination)
                self._busy[endpoint] = None
        elif other.qos.satisfies(endpoint.qos) and endpoint.match(
            other.guid, other.qos, destination, _first_request(peer.data.vendor)
        ):
            self._readers_of[other.guid].append(endpoint)
            self._busy[endpoint] = None

    def _unmatch(self, own: _Own, guid: Guid) -> None:
        own.endpoint.unmatch(guid)
        readers = self._readers_of.get(guid)
        if readers is not None and isinstance(own.endpoint, RtpsReader) and own.endpoint in readers:
            readers.remove(own.endpoint)
            if not readers:
                del self._readers_of[guid]


def _lease_ns(data: ParticipantData) -> int:
    return LONGEST_LEASE_NS if data.lease_ns is None else min(data.lease_ns, LONGEST_LEASE_NS)


def _first_request(vendor: bytes) -> int:
    """Return the base of the acknowledgment that requests a first heartbeat."""
    return 0 if vendor == EPROSIMA_VENDOR else 1
