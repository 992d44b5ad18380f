"""Robots out of what was heard of them: which topic is whose, and which are truth, odometry, estimate."""

from array import array
from collections import defaultdict
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from sim.geometry import FloatArray, Pose2
from thbridge.bags.report.paths import corrected, distance, errors, table
from thbridge.bags.report.values import Leg, Track
from thbridge.ros.frames import frame_name
from thbridge.ros.robots import (
    is_map_frame,
    is_odom_frame,
    is_truth,
    last_word,
    namespace_of,
    owner_of,
    prefix_of,
    usual_first,
)

UNDER_WAY = "under way"
BATTERIES = ("battery", "battery_state")
COMMANDS = ("cmd_vel",)
ESTIMATES = ("amcl_pose", "robot_pose", "slam_out_pose", "tracked_pose")
NO_ESTIMATES = ("initialpose", "goal", "current_goal", "target")
"""Poses on the map that somebody wants, or says."""
BASES = ("base_footprint", "base_link")


def numbers() -> "array[float]":
    """Room for rows of numbers, one behind the other: hours of them fit."""
    return array("d")


@dataclass(slots=True)
class Poses:
    """Poses of one topic or transform.

    Attributes:
        frame: that they are in.
        child: whose they are; "" where nobody says.
        rows: time, x, y, theta, again and again.
        speeds: time, m/s, rad/s, likewise.
        deviations: time, standard deviations of position and heading, likewise.
    """

    frame: str
    child: str
    rows: "array[float]" = field(default_factory=numbers)
    speeds: "array[float]" = field(default_factory=numbers)
    deviations: "array[float]" = field(default_factory=numbers)

    def add(self, time: float, pose: Pose2) -> None:
        """Append a pose."""
        self.rows.extend((time, pose.x, pose.y, pose.theta))


