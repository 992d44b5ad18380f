"""Nav2's services of the robots on a ROS 2 graph, and the logger services of the session's node."""

import logging
from collections.abc import Callable, Sequence
from functools import partial

from sim.common.grid import OccupancyGrid
from sim.inputs import GlobalLocalization, NomotionUpdate, SetPoseEstimate
from thbridge.app.live_graph.live_costmap_services import GetCostmap, LiveCostmapServices
from thbridge.app.live_graph.live_loggers import LOGGERS
from thbridge.app.live_graph.rate_limiter import RateLimiter
from thbridge.roles.shared.robot_requests import Request
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import pack
from thbridge.ros.names import MAP_FRAME, RobotNames
from thbridge.ros2 import lifecycle, loggers, services
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.nav2_parameters import COSTMAPS, LIFECYCLE_MANAGERS
from thbridge.ros2.parameters import ParameterNode
from thbridge.ros2graph.sockets.parameter_services import NodeServices
from thbridge.ros2graph.values.graph import NodeName
from thbridge.sockets.warn_once import WarnOnce

_log = logging.getLogger(__name__)


class LiveNodeServices:
    """Services of the Nav2 nodes of the robots. Requests that change a robot become inputs of the session.

    Args:
        offered: services of nodes.
        types: types of the messages.
        nodes: all nodes of the session.
        grid: the map.
        costmap: returns a costmap of a robot.
        limiter: limiter of the rate of requests.
        ask: callback with a request, and the name of the service as sender.
    """

    def __init__(
        self,
        offered: NodeServices,
        types: Distribution,
        nodes: Sequence[ParameterNode],
        grid: OccupancyGrid,
        costmap: GetCostmap,
        limiter: RateLimiter,
        ask: Callable[[str, Request], None],
    ) -> None:
        self._offered = offered
        self._types = types
        self._limiter = limiter
        self._ask = ask
        self._complaints = WarnOnce(_log)
        self._read_pose = services.initial_pose(types)
        self._map = {
            "map": (services.GET_MAP, services.map_answer(types, pack.occupancy_grid(0, MAP_FRAME, grid))),
            "load_map": (services.LOAD_MAP, services.map_refused(types)),
        }
        self._lifecycle = lifecycle.lifecycle_answers(types)
        self._manager = lifecycle.manager_answers(types)
        self._costmaps = LiveCostmapServices(offered, types, costmap, limiter, ask)
        for node in nodes:
            offered.describe_types(NodeName(node.namespace, node.name))
            if node.robot is not None:
                self._offer(node.robot, node)

    def advance(self) -> None:
        """Process the end of a tick."""
        self._costmaps.advance()

    def _offer(self, robot: int, node: ParameterNode) -> None:
        own = dict(self._manager if node.name in LIFECYCLE_MANAGERS else self._lifecycle)
        if node.name == "map_server":
            own |= self._map
        elif node.name == "amcl":
            self._offer_localization(robot)
        elif node.name == "planner_server":
            self._costmaps.offer_path_check(robot)
        for name in COSTMAPS:
            if node.name == name:
                self._costmaps.offer_costmap(robot, name)
        named = NodeName(node.namespace, node.name)
        for service, (type_, answer) in own.items():
            self._offered.serve(named, f"{named.whole}/{service}", type_, answer)

    def _offer_localization(self, robot: int) -> None:
        names = RobotNames.of(robot)
        node = NodeName(names.namespace, "amcl")
        for name, request in (
            ("reinitialize_global_localization", GlobalLocalization(robot)),
            ("request_nomotion_update", NomotionUpdate(robot)),
        ):
            self._pass_on(node, names.topic(name), request)
        service = names.topic("set_initial_pose")
        self._offered.serve(node, service, services.SET_INITIAL_POSE, partial(self._set_pose, robot, service))

    def _pass_on(self, node: NodeName, service: str, request: Request) -> None:
        """Offer a service whose call is a request without arguments."""
        respond = services.constant_answer(self._types, services.EMPTY)

        def answer(data: bytes) -> bytes:
            response = respond(data)
            if self._limiter.is_first(service):
                self._ask(service, request)
            return response

        self._offered.serve(node, service, services.EMPTY, answer)

    def _set_pose(self, robot: int, service: str, data: bytes) -> bytes:
        found = self._read_pose(data)
        if isinstance(found, InvalidMessage):
            self._complaints.warn(f"{service}: ignoring a pose: {found.sentence}")
        elif self._limiter.admits(service, "clients"):
            self._ask(service, SetPoseEstimate(robot, found.base_in_map, found.covariance))
        return self._types.encoded(f"{services.SET_INITIAL_POSE}_Response")


def offer_logger_levels(offered: NodeServices, types: Distribution, node: NodeName) -> None:
    """Offer the services `get_logger_levels` and `set_logger_levels` of our node."""
    offered.serve(
        node, f"{node.whole}/{loggers.GET}", loggers.GET_TYPE, partial(loggers.answer_levels, types, _level_of)
    )
    offered.serve(
        node, f"{node.whole}/{loggers.SET}", loggers.SET_TYPE, partial(loggers.answer_new_levels, types, _set_level)
    )


def _level_of(name: str) -> int:
    return logging.getLogger(name).level if name in LOGGERS else 0


def _set_level(name: str, level: int) -> str:
    if name not in LOGGERS:
        return f"there is no logger {name[:80]!r}. Use one of these loggers: {', '.join(LOGGERS)}"
    logging.getLogger(name).setLevel(level)
    return ""
