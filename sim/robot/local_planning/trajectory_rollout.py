"""Trajectory rollout: roll out sampled commands, score the resulting poses, choose the best command that is safe.

Source: ros-planning/navigation, base_local_planner/src/trajectory_planner.cpp and trajectory_planner_ros.cpp; Gerkey,
Konolige, Planning and Control in Unstructured Terrain (2008).
Differences from ROS: a robot that faces away from its path first turns in place. Obstacle costs are read under the
robot's center. The outline is only checked for collisions. Only the scored pose of a trajectory must have a path to the
goal. A command must also be safe (`braking`). The velocity is reduced near a point that the robot must not pass yet.
With a `min_vel_x` above 0, turns in place are tried only if no other command makes progress, and only to a heading with
progress.
"""

import math
from typing import NamedTuple

import numpy as np

from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.parameters import InflationParameters, TrajectoryPlannerParameters
from sim.robot.costmap.costs import INSCRIBED, CostFrame, Costs
from sim.robot.costmap.footprint_cost import footprint_cost
from sim.robot.local_planning.braking import USUAL_PADDING, Surroundings
from sim.robot.local_planning.local_planner import LocalPlanner, PlannerLimits
from sim.robot.local_planning.map_grid import MapGrids, cells_along, index_of, map_grids, spread, survey
from sim.robot.local_planning.rollout import (
    MotionState,
    RobotBody,
    best_safe_command,
    candidate_commands,
    surely_free,
    trajectory_cost,
)

HEADING_SCALE = 0.3
"""Weight of a deviation of one radian from the path in heading scoring. It is also fixed in ROS."""
STANDSTILL_SPEED = 1e-3
"""Velocity below which a command makes no progress, m/s."""
LOOK_AROUND = 0.5 * math.pi
"""Range on both sides in which a robot searches for a heading that brings progress, radians."""
LOOK_STEP = 0.15
"""Step between the headings of this search, radians."""


class _Samples(NamedTuple):
    """Commands to try, and settings of their rollouts. See TrajectoryPlannerParameters."""

    lowest_v: float
    highest_v: float
    lowest_w: float
    highest_w: float
    vx_samples: int
    vtheta_samples: int
    least_in_place: float
    standing: bool
    sim_time: float
    granularity: float
    angular_granularity: float


class _Weights(NamedTuple):
    """Weights for the score of a trajectory.

    Attributes:
        path: weight per cell off the path.
        goal: weight per cell that remains to the goal.
        obstacles: weight per unit of cost.
        heading_time: time along a trajectory at which its heading is scored, seconds. If negative, its end is scored.
        straight: True if the score uses the squared straight distance to the goal.
    """

    path: float
    goal: float
    obstacles: float
    heading_time: float
    straight: bool


@njit(cache=True)
def _steps(v: float, w: float, samples: _Samples, by_time: bool) -> int:
    """Return the number of poses in a rollout."""
    if by_time:
        return max(1, int(samples.sim_time / samples.granularity + 0.5))
    along = abs(v) * samples.sim_time / samples.granularity
    return max(1, int(max(along, abs(w) / samples.angular_granularity) + 0.5))


@njit(cache=True)
def _in_sight(costs: Costs, frame: CostFrame, x: float, y: float, to_x: float, to_y: float) -> bool:
    """Return True if no obstacle is on the straight line between two map points."""
    # A step is half a cell, so the line can skip only corners of cells.
    pieces = max(1, math.ceil(elementary.hypot(to_x - x, to_y - y) / (0.5 * frame.resolution)))
    for piece in range(pieces + 1):
        share = piece / pieces
        row = math.floor((y + share * (to_y - y) - frame.y) / frame.resolution)
        col = math.floor((x + share * (to_x - x) - frame.x) / frame.resolution)
        if row < 0 or col < 0 or row >= costs.shape[0] or col >= costs.shape[1] or costs[row, col] >= INSCRIBED:
            return False
    return True


