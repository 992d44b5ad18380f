"""Carrier of a ROS 2 graph over zenoh. It speaks with nodes of rmw_zenoh and of other libraries with the same keys.

zenoh calls back on its own threads. Messages go from there to the event loop through bounded queues, so a flood does
not use more memory.

If there is no router at the start, the carrier reports this. If the router is lost later, zenoh connects again and
announces all nodes and endpoints again.
"""

import logging
import secrets
import threading
from collections.abc import Callable, Sequence

import zenoh
from zenoh.handlers import Callback

from thbridge.ros2.qos import SERVICES, QosProfile
from thbridge.ros2.supports import MessageSupport, ServiceSupport
from thbridge.ros2graph.sockets.carrier import OnMessage, OnRequest
from thbridge.ros2graph.sockets.zenoh_endpoints import ZenohClient, ZenohWriter, serve, subscribe
from thbridge.ros2graph.sockets.zenoh_link import ZenohLink
from thbridge.ros2graph.values.graph import EndpointRole, GraphEndpoint, NodeName
from thbridge.ros2graph.wire.zenoh.graph import AnnouncedGraph
from thbridge.ros2graph.wire.zenoh.keys import EndpointKeys, SessionKeys, graph_key
from thbridge.sockets.addresses import Address
from thbridge.sockets.errors import CannotReach
from thbridge.sockets.warn_once import WarnOnce


class ZenohCarrier:
    """Connection of one program to a ROS 2 graph over zenoh. See `GraphCarrier`.

    Args:
        domain: domain of the graph, from 0.
        router: address of a router, for example that of `thbridge ros2 router`.
    """

    def __init__(self, domain: int, router: Address) -> None:
        # zenoh accepts no leading zeros. Of two peers, that with the greater last byte connects, so this program knows
        # the address of each peer, and can connect again.
        session = f"{secrets.randbits(96) | 1 << 95:x}ffffffff"
        self._domain = domain
        self._keys = SessionKeys(domain, session)
        self._link = ZenohLink(session, router)
        self._graph = AnnouncedGraph(session)
        self._lock = threading.Lock()
        self._numbers: dict[NodeName, int] = {}
        self._next_number = 0
        self._publishers: set[bytes] = set()
        self._warnings = WarnOnce(logging.getLogger(__name__))
        self._link.call(self._watch)

    async def start(self) -> CannotReach | None:
        """Join the graph. Return the reason if there is no router."""
        return await self._link.open()

    async def stop(self) -> None:
        """Leave the graph, and announce this to the other programs."""
        await self._link.close()

    def add_node(self, node: NodeName) -> None:
        """Announce a node."""
        if node not in self._numbers:
            self._numbers[node] = number = self._number()
            self._link.announce(self._keys.node(number, node))

    def publish(self, node: NodeName, topic: str, support: MessageSupport, qos: QosProfile) -> ZenohWriter:
        """Announce a publisher."""
        keys = self._endpoint(node, EndpointRole.PUBLISHER, topic, support, qos)
        self._publishers.add(keys.gid)
        writer = ZenohWriter(self._link, keys, qos, self._counter(EndpointRole.SUBSCRIPTION, keys))
        self._link.announce(keys.liveliness)
        return writer

    def subscribe(
        self, node: NodeName, topic: str, support: MessageSupport, qos: QosProfile, on_message: OnMessage
    ) -> None:
        """Announce a subscription. Messages of publishers of this program are not delivered."""
        keys = self._endpoint(node, EndpointRole.SUBSCRIPTION, topic, support, qos)
        subscribe(self._link, keys, qos, on_message, self._publishers)
        self._link.announce(keys.liveliness)

    def serve(self, node: NodeName, service: str, support: ServiceSupport, on_request: OnRequest) -> None:
        """Announce a server of a service."""
        keys = self._endpoint(node, EndpointRole.SERVER, service, support, SERVICES)
        serve(self._link, keys, on_request, self.node_of)
        self._link.announce(keys.liveliness)

    def client(self, node: NodeName, service: str, support: ServiceSupport) -> ZenohClient:
        """Announce a client of a service."""
        keys = self._endpoint(node, EndpointRole.CLIENT, service, support, SERVICES)
        count = self._counter(EndpointRole.SERVER, keys)
        client = ZenohClient(self._link, keys, lambda: count() > 0)
        self._link.announce(keys.liveliness)
        return client

    def nodes(self) -> Sequence[NodeName]:
        """Return the nodes of other programs that are known at this time."""
        with self._lock:
            return self._graph.nodes()

    def endpoints(self) -> Sequence[GraphEndpoint]:
        """Return the endpoints of other programs that are known at this time."""
        with self._lock:
            return self._graph.endpoints()

    def node_of(self, gid: bytes) -> str:
        """Return the full name of the node of an endpoint, or `UNANNOUNCED` if the endpoint is unknown."""
        with self._lock:
            return self._graph.node_of(gid)

    def _endpoint(
        self,
        node: NodeName,
        role: EndpointRole,
        name: str,
        support: MessageSupport | ServiceSupport,
        qos: QosProfile,
    ) -> EndpointKeys:
        self.add_node(node)
        number = self._numbers[node], self._number()
        return self._keys.endpoint(*number, node, role, name, support.dds_name, support.hash, qos)

    def _number(self) -> int:
        self._next_number += 1
        return self._next_number

    def _counter(self, role: EndpointRole, keys: EndpointKeys) -> Callable[[], int]:
        """Return a function that returns the number of endpoints with a role and the same key of messages."""

        def count() -> int:
            with self._lock:
                return self._graph.count(role, keys.data)

        return count

    def _watch(self, session: zenoh.Session) -> None:
        take = Callback(self._change, indirect=False)
        key = graph_key(self._domain)
        self._link.keep(session.liveliness().declare_subscriber(key, take, history=True))

    def _change(self, sample: zenoh.Sample) -> None:
        """Add or remove what another program announces, on a thread of zenoh."""
        key = str(sample.key_expr)
        with self._lock:
            if sample.kind == zenoh.SampleKind.DELETE:
                self._graph.remove(key)
            elif not self._graph.add(key):
                self._warnings.warn(f"an announcement of the graph is invalid or one too many: {key[:200]!r}")
