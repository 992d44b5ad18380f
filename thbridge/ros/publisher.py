"""Which messages a session says, tick by tick: the one order of topics that bags and live graphs share."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple, assert_never

import numpy as np

from sim.bodies import NO_POLYGONS, apart
from sim.geometry import FloatArray, Pose2
from sim.grid import OccupancyGrid
from sim.navigator import Arrived, Cancelled, Goal, Navigation, NoPath
from sim.observations import STANDSTILL, TICKS_PER_SECOND, LaserMount, Twist
from sim.robot import RobotOutput
from sim.team import TeamSnapshot
from thbridge.ros import names, pack, types
from thbridge.ros.goals import GoalId, GoalStatus, Status
from thbridge.ros.names import MAP_FRAME, RobotNames
from thbridge.ros.pack import Transform
from thbridge.ros.records import (
    CancelRequest,
    GameEvent,
    GoalRequest,
    InitialPose,
    Input,
    LogLine,
    Record,
    Score,
    SendRobots,
    Session,
    SimpleGoal,
    Success,
    Utterance,
    VelocityCommand,
)
from thbridge.ros.stamps import stamp_ns

COMMAND_PERIOD = 5
"""Ticks after which an unchanged command is said again while a goal is under way: 10 Hz, base drivers time out."""

THINGS_PERIOD = 5
"""Ticks from one word about things that walk to the next: 10 Hz."""

UNMEASURED = 1e6
"""Variance by which ROS drivers say that a robot of the plane measures no z, roll and pitch."""

_ODOM_POSE = pack.covariance(np.diag([1e-3, 1e-3, 1e-3]), UNMEASURED)
_ODOM_TWIST = pack.covariance(np.diag([1e-3, 1e-3, 1e-3]), UNMEASURED)
"""Nominal, as drivers give them: odometry knows nothing of its own drift."""


class Topic(NamedTuple):
    """A topic with the type of its messages; who comes late to a latched one gets its last message."""

    name: str
    msgtype: str
    latched: bool = False


class Message(NamedTuple):
    """One message: its topic, when it was said (nanoseconds of ROS time), and its bytes."""

    topic: Topic
    stamp_ns: int
    data: bytes


TF = Topic(names.TF, types.TFMESSAGE)
TF_STATIC = Topic(names.TF_STATIC, types.TFMESSAGE, latched=True)
MAP = Topic(names.MAP, types.OCCUPANCY_GRID, latched=True)
MAP_METADATA = Topic(names.MAP_METADATA, types.MAP_META_DATA, latched=True)
SESSION = Topic(names.SESSION, types.SESSION, latched=True)
SEND_ROBOTS = Topic(names.SEND_ROBOTS, types.STRING)
SUCCESS = Topic(names.SUCCESS, types.STRING)
GAME_EVENTS = Topic(names.GAME_EVENTS, types.GAME_EVENT)
SCORE = Topic(names.SCORE, types.SCORE, latched=True)
UTTERANCES = Topic(names.UTTERANCES, types.UTTERANCE)
INPUTS = Topic(names.INPUTS, types.INPUT)
ROSOUT = Topic(names.ROSOUT, types.LOG)
THINGS = Topic(names.THINGS, types.MARKER_ARRAY, latched=True)


@dataclass(frozen=True, slots=True)
class RobotTopics:
    """The topics of one robot."""

    odom: Topic
    base_pose_ground_truth: Topic
    scan: Topic
    amcl_pose: Topic
    particlecloud: Topic
    initialpose: Topic
    cmd_vel: Topic
    battery: Topic
    goal: Topic
    result: Topic
    plan: Topic

    @classmethod
    def of(cls, robot: RobotNames) -> "RobotTopics":
        """The topics in a robot's namespace."""
        return cls(
            odom=Topic(robot.topic("odom"), types.ODOMETRY),
            base_pose_ground_truth=Topic(robot.topic("base_pose_ground_truth"), types.ODOMETRY),
            scan=Topic(robot.topic("scan"), types.LASER_SCAN),
            amcl_pose=Topic(robot.topic("amcl_pose"), types.POSE_WITH_COVARIANCE, latched=True),
            particlecloud=Topic(robot.topic("particlecloud"), types.POSE_ARRAY, latched=True),
            initialpose=Topic(robot.topic("initialpose"), types.POSE_WITH_COVARIANCE),
            cmd_vel=Topic(robot.topic("cmd_vel"), types.TWIST),
            battery=Topic(robot.topic("battery"), types.BATTERY_STATE),
            goal=Topic(robot.topic("move_base/goal"), types.MOVE_BASE_GOAL),
            result=Topic(robot.topic("move_base/result"), types.MOVE_BASE_RESULT),
            plan=Topic(robot.topic("move_base/NavfnROS/plan"), types.PATH),
        )


