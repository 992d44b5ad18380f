"""A session on a ROS 2 graph while programs are killed and restarted, clocks jump, and the session stands still."""

import asyncio
import os
import signal
import struct
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from tests.peers.ros2.peer_process import DOMAIN, PeerProcess, joined, needs_ros2, peer
from tests.peers.ros2.peer_process import until as eventually
from tests.support.programs.jumping_clock import JUMPS, LIBRARY, Clock
from tests.support.programs.ports import free_domain, free_port
from tests.support.programs.processes import Program, until
from thbridge.ros2graph.sockets.dds import DdsCarrier

CLOCK = ("/clock", "rosgraph_msgs/msg/Clock", (10, False, False))
MAP = ("/robot1/map", "nav_msgs/msg/OccupancyGrid", (1, True, True))

pytestmark = [needs_ros2, pytest.mark.slow]


def robots(folder: Path, environment: dict[str, str] | None = None, domain: int = DOMAIN) -> Program:
    """Start robots, and wait until they are on the graph."""
    options = ("simr", "--server", f"127.0.0.1:{free_port()}", "--ros2", "--ros2-domain", str(domain))
    program = Program(folder, *options, environment=environment or dict(os.environ))
    until("the session to join", lambda: "ROS 2:" in program.text or program.process.poll() is not None, [program])
    return program


@pytest.fixture
def session(tmp_path: Path) -> Iterator[Program]:
    program = robots(tmp_path)
    yield program
    program.close()


@asynccontextmanager
async def listener() -> AsyncIterator[PeerProcess]:
    """Run a node that reports the clock and the map."""
    async with peer("rclpy_peer.py", "listener", "/") as node:
        for topic, kind, qos in (CLOCK, MAP):
            node.do("subscribe", topic=topic, type_name=kind, qos=qos)
        yield node


def simulated(message: dict) -> float:
    """Return the time of a message on the clock, seconds."""
    seconds, nanoseconds = struct.unpack("<4xiI", bytes.fromhex(message["data"]))
    return seconds + nanoseconds / 1e9


def participants(carrier: DdsCarrier) -> int:
    """Return the number of other participants with endpoints."""
    return len({each.gid[:12] for each in carrier.endpoints()})


def memory(program: Program) -> float:
    """Return the resident memory of a program in megabytes."""
    pages = int(Path(f"/proc/{program.process.pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGESIZE") / 2**20


def test_a_node_may_be_killed_and_restarted_twenty_times(session: Program) -> None:
    async def scenario() -> None:
        used = []
        for _ in range(20):
            async with listener() as node:
                await node.event("message", topic=MAP[0])  # It joins late, and the topic is latched.
                await node.event("message", topic=CLOCK[0])
                node.kill()
            used.append(memory(session))
        assert used[-1] - used[4] < 15.0, used

    asyncio.run(scenario())
    assert session.stop() == 0
    assert "Traceback" not in session.text


def test_killed_nodes_are_forgotten_after_their_lease() -> None:
    async def scenario() -> None:
        async with joined(DdsCarrier(DOMAIN)) as carrier:
            for count in range(1, 6):
                # Each process is another participant.
                async with peer("rclpy_peer.py", "victim", "/") as node:
                    await eventually(lambda: participants(carrier) == count, "the node")  # noqa: B023 - called at once
                    node.kill()
            await eventually(carrier.nodes, "the name of a node")
            assert len(carrier.nodes()) == 1
            await eventually(lambda: not carrier.endpoints(), "the end of the leases")
            assert not carrier.nodes()

    asyncio.run(scenario())


@pytest.mark.parametrize("seconds", [15.0, 25.0])
def test_a_session_that_stood_still_goes_on(session: Program, seconds: float) -> None:
    """The lease of a participant is 20 s. Without it, both forget each other, and meet again."""

    async def scenario() -> None:
        async with listener() as node:
            await node.event("message", topic=CLOCK[0])
            session.process.send_signal(signal.SIGSTOP)
            await asyncio.sleep(seconds)
            session.process.send_signal(signal.SIGCONT)
            resumed = time.monotonic()
            last = simulated(await node.event("message", topic=CLOCK[0]))
            # What arrived before is read first. Then the clock goes on.
            while simulated(await node.event("message", topic=CLOCK[0])) < last + 2.0:
                pass
            assert time.monotonic() - resumed < 8.0
            while True:
                node.do("graph", node="bt_navigator", namespace="/robot1", topics=[])
                if (await node.event("graph")).get("services"):
                    break
            async with listener() as other:
                await other.event("message", topic=MAP[0])

    asyncio.run(scenario())
    assert session.stop() == 0


@pytest.mark.skipif(LIBRARY is None, reason="libfaketime is not installed (see scripts/install_peers.sh)")
def test_jumps_of_the_clock_do_not_disturb_the_graph(tmp_path: Path) -> None:
    clock = Clock(tmp_path)
    program = robots(tmp_path, clock.environment)

    async def scenario() -> None:
        async with listener() as node:
            await node.event("message", topic=MAP[0])
            for offset in JUMPS:
                clock.jump(offset)
                end = time.monotonic() + 3.0
                while time.monotonic() < end:
                    await node.event("message", topic=CLOCK[0])
                async with listener() as other:
                    await other.event("message", topic=MAP[0])

    try:
        asyncio.run(scenario())
        assert program.stop() == 0
    finally:
        program.close()
    assert "Traceback" not in program.text


def test_a_second_session_in_the_same_domain_ends_before_anything_starts(session: Program, tmp_path: Path) -> None:
    second, other = tmp_path / "second", tmp_path / "other"
    for folder in (second, other):
        folder.mkdir()
    rival = robots(second)
    try:
        assert rival.process.wait(60) == 2
        assert "/robot1/amcl" in rival.text
        assert not [*second.glob("*.bag*"), *second.glob("bags/*")]
    finally:
        rival.close()
    elsewhere = robots(other, domain=free_domain())
    try:
        assert elsewhere.process.poll() is None
    finally:
        elsewhere.close()
    assert session.process.poll() is None
