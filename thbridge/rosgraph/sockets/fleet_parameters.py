"""Time offset of real robots' odometry, as a parameter of the ROS graph and by dynamic_reconfigure."""

import logging
import math
from collections.abc import Callable
from typing import cast

from thbridge.files.ros.definitions import Definitions
from thbridge.ros import reconfigure
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import types
from thbridge.ros.messages.types import service_type
from thbridge.ros.parameters import leaves
from thbridge.ros.reconfigure import DescribedParameter, ReconfigureServer
from thbridge.ros.topics import Topic
from thbridge.rosgraph.sockets.node import RosNode
from thbridge.rosgraph.wire.links import ServiceFailed
from thbridge.rosgraph.wire.xmlrpc import XmlRpcValue

_log = logging.getLogger(__name__)


class FleetParameters:
    """Current time offset. Nodes of the graph can read and change it.

    Args:
        node: node of the fleet.
        definitions: definitions of message types.
        offset: declaration of the parameter. Its default is the value at the start.
        apply: called with each value that is published, seconds.
    """

    def __init__(
        self, node: RosNode, definitions: Definitions, offset: DescribedParameter, apply: Callable[[float], None]
    ) -> None:
        self._node = node
        self._server = ReconfigureServer("", (offset,))
        self._key = f"{node.name}/{offset.name}"
        self._apply = apply
        self._seconds = cast(float, offset.default)
        updates = Topic(f"{node.name}/parameter_updates", types.CONFIG, latched=True)
        described = Topic(f"{node.name}/parameter_descriptions", types.CONFIG_DESCRIPTION, latched=True)
        texts = [definitions.of(topic.msgtype) for topic in (updates, described)]
        self._updates, descriptions = (
            node.advertise(topic.name, topic.msgtype, text.md5, text.text, topic.latched)
            for topic, text in zip((updates, described), texts, strict=True)
        )
        descriptions.publish(reconfigure.description(self._server))
        known = service_type(types.RECONFIGURE)
        service = f"{node.name}/set_parameters"
        node.serve(service, types.RECONFIGURE, known.md5, known.request, known.response, self._reconfigure)
        node.subscribe_param(node.name, self._set)
        self._publish()

    def _publish(self) -> bytes:
        config = reconfigure.values_config([(self._server.parameters[0], self._seconds)])
        self._node.declare_param(self._key, self._seconds)
        self._updates.publish(config)
        self._apply(self._seconds)
        return config

    def _reconfigure(self, data: bytes) -> bytes | ServiceFailed:
        """Process a change by a client of dynamic_reconfigure. Values are clamped to the bounds, as in ROS."""
        requested = reconfigure.requested_values(self._server, data)
        if isinstance(requested, InvalidMessage):
            return ServiceFailed(requested.sentence)
        for _, value in requested:
            self._change(value)
        return self._publish()

    def _set(self, key: str, value: XmlRpcValue) -> None:
        """Apply a change on the parameter server. Undo a deletion, or a value that is not an offset."""
        given = dict(leaves(key.rstrip("/"), value))
        if given != {self._key: self._seconds}:
            self._change(given.get(self._key, self._seconds))
            self._publish()

    def _change(self, value: object) -> None:
        (offset,) = self._server.parameters
        # In Python a bool is an int, but it is not a valid offset.
        number = float(value) if isinstance(value, int | float) and not isinstance(value, bool) else math.nan
        if number != offset.clamped(number):  # True also for NaN.
            least, most = offset.minimum, offset.maximum
            _log.warning("%s keeps its value: it must be a number from %g to %g, not %r", self._key, least, most, value)
        elif number != self._seconds:
            self._seconds = number
            _log.warning("%s is %g s now", self._key, number)
