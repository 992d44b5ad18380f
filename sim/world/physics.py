"""Physics of differential-drive robots: they move, touch walls and each other, and measure their wheels' rotation.

A tick is one call of a compiled kernel for all robots. Robots move one after another in the team's order. A
robot's move ends at the present bodies of the other robots. So no two robots ever overlap, and no robot has to wait for
another robot.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.frozen import frozen
from sim.common.geometry import Pose2
from sim.common.grid import GridFrame, OccupancyGrid
from sim.common.observations import TICK
from sim.common.polygons import (
    NO_POLYGONS,
    Clearance,
    Polygons,
    clearance_of,
    is_clear_of_walls,
    near_wall,
    placed_at,
    within_margin,
)
from sim.common.robot_numbers import namespace_of, robot_name
from sim.numerics import elementary, elementary_arrays
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.numerics.noise import key
from sim.numerics.noise_arrays import normals
from sim.parameters import WorldParameters
from sim.world.sensor_noise import SensorNoise, WheelNoise, measured_increment
from sim.world.thing import Thing
from sim.world.things import RobotBodies, ThingState, polygons_of, step_things

BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]


@frozen(eq=False)
class WorldState:
    """The truth about n robots in a tick. Its arrays are read-only.

    Attributes:
        tick: number of physics steps since the session began.
        poses: (n, 3) x, y, theta of every base in the map frame, theta in [-pi, pi).
        twists: (n, 2) true velocities of the last tick, base frame: m/s forward, rad/s counterclockwise.
        odom_poses: (n, 3) poses of the bases as measured by their wheels, each in the robot's own frame odom (its
            start).
        odom_twists: (n, 2) velocities that the wheels measured in the last tick.
        charge: (n,) remaining energy, in the game's units.
        contact: (n,) bool, True for a robot that a wall, another robot or a thing stopped, until it has moved away.
        collisions: (n,) int64, number of contacts so far.
        noise: true noise of the sensors.
        things: things that are present, and things that wait to appear.
        bodies: bodies of the present things, map frame.
    """

    tick: int
    poses: FloatArray
    twists: FloatArray
    odom_poses: FloatArray
    odom_twists: FloatArray
    charge: FloatArray
    contact: BoolArray
    collisions: IntArray
    noise: SensorNoise
    things: tuple[ThingState, ...] = ()
    bodies: Polygons = NO_POLYGONS

    def __post_init__(self) -> None:
        """Make the arrays read-only, because recorded ticks must not change."""
        self.poses.flags.writeable = False
        self.twists.flags.writeable = False
        self.odom_poses.flags.writeable = False
        self.odom_twists.flags.writeable = False
        self.charge.flags.writeable = False
        self.contact.flags.writeable = False
        self.collisions.flags.writeable = False


@dataclass(frozen=True, slots=True)
class Misplaced:
    """Reason why a robot cannot be put at a pose.

    Attributes:
        robot: index of the robot in the team.
        reason: "wall", "robot" or "thing", if its body would overlap it, or "outside", if it is outside the map.
        sentence: the reason as a sentence for people, with robots and coordinates.
    """

    robot: int
    reason: Literal["wall", "robot", "thing", "outside"]
    sentence: str


class _Body(NamedTuple):
    """Size and speed limits of a robot, for the kernel.

    Attributes:
        radius: radius of the circle around the base that contains all corners, meters.
        reach: maximum distance that a corner moves in a tick, meters.
        max_vel_x: see WorldParameters, also for the other fields.
    """

    radius: float
    reach: float
    max_vel_x: float
    max_vel_theta: float
    acc_lim_x: float
    acc_lim_theta: float


@njit(cache=True)
def _touches(
    robot: int,
    poses: FloatArray,
    footprint: FloatArray,
    radius: float,
    clearance: Clearance,
    frame: GridFrame,
    bodies: Polygons,
    margin: float,
    touched: BoolArray,
) -> tuple[bool, bool, bool]:
    """Return, for walls, other robots and things, True if a robot's body overlaps them or is within `margin` meters.

    Args:
        robot: index of the robot.
        poses: (n, 3) poses of all robots, including its own, map frame.
        footprint: (v, 2) corners, the same for all.
        radius: radius of the circle around the base that contains all corners.
        clearance: clearance of the grid.
        frame: frame of the grid.
        bodies: bodies of the things, map frame.
        margin: minimum distance, meters. If 0, only overlaps count.
        touched: (n,) output, set to True for every other robot that is touched.
    """
    x, y, theta = poses[robot]
    wall = False
    other = False
    thing = False
    if not is_clear_of_walls(x, y, radius + margin, clearance, frame):
        wall = near_wall(placed_at(footprint, x, y, theta), clearance, frame, margin)
    for j in range(poses.shape[0]):
        # Compare circles first. Most robots are so far away that the exact test is not needed.
        if j == robot or elementary.hypot(poses[j, 0] - x, poses[j, 1] - y) > 2.0 * radius + margin:
            continue
        body = placed_at(footprint, poses[j, 0], poses[j, 1], poses[j, 2])
        if within_margin(placed_at(footprint, x, y, theta), body, margin):
            touched[j] = True
            other = True
    for k in range(bodies.circles.shape[0]):
        distance = elementary.hypot(bodies.circles[k, 0] - x, bodies.circles[k, 1] - y)
        if thing or distance > radius + bodies.circles[k, 2] + margin:
            continue
        body = bodies.corners[bodies.ends[k] : bodies.ends[k + 1]]
        thing = within_margin(placed_at(footprint, x, y, theta), body, margin)
    return wall, other, thing


@njit(cache=True)
def _towards(value: float, target: float, limit: float, change: float) -> float:
    """Return `value` moved by at most `change` toward the target, which is limited to +-limit."""
    target = min(limit, max(-limit, target))
    return min(value + change, max(value - change, target))


@njit(cache=True)
def _chord(linear: float, angular: float, time: float) -> tuple[float, float]:
    """Return the signed length of an arc's chord, and the chord's angle to the first heading (half of the turn)."""
    half = 0.5 * angular * time
    # Below this angle, sin(half) / half is 1 to the last bit. The limit also avoids a division by 0.
    shrink = elementary.sin(half) / half if abs(half) > 1e-9 else 1.0
    return linear * time * shrink, half


@njit(cache=True)
def _step(
    tick: int,
    poses_before: FloatArray,
    twists_before: FloatArray,
    odom_before: FloatArray,
    contact_before: BoolArray,
    collisions_before: IntArray,
    commands: FloatArray,
    keys: NDArray[np.uint64],
    wheels: FloatArray,
    footprint: FloatArray,
    body: _Body,
    clearance: Clearance,
    frame: GridFrame,
    bodies: Polygons,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, BoolArray, IntArray]:
    """Return the state after one tick. See WorldState and SensorNoise for the arrays, World.step for the rules."""
    n = poses_before.shape[0]
    poses = poses_before.copy()
    twists = np.empty((n, 2))
    odom = odom_before.copy()
    odom_twists = np.zeros((n, 2))
    contact = np.zeros(n, dtype=np.bool_)
    collisions = collisions_before.copy()
    draws = np.empty(3)
    # Robots move one after another. A robot meets the new poses of robots before it and the old poses of robots after
    # it.
    for i in range(n):
        linear = _towards(twists_before[i, 0], commands[i, 0], body.max_vel_x, body.acc_lim_x * TICK)
        angular = _towards(twists_before[i, 1], commands[i, 1], body.max_vel_theta, body.acc_lim_theta * TICK)
        twists[i, 0] = linear
        twists[i, 1] = angular
        # A robot at rest causes no contact, and its odometry does not change.
        if linear == 0.0 and angular == 0.0:
            continue
        x, y, theta = poses[i, 0], poses[i, 1], poses[i, 2]
        # Check the body so often that no corner jumps over a cell between two checks.
        travel = (abs(linear) + abs(angular) * body.radius) * TICK
        looks = max(1, math.ceil(travel / frame.resolution))
        blocked = False
        for look in range(1, looks + 1):
            chord, half = _chord(linear, angular, TICK * look / looks)
            c, s = elementary.cos_sin(theta + half)
            poses[i, 0] = x + chord * c
            poses[i, 1] = y + chord * s
            poses[i, 2] = wrap_angle(theta + 2.0 * half)
            wall, other, thing = _touches(i, poses, footprint, body.radius, clearance, frame, bodies, 0.0, contact)
            if wall or other or thing:
                blocked = True
                break
        if blocked:
            poses[i, 0], poses[i, 1], poses[i, 2] = x, y, theta
            twists[i, 0] = 0.0
            twists[i, 1] = 0.0
            contact[i] = True
            continue
        chord, half = _chord(linear, angular, TICK)
        # Noise is keyed by the tick. So a robot that stands still need not draw numbers, and later numbers stay the
        # same.
        normals(keys[i], tick, draws)
        w = wheels[i]
        first_turn, measured_chord, second_turn = measured_increment(
            WheelNoise(w[0], w[1], w[2], w[3], w[4], w[5]), chord, half, draws
        )
        c, s = elementary.cos_sin(odom[i, 2] + first_turn)
        odom[i, 0] += measured_chord * c
        odom[i, 1] += measured_chord * s
        odom[i, 2] = wrap_angle(odom[i, 2] + first_turn + second_turn)
        odom_twists[i, 0] = measured_chord / TICK
        odom_twists[i, 1] = (first_turn + second_turn) / TICK
    ignored = np.empty(n, dtype=np.bool_)
    for i in range(n):
        # A robot may be stopped up to one tick's travel before an obstacle. It remains in contact until it is farther
        # away than that, so creeping nearer and being stopped again does not count as another collision.
        if contact_before[i] and not contact[i]:
            wall, other, thing = _touches(
                i, poses, footprint, body.radius, clearance, frame, bodies, body.reach, ignored
            )
            contact[i] = wall or other or thing
        if contact[i] and not contact_before[i]:
            collisions[i] += 1
    return poses, twists, odom, odom_twists, contact, collisions


def _is_zero(*arrays: FloatArray | BoolArray) -> bool:
    """Return True if all bits are 0. So -0.0 is not zero here, because the kernel makes it 0.0."""
    return not any(array.tobytes().strip(b"\0") for array in arrays)


@lru_cache(maxsize=64)
def _odometry_keys(seed: int, robots: int) -> NDArray[np.uint64]:
    """Return (robots,) keys of the wheels' noise."""
    return np.array([key(seed, namespace_of(i), "odometry") for i in range(robots)], dtype=np.uint64)


