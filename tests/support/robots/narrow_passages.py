"""Fields of cylinders with narrow passages, and drives through them with the parameters in narrow_passages.yaml.

The local planner is either ours, or that of ROS in a separate process (bench/robots/peers/trajectory_planner_peer.cpp).
Both use the same costmaps, global plans and recovery behaviors.
"""

import math
import struct
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label

from sim.common.distance_fields import cells_away
from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.common.observations import STANDSTILL, TICK, Neighbour, Twist
from sim.inputs import SendGoal
from sim.numerics.float_array import FloatArray
from sim.numerics.noise_arrays import NoiseStream
from sim.parameters import LaserParameters, RobotParameters, WorldParameters
from sim.robot.costmap.costs import CostFrame, Costs
from sim.robot.costmap.footprint import pad
from sim.robot.global_planning.itinerary import Itinerary, reached_index
from sim.robot.global_planning.itinerary_planner import ItineraryPlanner
from sim.robot.navigator import move_base
from sim.robot.navigator.controller import Controller
from sim.robot.navigator.follower import NO_POSES, Follower, FollowerOutput
from sim.robot.navigator.goals import Goal, GoalReached, NoPath
from sim.team import Team
from tests.support.project import ROOT
from thbridge.files.ros.parameters import read_ros_parameters

PARAMETERS = Path(__file__).with_name("narrow_passages.yaml")
PEER = ROOT / "tests/bench/robots/peers/trajectory_planner_peer.cpp"
STAND_INS = (
    "ros/console.h", "ros/ros.h", "geometry_msgs/Point.h", "geometry_msgs/PoseStamped.h", "costmap_2d/observation.h",
    "costmap_2d/footprint.h", "base_local_planner/planar_laser_scan.h", "base_local_planner/BaseLocalPlannerConfig.h",
    "base_local_planner/Position2DInt.h", "tf2/utils.h", "tf2/LinearMath/Matrix3x3.h", "angles/angles.h",
    "boost/thread.hpp", "boost/algorithm/string.hpp", "Eigen/Core",
)  # fmt: skip
"""Headers that peers/ros_stand_ins.h replaces."""
SOURCES = (
    "base_local_planner/src/trajectory_planner.cpp", "base_local_planner/src/costmap_model.cpp",
    "base_local_planner/src/footprint_helper.cpp", "base_local_planner/src/map_grid.cpp",
    "base_local_planner/src/map_cell.cpp", "base_local_planner/src/trajectory.cpp",
    "costmap_2d/src/costmap_2d.cpp", "costmap_2d/src/costmap_math.cpp",
)  # fmt: skip

FINE = 0.025
"""Side of a cell of the true map, meters."""
SITE = 0.15
"""Distance between neighboring sites of cylinders, meters; it is also the diameter of a cylinder."""
WIDTH, LENGTH = 30, 74
"""Number of sites across the field, and along it."""
OPEN_ENDS = 12
"""Rows of sites without cylinders at each end, where the robot starts and arrives."""
MARGIN = 14
"""Number of sites by which the map extends beyond the field on each side."""
PASSAGE = (0.6, 1.0)
"""Least and greatest width of the narrowest passage on the widest path through a field, meters."""
START = Pose2(MARGIN * SITE + 2.25, MARGIN * SITE + 0.8, 0.5 * math.pi)
GOAL = Pose2(START.x, START.y + 10.0, 0.5 * math.pi)
GOAL_RADIUS = 1.0
TIME_LIMIT = 100.0
WORLD = replace(
    WorldParameters(),
    footprint=((0.254, 0.215), (-0.254, 0.215), (-0.254, -0.215), (0.254, -0.215)),
    max_vel_x=2.0,
    max_vel_theta=4.0,
    acc_lim_x=20.0,
    acc_lim_theta=25.0,
    laser=replace(
        LaserParameters(), beams=720, rate=25, range_min=0.1, range_max=30.0, x=0.12, range_noise=0.001, dropout=0.0
    ),
)


def robot() -> RobotParameters:
    """Return the software parameters in PARAMETERS, with the true pose as localization, because the robot's map is
    empty."""
    return replace(read_ros_parameters([PARAMETERS], RobotParameters()).value, localization="truth")


