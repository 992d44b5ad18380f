"""Parameters of the robots on a ROS graph, on the parameter server and by dynamic_reconfigure.

A change by one of these two methods becomes a request, which the session processes and records. Then the parameter
server and dynamic_reconfigure both have the new value.
"""

import json
import logging
from collections.abc import Callable, Collection, Sequence
from functools import partial
from typing import cast

from sim.parameters import RobotParameters, reconfigurable
from sim.parameters.reconfiguration import ParameterRejection, with_values
from thbridge.app.live_graph.rate_limiter import RateLimiter
from thbridge.app.live_graph.typed_node import TypedNode
from thbridge.roles.shared.robot_requests import ParameterValue as SetValue
from thbridge.roles.shared.robot_requests import Request, SetParameters
from thbridge.ros import reconfigure
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import types
from thbridge.ros.names import RobotNames
from thbridge.ros.parameters import MOVE_BASE, ParameterValue, has, leaves, name_of, path_of, robot_tree, value_at
from thbridge.ros.reconfigure import ReconfigureServer
from thbridge.rosgraph.wire.links import ServiceFailed
from thbridge.rosgraph.wire.xmlrpc import XmlRpcValue
from thbridge.sockets.warn_once import WarnOnce
from thbridge.study.external_nodes import ExternalNodes

_log = logging.getLogger(__name__)

ROBOT = RobotNames.of(0)
"""Names of an arbitrary robot, with which nodes are recognized."""