@njit(cache=True)
def _heading_off(costs: Costs, frame: CostFrame, path: FloatArray, x: float, y: float, theta: float) -> float:
    """Return the angle between a heading and the farthest visible point of the path, radians.

    It is infinite if no point is visible.
    """
    for i in range(path.shape[0] - 1, -1, -1):
        if _in_sight(costs, frame, x, y, path[i, 0], path[i, 1]):
            return abs(wrap_angle(elementary.atan2(path[i, 1] - y, path[i, 0] - x) - theta))
    return np.inf


@njit(cache=True)
def _best(
    costs: Costs, frame: CostFrame, grid: MapGrids, path: FloatArray, around: Surroundings, body: RobotBody,
    now: MotionState, samples: _Samples, weights: _Weights,
) -> tuple[float, float, float]:  # fmt: skip
    """Return the best safe command (v, w), and its score minus that of standing still. Infinite without a command."""
    cols = costs.shape[1]
    by_time = weights.heading_time >= 0.0
    free = surely_free(body, 1.0)
    total = samples.vx_samples * (samples.vtheta_samples + 1)
    out = candidate_commands(total)
    ends = np.empty((total, 3))
    # The cells where trajectories end, and finally the cell of the robot.
    cells = np.empty(total + 1, dtype=np.int32)
    n = 0
    for i in range(samples.vx_samples):
        v = samples.lowest_v + (samples.highest_v - samples.lowest_v) * i / max(1, samples.vx_samples - 1)
        for j in range(-1, samples.vtheta_samples):
            share = j / max(1, samples.vtheta_samples - 1)
            # j = -1 is straight ahead (w = 0), which the samples of w may not include.
            w = 0.0 if j < 0 else samples.lowest_w + (samples.highest_w - samples.lowest_w) * share
            if abs(v) < STANDSTILL_SPEED and not (samples.standing and abs(w) >= samples.least_in_place):
                continue
            steps = _steps(v, w, samples, by_time)
            scored = steps - 1
            if by_time:
                scored = min(scored, math.ceil(weights.heading_time * steps / samples.sim_time))
            tried = trajectory_cost(costs, frame, now, v, w, body, samples.sim_time, steps, scored, free)
            if tried.legal:
                out.commands[n, 0], out.commands[n, 1] = v, w
                ends[n, 0], ends[n, 1], ends[n, 2] = tried.x, tried.y, tried.theta
                cells[n] = index_of(costs, frame, tried.x, tried.y)
                out.scores[n] = weights.obstacles * tried.worst
                out.steps[n] = steps
                out.doubtful[n] = tried.doubtful
                n += 1
    last = path[path.shape[0] - 1]
    # Scores are relative to standing still, so a negative score means progress toward the goal.
    standing = weights.goal * ((now.x - last[0]) ** 2 + (now.y - last[1]) ** 2)
    if not weights.straight and n > 0:
        cells[n] = index_of(costs, frame, now.x, now.y)
        survey(costs, frame, now.x, now.y, body.inscribed, grid.terrain)
        along = cells_along(costs, frame, path)
        spread(grid, cols, along, cells[: n + 1], grid.path)
        spread(grid, cols, along[along.shape[0] - 1 :], cells[: n + 1], grid.goal)
        standing = weights.path * grid.path[cells[n]] + weights.goal * grid.goal[cells[n]]
    for i in range(n):
        x, y, theta = ends[i]
        if weights.straight:
            out.scores[i] += weights.goal * ((x - last[0]) ** 2 + (y - last[1]) ** 2)
        elif grid.path[cells[i]] < 0 or grid.goal[cells[i]] < 0:
            out.scores[i] = np.inf
        else:
            out.scores[i] += weights.path * grid.path[cells[i]] + weights.goal * grid.goal[cells[i]]
        if by_time:
            out.scores[i] += HEADING_SCALE * _heading_off(costs, frame, path, x, y, theta)
    v, w, score = best_safe_command(costs, frame, out, n, around, body, now, samples.sim_time, False)
    return v, w, score - standing


