"""Parameters and services of the Nav2 nodes of a session: what clients ask becomes inputs, and all see the result."""

import logging
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.inputs import GlobalLocalization, NomotionUpdate, SetPoseEstimate
from sim.parameters import RobotParameters
from sim.robot.costmap.robot_costmap import RobotCostmap
from tests.support.project import ROOT
from tests.support.ros2.loopback import LoopbackGraph
from thbridge.app.live_graph.live_node_parameters import CHANGES_PER_TICK, TOO_MANY, LiveNodeParameters
from thbridge.app.live_graph.live_node_services import LiveNodeServices, offer_logger_levels
from thbridge.app.live_graph.rate_limiter import REQUESTS_PER_TICK, RateLimiter
from thbridge.roles.shared.robot_requests import Request, SetParameters
from thbridge.ros2 import lifecycle, services
from thbridge.ros2 import parameter_messages as messages
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.nav2_parameters import COSTMAPS, LIFECYCLE_MANAGERS, NAV2_NODES
from thbridge.ros2.parameters import Value, kind_of
from thbridge.ros2.qos import DEFAULT
from thbridge.ros2graph.sockets.parameter_services import EVENTS, NodeServices
from thbridge.ros2graph.values.graph import NodeName
from thbridge.study.external_nodes import ExternalNodes

TYPES = Distribution.of("jazzy")
SOFTWARE = RobotParameters()
CLIENT = NodeName("/", "client")
OURS = NodeName("/", "thbridge")
GRID = OccupancyGrid(np.arange(6, dtype=np.int8).reshape(2, 3), 0.05, Pose2(1.0, 2.0, 0.0))
COSTMAP = RobotCostmap(0, GRID.origin, GRID.origin, 0.05, np.zeros((2, 3), np.uint8), np.empty((0, 2)), circular=True)
EMPTY = "std_srvs/srv/Empty"


class TwoRobots:
    """Two robots on a graph, and a client."""

    def __init__(self, external: ExternalNodes = ExternalNodes.NONE, types: Distribution = TYPES) -> None:
        self.graph = LoopbackGraph()
        program, self.other = self.graph.program(), self.graph.program()
        offered, self.limiter = NodeServices(program, types, self.graph.pending.append), RateLimiter()
        self.asks: list[tuple[str, Request]] = []
        self.software = [SOFTWARE, SOFTWARE]
        self.parameters = LiveNodeParameters(
            offered, self.software, {"hunt": {"rooms": 4}}, 0.05, self.limiter, self._ask, external
        )
        self.services = LiveNodeServices(
            offered, types, self.parameters.nodes, GRID, lambda robot, name: COSTMAP, self.limiter, self._ask
        )
        offer_logger_levels(offered, TYPES, OURS)
        self.events: list[Any] = []
        self.other.subscribe(CLIENT, EVENTS, TYPES.message(messages.EVENT), DEFAULT, self._hear)

    def _ask(self, sender: str, request: Request) -> None:
        self.asks.append((sender, request))

    def _hear(self, message: bytes, gid: bytes) -> None:
        event: Any = TYPES.decode(messages.EVENT, message)
        values = {each.name: each.value.double_value for each in event.changed_parameters}
        self.events.append((event.node, event.stamp.sec, values))

    def tick(self, tick: int) -> None:
        """End a tick, with the parameters that the robots have then."""
        self.limiter.tick()
        self.parameters.follow(tick, self.software)
        self.graph.deliver()

    def call(self, service: str, type_: str, **fields: object) -> Any:
        request = f"{type_}_Request"
        responses: list[bytes] = []
        client = self.other.client(CLIENT, service, TYPES.service(type_))
        assert client.has_server, service
        client.call(TYPES.encode(request, TYPES.make(request, **fields)), responses.append)
        self.graph.deliver()
        return TYPES.decode(f"{type_}_Response", responses[0])

    def set(self, node: str, values: Sequence[tuple[str, Value]], together: bool = False) -> list[str]:
        """Set parameters, and return the reasons for refusals."""
        service = messages.SET_TOGETHER if together else messages.SET
        parameters = [
            TYPES.make(
                "rcl_interfaces/msg/Parameter",
                name=name,
                value=messages.parameter_value(TYPES, kind_of(value), value),
            )
            for name, value in values
        ]
        answer = self.call(f"{node}/{service}", messages.SERVICE_TYPES[service], parameters=parameters)
        results = [answer.result] if together else answer.results
        assert all(each.successful == (not each.reason) for each in results)
        return [each.reason for each in results]

    def get(self, node: str, name: str) -> float:
        answer = self.call(f"{node}/{messages.GET}", messages.SERVICE_TYPES[messages.GET], names=[name])
        return answer.values[0].double_value


