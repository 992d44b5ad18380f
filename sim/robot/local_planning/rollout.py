"""Rollout of a command: the poses it leads through, their costs, and collisions of the outline there."""

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
"""Meters that a trajectory keeps from obstacles where it can: a robot too near a corner cannot turn."""


class MotionState(NamedTuple):
    """Pose of a robot in the map and its velocities: meters, radians, m/s, rad/s."""

    x: float
    y: float
    theta: float
    v: float
    w: float


class RobotBody(NamedTuple):
    """Shape and limits of the robot, in the form that compiled kernels take.

    Attributes:
        footprint: (n, 2) padded corners, base frame.
        roomy: the same with what its padding leaves of COMFORT around it.
        outline: (m, 2) points along it.
        inscribed: its radius, meters; so circumscribed.
        cost_scaling_factor: that of the costmap's inflation; so inflation_radius.
        acc_lim_x: limit of accelerating and braking, m/s^2; acc_lim_theta in turning, rad/s^2.
        period: seconds from one command to the next.
        hold: the same, latency included.
        margin: meters to keep from walls.
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
        legal: True if the center stays on the costmap and off obstacles.
        worst: the greatest cost under the center.
        total: the sum of the costs under the center.
        doubtful: True if the outline may touch something, and must be looked at.
        x: the pose that is scored; so y and theta.
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
    """Return the cost under the center below which a footprint grown by `scale` and COMFORT touches nothing, however turned."""
    # Inflation makes the cost at the center a measure of the distance to the nearest obstacle.
    radius = body.circumscribed * scale + 1.5 * COMFORT
    if radius >= body.inflation_radius:
        return 0
    return int(cost_at(radius, body.inscribed, body.cost_scaling_factor))


@njit(cache=True)
def rollout(
    now: MotionState, wanted_v: float, wanted_w: float, body: RobotBody, sim_time: float, steps: int
) -> FloatArray:
    """Return (steps, 3) poses that a command leads through, the present one first.

    Velocities approach the command at the limits of acceleration. Sine and cosine are turned along, which is
    faster than computing them anew at each pose.
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
            turning = w * dt
            turn_cos, turn_sin = elementary.cos_sin(turning)
        cos, sin = cos * turn_cos - sin * turn_sin, sin * turn_cos + cos * turn_sin
    return out


@njit(cache=True)
def trajectory_cost(
    costs: Costs, frame: CostFrame, now: MotionState, wanted_v: float, wanted_w: float, body: RobotBody,
    sim_time: float, steps: int, scored: int, free: int,
) -> TrajectoryCost:  # fmt: skip
    """Follow a command step by step as `rollout` does, and look at the costs under the center.

    Args:
        costs: (rows, cols) the local costmap.
        frame: its place in the map.
        now: the robot's pose and velocities.
        wanted_v: the command; so wanted_w.
        body: the robot's.
        sim_time: seconds.
        steps: number of poses.
        scored: index of the one to score.
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
        # The robot stands at the first pose already: what that costs is no fault of the command.
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
    """Return True if a footprint touches nothing along (k, 3) poses, the first left out; see `surely_free`."""
    for i in range(1, poses.shape[0]):
        x, y, theta = poses[i]
        row, col = math.floor((y - frame.y) / frame.resolution), math.floor((x - frame.x) / frame.resolution)
        if costs[row, col] >= free and footprint_cost(costs, frame, footprint, x, y, theta) < 0.0:
            return False
    return True


@njit(cache=True)
def comfortable(costs: Costs, frame: CostFrame, body: RobotBody, poses: FloatArray, free: int) -> bool:
    """Do the same for the footprint with COMFORT around it; poses where that would leave the costmap are skipped."""
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
    """Return True if a command leaves room to stop (`sim.robot.local_planning.braking.safe`)."""
    return safe(
        around, body.footprint, body.outline, now.x, now.y, now.theta, now.v, now.w, wanted_v, wanted_w, body.hold,
        body.acc_lim_x, body.acc_lim_theta, body.margin,
    )  # fmt: skip


class CandidateCommands(NamedTuple):
    """Commands that were tried, n of them in the first places of each array.

    Attributes:
        commands: (m, 2) m/s and rad/s.
        scores: (m,) the lower the better; infinite where a command leads nowhere.
        steps: (m,) poses of each one's rollout.
        growth: (m,) factor by which the footprint is scaled that must be free along it.
        doubtful: (m,) True when the outline may touch something.
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
    """Return the best of n commands that is free and safe (v, w) and its score; infinite: there is none.

    Checks that take long are made from the best score on. A command that comes nearer to something than COMFORT is
    taken only if nothing else is left, or if the robot is that near already.

    Args:
        costs: (rows, cols) the local costmap.
        frame: its place in the map.
        tried: the commands; their scores are used up.
        n: their number.
        around: walls and neighbors that the robot may hit.
        body: the robot's.
        now: the robot's pose and velocities.
        sim_time: seconds rolled out.
        at_once: True if a command's speed is reached in the first instant.
    """
    second_best, second_score = -1, np.inf
    crowded = footprint_cost(costs, frame, body.roomy, now.x, now.y, now.theta) < 0.0
    for _ in range(n):
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
