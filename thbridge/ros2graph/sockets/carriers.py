"""Carrier of a ROS 2 graph, chosen by the graph's address."""

from thbridge.ros2graph.sockets.carrier import GraphCarrier
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.values.address import CarrierKind, Ros2Address
from thbridge.sockets.addresses import parse_address


def make_carrier(address: Ros2Address) -> GraphCarrier:
    """Return the carrier of a graph.

    Raises:
        ModuleNotFoundError: the carrier is zenoh, and the extra `ros2` is not installed.
        ValueError: the address of the router is invalid.
    """
    if address.carrier is CarrierKind.DDS:
        return DdsCarrier(address.domain, address.host)
    from thbridge.ros2graph.sockets.zenoh import ZenohCarrier  # noqa: PLC0415 - optional packages

    router = parse_address(address.router)
    if router is None:
        raise ValueError(f"{address.router!r} is not an address")
    return ZenohCarrier(address.domain, router)
