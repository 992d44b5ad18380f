"""ROS master over TCP, which answers calls and sends notifications to nodes."""

from __future__ import annotations

import asyncio
import logging
import os
import socket
import uuid
from collections.abc import Callable
from functools import lru_cache
from types import TracebackType

from thbridge.rosgraph.sockets.deliveries import Deliveries
from thbridge.rosgraph.sockets.http_client import CallFailed, XmlRpcClient
from thbridge.rosgraph.sockets.http_server import XmlRpcServer
from thbridge.rosgraph.sockets.rosout import rosout_node
from thbridge.rosgraph.wire.master import (
    ERROR,
    METHODS,
    ApiReply,
    Master,
    NodeShutdown,
    Notification,
    ParamUpdate,
    PublisherUpdate,
)
from thbridge.rosgraph.wire.xmlrpc import Fault, MethodCall, MethodResponse, XmlRpcValue, encode_call
from thbridge.sockets.addresses import LOCALHOST, ROS_MASTER_PORT, ListeningAddress
from thbridge.sockets.admission import OWN_MACHINE, Admission
from thbridge.sockets.errors import CannotListen
from thbridge.timing.loop import stopping

CALLER_ID = "/master"
"""Caller id of the master in calls to nodes."""

_DISTRIBUTION = "noetic"
_VERSION = "1.16.0"
"""Reported ROS release, which is the last release of ROS 1: distribution, and version of its roslaunch."""

_KEPT_CONNECTIONS = 128

_log = logging.getLogger(__name__)


class MasterServer:
    """ROS master. Nodes call it over TCP, and this process calls it directly.

    Like roscore, it also sets the parameters ``/run_id``, ``/rosdistro`` and ``/rosversion``. It can be used inside
    another program's event loop::

        async with MasterServer() as master:
            if isinstance(master, CannotListen): ...

    Args:
        host: address to listen on. ``0.0.0.0`` also accepts other machines. ROS 1 has no security.
        port: port to listen on. 0 selects any free port.
        timeout: maximum time in seconds for a node's answer to a notification.
        admission: decides by address which callers are accepted.
    """

    def __init__(
        self,
        host: str = LOCALHOST,
        port: int = ROS_MASTER_PORT,
        timeout: float = 5.0,
        admission: Admission = OWN_MACHINE,
    ) -> None:
        self._host = host
        self._port = port
        self._timeout = timeout
        self._server = XmlRpcServer(METHODS, self._handle, admission=admission)
        self._client = XmlRpcClient(_KEPT_CONNECTIONS)
        self._deliveries = Deliveries(self._deliver)
        self._master = Master("", os.getpid())
        self._stopped = asyncio.Event()
        self.uri = ""
        """URI of the master after its start, for ``ROS_MASTER_URI``."""

    @property
    def connections(self) -> int:
        """Number of open connections of nodes and tools."""
        return self._server.connections

    async def start(self) -> ListeningAddress | CannotListen:
        """Start to serve."""
        where = await self._server.start(self._host, self._port)
        if isinstance(where, CannotListen):
            return where
        self.uri = f"http://{_advertised(where.host)}:{where.port}/"
        self._master = Master(self.uri, os.getpid())
        self.call("setParam", CALLER_ID, "/run_id", str(uuid.uuid4()))
        # roscore sets these to the output of commands, including the line feed.
        self.call("setParam", CALLER_ID, "/rosdistro", f"{_DISTRIBUTION}\n")
        self.call("setParam", CALLER_ID, "/rosversion", f"{_VERSION}\n")
        return where

    async def stop(self) -> None:
        """Stop serving. Notifications that are not delivered yet are dropped."""
        await self._server.stop()
        await self._deliveries.stop()
        await self._client.close()

    async def __aenter__(self) -> MasterServer | CannotListen:
        where = await self.start()
        return where if isinstance(where, CannotListen) else self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.stop()

    async def stopped(self) -> None:
        """Wait until a node calls ``shutdown``."""
        await self._stopped.wait()

    def call(self, method: str, caller_id: str, *params: XmlRpcValue) -> ApiReply:
        """Answer a call of this process like a call that arrives over a socket.

        Raises:
            KeyError: the method is unknown.
        """
        return self._carry_out(MethodCall(method, [caller_id, *params]))

    def _handle(self, call: MethodCall, peer: str) -> XmlRpcValue:
        return self._carry_out(call).as_value()

    def _carry_out(self, call: MethodCall) -> ApiReply:
        reply, notifications = self._master.handle(call)
        for notification in notifications:
            self._deliveries.post(notification)
        if self._master.stopped:
            self._stopped.set()
        return reply

    async def _deliver(self, notification: Notification) -> bool:
        match notification:
            case PublisherUpdate(api, topic, publishers):
                answer = await self._client.post(api, _publisher_update(topic, publishers), self._timeout)
            case NodeShutdown(api, node, reason):
                answer = await self._notify(api, "shutdown", f"[{node}] Reason: {reason}")
            case ParamUpdate(api, key, value):
                answer = await self._notify(api, "paramUpdate", key, value)
                match answer:
                    case MethodResponse([int(status), *_]) if status == ERROR:
                        self._master.refuse_update(api, key)
        if not isinstance(answer, MethodResponse):
            _log.info("a node could not be notified: %s; notification: %s", answer, notification)
        return not isinstance(answer, CallFailed)

    async def _notify(self, api: str, method: str, *params: XmlRpcValue) -> MethodResponse | Fault | CallFailed:
        try:
            return await self._client.call(api, method, CALLER_ID, *params, timeout=self._timeout)
        except ValueError as error:  # A parameter is too long after encoding.
            return CallFailed(api, str(error))


async def serve(
    host: str,
    port: int,
    ready: Callable[[ListeningAddress | CannotListen], None],
    admission: Admission = OWN_MACHINE,
) -> None:
    """Run the programs of roscore (master and rosout) until Ctrl-C, SIGTERM, SIGHUP, or a node's call of ``shutdown``.

    Args:
        host: see `MasterServer`.
        port: see `MasterServer`.
        ready: called with the address, or with the reason for a failure.
        admission: decides by address which callers are accepted.
    """
    master = MasterServer(host, port, admission=admission)
    with stopping() as stopped:
        where = await master.start()
        ready(where)
        if isinstance(where, CannotListen):
            return
        rosout = rosout_node(master.uri, where.host, admission)
        if ":" in where.host:
            _log.warning("/rosout_agg is not published: nodes support only IPv4")
        elif isinstance(cannot := await rosout.start(), CannotListen):
            _log.warning("/rosout_agg is not published: %s", cannot)
        endings = [asyncio.ensure_future(ending) for ending in (stopped.wait(), master.stopped())]
        await asyncio.wait(endings, return_when=asyncio.FIRST_COMPLETED)
        for ending in endings:
            ending.cancel()
        await rosout.stop()
        await master.stop()


@lru_cache(16)
def _publisher_update(topic: str, publishers: tuple[str, ...]) -> bytes:
    """Encode a call for all subscribers of a topic. The cache saves encoding it again for each subscriber."""
    return encode_call("publisherUpdate", [CALLER_ID, topic, [*publishers]])


def _advertised(host: str) -> str:
    """Return the host for our URI. If it is the wildcard address, return this machine's name."""
    if host in {"0.0.0.0", "::"}:
        return socket.gethostname()
    return f"[{host}]" if ":" in host else host
