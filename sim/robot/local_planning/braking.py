"""Safe commands: commands after which a robot can still stop in time.

Assume that a robot obeys a command until the next command, and then brakes as hard as it can. The command is safe if
during this time the robot never comes too close to a wall, or to a place where a neighbor can be while it brakes. Walls
must remain WALL_MARGIN away. A robot may use half of the gap to a neighbor, minus `NEIGHBOUR_MARGIN`, because the other
robot may use the other half at the same time. If the gap is already below the margin, because an estimate jumped or a
robot was put there, the gap must not shrink. So braking is always safe if the last command was safe. Robots that obey
only safe commands do not collide, as long as the margins cover the errors of their estimates. Turning in place moves
the corners of a robot very little between two commands. So a turn may use all of a gap except TURNING_MARGIN.

Source: Fox, Burgard, Thrun, The Dynamic Window Approach to Collision Avoidance (1997), for admissible velocities, from
which a robot can stop in time; van den Berg, Lin, Manocha, Reciprocal Velocity Obstacles (ICRA 2008), for two robots
that share the work of avoiding each other.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.observations import Neighbour
from sim.common.polygons import placed_at, point_to_edge, side
from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.robot.costmap.costs import LETHAL, CostFrame, Costs
from sim.robot.costmap.footprint_cost import circumscribed_radius

WALL_MARGIN = 0.08
"""Distance kept from walls, meters. It approximately equals the maximum error of localization."""
LEAST_MARGIN = 0.03
"""Part of WALL_MARGIN that always remains, meters."""
USUAL_PADDING = 0.01
"""costmap_2d's default `footprint_padding`, meters. If the padding is larger, the excess counts toward the margins."""
SLIGHT_MARGIN = 0.01
"""Minimum of a margin after the subtraction of excess padding, meters."""
NEIGHBOUR_MARGIN = 0.14
"""Distance kept from neighbors, meters. It is larger, because the localization errors of two robots add up."""
TURNING_MARGIN = 0.08
LATENCY = 0.02
"""Time from a decision to its effect, seconds."""
OBSTACLE_RANGE = 1.5
"""Distance within which obstacles seen by the laser are taken into account, meters."""
NEIGHBOUR_RANGE = 2.0
"""A neighbor is ignored if the distance between the footprints is above this, meters."""


class Surroundings(NamedTuple):
    """Walls and neighbors that a robot may hit, for compiled kernels.

    Attributes:
        clearance: (rows, cols) meters from each cell of the map to the nearest wall.
        frame: frame of these cells in the map.
        bodies: (k, n, 2) outlines of neighbors in the map: at their present poses, and at poses until they have
            stopped.
        gaps: (k,) distance from the robot to each outline before the robot moves, meters.
    """

    clearance: NDArray[np.float32]
    frame: CostFrame
    bodies: FloatArray
    gaps: FloatArray


@njit(cache=True)
def _inside(x: float, y: float, polygon: FloatArray) -> bool:
    """Return True if a point is in a polygon (even-odd rule)."""
    inside = False
    j = polygon.shape[0] - 1
    for i in range(polygon.shape[0]):
        if (polygon[i, 1] > y) != (polygon[j, 1] > y):
            slope = (polygon[j, 0] - polygon[i, 0]) / (polygon[j, 1] - polygon[i, 1])
            if x < slope * (y - polygon[i, 1]) + polygon[i, 0]:
                inside = not inside
        j = i
    return inside


