"""Obstacles that no map shows (`things`) and scheduled failures of robots (`mishaps`) of a study file."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeVar

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.common.robot_numbers import index_of
from sim.common.traversability import Polygon, area, crosses_itself
from sim.inputs import KidnapRobot, KillRobot, PutThing, RemoveThing, ReviveRobot, ScheduledInput, TeamInput
from sim.numerics import elementary
from sim.parameters import param
from sim.world.thing import Thing
from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import Loaded

S = TypeVar("S")


class Shape(StrEnum):
    """Shape of a thing."""

    CRATE = "crate"
    DOOR = "door"
    FIRE = "fire"
    PERSON = "person"
    POLYGON = "polygon"


SIZES = {Shape.CRATE: (0.6, 0.6), Shape.DOOR: (1.2, 0.1), Shape.FIRE: (0.8, 0.8), Shape.PERSON: (0.4, 0.5)}
"""Default size of each shape: meters along the thing's yaw, and across it."""
ROUND = {Shape.FIRE, Shape.PERSON}
ROUND_CORNERS = 12
LONGEST = 86400.0
"""Latest time, in seconds: one day."""
LEAST_AREA = 1e-4
MOST_CORNERS = 100
FASTEST = 10.0
"""Maximum speed, m/s."""


@dataclass(frozen=True, slots=True)
class ThingEntry:
    """An obstacle that no map shows. Robots perceive it only with their lasers."""

    name: str = field(metadata={"help": "name of the obstacle"})
    shape: Shape = field(metadata={"help": "shape of the obstacle; a polygon needs `corners`"})
    at: tuple[float, float, float] | None = param(
        None, "pose on the map, for a standing obstacle: x, y, yaw", "m, m, rad"
    )
    path: tuple[tuple[float, float], ...] = param(
        (), "points x, y on the map, for a walking obstacle (instead of `at`)", "m"
    )
    speed: float = param(0.8, "speed of a walking obstacle", "m/s", 0.01, FASTEST)
    back_and_forth: bool = param(
        default=False, help="walk back and forth on the path; if false, stop at the end of the path"
    )
    size: tuple[float, float] | None = param(
        None, "length along the yaw, and width; if null, the default size of the shape", "m", 0.02, 100
    )
    corners: tuple[tuple[float, float], ...] = param(
        (), "for a polygon: corners x, y relative to the polygon's center, in order", "m"
    )
    appears: float = param(
        0.0, "simulated time at which the obstacle appears, or later, when no robot is there", "s", 0, LONGEST
    )
    vanishes: float | None = param(
        None, "simulated time at which the obstacle is removed; if null, it stays", "s", 0, LONGEST
    )

    def thing(self) -> Thing:
        """Return the obstacle as a body in the world."""
        if self.at is not None:
            x, y, yaw = self.at
            return Thing(self.name, self._footprint(), Pose2(x, y, yaw))
        (x, y), *rest = self.path
        start = Pose2(x, y, elementary.atan2(rest[0][1] - y, rest[0][0] - x))
        return Thing(self.name, self._footprint(), start, tuple(rest), self.speed, self.back_and_forth)

    def _footprint(self) -> Polygon:
        if self.shape is Shape.POLYGON:
            return self.corners
        length, width = self.size or SIZES[self.shape]
        if self.shape in ROUND:
            angles = [math.tau * (corner + 0.5) / ROUND_CORNERS for corner in range(ROUND_CORNERS)]
            return tuple((0.5 * length * c, 0.5 * width * s) for c, s in map(elementary.cos_sin, angles))
        return tuple((0.5 * length * i, 0.5 * width * j) for i, j in ((1, 1), (-1, 1), (-1, -1), (1, -1)))


class Mishap(StrEnum):
    """Kind of a scheduled failure."""

    DIES = "dies"
    REVIVES = "revives"
    CARRIED = "carried"


@dataclass(frozen=True, slots=True)
class MishapEntry:
    """A scheduled failure of a robot. The robot's software is not informed of it."""

    robot: int = field(metadata={"help": "number of the robot, from 1", "minimum": 1, "maximum": 64})
    what: Mishap = field(
        metadata={
            "help": "`dies`: the robot stops and sends nothing; `revives`: it works again; `carried`: a person moves it"
        }
    )
    time: float = field(
        metadata={"help": "simulated time of the failure", "unit": "s", "minimum": 0, "maximum": LONGEST}
    )
    to: tuple[float, float, float] | None = param(
        None, "for `carried`: new pose of the robot on the map: x, y, yaw", "m, m, rad"
    )

    def input(self) -> TeamInput:
        """Return the failure as an input of the team."""
        robot = index_of(self.robot)
        if self.to is not None:
            return KidnapRobot(robot, Pose2(*self.to))
        return KillRobot(robot) if self.what is Mishap.DIES else ReviveRobot(robot)


def schedule_of(things: Sequence[ThingEntry], mishaps: Sequence[MishapEntry]) -> tuple[ScheduledInput, ...]:
    """Return the scheduled inputs of all things and failures."""
    return (*_comings_and_goings(things), *(ScheduledInput(_tick(mishap.time), mishap.input()) for mishap in mishaps))


