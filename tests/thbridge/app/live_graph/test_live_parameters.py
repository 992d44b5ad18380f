"""Parameters of robots on a graph: parameter server and dynamic_reconfigure show the same, whoever turns them."""

import asyncio
import struct
from collections.abc import Callable, Coroutine
from copy import deepcopy
from dataclasses import replace

import pytest

from sim.parameters import RobotParameters
from tests.support.ros.service_client import call_service
from thbridge.app.live_graph.live_parameters import LiveParameters
from thbridge.app.live_graph.rate_limiter import REQUESTS_PER_TICK, RateLimiter
from thbridge.app.live_graph.typed_node import TypedNode
from thbridge.files.ros.definitions import Definitions
from thbridge.roles.shared.robot_requests import Request, SetParameters
from thbridge.ros.messages import types
from thbridge.ros.messages.types import service_type
from thbridge.rosgraph.sockets.master_server import MasterServer
from thbridge.rosgraph.sockets.node import NodeStarted, RosNode
from thbridge.rosgraph.wire.links import ServiceFailed
from thbridge.sockets.addresses import ListeningAddress

PATIENCE = 120.0
AMCL = "/robot2/amcl"
BODY = ((0.25, 0.25), (-0.25, 0.25), (-0.25, -0.25), (0.25, -0.25))


class Beside:
    """Two robots' parameters at a master of ours, and a client that turns them and looks."""

    def __init__(
        self,
        master: MasterServer,
        client: RosNode,
        door: RateLimiter,
        asks: list[tuple[str, Request]],
        ours: LiveParameters,
    ) -> None:
        self.ours = ours
        self.master = master
        self.door = door
        self.asks = asks
        self._client = client
        self.configs: dict[str, bytes] = {}

    def hear(self, *servers: str) -> None:
        for server in servers:
            topic = f"{server}/parameter_updates"
            self._client.subscribe(topic, types.CONFIG, "*", lambda data, _, s=server: self.configs.update({s: data}))

    def value(self, server: str, name: str) -> object:
        """As parameter_updates said it last; None before it said anything."""
        data = self.configs.get(server)
        if data is None:
            return None
        config = types.typestore().deserialize_ros1(data, "dynamic_reconfigure/msg/Config")
        rows = [*config.bools, *config.ints, *config.strs, *config.doubles]
        return {row.name: row.value for row in rows}[name]

    def param(self, key: str) -> object:
        return deepcopy(self.master.call("getParam", "/somebody", key).value)

    def set_param(self, key: str, value: object) -> None:
        self.master.call("setParam", "/somebody", key, value)

    async def reconfigure(self, server: str, **doubles: float) -> bytes | ServiceFailed:
        rows = b"".join(
            struct.pack("<I", len(name)) + name.encode() + struct.pack("<d", value) for name, value in doubles.items()
        )
        request = bytes(12) + struct.pack("<I", len(doubles)) + rows + bytes(4)
        return await self.call(server, request)

    async def call(self, server: str, request: bytes) -> bytes | ServiceFailed:
        md5 = service_type(types.RECONFIGURE).md5
        return await call_service(self.master.uri, f"{server}/set_parameters", md5, request)

    async def until(self, true: Callable[[], bool]) -> None:
        while not true():
            await asyncio.sleep(0.005)


def beside(test: Callable[[Beside], Coroutine[None, None, None]]) -> None:
    async def run() -> None:
        async with asyncio.timeout(PATIENCE):
            master = MasterServer(port=0)
            assert isinstance(await master.start(), ListeningAddress)
            asks: list[tuple[str, Request]] = []
            ours, client = RosNode("/ours", master.uri), RosNode("/client", master.uri)
            door = RateLimiter()
            parameters = LiveParameters(
                TypedNode(ours, Definitions(())),
                [RobotParameters()] * 2,
                BODY,
                door,
                lambda sender, what: asks.append((sender, what)),
            )
            for node in (ours, client):
                assert isinstance(await node.start(), NodeStarted)
                await node.registered()
            graph = Beside(master, client, door, asks, parameters)
            try:
                await test(graph)
            finally:
                for node in (client, ours):
                    await node.stop()
                await graph.master.stop()

    asyncio.run(run())


