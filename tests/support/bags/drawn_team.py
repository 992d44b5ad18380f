"""Snapshots of a team that a formula computes, without physics: robots on circles, with all parts that a snapshot can
have. They are the same in every run."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, Battery, Imu, LaserMount, Neighbour, Observations, Odometry, Scan, Twist
from sim.numerics.float_array import FloatArray
from sim.parameters import WorldParameters
from sim.robot.localization.estimate import Estimate
from sim.robot.navigator.goals import Goal, GoalReached, NoPath
from sim.robot.navigator.navigation import Navigation
from sim.robot.software import RobotOutput
from sim.snapshot import TeamSnapshot
from sim.world.physics import WorldState
from sim.world.sensor_noise import SensorNoise
from thbridge.ros.messages.records import InitialPose, Record, SendRobots, Success
from thbridge.ros.messages.session_records import GameEvent, InputRecord, ScoreRecord, SessionRecord, UtteranceRecord

MOUNT = LaserMount(Pose2(0.1, 0.0, 0.0), -2.0, 4.0 / 180, 181, 0.05, 8.0)
SCAN_PERIOD = 0.1
SESSION = SessionRecord(
    "map: arena\nname: Müller's £ study\n",
    2**63 + 5,
    {"thbridge": "0.1", "python": "3.11"},
    "play",
    ("SimR", "Hider"),
    "nearest",
)
SPEED = 0.5
LEG = 100
"""Ticks of driving to a goal; a pause of half this duration follows."""


def arena() -> OccupancyGrid:
    """Return a walled box of 16 m x 12 m, with unknown cells outside a door."""
    cells = np.zeros((120, 160), dtype=np.int8)
    cells[0], cells[-1], cells[:, 0], cells[:, -1] = 100, 100, 100, 100
    cells[40, :60] = 100
    cells[0, 10:20] = -1
    return OccupancyGrid(cells, 0.1, Pose2(-5.0, -5.0, 0.0))


def truth(robot: int, tick: int) -> Pose2:
    """Return the pose of a robot on its circle: it drives for LEG ticks, then stands still for half as many ticks."""
    driven = (tick // (LEG + LEG // 2)) * LEG + min(tick % (LEG + LEG // 2), LEG)
    radius = 1.0 + 0.3 * robot
    angle = SPEED * driven / 50 / radius
    return Pose2(1.0 + radius * math.cos(angle), 1.0 + radius * math.sin(angle), _wrapped(angle + math.pi / 2))


def snapshots(robots: int, ticks: int, first: int = 0) -> Iterator[TeamSnapshot]:
    """Yield ticks `first` to `first + ticks - 1` of a team."""
    for tick in range(first, first + ticks):
        outputs = tuple(_output(robot, tick) for robot in range(robots))
        commands = np.array([(o.navigation.command.linear, o.navigation.command.angular) for o in outputs])
        yield TeamSnapshot(tick, _world(tick, [output.observations for output in outputs]), outputs, commands)


def records(tick: int) -> tuple[Record, ...]:
    """Return some records of the game, of dialogues and of inputs, once a second; else none."""
    if tick % 50 != 10:
        return ()
    room = 1 + tick // 50 % 8
    return (
        InputRecord("said", "Hans", f"%%goto Hans SimR 0 {room - 1}", "{}"),
        SendRobots(f"%%goto Hans SimR 0 {room - 1}"),
        Success("%%error SimR Hans 0"),
        GameEvent("arrived", 0, room, f'{{"event":"arrived","robot":0,"room":{room}}}'),
        GameEvent("identified", 0, room, '{"event":"identified","name":"Blue <Bottle>","points":-20}'),
        GameEvent("ended", None, None, '{"event":"ended","reason":"all-visited"}'),
        ScoreRecord(10 * room - 30, room, 8, (80.5, 70.25)),
        UtteranceRecord(
            tick, "robot", 0, room, "select-room", f"It will cost me £{room} to go there", "claim", "robot"
        ),
        InitialPose(0, Pose2(1.0, 2.0, 0.5), np.diag([0.25, 0.25, 0.07])),
    )


def _wrapped(angle: float) -> float:
    return (angle + math.pi) % (2 * math.pi) - math.pi


def _moves(tick: int) -> bool:
    return tick % (LEG + LEG // 2) < LEG


def _world(tick: int, observations: Sequence[Observations]) -> WorldState:
    robots, odometry = len(observations), [each.odometry for each in observations]
    return WorldState(
        tick,
        np.array([truth(robot, tick).array() for robot in range(robots)]),
        np.tile([SPEED if _moves(tick) else 0.0, 0.0], (robots, 1)),
        np.array([sensed.base_in_odom.array() for sensed in odometry]),
        np.array([(sensed.twist.linear, sensed.twist.angular) for sensed in odometry]),
        np.array([each.battery.charge for each in observations]),
        np.zeros(robots, bool),
        np.zeros(robots, np.int64),
        SensorNoise.of([WorldParameters()] * robots),
    )


def _output(robot: int, tick: int) -> RobotOutput:
    true = truth(robot, tick)
    odom_in_map = Pose2(0.05 * math.sin(tick / 300), 0.03, 0.01 * math.sin(tick / 200 + robot))
    believed = true.compose(Pose2(0.03, 0.04 * math.sin(tick / 100 + robot), 0.02))
    drifted = odom_in_map.between(believed)
    moves = _moves(tick)
    twist = Twist(SPEED, 0.4) if moves else STANDSTILL
    scan = None
    if tick % 5 == robot % 5:
        ranges = (3.0 + np.sin(np.arange(MOUNT.beams) / 20 + tick)).astype(np.float32)
        ranges[3], ranges[4] = np.inf, np.nan
        scan = Scan(tick, MOUNT, ranges)
    battery = Battery(tick, 100.0 - 0.4 * (tick // 50), 100.0)
    observations = Observations(tick, Odometry(tick, drifted, twist), Imu(tick, 0.4), scan, battery)
    updated = moves and tick % 20 == 0
    around = true.array() + 0.05 * np.sin(np.arange(300 * 3).reshape(300, 3))
    estimate = Estimate(
        tick,
        odom_in_map.compose(drifted),
        odom_in_map,
        np.diag([0.01, 0.02, 0.003]),
        around if updated else np.empty((0, 3)),
        updated,
    )
    navigation = _navigation(robot, tick, twist)
    return RobotOutput(
        observations,
        estimate,
        navigation,
        Neighbour(robot, estimate.base_in_map, twist, np.empty((0, 2)), np.empty((0, 2)), np.empty(0)),
    )


def _navigation(robot: int, tick: int, twist: Twist) -> Navigation:
    leg, at = divmod(tick, LEG + LEG // 2)
    goal = Goal(leg, truth(robot, leg * (LEG + LEG // 2) + LEG))
    none = np.empty((0, 3))
    if at < LEG:
        plan = _plan(robot, leg)[at // 10 :]
        return Navigation(
            command=twist,
            goal=goal,
            state="controlling",
            plan=plan,
            times=np.zeros(len(plan)),
            local_plan=none,
            result=None,
            remaining=1.0,
        )
    result: GoalReached | NoPath | None = None
    if at == LEG:
        result = GoalReached(goal) if leg % 2 == 0 else NoPath(goal, "no-plan", "the goal is inside a wall")
    return Navigation(
        command=STANDSTILL,
        goal=None,
        state="idle",
        plan=none,
        times=np.empty(0),
        local_plan=none,
        result=result,
        remaining=0.0,
    )


def _plan(robot: int, leg: int) -> FloatArray:
    start = leg * (LEG + LEG // 2)
    return np.array([truth(robot, start + step * 5).array() for step in range(21)])
