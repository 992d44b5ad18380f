"""ROS 1 node. It publishes, subscribes and serves on a ROS graph by TCPROS, without an installation of ROS.

Everything runs on the thread of one event loop. The loop calls callbacks directly, so they must not raise. No peer can
make a node raise or wait.

Source: https://wiki.ros.org/ROS/Technical%20Overview, Master_API, Slave_API, TCPROS; rospy for further behavior that
ROS's tools rely on.

Differences from ROS: a node registers again with a restarted master, unlike nodes of rospy and roscpp. UDPROS is not
supported. Small messages are always sent at once (TCP_NODELAY), even if the subscriber does not request it.
"""

from __future__ import annotations

import asyncio
import itertools
import logging
import os
import socket
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from thbridge.files.errors import reason_of
from thbridge.rosgraph.sockets.http_client import CallFailed, XmlRpcClient
from thbridge.rosgraph.sockets.http_server import HttpLimits, XmlRpcServer
from thbridge.rosgraph.sockets.publications import Publication
from thbridge.rosgraph.sockets.registrar import (
    MasterCallbacks,
    NodeAddresses,
    Registrar,
    Registration,
    RegistrationKind,
)
from thbridge.rosgraph.sockets.replies import value_of
from thbridge.rosgraph.sockets.subscriptions import (
    MessageCallback,
    PublisherCallback,
    Subscription,
    SubscriptionRequest,
    ignore_publisher,
)
from thbridge.rosgraph.sockets.tcpros_server import ServiceHandler, TcprosServer
from thbridge.rosgraph.wire.links import ServiceHeader, TopicHeader
from thbridge.rosgraph.wire.slave import (
    METHODS,
    BusConnection,
    Consequence,
    NodeDescription,
    ParameterChanged,
    PublishersChanged,
    ShutdownRequested,
    answer_call,
)
from thbridge.rosgraph.wire.xmlrpc import MethodCall, XmlRpcValue
from thbridge.sockets.admission import OWN_MACHINE, Admission
from thbridge.sockets.errors import CannotListen

ParamCallback: TypeAlias = Callable[[str, XmlRpcValue], None]
"""Callback with the key of a parameter and its new value."""