def with_charge(state: WorldState, robot: int, charge: float) -> WorldState:
    """Return the same world, but with this remaining energy of one robot (index in the team)."""
    charges = state.charge.copy()
    charges[robot] = charge
    return replace(state, charge=charges)


def with_noise(state: WorldState, robots: Sequence[WorldParameters]) -> WorldState:
    """Return the same world, but with the sensor noise from each robot's parameters."""
    return replace(state, noise=SensorNoise.of(robots))


def with_thing(state: WorldState, thing: Thing) -> WorldState:
    """Return the world with one more thing.

    It appears once its place is free, and replaces a thing of the same name.
    """
    kept = without_thing(state, thing.name)
    return replace(kept, things=(*kept.things, ThingState(thing)))


def without_thing(state: WorldState, name: str) -> WorldState:
    """Return the same world without the thing of this name."""
    things = tuple(presence for presence in state.things if presence.thing.name != name)
    return replace(state, things=things, bodies=polygons_of(things))


class World:
    """The physics of n robots among the walls of one map.

    Only occupied cells (100) are walls. Unknown cells and the space outside the map are empty, as for the laser.
    """

    def __init__(self, grid: OccupancyGrid, parameters: WorldParameters, seed: int, charge: float) -> None:
        """Build a world. `charge` is the initial energy of every robot.

        Raises:
            ValueError: the footprint has fewer than three corners.
        """
        if len(parameters.footprint) < 3:
            raise ValueError(f"the footprint must have at least three corners, not {len(parameters.footprint)}")
        self._grid = grid
        self._parameters = parameters
        self._seed = seed
        self._charge = charge
        self._clearance = clearance_of(grid)
        self._frame = grid.frame
        self._footprint = np.array(parameters.footprint, dtype=np.float64)
        radius = float(elementary_arrays.hypot(self._footprint[:, 0], self._footprint[:, 1]).max())
        self._body = _Body(
            radius=radius,
            reach=(parameters.max_vel_x + parameters.max_vel_theta * radius) * TICK,
            max_vel_x=parameters.max_vel_x,
            max_vel_theta=parameters.max_vel_theta,
            acc_lim_x=parameters.acc_lim_x,
            acc_lim_theta=parameters.acc_lim_theta,
        )

    def start(self, poses: Sequence[Pose2]) -> WorldState | Misplaced:
        """Return the world at tick 0: all robots are at rest at these poses (map frame), with zero odometry.

        If a pose is impossible, return the reason.
        """
        n = len(poses)
        placed = np.empty((n, 3))
        for robot, pose in enumerate(poses):
            placed[robot] = pose.x, pose.y, wrap_angle(pose.theta)
            obstacle = self._obstacle(robot, placed[: robot + 1], NO_POLYGONS)
            if obstacle is not None:
                return obstacle
        return WorldState(
            tick=0,
            poses=placed,
            twists=np.zeros((n, 2)),
            odom_poses=np.zeros((n, 3)),
            odom_twists=np.zeros((n, 2)),
            charge=np.full(n, self._charge, dtype=np.float64),
            contact=np.zeros(n, dtype=np.bool_),
            collisions=np.zeros(n, dtype=np.int64),
            noise=SensorNoise.of([self._parameters] * n),
        )

    def place(self, state: WorldState, robot: int, pose: Pose2) -> WorldState | Misplaced:
        """Return the same world with one robot (index) moved to another pose, at rest. Its odometry does not change."""
        poses = state.poses.copy()
        poses[robot] = pose.x, pose.y, wrap_angle(pose.theta)
        obstacle = self._obstacle(robot, poses, state.bodies)
        if obstacle is not None:
            return obstacle
        twists = state.twists.copy()
        odom_twists = state.odom_twists.copy()
        contact = state.contact.copy()
        twists[robot] = 0.0
        odom_twists[robot] = 0.0
        contact[robot] = False
        return replace(state, poses=poses, twists=twists, odom_twists=odom_twists, contact=contact)

    def step(self, state: WorldState, commands: FloatArray) -> WorldState:
        """Return the world one tick later. First the things move, then the robots.

        Each robot's velocity moves toward its command within the motors' limits of speed and acceleration. The robot
        moves along an exact arc. If its body would touch a wall or another body anywhere along the arc, the robot stays
        where it was and loses its velocity. If it would touch another robot, both are in contact. Odometry has the
        noise of Probabilistic Robotics, table 5.6, keyed by (seed, robot, tick).

        Args:
            state: the present world.
            commands: (n, 2) wanted velocities, base frame: m/s forward, rad/s counterclockwise.

        Raises:
            ValueError: `commands` is not one finite command for every robot.
        """
        n = state.poses.shape[0]
        if commands.shape != (n, 2):
            raise ValueError(f"{n} robots need commands of shape ({n}, 2), not {commands.shape}")
        if not np.isfinite(commands).all():
            raise ValueError(f"all commands must be finite numbers, not {commands.tolist()}")
        tick = state.tick + 1
        things, bodies = self._move_things(state)
        if _is_zero(commands, state.twists, state.odom_twists, state.contact):
            # All robots stand, and no contact can end. So the kernel would change nothing.
            return replace(state, tick=tick, things=things, bodies=bodies)
        poses, twists, odom_poses, odom_twists, contact, collisions = _step(
            tick,
            state.poses,
            state.twists,
            state.odom_poses,
            state.contact,
            state.collisions,
            np.ascontiguousarray(commands, dtype=np.float64),
            _odometry_keys(self._seed, n),
            state.noise.wheels,
            self._footprint,
            self._body,
            self._clearance,
            self._frame,
            bodies,
        )
        return WorldState(
            tick, poses, twists, odom_poses, odom_twists, state.charge, contact, collisions, state.noise, things, bodies
        )

    def _move_things(self, state: WorldState) -> tuple[tuple[ThingState, ...], Polygons]:
        if not state.things:
            return state.things, state.bodies
        robots = RobotBodies(state.poses, state.twists, self._footprint, self._body.radius)
        things = step_things(state.things, robots)
        still = all(after is before for after, before in zip(things, state.things, strict=True))
        return things, state.bodies if still else polygons_of(things)

    def _obstacle(self, robot: int, poses: FloatArray, bodies: Polygons) -> Misplaced | None:
        """Return the reason why this robot's pose in `poses`, (n, 3), is impossible; None if it is possible."""
        x, y = float(poses[robot, 0]), float(poses[robot, 1])
        where = f"{robot_name(robot)} cannot be at ({x:.2f}, {y:.2f})"
        if not self._grid.contains(*self._grid.cell_of(x, y)):
            return Misplaced(robot, "outside", f"{where}: that is outside the map")
        touched = np.zeros(poses.shape[0], dtype=np.bool_)
        wall, other, thing = _touches(
            robot, poses, self._footprint, self._body.radius, self._clearance, self._frame, bodies, 0.0, touched
        )
        if wall:
            return Misplaced(robot, "wall", f"{where}: its body would be in a wall")
        if other:
            return Misplaced(robot, "robot", f"{where}: {robot_name(int(np.argmax(touched)))} stands there")
        if thing:
            return Misplaced(robot, "thing", f"{where}: something stands there")
        return None
