"""Other machines for games: the hosts of a Dask cluster (extra `cluster`), which may join and leave at any time."""

import asyncio
import logging
import secrets
import socket
from collections import Counter
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager, suppress
from pathlib import Path
from urllib.parse import urlsplit

from distributed import Client, Security

from thbridge.app.compose.machine import versions
from ui.web.pool.messages import LONGEST_LINE
from ui.web.pool.pool import HostLeft, WorkerDied
from ui.web.pool.remote import RemoteGame, keep_alive, start, unfit, warm_up
from ui.web.pool.running_games import WorkerAddress
from ui.web.pool.worker import GameRequest

CONNECT_SECONDS = 10.0
"""Seconds for the scheduler to answer."""
START_SECONDS = 30.0
"""Seconds for a host to start a game."""
WARM_SECONDS = 600.0
"""Seconds for a host to compile and load all code."""
LOOK_SECONDS = 1.0
"""Seconds between two looks at the cluster."""

_log = logging.getLogger(__name__)
_FAULTS = (OSError, ValueError, TimeoutError, TypeError, RuntimeError)
"""Errors of a scheduler that does not answer, or answers with other certificates."""


class ClusterUnfit(Exception):  # noqa: N818 - people read it as a sentence
    """The cluster cannot play games of this server. `str()` gives the reason and the remedy."""


class ClusterHosts:
    """Hosts of a Dask cluster; it implements `RemoteHosts`.

    The room of a host is the number of its Dask workers' threads, without those that carry out other tasks.

    Args:
        scheduler: address of the scheduler.
        served: folder to which the games are recorded; it has this path on all hosts.
        report: function that receives sentences about problems, for the researcher.

    Attributes:
        rooms: greatest number of games on each host at present.
    """

    def __init__(self, scheduler: str, served: Path, report: Callable[[str], None]) -> None:
        self.rooms: Mapping[str, int] = {}
        self._scheduler = scheduler
        self._served = served
        self._report = report
        self._security = Security()
        self._client: Client | None = None
        self._ready: set[str] = set()
        self._welcomes: dict[str, asyncio.Task[None]] = {}

    @asynccontextmanager
    async def watched(self) -> AsyncIterator["ClusterHosts"]:
        """Follow the hosts that join and leave inside this context."""
        watching = asyncio.create_task(self._watch())
        try:
            yield self
        finally:
            watching.cancel()
            await asyncio.gather(watching, return_exceptions=True)

    async def start(self, host: str, key: str, request: GameRequest) -> WorkerAddress | None:
        """See `RemoteHosts`."""
        worker = next((each for each in self._ready if _host(each) == host), None)
        if worker is None or self._client is None:
            self._leave(host)
            raise HostLeft
        try:
            # The scheduler may not know yet that the Dask worker has died.
            async with asyncio.timeout(CONNECT_SECONDS):
                (await _dial(host, urlsplit(worker).port or 0)).close()
        except OSError:
            self._leave(host)
            raise HostLeft from None
        game = RemoteGame(request, key, self._served)
        try:
            async with asyncio.timeout(START_SECONDS):
                started: dict[str, WorkerAddress | None] = await self._client.run(start, game, workers=[worker])
        except Exception as error:
            _log.warning("no game starts on %s: %r", worker, error)
            self._leave(host)
            raise WorkerDied from None
        return started[worker]

    def _leave(self, host: str) -> None:
        """Use a host again only after it has been welcomed again."""
        self.rooms = {each: room for each, room in self.rooms.items() if each != host}
        for worker in [each for each in self._ready if _host(each) == host]:
            self._ready.discard(worker)
            self._welcomes.pop(worker, None)

    async def connect(self, address: WorkerAddress) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        """See `RemoteHosts`."""
        place = urlsplit(address.socket)
        context = self._security.get_connection_args("client")["ssl_context"] if place.scheme == "tls" else None
        connection = await _dial(place.hostname or "", place.port or 0)
        # The context does not compare this name: certificates of a cluster need not name hosts.
        name = None if context is None else place.hostname
        return await asyncio.open_connection(sock=connection, ssl=context, server_hostname=name, limit=LONGEST_LINE)

    async def _watch(self) -> None:
        reported = False
        while True:
            try:
                async with _client(self._scheduler, self._security) as self._client:
                    while self._client.status == "running":
                        await self._look(self._client)
                        reported = False
                        await asyncio.sleep(LOOK_SECONDS)
            except Exception as error:
                _log.info("the Dask scheduler does not answer: %r", error)
            finally:
                for task in self._welcomes.values():
                    task.cancel()
                self._client, self.rooms = None, {}
                self._ready, self._welcomes = set(), {}
            if not reported:
                reported = True
                self._report(f"The Dask scheduler {self._scheduler} does not answer. Games start only on this machine.")
            await asyncio.sleep(LOOK_SECONDS)

    async def _look(self, client: Client) -> None:
        async with asyncio.timeout(CONNECT_SECONDS):
            threads: Mapping[str, int] = await client.nthreads()
            tasks: Mapping[str, tuple[str, ...]] = await client.processing()
        for worker in threads.keys() - self._welcomes.keys():
            self._welcomes[worker] = asyncio.create_task(self._welcome(client, worker))
        for worker in self._welcomes.keys() - threads.keys():
            self._welcomes.pop(worker).cancel()
            self._ready.discard(worker)
        rooms: Counter[str] = Counter()
        for worker in self._ready:
            rooms[_host(worker)] += max(threads[worker] - len(tasks.get(worker, ())), 0)
        self.rooms = rooms

    async def _welcome(self, client: Client, worker: str) -> None:
        """Prepare a Dask worker for games."""
        try:
            async with asyncio.timeout(WARM_SECONDS):
                problem = await _problem(client, self._served, worker)
                if problem:
                    self._report(f"No games are played on {problem}")
                    return
                await client.run(warm_up, workers=[worker])
            self._ready.add(worker)
        except Exception as error:
            _log.warning("no games are played on %s: %r", worker, error)
            await asyncio.sleep(CONNECT_SECONDS)
            self._welcomes.pop(worker, None)


