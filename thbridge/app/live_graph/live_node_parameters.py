"""Parameters of the robots on a ROS 2 graph: those of the Nav2 nodes of each robot, and of the session's node.

A change becomes a request, which the session processes and records. Then all nodes report the new value.
"""

import logging
from collections.abc import Callable, Mapping, Sequence

from sim.parameters import RobotParameters
from thbridge.app.live_graph.rate_limiter import RateLimiter
from thbridge.roles.shared.robot_requests import Request, SetParameters
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros.parameters import Tree
from thbridge.ros2.nav2_parameters import nav2_nodes, robot_nodes, session_node
from thbridge.ros2.parameters import GivenParameter, ParameterNode, Value, set_each, set_together
from thbridge.ros2graph.sockets.parameter_services import NodeServices, ParameterEvents
from thbridge.ros2graph.values.graph import NodeName
from thbridge.study.external_nodes import ExternalNodes

CHANGES_PER_TICK = 200
"""Maximum number of parameters that clients can set between two ticks. One robot has about 170 live parameters."""
TOO_MANY = "too many requests"

_log = logging.getLogger(__name__)


class LiveNodeParameters:
    """Present parameters of the robots, which nodes of the graph can read and change.

    Differs: a value takes effect in the next tick, and only if the robot lives. If a robot does not accept a change, a
    further event reports the old value.

    Args:
        services: services of nodes.
        software: parameters of each robot at the start.
        rest: parameters of the study, without the parameters of robots.
        resolution: size of a cell of the map, meters.
        limiter: limiter of the rate of requests.
        ask: callback with a request, and the name of the node's service as sender.
        external: nodes that other programs run. They have their own parameters.
    """

    def __init__(
        self,
        services: NodeServices,
        software: Sequence[RobotParameters],
        rest: Tree,
        resolution: float,
        limiter: RateLimiter,
        ask: Callable[[str, Request], None],
        external: ExternalNodes = ExternalNodes.NONE,
    ) -> None:
        self._software = list(software)
        self._limiter = limiter
        self._ask = ask
        self._tick = 0
        self._changes = 0
        wanted = nav2_nodes(external.amcl, external.move_base)
        self._of_robots = [
            [node for node in robot_nodes(robot, own, resolution) if node.name in wanted]
            for robot, own in enumerate(software)
        ]
        self.nodes: tuple[ParameterNode, ...] = (
            session_node(rest),
            *(node for nodes in self._of_robots for node in nodes),
        )
        self._present: dict[ParameterNode, dict[str, Value]] = {}
        self._events: dict[ParameterNode, ParameterEvents] = {node: services.offer(node, self) for node in self.nodes}

    def announce(self, tick: int) -> None:
        """Publish all parameters as new."""
        for node, events in self._events.items():
            events.announce(stamp_ns(tick), self.present(node))

    def follow(self, tick: int, software: Sequence[RobotParameters]) -> None:
        """Publish the parameters that changed in the last tick, also if a dead robot did not accept a change."""
        self._tick = tick
        self._changes = 0
        for robot, now in enumerate(software):
            self._replace(robot, now)

    def present(self, node: ParameterNode) -> Mapping[str, Value]:
        """Return the values of a node's parameters that may change, by name."""
        if node not in self._present:
            self._present[node] = {} if node.robot is None else node.reported(self._software[node.robot])
        return self._present[node]

    def set(self, node: ParameterNode, given: Sequence[GivenParameter], together: bool) -> Sequence[str]:
        """Set parameters of a node; see `ParameterOwner.set`."""
        service = f"{NodeName(node.namespace, node.name).whole}/set_parameters"
        if not self._admits(service, len(given)):
            return [TOO_MANY] * (1 if together else len(given))
        # The parameters of the session's node are all fixed, so any robot can stand in for its software.
        robot = node.robot or 0
        changes = (set_together if together else set_each)(node, self._software[robot], given)
        for reason in changes.refusals:
            if reason:
                _log.info("%s: %s", service, reason)
        if changes.values:
            self._replace(robot, changes.software)
            self._ask(service, SetParameters(robot, changes.values))
        return changes.refusals

    def _admits(self, service: str, count: int) -> bool:
        """Count a request with some parameters. Return False if there are too many since the last tick."""
        self._changes += count
        return self._changes <= CHANGES_PER_TICK and self._limiter.admits(service, "clients")

    def _replace(self, robot: int, now: RobotParameters) -> None:
        """Replace the parameters of a robot, and publish the differences."""
        before = self._software[robot]
        if now is before or now == before:
            return
        values = [(node, self.present(node)) for node in self._of_robots[robot]]
        self._software[robot] = now
        for node, old in values:
            self._present[node] = new = node.reported(now)
            changed = [(name, value) for name, value in new.items() if value != old[name]]
            if changed:
                self._events[node].changed(stamp_ns(self._tick), changed)
