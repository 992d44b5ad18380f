"""Nav2's services of the robots on a ROS 2 graph, and the logger services of the session's node."""

import logging
from collections.abc import Callable, Iterable, Sequence
from functools import partial

from sim.common.grid import OccupancyGrid
from sim.inputs import ClearCostmaps, GlobalLocalization, NomotionUpdate, SetPoseEstimate
from thbridge.app.live_graph.live_loggers import LOGGERS
from thbridge.app.live_graph.rate_limiter import RateLimiter
from thbridge.roles.shared.robot_requests import Request
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import pack
from thbridge.ros.names import MAP_FRAME, RobotNames
from thbridge.ros.topics import RosMessage
from thbridge.ros2 import loggers, services
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.nav2_parameters import COSTMAPS, nav2_nodes
from thbridge.ros2.parameters import ParameterNode
from thbridge.ros2graph.sockets.parameter_services import NodeServices
from thbridge.ros2graph.values.graph import NodeName
from thbridge.sockets.warn_once import WarnOnce
from thbridge.study.external_nodes import ExternalNodes

_log = logging.getLogger(__name__)


class LiveNodeServices:
    """Services of the Nav2 nodes of the robots. Their requests become inputs of the session.

    Differs: each of the services that clear a costmap clears both costmaps, as in ROS 1.

    Args:
        offered: services of nodes.
        types: types of the messages.
        nodes: all nodes of the session.
        robots: number of robots.
        grid: the map.
        limiter: limiter of the rate of requests.
        ask: callback with a request, and the name of the service as sender.
        external: nodes that other programs run.
    """

    def __init__(
        self,
        offered: NodeServices,
        types: Distribution,
        nodes: Sequence[ParameterNode],
        robots: int,
        grid: OccupancyGrid,
        limiter: RateLimiter,
        ask: Callable[[str, Request], None],
        external: ExternalNodes = ExternalNodes.NONE,
    ) -> None:
        self._offered = offered
        self._types = types
        self._limiter = limiter
        self._ask = ask
        self._complaints = WarnOnce(_log)
        self._costmaps: dict[str, bytes] = {}
        self._read_pose = services.initial_pose(types)
        self._answer_map = services.map_answer(types, pack.occupancy_grid(0, MAP_FRAME, grid))
        self._answer_costmap = services.costmap_answer(types)
        active, refused = services.active_state(types), services.map_refused(types)
        for node in nodes:
            named = NodeName(node.namespace, node.name)
            offered.describe_types(named)
            if node.robot is not None:
                offered.serve(named, f"{named.whole}/get_state", services.GET_STATE, active)
            if node.name == "map_server":
                offered.serve(named, f"{named.whole}/map", services.GET_MAP, self._answer_map)
                offered.serve(named, f"{named.whole}/load_map", services.LOAD_MAP, refused)
        wanted = nav2_nodes(external.amcl, external.move_base)
        for robot in range(robots):
            if "amcl" in wanted:
                self._offer_localization(robot)
            for name in COSTMAPS:
                if name in wanted:
                    self._offer_costmap(robot, name)

    def take(self, messages: Iterable[RosMessage]) -> None:
        """Remember the costmaps among the messages of a tick."""
        for message in messages:
            if message.topic.name.endswith(_PUBLISHED):
                self._costmaps[message.topic.name] = message.data

    def _offer_localization(self, robot: int) -> None:
        names = RobotNames.of(robot)
        node = NodeName(names.namespace, "amcl")
        for name, request in (
            ("reinitialize_global_localization", GlobalLocalization(robot)),
            ("request_nomotion_update", NomotionUpdate(robot)),
        ):
            self._pass_on(node, names.topic(name), services.EMPTY, request)
        service = names.topic("set_initial_pose")
        self._offered.serve(node, service, services.SET_INITIAL_POSE, partial(self._set_pose, robot, service))

    def _offer_costmap(self, robot: int, name: str) -> None:
        names = RobotNames.of(robot)
        node = NodeName(names.topic(name), name)
        self._pass_on(node, f"{node.namespace}/clear_entirely_{name}", services.CLEAR_COSTMAP, ClearCostmaps(robot))
        published = names.topic(f"move_base/{name}/costmap")
        self._offered.serve(
            node,
            f"{node.namespace}/get_costmap",
            services.GET_COSTMAP,
            lambda request: self._answer_costmap(self._costmaps.get(published), request),
        )

    def _pass_on(self, node: NodeName, service: str, type_: str, request: Request) -> None:
        """Offer a service whose call is a request without arguments."""
        respond = services.same_answer(self._types, type_)

        def answer(data: bytes) -> bytes:
            response = respond(data)
            if self._limiter.is_first(service):
                self._ask(service, request)
            return response

        self._offered.serve(node, service, type_, answer)

    def _set_pose(self, robot: int, service: str, data: bytes) -> bytes:
        found = self._read_pose(data)
        if isinstance(found, InvalidMessage):
            self._complaints.warn(f"{service}: ignoring a pose: {found.sentence}")
        elif self._limiter.admits(service, "clients"):
            self._ask(service, SetPoseEstimate(robot, found.base_in_map, found.covariance))
        name = f"{services.SET_INITIAL_POSE}_Response"
        return self._types.encode(name, self._types.make(name))


_PUBLISHED = tuple(f"/move_base/{name}/costmap" for name in COSTMAPS)
"""Ends of the names of topics with costmaps."""


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
