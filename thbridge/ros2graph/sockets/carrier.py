"""Carrier of a ROS 2 graph: what nodes need from DDS or zenoh. Messages are bytes of CDR, with their 4-byte header.

All callbacks run on the event loop, one after the other, and return quickly.
"""

from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias

from thbridge.ros2.qos import QosProfile
from thbridge.ros2.supports import MessageSupport, ServiceSupport
from thbridge.ros2graph.values.graph import GraphEndpoint, NodeName
from thbridge.sockets.errors import CannotListen, CannotReach

OnMessage: TypeAlias = Callable[[bytes, bytes], None]
"""Callback with a message, and the gid of its publisher."""
Reply: TypeAlias = Callable[[bytes], None]
"""Function that sends the response to a request. It may be called later, but only once."""
OnRequest: TypeAlias = Callable[[bytes, bytes, Reply], None]
"""Callback with a request, the gid of its client, and the function that sends the response."""


class GraphWriter(Protocol):
    """Publisher on a carrier."""

    @property
    def readers(self) -> int:
        """Number of matched subscriptions of other programs."""

    def write(self, message: bytes) -> None:
        """Send a message to all matched subscriptions. This never waits."""


class GraphClient(Protocol):
    """Client of a service on a carrier."""

    @property
    def has_server(self) -> bool:
        """True if a server is known."""

    def call(self, request: bytes, on_response: Callable[[bytes], None]) -> None:
        """Send a request. The callback gets the first response."""

    def close(self) -> None:
        """Leave the graph. No further response is delivered."""


class GraphCarrier(Protocol):
    """Connection of one program to a ROS 2 graph. Nodes and endpoints can be added before the start and later."""

    async def start(self) -> CannotListen | CannotReach | None:
        """Join the graph. Return the reason if this is not possible."""

    async def stop(self) -> None:
        """Leave the graph, and announce this to the other programs."""

    def add_node(self, node: NodeName) -> None:
        """Announce a node."""

    def publish(self, node: NodeName, topic: str, support: MessageSupport, qos: QosProfile) -> GraphWriter:
        """Announce a publisher."""

    def subscribe(
        self, node: NodeName, topic: str, support: MessageSupport, qos: QosProfile, on_message: OnMessage
    ) -> None:
        """Announce a subscription. Messages of publishers of this program are not delivered."""

    def serve(self, node: NodeName, service: str, support: ServiceSupport, on_request: OnRequest) -> None:
        """Announce a server of a service."""

    def client(self, node: NodeName, service: str, support: ServiceSupport) -> GraphClient:
        """Announce a client of a service."""

    def nodes(self) -> Sequence[NodeName]:
        """Return the nodes of other programs that are known at this time."""

    def endpoints(self) -> Sequence[GraphEndpoint]:
        """Return the endpoints of other programs that are known at this time."""

    def node_of(self, gid: bytes) -> str:
        """Return the full name of the node of an endpoint; a text without "/" if the node is unknown."""
