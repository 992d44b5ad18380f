"""Services of the robots' costmaps on a ROS 2 graph, and planner_server's check of paths."""

import logging
from collections.abc import Callable
from functools import partial

from sim.robot.costmap.robot_costmap import RobotCostmap
from sim.robot.costmap.view import CostmapName
from thbridge.app.live_graph.rate_limiter import RateLimiter
from thbridge.roles.shared.robot_requests import Request
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.names import RobotNames
from thbridge.ros2 import costmap_services as services
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.services import constant_answer
from thbridge.ros2graph.sockets.parameter_services import NodeServices
from thbridge.ros2graph.values.graph import NodeName
from thbridge.sockets.warn_once import WarnOnce

GetCostmap = Callable[[int, CostmapName], RobotCostmap]
"""Function that returns a costmap of a robot, given the index of the robot in the team."""

_log = logging.getLogger(__name__)


class LiveCostmapServices:
    """Services of costmaps. Requests to clear a costmap become inputs of the session. All other requests are queries.

    Args:
        offered: services of nodes.
        types: types of the messages.
        costmap: returns a costmap. It is called at most once per tick for each costmap.
        limiter: limiter of the rate of requests.
        ask: callback with a request, and the name of the service as sender.
    """

    def __init__(
        self,
        offered: NodeServices,
        types: Distribution,
        costmap: GetCostmap,
        limiter: RateLimiter,
        ask: Callable[[str, Request], None],
    ) -> None:
        self._offered = offered
        self._types = types
        self._costmap = costmap
        self._limiter = limiter
        self._ask = ask
        self._complaints = WarnOnce(_log)
        self._present: dict[tuple[int, CostmapName], RobotCostmap] = {}

    def advance(self) -> None:
        """Forget the costmaps of the last tick."""
        self._present.clear()

    def offer_costmap(self, robot: int, name: CostmapName) -> None:
        """Offer the services of a robot's costmap."""
        namespace = RobotNames.of(robot).topic(name)
        node, look = NodeName(namespace, name), partial(self._look, robot, name)
        for prefix, type_ in services.CLEARING.items():
            if self._types.knows(type_):
                service = f"{namespace}/{prefix}_{name}"
                answer = partial(self._clear, robot, name, service, type_, constant_answer(self._types, type_))
                self._offered.serve(node, service, type_, answer)
        get_costmap = services.costmap_answer(self._types, look)
        self._offered.serve(node, f"{namespace}/get_costmap", services.GET_COSTMAP, get_costmap)
        self._offered.serve(node, f"{namespace}/get_cost_{name}", *services.cost_answer(self._types, look))

    def offer_path_check(self, robot: int) -> None:
        """Offer the service is_path_valid of a robot's planner_server."""
        names = RobotNames.of(robot)
        answer = services.path_answer(self._types, partial(self._look, robot, "global_costmap"))
        node = NodeName(names.namespace, "planner_server")
        self._offered.serve(node, names.topic("is_path_valid"), services.IS_PATH_VALID, answer)

    def _look(self, robot: int, name: CostmapName) -> RobotCostmap:
        """Return the present costmap, which does not change between two ticks."""
        if (robot, name) not in self._present:
            self._present[robot, name] = self._costmap(robot, name)
        return self._present[robot, name]

    def _clear(
        self, robot: int, name: CostmapName, service: str, type_: str, respond: Callable[[bytes], bytes], data: bytes
    ) -> bytes:
        response = respond(data)
        request = services.region_of(self._types, type_, robot, name, data)
        if isinstance(request, InvalidMessage):
            self._complaints.warn(f"{service}: ignoring a request: {request.sentence}")
        elif self._limiter.admits(service, "clients"):
            self._ask(service, request)
        return response
