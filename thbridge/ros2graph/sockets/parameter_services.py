"""Services that each node of a ROS 2 graph has: its parameters, their events, and the descriptions of its types.

Requests that are no messages are dropped. Answers may take milliseconds, for example with 70 descriptors. So requests
wait in a queue for each client, and between two answers the event loop does other work. Clients take turns.
"""

import asyncio
import logging
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Protocol

from thbridge.ros2 import parameter_messages as messages
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.parameters import GivenParameter, ParameterNode, Value
from thbridge.ros2.qos import PARAMETER_EVENTS
from thbridge.ros2.type_descriptions import SERVICE, SERVICE_TYPE, answer_type_description
from thbridge.ros2graph.sockets.carrier import GraphCarrier, Reply
from thbridge.ros2graph.values.graph import NodeName
from thbridge.sockets.warn_once import WarnOnce

EVENTS = "/parameter_events"
MAX_WAITING, MAX_WAITING_OF_ALL = 200, 1000
"""Maximum number of requests of a client, and of all clients, that wait for their answers. Further ones are dropped."""
LARGEST_REQUEST = 1 << 18
"""Maximum number of bytes of a request."""

_log = logging.getLogger(__name__)


class ParameterOwner(Protocol):
    """Holder of the values of nodes' parameters."""

    def present(self, node: ParameterNode) -> Mapping[str, Value]:
        """Return the values of a node's parameters that may change, by name."""

    def set(self, node: ParameterNode, given: Sequence[GivenParameter], together: bool) -> Sequence[str]:
        """Set parameters of a node.

        Args:
            node: the node.
            given: the new values.
            together: True to set all parameters or none; the result then has only one reason.

        Returns:
            For each parameter the reason why it keeps its value, or an empty text.
        """


def call_soon(callback: Callable[[], None]) -> None:
    """Call a function in the next round of the event loop."""
    asyncio.get_running_loop().call_soon(callback)


class NodeServices:
    """Services of nodes on one carrier. All nodes share the supports of the types, and the queue of requests.

    Args:
        carrier: the carrier.
        types: types of the messages.
        defer: calls a function later.
    """

    def __init__(
        self, carrier: GraphCarrier, types: Distribution, defer: Callable[[Callable[[], None]], None] = call_soon
    ) -> None:
        self._carrier = carrier
        self._types = types
        self._defer = defer
        self._waiting: dict[str, deque[Callable[[], None]]] = {}
        self._count = 0
        self._complaints = WarnOnce(_log)
        self._supports = {service: types.service(name) for service, name in messages.SERVICE_TYPES.items()}
        self._description = types.service(SERVICE_TYPE)

    def serve(self, node: NodeName, service: str, type_: str, answer: Callable[[bytes], bytes]) -> None:
        """Offer a service whose answers take no time. `answer` raises ValueError for bytes that are no request."""
        self._carrier.serve(node, service, self._types.service(type_), partial(self._enqueue, service, answer))

    def describe_types(self, node: NodeName) -> None:
        """Offer `get_type_description` of a node."""
        service = f"{node.whole}/{SERVICE}"
        answer = partial(answer_type_description, self._types)
        self._carrier.serve(node, service, self._description, partial(self._enqueue, service, answer))

    def offer(self, node: ParameterNode, owner: ParameterOwner) -> "ParameterEvents":
        """Offer the services of a node's parameters, and return its publisher of events."""
        types, parameters = self._types, node.parameters
        answers: Mapping[str, Callable[[bytes], bytes]] = {
            messages.LIST: partial(messages.answer_list, types, parameters),
            messages.DESCRIBE: partial(messages.answer_descriptions, types, parameters),
            messages.TYPES: partial(messages.answer_types, types, parameters),
            messages.GET: lambda request: messages.answer_values(types, parameters, owner.present(node), request),
            messages.SET: partial(self._set, node, owner, messages.SET),
            messages.SET_TOGETHER: partial(self._set, node, owner, messages.SET_TOGETHER),
        }
        named = NodeName(node.namespace, node.name)
        for service, support in self._supports.items():
            name = f"{named.whole}/{service}"
            self._carrier.serve(named, name, support, partial(self._enqueue, name, answers[service]))
        return ParameterEvents(self._carrier, types, node)

    def _set(self, node: ParameterNode, owner: ParameterOwner, service: str, request: bytes) -> bytes:
        given = messages.given_parameters(self._types, service, request)
        refusals = owner.set(node, given, service == messages.SET_TOGETHER)
        return messages.set_answer(self._types, service, refusals)

    def _enqueue(
        self, service: str, answer: Callable[[bytes], bytes], request: bytes, client: bytes, reply: Reply
    ) -> None:
        name = self._carrier.node_of(client)
        queue = self._waiting.get(name, ())
        if len(queue) >= MAX_WAITING or self._count >= MAX_WAITING_OF_ALL or len(request) > LARGEST_REQUEST:
            self._complaints.warn(f"{service}: too many or too long requests of {name} wait; some are dropped")
            return
        self._waiting.setdefault(name, deque()).append(partial(self._answer, service, answer, request, name, reply))
        self._count += 1
        if self._count == 1:
            self._defer(self._answer_next)

    def _answer_next(self) -> None:
        """Answer the oldest request of the client whose turn it is. Then it is the next client's turn."""
        client = next(iter(self._waiting))
        queue = self._waiting.pop(client)
        try:
            queue.popleft()()
        finally:
            if queue:
                self._waiting[client] = queue
            self._count -= 1
            if self._count:
                self._defer(self._answer_next)

    def _answer(
        self, service: str, answer: Callable[[bytes], bytes], request: bytes, client: str, reply: Reply
    ) -> None:
        try:
            response = answer(request)
        except ValueError as error:
            self._complaints.warn(f"{service}: ignoring a request of {client}: {error}")
        else:
            reply(response)


class ParameterEvents:
    """Publisher of a node's parameter events."""

    def __init__(self, carrier: GraphCarrier, types: Distribution, node: ParameterNode) -> None:
        self._types = types
        self._node = node
        self._name = NodeName(node.namespace, node.name)
        self._writer = carrier.publish(self._name, EVENTS, types.message(messages.EVENT), PARAMETER_EVENTS)

    def announce(self, nanoseconds: int, present: Mapping[str, Value]) -> None:
        """Publish all parameters as new.

        Args:
            nanoseconds: time of the event.
            present: values of the parameters that may change.
        """
        if self._writer.readers:
            new = ((each, present.get(name, each.value)) for name, each in self._node.parameters.items())
            self._writer.write(messages.event(self._types, nanoseconds, self._name.whole, new=new))

    def changed(self, nanoseconds: int, values: Iterable[tuple[str, Value]]) -> None:
        """Publish changed parameters: names and new values."""
        if self._writer.readers:
            changed = [(self._node.parameters[name], value) for name, value in values]
            self._writer.write(messages.event(self._types, nanoseconds, self._name.whole, changed=changed))
