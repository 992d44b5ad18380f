"""Games on another machine: what a Dask worker runs there for the gateway.

A Dask worker only starts games. A warm program of its own forks a process for each game; this process outlives the Dask
worker, and the gateway connects to it directly.
"""

import asyncio
import logging
import os
import pickle
import socket
import ssl
import subprocess
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import IO, Protocol, cast
from urllib.parse import urlsplit

from thbridge.app.compose.machine import versions
from ui.web.pool.messages import LONGEST_LINE
from ui.web.pool.running_games import RunningGames, WorkerAddress
from ui.web.pool.worker import GameRequest, ServeGateway, work

ADDRESS_TIMEOUT = 20.0
"""Seconds for a started game to write its address."""
_LOOK = 0.02
_KEEPALIVE = (
    (socket.TCP_KEEPIDLE, 4),
    (socket.TCP_KEEPINTVL, 3),
    (socket.TCP_KEEPCNT, 3),
    (socket.TCP_USER_TIMEOUT, 12_000),
)
"""A connection to a machine that does not answer any more ends after about 12 s."""


class TlsSettings(Protocol):
    """Certificates of a Dask cluster: `distributed.Security`, which can be pickled."""

    def get_listen_args(self, role: str) -> Mapping[str, ssl.SSLContext | None]:
        """Return the arguments for a listening socket, with the key `ssl_context`."""


class DaskWorker(Protocol):
    """Dask worker: `distributed.Worker`."""

    @property
    def address(self) -> str:
        """Address of the Dask worker, such as `tls://10.0.0.2:41234`."""

    @property
    def security(self) -> TlsSettings:
        """Certificates of the Dask worker."""


@dataclass(frozen=True, slots=True)
class RemoteGame:
    """Game that a machine starts for a gateway on another one.

    Attributes:
        request: the game.
        key: its key.
        served: folder to which the gateway records; it has this path on all machines.
    """

    request: GameRequest
    key: str
    served: Path

    @property
    def running(self) -> RunningGames:
        """Running games of the gateway on this machine. The gateway itself may also be here."""
        return RunningGames(RunningGames.of(self.served).folder / "remote")


def keep_alive(connection: socket.socket) -> None:
    """Let a connection end soon after the other machine has vanished; accepted connections inherit this."""
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in _KEEPALIVE:
        connection.setsockopt(socket.IPPROTO_TCP, option, value)


def unfit(expected: Mapping[str, str], probe: Path) -> str:
    """Return why games of a gateway cannot be played on this machine; empty if they can.

    Args:
        expected: versions of the gateway's programs. A game resumes only with the same versions.
        probe: file that the gateway has just written to the study's folder.
    """
    here = versions()
    for name in sorted({*expected, *here}):
        if here.get(name) != expected.get(name):
            return (
                f"{name} is {here.get(name, 'not installed')} there, and {expected.get(name, 'not installed')} here. "
                "Install the same versions on all machines"
            )
    if not probe.exists():
        return f"{probe.parent} is another folder there, or missing. Share the folder under the same path"
    if not os.access(probe.parent, os.W_OK):
        return f"{probe.parent} cannot be written there. Start its Dask workers from the account of this server"
    return ""


class _WarmProgram:
    """Program of this Dask worker that forks a process for each game."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None

    def send(self, message: object) -> None:
        """Send a message to the program, which is started if necessary, and wait until it has acted on it."""
        with self._lock:
            if self._process is None or self._process.poll() is not None:
                command = [sys.executable, "-c", f"from {__name__} import main; main()"]
                self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            requests, answers = cast("IO[bytes]", self._process.stdin), cast("IO[bytes]", self._process.stdout)
            pickle.dump(message, requests)
            requests.flush()
            if not answers.readline():
                raise OSError("the program that starts games has ended")


_warm = _WarmProgram()


async def warm_up() -> None:
    """Compile what is missing on this machine, and load all code."""
    await asyncio.to_thread(_warm.send, None)


async def start(game: RemoteGame, dask_worker: DaskWorker) -> WorkerAddress | None:
    """Start a game on this machine, unless it is running; return the address of its worker, or None if it has none.

    Args:
        game: the game.
        dask_worker: Dask worker of this process, which Dask fills in.
    """
    running, place = game.running, urlsplit(dask_worker.address)
    if not running.is_running(game.key):
        await asyncio.to_thread(running.tidy)
        tls = dask_worker.security if place.scheme == "tls" else None
        await asyncio.to_thread(_warm.send, (game, place.hostname, tls))
    with suppress(TimeoutError):
        async with asyncio.timeout(ADDRESS_TIMEOUT):
            while running.is_running(game.key):
                if (address := running.address(game.key)) is not None:
                    return address
                await asyncio.sleep(_LOOK)
    return None


async def _open(host: str, tls: TlsSettings | None, serve: ServeGateway) -> tuple[asyncio.Server, str]:
    """Open a socket for the gateway. If the cluster encrypts, the gateway must have a certificate of the cluster."""
    listening = socket.create_server((host, 0), family=socket.AF_INET6 if ":" in host else socket.AF_INET)
    keep_alive(listening)
    context = None if tls is None else tls.get_listen_args("worker")["ssl_context"]
    server = await asyncio.start_server(serve, sock=listening, ssl=context, limit=LONGEST_LINE)
    shown = f"[{host}]" if ":" in host else host
    return server, f"{'tcp' if tls is None else 'tls'}://{shown}:{listening.getsockname()[1]}"


def main() -> None:
    """Fork a process for each game on the standard input, until it ends."""
    logging.basicConfig()
    # What games print goes to the terminal of the Dask worker.
    answers = os.fdopen(os.dup(1), "wb", buffering=0)
    os.dup2(2, 1)
    with suppress(EOFError):
        while True:
            # The other end is the program that has started this one.
            message: tuple[RemoteGame, str, TlsSettings | None] | None = pickle.load(sys.stdin.buffer)
            if message is None:
                import_module("ui.web.pool.warm")
            else:
                _fork(*message)
            answers.write(b"\n")


def _fork(game: RemoteGame, host: str, tls: TlsSettings | None) -> None:
    child = os.fork()
    if child == 0:
        try:
            nothing = os.open(os.devnull, os.O_RDONLY)
            os.dup2(nothing, 0)
            work(game.request, game.running.folder, game.key, partial(_open, host, tls))
        except BaseException:
            logging.exception("the game %s has ended unexpectedly", game.key)
        finally:
            sys.stderr.flush()
            os._exit(0)
    os.waitpid(child, 0)
