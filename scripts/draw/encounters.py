"""Draw encounters of robots: two that swap through one door, ten at one door, and a dead robot in a doorway.

Run this script from the project's folder: `.venv/bin/python scripts/draw/encounters.py`. Each picture shows the hall
with the trails of all robots, and next to it the position of each robot along the hall against time. The same code
gives the same trails.
"""

import argparse
import math
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.common.observations import TICK
from sim.inputs import KillRobot, SendGoal, TeamInput
from sim.numerics.float_array import FloatArray
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.navigator.goals import Goal, GoalReached, NoPath
from sim.team import Team

mpl.use("Agg")
from matplotlib import pyplot as plt

RESOLUTION = 0.05
LENGTH, WIDTH, WALL_AT = 12.0, 6.0, 6.0
DOOR = 1.1
LIMIT = 300.0
"""Simulated seconds after which an encounter ends in any case."""


@dataclass(frozen=True, slots=True)
class Encounter:
    """Hall that a wall divides, and robots that want to pass the wall.

    Attributes:
        title: title of the picture.
        doors: positions of the doors along the wall, meters.
        starts: start poses of the robots.
        goals: goal poses of the robots; None for a robot that is dead from the beginning.
    """

    title: str
    doors: tuple[float, ...]
    starts: tuple[Pose2, ...]
    goals: tuple[Pose2 | None, ...]


@dataclass(frozen=True, slots=True)
class EncounterRun:
    """Result of an encounter.

    Attributes:
        poses: (ticks, robots, 3) true poses.
        ends: for each robot, the result of its goal and the time of this result in seconds; None for dead robots.
        collisions: number of collisions.
    """

    poses: FloatArray
    ends: tuple[tuple[str, float] | None, ...]
    collisions: int


def swapping() -> Encounter:
    """Return two robots on opposite sides of a door; the goal of each robot is the start of the other."""
    west, east = Pose2(3.0, 3.0, 0.0), Pose2(9.0, 3.0, 0.0)
    return Encounter("Two robots swap through one door", (3.0,), (west, east), (east, west))


def crowd() -> Encounter:
    """Return ten robots on one side of a door; all want to reach the other side."""
    starts = tuple(Pose2(1.0 + row, 1.0 + 4.0 * side, 0.0) for side in range(2) for row in range(5))
    goals = tuple(Pose2(start.x + 6.0, start.y, 0.0) for start in starts)
    return Encounter("Ten robots through one door", (3.0,), starts, goals)


def dead_in_one_of_two() -> Encounter:
    """Return a hall with two doors, and a dead robot in the nearer door."""
    starts = (Pose2(WALL_AT, 1.5, 0.0), Pose2(2.0, 1.5, 0.0), Pose2(10.0, 1.5, 0.0))
    return Encounter(
        "A dead robot in one of two doors: take the other", (1.5, 4.5), starts, (None, starts[2], starts[1])
    )


def dead_in_the_only_one() -> Encounter:
    """Return a hall with one door, and a dead robot in this door."""
    starts = (Pose2(WALL_AT, 3.0, 0.0), Pose2(2.0, 3.0, 0.0), Pose2(10.0, 3.0, 0.0))
    return Encounter("A dead robot in the only door: no path is reported", (3.0,), starts, (None, starts[2], starts[1]))


ENCOUNTERS = {
    "two_swap": swapping,
    "ten_through_one_door": crowd,
    "dead_robot_two_doors": dead_in_one_of_two,
    "dead_robot_one_door": dead_in_the_only_one,
}


def hall(doors: tuple[float, ...]) -> OccupancyGrid:
    """Return a hall with walls around it, and with a wall with doors in the middle."""
    cells = np.full((round(WIDTH / RESOLUTION), round(LENGTH / RESOLUTION)), OCCUPIED, dtype=np.int8)
    cells[2:-2, 2:-2] = FREE
    wall = round(WALL_AT / RESOLUTION)
    cells[:, wall - 1 : wall + 1] = OCCUPIED
    for middle in doors:
        cells[
            round((middle - DOOR / 2) / RESOLUTION) : round((middle + DOOR / 2) / RESOLUTION), wall - 1 : wall + 1
        ] = FREE
    return OccupancyGrid(cells, RESOLUTION, Pose2(0.0, 0.0, 0.0))