class Publisher:
    """Turns each tick of a team into the messages that its ROS nodes would publish.

    Args:
        robots: size of the team.
        mount: the laser that every robot carries.
        scan_period: seconds between two scans of one robot.
    """

    def __init__(self, robots: int, mount: LaserMount, scan_period: float) -> None:
        self._laser_in_base = mount.laser_in_base
        self._robots = [_RobotPublisher(robot, scan_period) for robot in range(robots)]
        self._bodies = NO_POLYGONS
        self._bodies_tick = 0

    def opening(self, tick: int, session: Session, grid: OccupancyGrid) -> list[Message]:
        """What is said once, before all else: session, frames that never move, the map. All of it is latched."""
        stamp = stamp_ns(tick)
        static = [
            transform
            for robot in self._robots
            for transform in (
                Transform(robot.names.base_footprint, robot.names.base_link, Pose2(0.0, 0.0, 0.0)),
                Transform(robot.names.base_link, robot.names.base_laser, self._laser_in_base),
            )
        ]
        return [
            Message(SESSION, stamp, pack.session(tick, session)),
            Message(TF_STATIC, stamp, pack.transforms(tick, static)),
            Message(MAP, stamp, pack.occupancy_grid(tick, MAP_FRAME, grid)),
            Message(MAP_METADATA, stamp, pack.map_meta_data(tick, grid)),
        ]

    def tick(self, snapshot: TeamSnapshot, records: Iterable[Record] = ()) -> list[Message]:
        """What is said in one tick: inputs first, then the robots in the team's order, then the other records.

        Raises:
            ValueError: the team is not as large as was said.
        """
        stamp = stamp_ns(snapshot.tick)
        records = tuple(records)
        inputs = [record for record in records if isinstance(record, Input)]
        messages = [Message(INPUTS, stamp, pack.outside_input(snapshot.tick, record)) for record in inputs]
        messages.append(Message(TF, stamp, pack.transforms(snapshot.tick, self._moving_frames(snapshot))))
        for index, (robot, output) in enumerate(zip(self._robots, snapshot.robots, strict=True)):
            x, y, theta = snapshot.world.poses[index].tolist()
            linear, angular = snapshot.world.twists[index].tolist()
            command = Twist(*snapshot.commands[index].tolist())
            said_by = output if index not in snapshot.dead else None
            said = robot.tick(snapshot.tick, Pose2(x, y, theta), Twist(linear, angular), command, said_by)
            messages.extend(Message(topic, stamp, data) for topic, data in said)
        messages.extend(Message(topic, stamp, data) for topic, data in self._things(snapshot))
        messages.extend(Message(topic, stamp, data) for topic, data in self._records(snapshot.tick, records))
        return messages

    def _moving_frames(self, snapshot: TeamSnapshot) -> Iterator[Transform]:
        for index, (robot, output) in enumerate(zip(self._robots, snapshot.robots, strict=True)):
            if index in snapshot.dead:
                continue
            yield Transform(MAP_FRAME, robot.odom, output.estimate.odom_in_map)
            yield Transform(robot.odom, robot.base_footprint, output.observations.odometry.base_in_odom)

    def _things(self, snapshot: TeamSnapshot) -> Iterator[tuple[Topic, bytes]]:
        """All things, whenever one came, went or walked."""
        bodies = snapshot.world.bodies
        walks_only = len(bodies.circles) == len(self._bodies.circles)
        if bodies is self._bodies or (walks_only and snapshot.tick - self._bodies_tick < THINGS_PERIOD):
            return
        self._bodies, self._bodies_tick = bodies, snapshot.tick
        things = [presence.thing.name for presence in snapshot.world.things if presence.appeared]
        outlines = zip(things, apart(bodies), strict=True)
        yield THINGS, pack.outlines(snapshot.tick, MAP_FRAME, outlines)

    def _records(self, tick: int, records: Iterable[Record]) -> Iterator[tuple[Topic, bytes]]:
        for record in records:
            match record:
                case GameEvent():
                    yield GAME_EVENTS, pack.game_event(tick, record)
                case Score():
                    yield SCORE, pack.score(tick, record)
                case Utterance():
                    yield UTTERANCES, pack.utterance(tick, record)
                case Input():
                    pass  # Said before all else.
                case SendRobots(line):
                    yield SEND_ROBOTS, pack.string(line)
                case Success(line):
                    yield SUCCESS, pack.string(line)
                case InitialPose(robot, pose, planar):
                    yield (
                        self._robots[robot].topics.initialpose,
                        pack.pose_with_covariance(tick, MAP_FRAME, pose, planar),
                    )
                case LogLine():
                    yield ROSOUT, pack.log(tick, record)
                case GoalRequest() | CancelRequest() | SimpleGoal() | VelocityCommand():
                    pass  # What becomes of them shows in the robot's own topics.
                case _:
                    assert_never(record)


