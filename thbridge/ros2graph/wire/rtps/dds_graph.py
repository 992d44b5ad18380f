"""Our nodes on a DDS domain, and those of others: ROS 2 above RTPS."""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from thbridge.ros2.qos import LATCHED, SERVICES, QosProfile
from thbridge.ros2.supports import MessageSupport, ServiceSupport
from thbridge.ros2graph.values.graph import GraphEndpoint, NodeName
from thbridge.ros2graph.wire.rtps import ros_names
from thbridge.ros2graph.wire.rtps.correlation import (
    client_key,
    header_of,
    insert_header,
    related,
    related_request,
    sequence_of,
    split_header,
)
from thbridge.ros2graph.wire.rtps.entities_info import NodeEntities, decode_entities, encode_entities
from thbridge.ros2graph.wire.rtps.guids import PREFIX_SIZE, Guid
from thbridge.ros2graph.wire.rtps.participant import RtpsParticipant
from thbridge.ros2graph.wire.rtps.readers import ReceivedSample, RtpsReader
from thbridge.ros2graph.wire.rtps.submessages import CYCLONE_VENDOR
from thbridge.ros2graph.wire.rtps.writers import RtpsWriter

MOST_CALLS = 1024
"""Maximum number of calls of a client that wait for their response. Older calls get none."""
MOST_HELD = 64
"""Maximum number of responses of a server that wait until their client's reader is known."""
LARGEST_LIST = 1 << 20
"""Maximum number of bytes of the list of a participant's nodes."""
_SERVICE_TYPE_END = "_Request"


@dataclass(slots=True)
class _Entities:
    """Endpoints of one of our nodes."""

    readers: list[Guid] = field(default_factory=list)
    writers: list[Guid] = field(default_factory=list)


