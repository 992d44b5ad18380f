"""Measurement of travel times between rooms for a `mapTimes` file."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from statistics import fmean, stdev

from sim.common.observations import TICK
from sim.inputs import SendGoal
from sim.numerics import noise
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.installed_parts import InstalledParts
from sim.robot.navigator.goals import Goal, GoalReached, NoPath
from sim.team import Team
from thbridge.files.map_files import Map
from thbridge.hunt.rooms import Room

LIMIT = 3600.0
"""Simulated seconds after which a trip ends. Usually, the navigator gives up much earlier."""


@dataclass(frozen=True, slots=True)
class MeasurementSetup:
    """The map, world and robot of a measurement.

    Attributes:
        place: the map.
        world: bodies, motors and sensors.
        robot: the robot's software.
        seed: random seed.
        parts: installed parts that the software may name.
    """

    place: Map
    world: WorldParameters
    robot: RobotParameters
    seed: int
    parts: InstalledParts = field(default_factory=InstalledParts)


@dataclass(frozen=True, slots=True, order=True)
class RoomTrip:
    """One drive from the goal pose of room `start` to the goal pose of room `goal`.

    If `start` is the corridor, run 0 starts at the map's first start pose, run 1 at the second start pose, and so on.
    The number of the run also determines the noise.
    """

    start: Room
    goal: Room
    run: int


@dataclass(frozen=True, slots=True)
class TripResult:
    """Result of a trip: simulated seconds, or a sentence with the reason why the robot did not arrive."""

    trip: RoomTrip
    seconds: float | None
    refusal: str | None


@dataclass(frozen=True, slots=True)
class TripTimes:
    """The results of all trips between two rooms.

    Attributes:
        start: the room of the start.
        goal: the room of the goal.
        seconds: simulated seconds of each trip that arrived.
        refusals: reasons why trips did not arrive, as sentences.
    """

    start: Room
    goal: Room
    seconds: tuple[float, ...]
    refusals: tuple[str, ...]

    @property
    def mean(self) -> float | None:
        """Mean simulated seconds, or None if no trip arrived."""
        return fmean(self.seconds) if self.seconds else None

    @property
    def deviation(self) -> float | None:
        """Sample standard deviation of the seconds, or None if fewer than two trips arrived."""
        return stdev(self.seconds) if len(self.seconds) > 1 else None


def trips(place: Map, runs: int) -> Iterator[RoomTrip]:
    """Yield all trips of a measurement: from the corridor and every room to every other room, each `runs` times."""
    rooms = [entry.room for entry in place.rooms]
    for run in range(runs):
        for start in [Room(0), *rooms]:
            for goal in rooms:
                if start != goal:
                    yield RoomTrip(start, goal, run)


def drive(course: MeasurementSetup, trip: RoomTrip) -> TripResult:
    """Drive one trip with a single robot on the map."""
    place = course.place
    starts = place.starts
    start = starts[trip.run % len(starts)] if trip.start.is_corridor else place.rooms[trip.start.people - 1].goal
    words = ("measure", str(trip.start.people), str(trip.goal.people), str(trip.run))
    seed = int(noise.key(course.seed, *words)) % 2**31
    team = Team(place.grid, course.world, [course.robot], [start], seed, charge=math.inf, parts=course.parts)
    inputs = [SendGoal(0, Goal(0, place.rooms[trip.goal.people - 1].goal))]
    for tick in range(1, round(LIMIT / TICK)):
        result = team.step(inputs).robots[0].navigation.result
        inputs = []
        if isinstance(result, GoalReached):
            return TripResult(trip, tick * TICK, None)
        if isinstance(result, NoPath):
            return TripResult(trip, None, result.sentence)
    return TripResult(trip, None, f"the robot was still under way after {LIMIT:g} s")


def by_pair(done: Iterable[TripResult]) -> tuple[TripTimes, ...]:
    """Return the results of each pair of rooms, ordered by start and goal. The order of `done` does not matter."""
    pairs: dict[tuple[Room, Room], list[TripResult]] = {}
    for driven in sorted(done, key=lambda driven: driven.trip):
        pairs.setdefault((driven.trip.start, driven.trip.goal), []).append(driven)
    return tuple(
        TripTimes(
            start,
            goal,
            tuple(driven.seconds for driven in together if driven.seconds is not None),
            tuple(driven.refusal for driven in together if driven.refusal is not None),
        )
        for (start, goal), together in sorted(pairs.items())
    )