def _comings_and_goings(things: Sequence[ThingEntry]) -> Iterator[ScheduledInput]:
    for entry in things:
        yield ScheduledInput(_tick(entry.appears), PutThing(entry.thing()))
        if entry.vanishes is not None:
            yield ScheduledInput(_tick(entry.vanishes), RemoveThing(entry.name))


def _tick(seconds: float) -> int:
    return round(seconds * TICKS_PER_SECOND)


def faults_of_things(loaded: Loaded[S], things: Sequence[ThingEntry]) -> Iterator[BadFile]:
    """Yield faults of values in the section `things` that are valid alone, but contradict each other."""
    first: dict[str, int] = {}
    for index, entry in enumerate(things):
        key = f"things[{index}]"
        if first.setdefault(entry.name, index) != index:
            problem = (
                f"{entry.name!r} is also the name of the thing in line {loaded.lines[f'things[{first[entry.name]}]']}"
            )
            yield loaded.fault(f"{key}.name", problem, "Give every thing its own name")
        if entry.vanishes is not None and entry.vanishes <= entry.appears:
            problem = f"{entry.vanishes:g} is not later than `appears`, which is {entry.appears:g}"
            yield loaded.fault(f"{key}.vanishes", problem, "Write a later time, or delete the line")
        yield from _faults_of_place(loaded, key, entry)
        yield from _faults_of_body(loaded, key, entry)


def _faults_of_place(loaded: Loaded[S], key: str, entry: ThingEntry) -> Iterator[BadFile]:
    if (entry.at is None) == (not entry.path):
        problem = "the thing has neither `at` nor `path`" if entry.at is None else "the thing has both `at` and `path`"
        remedy = "Write at: [x, y, yaw] for a standing thing, or path: [[x, y], [x, y]] for a walking thing"
        yield loaded.fault(key, problem, remedy)
    elif entry.at is None and len(entry.path) < 2:
        yield loaded.fault(f"{key}.path", "a path needs two points", "Write two points or more, or at: [x, y, yaw]")
    elif any(one == other for one, other in itertools.pairwise(entry.path)):
        yield loaded.fault(f"{key}.path", "two consecutive points are the same", "Delete one of the two")
    for name in ("speed", "back_and_forth"):
        if entry.at is not None and f"{key}.{name}" in loaded.lines:
            yield loaded.fault(
                f"{key}.{name}", "a thing with `at` does not walk", "Delete the line, or write `path` instead of `at`"
            )


def _faults_of_body(loaded: Loaded[S], key: str, entry: ThingEntry) -> Iterator[BadFile]:
    if entry.shape is not Shape.POLYGON:
        if entry.corners:
            problem = f"a {entry.shape} cannot have corners"
            yield loaded.fault(f"{key}.corners", problem, "Write shape: polygon, or delete the line")
        return
    if entry.size is not None:
        yield loaded.fault(
            f"{key}.size", "a polygon cannot have a size, because its corners determine the size", "Delete the line"
        )
    if len(entry.corners) < 3 or area(entry.corners) < LEAST_AREA:
        yield loaded.fault(f"{key}.corners", "these corners enclose no area", "Write three or more corners in order")
    elif crosses_itself(entry.corners):
        yield loaded.fault(
            f"{key}.corners", "the polygon's sides cross each other", "Write the corners in order around the polygon"
        )


def fault_of_thing(thing: Thing, farthest: float, longest: int) -> str | None:
    """Return the fault of a thing as a sentence for people, or None if the thing is valid.

    Args:
        thing: the thing that the client describes.
        farthest: greatest coordinate, meters.
        longest: greatest length of the thing's name, characters.
    """
    places = ((thing.base_in_map.x, thing.base_in_map.y), (thing.base_in_map.theta, 0.0), *thing.path)
    if not 0 < len(thing.name) <= longest:
        return f"the name of a thing must have 1 to {longest} characters"
    if max(len(thing.footprint), len(thing.path)) > MOST_CORNERS:
        return f"a thing may have at most {MOST_CORNERS} corners and {MOST_CORNERS} points on its path"
    if any(max(abs(x), abs(y)) > farthest for x, y in (*places, *thing.footprint)):
        return f"the coordinates of a thing must be within -{farthest:g} to {farthest:g} m"
    if area(thing.footprint) < LEAST_AREA or crosses_itself(thing.footprint):
        return "the corners of a thing must enclose an area, and must be in order around this area"
    return None if 0.0 <= thing.speed <= FASTEST else f"the speed of a thing must be 0 to {FASTEST:g} m/s"


def faults_of_mishaps(loaded: Loaded[S], mishaps: Sequence[MishapEntry], robots: int) -> Iterator[BadFile]:
    """Yield faults of values in the section `mishaps` that are valid alone, but contradict each other."""
    for index, entry in enumerate(mishaps):
        key = f"mishaps[{index}]"
        if entry.robot > robots:
            problem = f"there is no robot {entry.robot}: the study has {robots}"
            yield loaded.fault(f"{key}.robot", problem, f"Write a number from 1 to {robots}, or increase `robots`")
        if entry.what is Mishap.CARRIED and entry.to is None:
            yield loaded.fault(key, "the new place of the robot is missing", "Add the key `to: [x, y, yaw]`")
        if entry.what is not Mishap.CARRIED and entry.to is not None:
            yield loaded.fault(f"{key}.to", f"a robot that {entry.what} does not move", "Delete the key `to`")