class TrajectoryPlanner(LocalPlanner):
    """Trajectory rollout for one robot.

    Args:
        parameters: parameters of base_local_planner.
        footprint: (n, 2) padded corners, base frame.
        inflation: inflation parameters of the costmap.
        shape: rows and columns of the local costmap.
        period: time between two commands, seconds.
        padding: padding of the corners, meters.
    """

    def __init__(
        self,
        parameters: TrajectoryPlannerParameters,
        footprint: FloatArray,
        inflation: InflationParameters,
        shape: tuple[int, int],
        period: float,
        padding: float = USUAL_PADDING,
    ) -> None:
        limits = PlannerLimits(
            acc_lim_x=parameters.acc_lim_x,
            acc_lim_theta=parameters.acc_lim_theta,
            max_vel_theta=parameters.max_vel_theta,
            min_in_place_vel_theta=parameters.min_in_place_vel_theta,
            escape_vel=parameters.escape_vel,
            escape_reset_dist=parameters.escape_reset_dist,
            escape_reset_theta=parameters.escape_reset_theta,
            heading_lookahead=parameters.heading_lookahead,
            oscillation_reset_dist=parameters.oscillation_reset_dist,
            sim_time=parameters.sim_time,
            sim_granularity=parameters.sim_granularity,
            xy_goal_tolerance=parameters.xy_goal_tolerance,
            yaw_goal_tolerance=parameters.yaw_goal_tolerance,
            latch_xy_goal_tolerance=parameters.latch_xy_goal_tolerance,
            # ROS's value is fixed at 0.01, which noisy wheels never measure.
            trans_stopped_vel=0.05,
            theta_stopped_vel=0.1,
        )
        super().__init__(limits, footprint, inflation, period, padding)
        self._parameters = parameters
        self._grids = map_grids(*shape)

    def _search(
        self,
        now: MotionState,
        costs: Costs,
        frame: CostFrame,
        path: FloatArray,
        greatest_v: float,
        around: Surroundings,
        stalled: bool,
    ) -> tuple[float, float, float]:
        wanted = self._parameters
        reach = self._body.period if wanted.dwa else wanted.sim_time
        highest_v = max(min(wanted.max_vel_x, greatest_v, now.v + wanted.acc_lim_x * reach), wanted.min_vel_x)
        samples = _Samples(
            min(highest_v, max(wanted.min_vel_x, now.v - wanted.acc_lim_x * reach)),
            highest_v,
            max(wanted.min_vel_theta, now.w - wanted.acc_lim_theta * reach),
            min(wanted.max_vel_theta, now.w + wanted.acc_lim_theta * reach),
            wanted.vx_samples,
            wanted.vtheta_samples,
            wanted.min_in_place_vel_theta,
            not stalled,
            wanted.sim_time,
            wanted.sim_granularity,
            wanted.angular_sim_granularity,
        )
        # Weights here are per cell, as in ROS. Biases per meter are multiplied by the side of a cell.
        per_cell = frame.resolution if wanted.meter_scoring else 1.0
        weights = _Weights(
            0.0 if wanted.simple_attractor else wanted.path_distance_bias * per_cell,
            wanted.goal_distance_bias * per_cell,
            0.0 if stalled else wanted.occdist_scale,
            wanted.heading_scoring_timestep if wanted.heading_scoring else -1.0,
            wanted.simple_attractor,
        )
        return _best(costs, frame, self._grids, path, around, self._body, now, samples, weights)

    def _leading_heading(
        self,
        now: MotionState,
        costs: Costs,
        frame: CostFrame,
        path: FloatArray,
        greatest_v: float,
        around: Surroundings,
    ) -> float | None:
        # ROS's planner always tries turns in place. Here, with a `min_vel_x` above 0, the samples contain none.
        best, best_score = None, 0.0
        for side in (1.0, -1.0):
            for step in range(1, round(LOOK_AROUND / LOOK_STEP) + 1):
                there = MotionState(now.x, now.y, now.theta + side * step * LOOK_STEP, 0.0, 0.0)
                if footprint_cost(costs, frame, self._body.footprint, there.x, there.y, there.theta) < 0.0:
                    break
                _, _, score = self._search(there, costs, frame, path, greatest_v, around, stalled=True)
                if score < best_score:
                    best, best_score = there.theta, score
        return best
