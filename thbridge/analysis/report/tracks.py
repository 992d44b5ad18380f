"""Assignment of topics to robots, and choice of each robot's truth, odometry and estimate."""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from thbridge.analysis.report.paths import corrected, distance, errors, relocations
from thbridge.analysis.report.report import GoalAttempt, Track
from thbridge.analysis.report.sound_paths import RECORDED, STAMPED, SoundPath, sound_path, unfit_stamps
from thbridge.analysis.report.ways_made import WaysMade
from thbridge.files.disk.spool import SpoolFile
from thbridge.files.tables.number_rows import NumberRows
from thbridge.ros.messages.plausible import LARGEST
from thbridge.ros.names import frame_name
from thbridge.ros.odometry_faults import FaultKind, fault_sentences
from thbridge.ros.robots import (
    ODOM_FRAME,
    by_number,
    is_map_frame,
    is_odom_frame,
    is_truth,
    last_word,
    owner_of,
    owner_of_edge,
    prefix_of,
    robots_among,
    usual_first,
)

UNDER_WAY = "under way"
BATTERIES = ("battery", "battery_state")
COMMANDS = ("cmd_vel",)
ESTIMATES = ("amcl_pose", "robot_pose", "slam_out_pose", "tracked_pose")
NO_ESTIMATES = ("initialpose", "goal", "current_goal", "target", "believed_pose")
"""Topics of poses on the map that are goals, or guesses of people."""
BASES = ("base_footprint", "base_link")


MOST_POSES = 500_000
"""Maximum number of poses of all robots' paths in a report; from longer recordings, every n-th pose is kept."""


