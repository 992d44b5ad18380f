"""Observations: the beliefs of a robot and the knowledge of its team, as a vector of numbers in [-1, 1]."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from struct import Struct
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.observations import TICK, Twist
from sim.numerics import elementary
from sim.robot.software import RobotOutput
from thbridge.api.snapshot import Floats, Ranges
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room

SECTORS = 24
"""Number of sectors of a scan; an observation contains the smallest range of each sector."""

Vector = NDArray[np.float32]
Mask = NDArray[np.int8]
LayoutOfParts: TypeAlias = "Mapping[str, slice[int, int, None]]"


@dataclass(frozen=True, slots=True)
class ObservationScale:
    """Magnitudes that are scaled to 1 in observations.

    Attributes:
        left: smallest x of the map, meters.
        low: smallest y of the map, meters.
        width: size of the map along x, meters.
        height: size of the map along y, meters.
        energy: energy at the start.
        speed: largest speed, meters per second.
        turn: largest rate of turn, radians per second.
        range: largest range of the laser, meters.
        seconds: duration of an episode.
    """

    left: float
    low: float
    width: float
    height: float
    energy: float
    speed: float
    turn: float
    range: float
    seconds: float


class BodyNumbers(NamedTuple):
    """Numbers about one robot that do not come from the game.

    Attributes:
        motion: position, heading, spread and speed.
        lost: 1 if the robot considers itself lost.
        remaining: remaining length of the robot's plan.
        seen: directions and scan, if they are part of observations.
    """

    motion: list[float]
    lost: float
    remaining: float
    seen: list[float]


class ObservationEncoder:
    """Encoder that converts a session's state into observations, one for each agent.

    Args:
        robots: number of robots.
        goals: goal pose of each room.
        scale: magnitudes that are scaled to 1.
        with_scans: if True, observations include scans and relative positions of rooms, which agents need to choose
            velocities.

    Attributes:
        layout: position of each part in the vector.
        size: length of the vector.
    """

    def __init__(self, robots: int, goals: Sequence[Pose2], scale: ObservationScale, *, with_scans: bool) -> None:
        rooms = len(goals)
        parts = {
            "place": 2,
            "heading": 2,
            "spread": 3,
            "speed": 2,
            "energy": 1,
            "ready": 1,
            "lost": 1,
            "remaining": 1,
            "bound_for": rooms,
            "costs": rooms,
            **({"directions": 2 * rooms, "scan": SECTORS} if with_scans else {}),
            "visited": rooms,
            "reserved": rooms,
            "time": 1,
            "mates": len(range(1, robots)) * (6 + rooms),
        }
        self.layout: LayoutOfParts = dict(_slices(parts))
        self.size = sum(parts.values())  # of integers
        self._goals = tuple(goals)
        self._scale = scale
        self._with_scans = with_scans
        # Packing is twice as fast as an array made from lists. Arrays of limits are twice as fast as single numbers.
        self._packing = Struct(f"{robots * self.size}f")
        self._shape = robots, self.size
        self._most, self._least = np.ones(self._shape, np.float32), -np.ones(self._shape, np.float32)
        self._game: GameState | None = None
        self._of_game: list[_GameNumbers] = []
        self._of_rooms: list[float] = []

    def encode(self, tick: int, bodies: Sequence[BodyNumbers], game: GameState, ready: Sequence[bool]) -> Vector:
        """Return (robots, size) observations.

        Args:
            tick: the current tick.
            bodies: results of `of_output` or `of_pose`, one for each robot.
            game: the state of the game.
            ready: True for each robot that can be sent.
        """
        if game is not self._game:
            self._take(game, ready)
        of_game = self._of_game
        time = tick * TICK / self._scale.seconds
        mates = [body.motion[:4] + numbers.own for body, numbers in zip(bodies, of_game, strict=True)]
        row: list[float] = []
        for robot, (body, numbers) in enumerate(zip(bodies, of_game, strict=True)):
            row += body.motion
            row += numbers.own[:2]
            row += body.lost, body.remaining
            row += numbers.bound_for
            row += numbers.costs
            row += body.seen
            row += self._of_rooms
            row.append(time)
            for other, mate in enumerate(mates):
                if other != robot:
                    row += mate
        observations = np.empty(self._shape, np.float32)
        self._packing.pack_into(observations.data, 0, *row)
        np.minimum(observations, self._most, out=observations)
        return np.maximum(observations, self._least, out=observations)

    def of_output(self, output: RobotOutput, scan: Ranges) -> BodyNumbers:
        """Return the numbers of a robot according to its beliefs; `scan` is the robot's last scan."""
        # The robot's broadcast already contains pose and odometry, so the robot's sensor messages are not needed.
        pose, twist = output.neighbour.base_in_map, output.neighbour.twist
        (xx, _, _), (_, yy, _), (_, _, aa) = output.estimate.covariance.tolist()
        spread = [math.sqrt(max(variance, 0.0)) for variance in (xx, yy, aa)]
        seen = [*self._directions(pose), *self._sectors(scan)] if self._with_scans else []
        return self._body(pose, spread, twist, output.lost, output.navigation.remaining, seen)

    def of_pose(self, pose: Pose2, twist: Twist, remaining: float) -> BodyNumbers:
        """Return the numbers of a robot that knows its pose; `remaining` is the remaining distance, in meters."""
        return self._body(pose, [0.0, 0.0, 0.0], twist, False, remaining, [])

    def poses(self, bodies: Sequence[BodyNumbers]) -> Floats:
        """Return (robots, 3) poses, computed from the numbers of the robots."""
        scale = self._scale
        return np.array(
            [
                (
                    scale.left + scale.width * (x + 1.0) / 2.0,
                    scale.low + scale.height * (y + 1.0) / 2.0,
                    elementary.atan2(sine, cosine),
                )
                for (x, y, cosine, sine, *_), *_ in bodies
            ]
        )

    def _body(
        self, pose: Pose2, spread: list[float], twist: Twist, lost: bool, remaining: float, seen: list[float]
    ) -> BodyNumbers:
        scale = self._scale
        motion = [
            2.0 * (pose.x - scale.left) / scale.width - 1.0,
            2.0 * (pose.y - scale.low) / scale.height - 1.0,
            *elementary.cos_sin(pose.theta),
            *spread,
            twist.linear / scale.speed,
            twist.angular / scale.turn,
        ]
        return BodyNumbers(motion, float(lost), remaining / (scale.width + scale.height), seen)

    def _take(self, game: GameState, ready: Sequence[bool]) -> None:
        """Compute the numbers of the game, if the state of the game has changed."""
        self._game = game
        self._of_game = [self._numbers(game, robot, is_ready) for robot, is_ready in enumerate(ready)]
        reserved = [0.0] * len(game.rooms)
        for mover in game.robots:
            if mover.bound_for is not None:
                reserved[mover.bound_for.wire] = 1.0
        self._of_rooms = [float(room.visited) for room in game.rooms] + reserved

    def _numbers(self, game: GameState, robot: int, is_ready: bool) -> "_GameNumbers":
        state, full = game.robots[robot], self._scale.energy
        bound_for = [0.0] * len(game.rooms)
        if state.bound_for is not None:
            bound_for[state.bound_for.wire] = 1.0
        costs = [cost / full for cost in game.costs_from(robot)[1:]]
        return _GameNumbers([state.energy / full, float(is_ready), *bound_for], bound_for, costs)

    def _directions(self, base_in_map: Pose2) -> Iterator[float]:
        """Yield x and y of each room's goal, relative to the robot's believed pose."""
        cosine, sine = elementary.cos_sin(base_in_map.theta)
        for goal in self._goals:
            x, y = goal.x - base_in_map.x, goal.y - base_in_map.y
            yield (cosine * x + sine * y) / self._scale.width
            yield (cosine * y - sine * x) / self._scale.height

    def _sectors(self, ranges: Ranges) -> list[float]:
        """Return the smallest range in each sector of a scan; lost beams count as free."""
        edges = np.linspace(0, len(ranges), SECTORS, endpoint=False).astype(np.int64)
        nearest = np.fmin.reduceat(ranges, edges)
        least: list[float] = (np.fmin(nearest, self._scale.range) / self._scale.range).tolist()
        return least


class _GameNumbers(NamedTuple):
    """Numbers of the game for one robot: its own state, the room to which it drives, and the costs of its moves."""

    own: list[float]
    bound_for: list[float]
    costs: list[float]


def action_masks(choices: Sequence[Sequence[Room]], rooms: int) -> Mask:
    """Return (robots, rooms + 1) flags: 1 for each action that counts.

    Action 0 means to wait; all other actions are room numbers.

    Args:
        choices: rooms that each robot may choose.
        rooms: number of rooms of the game.
    """
    masks = b""
    for open_to in choices:
        mask = bytearray(rooms + 1)
        mask[0] = 1
        for room in open_to:
            mask[room.people] = 1
        masks += mask
    # An array made from bytes is read-only, and is created twice as fast as an array made from lists.
    return np.frombuffer(masks, np.int8).reshape(len(choices), rooms + 1)


def _slices(parts: Mapping[str, int]) -> "Iterator[tuple[str, slice[int, int, None]]]":
    start = 0
    for name, size in parts.items():
        yield name, slice(start, start + size)
        start += size
