"""Simulation of one robot that drives to one goal on any map. The results are from the ground truth."""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from sim.common.geometry import Pose2
from sim.common.grid import OCCUPIED, OccupancyGrid
from sim.common.observations import TICK
from sim.inputs import PutThing, ScheduledInput, SendGoal, TeamInput
from sim.numerics.float_array import FloatArray
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.installed_parts import InstalledParts
from sim.robot.navigator.goals import Goal, GoalReached, NoPath
from sim.team import Team
from sim.world.physics import Misplaced, World


@dataclass(frozen=True, slots=True)
class DriveTask:
    """A drive from a start pose to a goal pose.

    Attributes:
        start: pose of the base, map frame.
        goal: pose of the base, map frame.
        any_heading: True if the heading at the goal does not matter.
        timeout: simulated seconds after which the drive ends.
    """

    start: Pose2
    goal: Pose2
    any_heading: bool
    timeout: float


@dataclass(frozen=True, slots=True)
class DriveResult:
    """The result of a drive.

    Attributes:
        reached: True if the robot reported its arrival at the goal.
        collided: True if the robot's body touched a wall or an obstacle.
        seconds: simulated seconds until the robot arrived or gave up.
        distance: true driven distance, meters.
        min_clearance: minimum true distance between the body's outline and walls or unmapped obstacles during the
            drive, meters. Infinite without walls. Moving obstacles do not count.
        reason: sentence with the reason why the robot did not arrive, or None if it arrived.
    """

    reached: bool
    collided: bool
    seconds: float
    distance: float
    min_clearance: float
    reason: str | None


def drive(
    grid: OccupancyGrid,
    world: WorldParameters,
    robot: RobotParameters,
    task: DriveTask,
    seed: int,
    true_grid: OccupancyGrid | None = None,
    schedule: Sequence[ScheduledInput] = (),
    parts: InstalledParts | None = None,
) -> DriveResult | Misplaced:
    """Drive a single robot to a goal. If its body does not fit at the start pose, return the reason.

    Args:
        grid: the map that the robot knows. Its origin may be rotated.
        world: bodies, motors and sensors.
        robot: the robot's software.
        task: start and goal.
        seed: random seed.
        true_grid: the true map, if it differs from the robot's map. Both maps have the same origin.
        schedule: obstacles that appear and vanish (`PutThing`, `RemoveThing`), map frame.
        parts: installed parts that the software may name. If None, the software must not name installed parts.
    """
    true_grid = true_grid or grid
    if grid.origin.theta != 0.0:
        # Drive in the frame of the grid, in which the map is not rotated. Lengths do not change.
        in_grid = grid.origin.inverse()
        task = dataclasses.replace(task, start=in_grid.compose(task.start), goal=in_grid.compose(task.goal))
        schedule = [ScheduledInput(timed.tick, _moved(timed.input, in_grid)) for timed in schedule]
        grid, true_grid = (
            OccupancyGrid(each.cells, each.resolution, Pose2(0.0, 0.0, 0.0)) for each in (grid, true_grid)
        )
    if task.any_heading:
        robot = _heedless_of_heading(robot)
    placed = World(true_grid, world, seed, charge=math.inf).start([task.start])
    if isinstance(placed, Misplaced):
        return placed
    team = Team(grid, world, [robot], [task.start], seed, math.inf, schedule, true_grid, parts)
    room = _Room(true_grid, np.array(world.footprint, dtype=np.float64))
    room.enter(placed.poses[0])
    inputs = [SendGoal(0, Goal(0, task.goal))]
    before, distance, collided = placed.poses[0], 0.0, False
    tick, reason = 0, f"the robot was still under way after {task.timeout:g} s"
    while tick < round(task.timeout / TICK):
        snapshot = team.step(inputs)
        tick, inputs = tick + 1, []
        pose = snapshot.truth.poses[0]
        distance += float(np.hypot(*(pose - before)[:2]))
        before = pose
        room.enter(pose)
        collided = bool(snapshot.truth.collisions[0] > 0)
        result = snapshot.robots[0].navigation.result
        if isinstance(result, GoalReached):
            return DriveResult(True, collided, round(tick * TICK, 2), distance, room.least, None)
        if isinstance(result, NoPath):
            reason = result.sentence
            break
    return DriveResult(False, collided, round(tick * TICK, 2), distance, room.least, reason)


def _moved(event: TeamInput, by: Pose2) -> TeamInput:
    """Return the event in another frame. Events without a pose do not change."""
    if not isinstance(event, PutThing):
        return event
    thing = event.thing
    path = by.transform(np.array(thing.path)).tolist() if thing.path else ()
    moved = dataclasses.replace(thing, base_in_map=by.compose(thing.base_in_map), path=tuple((x, y) for x, y in path))
    return PutThing(moved)


def _heedless_of_heading(robot: RobotParameters) -> RobotParameters:
    return dataclasses.replace(
        robot,
        TrajectoryPlannerROS=dataclasses.replace(robot.TrajectoryPlannerROS, yaw_goal_tolerance=math.pi),
        DWAPlannerROS=dataclasses.replace(robot.DWAPlannerROS, yaw_goal_tolerance=math.pi),
    )


class _Room:
    """Minimum distance of a moving body from the walls.

    Args:
        grid: the map, not rotated.
        footprint: (n, 2) corners of the body, base frame.
    """

    def __init__(self, grid: OccupancyGrid, footprint: FloatArray) -> None:
        rows, cols = np.nonzero(grid.cells == OCCUPIED)
        centres = grid.centres_of(np.column_stack([rows, cols]))
        self._half = 0.5 * grid.resolution
        self._walls = cKDTree(centres) if len(centres) else None
        self._centres = centres
        self._footprint = footprint
        self._radius = float(np.hypot(*footprint.T).max())
        self.least = math.inf

    def enter(self, pose: FloatArray) -> None:
        """Update the minimum distance with a new pose of the body (x, y, theta)."""
        if self._walls is None:
            return
        nearest, _ = self._walls.query(pose[:2])
        # The circumscribed circles of body and cell give a lower bound for the distance. So the exact distance is
        # necessary only for a few cells.
        around = self._radius + self._half * math.sqrt(2)
        if nearest - around >= self.least:
            return
        reach = nearest + 2 * around if math.isinf(self.least) else self.least + around
        cells = self._centres[self._walls.query_ball_point(pose[:2], reach)]
        if len(cells):
            body = Pose2(*(float(value) for value in pose)).transform(self._footprint)
            self.least = min(self.least, _to_squares(body, cells, self._half))


def _to_squares(body: FloatArray, centres: FloatArray, half: float) -> float:
    """Return the distance from a polygon to the nearest of k squares with these centers, meters. 0 for an overlap."""
    # The shortest distance between two disjoint polygons is from a corner of one polygon to an edge of the other.
    beside = np.maximum(np.abs(body[:, np.newaxis] - centres) - half, 0.0)
    corners = centres[:, np.newaxis] + half * np.array([(1, 1), (1, -1), (-1, -1), (-1, 1)])
    ends = np.roll(body, -1, axis=0)
    edges = ends - body
    along = corners.reshape(-1, 1, 2) - body
    share = np.clip((along * edges).sum(axis=2) / np.maximum((edges**2).sum(axis=1), 1e-12), 0.0, 1.0)
    off = along - share[..., np.newaxis] * edges
    return float(min(np.hypot(beside[..., 0], beside[..., 1]).min(), np.hypot(off[..., 0], off[..., 1]).min()))
