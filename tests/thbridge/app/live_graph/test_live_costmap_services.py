"""Services of costmaps, and is_path_valid, as a client of a graph uses them, with the types of each distribution."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.inputs import ClearCostmapRegion
from sim.robot.costmap.costs import INSCRIBED, LETHAL, UNKNOWN
from sim.robot.costmap.robot_costmap import RobotCostmap
from sim.robot.costmap.view import CostmapName
from tests.support.ros2.loopback import LoopbackGraph
from thbridge.app.live_graph.live_costmap_services import LiveCostmapServices
from thbridge.app.live_graph.rate_limiter import REQUESTS_PER_TICK, RateLimiter
from thbridge.roles.shared.robot_requests import Request
from thbridge.ros2 import costmap_services as services
from thbridge.ros2.action_messages import pose_stamped_of
from thbridge.ros2.distribution import Distribution
from thbridge.ros2graph.sockets.parameter_services import NodeServices
from thbridge.ros2graph.values.graph import NodeName

CLIENT = NodeName("/", "client")
SQUARE = np.array([[0.05, 0.05], [-0.05, 0.05], [-0.05, -0.05], [0.05, -0.05]])
AROUND = "nav2_msgs/srv/ClearCostmapAroundRobot"


class OneRobot:
    """A robot whose costmap has a row of 40 cells of 0.1 m, each with its own cost."""

    def __init__(self, distribution: str, circular: bool = True) -> None:
        self.types = Distribution.of(distribution)
        self.graph = LoopbackGraph()
        program, self.other = self.graph.program(), self.graph.program()
        self.asks: list[tuple[str, Request]] = []
        self.looks: list[tuple[int, CostmapName]] = []
        self.limiter = RateLimiter()
        self.costs = np.zeros((3, 40), np.uint8)
        self.base = Pose2(0.15, 0.15, 0.0)
        self.circular = circular
        offered = NodeServices(program, self.types, self.graph.pending.append)
        ask = lambda sender, request: self.asks.append((sender, request))  # noqa: E731
        self.offered = LiveCostmapServices(offered, self.types, self._costmap, self.limiter, ask)
        self.offered.offer_costmap(1, "local_costmap")
        self.offered.offer_path_check(1)

    def _costmap(self, robot: int, name: CostmapName) -> RobotCostmap:
        self.looks.append((robot, name))
        return RobotCostmap(25, self.base, Pose2(0.0, 0.0, 0.0), 0.1, self.costs, SQUARE, self.circular)

    def call(self, service: str, type_: str, **fields: object) -> Any:
        response = self.send(service, type_, self.types.encode(f"{type_}_Request", self.request(type_, **fields)))
        assert response is not None
        return self.types.decode(f"{type_}_Response", response)

    def request(self, type_: str, **fields: object) -> object:
        return self.types.make(f"{type_}_Request", **fields)

    def send(self, service: str, type_: str, data: bytes) -> bytes | None:
        """Return the response; if None, there is none."""
        responses: list[bytes] = []
        client = self.other.client(CLIENT, f"/robot2/{service}", self.types.service(type_))
        assert client.has_server, service
        client.call(data, responses.append)
        self.graph.deliver()
        return responses[0] if responses else None

    def pose(self, x: float, y: float = 0.15, frame: str = "map") -> object:
        return pose_stamped_of(self.types, frame, 0, Pose2(x, y, 0.0))

    def is_valid(self, *x: float, **fields: object) -> bool:
        path = self.types.make("nav_msgs/msg/Path", poses=[self.pose(each) for each in x])
        valid: bool = self.call("is_path_valid", services.IS_PATH_VALID, path=path, **fields).is_valid
        return valid


@pytest.fixture(params=["jazzy", "kilted"])
def robot(request: pytest.FixtureRequest) -> Iterator[OneRobot]:
    yield OneRobot(request.param)


def test_requests_to_clear_become_inputs(robot: OneRobot) -> None:
    robot.call("local_costmap/clear_entirely_local_costmap", services.CLEAR_ENTIRELY)
    robot.call("local_costmap/clear_around_local_costmap", AROUND, reset_distance=1.5)
    robot.call("local_costmap/clear_except_local_costmap", services.CLEAR_EXCEPT, reset_distance=-2.0)
    assert robot.asks == [
        ("/robot2/local_costmap/clear_entirely_local_costmap", ClearCostmapRegion(1, "local_costmap")),
        ("/robot2/local_costmap/clear_around_local_costmap", ClearCostmapRegion(1, "local_costmap", 1.5)),
        (
            "/robot2/local_costmap/clear_except_local_costmap",
            ClearCostmapRegion(1, "local_costmap", -2.0, None, outside=True),
        ),
    ]


def test_only_jazzy_clears_around_a_pose(caplog: pytest.LogCaptureFixture) -> None:
    jazzy, name = OneRobot("jazzy"), "local_costmap/clear_around_pose_local_costmap"
    jazzy.call(name, services.CLEAR_AROUND_POSE, reset_distance=0.5, pose=jazzy.pose(1.0))
    jazzy.call(name, services.CLEAR_AROUND_POSE, reset_distance=0.5, pose=jazzy.pose(1.0, frame="robot2/odom"))
    expected = ClearCostmapRegion(1, "local_costmap", 0.5, Pose2(1.0, 0.15, 0.0))
    assert [request for _, request in jazzy.asks] == [expected]
    assert "robot2/odom" in caplog.text
    assert f"/robot2/{name}" not in {each.name for each in OneRobot("kilted").other.endpoints()}


def test_distances_that_are_no_numbers_have_no_effect(robot: OneRobot) -> None:
    for distance in (math.nan, math.inf, 3e38):
        robot.call("local_costmap/clear_around_local_costmap", AROUND, reset_distance=distance)
    assert robot.asks == []


def test_floods_of_requests_are_limited(robot: OneRobot) -> None:
    for _ in range(REQUESTS_PER_TICK + 5):
        robot.call("local_costmap/clear_around_local_costmap", AROUND, reset_distance=1.0)
    assert len(robot.asks) == REQUESTS_PER_TICK


def test_a_costmap_has_its_present_costs(robot: OneRobot) -> None:
    robot.costs[1] = np.arange(216, 256)
    found = robot.call("local_costmap/get_costmap", services.GET_COSTMAP).map
    assert (found.header.frame_id, found.header.stamp.sec, found.header.stamp.nanosec) == ("map", 1, 500_000_000)
    assert (found.metadata.size_x, found.metadata.size_y, found.metadata.layer) == (40, 3, "master")
    assert found.data.reshape(3, 40).tolist() == robot.costs.tolist()
    robot.call("local_costmap/get_costmap", services.GET_COSTMAP)
    assert robot.looks == [(1, "local_costmap")]
    robot.offered.advance()
    robot.call("local_costmap/get_costmap", services.GET_COSTMAP)
    assert len(robot.looks) == 2


@pytest.mark.parametrize("footprint", [False, True])
def test_costs_of_points(footprint: bool) -> None:
    jazzy, kilted = OneRobot("jazzy"), OneRobot("kilted")
    costs = []
    for robot in (jazzy, kilted):
        robot.costs[:, 10:12], robot.costs[:, 20:22], robot.costs[:, 30:32] = 77, LETHAL, UNKNOWN
    places = (0.97, 2.05, 3.05, 5.0)
    for x in places:
        fields = {"use_footprint": footprint, "x": x, "y": 0.15}
        costs.append(jazzy.call("local_costmap/get_cost_local_costmap", services.GET_COST, **fields).cost)
    name, poses = "local_costmap/get_cost_local_costmap", [kilted.pose(x) for x in places]
    answer = kilted.call(name, services.GET_COSTS, use_footprint=footprint, poses=poses)
    if footprint:
        assert costs == answer.costs.tolist() == [77.0, 254.0, 255.0, 254.0]
        assert answer.success
    else:
        assert costs == [0.0, 254.0, 255.0, -1.0]
        assert answer.costs.tolist() == [0.0, 254.0, 255.0, 254.0]
        assert not answer.success
    elsewhere = kilted.call(name, services.GET_COSTS, poses=[kilted.pose(0.95, frame="odom"), kilted.pose(1.05)])
    assert elsewhere.costs.tolist() == [255.0, 77.0]
    assert not elsewhere.success
    for number in (math.nan, math.inf, -3e38):
        for field in ("x", "y"):
            assert jazzy.call(name, services.GET_COST, use_footprint=footprint, **{field: number}).cost == -1.0


def test_a_path_is_valid_without_obstacles_ahead(robot: OneRobot) -> None:
    assert not robot.is_valid()
    robot.costs[:, 20] = INSCRIBED
    assert robot.is_valid(0.15, 1.0, 1.95)
    assert not robot.is_valid(0.15, 1.0, 2.05)
    assert not robot.is_valid(0.15, 7.0)
    for number in (math.nan, math.inf, 1e300):
        assert not robot.is_valid(0.15, number)
    # The robot has passed the obstacle.
    robot.base = Pose2(2.6, 0.15, 0.0)
    robot.offered.advance()
    assert robot.is_valid(0.15, 2.05, 3.0)
    robot.costs[:, 30] = UNKNOWN
    assert robot.is_valid(2.5, 3.05)
    assert set(robot.looks) == {(1, "global_costmap")}


def test_a_path_of_a_robot_with_corners(robot: OneRobot) -> None:
    robot.circular = False
    robot.costs[:, 20], robot.costs[:, 30] = INSCRIBED, LETHAL
    assert robot.is_valid(0.15, 2.05, 2.91)
    assert not robot.is_valid(0.15, 2.96)


def test_kilted_has_a_maximum_cost_and_an_option_for_unknown_space() -> None:
    robot = OneRobot("kilted")
    robot.costs[:, 20], robot.costs[:, 30] = 100, UNKNOWN
    assert robot.is_valid(0.15, 2.05, max_cost=101)
    assert not robot.is_valid(0.15, 2.05, max_cost=100)
    assert robot.is_valid(0.15, 3.05, max_cost=100)
    assert not robot.is_valid(0.15, 3.05, consider_unknown_as_obstacle=True)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=50)
@given(st.sampled_from([*services.CLEARING, "get_costmap", "get_cost", "is_path_valid"]), st.data())
def test_any_bytes_have_an_answer_or_none(robot: OneRobot, prefix: str, data: st.DataObject) -> None:
    own = {"get_costmap": services.GET_COSTMAP, "is_path_valid": services.IS_PATH_VALID}
    type_ = own.get(prefix) or services.CLEARING.get(prefix) or ""
    if prefix == "get_cost":
        type_ = services.GET_COSTS if robot.types.knows(services.GET_COSTS) else services.GET_COST
    if not robot.types.knows(type_):
        return
    name = {"is_path_valid": prefix, "get_costmap": f"local_costmap/{prefix}"}
    whole = robot.types.encode(f"{type_}_Request", robot.request(type_))
    cut = data.draw(st.integers(0, len(whole)))
    damaged = whole[:cut] + data.draw(st.binary(max_size=200))
    robot.send(name.get(prefix, f"local_costmap/{prefix}_local_costmap"), type_, damaged)
    for _, request in robot.asks:
        assert isinstance(request, ClearCostmapRegion)
        assert request.side is None or abs(request.side) <= 1e6
