"""Registration of a node with the master. It is repeated after each restart of the master."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum

from thbridge.rosgraph.sockets.http_client import CallFailed, XmlRpcClient
from thbridge.rosgraph.sockets.replies import value_of
from thbridge.rosgraph.wire.xmlrpc import Fault, MethodResponse, XmlRpcValue
from thbridge.sockets.warn_once import WarnOnce

_HEARTBEAT = 1.0
"""Seconds between two checks of the master."""

_FIRST_PAUSE = 0.1
"""Seconds before the next call of a missing master. This time doubles at each failure."""

_LAST_PAUSE = 2.0

_REPORTED_MISSES = 2
"""Number of consecutive calls without an answer that cause a warning. A single call may be lost, or may arrive before
the master is ready."""

_FAREWELL_SECONDS = 3.0
"""Maximum time in seconds for all calls that remove the node's registrations."""

_log = logging.getLogger(__name__)


class RegistrationKind(Enum):
    """Kind of a registration. The values are parts of the names of the master's methods."""

    PUBLISHER = "Publisher"
    SUBSCRIBER = "Subscriber"
    SERVICE = "Service"
    PARAMETER = "Param"


@dataclass(frozen=True, slots=True)
class NodeAddresses:
    """URIs of a node.

    Attributes:
        slave: ``http://host:port/``.
        services: ``rosrpc://host:port``.
    """

    slave: str
    services: str


@dataclass(frozen=True, slots=True)
class Registration:
    """Registration with the master.

    Attributes:
        kind: its kind.
        name: name of the topic, service or parameter.
        type: type of the topic, otherwise empty.
    """

    kind: RegistrationKind
    name: str
    type: str = ""

    def register_call(self, at: NodeAddresses) -> tuple[str, tuple[str, ...]]:
        """Return the master's method that adds this registration, and its arguments after the caller id."""
        match self.kind:
            case RegistrationKind.SERVICE:
                return "registerService", (self.name, at.services, at.slave)
            case RegistrationKind.PARAMETER:
                return "subscribeParam", (at.slave, self.name)
            case _:
                return f"register{self.kind.value}", (self.name, self.type, at.slave)

    def unregister_call(self, at: NodeAddresses) -> tuple[str, tuple[str, ...]]:
        """Return the master's method that removes this registration, and its arguments after the caller id."""
        match self.kind:
            case RegistrationKind.SERVICE:
                return "unregisterService", (self.name, at.services)
            case RegistrationKind.PARAMETER:
                return "unsubscribeParam", (at.slave, self.name)
            case _:
                return f"unregister{self.kind.value}", (self.name, at.slave)


@dataclass(frozen=True, slots=True)
class MasterCallbacks:
    """Callbacks of the registrar.

    Attributes:
        lost: called when the master no longer answers.
        found: called when all registrations with a new master are complete. The first master is also a new master.
        replaced: called when another node has our name. The registrar has stopped then.
    """

    lost: Callable[[], None]
    found: Callable[[], None]
    replaced: Callable[[], None]


