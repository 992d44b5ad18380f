"""The robots' parameters on a ROS graph: on the parameter server, and in the hands of dynamic_reconfigure.

Either way what may change acts, as a request that the session takes and records, and the other way tells of it.
"""

import json
import logging
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import cast

from sim.parameters import RobotParameters, reconfigurable
from sim.parameters.reconfiguration import ParameterRejection
from thbridge.app.rosgraph.rate_limiter import RateLimiter
from thbridge.app.rosgraph.typed_node import TypedNode
from thbridge.roles.robot_requests import ParameterValue as SetValue
from thbridge.roles.robot_requests import Request, SetParameters, with_values
from thbridge.ros import reconfigure
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import types
from thbridge.ros.names import RobotNames
from thbridge.ros.parameters import ParameterValue, has, leaves, name_of, path_of, robot_tree, value_at
from thbridge.ros.reconfigure import ReconfigureServer
from thbridge.sockets.rosgraph.connections import WarnOnce
from thbridge.wire.rosgraph.links import ServiceFailed
from thbridge.wire.rosgraph.xmlrpc import XmlRpcValue

_log = logging.getLogger(__name__)


class LiveParameters:
    """What the robots' parameters are now, for everybody on the graph who looks or turns them.

    Differs: in ROS a parameter that is set on the parameter server is read once, when its node starts; here it acts at
    once, as by dynamic_reconfigure.

    Args:
        node: says and hears it all.
        software: of each robot, as it begins.
        door: says when somebody turns them too often.
        ask: takes what is asked of the robots, with the name of the parameters or of the service that was asked.
    """

    def __init__(
        self,
        node: TypedNode,
        software: Sequence[RobotParameters],
        limiter: RateLimiter,
        ask: Callable[[str, Request], None],
    ) -> None:
        self._node = node
        self._software = list(software)
        self._door = limiter
        self._ask = ask
        self._complaints = WarnOnce(_log)
        self._robots = [RobotNames.of(robot) for robot in range(len(software))]
        self._updates = {
            (robot, section.path): node.advertise(
                f"{section.name(named)}/parameter_updates", types.CONFIG, latched=True
            )
            for robot, named in enumerate(self._robots)
            for section in reconfigure.reconfigure_servers()
        }
        for robot, named in enumerate(self._robots):
            node.ros.declare_param(named.namespace, sendable(robot_tree(self._software[robot])))
            node.ros.subscribe_param(named.namespace, partial(self._set, robot))
            for section in reconfigure.reconfigure_servers():
                self._offer(robot, section)

    def follow(self, software: Sequence[RobotParameters]) -> None:
        """A tick has passed: tell what has changed, whoever changed it, and what has not since its robot was dead."""
        for robot, now in enumerate(software):
            before, self._software[robot] = self._software[robot], now
            if now is not before and now != before:
                self._tell(robot, [path for path in reconfigurable() if value_at(now, path) != value_at(before, path)])

    def _offer(self, robot: int, section: ReconfigureServer) -> None:
        """Be the dynamic_reconfigure server of a section."""
        name = section.name(self._robots[robot])
        described = self._node.advertise(f"{name}/parameter_descriptions", types.CONFIG_DESCRIPTION, latched=True)
        described.publish(reconfigure.description(section))
        self._publish(robot, section)
        service = f"{name}/set_parameters"
        self._node.serve(service, types.RECONFIGURE, partial(self._reconfigure, robot, section, service))

    def _reconfigure(self, robot: int, section: ReconfigureServer, service: str, data: bytes) -> bytes | ServiceFailed:
        """A client of dynamic_reconfigure turns parameters; the answer is what they are then."""
        if not self._door.admits(service, "clients"):
            return ServiceFailed("it is asked too often")
        changes = reconfigure.requested_changes(section, self._software[robot], data)
        if isinstance(changes, InvalidMessage):
            return ServiceFailed(changes.sentence)
        self._change(robot, changes, service)
        self._declare(robot, (path for path, _ in changes))
        return self._publish(robot, section)

    def _set(self, robot: int, key: str, value: XmlRpcValue) -> None:
        """Somebody set a parameter, or many below one key: what may change acts, the rest is put back."""
        named, before = self._robots[robot], self._software[robot]
        given = [
            (path, _readable(leaf)) for name, leaf in leaves(key.rstrip("/"), value) if (path := path_of(named, name))
        ]
        # Anybody may keep parameters of their own beside ours.
        changes = [(path, leaf) for path, leaf in given if has(before, path) and leaf != value_at(before, path)]
        if self._door.admits(key, "clients"):
            self._change(robot, changes, named.topic("parameters"))
        # Also what was set as it stands: a master that is restarted hears of it only from us.
        self._tell(robot, [path for path, _ in changes])

    def _change(self, robot: int, changes: Sequence[tuple[str, SetValue]], sender: str) -> None:
        """Turn parameters: what cannot be done together is done one by one, as far as it goes."""
        whole = with_values(self._software[robot], changes)
        for values in [changes] if not isinstance(whole, ParameterRejection) else [[one] for one in changes]:
            after = with_values(self._software[robot], values)
            if isinstance(after, ParameterRejection):
                self._complaints.tell(f"{name_of(self._robots[robot], after.path)} keeps its value: {after.sentence}")
            elif after != self._software[robot]:
                self._software[robot] = after
                self._ask(sender, SetParameters(robot, tuple(values)))

    def _tell(self, robot: int, paths: Sequence[str]) -> None:
        """Tell everybody what some parameters are now."""
        self._declare(robot, paths)
        touched = {path.rpartition(".")[0] for path in paths}
        for section in reconfigure.reconfigure_servers():
            if section.path in touched:
                self._publish(robot, section)

    def _declare(self, robot: int, paths: Iterable[str]) -> None:
        """Tell the parameter server what some parameters are now."""
        for path in paths:
            now = value_at(self._software[robot], path)
            if now is not None:
                self._node.ros.declare_param(name_of(self._robots[robot], path), sendable(now))

    def _publish(self, robot: int, section: ReconfigureServer) -> bytes:
        """Tell dynamic_reconfigure's clients what a section's parameters are now; returns what they are told."""
        now = reconfigure.config(section, self._software[robot])
        self._updates[robot, section.path].publish(now)
        return now


def sendable(value: ParameterValue) -> XmlRpcValue:
    """A parameter's value as the parameter server takes it: the same, which types cannot tell."""
    return cast(XmlRpcValue, value)


def _readable(value: object) -> SetValue:
    """A parameter's value as requests hold it: lists, such as footprints, as text."""
    return value if isinstance(value, bool | int | float | str | None) else json.dumps(value, default=str)