def with_error(software: RobotParameters, error: float) -> RobotParameters:
    return replace(software, amcl=replace(software.amcl, kld_err=error))


def test_a_change_becomes_one_input_and_one_event() -> None:
    both = TwoRobots()
    asked = [("pf_err", 0.25), ("max_beams", 90), ("pf_z", 77.0)]
    assert both.set("/robot2/amcl", asked) == ["", "", "pf_z is at most 5, not 77"]
    values = (("amcl.kld_err", 0.25), ("amcl.laser_max_beams", 90))
    assert both.asks == [("/robot2/amcl/set_parameters", SetParameters(1, values))]
    assert (both.get("/robot2/amcl", "pf_err"), both.get("/robot1/amcl", "pf_err")) == (0.25, SOFTWARE.amcl.kld_err)
    both.software[1] = replace(SOFTWARE, amcl=replace(SOFTWARE.amcl, kld_err=0.25, laser_max_beams=90))
    both.tick(50)
    ((node, _, changed),) = both.events
    assert (node, changed.keys()) == ("/robot2/amcl", {"pf_err", "max_beams"})


def test_all_or_nothing() -> None:
    both = TwoRobots()
    assert both.set("/robot1/amcl", [("pf_err", 0.25), ("no_such", 1)], together=True) == [
        "parameter 'no_such' cannot be set because it was not declared"
    ]
    assert both.asks == []
    pair: list[tuple[str, Value]] = [("min_particles", 4000), ("max_particles", 5000)]
    assert both.set("/robot1/amcl", pair, together=True) == [""]
    assert both.asks[0][1] == SetParameters(0, (("amcl.min_particles", 4000), ("amcl.max_particles", 5000)))


def test_changes_by_others_are_published() -> None:
    both = TwoRobots()
    both.software[0] = with_error(SOFTWARE, 0.125)
    both.tick(100)
    assert both.events == [("/robot1/amcl", 3, {"pf_err": 0.125})]
    assert both.get("/robot1/amcl", "pf_err") == 0.125
    assert both.asks == []


def test_a_dead_robot_keeps_its_parameters() -> None:
    both = TwoRobots()
    assert both.set("/robot1/amcl", [("pf_err", 0.25)]) == [""]
    both.tick(1)
    assert [values for _, _, values in both.events] == [{"pf_err": 0.25}, {"pf_err": SOFTWARE.amcl.kld_err}]
    assert both.get("/robot1/amcl", "pf_err") == SOFTWARE.amcl.kld_err


def test_the_session_itself_cannot_be_changed() -> None:
    both = TwoRobots()
    assert both.set("/thbridge", [("hunt.rooms", 7)]) == [
        "parameter 'hunt.rooms' cannot be set because it is read-only"
    ]
    assert both.asks == []


def test_floods_are_refused() -> None:
    both = TwoRobots()
    for number in range(REQUESTS_PER_TICK):
        assert both.set("/robot1/amcl", [("pf_err", (number + 1) / 100)]) == [""]
    assert both.set("/robot1/amcl", [("pf_err", 0.5)]) == [TOO_MANY]
    assert both.set("/robot1/local_costmap/local_costmap", [("width", 5.0)]) == [""]
    assert both.set("/robot2/amcl", [("pf_err", 0.5)] * (CHANGES_PER_TICK + 1)) == [TOO_MANY] * (CHANGES_PER_TICK + 1)
    assert both.set("/robot2/amcl", [("pf_err", 0.5)], together=True) == [TOO_MANY]
    assert len(both.asks) == REQUESTS_PER_TICK + 1
    both.tick(1)
    assert both.set("/robot2/amcl", [("pf_err", 0.5)]) == [""]