async def check_cluster(scheduler: str, served: Path) -> None:
    """Check that the scheduler answers, and that games can be played on the hosts that are there.

    Raises:
        ClusterUnfit: they cannot.
    """
    scheme = scheduler.rpartition("://")[0]
    if scheme not in {"", "tcp", "tls"}:
        raise ClusterUnfit(f"--scheduler {scheduler}: the address must begin with tcp:// or tls://.")
    try:
        security = Security()
        if scheme == "tls" and security.get_connection_args("client")["ssl_context"] is None:
            raise ClusterUnfit(
                f"--scheduler {scheduler}: this computer has no certificate of the cluster. Name it in Dask's "
                "settings, for example in DASK_DISTRIBUTED__COMM__TLS__CLIENT__CERT; see `thbridge docs sweeps`."
            )
        async with _client(scheduler, security) as client:
            for worker in await client.nthreads():
                if problem := await _problem(client, served, worker):
                    raise ClusterUnfit(f"--scheduler {scheduler}: games cannot be played on {problem}")
    except _FAULTS as error:
        raise ClusterUnfit(
            f"No Dask scheduler answers at {scheduler} ({error}). Start a scheduler with `dask scheduler`, and workers "
            "with `dask worker ADDRESS`. If the scheduler uses TLS, begin the address with tls://, and use a "
            "certificate of the same authority; see `thbridge docs sweeps`."
        ) from None


def _client(scheduler: str, security: Security) -> Client:
    return Client(scheduler, security=security, timeout=CONNECT_SECONDS, set_as_default=False, asynchronous=True)


async def _problem(client: Client, served: Path, worker: str) -> str:
    """Return the host of a Dask worker and why games cannot be played there; empty if they can."""
    with _probe(served) as probe:
        answers = await client.run(unfit, versions(), probe, workers=[worker], on_error="return")
    problem = answers.get(worker, "")
    if isinstance(problem, ImportError):
        problem = f"{problem.name} is not installed there. Run there: pip install 'thbridge[web,cluster]'"
    elif isinstance(problem, Exception):
        raise problem
    return f"{_host(worker)}: {problem}." if problem else ""


@contextmanager
def _probe(served: Path) -> Iterator[Path]:
    """Yield a new file, which is seen on all machines that share the folder."""
    probe = served / f".shared-{secrets.token_hex(8)}"
    probe.touch(0o600)
    try:
        yield probe
    finally:
        with suppress(FileNotFoundError):
            probe.unlink()


async def _dial(host: str, port: int) -> socket.socket:
    """Return a connection that ends soon after the other machine has vanished."""
    loop = asyncio.get_running_loop()
    (family, kind, protocol, _, where), *_ = await loop.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    connection = socket.socket(family, kind, protocol)
    try:
        connection.setblocking(False)
        keep_alive(connection)
        await loop.sock_connect(connection, where)
    except BaseException:
        connection.close()
        raise
    return connection


def _host(worker: str) -> str:
    return urlsplit(worker).hostname or worker
