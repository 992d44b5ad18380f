"""ROS master as a state machine. Its inputs are calls. Its outputs are replies and notifications.

It stores the registrations of publishers, subscribers and services, and the parameters. It does not transport messages.

Source: http://wiki.ros.org/ROS/Master_API and ROS/Parameter_Server_API; ROS's rosmaster/master_api.py for status codes,
texts and the order of checks.

Differences from ROS: the number of nodes and registrations, the length of names and the size of all parameters have
limits. Above a limit, the reply to a call is an error. A node that replies to a parameter update with an error loses
its subscription, as rosmaster intends. Caller ids are treated as global names.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from thbridge.rosgraph.values.names import ANY_TYPE, SEPARATOR
from thbridge.rosgraph.wire.arguments import (
    InvalidArgumentError,
    api_uri,
    caller_id,
    global_key,
    graph_name,
    relative_key,
    subgraph,
    topic_type,
)
from thbridge.rosgraph.wire.parameter_tree import ParameterTree, updates
from thbridge.rosgraph.wire.registrations import MAX_REGISTRATIONS, ProviderKind, Registrations
from thbridge.rosgraph.wire.xmlrpc import MethodCall, XmlRpcValue

ERROR, FAILURE, SUCCESS = -1, 0, 1
"""Status codes: error of the caller, error of the master, success."""

_MAX_TYPES = 2 * MAX_REGISTRATIONS


@dataclass(frozen=True, slots=True)
class ApiReply:
    """Reply of a method of the master API or slave API: status code, sentence for people, value."""

    status: int
    message: str
    value: XmlRpcValue

    def as_value(self) -> XmlRpcValue:
        """Return the list that XML-RPC sends."""
        return [self.status, self.message, self.value]


@dataclass(frozen=True, slots=True)
class PublisherUpdate:
    """Notification of a topic's current publishers to a subscriber. ``api`` and ``publishers`` are slave URIs."""

    api: str
    topic: str
    publishers: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ParamUpdate:
    """Notification of a parameter's value. ``key`` ends with a slash. An empty dict means that it was deleted."""

    api: str
    key: str
    value: XmlRpcValue


@dataclass(frozen=True, slots=True)
class NodeShutdown:
    """Notification to a node that it must end, because another node has taken its name."""

    api: str
    node: str
    reason: str


Notification: TypeAlias = PublisherUpdate | ParamUpdate | NodeShutdown

_VALUE_ON_ERROR: Mapping[str, XmlRpcValue] = {
    "registerService": 0,
    "unregisterService": 0,
    "registerSubscriber": [],
    "unregisterSubscriber": 0,
    "registerPublisher": [],
    "unregisterPublisher": 0,
    "lookupNode": "",
    "lookupService": "",
    "getPublishedTopics": 0,
    "getTopicTypes": [],
    "getSystemState": [[], [], []],
    "getUri": "",
    "getPid": -1,
    "shutdown": 0,
    "deleteParam": 0,
    "setParam": 0,
    "getParam": 0,
    "searchParam": 0,
    "subscribeParam": 0,
    "unsubscribeParam": 0,
    "hasParam": False,
    "getParamNames": [],
}

METHODS = frozenset(_VALUE_ON_ERROR)
"""Names of all methods."""


