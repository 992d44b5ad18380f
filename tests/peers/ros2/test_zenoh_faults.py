"""A session on a ROS 2 graph over zenoh while its router, the session itself, its clients and the network fail."""

import asyncio
import os
import signal
import sys
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from itertools import count
from pathlib import Path

import pytest

from tests.peers.ros2.peer_process import PeerProcess, needs_ros2, peer, until, with_timeout, zenoh_peer
from tests.support.programs.bad_cable import HERE, BadCable, bad_cable
from tests.support.programs.ports import free_port
from tests.support.programs.processes import Program
from tests.support.programs.processes import until as wait
from tests.support.ros2.navigation_goals import goal_id, navigation_goal
from thbridge.ros2.actions import NO_ID, ActionGoalState, ActionResult, GoalInfo
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.navigate_to_pose import NAVIGATE_TO_POSE
from thbridge.ros2.qos import DEFAULT, LATCHED
from thbridge.ros2graph.sockets.action_client import GraphActionClient
from thbridge.ros2graph.sockets.zenoh import ZenohCarrier
from thbridge.ros2graph.values.graph import NodeName
from thbridge.sockets.addresses import Address

DOMAIN = 72
KILTED = Distribution.of("kilted")
GET = "rcl_interfaces/srv/GetParameters"
OPERATOR = NodeName("/", "operator")
GOALS = count(1)

pytestmark = [needs_ros2, pytest.mark.slow]


