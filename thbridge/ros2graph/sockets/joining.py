"""Joining a ROS 2 graph: its carrier, and a look at the nodes that are already there."""

import asyncio
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from thbridge.ros2graph.sockets.carrier import GraphCarrier
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.values.address import CarrierKind, Ros2Address
from thbridge.ros2graph.values.graph import EndpointRole
from thbridge.sockets.addresses import parse_address
from thbridge.sockets.admission import OWN_MACHINE, Admission

_LOOKS = 15
_LOOK_SECONDS = 0.1
"""Nodes on the same machine or network answer within a second."""


@dataclass(frozen=True, slots=True)
class NodeTaken:
    """Another program has a node that this program needs. `str` returns one line for people.

    Attributes:
        node: full name of the node.
    """

    node: str

    def __str__(self) -> str:
        return f"another program in this domain already has the node {self.node}. Stop that program first."


def carrier_of(address: Ros2Address, admission: Admission = OWN_MACHINE) -> GraphCarrier:
    """Return the carrier of a graph, before it is started.

    Args:
        address: the graph.
        admission: decides by address whose datagrams are processed. A zenoh session accepts only this machine.

    Raises:
        ModuleNotFoundError: the carrier is zenoh, and the extra `ros2` is not installed.
        ValueError: the address of the router is invalid.
    """
    if address.carrier is CarrierKind.DDS:
        return DdsCarrier(address.domain, address.host, admission=admission)
    from thbridge.ros2graph.sockets.zenoh import ZenohCarrier  # noqa: PLC0415 - optional packages

    router = parse_address(address.router)
    if router is None:
        raise ValueError(f"{address.router!r} is not an address")
    return ZenohCarrier(address.domain, router)


async def find_nodes(
    carrier: GraphCarrier, is_sought: Callable[[str], bool], published: Collection[str] = ()
) -> Sequence[str]:
    """Look for other programs' nodes, and return their full names as soon as there is one.

    Args:
        carrier: the carrier, which has joined the graph.
        is_sought: function that returns True for a full name that is looked for.
        published: topics. Nodes that publish one of them are also looked for.
    """
    for _ in range(_LOOKS):
        found = {name for node in carrier.nodes() if is_sought(name := node.whole)}
        for endpoint in carrier.endpoints():
            if endpoint.role is EndpointRole.PUBLISHER and endpoint.name in published:
                found.add(carrier.node_of(endpoint.gid))
        if found:
            return sorted(found)
        await asyncio.sleep(_LOOK_SECONDS)
    return ()
