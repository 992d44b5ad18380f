"""The graph that other programs announce by liveliness keys."""

from collections import Counter
from collections.abc import Sequence

from thbridge.ros2graph.values.graph import EndpointRole, GraphEndpoint, NodeName
from thbridge.ros2graph.wire.zenoh.keys import Announcement, read_liveliness_key

MOST_KEYS = 16_384
"""Maximum number of liveliness keys of other programs. Further keys are ignored."""
UNANNOUNCED = "unannounced_program"
"""Name for all programs that do not announce the endpoint of a message. They can write a new gid in each message, so
with a name for each gid, one of them would take the turns of many clients."""


class AnnouncedGraph:
    """Nodes and endpoints of other programs.

    Args:
        own_session: id of this program's zenoh session; its keys are ignored.
    """

    def __init__(self, own_session: str) -> None:
        self._own_session = own_session
        self._known: dict[str, Announcement] = {}
        self._by_gid: dict[bytes, GraphEndpoint] = {}
        self._counts: Counter[tuple[EndpointRole, str]] = Counter()

    def add(self, key: str) -> bool:
        """Add a node or endpoint. Return False if its key is invalid, or if there are too many keys."""
        if key in self._known:
            return True
        announced = read_liveliness_key(key)
        if announced is None or (len(self._known) >= MOST_KEYS and announced.session != self._own_session):
            return False
        if announced.session != self._own_session:
            self._known[key] = announced
            if announced.endpoint is not None:
                self._by_gid[announced.endpoint.gid] = announced.endpoint
                self._counts[announced.endpoint.role, announced.data] += 1
        return True

    def remove(self, key: str) -> None:
        """Remove a node or endpoint that has left the graph."""
        announced = self._known.pop(key, None)
        if announced is None or announced.endpoint is None:
            return
        # Hostile programs can find two keys with the same gid.
        self._by_gid.pop(announced.endpoint.gid, None)
        place = announced.endpoint.role, announced.data
        self._counts[place] -= 1
        if not self._counts[place]:
            del self._counts[place]

    def nodes(self) -> Sequence[NodeName]:
        """Return the known nodes, each name once."""
        return [*dict.fromkeys(each.node for each in self._known.values() if each.endpoint is None)]

    def endpoints(self) -> Sequence[GraphEndpoint]:
        """Return the known endpoints."""
        return [*self._by_gid.values()]

    def count(self, role: EndpointRole, data: str) -> int:
        """Return the number of endpoints with this role and this key of messages."""
        return self._counts[role, data]

    def node_of(self, gid: bytes) -> str:
        """Return the full name of an endpoint's node, or `UNANNOUNCED` if the endpoint is unknown."""
        endpoint = self._by_gid.get(gid)
        return UNANNOUNCED if endpoint is None or endpoint.node is None else endpoint.node.whole