@dataclass(slots=True)
class Heard:
    """What was heard of robots, by topic.

    Attributes:
        odometry: of type nav_msgs/Odometry.
        poses: of types geometry_msgs/PoseWithCovarianceStamped and PoseStamped.
        edges: of tf, by the namespace of its topic, parent and child; those only whose parent is a map or odometry.
        energy: time, what is left.
        commands: time, m/s, rad/s.
        goals: by topic: name of the goal, when it was set; those under way.
        legs: by topic: goals that ended.
    """

    odometry: dict[str, Poses] = field(default_factory=dict)
    poses: dict[str, Poses] = field(default_factory=dict)
    edges: dict[tuple[str, str, str], Poses] = field(default_factory=dict)
    energy: "defaultdict[str, array[float]]" = field(default_factory=lambda: defaultdict(numbers))
    commands: "defaultdict[str, array[float]]" = field(default_factory=lambda: defaultdict(numbers))
    goals: defaultdict[str, dict[str, float]] = field(default_factory=lambda: defaultdict(dict))
    legs: defaultdict[str, list[Leg]] = field(default_factory=lambda: defaultdict(list))

    def tracks(self, duration: float) -> tuple[Track, ...]:
        """One for each robot, in the order of their numbers."""
        robots = self._robots()
        return tuple(self._track(robot, robots, duration) for robot in sorted(robots, key=_by_number))

    def _robots(self) -> frozenset[str]:
        """Prefixes of frames and namespaces that are robots; "" is one without."""
        found = {prefix_of(poses.child) or namespace_of(topic) for topic, poses in self.odometry.items()}
        if not found:
            found |= {_owner_of_edge(key) for key, poses in self.edges.items() if is_odom_frame(poses.frame)}
        for topic in (*self.energy, *self.goals, *self.legs, *_estimates(self.poses)):
            found.add(owner_of(topic, found) if found else namespace_of(topic))
        named = found - {""}
        return frozenset(named if len(named) == 1 else found)

    def _track(self, robot: str, robots: frozenset[str], duration: float) -> Track:
        def own(topics: Iterable[str]) -> list[str]:
            return [topic for topic in topics if owner_of(topic, robots) == robot]

        def own_poses(heard: dict[str, Poses]) -> dict[str, Poses]:
            return {
                topic: poses
                for topic, poses in heard.items()
                if (prefix_of(poses.child) if prefix_of(poses.child) in robots - {""} else owner_of(topic, robots))
                == robot
            }

        edges = {
            f"tf {poses.frame} -> {poses.child}": poses
            for key, poses in self.edges.items()
            if _owner_of_edge(key) == robot or len(robots) == 1
        }
        odometry_topics, pose_topics = own_poses(self.odometry), own_poses(self.poses)
        sources = []

        def take(what: str, candidates: dict[str, Poses], usual: tuple[str, ...] = ()) -> Poses | None:
            names = usual_first(candidates, usual)
            if not names:
                return None
            others = f"; there is also {', '.join(names[1:])}" if len(names) > 1 else ""
            sources.append(f"{what} from {names[0]}{others}")
            return candidates[names[0]]

        truth = take("truth", _chosen(odometry_topics, lambda topic, _: is_truth(topic))) or take(
            "truth", _chosen(pose_topics, lambda topic, _: is_truth(topic))
        )
        if truth is not None and truth.frame and not is_map_frame(truth.frame):
            sources.append(f"the truth is in the frame {frame_name(truth.frame)}, and is taken as places on the map")
        counted = _chosen(odometry_topics, lambda topic, poses: not is_truth(topic) and not is_map_frame(poses.frame))
        odometry = take("odometry", counted, ("odom",)) or take(
            "odometry", _chosen(edges, lambda _, poses: is_odom_frame(poses.frame)), BASES
        )
        estimate = np.empty((0, 4))
        corrections = _chosen(
            edges,
            lambda _, poses: odometry is not None and frame_name(poses.child) == frame_name(odometry.frame),
        )
        if odometry is not None and (correction := take("estimate", corrections)) is not None:
            estimate = corrected(table(odometry.rows, 4), table(correction.rows, 4))
        else:
            for kind, usual in (
                (_estimates(pose_topics), ESTIMATES),
                (_chosen(odometry_topics, lambda topic, poses: not is_truth(topic) and is_map_frame(poses.frame)), ()),
                (_chosen(edges, lambda _, poses: last_word(poses.child) in BASES and is_map_frame(poses.frame)), BASES),
            ):
                if (found := take("estimate", kind, usual)) is not None:
                    estimate = table(found.rows, 4)
                    break
        admitted = next(
            (pose_topics[name].deviations for name in usual_first(_estimates(pose_topics), ESTIMATES)), numbers()
        )
        energy = next((self.energy[name] for name in usual_first(own(self.energy), BATTERIES)), numbers())
        commands = next((self.commands[name] for name in usual_first(own(self.commands), COMMANDS)), numbers())
        legs = [leg for topic in own(self.legs) for leg in self.legs[topic]]
        legs += [
            Leg(start, duration, UNDER_WAY, "") for topic in own(self.goals) for start in self.goals[topic].values()
        ]
        true_path = table(truth.rows if truth is not None else numbers(), 4)
        driven = table(odometry.rows if odometry is not None else numbers(), 4)
        return Track(
            name=robot or "robot",
            truth=true_path,
            estimate=estimate,
            errors=errors(estimate, true_path),
            energy=table(energy, 2),
            legs=tuple(sorted(legs, key=lambda leg: leg.start)),
            distance=distance(next((path for path in (true_path, estimate, driven) if len(path)), true_path)),
            odometry=driven,
            speeds=table(odometry.speeds if odometry is not None else numbers(), 3),
            commands=table(commands, 3),
            deviations=table(admitted, 3),
            sources=tuple(sources),
        )


def _chosen(heard: dict[str, Poses], wanted: Callable[[str, Poses], bool]) -> dict[str, Poses]:
    return {name: poses for name, poses in heard.items() if wanted(name, poses)}


def _estimates(poses: dict[str, Poses]) -> dict[str, Poses]:
    """Poses on the map that may be a localiser's."""
    return _chosen(
        poses,
        lambda topic, said: is_map_frame(said.frame) and not is_truth(topic) and last_word(topic) not in NO_ESTIMATES,
    )


def _owner_of_edge(key: tuple[str, str, str]) -> str:
    """Whose a transform is: as the prefix of a frame says, else the namespace of its tf."""
    namespace, parent, child = key
    return prefix_of(child) or prefix_of(parent) or namespace


def _by_number(robot: str) -> tuple[int, str]:
    """robot2 before robot10."""
    digits = "".join(sign for sign in robot if sign.isdigit())
    return int(digits or 0), robot


def deviations(time: float, covariance: FloatArray) -> tuple[float, float, float] | None:
    """A row of `Poses.deviations`; None where the covariance says nothing."""
    position, heading = covariance[0, 0] + covariance[1, 1], covariance[2, 2]
    if not (position >= 0.0 and heading >= 0.0):
        return None
    return time, float(np.sqrt(position)), float(np.sqrt(heading))
