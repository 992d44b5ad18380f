"""Programs of ROS 2 over DDS or zenoh as peers: they run in their own processes, driven by lines of JSON."""

import asyncio
import functools
import json
import os
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path

import pytest

from tests.support.programs.ports import free_domain
from tests.support.project import ROOT
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.sockets.addresses import Address

ROS2 = ROOT / ".peers" / "ros2"
PYTHON = ROS2 / "bin" / "python"
FOLDER = Path(__file__).parent
DOMAIN = free_domain()
"""Domain of this process's tests, so that tests of other processes do not take part."""
TIMEOUT = 60.0
ZENOH_PEERS = {"sdk": "zenoh_sdk_peer.py", "pyzeros": "pyzeros_peer.py"}
"""Scripts of nodes that use a library of ROS 2 over zenoh."""

needs_ros2 = pytest.mark.skipif(not PYTHON.exists(), reason=f"not installed: {PYTHON} (see scripts/install_peers.sh)")


def with_timeout(test: Callable[..., Awaitable[None]]) -> Callable[..., None]:
    """Run a test's coroutine, but not for ever."""

    @functools.wraps(test)
    def run(*args, **kwargs) -> None:
        async def limited() -> None:
            async with asyncio.timeout(2 * TIMEOUT):
                await test(*args, **kwargs)

        asyncio.run(limited())

    return run


async def until(happens: Callable[[], object], what: str) -> None:
    """Wait for an event of this process."""
    try:
        async with asyncio.timeout(TIMEOUT):
            while not happens():
                await asyncio.sleep(0.005)
    except TimeoutError:
        pytest.fail(f"it did not happen within {TIMEOUT:g} s: {what}")


class PeerProcess:
    """A peer. Its events wait in order; those that a test does not wait for are dropped."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self.process = process

    def do(self, command: str, **arguments: object) -> None:
        """Send a command."""
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps({"do": command, **arguments}).encode() + b"\n")

    async def event(self, kind: str, **fields: object) -> dict:
        """Wait for an event with these fields."""
        assert self.process.stdout is not None
        async with asyncio.timeout(TIMEOUT):
            while line := await self.process.stdout.readline():
                found = json.loads(line)
                if found["event"] == kind and all(found[name] == value for name, value in fields.items()):
                    return found
        pytest.fail(f"the peer ended without the event {kind!r}")

    def kill(self) -> None:
        """End it without a farewell."""
        self.process.kill()

    async def end(self) -> None:
        """End it, as its user would."""
        if self.process.returncode is None:
            assert self.process.stdin is not None
            self.process.stdin.close()
            async with asyncio.timeout(TIMEOUT):
                await self.process.wait()


def environment(domain: int | str, discovery: str = "LOCALHOST") -> dict[str, str]:
    """Return the environment of a peer. `discovery` is its automatic discovery range on DDS."""
    kept = {name: value for name, value in os.environ.items() if name not in {"PYTHONPATH", "PYTHONHOME"}}
    own = {"ROS_DOMAIN_ID": str(domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": discovery}
    # scripts/install_peers.sh fills this folder with code that pyzeros compiles.
    return {**kept, **own, "CYDR_CACHE_DIR": str(ROS2 / "cydr_cache")}


@asynccontextmanager
async def peer(
    script: str,
    *arguments: str,
    discovery: str = "LOCALHOST",
    folder: Path | None = None,
    by: Sequence[str] = (str(PYTHON),),
) -> AsyncIterator[PeerProcess]:
    """Run a peer by a command. It may write files into the folder."""
    process = await asyncio.create_subprocess_exec(
        *by,
        str(FOLDER / script),
        *arguments,
        env=environment(DOMAIN, discovery),
        cwd=folder,
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        limit=4 << 20,
    )
    started = PeerProcess(process)
    try:
        await started.event("ready")
        yield started
    finally:
        if process.returncode is None:
            process.kill()
        await process.wait()


def zenoh_peer(library: str, router: Address, domain: int, folder: Path) -> AbstractAsyncContextManager[PeerProcess]:
    """Run a node of a library for zenoh."""
    return peer(ZENOH_PEERS[library], str(router.port), str(domain), folder=folder)


@asynccontextmanager
async def joined(carrier: DdsCarrier) -> AsyncIterator[DdsCarrier]:
    """Join the domain."""
    assert await carrier.start() is None
    try:
        yield carrier
    finally:
        await carrier.stop()


def padded(message: bytes) -> bytes:
    """DDS transports messages in words of four bytes."""
    return message + bytes(-len(message) % 4)