@njit(cache=True)
def gap(a: FloatArray, b: FloatArray) -> float:
    """Return the distance between two polygons, meters, or 0 if they touch or overlap.

    Args:
        a: (n, 2) corners in order.
        b: (m, 2) corners in order.
    """
    if _inside(a[0, 0], a[0, 1], b) or _inside(b[0, 0], b[0, 1], a):
        return 0.0
    nearest = np.inf
    i_last = a.shape[0] - 1
    for i in range(a.shape[0]):
        j_last = b.shape[0] - 1
        ax, ay, bx, by = a[i_last, 0], a[i_last, 1], a[i, 0], a[i, 1]
        for j in range(b.shape[0]):
            cx, cy, dx, dy = b[j_last, 0], b[j_last, 1], b[j, 0], b[j, 1]
            # Two segments cross if the ends of each are on different sides of the other.
            apart_cd = side(ax, ay, bx, by, cx, cy) * side(ax, ay, bx, by, dx, dy) < 0.0
            if apart_cd and side(cx, cy, dx, dy, ax, ay) * side(cx, cy, dx, dy, bx, by) < 0.0:
                return 0.0
            nearest = min(nearest, point_to_edge(bx, by, cx, cy, dx, dy), point_to_edge(dx, dy, ax, ay, bx, by))
            j_last = j
        i_last = i
    return math.sqrt(nearest)


@njit(cache=True)
def _toward(speed: float, wanted: float, step: float) -> float:
    """Return the velocity after a change of at most `step` toward the wanted velocity."""
    return min(speed + step, wanted) if wanted > speed else max(speed - step, wanted)


@njit(cache=True)
def stopping_poses(
    x: float, y: float, theta: float, v: float, w: float, wanted_v: float, wanted_w: float, hold: float,
    acc_lim_x: float, acc_lim_theta: float,
) -> FloatArray:  # fmt: skip
    """Return (k, 3) poses of a robot that obeys a command for `hold` seconds and then brakes until it stops."""
    # A step is two ticks. After 8 s the rollout ends, so that very weak brakes do not make the search slower.
    dt = 0.04
    poses = np.empty((200, 3))
    n = 0
    time = 0.0
    while n < 200:
        braking = time >= hold
        v = _toward(v, 0.0 if braking else wanted_v, acc_lim_x * dt)
        w = _toward(w, 0.0 if braking else wanted_w, acc_lim_theta * dt)
        if braking and v == 0.0 and w == 0.0 and n > 0:
            break
        # The chord of an arc has the direction of the heading at the arc's middle.
        c, s = elementary.cos_sin(theta + 0.5 * w * dt)
        x += v * c * dt
        y += v * s * dt
        theta += w * dt
        poses[n, 0], poses[n, 1], poses[n, 2] = x, y, theta
        n += 1
        time += dt
    return poses[:n]


@njit(cache=True)
def wall_clearance(
    clearance: NDArray[np.float32], frame: CostFrame, outline: FloatArray, x: float, y: float, theta: float
) -> float:
    """Return the distance from a robot's outline to the nearest wall, meters, or 0 outside the map.

    Args:
        clearance: see Surroundings.
        frame: see Surroundings.
        outline: (m, 2) points along the outline, base frame.
        x: pose of the base in the map, with `y` and `theta`.
    """
    c, s = elementary.cos_sin(theta)
    rows, cols = clearance.shape
    least = np.inf
    for i in range(outline.shape[0]):
        px = x + c * outline[i, 0] - s * outline[i, 1]
        py = y + s * outline[i, 0] + c * outline[i, 1]
        # Interpolate between four cell centers. Otherwise a step along a wall could look like a step toward the wall.
        across, along = (py - frame.y) / frame.resolution - 0.5, (px - frame.x) / frame.resolution - 0.5
        row, col = math.floor(across), math.floor(along)
        if row < 0 or col < 0 or row >= rows - 1 or col >= cols - 1:
            return 0.0
        up, right = across - row, along - col
        low = (1.0 - right) * clearance[row, col] + right * clearance[row, col + 1]
        high = (1.0 - right) * clearance[row + 1, col] + right * clearance[row + 1, col + 1]
        least = min(least, (1.0 - up) * low + up * high)
    return least


