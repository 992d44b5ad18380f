"""Observations of an environment: what each robot believes and its team knows, as one vector of numbers in [-1, 1]."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.observations import TICK
from sim.numerics import elementary
from sim.robot.software import RobotOutput
from sim.team import TeamSnapshot
from thbridge.api.snapshot import Ranges
from thbridge.hunt.game import GameState
from thbridge.hunt.rules import affordable

SECTORS = 24
"""Parts of a scan, each with its nearest range."""

Vector = NDArray[np.float32]
Mask = NDArray[np.int8]
LayoutOfParts: TypeAlias = "Mapping[str, slice[int, int, None]]"


@dataclass(frozen=True, slots=True)
class ObservationScale:
    """Magnitudes that become 1.

    Attributes:
        left: least x of the map, metres.
        low: least y.
        width: of the map along x, metres.
        height: along y.
        energy: at the start.
        speed: metres per second.
        turn: radians per second.
        range: greatest of the laser, metres.
        seconds: of an episode.
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


class ObservationEncoder:
    """Turns a session's state into the observation of each agent.

    Args:
        robots: size of the team.
        goals: goal pose of each room.
        scale: magnitudes.
        with_scans: scans and relative places of rooms are part of it, for who drives.

    Attributes:
        layout: places of the parts in the vector.
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
        self.size = sum(parts.values())
        self._goals = tuple(goals)
        self._scale = scale
        self._with_scans = with_scans
        self._game: GameState | None = None
        self._of_game: list[_GameNumbers] = []
        self._of_rooms: list[float] = []

    def encode(
        self, team: TeamSnapshot, game: GameState, scans: Sequence[Ranges], ready: Callable[[int], bool]
    ) -> Vector:
        """Return (robots, size) observations.

        Args:
            team: what robots believe.
            game: the state of the game.
            scans: the last of each robot.
            ready: True for the index of a robot that could be sent.
        """
        if game is not self._game:
            self._take(game, ready)
        time = team.tick * TICK / self._scale.seconds
        bodies = [self._body(output) for output in team.robots]
        mates = [body[:4] + numbers.own for body, numbers in zip(bodies, self._of_game, strict=True)]
        rows: list[list[float]] = []
        for robot, output in enumerate(team.robots):
            numbers = self._of_game[robot]
            row = bodies[robot] + numbers.own[:2]
            row.append(1.0 if output.lost else 0.0)
            row.append(output.navigation.remaining / (self._scale.width + self._scale.height))
            row += numbers.bound_for
            row += numbers.costs
            if self._with_scans:
                row += self._directions(output.neighbour.base_in_map)
                row += self._sectors(scans[robot])
            row += self._of_rooms
            row.append(time)
            for other, mate in enumerate(mates):
                if other != robot:
                    row += mate
            rows.append(row)
        observations = np.array(rows, dtype=np.float32)
        return np.clip(observations, -1.0, 1.0, out=observations)

    def _take(self, game: GameState, ready: Callable[[int], bool]) -> None:
        """Take a new state of the game; most ticks have none."""
        self._game = game
        self._of_game = [self._numbers(game, robot, is_ready=ready(robot)) for robot in range(len(game.robots))]
        visited = [float(room.visited) for room in game.rooms]
        reserved = [0.0] * len(game.rooms)
        for robot in game.robots:
            if robot.bound_for is not None:
                reserved[robot.bound_for.wire] = 1.0
        self._of_rooms = visited + reserved

    def _numbers(self, game: GameState, robot: int, *, is_ready: bool) -> "_GameNumbers":
        state = game.robots[robot]
        bound_for = [0.0] * len(game.rooms)
        if state.bound_for is not None:
            bound_for[state.bound_for.wire] = 1.0
        costs = [cost / self._scale.energy for cost in game.costs_from(robot)[1:]]
        return _GameNumbers([state.energy / self._scale.energy, float(is_ready), *bound_for], bound_for, costs)

    def _body(self, output: RobotOutput) -> list[float]:
        """Place, heading, spread and speed of a robot."""
        # What it broadcasts is pose and odometry; its observations need not be made for them.
        scale, pose, twist = self._scale, output.neighbour.base_in_map, output.neighbour.twist
        cosine, sine = elementary.cos_sin(pose.theta)
        (xx, _, _), (_, yy, _), (_, _, aa) = output.estimate.covariance.tolist()
        return [
            2.0 * (pose.x - scale.left) / scale.width - 1.0,
            2.0 * (pose.y - scale.low) / scale.height - 1.0,
            cosine,
            sine,
            math.sqrt(max(xx, 0.0)),
            math.sqrt(max(yy, 0.0)),
            math.sqrt(max(aa, 0.0)),
            twist.linear / scale.speed,
            twist.angular / scale.turn,
        ]

    def _directions(self, base_in_map: Pose2) -> Iterator[float]:
        """Yield x and y of each room's goal as the robot believes to see it."""
        cosine, sine = elementary.cos_sin(base_in_map.theta)
        for goal in self._goals:
            x, y = goal.x - base_in_map.x, goal.y - base_in_map.y
            yield (cosine * x + sine * y) / self._scale.width
            yield (cosine * y - sine * x) / self._scale.height

    def _sectors(self, ranges: Ranges) -> list[float]:
        """Return the nearest range in each part of a scan; lost beams count as free."""
        edges = np.linspace(0, len(ranges), SECTORS, endpoint=False).astype(np.int64)
        nearest = np.fmin.reduceat(ranges, edges)
        least: list[float] = (np.fmin(nearest, self._scale.range) / self._scale.range).tolist()
        return least


@dataclass(frozen=True, slots=True)
class _GameNumbers:
    """The game about one robot: energy, readiness and where it is bound for; the latter again; costs."""

    own: list[float]
    bound_for: list[float]
    costs: list[float]


def action_masks(game: GameState, ready: Callable[[int], bool]) -> list[Mask]:
    """Return the mask of each robot's actions: 0 is to wait, others are rooms by number."""
    masks = []
    for robot in range(len(game.robots)):
        mask = np.zeros(len(game.rooms) + 1, dtype=np.int8)
        mask[0] = 1
        if ready(robot):
            mask[[room.people for room in affordable(game, robot)]] = 1
        mask.setflags(write=False)
        masks.append(mask)
    return masks


def _slices(parts: Mapping[str, int]) -> "Iterator[tuple[str, slice[int, int, None]]]":
    start = 0
    for name, size in parts.items():
        yield name, slice(start, start + size)
        start += size