class _RobotPublisher:
    """One robot's topics, and what it said last where only changes are worth saying."""

    def __init__(self, robot: int, scan_period: float) -> None:
        self.names = RobotNames.of(robot)
        self.topics = RobotTopics.of(self.names)
        self.odom, self.base_footprint = self.names.odom, self.names.base_footprint
        self._scan_period = scan_period
        self._charge = math.nan
        self._command = STANDSTILL
        self._command_tick = 0
        self._goal: Goal | None = None
        self._goal_tick = 0
        self._plan: FloatArray = np.empty((0, 3))

    def tick(
        self, tick: int, truth: Pose2, twist: Twist, command: Twist, output: RobotOutput | None
    ) -> Iterator[tuple[Topic, bytes]]:
        topics = self.topics
        true_pose = pack.odometry(tick, MAP_FRAME, self.base_footprint, truth, twist)
        if output is None:  # of a dead robot only the truth is known
            yield topics.base_pose_ground_truth, true_pose
            return
        observations, estimate = output.observations, output.estimate
        sensed = observations.odometry
        yield (
            topics.odom,
            pack.odometry(
                tick, self.odom, self.base_footprint, sensed.base_in_odom, sensed.twist, _ODOM_POSE, _ODOM_TWIST
            ),
        )
        yield topics.base_pose_ground_truth, true_pose
        if observations.scan is not None:
            yield topics.scan, pack.laser_scan(observations.scan, self.names.base_laser, self._scan_period)
        if estimate.updated:
            yield (
                topics.amcl_pose,
                pack.pose_with_covariance(tick, MAP_FRAME, estimate.base_in_map, estimate.covariance),
            )
            if len(estimate.particles):
                yield topics.particlecloud, pack.pose_array(tick, MAP_FRAME, estimate.particles)
        charge = observations.battery.charge
        if tick % TICKS_PER_SECOND == 0 or charge != self._charge:
            self._charge = charge
            yield topics.battery, pack.battery_state(observations.battery, self.names.namespace[1:])
        yield from self._navigation(tick, command, output.navigation)

    def _navigation(self, tick: int, command: Twist, navigation: Navigation) -> Iterator[tuple[Topic, bytes]]:
        topics = self.topics
        if navigation.result is not None:
            ended = navigation.result.goal
            if ended != self._goal:  # set and given up within one tick
                yield self._set_goal(tick, ended)
            yield topics.result, self._packed_result(tick, navigation.result)
            self._goal = None
        if navigation.goal is not None and navigation.goal != self._goal:
            yield self._set_goal(tick, navigation.goal)
        repeated = navigation.goal is not None and tick - self._command_tick >= COMMAND_PERIOD
        if command != self._command or repeated:
            self._command, self._command_tick = command, tick
            yield topics.cmd_vel, pack.command(command)
        if not _is_rest(navigation.plan, self._plan):
            yield topics.plan, pack.path(tick, MAP_FRAME, navigation.plan)
        self._plan = navigation.plan

    def _set_goal(self, tick: int, goal: Goal) -> tuple[Topic, bytes]:
        self._goal, self._goal_tick = goal, tick
        return self.topics.goal, pack.move_base_goal(tick, self._goal_id(goal), MAP_FRAME, goal.base_in_map)

    def _packed_result(self, tick: int, result: Arrived | NoPath | Cancelled) -> bytes:
        match result:
            case Arrived(goal):
                status, text = Status.SUCCEEDED, "Goal reached."
            case NoPath(goal, _, sentence):
                status, text = Status.ABORTED, sentence
            case Cancelled(goal):
                status, text = Status.PREEMPTED, ""
            case _:
                assert_never(result)
        return pack.move_base_result(tick, GoalStatus(self._goal_id(goal), status, text))

    def _goal_id(self, goal: Goal) -> GoalId:
        return GoalId(f"{self.names.namespace[1:]}-{goal.id}", stamp_ns(self._goal_tick))


def _is_rest(plan: FloatArray, last: FloatArray) -> bool:
    """Whether a plan is the last one, or what is left of it to drive from a new place: not worth saying."""
    if plan is last:
        return True
    if not len(plan):
        return not len(last)
    ahead = plan[1:]
    return len(plan) <= len(last) and np.array_equal(last[len(last) - len(ahead) :], ahead)
