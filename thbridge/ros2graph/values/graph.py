"""Nodes and endpoints of a ROS 2 graph."""

from dataclasses import dataclass
from enum import Enum

from thbridge.ros2.qos import QosProfile


@dataclass(frozen=True, slots=True)
class NodeName:
    """Name of a node. `namespace` starts with a slash, for example "/robot1"; without namespace it is "/"."""

    namespace: str
    name: str

    @property
    def whole(self) -> str:
        """Return the full name, for example "/robot1/amcl"."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


class EndpointRole(Enum):
    """Role of an endpoint in the graph."""

    PUBLISHER = "publisher"
    SUBSCRIPTION = "subscription"
    SERVER = "server"
    CLIENT = "client"


@dataclass(frozen=True, slots=True)
class GraphEndpoint:
    """Endpoint of another program's node.

    Attributes:
        role: its role.
        node: its node; None until the node is known.
        name: name of the topic or service, for example "/robot1/scan".
        type: for example "sensor_msgs/msg/LaserScan".
        hash: hash of the type; empty if the program does not declare it.
        qos: its quality of service.
        gid: unique id, at most 16 bytes.
    """

    role: EndpointRole
    node: NodeName | None
    name: str
    type: str
    hash: str
    qos: QosProfile
    gid: bytes