class Registrar:
    """Registrar of a node with the master. It registers the node again with a restarted master.

    Each check looks up our own name. The answer shows whether the master is gone, was restarted (even quickly), or has
    given our name to another node.

    Args:
        client: client for calls to the master.
        master_uri: URI of the master, ``http://host:port``.
        caller: name of the node.
        callbacks: functions that are called at changes.
    """

    def __init__(self, client: XmlRpcClient, master_uri: str, caller: str, callbacks: MasterCallbacks) -> None:
        self._client = client
        self._master_uri = master_uri
        self._caller = caller
        self._callbacks = callbacks
        self._wanted: dict[Registration, Callable[[XmlRpcValue], None]] = {}
        self._registered: set[Registration] = set()
        self._parameters: dict[str, XmlRpcValue] = {}
        self._unset: dict[str, None] = {}
        self._reached = False
        self._misses = 0
        self._woken = asyncio.Event()
        self._settled = asyncio.Event()
        self._complaints = WarnOnce(_log)

    def add(self, registration: Registration, registered: Callable[[XmlRpcValue], None]) -> None:
        """Add a registration for the present master and every later master.

        `registered` is called with each master's answer.
        """
        self._wanted[registration] = registered
        self._settled.clear()
        self._woken.set()

    def declare(self, key: str, value: XmlRpcValue) -> None:
        """Set a parameter on this master and every later master. It is deleted when the node leaves."""
        self._parameters[key] = value
        self._unset[key] = None
        self._settled.clear()
        self._woken.set()

    async def settled(self) -> None:
        """Wait until everything is registered."""
        await self._settled.wait()

    async def run(self, addresses: NodeAddresses) -> None:
        """Keep all registrations until another node has our name."""
        pause = _FIRST_PAUSE
        while True:
            self._woken.clear()
            where = await self._call("lookupNode", self._caller)
            match where:
                case CallFailed():
                    self._miss(where)
                    pause = min(2 * pause, _LAST_PAUSE)
                # Another node has registered under our name, so the master has removed our registrations.
                case MethodResponse([1, _, str(uri)]) if uri != addresses.slave and self._registered:
                    self._callbacks.replaced()
                    return
                case MethodResponse([1, _, str(uri)]) if uri == addresses.slave and self._reached:
                    await self._register(addresses)
                    pause = _HEARTBEAT
                # The master has not answered for some time, but it was not restarted.
                case MethodResponse([1, _, str(uri)]) if uri == addresses.slave:
                    await self._register_afresh(addresses, forgotten=False)
                    pause = _HEARTBEAT
                # Usually the master does not know our name, because it is new or was restarted.
                case _:
                    await self._register_afresh(addresses, forgotten=bool(self._registered))
                    pause = _HEARTBEAT
            with suppress(TimeoutError):
                async with asyncio.timeout(pause):
                    await self._woken.wait()

    async def leave(self, addresses: NodeAddresses) -> None:
        """Remove all registrations, as long as the master answers."""
        with suppress(TimeoutError):
            async with asyncio.timeout(_FAREWELL_SECONDS):
                match await self._call("lookupNode", self._caller):
                    case MethodResponse([1, _, str(uri)]) if uri != addresses.slave:
                        ours: Iterable[str] = ()  # Another node with our name may have set the same parameters.
                    case _:
                        ours = self._parameters.keys() - self._unset.keys()
                for key in ours:
                    if isinstance(await self._call("deleteParam", key), CallFailed):
                        return
                for registration in self._registered:
                    method, params = registration.unregister_call(addresses)
                    if isinstance(await self._call(method, *params), CallFailed):
                        return

    async def _register_afresh(self, addresses: NodeAddresses, *, forgotten: bool) -> None:
        """Register everything.

        Args:
            addresses: URIs of the node.
            forgotten: True if the master was restarted and has lost earlier registrations.
        """
        news = not self._reached or bool(self._registered)
        self._registered.clear()
        self._unset = dict.fromkeys(self._parameters)
        self._reached = await self._register(addresses)
        if news and self._reached:
            level = logging.WARNING if forgotten or self._misses >= _REPORTED_MISSES else logging.INFO
            _log.log(level, "%s is registered with the ROS master at %s", self._caller, self._master_uri)
            self._callbacks.found()
        if self._reached:
            self._misses = 0

    async def _register(self, addresses: NodeAddresses) -> bool:
        """Add all missing registrations. Return True if the master answered every call.

        Parameters are first, because a node that finds our node may then read `/use_sim_time`, and must find it set.
        """
        complete = True
        for key in list(self._unset):
            value = self._parameters[key]
            reply = await self._call("setParam", key, value)
            if isinstance(reply, CallFailed):
                self._miss(reply)
                return False
            outcome = value_of(self._master_uri, reply)
            if isinstance(outcome, CallFailed):
                self._complaints.warn(f"the master does not accept {key}: {outcome.reason}")
            if self._parameters[key] is value:  # During the call, it may have been declared again with another value.
                del self._unset[key]
        for registration in [each for each in self._wanted if each not in self._registered]:
            method, params = registration.register_call(addresses)
            reply = await self._call(method, *params)
            if isinstance(reply, CallFailed):
                self._miss(reply)
                return False
            answer = value_of(self._master_uri, reply)
            if isinstance(answer, CallFailed):
                self._complaints.warn(f"the master does not accept {registration.name}: {answer.reason}")
                complete = False
            else:
                self._registered.add(registration)
                self._wanted[registration](answer)
        if complete and not self._unset and self._registered >= self._wanted.keys():
            self._settled.set()
        return True

    def _miss(self, failed: CallFailed) -> None:
        if self._reached:
            self._reached = False
            self._callbacks.lost()
        self._misses += 1
        if self._misses == _REPORTED_MISSES:
            problem = "the ROS master no longer answers" if self._registered else "no ROS master yet"
            _log.warning("%s: %s; waiting for it", problem, failed)

    async def _call(self, method: str, *params: XmlRpcValue) -> MethodResponse | Fault | CallFailed:
        return await self._client.call(self._master_uri, method, self._caller, *params)
