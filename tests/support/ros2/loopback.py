"""ROS 2 graph in memory: programs whose messages arrive when `LoopbackGraph.deliver` is called."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from thbridge.ros2.qos import Durability, QosProfile
from thbridge.ros2.supports import MessageSupport, ServiceSupport
from thbridge.ros2graph.sockets.carrier import GraphClient, GraphWriter, OnMessage, OnRequest
from thbridge.ros2graph.values.graph import EndpointRole, GraphEndpoint, NodeName
from thbridge.sockets.errors import CannotListen, CannotReach


@dataclass(eq=False)
class _Reader:
    program: "LoopbackCarrier"
    topic: str
    qos: QosProfile
    on_message: OnMessage


@dataclass(eq=False)
class LoopbackWriter:
    graph: "LoopbackGraph"
    program: "LoopbackCarrier"
    topic: str
    qos: QosProfile
    gid: bytes
    kept: list[bytes] = field(default_factory=list)

    def matched(self) -> list[_Reader]:
        return [
            reader
            for reader in self.graph.readers
            if reader.topic == self.topic and reader.program is not self.program and self.qos.satisfies(reader.qos)
        ]

    @property
    def readers(self) -> int:
        return len(self.matched())

    def write(self, message: bytes) -> None:
        self.kept = [*self.kept, message][-self.qos.depth :]
        for reader in self.matched():
            self.send(reader, message)

    def send(self, reader: _Reader, message: bytes) -> None:
        self.graph.pending.append(lambda: reader.on_message(message, self.gid))


@dataclass(eq=False)
class LoopbackClient:
    graph: "LoopbackGraph"
    service: str
    gid: bytes
    closed: bool = False

    @property
    def has_server(self) -> bool:
        return self.service in self.graph.servers

    def call(self, request: bytes, on_response: Callable[[bytes], None]) -> None:
        on_request = self.graph.servers.get(self.service)
        if on_request is None:
            return

        def reply(response: bytes) -> None:
            self.graph.pending.append(lambda: None if self.closed else on_response(response))

        self.graph.pending.append(lambda: on_request(request, self.gid, reply))

    def close(self) -> None:
        self.closed = True


class LoopbackGraph:
    """Graph of several programs."""

    def __init__(self) -> None:
        self.pending: deque[Callable[[], None]] = deque()
        self.programs: list[LoopbackCarrier] = []
        self.readers: list[_Reader] = []
        self.writers: list[LoopbackWriter] = []
        self.servers: dict[str, OnRequest] = {}
        self.owners: list[tuple[LoopbackCarrier, GraphEndpoint]] = []

    def program(self) -> "LoopbackCarrier":
        """Add a program."""
        return LoopbackCarrier(self)

    def deliver(self) -> None:
        """Deliver all messages, and the messages that this causes."""
        while self.pending:
            self.pending.popleft()()


class LoopbackCarrier:
    """Carrier of one program. It implements `GraphCarrier`."""

    def __init__(self, graph: LoopbackGraph) -> None:
        self._graph = graph
        self.own: list[NodeName] = []
        graph.programs.append(self)

    async def start(self) -> CannotListen | CannotReach | None:
        return None

    async def stop(self) -> None:
        graph = self._graph
        graph.readers = [reader for reader in graph.readers if reader.program is not self]
        graph.writers = [writer for writer in graph.writers if writer.program is not self]
        for owner, endpoint in graph.owners:
            if owner is self and endpoint.role is EndpointRole.SERVER:
                graph.servers.pop(endpoint.name, None)
        graph.owners = [(owner, endpoint) for owner, endpoint in graph.owners if owner is not self]

    def add_node(self, node: NodeName) -> None:
        self.own.append(node)

    def publish(self, node: NodeName, topic: str, support: MessageSupport, qos: QosProfile) -> GraphWriter:
        gid = self._own(EndpointRole.PUBLISHER, node, topic, support, qos)
        writer = LoopbackWriter(self._graph, self, topic, qos, gid)
        self._graph.writers.append(writer)
        return writer

    def subscribe(
        self, node: NodeName, topic: str, support: MessageSupport, qos: QosProfile, on_message: OnMessage
    ) -> None:
        self._own(EndpointRole.SUBSCRIPTION, node, topic, support, qos)
        reader = _Reader(self, topic, qos, on_message)
        self._graph.readers.append(reader)
        if qos.durability is Durability.TRANSIENT_LOCAL:
            for writer in self._graph.writers:
                if reader in writer.matched():
                    for message in writer.kept:
                        writer.send(reader, message)

    def serve(self, node: NodeName, service: str, support: ServiceSupport, on_request: OnRequest) -> None:
        self._own(EndpointRole.SERVER, node, service, support, QosProfile())
        self._graph.servers[service] = on_request

    def client(self, node: NodeName, service: str, support: ServiceSupport) -> GraphClient:
        return LoopbackClient(
            self._graph, service, self._own(EndpointRole.CLIENT, node, service, support, QosProfile())
        )

    def nodes(self) -> Sequence[NodeName]:
        return [node for program in self._graph.programs if program is not self for node in program.own]

    def endpoints(self) -> Sequence[GraphEndpoint]:
        return [endpoint for owner, endpoint in self._graph.owners if owner is not self]

    def node_of(self, gid: bytes) -> str:
        node = self._graph.owners[int.from_bytes(gid, "little")][1].node
        assert node is not None
        return node.whole

    def _own(
        self, role: EndpointRole, node: NodeName, name: str, support: MessageSupport | ServiceSupport, qos: QosProfile
    ) -> bytes:
        gid = len(self._graph.owners).to_bytes(16, "little")
        self._graph.owners.append((self, GraphEndpoint(role, node, name, support.name, support.hash, qos, gid)))
        return gid
