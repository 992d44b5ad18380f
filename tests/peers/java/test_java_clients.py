"""Java programs that read lines the way those of 2016 did play a whole hunt through our server."""

import asyncio
import shutil
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.support.programs.peer_programs import run_peer, skip_if_crashed
from thbridge.files.keys.certificate import certificate_of
from thbridge.files.keys.key_ring import KeyRing
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.keys import RingKeys
from thbridge.sockets.tls import server_context
from thbridge.text_protocol.sockets.server import TextServer
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextMessage, parse_line
from thbridge.text_protocol.wire.router import MessageRouter
from thbridge.timing.wall_clock import utc_now

SOURCES = sorted(Path(__file__).parent.glob("*.java"))
PATIENCE = 120  # seconds until a hunt that hangs gives up
TREASURES = ["3:Orange:Round and Large:10:Orange Bottle:rsz_t1.jpg", "5:Blue:Square:20:Blue Bottle:rsz_t2.jpg"]

SimR = Callable[[ListeningAddress], AbstractAsyncContextManager[None]]
"""A program that drives the robots, running and registered at this address while the context lasts."""

pytestmark = pytest.mark.skipif(
    shutil.which("javac") is None or shutil.which("java") is None, reason="no JDK: javac and java are not installed"
)


@pytest.fixture(scope="module")
def classes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The compiled programs."""
    folder = tmp_path_factory.mktemp("java")
    done = run_peer(["javac", "-encoding", "UTF-8", "-Xlint:all", "-Werror", "-d", folder, *SOURCES])
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@asynccontextmanager
async def scripted_simr(address: ListeningAddress) -> AsyncIterator[None]:
    """A SimR of which every robot is where it is sent at once; plain lines on the wire, as in 2016."""
    reader, writer = await asyncio.open_connection(address.host, address.port)
    writer.write(b"%%setid SimR \r\n")
    assert await reader.readline() == b"%%ack \n"

    async def drive() -> None:
        while line := await reader.readline():
            message = parse_line(line.decode())
            if isinstance(message, TextMessage):
                goto = legacy.decode(message)
                assert isinstance(goto, legacy.GotoRoom)
                writer.write(f'%%error SimR TabUI "{goto.robot};{goto.room}"\n'.encode())

    driving = asyncio.create_task(drive())
    try:
        yield
    finally:
        writer.close()
        await driving


@dataclass(frozen=True)
class Understood:
    """What the two Java programs printed, and how TabUI ended."""

    tabui: list[str]
    hider: list[str]
    status: int


async def hunt(classes: Path, simr: SimR, visits: list[str]) -> Understood:
    """One game of the Java TabUI and Hider with the given SimR through our server, which takes keys besides."""
    ring = KeyRing(classes / "keys", utc_now)
    server = TextServer(keys=RingKeys(ring, server_context(certificate_of(ring.folder, utc_now()))))
    address = await server.start(MessageRouter(), "127.0.0.1", 0)
    assert isinstance(address, ListeningAddress)

    async def java(program: str, *args: str) -> asyncio.subprocess.Process:
        # A small heap and the first compiler only: these programs live for a second.
        options = ["-Xshare:auto", "-XX:TieredStopAtLevel=1", "-Xmx32m", "-cp", str(classes)]
        return await asyncio.create_subprocess_exec(
            "java", *options, program, address.host, str(address.port), *args, stdout=asyncio.subprocess.PIPE
        )

    async with asyncio.timeout(PATIENCE):
        hider = await java("Hider", *TREASURES)
        assert hider.stdout is not None
        assert await hider.stdout.readline() == b"acknowledged\n"
        async with simr(address):
            tabui = await java("TabUi", *visits)
            tabui_said, _ = await tabui.communicate()
        await server.stop()
        hider_said, _ = await hider.communicate()
    for program, ended in (("Hider", hider), ("TabUi", tabui)):
        skip_if_crashed(f"java {program}", ended.returncode)
    assert hider.returncode == 0
    return Understood(
        tabui_said.decode().splitlines(),
        [line for line in hider_said.decode().splitlines() if line != "acknowledged"],
        tabui.returncode if tabui.returncode is not None else -1,
    )


@pytest.mark.parametrize("simr", [scripted_simr])
def test_a_hunt_of_the_old_programs(classes: Path, simr: SimR) -> None:
    understood = asyncio.run(hunt(classes, simr, ["0:3:Orange Bottle", "1:5:Pink can"]))
    assert understood == Understood(
        tabui=[
            "reached robot=0 room=3",
            "found room=3 [Colour: Orange Footprint: Round and Large]",
            "image room=3 [rsz_t1.jpg]",
            "score 10",
            "reached robot=1 room=5",
            "found room=5 [Colour: Blue Footprint: Square]",
            "image room=5 [rsz_t2.jpg]",
            "score -20",
            "total -10",
        ],
        hider=[
            "asked room=3",
            "snapped room=3",
            "identified room=3 name=Orange Bottle",
            "asked room=5",
            "snapped room=5",
            "identified room=5 name=Pink can",
        ],
        status=0,
    )