class Graph:
    """Router and session, as programs of their own."""

    def __init__(self, folder: Path, cable: BadCable | None = None) -> None:
        self.at = Address("127.0.0.1", free_port())
        by, listen = (), [str(self.at)]
        if cable is not None:
            by, listen = cable.here_by, [f"0.0.0.0:{self.at.port}", "--open-to", "10.9.0.0/24"]
        self.router = Program(folder, "ros2", "router", "--listen", *listen, by=by)
        wait("the router", lambda: "listening on" in self.router.text, [self.router])
        section = f"{{distribution: kilted, carrier: zenoh, domain: {DOMAIN}, router: '{self.at}'}}"
        (folder / "study.yaml").write_text(f"ros2: {section}\n")
        self.session = Program(folder, "simr", "study.yaml", "--server", f"127.0.0.1:{free_port()}", "--ros2", by=by)
        self.until_joined()

    def until_joined(self) -> None:
        wait("the session", lambda: "ROS 2:" in self.session.text or self.ended, [self.session])
        assert not self.ended, self.session.text

    @property
    def ended(self) -> bool:
        return self.session.process.poll() is not None

    @property
    def memory(self) -> float:
        """Resident memory of the session in megabytes."""
        pages = int(Path(f"/proc/{self.session.process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGESIZE") / 2**20

    def close(self) -> None:
        for program in (self.session, self.router):
            program.close()


@pytest.fixture
def graph(tmp_path: Path) -> Iterator[Graph]:
    made = Graph(tmp_path)
    yield made
    made.close()
    assert "Traceback" not in made.session.text + made.router.text


class Operator:
    """Node that uses all kinds of endpoints of the session."""

    def __init__(self, at: Address) -> None:
        self.carrier = ZenohCarrier(DOMAIN, at)
        self.got = dict.fromkeys(("/clock", "/robot1/map", "feedback"), 0)
        for topic, kind, qos in (
            ("/clock", "rosgraph_msgs/msg/Clock", DEFAULT),
            ("/robot1/map", "nav_msgs/msg/OccupancyGrid", LATCHED),
        ):
            self.carrier.subscribe(OPERATOR, topic, KILTED.message(kind), qos, lambda *_, name=topic: self.count(name))
        self.action = GraphActionClient(
            self.carrier,
            OPERATOR,
            "/robot1/navigate_to_pose",
            KILTED,
            NAVIGATE_TO_POSE,
            lambda goal, feedback: self.count("feedback"),
        )
        self.parameters = self.carrier.client(OPERATOR, "/robot1/amcl/get_parameters", KILTED.service(GET))

    def count(self, name: str) -> None:
        self.got[name] += 1

    def send(self, x: float) -> tuple[bytes, list[ActionResult[object]]]:
        """Send a goal; return its id, and a list that gets its result."""
        goal, results = goal_id(next(GOALS)), []

        def answered(accepted: int | None) -> None:
            assert accepted is not None
            self.action.get_result(goal, results.append)

        self.action.send_goal(goal, navigation_goal(KILTED, x), answered)
        return goal, results

    async def hears(self, name: str, number: int = 1) -> None:
        """Wait for further messages."""
        before = self.got[name]
        await until(lambda: self.got[name] >= before + number, f"{number} times {name}")

    async def call(self) -> None:
        """Call a service."""
        await until(lambda: self.parameters.has_server, "the service")
        responses: list[bytes] = []
        request = KILTED.encode(f"{GET}_Request", KILTED.make(f"{GET}_Request", names=["min_particles"]))
        self.parameters.call(request, responses.append)
        await until(lambda: responses, "the response")

    async def works(self) -> None:
        """Use a topic, a latched topic, a service and an action."""
        await self.hears("/clock", 10)
        await until(lambda: self.got["/robot1/map"], "the map")
        await self.call()
        await until(lambda: self.action.has_server, "the action server")
        goal, results = self.send(3.0)
        await self.hears("feedback", 5)
        self.action.cancel(GoalInfo(goal, 0))
        await until(lambda: results, "the result")
        assert results[0].state is ActionGoalState.CANCELED

    def seen(self) -> set[tuple[str, ...]]:
        """Return the session's graph."""
        nodes = {("node", node.whole) for node in self.carrier.nodes()}
        ends = [each for each in self.carrier.endpoints() if each.node is not None]
        found = {(each.role.value, each.name, each.type, each.hash, each.node.whole, str(each.qos)) for each in ends}
        return {each for each in nodes | found if each[-1].startswith("/robot") or each[0] != "node"}


@asynccontextmanager
async def operator(at: Address) -> AsyncIterator[Operator]:
    """Run an operator in this process."""
    made = Operator(at)
    while await made.carrier.start() is not None:
        await asyncio.sleep(0.1)
    try:
        yield made
    finally:
        await made.carrier.stop()


def killable(at: Address, by: Sequence[str] = ()) -> AbstractAsyncContextManager[PeerProcess]:
    """Run an operator in its own process, by a command."""
    return peer("zenoh_operator.py", str(at), str(DOMAIN), by=(*by, sys.executable))


async def knows_robot(other: PeerProcess) -> None:
    """Wait until a peer knows the session's endpoints."""
    while True:
        other.do("info", name="/hunt/score")
        if "thbridge" in (await other.event("info"))["nodes"]:
            return


async def count_of(other: PeerProcess, topic: str, number: int) -> int:
    """Wait until a peer has got this number of messages of a topic; return the number that it has."""
    while True:
        other.do("count")
        found = (await other.event("counts")).get(topic, 0)
        if found >= number:
            return found


@with_timeout
async def test_a_router_may_be_killed_and_restarted(graph: Graph, tmp_path: Path) -> None:
    async with operator(graph.at) as early, zenoh_peer("sdk", graph.at, DOMAIN, tmp_path) as sdk:
        await early.works()
        await knows_robot(sdk)
        before = early.seen()
        goal, results = early.send(-3.0)
        await early.hears("feedback", 3)
        graph.router.kill()
        await early.hears("/clock", 10)
        await early.hears("feedback", 3)
        graph.router = graph.router.again()
        async with operator(graph.at) as late:
            await late.works()  # This replaces the goal.
            await until(lambda: results, "the result of a goal from before")
            await until(lambda: before <= late.seen(), "the whole graph")
            assert before <= early.seen()
        await early.works()
        await knows_robot(sdk)
    assert goal
    assert graph.session.stop() == 0


@with_timeout
async def test_a_session_may_be_killed_and_restarted(graph: Graph, tmp_path: Path) -> None:
    async with operator(graph.at) as node, zenoh_peer("pyzeros", graph.at, DOMAIN, tmp_path):
        await node.works()
        before = node.seen()
        for _ in range(2):
            graph.session.kill()
            await until(lambda: not node.parameters.has_server and not node.seen() & before, "the end of the session")
            node.got["/robot1/map"] = 0
            graph.session = await asyncio.to_thread(graph.session.again)
            await asyncio.to_thread(graph.until_joined)
            await until(lambda: before <= node.seen(), "the whole graph")
            await node.works()
    assert graph.session.stop() == 0


@with_timeout
async def test_a_goal_of_a_killed_client_continues_and_others_can_cancel_it(graph: Graph) -> None:
    async with operator(graph.at) as node, killable(graph.at) as other:
        other.do("goal", id=100, x=3.0)
        await other.event("answer")
        other.kill()
        await until(lambda: NodeName("/", "killed") not in node.carrier.nodes(), "the end of the client")
        await node.hears("feedback", 10)
        results: list[ActionResult[object]] = []
        node.action.get_result(goal_id(100), results.append)
        node.action.cancel(GoalInfo(NO_ID, 0))
        await until(lambda: results, "the result")
        assert results[0].state is ActionGoalState.CANCELED
        await node.works()
    assert graph.session.stop() == 0


@with_timeout
async def test_subscribers_that_stand_still_delay_nobody(graph: Graph) -> None:
    async with operator(graph.at) as node, killable(graph.at) as other:
        await node.works()
        other.do("subscribe")
        await count_of(other, "clock", 10)
        assert await count_of(other, "robot1/scan", 1)
        before = graph.memory
        other.process.send_signal(signal.SIGSTOP)
        for _ in range(3):
            loop = asyncio.get_running_loop()
            began, heard = loop.time(), node.got["/clock"]
            await node.hears("/clock", 250)
            assert loop.time() - began < 10.0
            await node.call()
            assert node.got["/clock"] > heard
        assert graph.memory - before < 30.0
        other.process.send_signal(signal.SIGCONT)
        await count_of(other, "clock", 100 + await count_of(other, "clock", 0))
        await node.works()
    assert graph.session.stop() == 0


@with_timeout
async def test_a_client_commands_robots_over_a_lossy_network(tmp_path: Path) -> None:
    with bad_cable() as cable:
        graph = await asyncio.to_thread(Graph, tmp_path, cable)
        try:
            cable.set(0.02, 0.2)
            async with killable(Address(HERE, graph.at.port), cable.there_by) as other:
                other.do("goal", id=1, x=1.0)
                await other.event("result", status="SUCCEEDED")
                other.do("subscribe")
                await count_of(other, "robot1/map", 1)
                await count_of(other, "clock", 500)
                other.do("goal", id=2, x=2.0)
                await other.event("result", status="SUCCEEDED")
            assert graph.session.stop() == 0
        finally:
            graph.close()
        assert "Traceback" not in graph.session.text + graph.router.text
