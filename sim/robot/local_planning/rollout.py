"""Rollout of a command: the poses along its trajectory, their costs, and collisions of the outline there."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.robot.costmap.costs import INSCRIBED, CostFrame, Costs
from sim.robot.costmap.footprint_cost import footprint_cost
from sim.robot.costmap.inflation import cost_at
from sim.robot.local_planning.braking import Surroundings, safe

COMFORT = 0.1
"""Preferred distance between a trajectory and obstacles, meters. A robot that is too close to a corner cannot turn."""


class MotionState(NamedTuple):
    """Pose of a robot in the map and its velocities: meters, radians, m/s, rad/s."""

    x: float
    y: float
    theta: float
    v: float
    w: float


class RobotBody(NamedTuple):
    """Shape and limits of the robot, for compiled kernels.

    Attributes:
        footprint: (n, 2) padded corners, base frame.
        roomy: footprint enlarged by the part of COMFORT that its padding does not cover.
        outline: (m, 2) points along the footprint.
        inscribed: inscribed radius of the footprint, meters. `circumscribed` is the circumscribed radius.
        cost_scaling_factor: parameter of the costmap's inflation, like `inflation_radius`.
        acc_lim_x: limit of acceleration and braking, m/s^2. `acc_lim_theta` is the limit for turns, rad/s^2.
        period: time between two commands, seconds.
        hold: time between two commands plus latency, seconds.
        margin: distance to keep from walls, meters.
    """

    footprint: FloatArray
    roomy: FloatArray
    outline: FloatArray
    inscribed: float
    circumscribed: float
    cost_scaling_factor: float
    inflation_radius: float
    acc_lim_x: float
    acc_lim_theta: float
    period: float
    hold: float
    margin: float


class TrajectoryCost(NamedTuple):
    """Costs along the trajectory of a command.

    Attributes:
        legal: True if the center remains on the costmap and meets no obstacle.
        worst: maximum cost under the center.
        total: sum of the costs under the center.
        doubtful: True if the outline may touch something and must be checked.
        x: pose to score, with `y` and `theta`.
    """

    legal: bool
    worst: float
    total: float
    doubtful: bool
    x: float
    y: float
    theta: float


@njit(cache=True)
def surely_free(body: RobotBody, scale: float) -> int:
    """Return a cost. If the center has a lower cost, the scaled footprint with COMFORT is free at any heading."""
    # Because of inflation, the cost at the center shows the distance to the nearest obstacle.
    radius = body.circumscribed * scale + 1.5 * COMFORT
    if radius >= body.inflation_radius:
        return 0
    return int(cost_at(radius, body.inscribed, body.cost_scaling_factor))


@njit(cache=True)
def rollout(
    now: MotionState, wanted_v: float, wanted_w: float, body: RobotBody, sim_time: float, steps: int
) -> FloatArray:
    """Return (steps, 3) poses along the trajectory of a command. The first is the present pose.

    Velocities approach the command at the limits of acceleration. The heading's cosine and sine are rotated step by
    step, which is faster than computing them for each pose.
    """
    out = np.empty((steps, 3))
    dt = sim_time / steps
    step_v, step_w = body.acc_lim_x * dt, body.acc_lim_theta * dt
    x, y, theta, v, w = now
    cos, sin = elementary.cos_sin(theta)
    turn_cos, turn_sin, turning = 1.0, 0.0, 0.0
    for i in range(steps):
        out[i, 0], out[i, 1], out[i, 2] = x, y, theta
        v = min(v + step_v, wanted_v) if wanted_v > v else max(v - step_v, wanted_v)
        w = min(w + step_w, wanted_w) if wanted_w > w else max(w - step_w, wanted_w)
        x += v * cos * dt
        y += v * sin * dt
        theta += w * dt
        if w * dt != turning:
            # The rotation per step changes only while the angular velocity changes.
            turning = w * dt
            turn_cos, turn_sin = elementary.cos_sin(turning)
        cos, sin = cos * turn_cos - sin * turn_sin, sin * turn_cos + cos * turn_sin
    return out


@njit(cache=True)
def trajectory_cost(
    costs: Costs, frame: CostFrame, now: MotionState, wanted_v: float, wanted_w: float, body: RobotBody,
    sim_time: float, steps: int, scored: int, free: int,
) -> TrajectoryCost:  # fmt: skip
    """Follow a command step by step like `rollout`, and read the costs under the center.

    Args:
        costs: (rows, cols) local costmap.
        frame: frame of the costmap in the map.
        now: pose and velocities of the robot.
        wanted_v: the command, with `wanted_w`.
        body: shape and limits of the robot.
        sim_time: duration, seconds.
        steps: number of poses.
        scored: index of the pose to score.
        free: see `surely_free`.
    """
    rows, cols = costs.shape
    dt = sim_time / steps
    step_v, step_w = body.acc_lim_x * dt, body.acc_lim_theta * dt
    x, y, theta, v, w = now
    cos, sin = elementary.cos_sin(theta)
    turn_cos, turn_sin, turning = 1.0, 0.0, 0.0
    per_cell = 1.0 / frame.resolution
    worst, total, doubtful = 0.0, 0.0, False
    scored_x, scored_y, scored_theta = x, y, theta
    for i in range(steps):
        row, col = math.floor((y - frame.y) * per_cell), math.floor((x - frame.x) * per_cell)
        if row < 0 or col < 0 or row >= rows or col >= cols:
            return TrajectoryCost(False, worst, total, doubtful, x, y, theta)
        cost = costs[row, col]
        # The robot is already at the first pose, so its cost does not depend on the command.
        if i > 0 and cost >= free:
            if cost >= INSCRIBED:
                return TrajectoryCost(False, worst, total, doubtful, x, y, theta)
            doubtful = True
        worst = max(worst, float(cost))
        total += cost
        if i == scored:
            scored_x, scored_y, scored_theta = x, y, theta
        v = min(v + step_v, wanted_v) if wanted_v > v else max(v - step_v, wanted_v)
        w = min(w + step_w, wanted_w) if wanted_w > w else max(w - step_w, wanted_w)
        x += v * cos * dt
        y += v * sin * dt
        theta += w * dt
        if w * dt != turning:
            turning = w * dt
            turn_cos, turn_sin = elementary.cos_sin(turning)
        cos, sin = cos * turn_cos - sin * turn_sin, sin * turn_cos + cos * turn_sin
    return TrajectoryCost(True, worst, total, doubtful, scored_x, scored_y, scored_theta)


@njit(cache=True)
def outline_free(costs: Costs, frame: CostFrame, footprint: FloatArray, poses: FloatArray, free: int) -> bool:
    """Return True if a footprint touches nothing at the (k, 3) poses after the first. See `surely_free` for `free`."""
    for i in range(1, poses.shape[0]):
        x, y, theta = poses[i]
        row, col = math.floor((y - frame.y) / frame.resolution), math.floor((x - frame.x) / frame.resolution)
        if costs[row, col] >= free and footprint_cost(costs, frame, footprint, x, y, theta) < 0.0:
            return False
    return True


@njit(cache=True)
def comfortable(costs: Costs, frame: CostFrame, body: RobotBody, poses: FloatArray, free: int) -> bool:
    """Do the same for the footprint with COMFORT around it. Poses where it would leave the costmap are ignored."""
    rows, cols = costs.shape
    rim = (body.circumscribed + 1.5 * COMFORT) / frame.resolution + 1.0
    for i in range(1, poses.shape[0]):
        x, y, theta = poses[i]
        across, along = (y - frame.y) / frame.resolution, (x - frame.x) / frame.resolution
        if across < rim or along < rim or across > rows - rim or along > cols - rim:
            continue
        cost = costs[math.floor(across), math.floor(along)]
        if cost >= free and footprint_cost(costs, frame, body.roomy, x, y, theta) < 0.0:
            return False
    return True


@njit(cache=True)
def command_safe(around: Surroundings, body: RobotBody, now: MotionState, wanted_v: float, wanted_w: float) -> bool:
    """Return True if the robot can still stop in time after a command (`sim.robot.local_planning.braking.safe`)."""
    return safe(
        around, body.footprint, body.outline, now.x, now.y, now.theta, now.v, now.w, wanted_v, wanted_w, body.hold,
        body.acc_lim_x, body.acc_lim_theta, body.margin,
    )  # fmt: skip


class CandidateCommands(NamedTuple):
    """Candidate commands. Only the first n elements of each array are used.

    Attributes:
        commands: (m, 2) m/s and rad/s.
        scores: (m,) scores. Lower is better. Infinite if a command makes no progress.
        steps: (m,) number of poses of each rollout.
        growth: (m,) scale factor of the footprint that must be free along the rollout.
        doubtful: (m,) True if the outline may touch something.
    """

    commands: FloatArray
    scores: FloatArray
    steps: NDArray[np.int64]
    growth: FloatArray
    doubtful: NDArray[np.bool_]


@njit(cache=True)
def candidate_commands(room: int) -> CandidateCommands:
    """Make the arrays for `room` commands."""
    return CandidateCommands(
        np.empty((room, 2)),
        np.empty(room),
        np.empty(room, dtype=np.int64),
        np.ones(room),
        np.empty(room, dtype=np.bool_),
    )


@njit(cache=True)
def best_safe_command(
    costs: Costs, frame: CostFrame, tried: CandidateCommands, n: int, around: Surroundings, body: RobotBody,
    now: MotionState, sim_time: float, at_once: bool,
) -> tuple[float, float, float]:  # fmt: skip
    """Return the best free and safe command (v, w) of n commands, and its score, which is infinite if there is none.

    The slow checks start with the best score and end at the first command that passes. A command that leads nearer than
    COMFORT to a wall or a body is used only if there is no other command, or if the robot is already that near.

    Args:
        costs: (rows, cols) local costmap.
        frame: frame of the costmap in the map.
        tried: the commands. Their scores are overwritten.
        n: number of commands.
        around: walls and neighbors that the robot may hit.
        body: shape and limits of the robot.
        now: pose and velocities of the robot.
        sim_time: duration of the rollouts, seconds.
        at_once: True if a command's velocity is reached immediately.
    """
    second_best, second_score = -1, np.inf
    # A robot that is already too close must still be able to leave.
    crowded = footprint_cost(costs, frame, body.roomy, now.x, now.y, now.theta) < 0.0
    for _ in range(n):
        # Select the minimum repeatedly instead of sorting, because usually one of the first commands passes.
        best = 0
        for i in range(1, n):
            if tried.scores[i] < tried.scores[best]:
                best = i
        if tried.scores[best] == np.inf:
            break
        score, tried.scores[best] = tried.scores[best], np.inf
        v, w = tried.commands[best]
        near = False
        if tried.doubtful[best]:
            begin = MotionState(now.x, now.y, now.theta, v, w) if at_once else now
            poses = rollout(begin, v, w, body, sim_time, tried.steps[best])
            free = surely_free(body, tried.growth[best])
            if not outline_free(costs, frame, tried.growth[best] * body.footprint, poses, free):
                continue
            near = not crowded and not comfortable(costs, frame, body, poses, free)
        if (not near or second_best < 0) and command_safe(around, body, now, v, w):
            if not near:
                return v, w, score
            second_best, second_score = best, score
    if second_best >= 0:
        return tried.commands[second_best, 0], tried.commands[second_best, 1], second_score
    return 0.0, 0.0, np.inf
