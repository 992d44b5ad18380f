"""The ROS master over TCP: serves calls and carries notifications to the nodes they are for."""

from __future__ import annotations

import asyncio
import logging
import os
import socket
import uuid
from collections import OrderedDict
from collections.abc import Awaitable, Callable
from types import TracebackType

from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.rosgraph.http_client import CallFailed, XmlRpcClient
from thbridge.sockets.rosgraph.http_server import XmlRpcServer
from thbridge.sockets.rosgraph.rosout import rosout_node
from thbridge.timing.loop import stopping
from thbridge.wire.rosgraph.master import (
    ERROR,
    METHODS,
    ApiReply,
    Master,
    NodeShutdown,
    Notification,
    ParamUpdate,
    PublisherUpdate,
)
from thbridge.wire.rosgraph.xmlrpc import Fault, MethodCall, MethodResponse, XmlRpcValue

DEFAULT_HOST = "127.0.0.1"
DEFAULT_PORT = 11311

CALLER_ID = "/master"
"""The name under which the master calls nodes; theirs for it."""

_DISTRIBUTION = "noetic"
_VERSION = "1.16.0"
"""The ROS that we speak like, its last: distribution, and version of its roslaunch."""

_KEPT_CONNECTIONS = 128

_log = logging.getLogger(__name__)


class MasterServer:
    """A master that nodes reach over TCP, and this process without.

    Beside the master's own work it sets what roscore sets: ``/run_id``, ``/rosdistro`` and ``/rosversion``. Usable
    inside another program's loop::

        async with MasterServer() as master:
            if isinstance(master, CannotListen): ...

    Args:
        host: address to listen on; ``0.0.0.0`` lets other machines in, and ROS 1 has no security whatever.
        port: 0 takes any that is free.
        patience: seconds that a node has to take a notification.
    """

    def __init__(self, host: str = DEFAULT_HOST, port: int = DEFAULT_PORT, patience: float = 5.0) -> None:
        self._host = host
        self._port = port
        self._patience = patience
        self._server = XmlRpcServer(METHODS, self._handle)
        self._client = XmlRpcClient(_KEPT_CONNECTIONS)
        self._deliveries = _Deliveries(self._deliver)
        self._master = Master("", os.getpid())
        self._stopped = asyncio.Event()
        self.uri = ""
        """Where nodes find the master once it is started: what ``ROS_MASTER_URI`` is to say."""

    @property
    def connections(self) -> int:
        """How many connections of nodes and tools are open."""
        return self._server.connections

    async def start(self) -> ListeningAddress | CannotListen:
        """Begin to serve."""
        where = await self._server.start(self._host, self._port)
        if isinstance(where, CannotListen):
            return where
        self.uri = f"http://{_advertised(where.host)}:{where.port}/"
        self._master = Master(self.uri, os.getpid())
        self.call("setParam", CALLER_ID, "/run_id", str(uuid.uuid4()))
        # roscore takes these from commands, whose line feeds it keeps.
        self.call("setParam", CALLER_ID, "/rosdistro", f"{_DISTRIBUTION}\n")
        self.call("setParam", CALLER_ID, "/rosversion", f"{_VERSION}\n")
        return where

    async def stop(self) -> None:
        """Cease to serve; notifications that are not delivered yet are dropped."""
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
        """Carry out a call of this process, as if it had come over a socket.

        Raises:
            KeyError: there is no such method.
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

    async def _deliver(self, notification: Notification) -> None:
        match notification:
            case PublisherUpdate(api, topic, publishers):
                answer = await self._tell(api, "publisherUpdate", topic, [*publishers])
            case NodeShutdown(api, node, reason):
                answer = await self._tell(api, "shutdown", f"[{node}] Reason: {reason}")
            case ParamUpdate(api, key, value):
                answer = await self._tell(api, "paramUpdate", key, value)
                match answer:
                    case MethodResponse([int(status), *_]) if status == ERROR:
                        self._master.refuse_update(api, key)
        if not isinstance(answer, MethodResponse):
            _log.info("could not be told (%s): %s", answer, notification)

    async def _tell(self, api: str, method: str, *params: XmlRpcValue) -> MethodResponse | Fault | CallFailed:
        try:
            return await self._client.call(api, method, CALLER_ID, *params, timeout=self._patience)
        except ValueError as error:  # a parameter that somebody set, and that is too long once it is written
            return CallFailed(api, str(error))


async def serve(host: str, port: int, ready: Callable[[ListeningAddress | CannotListen], None]) -> None:
    """Be what roscore is, master and log, until Ctrl-C, SIGTERM, or a node's call of ``shutdown``.

    Args:
        host: see `MasterServer`.
        port: see `MasterServer`.
        ready: told where nodes can reach it, or why they cannot.
    """
    master = MasterServer(host, port)
    where = await master.start()
    ready(where)
    if isinstance(where, CannotListen):
        return
    rosout = rosout_node(master.uri, where.host)
    if ":" in where.host:
        _log.warning("no /rosout_agg: nodes speak IPv4 only")
    elif isinstance(cannot := await rosout.start(), CannotListen):
        _log.warning("no /rosout_agg: %s", cannot)
    with stopping() as stopped:
        endings = [asyncio.ensure_future(ending) for ending in (stopped.wait(), master.stopped())]
        await asyncio.wait(endings, return_when=asyncio.FIRST_COMPLETED)
        for ending in endings:
            ending.cancel()
    await rosout.stop()
    await master.stop()


class _Deliveries:
    """Carries notifications to nodes: in order and one at a time for each, all nodes side by side.

    What waits for a node is bounded by what there is to say: a later notification about the same topic or parameter
    takes the place of the earlier one, at the end of the queue.
    """

    def __init__(self, deliver: Callable[[Notification], Awaitable[None]]) -> None:
        self._deliver = deliver
        self._waiting: dict[str, OrderedDict[tuple[str, str], Notification]] = {}
        self._carriers: dict[str, asyncio.Task[None]] = {}

    def post(self, notification: Notification) -> None:
        """Have a notification delivered."""
        api = notification.api
        waiting = self._waiting.setdefault(api, OrderedDict())
        subject = _subject(notification)
        waiting.pop(subject, None)
        waiting[subject] = notification
        if api not in self._carriers:
            self._carriers[api] = asyncio.get_running_loop().create_task(self._carry(api))

    async def stop(self) -> None:
        """Drop what is not delivered."""
        carriers = [*self._carriers.values()]
        for carrier in carriers:
            carrier.cancel()
        await asyncio.gather(*carriers, return_exceptions=True)

    async def _carry(self, api: str) -> None:
        waiting = self._waiting[api]
        try:
            while waiting:
                _, notification = waiting.popitem(last=False)
                await self._deliver(notification)
        finally:
            del self._waiting[api], self._carriers[api]


def _subject(notification: Notification) -> tuple[str, str]:
    match notification:
        case PublisherUpdate(_, topic, _):
            return "topic", topic
        case ParamUpdate(_, key, _):
            return "parameter", key
        case NodeShutdown(_, node, _):
            return "node", node


def _advertised(host: str) -> str:
    """What other machines call a host that we listen on; an address for all of this one's is none of its names."""
    if host in {"0.0.0.0", "::"}:
        return socket.gethostname()
    return f"[{host}]" if ":" in host else host