class DdsGraph:
    """Our nodes and endpoints, and those of other participants.

    Args:
        participant: our participant.
        stamp: returns nanoseconds since 1970.
        wake: called when there is something to send.
        warn: called with the fault of an invalid message.
    """

    def __init__(
        self,
        participant: RtpsParticipant,
        stamp: Callable[[], int],
        wake: Callable[[], None],
        warn: Callable[[str], None],
    ) -> None:
        self.participant = participant
        self.stamp = stamp
        self._wake = wake
        self._warn = warn
        self._own: dict[NodeName, _Entities] = {}
        self._others: dict[bytes, list[NodeEntities]] = {}
        self._node_of: dict[bytes, dict[Guid, NodeName]] = {}
        self._found: list[GraphEndpoint] | None = None
        self._servers: list[DdsServer] = []
        self._is_stale = True
        self._has_changed = False
        self._informed: tuple[int, set[Guid]] = (0, set())
        participant.on_change = self._on_change
        user_data = ros_names.hash_data(ros_names.DISCOVERY_HASH)
        topic = (ros_names.DISCOVERY_TOPIC, ros_names.DISCOVERY_TYPE)
        self._info = participant.add_writer(*topic, LATCHED, user_data, stamp())
        participant.add_reader(*topic, LATCHED, user_data, self._on_info, stamp())

    def add_node(self, node: NodeName) -> None:
        """Announce a node."""
        if node not in self._own:
            self._own[node] = _Entities()
            self._changed()

    def publish(self, node: NodeName, topic: str, support: MessageSupport, qos: QosProfile) -> "DdsWriter":
        """Announce a publisher."""
        return DdsWriter(self, self.writer(node, ros_names.topic_name(topic), support, qos))

    def subscribe(
        self,
        node: NodeName,
        topic: str,
        support: MessageSupport,
        qos: QosProfile,
        on_message: Callable[[bytes, bytes], None],
    ) -> None:
        """Announce a subscription."""

        def deliver(sample: ReceivedSample) -> None:
            if sample.payload and not sample.disposed:
                on_message(sample.payload, sample.writer)

        self.reader(node, ros_names.topic_name(topic), support, qos, deliver)

    def serve(
        self,
        node: NodeName,
        service: str,
        support: ServiceSupport,
        on_request: Callable[[bytes, bytes, Callable[[bytes], None]], None],
    ) -> None:
        """Announce a server of a service."""
        self._servers.append(DdsServer(self, node, service, support, on_request))

    def client(self, node: NodeName, service: str, support: ServiceSupport) -> "DdsClient":
        """Announce a client of a service."""
        return DdsClient(self, node, service, support)

    def nodes(self) -> list[NodeName]:
        """Return the nodes of other participants, in order of their names."""
        found = {each.node for nodes in self._others.values() for each in nodes}
        return sorted(found, key=lambda node: node.whole)

    def endpoints(self) -> Sequence[GraphEndpoint]:
        """Return the endpoints of the nodes of other participants. The list is made again only after a change."""
        if self._found is None:
            self._found = list(self._find_endpoints())
        return self._found

    def _find_endpoints(self) -> Iterator[GraphEndpoint]:
        for data in self.participant.endpoints():
            role = ros_names.role_and_name(data.topic, is_writer=data.is_writer)
            type_name = ros_names.type_of(data.type)
            if role is not None and type_name is not None:
                if data.topic.startswith("rq"):
                    type_name = type_name.removesuffix(_SERVICE_TYPE_END)
                node = self._node(data.guid)
                type_hash = ros_names.hash_of(data.user_data)
                yield GraphEndpoint(role[0], node, role[1], type_name, type_hash, data.qos, data.guid)

    def node_of(self, gid: Guid) -> str:
        """Return the full name of the node of an endpoint; the GUID as hexadecimal digits if the node is unknown."""
        node = self._node(gid)
        return gid.hex() if node is None else node.whole

    def tick(self, now_ns: int) -> None:
        """Repeat what was not acknowledged, and announce changes of our nodes."""
        self.participant.tick(now_ns)
        # Fast DDS forgets the nodes of a participant that it lost for some time, and does not read an old list again.
        informed = self._info.returned, set(self._info.readers)
        if informed[0] > self._informed[0] or informed[1] - self._informed[1]:
            self._is_stale = True
        self._informed = informed
        self.flush()

    def flush(self) -> None:
        """Announce changes of our nodes, and process those of others. This is done once for many changes."""
        if self._has_changed:
            self._has_changed = False
            self._follow_others()
        if self._is_stale:
            self._is_stale = False
            nodes = [NodeEntities(node, each.readers, each.writers) for node, each in self._own.items()]
            message = encode_entities(self.participant.guid, nodes)
            self.participant.write(self._info, message, self.stamp())

    def _on_change(self) -> None:
        """Note a change of other participants or their endpoints."""
        self._has_changed, self._found = True, None

    def _follow_others(self) -> None:
        for prefix in [each for each in self._others if not self.participant.has_peer(each)]:
            del self._others[prefix], self._node_of[prefix]
        for server in self._servers:
            server.send_held()

    def writer(self, node: NodeName, topic: str, support: MessageSupport, qos: QosProfile) -> RtpsWriter:
        """Announce a writer of one of our nodes."""
        self.add_node(node)
        user_data = ros_names.hash_data(support.hash)
        writer = self.participant.add_writer(topic, support.dds_name, qos, user_data, self.stamp())
        self._own[node].writers.append(writer.guid)
        self._changed()
        return writer

    def reader(
        self,
        node: NodeName,
        topic: str,
        support: MessageSupport,
        qos: QosProfile,
        on_sample: Callable[[ReceivedSample], None],
    ) -> RtpsReader:
        """Announce a reader of one of our nodes."""
        self.add_node(node)
        user_data = ros_names.hash_data(support.hash)
        reader = self.participant.add_reader(topic, support.dds_name, qos, user_data, on_sample, self.stamp())
        self._own[node].readers.append(reader.guid)
        self._changed()
        return reader

    def remove(self, node: NodeName, writer: RtpsWriter, reader: RtpsReader) -> None:
        """Remove endpoints of one of our nodes."""
        self.participant.remove(writer, self.stamp())
        self.participant.remove(reader, self.stamp())
        self._own[node].writers.remove(writer.guid)
        self._own[node].readers.remove(reader.guid)
        self._changed()

    def write(
        self, writer: RtpsWriter, message: bytes, inline: bytes = b"", only: frozenset[bytes] | None = None
    ) -> int:
        """Send a message. See `RtpsWriter.write`."""
        sequence = self.participant.write(writer, message, self.stamp(), inline, only)
        self._wake()
        return sequence

    def uses_header(self, guid: Guid) -> bool:
        """Return True if the participant of an endpoint correlates requests in the style of rmw_cyclonedds."""
        return self.participant.vendor_of(guid) == CYCLONE_VENDOR

    def warn(self, fault: str) -> None:
        """Report an invalid message."""
        self._warn(fault)

    def _changed(self) -> None:
        self._is_stale = True
        self._wake()

    def _on_info(self, sample: ReceivedSample) -> None:
        if sample.disposed or not sample.payload:
            return
        if len(sample.payload) > LARGEST_LIST:
            self.warn("a participant's list of nodes is too long")
            return
        prefix = sample.writer[:PREFIX_SIZE]
        try:
            nodes = decode_entities(sample.payload)
        except ValueError as fault:
            self.warn(str(fault))
            return
        self._found = None
        self._others[prefix] = nodes
        self._node_of[prefix] = {gid: each.node for each in nodes for gid in (*each.readers, *each.writers)}

    def _node(self, gid: Guid) -> NodeName | None:
        """Return the node of an endpoint. Only its own participant can say it."""
        return self._node_of.get(gid[:PREFIX_SIZE], {}).get(gid)