@pytest.mark.parametrize(
    ("external", "missing"),
    [
        (ExternalNodes.MOVE_BASE, {"controller_server", "local_costmap", "lifecycle_manager_navigation"}),
        (ExternalNodes.BOTH, {"amcl", "controller_server", "local_costmap", "lifecycle_manager_localization"}),
    ],
)
def test_nodes_of_other_programs_are_missing(external: ExternalNodes, missing: set[str]) -> None:
    own = TwoRobots(external)
    names = {node.name for node in own.parameters.nodes}
    assert names.isdisjoint(missing)
    assert {"map_server", "thbridge"} <= names
    offered = {endpoint.name for endpoint in own.other.endpoints()}
    assert ("/robot1/set_initial_pose" in offered) == ("amcl" not in missing)
    assert "/robot1/global_costmap/clear_entirely_global_costmap" not in offered


def test_every_node_has_its_services() -> None:
    both = TwoRobots()
    offered = {endpoint.name for endpoint in both.other.endpoints()}
    for node in both.parameters.nodes:
        whole = NodeName(node.namespace, node.name).whole
        assert {f"{whole}/{name}" for name in (*messages.SERVICE_TYPES, "get_type_description")} <= offered
        if node.name in LIFECYCLE_MANAGERS:
            assert both.call(f"{whole}/is_active", lifecycle.IS_ACTIVE).success
            assert not both.call(f"{whole}/manage_nodes", lifecycle.MANAGE_NODES, command=3).success
        elif node.robot is not None:
            state = both.call(f"{whole}/get_state", lifecycle.GET_STATE).current_state
            assert (state.id, state.label) == (3, "active")
            deactivate = TYPES.make("lifecycle_msgs/msg/Transition", id=4)
            assert not both.call(f"{whole}/change_state", lifecycle.CHANGE_STATE, transition=deactivate).success
            now = both.call(f"{whole}/get_available_transitions", lifecycle.GET_TRANSITIONS).available_transitions
            assert [each.transition.label for each in now] == ["deactivate", "shutdown"]


def test_services_of_nav2_become_inputs() -> None:
    both = TwoRobots()
    both.call("/robot2/reinitialize_global_localization", EMPTY)
    both.call("/robot1/request_nomotion_update", EMPTY)
    both.call("/robot1/request_nomotion_update", EMPTY)
    assert both.asks == [
        ("/robot2/reinitialize_global_localization", GlobalLocalization(1)),
        ("/robot1/request_nomotion_update", NomotionUpdate(0)),
    ]


def pose(frame: str, x: float, covariance: float) -> object:
    position = TYPES.make("geometry_msgs/msg/Point", x=x, y=2.0)
    whole = np.zeros(36)
    whole[[0, 7, 35]] = covariance
    estimate = TYPES.make(
        "geometry_msgs/msg/PoseWithCovariance",
        pose=TYPES.make("geometry_msgs/msg/Pose", position=position),
        covariance=whole,
    )
    header = TYPES.make("std_msgs/msg/Header", frame_id=frame)
    return TYPES.make("geometry_msgs/msg/PoseWithCovarianceStamped", header=header, pose=estimate)


def test_the_initial_pose_can_be_set(caplog: pytest.LogCaptureFixture) -> None:
    both = TwoRobots()
    both.call("/robot2/set_initial_pose", services.SET_INITIAL_POSE, pose=pose("map", 1.5, 0.25))
    ((sender, request),) = both.asks
    assert sender == "/robot2/set_initial_pose"
    assert isinstance(request, SetPoseEstimate)
    assert (request.robot, request.base_in_map) == (1, Pose2(1.5, 2.0, 0.0))
    assert request.covariance.tolist() == np.diag([0.25] * 3).tolist()
    both.call("/robot2/set_initial_pose", services.SET_INITIAL_POSE, pose=pose("odom", 1.5, 0.25))
    both.call("/robot2/set_initial_pose", services.SET_INITIAL_POSE, pose=pose("map", 1.5, float("nan")))
    assert len(both.asks) == 1
    assert [record.getMessage().partition(":")[0] for record in caplog.records] == ["/robot2/set_initial_pose"] * 2