_CALLERS = 128
"""Maximum number of connections to the slave API."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class NodeStarted:
    """Success of `RosNode.start`.

    Attributes:
        uri: URI of the node's slave API.
    """

    uri: str


def _ignore() -> None:
    """Do nothing."""


def _ignore_reason(reason: str) -> None:
    """Do nothing."""


def _ignore_value(value: XmlRpcValue) -> None:
    """Do nothing."""


class RosNode:
    """ROS node.

    Names are global and resolved, such as ``/robot1/scan``. Publications, subscriptions and services last as long as
    the node. They can be added before `start`, and while there is no master.

    Args:
        name: name of the node, such as ``/thbridge``.
        master_uri: URI of the master, such as ``http://127.0.0.1:11311``.
        host: address on which the node listens and at which other nodes call it. Every program that can connect can
            command robots, because TCPROS has no passwords. With 127.0.0.1, only programs of this machine can connect.
            With 0.0.0.0, the node listens on every address, and other nodes get this machine's name.
        on_shutdown: called with the reason when the node is asked to end. The cause is another node that has taken its
            name, or ``rosnode kill``. It should cause the owner to call `stop`.
        on_lost: called when the master no longer answers.
        on_found: called when all registrations with a new master are complete. This is the first master, or a
            restarted master, which has lost its parameters.
    """

    def __init__(
        self,
        name: str,
        master_uri: str,
        host: str = "127.0.0.1",
        *,
        on_shutdown: Callable[[str], None] = _ignore_reason,
        on_lost: Callable[[], None] = _ignore,
        on_found: Callable[[], None] = _ignore,
        admission: Admission = OWN_MACHINE,
    ) -> None:
        self.name = name
        self.master_uri = master_uri
        self.host = host
        self._advertised_host = socket.gethostname() if host == "0.0.0.0" else host
        self._on_shutdown = on_shutdown
        self._numbers = itertools.count(1)
        self._client = XmlRpcClient()
        self._slave = XmlRpcServer(METHODS, self._answer, HttpLimits(connections=_CALLERS), admission)
        self._tcpros = TcprosServer(name, self._numbers, admission)
        self._tcpros_port = 0
        self._subscriptions: dict[str, Subscription] = {}
        self._parameters: dict[str, ParamCallback] = {}
        self._registrar = Registrar(
            self._client,
            master_uri,
            name,
            MasterCallbacks(on_lost, on_found, lambda: self._go("another node has its name")),
        )
        self._addresses = NodeAddresses("", "")
        self._registering: asyncio.Task[None] | None = None
        self._leaving: asyncio.Task[None] | None = None

    async def start(self) -> NodeStarted | CannotListen:
        """Listen, and start to register. The master may appear later."""
        address = await self._address()
        if isinstance(address, CannotListen):
            return address
        # The slave API reports the port of TCPROS, so the server of TCPROS starts first.
        tcpros = await self._tcpros.start(address)
        if isinstance(tcpros, CannotListen):
            return tcpros
        slave = await self._slave.start(address)
        if isinstance(slave, CannotListen):
            await self._tcpros.stop()
            return slave
        self._tcpros_port = tcpros.port
        self._addresses = NodeAddresses(
            f"http://{self._advertised_host}:{slave.port}/", f"rosrpc://{self._advertised_host}:{tcpros.port}"
        )
        self._registering = asyncio.get_running_loop().create_task(self._registrar.run(self._addresses))
        return NodeStarted(self._addresses.slave)

    async def _address(self) -> str | CannotListen:
        """Return the first IPv4 address of our host, because ROS's nodes support IPv4 only."""
        try:
            found = await asyncio.get_running_loop().getaddrinfo(self.host, 0, family=socket.AF_INET)
        except OSError as error:
            return CannotListen(self.host, 0, reason_of(error))
        except UnicodeError:
            return CannotListen(self.host, 0, "this is not the name of a host")
        return str(found[0][4][0])

    async def registered(self) -> None:
        """Wait until all present registrations of this node are complete.

        Refused registrations are logged and repeated.
        """
        await self._registrar.settled()

    async def stop(self) -> None:
        """Remove all registrations, send the published messages, and close all connections."""
        registering, self._registering = self._registering, None
        if registering is None:
            if self._leaving is not None and self._leaving is not asyncio.current_task():
                await self._leaving
            return
        registering.cancel()
        await asyncio.wait([registering])
        await self._registrar.leave(self._addresses)
        await asyncio.gather(*(each.stop() for each in self._subscriptions.values()))
        await self._tcpros.stop()
        await self._slave.stop()
        await self._client.close()

    def leave(self) -> None:
        """Start `stop` without waiting for it."""
        if self._leaving is None:
            self._leaving = asyncio.get_running_loop().create_task(self.stop())

    def advertise(self, topic: str, kind: str, md5: str, definition: str, latched: bool = False) -> Publication:
        """Publish a topic.

        Args:
            topic: global name.
            kind: type of its messages, such as ``sensor_msgs/LaserScan``.
            md5: the type's md5 sum.
            definition: the type's complete text, as in bags.
            latched: True if new subscribers get the last message at once.

        Raises:
            ValueError: this node already publishes the topic.
        """
        if topic in self._tcpros.publications:
            raise ValueError(f"this node already publishes {topic}")
        publication = self._tcpros.offer(TopicHeader(topic, kind, md5, definition, latched))
        self._registrar.add(Registration(RegistrationKind.PUBLISHER, topic, kind), _ignore_value)
        return publication

    def subscribe(
        self,
        topic: str,
        kind: str,
        md5: str,
        on_message: MessageCallback,
        tcp_nodelay: bool = True,
        on_publisher: PublisherCallback = ignore_publisher,
    ) -> None:
        """Subscribe to a topic. Messages come from all publishers, including this node.

        Args:
            topic: global name.
            kind: type of its messages, or ``*`` for any type.
            md5: the type's md5 sum, or ``*`` for any sum.
            on_message: called with each serialized message and the name of its publisher.
            tcp_nodelay: True to request that publishers send small messages at once.
            on_publisher: called with the name of each publisher that accepts the subscription, and its header.

        Raises:
            ValueError: this node already subscribes to the topic.
        """
        if topic in self._subscriptions:
            raise ValueError(f"this node already subscribes to {topic}")
        request = SubscriptionRequest(topic, kind, md5, tcp_nodelay)
        subscription = Subscription(self.name, request, on_message, self._client, self._numbers, on_publisher)
        self._subscriptions[topic] = subscription

        def registered(publishers: XmlRpcValue) -> None:
            # The master's reply to a registration lists the present publishers.
            if isinstance(publishers, list):
                subscription.set_publishers([each for each in publishers if isinstance(each, str)])

        self._registrar.add(Registration(RegistrationKind.SUBSCRIBER, topic, kind), registered)

    def serve(
        self, service: str, kind: str, md5: str, request_type: str, response_type: str, handler: ServiceHandler
    ) -> None:
        """Serve a service.

        Args:
            service: global name.
            kind: its type, such as ``nav_msgs/GetMap``.
            md5: the service type's md5 sum.
            request_type: type of its request, such as ``nav_msgs/GetMapRequest``.
            response_type: type of its response, such as ``nav_msgs/GetMapResponse``.
            handler: returns the serialized response to a serialized request, or a failure, at once or later.

        Raises:
            ValueError: this node already serves the service.
        """
        if self._tcpros.service(service) is not None:
            raise ValueError(f"this node already serves {service}")
        self._tcpros.serve(ServiceHeader(service, kind, md5, request_type, response_type), handler)
        self._registrar.add(Registration(RegistrationKind.SERVICE, service), _ignore_value)

    async def get_param(self, key: str) -> XmlRpcValue | CallFailed:
        """Return the value of a parameter or of a tree of parameters."""
        return await self._ask_master("getParam", key)

    def declare_param(self, key: str, value: XmlRpcValue) -> None:
        """Set a parameter or a tree of parameters on this master and every later master.

        The parameter lasts as long as the node, and is set before all registrations. A second declaration replaces its
        value.
        """
        self._registrar.declare(key, value)

    def subscribe_param(self, key: str, changed: ParamCallback) -> None:
        """Subscribe to changes of a parameter, or of any parameter below it, by other nodes.

        Args:
            key: global name.
            changed: called with the changed key and its value. The changed key is the given key or below it. An empty
                dictionary means that the key was deleted.

        Raises:
            ValueError: this node already subscribes to the parameter.
        """
        if key in self._parameters:
            raise ValueError(f"this node already subscribes to {key}")
        self._parameters[key] = changed
        self._registrar.add(Registration(RegistrationKind.PARAMETER, key), _ignore_value)

    async def _ask_master(self, method: str, *params: XmlRpcValue) -> XmlRpcValue | CallFailed:
        reply = await self._client.call(self.master_uri, method, self.name, *params)
        return value_of(self.master_uri, reply)

    def _answer(self, call: MethodCall, peer: str) -> XmlRpcValue:
        answer = answer_call(call, self._described())
        if answer.consequence is not None:
            # The caller gets its reply first, because the call may end this node.
            asyncio.get_running_loop().call_soon(self._carry_out, answer.consequence)
        return answer.reply

    def _described(self) -> NodeDescription:
        return NodeDescription(
            name=self.name,
            uri=self._addresses.slave,
            master_uri=self.master_uri,
            pid=os.getpid(),
            tcpros=(self._advertised_host, self._tcpros_port),
            publications={name: each.topic.type for name, each in self._tcpros.publications.items()},
            subscriptions={name: each.request.kind for name, each in self._subscriptions.items()},
            parameters=self._parameters.keys(),
            connections=self._connections,
        )

    def _connections(self) -> list[BusConnection]:
        subscribed = [connection for each in self._subscriptions.values() for connection in each.connections()]
        return [*self._tcpros.connections(), *subscribed]

    def _carry_out(self, consequence: Consequence) -> None:
        match consequence:
            case PublishersChanged(topic, uris):
                if topic in self._subscriptions:
                    self._subscriptions[topic].set_publishers(uris)
            case ParameterChanged(key, value, wanted):
                for each in wanted:
                    self._parameters[each](key, value)
            case ShutdownRequested(reason):
                self._go(reason)

    def _go(self, reason: str) -> None:
        # If the registrar continued, it would register this node again, and take the name from the other node.
        if self._registering is not None:
            self._registering.cancel()
        _log.warning("%s is asked to shut down: %s", self.name, reason)
        self._on_shutdown(reason)