@dataclass(frozen=True, slots=True)
class TrajectoryTopics:
    """Topics that the user names as a robot's trajectories, regardless of their names.

    Attributes:
        truth: topic of the robot's true poses. If None, the topic is found by name.
        estimate: topic of the robot's estimated poses. If None, the topic is found by name.
    """

    truth: str | None = None
    estimate: str | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Topics that were named."""
        return tuple(name for name in (self.truth, self.estimate) if name is not None)


FOUND_BY_NAME = TrajectoryTopics()
BY_RECORDING = "truth and estimate are compared by the time of recording"
"""Beginning of the note about unusable headers."""


@dataclass(slots=True)
class PoseSeries:
    """Poses of one topic or transform over time.

    Attributes:
        frame: frame of the poses.
        child: frame that the poses describe; "" if unknown.
        rows: rows of time of recording, stamp, x, y, theta; a stamp of 0 is NaN.
        speeds: rows of time, m/s, rad/s.
        deviations: rows of time of recording, stamp, standard deviations of position (m) and heading (rad).
    """

    frame: str
    child: str
    rows: NumberRows
    speeds: NumberRows
    deviations: NumberRows

    def add(self, time: float, stamp: float, pose: Pose2) -> None:
        """Append a pose."""
        self.rows.extend((time, stamp, pose.x, pose.y, pose.theta))


@dataclass(slots=True)
class SeriesByTopic:
    """Data of robots over time, by topic.

    Attributes:
        named: topics of one robot's trajectories, if the user named them; then this is the only robot.
        spool: storage of the numbers.
        odometry: poses of type nav_msgs/Odometry.
        poses: poses of types geometry_msgs/PoseWithCovarianceStamped and PoseStamped.
        edges: transforms whose parent is a map or odometry, by namespace of the tf topic, parent and child.
        energy: rows of time, energy left.
        commands: rows of time, m/s, rad/s.
        goals: ids of the current goals, with the time when they were set.
        attempts: goals that ended.
        `carried`: times at which a robot was picked up and moved, by the name of the robot.
        ways_made: times in which robots made way for other robots.
        left_out: number of rows that `plausible` omitted, by topic.
    """

    named: TrajectoryTopics = FOUND_BY_NAME
    spool: SpoolFile = field(default_factory=SpoolFile)
    odometry: dict[str, PoseSeries] = field(default_factory=dict)
    poses: dict[str, PoseSeries] = field(default_factory=dict)
    edges: dict[tuple[str, str, str], PoseSeries] = field(default_factory=dict)
    energy: defaultdict[str, NumberRows] = field(init=False)
    commands: defaultdict[str, NumberRows] = field(init=False)
    goals: defaultdict[str, dict[str, float]] = field(default_factory=lambda: defaultdict(dict))
    attempts: defaultdict[str, list[GoalAttempt]] = field(default_factory=lambda: defaultdict(list))
    carried: defaultdict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    ways_made: WaysMade = field(default_factory=WaysMade)
    left_out: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        self.energy, self.commands = defaultdict(self.numbers), defaultdict(self.numbers)

    def numbers(self) -> NumberRows:
        """Return an empty series of numbers."""
        return NumberRows(self.spool)

    def poses_of(self, frame: str, child: str) -> PoseSeries:
        """Return an empty series of poses."""
        return PoseSeries(frame, child, self.numbers(), self.numbers(), self.numbers())

    def plausible(self, topic: str, rows: FloatArray, times: int = 0) -> FloatArray:
        """Return a topic's rows that figures can show; count its other rows. The first `times` columns are times."""
        good = (np.abs(rows[:, times:]) <= LARGEST).all(axis=1)  # NaN fails it
        if good.all():
            return rows
        self.left_out[topic] += int(np.count_nonzero(~good))
        return rows[good]

    def left_out_sentences(self) -> tuple[str, ...]:
        """Return sentences about rows that `plausible` omitted."""
        return tuple(
            f"{count} values of {topic} are omitted: they are not finite, or beyond {LARGEST:.0e}."
            for topic, count in self.left_out.items()
        )

    def tracks(self, duration: float) -> Iterator[Track]:
        """Yield the track of each robot, in the order of their numbers."""
        robots = self._robots()
        wanted = {owner_of(self.named.names[0], robots) if robots else ""} if self.named.names else robots
        return (self._track(robot, robots | wanted, duration) for robot in sorted(wanted, key=by_number))

    def thinned_tracks(self, duration: float) -> tuple[Track, ...]:
        """Return the tracks of all robots, with at most `MOST_POSES` poses of a kind in total."""
        most = max(1, MOST_POSES // max(1, len(self._robots())))
        return tuple(_thinned(track, most) for track in self.tracks(duration))

    def _robots(self) -> frozenset[str]:
        """Return the names of the robots: prefixes of frames, and namespaces; "" for a robot without either."""
        odometry = {topic: poses.child for topic, poses in self.odometry.items()}
        edges = (key for key, poses in self.edges.items() if is_odom_frame(poses.frame))
        found = robots_among(odometry, edges, (*self.energy, *self.goals, *self.attempts, *_estimates(self.poses)))
        # Robots may be known only by the commands that they received.
        return found or robots_among({}, (), (topic for topic in self.commands if last_word(topic) in COMMANDS))

    def _track(self, robot: str, robots: frozenset[str], duration: float) -> Track:
        sources = _Sources(self, robot, robots)
        paths = sources.paths()
        kidnapped = np.array(self.carried.get(robot, ()), dtype=np.float64)
        if len(paths.truth.cuts) and not len(kidnapped):
            sources.notes.append(f"the truth jumps {len(paths.truth.cuts)} times without a drive")
        if not len(paths.truth.rows) and len(paths.relocated):
            sources.notes.append(f"the estimate jumps {len(paths.relocated)} times without a drive")
        carried = np.union1d(kidnapped, paths.truth.cuts)
        cut_paths = (
            (paths.truth.rows, carried),
            (paths.estimate, paths.relocated),
            (paths.odometry.rows, paths.odometry.cuts),
        )
        attempts = [attempt for topic in sources.own(self.attempts) for attempt in self.attempts[topic]]
        attempts += [
            GoalAttempt(start, duration, UNDER_WAY, "")
            for topic in sources.own(self.goals)
            for start in self.goals[topic].values()
        ]
        return Track(
            name=robot or "robot",
            truth=paths.truth.rows,
            estimate=paths.estimate,
            errors=errors(paths.estimate, paths.truth.rows),
            energy=_first(self.energy, sources.own(self.energy), BATTERIES, 2),
            attempts=tuple(sorted(attempts, key=lambda attempt: attempt.start)),
            distance=next((distance(path, cuts) for path, cuts in cut_paths if len(path)), 0.0),
            odometry=paths.odometry.rows,
            speeds=paths.speeds,
            commands=_first(self.commands, sources.own(self.commands), COMMANDS, 3),
            deviations=paths.deviations,
            sources=tuple(sources.notes),
            carried=carried,
            relocated=paths.relocated,
            ways_made=self.ways_made.of(robot, duration),
            reset=paths.odometry.cuts,
            faults=paths.faults,
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Paths:
    """Poses of one robot over time, as in `Track`.

    Attributes:
        faults: sentences about poses that cannot be the motion of a robot.
    """

    truth: SoundPath
    estimate: FloatArray
    relocated: FloatArray
    odometry: SoundPath
    speeds: FloatArray
    deviations: FloatArray
    faults: tuple[str, ...]


class _Taken(NamedTuple):
    """Poses, with the name of their topic or transform."""

    name: str
    poses: PoseSeries

    @property
    def rows(self) -> FloatArray:
        return self.poses.rows.table(5)


class _Sources:
    """Choice of one robot's truth, odometry and estimate among topics and transforms.

    Attributes:
        notes: sentences about the chosen topics, for people.
    """

    def __init__(self, by_topic: SeriesByTopic, robot: str, robots: frozenset[str]) -> None:
        self.notes: list[str] = []
        self._robot, self._robots = robot, robots
        self._named, self._all = by_topic.named, {**by_topic.odometry, **by_topic.poses}
        self._nothing = _Taken("", by_topic.poses_of("", ""))
        self._odometry = self._own_poses(by_topic.odometry)
        self._poses = self._own_poses(by_topic.poses)
        self._edges = {
            f"tf {poses.frame} -> {poses.child}": poses
            for key, poses in by_topic.edges.items()
            if owner_of_edge(key) == robot or len(robots) == 1
        }

    def own(self, topics: Iterable[str]) -> list[str]:
        """Return the topics that belong to the robot."""
        return [topic for topic in topics if owner_of(topic, self._robots) == self._robot]

    def paths(self) -> _Paths:
        """Return the robot's poses over time. The times are stamps if the truth and the estimate have usable stamps."""
        truth, odometry = self._truth(), self._odometry_taken()
        estimate, corrections = self._estimate(odometry)
        believed = odometry if corrections is not None else estimate
        true_rows, believed_rows = truth.rows, believed.rows
        unfit = [(each.name, unfit_stamps(rows)) for each, rows in ((truth, true_rows), (believed, believed_rows))]
        reasons = [f"the headers of {name} {reason}" for name, reason in unfit if reason is not None]
        if reasons and len(true_rows) and len(believed_rows):
            self.notes.append(f"{BY_RECORDING}, because {' and '.join(dict.fromkeys(reasons))}")
        true_path = sound_path(true_rows, not reasons)
        driven_rows = believed_rows if believed is odometry else odometry.rows
        driven = sound_path(driven_rows, not reasons if believed is odometry else unfit_stamps(driven_rows) is None)
        if corrections is None:
            direct = sound_path(believed_rows, not reasons, believed=True)
            estimated, relocated = direct.rows, direct.cuts
        else:
            known = corrections.rows[:, (RECORDED, 2, 3, 4)]
            estimated = corrected(driven.rows, driven.recorded, known)
            relocated = np.union1d(relocations(driven.rows, driven.recorded, known), driven.cuts)
        moved = (FaultKind.RESET, FaultKind.JUMP)  # in the truth, these mean that the robot was picked up and moved
        faults = (
            *fault_sentences(truth.name, [fault for fault in true_path.faults if fault.kind not in moved], 0),
            *fault_sentences(odometry.name, driven.faults, 0),
        )
        speeds, deviations = odometry.poses.speeds.table(3), self._admitted(not reasons)
        return _Paths(true_path, estimated, relocated, driven, speeds, deviations, faults)

    def _truth(self) -> _Taken:
        """Return the robot's true poses; no rows if there are none."""
        if self._named.truth is not None:
            return self._by_name("truth", self._named.truth)

        def known(topic: str, _: PoseSeries) -> bool:
            return is_truth(topic)

        truth = self._take("truth", (_chosen(self._odometry, known), ()), (_chosen(self._poses, known), ()))
        frame = truth.poses.frame
        if frame and not is_map_frame(frame):
            self.notes.append(f"the truth is in the frame {frame_name(frame)}, and is used as positions on the map")
        return truth

    def _odometry_taken(self) -> _Taken:
        """Return the robot's odometry; no rows if there is none."""
        topics = _chosen(self._odometry, lambda topic, series: not is_truth(topic) and not is_map_frame(series.frame))
        edges = _chosen(self._edges, lambda _, series: is_odom_frame(series.frame))
        return self._take("odometry", (topics, (ODOM_FRAME,)), (edges, ()))

    def _estimate(self, odometry: _Taken) -> tuple[_Taken, _Taken | None]:
        """Return the robot's estimated poses. If its odometry has corrections map -> odom, return these instead."""
        if self._named.estimate is not None:
            return self._by_name("estimate", self._named.estimate), None
        frame = frame_name(odometry.poses.frame)
        corrections = _chosen(
            self._edges, lambda _, series: is_map_frame(series.frame) and frame_name(series.child) == frame
        )
        if odometry.poses.rows and corrections:
            return self._nothing, self._take("estimate", (corrections, ()))
        fused = _chosen(self._odometry, lambda topic, series: not is_truth(topic) and is_map_frame(series.frame))
        direct = _chosen(self._edges, lambda _, series: is_map_frame(series.frame) and last_word(series.child) in BASES)
        return self._take("estimate", (_estimates(self._poses), ESTIMATES), (fused, ()), (direct, ())), None

    def _admitted(self, by_stamp: bool) -> FloatArray:
        """Return (d, 3) table of time and the standard deviations that the robot's localizer reports."""
        names = usual_first(_estimates(self._poses), ESTIMATES)
        if not names:
            return np.empty((0, 3))
        rows = self._poses[names[0]].deviations.table(4)
        by_stamp = by_stamp and not np.isnan(rows[:, STAMPED]).any()
        rows = rows[:, (STAMPED if by_stamp else RECORDED, 2, 3)]
        return rows[np.argsort(rows[:, 0], kind="stable")]

    def _by_name(self, what: str, topic: str) -> _Taken:
        """Return the poses of a topic that the user named."""
        self.notes.append(f"{what} from {topic}, as requested")
        return _Taken(topic, self._all[topic]) if topic in self._all else self._nothing

    def _own_poses(self, by_topic: Mapping[str, PoseSeries]) -> dict[str, PoseSeries]:
        """Return the poses of the robot, found by the prefix of the frame, or otherwise by the namespace."""
        named = self._robots - {""}
        return {
            topic: poses
            for topic, poses in by_topic.items()
            if (prefix if (prefix := prefix_of(poses.child)) in named else owner_of(topic, self._robots)) == self._robot
        }

    def _take(self, what: str, *choices: tuple[Mapping[str, PoseSeries], tuple[str, ...]]) -> _Taken:
        """Take the first choice that has poses, and return its poses with the most usual name; otherwise no rows."""
        for candidates, usual in choices:
            if names := usual_first(candidates, usual):
                others = f"; other topics: {', '.join(names[1:])}" if len(names) > 1 else ""
                self.notes.append(f"{what} from {names[0]}{others}")
                return _Taken(names[0], candidates[names[0]])
        return self._nothing


def _first(
    by_topic: Mapping[str, NumberRows], topics: Iterable[str], usual: tuple[str, ...], columns: int
) -> FloatArray:
    """Return (n, columns) table of the topic with the most usual name; without rows if there is no topic."""
    names = usual_first(topics, usual)
    return by_topic[names[0]].table(columns) if names else np.empty((0, columns))


def _thinned(track: Track, most: int) -> Track:
    """Return a track with about `most` poses of each kind, including the last pose. The distance is unchanged."""
    long = (track.truth, track.estimate, track.errors, track.odometry, track.speeds)
    every = -(-max(map(len, long)) // most)
    if every <= 1:
        return track
    truth, estimate, errors, odometry, speeds = (
        np.concatenate((path[: len(path) - 1 : every], path[-1:])) if len(path) else path for path in long
    )
    return replace(
        track,
        truth=truth,
        estimate=estimate,
        errors=errors,
        odometry=odometry,
        speeds=speeds,
        sources=(*track.sources, f"one pose in {every} is used, because there are very many"),
    )


def _chosen(by_topic: Mapping[str, PoseSeries], wanted: Callable[[str, PoseSeries], bool]) -> dict[str, PoseSeries]:
    return {name: poses for name, poses in by_topic.items() if wanted(name, poses)}


def _estimates(poses: Mapping[str, PoseSeries]) -> dict[str, PoseSeries]:
    """Return the poses on the map that may come from a localizer."""
    return _chosen(
        poses,
        lambda topic, series: (
            is_map_frame(series.frame) and not is_truth(topic) and last_word(topic) not in NO_ESTIMATES
        ),
    )


def deviations(time: float, covariance: FloatArray) -> tuple[float, float, float] | None:
    """Return a time and standard deviations of position (m) and heading (rad); None if the covariance is not valid."""
    position, heading = covariance[0, 0] + covariance[1, 1], covariance[2, 2]
    if not (0.0 <= position <= LARGEST and 0.0 <= heading <= LARGEST):
        return None
    return time, float(np.sqrt(position)), float(np.sqrt(heading))
