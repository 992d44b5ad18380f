"""Session of zenoh, with a thread that makes all calls, because zenoh may wait for slow peers in any call."""

import asyncio
import logging
import socket
import time
from collections import deque
from collections.abc import Callable

import zenoh

from thbridge.ros2graph.sockets.last_items import CallThread, ClientThreads, Job
from thbridge.ros2graph.sockets.zenoh_lost_peers import LostPeers
from thbridge.ros2graph.sockets.zenoh_settings import peer_settings
from thbridge.sockets.addresses import LOCALHOST, Address
from thbridge.sockets.admission import is_own
from thbridge.sockets.errors import CannotReach

_log = logging.getLogger(__name__)

_CONNECT_SECONDS = 5.0
"""Seconds that a router has to accept a connection, and then the session."""
_POLL_SECONDS = 0.02
_BUSY_SECONDS = 0.002
_REST_SECONDS = 0.002
"""Seconds for which the event loop handles what has arrived, and for which it then does other work, such as ticks. So
floods take at most about half of its time."""
_STOP_SECONDS = 5.0
"""Seconds that zenoh has to end the session."""
_REMEDY = "Start one with `thbridge ros2 router` or `ros2 run rmw_zenoh_cpp rmw_zenohd`, or name another address"


class ZenohLink:
    """Connection to a zenoh network. Calls can be posted before it is open.

    Args:
        session: id of the session: hexadecimal digits without leading zeros.
        router: address of a router.
    """

    def __init__(self, session: str, router: Address) -> None:
        self._id = session
        self._router = router
        self._calls = CallThread("zenoh")
        self._replies = ClientThreads("zenoh replies")
        self._session: zenoh.Session | None = None
        self._lost: LostPeers | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._tokens: dict[str, zenoh.LivelinessToken] = {}
        self._declared: list[object] = []
        self._woken: deque[Job] = deque()
        self._runs = False

    async def open(self) -> CannotReach | None:
        """Connect, and make the calls that are posted. Return the reason if there is no router."""
        try:
            async with asyncio.timeout(_CONNECT_SECONDS):
                _, writer = await asyncio.open_connection(*self._router)
                writer.close()
        except OSError as error:  # TimeoutError is one, too.
            return CannotReach.because(error, "zenoh router", self._router, _REMEDY)
        try:
            own = _free_address()
            session = await asyncio.to_thread(zenoh.open, peer_settings(self._id, self._router, own))
        except zenoh.ZError as error:
            return CannotReach("zenoh router", self._router, str(error), _REMEDY)
        if not await _is_connected(session):
            await asyncio.to_thread(session.close)
            return CannotReach("zenoh router", self._router, "the program there is no zenoh router", _REMEDY)
        self._session, self._loop = session, asyncio.get_running_loop()
        if is_own(self._router.host):
            self._lost = LostPeers(session, own, self._router, self.wake)
        self._calls.start()
        return None

    async def close(self) -> None:
        """Make the posted calls, end the session, and announce this to the other programs."""
        self._loop = None
        if self._session is None:
            return
        if self._lost is not None:
            await self._lost.stop()
        self.call(self._end)
        self._replies.end()
        if not await asyncio.to_thread(self._calls.end, _STOP_SECONDS):
            _log.warning("zenoh did not end its session in time; it ends with the program")

    def call(self, job: Callable[[zenoh.Session], object]) -> None:
        """Make a call of zenoh after all posted calls. This never waits. After the end, nothing happens."""

        self._calls.post(lambda: None if self._session is None else job(self._session))

    def reply(self, client: str, job: Job, size: int) -> bool:
        """Make a call that may wait for a client's node. See `ClientThreads.post`."""
        return self._replies.post(client, lambda: None if self._session is None else job(), size)

    def call_later(self, seconds: float, job: Callable[[zenoh.Session], None]) -> None:
        """Make a call of zenoh after this number of seconds. Any thread may ask for this."""

        def start() -> None:
            asyncio.get_running_loop().call_later(seconds, self.call, job)

        self.wake(start)

    def wake(self, job: Job) -> None:
        """Make a call on the event loop. Any thread may ask for this. After the end, nothing happens."""
        self._woken.append(job)
        self._run_soon()

    def _run_soon(self) -> None:
        # If two threads come here at once, the second call finds nothing to do.
        loop = self._loop
        if loop is not None and not self._runs:
            self._runs = True
            loop.call_soon_threadsafe(self._run)

    def _run(self) -> None:
        end = time.monotonic() + _BUSY_SECONDS
        while self._woken and self._loop is not None:
            if time.monotonic() > end:
                self._loop.call_later(_REST_SECONDS, self._run)
                return
            self._woken.popleft()()
        self._runs = False
        if self._woken:  # A thread has added a job meanwhile.
            self._run_soon()

    def keep(self, declared: object) -> None:
        """Keep a declared object until the end; otherwise, zenoh withdraws the declaration."""
        self._declared.append(declared)

    def announce(self, key: str) -> None:
        """Announce a liveliness key to the other programs."""

        def declare(session: zenoh.Session) -> None:
            self._tokens[key] = session.liveliness().declare_token(key)

        self.call(declare)

    def withdraw(self, key: str) -> None:
        """Withdraw a liveliness key."""
        self.call(lambda _: self._tokens.pop(key).undeclare())

    def _end(self, session: zenoh.Session) -> None:
        self._session = None
        session.close()
        self._tokens.clear()
        self._declared.clear()


def _free_address() -> Address:
    # zenoh does not report the port that the system selects.
    with socket.create_server((LOCALHOST, 0)) as probe:
        return Address(*probe.getsockname())


async def _is_connected(session: zenoh.Session) -> bool:
    """Wait until the session is connected. Return False if this takes too long."""
    try:
        async with asyncio.timeout(_CONNECT_SECONDS):
            while not (session.info.routers_zid() or session.info.peers_zid()):
                await asyncio.sleep(_POLL_SECONDS)
    except TimeoutError:
        return False
    return True