def play(encounter: Encounter, seed: int = 1) -> EncounterRun:
    """Simulate an encounter to its end."""
    robots = len(encounter.starts)
    world = WorldParameters()
    team = Team(hall(encounter.doors), world, [RobotParameters()] * robots, encounter.starts, seed, charge=math.inf)
    inputs: list[TeamInput] = [
        KillRobot(robot) if goal is None else SendGoal(robot, Goal(robot, goal))
        for robot, goal in enumerate(encounter.goals)
    ]
    ends: dict[int, tuple[str, float]] = {}
    poses: list[FloatArray] = []
    collisions = 0
    alive = sum(goal is not None for goal in encounter.goals)
    while len(ends) < alive and len(poses) * TICK < LIMIT:
        snapshot = team.step(inputs)
        inputs = []
        poses.append(snapshot.truth.poses.copy())
        collisions = int(snapshot.truth.collisions.sum())
        for robot, output in enumerate(snapshot.robots):
            match output.navigation.result:
                case GoalReached():
                    ends[robot] = ("arrived", len(poses) * TICK)
                case NoPath(_, reason, _):
                    ends[robot] = (reason, len(poses) * TICK)
                case _:
                    pass
    return EncounterRun(np.array(poses), tuple(ends.get(robot) for robot in range(robots)), collisions)


def draw(encounter: Encounter, run: EncounterRun, file: Path) -> None:
    """Draw the hall with the trails, and the position along the hall against time."""
    figure, (plan, diagram) = plt.subplots(1, 2, figsize=(11.0, 3.6), width_ratios=(1.6, 1.0), layout="constrained")
    grid = hall(encounter.doors)
    plan.imshow(grid.cells, cmap="Greys", origin="lower", extent=(0.0, LENGTH, 0.0, WIDTH), vmin=0, vmax=160)
    times = np.arange(len(run.poses)) * TICK
    colours = plt.get_cmap("tab10")
    footprint = np.array(WorldParameters().footprint)
    for robot, goal in enumerate(encounter.goals):
        trail = run.poses[:, robot]
        colour = "black" if goal is None else colours(robot % 10)
        plan.plot(trail[:, 0], trail[:, 1], color=colour, linewidth=1.2)
        plan.fill(*Pose2(*trail[0]).transform(footprint).T, color=colour, alpha=0.35)
        plan.fill(*Pose2(*trail[-1]).transform(footprint).T, color=colour)
        diagram.plot(times, trail[:, 0], color=colour, linewidth=1.2)
    diagram.axhline(WALL_AT, color="grey", linestyle=":", linewidth=1.0)
    plan.set(xlabel="x, meters", ylabel="y, meters", title=encounter.title)
    last = max((end[1] for end in run.ends if end is not None), default=0.0)
    results = sorted({end[0].replace("_", " ") for end in run.ends if end is not None})
    diagram.set(
        xlabel="simulated seconds",
        ylabel="x, meters",
        title=f"{', '.join(results)}; last after {last:.0f} s; collisions: {run.collisions}",
    )
    diagram.title.set_fontsize(9)
    figure.savefig(file, dpi=110, metadata={"Software": None})
    plt.close(figure)


def main() -> None:
    """Draw all encounters."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--into", type=Path, default=Path("docs/pictures"), help="output folder (default docs/pictures)"
    )
    into: Path = parser.parse_args().into
    into.mkdir(parents=True, exist_ok=True)
    for name, encounter in ENCOUNTERS.items():
        run = play(encounter())
        draw(encounter(), run, into / f"{name}.png")
        print(name, run.ends, "collisions", run.collisions)


if __name__ == "__main__":
    main()
