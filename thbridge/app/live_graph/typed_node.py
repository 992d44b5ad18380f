"""Node of ROS whose topics and services are declared only by the names of their types."""

from collections.abc import Callable
from dataclasses import dataclass

from thbridge.files.ros.definitions import Definitions
from thbridge.ros.messages.types import service_type
from thbridge.rosgraph.sockets.node import RosNode
from thbridge.rosgraph.sockets.publications import Publication
from thbridge.rosgraph.sockets.tcpros_server import ServiceHandler


@dataclass(frozen=True, slots=True, eq=False)
class TypedNode:
    """Node with the definitions of its message types.

    Attributes:
        ros: the node.
        definitions: definitions of message types.
    """

    ros: RosNode
    definitions: Definitions

    def advertise(self, topic: str, msgtype: str, latched: bool = False) -> Publication:
        """Publish a topic; see `RosNode.advertise`."""
        definition = self.definitions.of(msgtype)
        return self.ros.advertise(topic, msgtype, definition.md5, definition.text, latched)

    def subscribe(self, topic: str, msgtype: str, on_message: Callable[[bytes, str], None]) -> None:
        """Subscribe to a topic; see `RosNode.subscribe`."""
        self.ros.subscribe(topic, msgtype, self.definitions.of(msgtype).md5, on_message)

    def serve(self, service: str, kind: str, handler: ServiceHandler) -> None:
        """Offer a service; see `RosNode.serve`."""
        known = service_type(kind)
        self.ros.serve(service, kind, known.md5, known.request, known.response, handler)
