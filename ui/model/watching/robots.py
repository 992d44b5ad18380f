"""Recognition of robots in a stream of messages, and of the topics of each robot."""

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

from sim.common.robot_numbers import index_of, robot_name
from thbridge.analysis.report.tracks import BATTERIES, ESTIMATES, NO_ESTIMATES
from thbridge.ros.messages import types, unpack
from thbridge.ros.names import frame_name
from thbridge.ros.robots import (
    ODOM_FRAME,
    by_number,
    is_map_frame,
    is_odom_frame,
    is_truth,
    last_word,
    owner_of,
    prefix_of,
    robots_among,
    usual_first,
)
from ui.model.watching.frames import namespace_of_tf
from ui.model.watching.messages import TF_TYPES, WatchedMessage

_ONLY_ROBOTS = frozenset({types.BATTERY_STATE, types.MOVE_BASE_GOAL, types.MOVE_BASE_RESULT})
_OURS = re.compile(r"robot([1-9][0-9]*)")


@dataclass(frozen=True, slots=True)
class WatchedRobot:
    """Robot with the names of its topics; None if the robot has no such topic.

    Attributes:
        robot: index of the robot; if robots are called robot1, robot2, ..., the index in the team.
        key: namespace of the robot, or prefix of the robot's frames; "" if there is none.
        name: name for people.
        base: frame of the robot's base.
        truth: poses from a simulator or from motion capture.
        odom: wheel odometry.
        estimate: poses from the localizer, with covariance.
        cloud: particles.
        scan: laser scans.
        battery: energy.
        goal: goals of the action move_base; the other topics of the action have the same namespace.
        status: states of goals.
        result: results of goals.
        plan: plans of the global planner.
        local_plan: plans of the local planner.
        global_costmap: global costmap, as an occupancy grid.
        local_costmap: local costmap, as an occupancy grid.
        footprint: outline of the robot's body.
    """

    robot: int
    key: str
    name: str
    base: str
    truth: str | None = None
    odom: str | None = None
    estimate: str | None = None
    cloud: str | None = None
    scan: str | None = None
    battery: str | None = None
    goal: str | None = None
    status: str | None = None
    result: str | None = None
    plan: str | None = None
    local_plan: str | None = None
    global_costmap: str | None = None
    local_costmap: str | None = None
    footprint: str | None = None


@dataclass(slots=True)
class RobotDiscovery:
    """Recognition of robots by topics and frames; a few messages of each topic are enough.

    Attributes:
        topics: types of topics, by topic name.
        children: child frames of odometry messages, by topic name.
        edges: transforms in tf whose parent is an odometry frame, as (namespace, parent, child).
        mapped: True if a message with a map has arrived.
    """

    topics: dict[str, str] = field(default_factory=dict)
    children: dict[str, str] = field(default_factory=dict)
    edges: set[tuple[str, str, str]] = field(default_factory=set)
    mapped: bool = False

    def take(self, message: WatchedMessage) -> None:
        """Add a message. If the content is unreadable, only the topic is used."""
        self.topics[message.topic] = message.msgtype
        self.mapped |= message.msgtype == types.OCCUPANCY_GRID and "costmap" not in message.topic
        try:
            if message.msgtype == types.ODOMETRY:
                self.children[message.topic] = unpack.odometry(message.data).child_frame
            elif message.msgtype in TF_TYPES:
                for _, (parent, child, _) in unpack.transforms(message.data):
                    self.mapped |= is_map_frame(parent)
                    if is_odom_frame(parent):
                        self.edges.add((namespace_of_tf(message.topic), frame_name(parent), frame_name(child)))
        except ValueError:
            return

    def robots(self) -> tuple[WatchedRobot, ...]:
        """Return the robots, in the order of their numbers."""
        others = [
            topic
            for topic, msgtype in self.topics.items()
            if msgtype in _ONLY_ROBOTS or (msgtype == types.POSE_WITH_COVARIANCE and _is_belief(topic))
        ]
        keys = sorted(robots_among(self.children, self.edges, others), key=by_number)
        numbers = [_OURS.fullmatch(key) for key in keys]
        ours = bool(keys) and all(numbers)
        return tuple(
            self._watched_robot(index_of(int(number[1])) if ours and number else index, key, frozenset(keys), ours)
            for index, (key, number) in enumerate(zip(keys, numbers, strict=True))
        )

    def _watched_robot(self, robot: int, key: str, keys: frozenset[str], ours: bool) -> WatchedRobot:
        own = {topic: msgtype for topic, msgtype in self.topics.items() if self._owner(topic, keys) == key}
        odom = _first(own, types.ODOMETRY, lambda topic: not is_truth(topic), (ODOM_FRAME,))
        truth = _first(own, types.ODOMETRY, is_truth, ())
        truth = truth or _first(own, types.POSE_STAMPED, is_truth, ())
        truth = truth or _first(own, types.POSE_WITH_COVARIANCE, is_truth, ())
        base = self.children.get(odom or "", "") or next(
            (child for _, _, child in sorted(self.edges) if prefix_of(child) == key or len(keys) == 1), ""
        )
        # Other actions than move_base also have topics for goals and states.
        moves = {topic: msgtype for topic, msgtype in own.items() if "move_base" in topic}
        return WatchedRobot(
            robot=robot,
            key=key,
            name=robot_name(robot) if ours or not key else key,
            base=frame_name(base),
            truth=truth,
            odom=odom,
            estimate=_first(own, types.POSE_WITH_COVARIANCE, _is_belief, ESTIMATES),
            cloud=_first(own, types.POSE_ARRAY, _any, ("particlecloud",)),
            scan=_first(own, types.LASER_SCAN, _any, ("scan", "base_scan")),
            battery=_first(own, types.BATTERY_STATE, _any, BATTERIES),
            goal=_first(moves, types.MOVE_BASE_GOAL, _any, ("goal",)),
            status=_first(moves, types.GOAL_STATUS_ARRAY, _any, ("status",)),
            result=_first(moves, types.MOVE_BASE_RESULT, _any, ("result",)),
            plan=_first(moves, types.PATH, lambda topic: last_word(topic) == "plan", ()),
            local_plan=_first(moves, types.PATH, lambda topic: last_word(topic) == "local_plan", ()),
            global_costmap=_first(moves, types.OCCUPANCY_GRID, lambda topic: "global_costmap" in topic, ("costmap",)),
            local_costmap=_first(moves, types.OCCUPANCY_GRID, lambda topic: "local_costmap" in topic, ("costmap",)),
            footprint=_first(moves, types.POLYGON_STAMPED, lambda topic: "local" in topic, ("footprint",))
            or _first(moves, types.POLYGON_STAMPED, _any, ("footprint",)),
        )

    def _owner(self, topic: str, keys: Collection[str]) -> str:
        """Return the key of a topic's robot.

        It is the prefix of the frame in the topic's messages if a robot has this prefix; otherwise the namespace.
        """
        prefix = prefix_of(self.children.get(topic, ""))
        return prefix if prefix and prefix in keys else owner_of(topic, keys)


def _first(
    topics: Mapping[str, str], msgtype: str, wanted: Callable[[str], bool], usual: tuple[str, ...]
) -> str | None:
    """Return the wanted topic of this type that has the usual name; if there is none, return the first topic."""
    found = usual_first(
        (topic for topic, found_type in topics.items() if found_type == msgtype and wanted(topic)), usual
    )
    return found[0] if found else None


def _any(topic: str) -> bool:
    return True


def _is_belief(topic: str) -> bool:
    return not is_truth(topic) and last_word(topic) not in NO_ESTIMATES