class ParameterServer:
    """Parameters of a ROS graph. Subscriptions to parameters are registrations.

    Args:
        registrations: registrations of all nodes.
        notify: called with each notification to a subscriber.
    """

    def __init__(self, registrations: Registrations, notify: Callable[[ParamUpdate], None]) -> None:
        self._registrations = registrations
        self._notify = notify
        self._tree = ParameterTree()

    def set(self, caller: str, key: str, value: XmlRpcValue) -> ApiReply:
        """Set a parameter, and notify all subscribers except the caller."""
        if value is None:
            raise InvalidArgumentError("ERROR: parameter [value] must be specified")
        try:
            self._tree.set(key, value)
        except ValueError as error:
            return ApiReply(ERROR, f"Error: invalid arguments: {error}", 0)
        self._tell_of_change(key, value, author=caller)
        return ApiReply(SUCCESS, f"parameter {key} set", 0)

    def get(self, key: str) -> ApiReply:
        """Return the value of a parameter or a namespace."""
        try:
            return ApiReply(SUCCESS, f"Parameter [{key}]", self._tree.get(key))
        except KeyError:
            return ApiReply(ERROR, f"Parameter [{key}] is not set", 0)

    def delete(self, key: str) -> ApiReply:
        """Delete a parameter, and notify its subscribers."""
        try:
            self._tree.delete(key)
        except KeyError:
            return ApiReply(ERROR, f"parameter [{key}] is not set", 0)
        self._tell_of_change(key, {}, author=None)
        return ApiReply(SUCCESS, f"parameter {key} deleted", 0)

    def search(self, caller: str, key: str) -> ApiReply:
        """Search for a parameter in the caller's namespace and in the namespaces that enclose it."""
        found = self._tree.search(caller, key)
        if found is None:
            return ApiReply(ERROR, f"Cannot find parameter [{key}] in an upwards search", "")
        return ApiReply(SUCCESS, f"Found [{found}]", found)

    def has(self, key: str) -> ApiReply:
        """Return True if a parameter is set."""
        return ApiReply(SUCCESS, key, key in self._tree)

    def names(self) -> ApiReply:
        """Return the names of all parameters."""
        return ApiReply(SUCCESS, "Parameter names", [*self._tree.names()])

    def subscribed(self, key: str) -> ApiReply:
        """Return the value of a parameter to its new subscriber. If it is not set, return an empty dict."""
        value: XmlRpcValue = self._tree.get(key) if key in self._tree else {}
        return ApiReply(SUCCESS, f"Subscribed to parameter [{key}]", value)

    def unsubscribe(self, caller: str, api: str, key: str) -> ApiReply:
        """Remove a subscription."""
        self._registrations.unregister(ProviderKind.PARAMETER, _subscription(key), caller, api)
        return ApiReply(SUCCESS, f"Unsubscribe to parameter [{key}]", 1)

    def _tell_of_change(self, key: str, value: XmlRpcValue, author: str | None) -> None:
        subscribed = self._registrations.keys(ProviderKind.PARAMETER)
        for update in updates(subscribed, key, value):
            for provider in self._registrations.providers(ProviderKind.PARAMETER, update.subscription):
                if not (update.own and provider.node == author):
                    self._notify(ParamUpdate(provider.api, update.key, update.value))