class LiveParameters:
    """Present parameters of the robots, which nodes of the graph can read and change.

    Differs: in ROS, a node reads a parameter from the parameter server only when the node starts. Here, a change acts
    at once, as with dynamic_reconfigure.

    Args:
        node: node of the session.
        software: parameters of each robot at the start.
        body: corners of a robot's body in the robot's base frame, meters.
        limiter: limiter of the rate of changes.
        ask: callback with a request, and the name of the parameters or of the service as sender.
        external: nodes that other programs run. They change their own parameters; here, only the initial values are
            published.
    """

    def __init__(
        self,
        node: TypedNode,
        software: Sequence[RobotParameters],
        body: Sequence[Sequence[float]],
        limiter: RateLimiter,
        ask: Callable[[str, Request], None],
        external: ExternalNodes = ExternalNodes.NONE,
    ) -> None:
        self._node = node
        self._software = list(software)
        self._body = body
        self._external = external
        self._limiter = limiter
        self._ask = ask
        self._complaints = WarnOnce(_log)
        self._robots = [RobotNames.of(robot) for robot in range(len(software))]
        self._updates = {
            (robot, section.path): node.advertise(
                f"{section.name(named)}/parameter_updates", types.CONFIG, latched=True
            )
            for robot, named in enumerate(self._robots)
            for section in self._servers()
        }
        self._declared = [self._as_nodes_read(robot) for robot in range(len(software))]
        for robot, named in enumerate(self._robots):
            node.ros.declare_param(named.namespace, sendable(robot_tree(self._software[robot], named, body)))
            node.ros.subscribe_param(named.namespace, partial(self._set, robot))
            for section in self._servers():
                self._offer(robot, section)

    def _servers(self) -> tuple[ReconfigureServer, ...]:
        """Return the dynamic_reconfigure servers of the nodes that are part of this session."""
        servers = reconfigure.reconfigure_servers()
        return tuple(section for section in servers if not self._is_external(section.name(ROBOT)))

    def _is_external(self, name: str) -> bool:
        """Return True for the name of an external node, or of a parameter of an external node."""
        node = next(iter(name.strip("/").split("/")[1:]), "")
        return self._external.amcl if node == "amcl" else self._external.move_base and node == MOVE_BASE

    def _as_nodes_read(self, robot: int) -> dict[str, ParameterValue]:
        """Return a robot's parameters as on the parameter server, by full name."""
        named = self._robots[robot]
        tree = robot_tree(self._software[robot], named, self._body)
        return cast(dict[str, ParameterValue], dict(leaves(named.namespace, tree)))

    def follow(self, software: Sequence[RobotParameters]) -> None:
        """Publish the parameters that changed in the last tick, also if a dead robot did not accept a change."""
        for robot, now in enumerate(software):
            before, self._software[robot] = self._software[robot], now
            if now is not before and now != before:
                changed = [path for path in reconfigurable() if value_at(now, path) != value_at(before, path)]
                self._publish_changes(robot, changed)

    def _offer(self, robot: int, section: ReconfigureServer) -> None:
        """Offer the dynamic_reconfigure server of a section."""
        name = section.name(self._robots[robot])
        described = self._node.advertise(f"{name}/parameter_descriptions", types.CONFIG_DESCRIPTION, latched=True)
        described.publish(reconfigure.description(section))
        self._publish(robot, section)
        service = f"{name}/set_parameters"
        self._node.serve(service, types.RECONFIGURE, partial(self._reconfigure, robot, section, service))

    def _reconfigure(self, robot: int, section: ReconfigureServer, service: str, data: bytes) -> bytes | ServiceFailed:
        """Carry out a change by a client of dynamic_reconfigure; the response contains the resulting values."""
        if not self._limiter.admits(service, "clients"):
            return ServiceFailed("too many requests")
        changes = reconfigure.requested_changes(section, self._software[robot], data)
        if isinstance(changes, InvalidMessage):
            return ServiceFailed(changes.sentence)
        self._change(robot, changes, service)
        self._declare(robot)
        return self._publish(robot, section)

    def _set(self, robot: int, key: str, value: XmlRpcValue) -> None:
        """Process a change of a parameter on the parameter server, or of several parameters below one key.

        Valid changes act. After an invalid change, the old value is published again.
        """
        named, before, key = self._robots[robot], self._software[robot], key.rstrip("/")
        given = {name: leaf for name, leaf in leaves(key, value) if not self._is_external(name)}
        declared = {name: leaf for name, leaf in self._declared[robot].items() if not self._is_external(name)}
        # A value that is equal to the present value is no change, so that clients can load a dump of all parameters.
        new = {name: leaf for name, leaf in given.items() if leaf != declared.get(name)}
        changes = [
            (path, _readable(leaf))
            for name, leaf in new.items()
            if (path := path_of(named, name)) and has(before, path)
        ]
        for name in new.keys() & declared.keys() - {name_of(named, path) for path, _ in changes}:
            self._complaints.warn(f"{name} keeps its value: this parameter is fixed for robots of this study")
        if self._limiter.admits(key, "clients"):
            self._change(robot, changes, named.topic("parameters"))
        # When a client sets a section, the server deletes parameters that the client omits. They are declared again.
        replaced = {name for name in declared if name == key or name.startswith(f"{key}/")}
        self._publish_changes(
            robot, [path for path, _ in changes], {n for n in replaced if declared[n] != given.get(n)}
        )

    def _change(self, robot: int, changes: Sequence[tuple[str, SetValue]], sender: str) -> None:
        """Change parameters together. If the changes are not valid together, make each valid change separately."""
        whole = with_values(self._software[robot], changes)
        for values in [changes] if not isinstance(whole, ParameterRejection) else [[one] for one in changes]:
            after = with_values(self._software[robot], values)
            if isinstance(after, ParameterRejection):
                self._complaints.warn(f"{name_of(self._robots[robot], after.path)} keeps its value: {after.sentence}")
            elif after != self._software[robot]:
                self._software[robot] = after
                self._ask(sender, SetParameters(robot, tuple(values)))

    def _publish_changes(self, robot: int, paths: Sequence[str], lost: Collection[str] = ()) -> None:
        """Publish the values of some parameters, on the parameter server and by dynamic_reconfigure.

        Args:
            robot: index of the robot.
            paths: paths of the parameters.
            lost: names of parameters that are missing on the server, or have another value there.
        """
        self._declare(robot, lost)
        touched = {path.rpartition(".")[0] for path in paths}
        for section in self._servers():
            if section.path in touched:
                self._publish(robot, section)

    def _declare(self, robot: int, lost: Collection[str] = ()) -> None:
        """Set the parameters that have changed or are missing on the parameter server."""
        before, now = self._declared[robot], self._as_nodes_read(robot)
        self._declared[robot] = now
        for name, value in now.items():
            if name in lost or value != before.get(name):
                self._node.ros.declare_param(name, sendable(value))

    def _publish(self, robot: int, section: ReconfigureServer) -> bytes:
        """Publish the values of a section to clients of dynamic_reconfigure, and return the message."""
        now = reconfigure.config(section, self._software[robot])
        self._updates[robot, section.path].publish(now)
        return now


def sendable(value: ParameterValue) -> XmlRpcValue:
    """Return the unchanged value of a parameter, with the declared type of values on the parameter server."""
    return cast(XmlRpcValue, value)


def _readable(value: object) -> SetValue:
    """Return the value of a parameter in the form for requests. Lists, such as footprints, become text."""
    return value if isinstance(value, bool | int | float | str | None) else json.dumps(value, default=str)