def test_what_a_client_of_dynamic_reconfigure_turns_is_asked_of_its_robot_and_told_to_all() -> None:
    async def test(graph: Beside) -> None:
        graph.hear(AMCL, "/robot1/amcl")
        await graph.until(lambda: graph.value(AMCL, "kld_err") == 0.05)
        answer = await graph.reconfigure(AMCL, kld_err=0.25, laser_z_hit=7.0)
        assert graph.asks == [
            (f"{AMCL}/set_parameters", SetParameters(1, (("amcl.kld_err", 0.25), ("amcl.laser_z_hit", 1.0))))
        ]
        await graph.until(lambda: graph.value(AMCL, "kld_err") == 0.25)
        assert answer == graph.configs[AMCL]
        await graph.until(lambda: graph.param(f"{AMCL}/laser_z_hit") == 1.0)
        assert graph.param(f"{AMCL}/kld_err") == 0.25
        assert graph.value("/robot1/amcl", "kld_err") in {None, 0.05}
        assert graph.param("/robot1/amcl/kld_err") == 0.05

    beside(test)


def test_what_is_set_on_the_parameter_server_is_told_by_dynamic_reconfigure() -> None:
    async def test(graph: Beside) -> None:
        layer = "/robot1/move_base/local_costmap/inflation_layer"
        graph.hear("/robot1/amcl", layer)
        graph.set_param("/robot1", {"amcl": {"kld_err": 0.3}, "move_base": {}})
        await graph.until(lambda: graph.value("/robot1/amcl", "kld_err") == 0.3)
        graph.set_param(f"{layer}/inflation_radius", 1.25)
        await graph.until(lambda: graph.value(layer, "inflation_radius") == 1.25)
        assert [ask for _, ask in graph.asks] == [
            SetParameters(0, (("amcl.kld_err", 0.3),)),
            SetParameters(0, (("local_costmap.inflation_layer.inflation_radius", 1.25),)),
        ]

    beside(test)


def test_what_others_turn_is_told_to_all_and_what_was_asked_of_the_dead_is_taken_back() -> None:
    async def test(graph: Beside) -> None:
        graph.hear(AMCL)
        asked = await graph.reconfigure(AMCL, kld_err=0.25)
        assert isinstance(asked, bytes)
        software = RobotParameters()
        turned = replace(software, amcl=replace(software.amcl, laser_z_hit=0.75))
        graph.ours.follow((software, turned))
        await graph.until(lambda: graph.value(AMCL, "laser_z_hit") == 0.75)
        assert graph.value(AMCL, "kld_err") == 0.05
        await graph.until(lambda: graph.param(f"{AMCL}/laser_z_hit") == 0.75)
        assert graph.param(f"{AMCL}/kld_err") == 0.05
        assert len(graph.asks) == 1
        await graph.reconfigure(AMCL, laser_z_hit=0.95)  # As it was in the beginning, and is not any more.
        assert graph.asks[1:] == [(f"{AMCL}/set_parameters", SetParameters(1, (("amcl.laser_z_hit", 0.95),)))]

    beside(test)


def test_what_cannot_be_together_is_kept_and_the_answer_says_so(caplog: pytest.LogCaptureFixture) -> None:
    async def test(graph: Beside) -> None:
        planner = "/robot1/move_base/TrajectoryPlannerROS"
        before = await graph.reconfigure(planner)
        answer = await graph.reconfigure(planner, min_vel_x=3.0, sim_time=2.5)  # above max_vel_x
        assert graph.asks == [
            (f"{planner}/set_parameters", SetParameters(0, (("TrajectoryPlannerROS.sim_time", 2.5),)))
        ]
        assert isinstance(before, bytes)
        assert answer == before.replace(struct.pack("<d", 1.7), struct.pack("<d", 2.5))

    beside(test)
    assert "/robot1/move_base/TrajectoryPlannerROS/min_vel_x keeps its value" in caplog.text


def test_a_request_that_is_none_fails_and_changes_nothing() -> None:
    async def test(graph: Beside) -> None:
        assert isinstance(await graph.call(AMCL, b"\xff\xff\xff\xff"), ServiceFailed)
        assert graph.asks == []

    beside(test)


