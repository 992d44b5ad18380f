"""Messages of a session, tick by tick, in the same order for bags and live graphs."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import assert_never

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import TICKS_PER_SECOND, LaserMount
from sim.common.polygons import NO_POLYGONS, unpack_polygons
from sim.robot.software import PropagatedOutput, RobotOutput
from sim.snapshot import TeamSnapshot
from thbridge.ros.actionlib import ActionRequest, ActionServerMessage
from thbridge.ros.diagnostics import RobotDiagnostics
from thbridge.ros.messages import pack
from thbridge.ros.messages.pack import RoomLabel, Transform
from thbridge.ros.messages.records import (
    CancelRequest,
    GoalRequest,
    InitialPose,
    LogLine,
    Record,
    SendRobots,
    SimpleGoal,
    Success,
    VehicleFrame,
    VehicleRecord,
    VehicleState,
    VelocityCommand,
)
from thbridge.ros.messages.session_records import (
    DialogueMoveRecord,
    DialogueStateRecord,
    GameEvent,
    HeldTurns,
    InputRecord,
    ScoreRecord,
    SeatNotice,
    SessionRecord,
    TeamEvent,
    UtteranceRecord,
)
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros.names import GRAPH_LINK, MAP_FRAME, RobotNames
from thbridge.ros.one_robot import ODOMETRY_COVARIANCE, SHARED_PERIODS, Motion, RobotPublisher
from thbridge.ros.topics import (
    CLOCK,
    DIAGNOSTICS,
    DIALOGUE_MOVES,
    DIALOGUE_STATES,
    GAME_EVENTS,
    INPUTS,
    MAP,
    MAP_METADATA,
    ROOMS,
    ROSOUT,
    SCORE,
    SEND_ROBOTS,
    SESSION,
    SHOWN,
    SUCCESS,
    TEAM,
    TEAM_TOPICS,
    TF,
    TF_STATIC,
    THINGS,
    UTTERANCES,
    WIZARD,
    Planners,
    RosMessage,
    Topic,
    VehicleTopics,
)

__all__ = ["Planners", "RosMessage", "TeamPublisher", "Topic", "clock_message", "messages_of"]

THINGS_PERIOD = 5
"""Ticks between two messages about moving things. This is 10 Hz."""
DIAGNOSTICS_PERIOD = TICKS_PER_SECOND


def clock_message(tick: int) -> RosMessage:
    """Return the message of /clock for graphs in simulated time. Bags do not contain it: `rosbag play` publishes it."""
    return RosMessage(CLOCK, stamp_ns(tick), pack.clock(tick))


class TeamPublisher:
    """Converter of a team's ticks to the messages that its ROS nodes would publish.

    Args:
        robots: number of robots.
        mount: mounting of every robot's laser.
        scan_period: seconds between two scans of one robot.
        planners: names of each robot's planners. If None, they are move_base's default planners.
        rooms: names of the map's rooms.
        vehicles: True if the robots are also MAVLink vehicles.

    Attributes:
        robots: number of robots.

    Raises:
        ValueError: the numbers of robots and planners differ.
    """

    def __init__(
        self,
        robots: int,
        mount: LaserMount,
        scan_period: float,
        planners: Sequence[Planners] | None = None,
        rooms: Sequence[RoomLabel] = (),
        *,
        vehicles: bool = False,
    ) -> None:
        self.robots = robots
        self._laser_in_base = mount.laser_in_base
        self._rooms = rooms
        team = range(robots)
        named = [Planners() for _ in team] if planners is None else planners
        self._robots = [RobotPublisher(robot, scan_period, own) for robot, own in zip(team, named, strict=True)]
        self._vehicles = [VehicleTopics(RobotNames.of(robot)) for robot in team if vehicles]
        self._watches = [RobotDiagnostics(robot) for robot in team]
        self._true_rows = pack.OdometryRows(pack.NO_COVARIANCE)
        self._odometry_rows = pack.OdometryRows(ODOMETRY_COVARIANCE)
        self._truth: tuple[object, ...] = ()
        self._bodies = NO_POLYGONS
        self._bodies_tick = 0

    @property
    def topics(self) -> tuple[Topic, ...]:
        """All topics on which messages may be published, except the clock."""
        own = tuple(topic for robot in self._robots for topic in robot.topics.all())
        return TEAM_TOPICS + own + tuple(topic for robot in self._vehicles for topic in robot.all())

    def opening(self, tick: int, session: SessionRecord, grid: OccupancyGrid) -> list[RosMessage]:
        """Return the first messages, which are latched and published once: session, static transforms, map."""
        stamp = stamp_ns(tick)
        static = [
            transform
            for robot in self._robots
            for transform in (
                Transform(robot.names.base_footprint, robot.names.base_link, Pose2(0.0, 0.0, 0.0)),
                Transform(robot.names.base_link, robot.names.base_laser, self._laser_in_base),
            )
        ]
        messages = [
            RosMessage(SESSION, stamp, pack.session(tick, session)),
            RosMessage(TF_STATIC, stamp, pack.transforms(tick, static)),
            RosMessage(MAP, stamp, pack.occupancy_grid(tick, MAP_FRAME, grid)),
            RosMessage(MAP_METADATA, stamp, pack.map_meta_data(tick, grid)),
        ]
        if self._rooms:
            messages.append(RosMessage(ROOMS, stamp, pack.room_labels(tick, MAP_FRAME, self._rooms)))
        return messages

    def tick(self, snapshot: TeamSnapshot, records: Sequence[Record] = ()) -> list[RosMessage]:
        """Return the messages of a tick: inputs from outside, the robots in their order, then the other records.

        Raises:
            ValueError: the team has another number of robots than this publisher.
        """
        return self.ticks([(snapshot, records)])

    def ticks(self, ticks: Sequence[tuple[TeamSnapshot, Sequence[Record]]]) -> list[RosMessage]:
        """Return the messages of successive ticks: the same as `tick` for each of them, but much faster.

        Raises:
            ValueError: the team has another number of robots than this publisher.
        """
        motions = self._motions([snapshot for snapshot, _ in ticks])
        messages: list[RosMessage] = []
        for (snapshot, records), motion in zip(ticks, motions, strict=True):
            messages += self._tick(snapshot, motion, records)
        return messages

    def _tick(self, snapshot: TeamSnapshot, motion: Motion, records: Sequence[Record]) -> list[RosMessage]:
        tick, stamp = snapshot.tick, stamp_ns(snapshot.tick)
        requests: defaultdict[int, list[ActionRequest]] = defaultdict(list)
        messages: list[RosMessage] = []
        lines: list[LogLine] = []
        for record in records:
            if isinstance(record, InputRecord):
                messages.append(RosMessage(INPUTS, stamp, pack.outside_input(tick, record)))
            elif isinstance(record, ActionRequest):
                requests[record.robot].append(record)
                messages.extend(self._robots[record.robot].received(stamp, tick, record))
                lines += self._watches[record.robot].log_request(record)
            elif isinstance(record, InitialPose):
                data = pack.pose_with_covariance(tick, MAP_FRAME, record.base_in_map, record.covariance)
                messages.append(RosMessage(self._robots[record.robot].topics.initialpose, stamp, data, foreign=True))
        outputs, dead = snapshot.robots, snapshot.dead
        quiet = frozenset() if requests else self._quiet(snapshot, motion)
        goals = {
            index: robot.goals(tick, requests.get(index, ()), output, index in dead)
            for index, (robot, output) in enumerate(zip(self._robots, outputs, strict=True))
            if index not in quiet
        }
        bases = self._localise(outputs, goals)
        said = [(TF, self._moving_frames(snapshot, motion))]
        changed = tick % DIAGNOSTICS_PERIOD == 0
        for index, (robot, watch, output) in enumerate(zip(self._robots, self._watches, outputs, strict=True)):
            said.append((robot.topics.base_pose_ground_truth, motion.truth[index]))
            if index in quiet:
                said.append((robot.topics.odom, motion.odometry[index]))
                continue
            if index not in dead:
                said += robot.tick(tick, motion, bases.get(index, b""), output, goals[index])
            lines += watch.log_lines(snapshot, output, goals[index])
            changed = changed or watch.changed
        said += self._things(snapshot)
        said += [(ROSOUT, pack.log(tick, line)) for line in lines]
        if changed:
            said.append((DIAGNOSTICS, pack.diagnostic_array(tick, self._diagnoses(snapshot))))
        # This equals `RosMessage(...)`, but is faster, because it does not run the Python code of the constructor.
        messages += [tuple.__new__(RosMessage, (topic, stamp, data, False)) for topic, data in said]
        for record in records:
            if isinstance(record, VehicleRecord):
                messages.append(self._vehicle(stamp, tick, record))
            else:
                messages.extend(messages_of(stamp, tick, record))
        return messages

    def _vehicle(self, stamp: int, tick: int, record: VehicleRecord) -> RosMessage:
        topics = self._vehicles[record.robot]
        match record:
            case VehicleState():
                return RosMessage(topics.state, stamp, pack.vehicle_state(tick, record))
            case VehicleFrame(_, received, frame):
                data = pack.mavlink(tick, frame)
                if received:
                    return RosMessage(topics.received, stamp, data, foreign=frame.link == GRAPH_LINK)
                return RosMessage(topics.sent, stamp, data)

    def _diagnoses(self, snapshot: TeamSnapshot) -> list[pack.DiagnosticStatus]:
        return [
            diagnosis
            for watch, output in zip(self._watches, snapshot.robots, strict=True)
            for diagnosis in watch.diagnoses(snapshot, output)
        ]

    def _motions(self, snapshots: Sequence[TeamSnapshot]) -> Iterator[Motion]:
        """Yield the motion of each tick. The poses of all ticks are packed together."""
        truths = [snapshot.truth for snapshot in snapshots]
        if any(len(truth.poses) != len(self._robots) for truth in truths):
            raise ValueError(f"these are the messages of {len(self._robots)} robots")
        poses = np.concatenate([truth.poses for truth in truths])
        odom_poses = np.concatenate([truth.odom_poses for truth in truths])
        true = iter(self._true_rows.packed(poses, np.concatenate([truth.twists for truth in truths])))
        sensed = iter(self._odometry_rows.packed(odom_poses, np.concatenate([truth.odom_twists for truth in truths])))
        for snapshot, truth in zip(snapshots, truths, strict=True):
            head = pack.head(snapshot.tick)
            yield Motion(
                [b"".join((head, robot.map_to_base, row)) for robot, row in zip(self._robots, true, strict=False)],
                [b"".join((head, robot.odom_to_base, row)) for robot, row in zip(self._robots, sensed, strict=False)],
                truth.poses.tolist(),
                snapshot.commands.tolist(),
                truth.charge.tolist(),
            )

    def _quiet(self, snapshot: TeamSnapshot, motion: Motion) -> frozenset[int]:
        """Return the robots that send only truth and odometry in this tick. No client may have sent a request."""
        truth = motion.charges, snapshot.truth.collisions.tolist(), snapshot.dead
        before, self._truth = self._truth, truth
        if truth != before or not all(snapshot.tick % period for period in SHARED_PERIODS):
            return frozenset()
        return frozenset(
            index
            for index, (robot, output) in enumerate(zip(self._robots, snapshot.robots, strict=True))
            if isinstance(output, PropagatedOutput) and robot.is_quiet(snapshot.tick, motion, output)
        )

    def _localise(
        self, outputs: Sequence[RobotOutput], goals: Mapping[int, Sequence[ActionServerMessage]]
    ) -> dict[int, bytes]:
        """Process new estimates, and return the believed poses, packed as geometry_msgs/Pose, by robot.

        Args:
            outputs: outputs of all robots.
            goals: messages of the action servers, by robot. Robots that send only truth and odometry are omitted.
        """
        bases: dict[int, bytes] = {}
        for index, sent in goals.items():
            robot, output = self._robots[index], outputs[index]
            if isinstance(output, PropagatedOutput) and robot.odom_in_map is not None:
                if sent:
                    bases[index] = pack.compiled_pose(output.neighbour.base_in_map)
                continue
            estimate = output.estimate
            if estimate.odom_in_map is not robot.odom_in_map:
                robot.correct(estimate.odom_in_map)
            if sent or estimate.updated or output.observations.scan is not None:
                bases[index] = pack.compiled_pose(estimate.base_in_map)
        return bases

    def _moving_frames(self, snapshot: TeamSnapshot, motion: Motion) -> bytes:
        head = pack.head(snapshot.tick)
        entries: list[bytes] = []
        for index, (robot, odometry) in enumerate(zip(self._robots, motion.odometry, strict=True)):
            if index not in snapshot.dead:
                # An odometry message starts with its transform.
                entries += (head + robot.map_to_odom, odometry[: robot.transform_bytes])
        return pack.stamped_transforms(entries)

    def _things(self, snapshot: TeamSnapshot) -> Iterator[tuple[Topic, bytes]]:
        """Yield the outlines of all things if a thing has appeared, disappeared or moved."""
        bodies = snapshot.truth.bodies
        walks_only = len(bodies.circles) == len(self._bodies.circles)
        if bodies is self._bodies or (walks_only and snapshot.tick - self._bodies_tick < THINGS_PERIOD):
            return
        self._bodies, self._bodies_tick = bodies, snapshot.tick
        things = [presence.thing.name for presence in snapshot.truth.things if presence.appeared]
        outlines = zip(things, unpack_polygons(bodies), strict=True)
        yield THINGS, pack.outlines(snapshot.tick, MAP_FRAME, outlines)


def messages_of(stamp: int, tick: int, record: Record) -> Iterator[RosMessage]:
    """Yield the message of a record. It is published after the messages of the robots. `tick` is for its header."""
    match record:
        case GameEvent():
            yield RosMessage(GAME_EVENTS, stamp, pack.game_event(tick, record))
        case ScoreRecord():
            yield RosMessage(SCORE, stamp, pack.score(tick, record))
        case UtteranceRecord():
            yield RosMessage(UTTERANCES, stamp, pack.utterance(tick, record))
        case DialogueMoveRecord():
            yield RosMessage(DIALOGUE_MOVES, stamp, pack.dialogue_move(tick, record))
        case DialogueStateRecord():
            yield RosMessage(DIALOGUE_STATES, stamp, pack.dialogue_state(tick, record))
        case HeldTurns(text):
            yield RosMessage(WIZARD, stamp, pack.string(text))
        case TeamEvent(event):
            yield RosMessage(TEAM, stamp, pack.game_event(tick, event))
        case SeatNotice():
            yield RosMessage(SHOWN, stamp, pack.seat_notice(tick, record))
        case SendRobots(line):
            yield RosMessage(SEND_ROBOTS, stamp, pack.string(line))
        case Success(line):
            yield RosMessage(SUCCESS, stamp, pack.string(line))
        case LogLine():
            yield RosMessage(ROSOUT, stamp, pack.log(tick, record))
        case InputRecord() | GoalRequest() | CancelRequest() | SimpleGoal() | InitialPose():
            pass  # It is published before the robots' messages.
        case VelocityCommand():
            pass  # The topic cmd_vel has the motors' command.
        case VehicleFrame() | VehicleState():
            pass  # The robot's own topics have it.
        case _:
            assert_never(record)
