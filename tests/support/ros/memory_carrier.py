"""Carrier of a ROS 2 graph in memory, with one client outside the program."""

from collections.abc import Callable, Sequence

from thbridge.ros2.qos import QosProfile
from thbridge.ros2.supports import MessageSupport, ServiceSupport
from thbridge.ros2graph.sockets.carrier import GraphClient, GraphWriter, OnMessage, OnRequest
from thbridge.ros2graph.values.graph import GraphEndpoint, NodeName
from thbridge.sockets.errors import CannotListen

CLIENT = b"client-0123456"


class MemoryWriter:
    """Publisher whose messages are kept."""

    def __init__(self, keep: Callable[[bytes], None]) -> None:
        self.write = keep
        self.readers = 1
        self.dropped = 0


class MemoryCarrier:
    """Carrier that delivers requests and messages of one outside client.

    Attributes:
        published: topics and messages, in their order.
        services: types of the services, by name.
    """

    def __init__(self) -> None:
        self.published: list[tuple[str, bytes]] = []
        self.services: dict[str, str] = {}
        self.topics: dict[str, str] = {}
        self._servers: dict[str, OnRequest] = {}
        self._readers: dict[str, OnMessage] = {}
        self._nodes: list[NodeName] = []

    def call(self, service: str, request: bytes) -> bytes | None:
        """Return the response to a request, or None if there is none yet."""
        responses: list[bytes] = []
        self._servers[service](request, CLIENT, responses.append)
        return responses[0] if responses else None

    def send(self, topic: str, message: bytes) -> None:
        """Send a message of the outside client."""
        self._readers[topic](message, CLIENT)

    async def start(self) -> CannotListen | None:
        return None

    async def stop(self) -> None:
        pass

    def add_node(self, node: NodeName) -> None:
        self._nodes.append(node)

    def publish(self, node: NodeName, topic: str, support: MessageSupport, qos: QosProfile) -> GraphWriter:
        self.topics[topic] = support.name
        return MemoryWriter(lambda message: self.published.append((topic, message)))

    def subscribe(
        self, node: NodeName, topic: str, support: MessageSupport, qos: QosProfile, on_message: OnMessage
    ) -> None:
        self._readers[topic] = on_message

    def serve(self, node: NodeName, service: str, support: ServiceSupport, on_request: OnRequest) -> None:
        assert service not in self._servers, f"{service} is offered twice"
        self._servers[service] = on_request
        self.services[service] = support.name

    def client(self, node: NodeName, service: str, support: ServiceSupport) -> GraphClient:
        raise NotImplementedError

    def nodes(self) -> Sequence[NodeName]:
        return ()

    def endpoints(self) -> Sequence[GraphEndpoint]:
        return ()

    def node_of(self, gid: bytes) -> str:
        return "/client" if gid == CLIENT else gid.hex()
