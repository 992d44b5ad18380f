"""Programs of zenoh-ros2-sdk and pyzeros as peers: each runs in its own process, and is driven by lines of JSON."""

import asyncio
import functools
import json
import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from tests.support.programs.peer_programs import run_peer
from tests.support.project import ROOT

PYTHON = ROOT / ".peers" / "ros2" / "bin" / "python"
SCRIPTS = {"sdk": "zenoh_sdk_peer.py", "pyzeros": "pyzeros_peer.py"}
TIMEOUT = 60.0

CACHE = PYTHON.parents[1] / "cydr_cache"
"""Folder for code that pyzeros compiles."""

needs_ros2 = pytest.mark.skipif(not PYTHON.exists(), reason=f"not installed: {PYTHON} (see scripts/install_peers.sh)")


class ZenohPeer:
    """A peer. Its events wait in order; those that a test does not wait for are dropped."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        assert process.stdin is not None
        assert process.stdout is not None
        self.process, self._commands, self._events = process, process.stdin, process.stdout

    def do(self, command: str, **arguments: object) -> None:
        """Send a command."""
        self._commands.write(json.dumps({"do": command, **arguments}).encode() + b"\n")

    async def event(self, kind: str) -> dict:
        """Wait for an event."""
        async with asyncio.timeout(TIMEOUT):
            while line := await self._events.readline():
                if (found := json.loads(line))["event"] == kind:
                    return found
        pytest.fail(f"the peer ended without the event {kind!r}")


def _environment() -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if name not in {"PYTHONPATH", "PYTHONHOME"}}
    return kept | {"CYDR_CACHE_DIR": str(CACHE)}


@functools.cache
def compile_pyzeros() -> None:
    """Let pyzeros compile its code for attachments; the first time, this takes half a minute."""
    code = "from pyzeros.builtin_msgs import Attachment; Attachment.deserialize(Attachment().serialize())"
    run_peer([PYTHON, "-c", code], env=_environment()).check_returncode()


@asynccontextmanager
async def zenoh_peer(library: str, port: int, domain: int, folder: Path) -> AsyncIterator[ZenohPeer]:
    """Run a peer at the router with this port. It may write files into the folder."""
    process = await asyncio.create_subprocess_exec(
        *(str(PYTHON), str(Path(__file__).with_name(SCRIPTS[library])), str(port), str(domain)),
        env=_environment(),
        cwd=folder,
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
    )
    started = ZenohPeer(process)
    try:
        await started.event("ready")
        yield started
    finally:
        if process.returncode is None:
            process.kill()
        await process.wait()