def known_map() -> OccupancyGrid:
    """Return the robot's map, which is empty."""
    rows, cols = (round((size + 2 * MARGIN) * SITE / 0.05) for size in (LENGTH, WIDTH))
    return OccupancyGrid(np.zeros((rows, cols), np.int8), 0.05, Pose2(0.0, 0.0, 0.0))


def field_of(seed: int) -> OccupancyGrid:
    """Return the first field of cylinders drawn from a seed in which the narrowest passage has a width within
    PASSAGE."""
    noise = NoiseStream.named(seed, "cylinders")
    for attempt in range(1000):
        grid = _drawn(_sites(noise, attempt))
        if _passes(grid, PASSAGE[0]) and not _passes(grid, PASSAGE[1]):
            return grid
    raise ValueError(f"no field of seed {seed} has such a passage")


def _sites(noise: NoiseStream, attempt: int) -> NDArray[np.bool_]:
    """Return a (LENGTH, WIDTH) array, True at sites with a cylinder: clumps that a cellular automaton grows from random
    sites."""
    draws = noise.uniforms(attempt, 1 + WIDTH * LENGTH)
    taken = draws[1:].reshape(LENGTH, WIDTH) < 0.12 + 0.18 * draws[0]
    taken[:OPEN_ENDS] = taken[-OPEN_ENDS:] = False
    for _ in range(2):
        padded = np.pad(taken.astype(int), 1)
        shifted = [np.roll(padded, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        around = np.sum(shifted, axis=0)[1:-1, 1:-1] - taken
        taken = (taken & (around >= 2)) | (around >= 5)
        taken[:OPEN_ENDS] = taken[-OPEN_ENDS:] = False
    taken[:, [0, -1]] = taken[0] = True
    return np.asarray(taken)


def _drawn(sites: NDArray[np.bool_]) -> OccupancyGrid:
    per_site = round(SITE / FINE)
    middle = (np.arange(per_site) + 0.5) * FINE - 0.5 * SITE
    disc = middle[:, np.newaxis] ** 2 + middle**2 <= (0.5 * SITE) ** 2
    cells = np.where(np.kron(np.pad(sites, MARGIN), disc), OCCUPIED, FREE).astype(np.int8)
    return OccupancyGrid(cells, FINE, Pose2(0.0, 0.0, 0.0))


def _passes(grid: OccupancyGrid, gap: float) -> bool:
    """Return True if a disc with this diameter can move from the start to the goal within the field."""
    inner = slice(round(MARGIN * SITE / FINE), round((MARGIN + WIDTH) * SITE / FINE))
    away = cells_away(grid.cells == FREE)[:, inner] * FINE
    room, _ = label(away >= 0.5 * (gap + FINE))
    start, goal = (grid.cell_of(pose.x, pose.y) for pose in (START, GOAL))
    return bool(room[start[0], start[1] - inner.start] == room[goal[0], goal[1] - inner.start] != 0)


@dataclass(frozen=True, slots=True)
class Passage:
    """Result of a drive.

    Attributes:
        end: "reached", "collided", the reason why the robot gave up the goal, or "under way" after the time limit.
        seconds: simulated seconds until then.
    """

    end: str
    seconds: float


def drive(true: OccupancyGrid, software: RobotParameters, limit: float = TIME_LIMIT) -> Passage:
    """Drive through a field that the robot has no map of, until it is within GOAL_RADIUS of the goal."""
    team = Team(known_map(), WORLD, [software], [START], 1, math.inf, (), true)
    inputs = [SendGoal(0, Goal(0, GOAL))]
    for tick in range(1, round(limit / TICK) + 1):
        snapshot = team.step(inputs)
        inputs = []
        x, y, _ = snapshot.truth.poses[0]
        result = snapshot.robots[0].navigation.result
        if snapshot.truth.collisions[0] > 0:
            return Passage("collided", tick * TICK)
        if math.hypot(x - GOAL.x, y - GOAL.y) <= GOAL_RADIUS or isinstance(result, GoalReached):
            return Passage("reached", tick * TICK)
        if isinstance(result, NoPath):
            return Passage(result.reason, tick * TICK)
    return Passage("under way", limit)


def build_peer(navigation: Path, folder: Path) -> Path:
    """Compile ROS's planner without ROS, with the compiler options of a ROS release.

    Args:
        navigation: checkout of github.com/ros-planning/navigation.
        folder: output folder.
    """
    for name in STAND_INS:
        header = folder / name
        header.parent.mkdir(parents=True, exist_ok=True)
        header.write_text('#include "ros_stand_ins.h"\n')
    program = folder / "trajectory_planner_peer"
    includes = [PEER.parent, folder, navigation / "base_local_planner/include", navigation / "costmap_2d/include"]
    flags = ["-O3", "-DNDEBUG", "-w", *(f"-I{each}" for each in includes)]
    subprocess.run(["g++", *flags, PEER, *(navigation / name for name in SOURCES), "-o", program], check=True)
    return program


class Peer:
    """ROS's own trajectory planner, for one drive.

    Args:
        program: the compiled trajectory_planner_peer.
        software: parameters of the robot.
    """

    def __init__(self, program: Path, software: RobotParameters) -> None:
        parameters, costmap = software.TrajectoryPlannerROS, software.local_costmap
        words = [f"{each.name}={float(getattr(parameters, each.name))!r}" for each in fields(parameters)]
        corners = pad(np.array(costmap.footprint), costmap.footprint_padding).ravel().tolist()
        words.append("footprint=" + ",".join(map(repr, corners)))
        words.append(f"sim_period={1.0 / software.move_base.controller_frequency!r}")
        pipe = subprocess.PIPE
        self._process = subprocess.Popen([str(program), *words], stdin=pipe, stdout=pipe)

    def command(self, costs: Costs, frame: CostFrame, pose: Pose2, twist: Twist, plan: FloatArray) -> Twist | None:
        """Return the planner's command; None if it finds none.

        Args:
            costs: (rows, cols) the local costmap.
            frame: position of the costmap in the map.
            pose: pose of the robot in the map.
            twist: velocity of the robot.
            plan: (m, 2) points of a new plan; if empty, the planner uses its last plan.
        """
        feed, answer = self._process.stdin, self._process.stdout
        assert feed is not None and answer is not None
        values = (frame.resolution, frame.x, frame.y, pose.x, pose.y, pose.theta, twist.linear, twist.angular)
        feed.write(struct.pack("<iii", *costs.shape, len(plan)) + struct.pack("<8d", *values))
        feed.write(np.ascontiguousarray(plan, dtype=np.float64).tobytes() + np.ascontiguousarray(costs).tobytes())
        feed.flush()
        v, w, score = struct.unpack("<3d", answer.read(24))
        return Twist(v, w) if score >= 0.0 else None

    def close(self) -> None:
        """End the planner's process."""
        self._process.communicate()


class PeerFollower(Follower):
    """Follower that drives by a peer's commands. As in ROS, it leaves obstacles on the itinerary to the planner."""

    peer: Peer

    def __init__(
        self,
        controller: Controller,
        itinerary_planner: ItineraryPlanner,
        tick: int,
        itinerary: Itinerary,
        heading: float,
        turns_at_end: bool,
        before: Follower | None = None,
    ) -> None:
        super().__init__(controller, itinerary_planner, tick, itinerary, heading, turns_at_end, before)
        self._plan = itinerary.points

    def held_up(self, tick: int) -> bool:
        """Return False."""
        return False

    def obstructed(self) -> bool:
        """Return False."""
        return False

    def step(self, tick: int, pose: Pose2, twist: Twist, neighbours: Sequence[Neighbour]) -> FollowerOutput:
        """Return the peer's command."""
        if self._controller.update_due(tick):
            self._controller.update_costmap(pose, neighbours)
        index = int(reached_index(self._itinerary.points, self._index, pose.x, pose.y))
        if index > self._index:
            self._pass(index)
        costmap = self._controller.costmap
        command = self.peer.command(costmap.costs, costmap.frame, pose, twist, self._plan)
        self._plan = self._plan[:0]
        return FollowerOutput(command or STANDSTILL, NO_POSES, valid=command is not None)


@contextmanager
def driven_by(program: Path, software: RobotParameters) -> Iterator[None]:
    """Let ROS's planner drive robots instead of ours, until the end of the block."""
    PeerFollower.peer = Peer(program, software)
    try:
        with patch.object(move_base, "Follower", PeerFollower):
            yield
    finally:
        PeerFollower.peer.close()