class Master:
    """State of a ROS graph.

    Args:
        uri: URI of the master, as it reports it.
        pid: process id of the master, as it reports it.

    Attributes:
        stopped: True if ``shutdown`` was called.
    """

    def __init__(self, uri: str, pid: int) -> None:
        self._uri = uri
        self._pid = pid
        self._registrations = Registrations()
        self._types: dict[str, str] = {}
        self._notifications: list[Notification] = []
        self._parameters = ParameterServer(self._registrations, self._notifications.append)
        self.stopped = False

    def handle(self, call: MethodCall) -> tuple[ApiReply, list[Notification]]:
        """Execute a call of the master API or the parameter server API.

        Args:
            call: one of `METHODS`.

        Returns:
            The reply to the caller, and the notifications to other nodes, in order.

        Raises:
            KeyError: the method is unknown.
        """
        on_error = _VALUE_ON_ERROR[call.method]
        self._notifications.clear()
        if not call.params:
            return ApiReply(ERROR, "missing required caller_id parameter", on_error), []
        caller, *given = call.params
        try:
            reply = self._carry_out(call.method, caller_id(caller), given)
        except InvalidArgumentError as error:
            reply = ApiReply(ERROR, str(error), on_error)
        except ValueError as error:
            reply = ApiReply(FAILURE, f"Internal failure: {error}", on_error)
        if reply.value is None:
            reply = ApiReply(ERROR, "Internal error (None value returned)", on_error)
        return reply, [*self._notifications]

    def refuse_update(self, api: str, key: str) -> None:
        """Remove a node's subscription to a parameter after the node refused an update. The key ends with a slash."""
        self._registrations.unsubscribe_all(key, api)

    def _carry_out(self, method: str, caller: str, given: list[XmlRpcValue]) -> ApiReply:
        # The patterns are the signatures of the API. Arguments are checked from left to right, like in rosmaster.
        match method, given:
            case "registerPublisher", [topic, type_, api]:
                name = graph_name(topic, "topic", caller)
                return self._register_publisher(caller, name, topic_type(type_), api_uri(api))
            case "unregisterPublisher", [topic, api]:
                return self._unregister_publisher(caller, graph_name(topic, "topic", caller), api_uri(api))
            case "registerSubscriber", [topic, type_, api]:
                name = graph_name(topic, "topic", caller)
                return self._register_subscriber(caller, name, topic_type(type_), api_uri(api))
            case "unregisterSubscriber", [topic, api]:
                return self._unregister(
                    ProviderKind.SUBSCRIBER, caller, graph_name(topic, "topic", caller), api_uri(api)
                )
            case "registerService", [service, service_api, api]:
                name = graph_name(service, "service", caller)
                return self._register_service(caller, name, api_uri(service_api, "service_api"), api_uri(api))
            case "unregisterService", [service, service_api]:
                name = graph_name(service, "service", caller)
                return self._unregister_service(caller, name, api_uri(service_api, "service_api"))
            case "lookupService", [service]:
                return self._lookup_service(graph_name(service, "service", caller))
            case "lookupNode", [node]:
                return self._lookup_node(graph_name(node, "node", caller, root=True))
            case "getPublishedTopics", [namespace]:
                return self._published_topics(subgraph(namespace, caller))
            case "getTopicTypes", []:
                return ApiReply(SUCCESS, "current system state", [[name, type_] for name, type_ in self._types.items()])
            case "getSystemState", []:
                shown = (ProviderKind.PUBLISHER, ProviderKind.SUBSCRIBER, ProviderKind.SERVICE)
                return ApiReply(SUCCESS, "current system state", [self._registrations.state(kind) for kind in shown])
            case "getUri", []:
                return ApiReply(SUCCESS, "", self._uri)
            case "getPid", []:
                return ApiReply(SUCCESS, "", self._pid)
            case "shutdown", [_]:
                self.stopped = True
                return ApiReply(SUCCESS, "shutdown", 0)
            case "setParam", [key, value]:
                return self._parameters.set(caller, global_key(key, caller), value)
            case "getParam", [key]:
                return self._parameters.get(global_key(key, caller))
            case "deleteParam", [key]:
                return self._parameters.delete(global_key(key, caller))
            case "hasParam", [key]:
                return self._parameters.has(global_key(key, caller))
            case "searchParam", [key]:
                return self._parameters.search(caller, relative_key(key))
            case "subscribeParam", [api, key]:
                uri, name = api_uri(api), global_key(key, caller)
                self._register(ProviderKind.PARAMETER, _subscription(name), caller, uri)
                return self._parameters.subscribed(name)
            case "unsubscribeParam", [api, key]:
                return self._parameters.unsubscribe(caller, api_uri(api), global_key(key, caller))
            case "getParamNames", []:
                return self._parameters.names()
            case _:
                raise InvalidArgumentError("Error: bad call arity")

    # -- publishers, subscribers, services -----------------------------------------------------------------------------

    def _register(self, kind: ProviderKind, key: str, caller: str, caller_api: str, api: str | None = None) -> None:
        replaced = self._registrations.register(kind, key, caller, caller_api, api)
        if replaced is not None:
            self._notifications.append(NodeShutdown(replaced, caller, "new node registered with same name"))

    def _unregister(self, kind: ProviderKind, caller: str, key: str, api: str) -> ApiReply:
        if self._registrations.api_of(caller) is None:
            return ApiReply(SUCCESS, f"[{caller}] is not a registered node", 0)
        if self._registrations.unregister(kind, key, caller, api):
            return ApiReply(SUCCESS, f"Unregistered [{caller}] as provider of [{key}]", 1)
        return ApiReply(SUCCESS, f"[{caller}] is not a known provider of [{key}]", 0)

    def _notify_subscribers(self, topic: str) -> list[str]:
        """Notify all subscribers of a topic about its publishers, and return the subscribers' URIs."""
        publishers = tuple(self._registrations.apis(ProviderKind.PUBLISHER, topic))
        subscribers = self._registrations.apis(ProviderKind.SUBSCRIBER, topic)
        self._notifications += [PublisherUpdate(api, topic, publishers) for api in subscribers]
        return subscribers

    def _register_publisher(self, caller: str, topic: str, type_: str, api: str) -> ApiReply:
        self._register(ProviderKind.PUBLISHER, topic, caller, api)
        # A type replaces an earlier type, but "any type" must not replace a known type.
        if type_ != ANY_TYPE or topic not in self._types:
            self._learn_type(topic, type_)
        subscribers = self._notify_subscribers(topic)
        return ApiReply(SUCCESS, f"Registered [{caller}] as publisher of [{topic}]", [*subscribers])

    def _learn_type(self, topic: str, type_: str) -> None:
        # The type of a topic is kept after the end of its registrations. The number of types is limited, so types of
        # topics without a registration are deleted when there are too many.
        if topic not in self._types and len(self._types) >= _MAX_TYPES:
            there = self._registrations.is_topic
            self._types = {name: kept for name, kept in self._types.items() if there(name)}
        self._types[topic] = type_

    def _unregister_publisher(self, caller: str, topic: str, api: str) -> ApiReply:
        reply = self._unregister(ProviderKind.PUBLISHER, caller, topic, api)
        if reply.value:
            self._notify_subscribers(topic)
        return reply

    def _register_subscriber(self, caller: str, topic: str, type_: str, api: str) -> ApiReply:
        self._register(ProviderKind.SUBSCRIBER, topic, caller, api)
        if type_ != ANY_TYPE and topic not in self._types:
            self._learn_type(topic, type_)
        publishers = self._registrations.apis(ProviderKind.PUBLISHER, topic)
        return ApiReply(SUCCESS, f"Subscribed to [{topic}]", [*publishers])

    def _register_service(self, caller: str, service: str, service_api: str, api: str) -> ApiReply:
        self._register(ProviderKind.SERVICE, service, caller, api, service_api)
        return ApiReply(SUCCESS, f"Registered [{caller}] as provider of [{service}]", 1)

    def _unregister_service(self, caller: str, service: str, service_api: str) -> ApiReply:
        reply = self._unregister(ProviderKind.SERVICE, caller, service, service_api)
        if reply.value == 0 and self._registrations.api_of(caller) is not None:
            message = f"[{service_api}] is no longer the current service api handle for [{service}]"
            return ApiReply(SUCCESS, message, 0)
        return reply

    def _lookup_service(self, service: str) -> ApiReply:
        match self._registrations.apis(ProviderKind.SERVICE, service):
            case [api]:
                return ApiReply(SUCCESS, f"rosrpc URI: [{api}]", api)
            case _:
                return ApiReply(ERROR, "no provider", "")

    def _lookup_node(self, node: str) -> ApiReply:
        api = self._registrations.api_of(node)
        return ApiReply(ERROR, f"unknown node [{node}]", "") if api is None else ApiReply(SUCCESS, "node api", api)

    def _published_topics(self, namespace: str) -> ApiReply:
        inside = namespace and namespace.removesuffix(SEPARATOR) + SEPARATOR
        topics = [topic for topic in self._registrations.keys(ProviderKind.PUBLISHER) if topic.startswith(inside)]
        return ApiReply(SUCCESS, "current topics", [[topic, self._types[topic]] for topic in topics])


def _subscription(key: str) -> str:
    return key.removesuffix(SEPARATOR) + SEPARATOR
