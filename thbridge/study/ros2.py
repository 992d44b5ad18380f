"""The section `ros2` of a study: the ROS 2 graph that a session can join."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

from sim.parameters import param
from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import Loaded
from thbridge.ros2graph.values.address import (
    MOST_DOMAINS,
    ROUTER,
    CarrierKind,
    Ros2Address,
    RosDistribution,
    is_ipv4,
)
from thbridge.sockets.addresses import parse_address

S = TypeVar("S")


@dataclass(frozen=True, slots=True)
class Ros2Section:
    """ROS 2 graph that a session joins with the option `--ros2`, or that has the real robots."""

    distribution: RosDistribution = param(
        RosDistribution.JAZZY, "distribution of ROS 2 on the graph; some message types differ between distributions"
    )
    carrier: CarrierKind = param(
        CarrierKind.DDS, "protocol of the graph: dds (default of ROS 2), or zenoh (rmw_zenoh, with a router)"
    )
    domain: int = param(0, "domain id; only programs of the same domain see each other", "", 0, MOST_DOMAINS)
    host: str = param(
        "127.0.0.1", "address of this machine on the graph's network; 127.0.0.1: only programs of this machine"
    )
    router: str = param(ROUTER, "address, HOST:PORT, of the zenoh router")
    use_sim_time: bool = param(False, "whether real robots (robots_from: ros2) get their time from /clock")

    @property
    def address(self) -> Ros2Address:
        """Address of the graph."""
        return Ros2Address(self.carrier, self.domain, self.host, self.router, self.distribution)


def faults_of_ros2(loaded: Loaded[S], section: Ros2Section) -> Iterator[BadFile]:
    """Yield a fault for each address that is invalid."""
    if not is_ipv4(section.host):
        problem = f"{section.host!r} is not an IPv4 address"
        yield loaded.fault("ros2.host", problem, "Write an address of this machine, such as 127.0.0.1")
    if parse_address(section.router) is None:
        problem = f"{section.router!r} is not an address"
        yield loaded.fault("ros2.router", problem, f"Write HOST:PORT, such as {ROUTER}")