@njit(cache=True)
def beside_obstacles(
    clearance: NDArray[np.float32], marks: Costs, frame: CostFrame, x: float, y: float
) -> tuple[NDArray[np.float32], CostFrame]:
    """Return the clearance around a robot. Obstacles that its laser has seen count as walls.

    Args:
        clearance: (rows, cols) meters to the nearest wall.
        marks: (rows, cols) LETHAL where an obstacle was seen.
        frame: frame of these cells in the map.
        x: position of the robot in the map, with `y`.

    Returns:
        A window of the clearance, exact up to WALL_MARGIN, and its frame.
    """
    cells = math.ceil(OBSTACLE_RANGE / frame.resolution)
    row, col = math.floor((y - frame.y) / frame.resolution), math.floor((x - frame.x) / frame.resolution)
    low, left = max(0, row - cells), max(0, col - cells)
    high, right = min(clearance.shape[0], row + cells + 1), min(clearance.shape[1], col + cells + 1)
    near = clearance[low:high, left:right].copy()
    span = math.ceil(WALL_MARGIN / frame.resolution) + 1
    # Beyond WALL_MARGIN the exact distance makes no difference. So each mark needs to change only few cells.
    for r in range(low, high):
        for c in range(left, right):
            if marks[r, c] != LETHAL:
                continue
            for i in range(max(low, r - span), min(high, r + span + 1)):
                for j in range(max(left, c - span), min(right, c + span + 1)):
                    away = np.float32(max(0.0, (elementary.hypot(i - r, j - c) - 0.5) * frame.resolution))
                    near[i - low, j - left] = min(near[i - low, j - left], away)
    return near, CostFrame(frame.x + left * frame.resolution, frame.y + low * frame.resolution, frame.resolution)


@njit(cache=True)
def _bodies(states: FloatArray, footprints: FloatArray, acc_lim_x: float, hold: float) -> FloatArray:
    """Return (3 k, n, 2) outlines of k robots: at the present poses, where they can stop, and halfway between.

    Args:
        states: (k, 5) x, y, theta, linear and angular velocity of each robot.
        footprints: (k, n, 2).
        acc_lim_x: braking limit for all robots, m/s^2.
        hold: time between two commands, including latency, seconds.
    """
    out = np.empty((3 * states.shape[0], footprints.shape[1], 2))
    for k in range(states.shape[0]):
        x, y, theta, v, w = states[k]
        # At constant speed v, the robot covers in this time the distance of holding v and then braking: v hold + v^2 /
        # (2 a).
        coast = hold + abs(v) / (2.0 * acc_lim_x)
        for part in range(3):
            time = 0.5 * part * coast
            turned = theta + w * time
            c, s = elementary.cos_sin(theta + 0.5 * w * time)
            body = placed_at(footprints[k], x + v * time * c, y + v * time * s, turned)
            # Copy the corners one by one. For slices whose shapes may differ, numba would compile an error message,
            # which takes about a second.
            for i in range(body.shape[0]):
                out[3 * k + part, i, 0], out[3 * k + part, i, 1] = body[i, 0], body[i, 1]
    return out


@njit(cache=True)
def _gaps(body: FloatArray, bodies: FloatArray) -> FloatArray:
    """Return (k,) distances from a polygon to k other polygons, meters.

    The three outlines of a robot all get the smallest of their distances.
    """
    out = np.empty(bodies.shape[0])
    for k in range(0, bodies.shape[0], 3):
        least = min(gap(body, bodies[k]), gap(body, bodies[k + 1]), gap(body, bodies[k + 2]))
        out[k : k + 3] = least
    return out


def surroundings(
    clearance: NDArray[np.float32],
    frame: CostFrame,
    footprint: FloatArray,
    pose: Pose2,
    neighbours: Sequence[Neighbour],
    acc_lim_x: float,
    hold: float,
) -> Surroundings:
    """Collect the walls and neighbors that a robot at a pose must avoid.

    Args:
        clearance: (rows, cols) meters to the nearest wall.
        frame: frame of these cells in the map.
        footprint: (n, 2) padded corners of the robot.
        pose: pose of its base in the map.
        neighbours: the other robots. Distant robots are ignored.
        acc_lim_x: braking limit for all robots, m/s^2.
        hold: time between two commands, including latency, seconds.
    """
    x, y, theta = pose.x, pose.y, pose.theta
    reach = NEIGHBOUR_RANGE + 2.0 * circumscribed_radius(footprint)
    near = [
        other for other in neighbours if abs(other.base_in_map.x - x) < reach and abs(other.base_in_map.y - y) < reach
    ]
    if not near:
        return Surroundings(clearance, frame, np.empty((0, len(footprint), 2)), np.empty(0))
    states = np.array(
        [
            (
                other.base_in_map.x,
                other.base_in_map.y,
                other.base_in_map.theta,
                other.twist.linear,
                other.twist.angular,
            )
            for other in near
        ]
    )
    footprints = np.array([_fitted(other.footprint, len(footprint)) for other in near])
    bodies = _bodies(states, footprints, acc_lim_x, hold)
    return Surroundings(clearance, frame, bodies, _gaps(placed_at(footprint, x, y, theta), bodies))