def test_a_master_that_is_started_again_hears_what_the_parameters_are_now() -> None:
    async def test(graph: Beside) -> None:
        await graph.reconfigure(AMCL, kld_err=0.25)
        graph.set_param(f"{AMCL}/laser_z_hit", 0.5)
        await graph.until(lambda: len(graph.asks) == 2)
        port = int(graph.master.uri.rstrip("/").rpartition(":")[2])
        await graph.master.stop()
        graph.master = MasterServer(port=port)
        assert isinstance(await graph.master.start(), ListeningAddress)
        # They are told one after the other.
        await graph.until(lambda: graph.param(f"{AMCL}/laser_z_hit") == 0.5)
        await graph.until(lambda: graph.param(f"{AMCL}/kld_err") == 0.25)

    beside(test)


def test_who_turns_too_often_between_two_ticks_is_not_heard_until_the_next() -> None:
    async def test(graph: Beside) -> None:
        values = [0.1 * (number + 1) for number in range(REQUESTS_PER_TICK)]
        answers = [await graph.reconfigure(AMCL, kld_err=value) for value in (*values, 0.05)]
        assert [isinstance(answer, ServiceFailed) for answer in answers] == [False] * REQUESTS_PER_TICK + [True]
        assert len(graph.asks) == REQUESTS_PER_TICK
        name = "/robot1/amcl/kld_err"
        for number, value in enumerate(values):
            graph.set_param(name, value)
            await graph.until(lambda heard=REQUESTS_PER_TICK + number + 1: len(graph.asks) == heard)
        graph.set_param(name, 0.05)
        await graph.until(lambda: graph.param(name) == values[-1])  # put back
        assert len(graph.asks) == 2 * REQUESTS_PER_TICK
        graph.door.tick()
        assert not isinstance(await graph.reconfigure(AMCL, kld_err=0.05), ServiceFailed)

    beside(test)


def test_what_was_dumped_can_be_loaded_again_and_changes_nothing(caplog: pytest.LogCaptureFixture) -> None:
    async def test(graph: Beside) -> None:
        await graph.until(lambda: graph.param("/robot1/amcl/kld_err") == 0.05)
        dump = graph.param("/robot1")
        assert isinstance(dump, dict)
        graph.set_param("/robot1", dump)
        for node, values in dump.items():
            graph.set_param(f"/robot1/{node}", values)
        graph.set_param("/robot1/amcl/kld_err", 0.5)
        await graph.until(lambda: len(graph.asks) == 1)
        assert graph.asks[0][1] == SetParameters(0, (("amcl.kld_err", 0.5),))
        await graph.until(lambda: graph.param("/robot1/amcl/kld_err") == 0.5)
        dump["amcl"]["kld_err"] = 0.5
        assert graph.param("/robot1") == dump

    beside(test)
    assert "keeps its value" not in caplog.text


def test_a_changed_dump_changes_what_can_change_and_the_rest_is_put_back(caplog: pytest.LogCaptureFixture) -> None:
    async def test(graph: Beside) -> None:
        await graph.until(lambda: graph.param("/robot1/amcl/kld_err") == 0.05)
        dump = graph.param("/robot1")
        assert isinstance(dump, dict)
        before = graph.param("/robot1")
        dump["amcl"]["kld_err"] = 0.3
        dump["amcl"]["odom_frame_id"] = "wheels"
        dump["move_base"]["local_costmap"]["plugins"] = []
        dump["somebody"] = {"elses": 1}
        graph.set_param("/robot1", dump)
        await graph.until(lambda: graph.param("/robot1/amcl/odom_frame_id") == "robot1/odom")
        await graph.until(lambda: graph.param("/robot1/move_base/local_costmap/plugins") != [])
        assert [ask for _, ask in graph.asks] == [SetParameters(0, (("amcl.kld_err", 0.3),))]
        before["amcl"]["kld_err"] = 0.3  # type: ignore[index]
        assert graph.param("/robot1") == {**before, "somebody": {"elses": 1}}  # type: ignore[dict-item]

    beside(test)
    assert "/robot1/amcl/odom_frame_id keeps its value" in caplog.text
    assert "/robot1/move_base/local_costmap/plugins keeps its value" in caplog.text


def test_a_footprint_that_is_set_is_the_robots_from_then_on() -> None:
    async def test(graph: Beside) -> None:
        name = "/robot1/move_base/local_costmap/footprint"
        await graph.until(lambda: graph.param(name) == [list(corner) for corner in BODY])
        smaller = [[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]]
        graph.set_param(name, smaller)
        await graph.until(lambda: len(graph.asks) == 1)
        await graph.until(lambda: graph.param(name) == smaller)

    beside(test)