class DdsWriter:
    """Publisher on DDS."""

    def __init__(self, graph: DdsGraph, writer: RtpsWriter) -> None:
        self._graph = graph
        self._writer = writer

    @property
    def readers(self) -> int:
        """Number of matched subscriptions of other programs."""
        return len(self._writer.readers)

    def write(self, message: bytes) -> None:
        """Send a message to all matched subscriptions."""
        self._graph.write(self._writer, message)


@dataclass(slots=True)
class _Response:
    """Response that waits until the reader of its client is known.

    Attributes:
        writer: GUID of the client's writer.
        reader: GUID of the client's reader; empty if any reader of its participant serves.
        message: the response.
        inline: its inline quality of service.
    """

    writer: Guid
    reader: Guid
    message: bytes
    inline: bytes


class DdsServer:
    """Server of a service on DDS."""

    def __init__(
        self,
        graph: DdsGraph,
        node: NodeName,
        service: str,
        support: ServiceSupport,
        on_request: Callable[[bytes, bytes, Callable[[bytes], None]], None],
    ) -> None:
        self._graph = graph
        self._on_request = on_request
        self._held: deque[_Response] = deque(maxlen=MOST_HELD)
        response = ros_names.response_topic(service)
        self._writer = graph.writer(node, response, support.response, SERVICES)
        graph.reader(node, ros_names.request_topic(service), support.request, SERVICES, self._on_sample)

    def send_held(self) -> None:
        """Send the responses whose client can receive them, and drop those whose client is gone."""
        for response in list(self._held):
            if self._can_receive(response):
                self._held.remove(response)
                self._send(response)
            elif self._graph.participant.endpoint(response.writer) is None:
                self._held.remove(response)

    def _on_sample(self, sample: ReceivedSample) -> None:
        if sample.disposed or not sample.payload:
            return
        message, header = sample.payload, b""
        client, sequence = b"", sample.sequence
        if self._graph.uses_header(sample.writer):
            try:
                header, message = split_header(message)
            except ValueError as fault:
                self._graph.warn(str(fault))
                return
        else:
            request = related_request(sample.inline)
            client = b"" if request is None else request[0]

        def reply(response: bytes) -> None:
            if header:
                waiting = _Response(sample.writer, b"", insert_header(response, header), b"")
            else:
                waiting = _Response(sample.writer, client, response, related(client or sample.writer, sequence))
            if self._can_receive(waiting):
                self._send(waiting)
            else:
                self._held.append(waiting)

        self._on_request(message, sample.writer, reply)

    def _can_receive(self, response: _Response) -> bool:
        readers = self._writer.readers
        if response.reader:
            return response.reader in readers
        return any(each.startswith(response.writer[:PREFIX_SIZE]) for each in readers)

    def _send(self, response: _Response) -> None:
        self._graph.write(self._writer, response.message, response.inline, frozenset({response.writer[:PREFIX_SIZE]}))