def _fitted(footprint: FloatArray, corners: int) -> FloatArray:
    """Return a footprint with this number of corners: with the last corner repeated, or reduced to its bounding box."""
    missing = corners - len(footprint)
    if missing == 0:
        return footprint
    if missing > 0:
        return np.vstack([footprint, np.repeat(footprint[-1:], missing, axis=0)])
    (x0, y0), (x1, y1) = footprint.min(axis=0), footprint.max(axis=0)
    return _fitted(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])[:corners], corners)


def left_of(margin: float, padding: float) -> float:
    """Return the part of a margin that a footprint's padding (meters) does not cover, meters."""
    return margin - max(0.0, padding - USUAL_PADDING)


@njit(cache=True)
def safe(
    around: Surroundings, footprint: FloatArray, outline: FloatArray, x: float, y: float, theta: float, v: float,
    w: float, wanted_v: float, wanted_w: float, hold: float, acc_lim_x: float, acc_lim_theta: float, margin: float,
) -> bool:  # fmt: skip
    """Return True if the robot can still stop in time after a command. See the module's docstring.

    Args:
        around: the surroundings at this pose.
        footprint: (n, 2) padded corners of the robot.
        outline: (m, 2) points along the footprint.
        x: pose of the base in the map, with `y` and `theta`.
        v: velocity of the robot, m/s. `w` is its angular velocity, rad/s.
        wanted_v: the command, with `wanted_w`.
        hold: time between two commands, including latency, seconds.
        acc_lim_x: braking limit, m/s^2. `acc_lim_theta` is the limit for turns, rad/s^2.
        margin: distance to keep from walls, meters.
    """
    room = wall_clearance(around.clearance, around.frame, outline, x, y, theta)
    # A robot nearer to a wall than the margin may come 3 mm nearer with each command. Otherwise it could not even drive
    # along the wall. These millimeters add up, but only until LEAST_MARGIN is left.
    room = max(min(margin, room) - 0.003, min(LEAST_MARGIN, margin, room))
    poses = stopping_poses(x, y, theta, v, w, wanted_v, wanted_w, hold, acc_lim_x, acc_lim_theta)
    radius = circumscribed_radius(footprint)
    for k in range(poses.shape[0]):
        px, py, turned = poses[k]
        if wall_clearance(around.clearance, around.frame, outline, px, py, turned) < room:
            return False
    turning = wanted_v == 0.0 and abs(v) < 0.05
    for j in range(around.bodies.shape[0]):
        present = around.gaps[j]
        # Half of the gap in excess of the margin may be used. A gap below the margin must not shrink, except by a
        # rounding error.
        if turning:
            needed = min(TURNING_MARGIN, present - 1e-3)
        elif present > NEIGHBOUR_MARGIN:
            needed = 0.5 * (present + NEIGHBOUR_MARGIN)
        else:
            needed = present - 1e-3
        body = around.bodies[j]
        for k in range(poses.shape[0]):
            px, py, turned = poses[k]
            # The whole footprint is within `radius` of the base. So in most cases the distance of the base, which is
            # cheap to compute, is sufficient.
            closest = np.inf
            for i in range(body.shape[0]):
                closest = min(closest, point_to_edge(px, py, body[i - 1, 0], body[i - 1, 1], body[i, 0], body[i, 1]))
            if math.sqrt(closest) - radius >= needed:
                continue
            if gap(placed_at(footprint, px, py, turned), body) < needed:
                return False
    return True