def test_the_map_can_be_read_but_not_replaced() -> None:
    both = TwoRobots()
    whole = both.call("/robot1/map_server/map", services.GET_MAP).map
    assert (whole.header.frame_id, whole.info.width, whole.info.height) == ("map", 3, 2)
    assert whole.data.tolist() == [0, 1, 2, 3, 4, 5]
    assert both.call("/robot1/map_server/load_map", services.LOAD_MAP, map_url="other.yaml").result == 255
    assert both.asks == []


@settings(max_examples=50)
@given(st.binary(max_size=400), st.integers(0, 400))
def test_bytes_that_are_no_request_have_no_effect(noise: bytes, place: int) -> None:
    both = TwoRobots()
    request = f"{services.SET_INITIAL_POSE}_Request"
    whole = TYPES.encode(request, TYPES.make(request, pose=pose("map", 1.0, 0.25)))
    for endpoint in both.other.endpoints():
        if endpoint.name.startswith("/robot1/") and endpoint.name.count("/") <= 3:
            client = both.other.client(CLIENT, endpoint.name, TYPES.service(services.EMPTY))
            for damaged in (noise, whole[:place] + noise):
                client.call(damaged, lambda response: None)
    both.graph.deliver()
    for _, request_ in both.asks:
        if isinstance(request_, SetPoseEstimate):
            assert np.isfinite(request_.covariance).all()


def test_levels_of_our_loggers_can_be_read_and_set() -> None:
    both = TwoRobots()
    logger = logging.getLogger("sim")
    before = logger.level
    try:
        levels = [
            TYPES.make("rcl_interfaces/msg/LoggerLevel", name=name, level=level)
            for name, level in (("sim", 10), ("sim", 11), ("root", 20))
        ]
        answer = both.call("/thbridge/set_logger_levels", "rcl_interfaces/srv/SetLoggerLevels", levels=levels)
        assert [each.successful for each in answer.results] == [True, False, False]
        assert [each.reason for each in answer.results] == [
            "",
            "there is no level 11. Use one of these levels: 0, 10, 20, 30, 40, 50",
            "there is no logger 'root'. Use one of these loggers: thbridge, sim, ui",
        ]
        known = both.call("/thbridge/get_logger_levels", "rcl_interfaces/srv/GetLoggerLevels", names=["sim", "root"])
        assert [(each.name, each.level) for each in known.levels] == [("sim", 10), ("root", 0)]
    finally:
        logger.setLevel(before)


@pytest.mark.parametrize(("distribution", "other"), [("jazzy", "Kilted"), ("kilted", "Jazzy")])
def test_the_page_lists_exactly_the_services_of_a_robot(distribution: str, other: str) -> None:
    both = TwoRobots(types=Distribution.of(distribution))
    offered = {
        each.name.removeprefix("/robot1/") for each in both.other.endpoints() if each.name.startswith("/robot1/")
    }
    listed: dict[str, bool] = {}
    for line in (ROOT / "docs" / "reference" / "nav2-services.md").read_text().splitlines():
        if match := re.match(r"\| `([A-Za-z_/]+)`.*\| ([^|]*) \| ([^|]*) \|$", line):
            for part in (name if name not in COSTMAPS else f"{name}/{name}" for name in NAV2_NODES):
                name = match[1].replace("NODE", part).replace("COSTMAP", part.rpartition("/")[2])
                if "COSTMAP" not in match[1] or "/" in part:
                    there = not match[3].startswith(("no", "only")) and f"only {other}" not in match[2]
                    listed[name] = there and not (part in LIFECYCLE_MANAGERS and "lifecycle" in match[2])
    of_parameters = {name for name in offered if name.rpartition("/")[2] in messages.SERVICE_TYPES}
    assert offered - of_parameters == {name for name, there in listed.items() if there} - of_parameters
    assert len(offered - of_parameters) > 60