@dataclass(slots=True)
class _Call:
    """Call that waits for its response, and the numbers of its requests: one for each style of correlation."""

    on_response: Callable[[bytes], None]
    sequences: Sequence[int] = ()


class DdsClient:
    """Client of a service on DDS."""

    def __init__(self, graph: DdsGraph, node: NodeName, service: str, support: ServiceSupport) -> None:
        self._graph = graph
        self._node = node
        self._calls: dict[int, _Call] = {}
        self._is_closed = False
        response = ros_names.response_topic(service)
        self._reader = graph.reader(node, response, support.response, SERVICES, self._on_sample)
        self._writer = graph.writer(node, ros_names.request_topic(service), support.request, SERVICES)
        self._key = client_key(self._writer.guid)

    @property
    def has_server(self) -> bool:
        """True if a server is known that can receive a request and send a response."""
        return bool(self._servers())

    def call(self, request: bytes, on_response: Callable[[bytes], None]) -> None:
        """Send a request. The callback gets the first response."""
        if self._is_closed:
            return
        servers = self._servers()
        with_header = frozenset(each for each in servers if self._graph.uses_header(each))
        without = frozenset(servers) - with_header
        call = _Call(on_response)
        sequences = []
        if with_header:
            message = insert_header(request, header_of(self._key, self._writer.next))
            sequences.append(self._graph.write(self._writer, message, b"", with_header))
        if without:
            inline = related(self._reader.guid)
            sequences.append(self._graph.write(self._writer, request, inline, without))
        call.sequences = sequences
        for sequence in sequences:
            self._calls[sequence] = call
        while len(self._calls) > MOST_CALLS:
            del self._calls[next(iter(self._calls))]
        self._graph.participant.expect(self._reader, expects=bool(self._calls))

    def close(self) -> None:
        """Leave the graph. No further response is delivered."""
        if not self._is_closed:
            self._is_closed = True
            self._calls.clear()
            self._graph.remove(self._node, self._writer, self._reader)

    def _servers(self) -> set[bytes]:
        """Return the prefixes of participants whose server is matched in both directions.

        Servers drop the response if they do not know the client's reader, so they must have confirmed that they do.
        """
        receivers = {each[:PREFIX_SIZE] for each in self._writer.readers}
        senders = {each[:PREFIX_SIZE] for each in self._reader.writers}
        knows = self._graph.participant.is_known_to
        return {each for each in receivers & senders if knows(each, self._reader) and knows(each, self._writer)}

    def _on_sample(self, sample: ReceivedSample) -> None:
        if sample.disposed or not sample.payload:
            return
        message = sample.payload
        if self._graph.uses_header(sample.writer):
            try:
                header, message = split_header(message)
            except ValueError as fault:
                self._graph.warn(str(fault))
                return
            sequence = sequence_of(header) if header.startswith(self._key) else None
        else:
            request = related_request(sample.inline)
            is_ours = request is not None and request[0] in {self._reader.guid, self._writer.guid}
            sequence = request[1] if request is not None and is_ours else None
        call = None if sequence is None else self._calls.get(sequence)
        if call is not None:
            for each in call.sequences:
                self._calls.pop(each, None)
            self._graph.participant.expect(self._reader, expects=bool(self._calls))
            call.on_response(message)
