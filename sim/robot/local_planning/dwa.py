"""Dynamic window approach: choose the best of the commands that are reachable within the next period.

The dynamic window is the set of velocities (v, w) that the motors can reach within one control period. Samples on a
grid of this window are rolled out into arcs. Critics score each arc by distances and by the costs along the arc. The
distances are from the last pose to the path and to the path's end. They are computed for the robot's center and for a
nose in front of it. All arcs are rolled out first, so that distances are counted only for cells where arcs end
(`map_grid`). Two checks are slow: collisions of the outline, and room to brake. They start with the best score and end
at the first command that passes (`rollout.best_safe_command`).

Source: ros-planning/navigation, dwa_local_planner/src/dwa_planner.cpp; base_local_planner/src/
simple_trajectory_generator.cpp, simple_scored_sampling_planner.cpp and the cost functions; Fox, Burgard, Thrun, The
Dynamic Window Approach to Collision Avoidance (1997).
Differences from ROS: all those of `trajectory_rollout`, and one more. In ROS, a standing robot prefers turning in place
wherever obstacle costs exceed progress. Here it does not (see `STALL_TIMEOUT` in `local_planner`).
"""

import math
from typing import NamedTuple

import numpy as np

from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.parameters import DwaPlannerParameters, InflationParameters
from sim.robot.costmap.costs import CostFrame, Costs
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

EPSILON = 1e-4
"""Tolerance of velocities at their limits, m/s and rad/s."""
ESCAPE_VEL = -0.1
"""Velocity for backing up if no command makes progress, m/s.

It ends after ESCAPE_DIST meters. ROS leaves this to move_base.
"""
ESCAPE_DIST = 0.12


class _Samples(NamedTuple):
    """Commands to try, and settings of their rollouts.

    Attributes:
        v: (k,) velocities, m/s. `w` are (m,) angular velocities, rad/s.
        least_v: commands slower than both `least_v` and `least_w` are not tried.
        only_v: required sign of v. 0 permits both signs. `only_w` is the same for w.
        at_once: True if a command's velocity is reached immediately.
        sim_time: see DwaPlannerParameters, also for the other fields.
    """

    v: FloatArray
    w: FloatArray
    least_v: float
    least_w: float
    only_v: float
    only_w: float
    at_once: bool
    sim_time: float
    granularity: float
    angular_granularity: float


class _Critics(NamedTuple):
    """Weights and settings for the score of a trajectory.

    Attributes:
        path: weight per cell between the center's last position and the path. `alignment` is the same for the nose.
        goal: weight per cell between the last position and the path's end, for center and nose.
        obstacles: weight per unit of cost.
        sum_scores: True if the costs along the trajectory add up.
        twirling: weight per rad/s.
        nose: distance of the nose in front of the center, meters.
        scaling_speed: above this velocity, the footprint is enlarged, m/s. At `max_vel_trans` the factor is 1 +
            `max_scaling_factor`.
    """

    path: float
    alignment: float
    goal: float
    obstacles: float
    sum_scores: bool
    twirling: float
    nose: float
    scaling_speed: float
    max_scaling_factor: float
    max_vel_trans: float


@njit(cache=True)
def _growth(v: float, critics: _Critics) -> float:
    """Return the scale factor of the footprint. It increases with velocity, so that fast robots keep more distance."""
    above = abs(v) - critics.scaling_speed
    span = critics.max_vel_trans - critics.scaling_speed
    return 1.0 + critics.max_scaling_factor * above / span if above > 0.0 and span > 0.0 else 1.0


@njit(cache=True)
def _steps(v: float, w: float, samples: _Samples) -> int:
    """Return the number of poses in a rollout. No step is longer, or turns more, than the granularities allow."""
    distance, turn = abs(v) * samples.sim_time, abs(w) * samples.sim_time
    return max(1, math.ceil(max(distance / samples.granularity, turn / samples.angular_granularity)))


@njit(cache=True)
def _best(
    costs: Costs, frame: CostFrame, grid: MapGrids, path: FloatArray, around: Surroundings, body: RobotBody,
    now: MotionState, samples: _Samples, critics: _Critics,
) -> tuple[float, float, float]:  # fmt: skip
    """Return the best safe command (v, w) and its score, or an infinite score if there is no command."""
    rows, cols = costs.shape
    total = samples.v.shape[0] * samples.w.shape[0]
    out = candidate_commands(total)
    # For each trajectory: the cell of the center at its end, then the cell of the nose.
    cells = np.empty(2 * total, dtype=np.int32)
    n = 0
    for v in samples.v:
        # The footprint's scale depends only on v, so compute it once for all w.
        growth = _growth(v, critics)
        free = surely_free(body, growth)
        for w in samples.w:
            # As in ROS, one of the two velocities must reach its minimum.
            if abs(v) + EPSILON < samples.least_v and abs(w) + EPSILON < samples.least_w:
                continue
            if v * samples.only_v < 0.0 or w * samples.only_w < 0.0:
                continue
            steps = _steps(v, w, samples)
            begin = MotionState(now.x, now.y, now.theta, v, w) if samples.at_once else now
            tried = trajectory_cost(costs, frame, begin, v, w, body, samples.sim_time, steps, steps - 1, free)
            if not tried.legal:
                continue
            c, s = elementary.cos_sin(tried.theta)
            nose_x = tried.x + critics.nose * c
            nose_y = tried.y + critics.nose * s
            nose = index_of(costs, frame, nose_x, nose_y)
            if nose < 0:
                continue
            out.commands[n, 0], out.commands[n, 1] = v, w
            cells[2 * n], cells[2 * n + 1] = index_of(costs, frame, tried.x, tried.y), nose
            cost = tried.total if critics.sum_scores else tried.worst
            out.scores[n] = critics.obstacles * cost + critics.twirling * abs(w)
            out.steps[n] = steps
            out.growth[n] = growth
            out.doubtful[n] = tried.doubtful
            n += 1
    if n > 0:
        survey(costs, frame, now.x, now.y, body.inscribed, grid.terrain)
        along = cells_along(costs, frame, path)
        last = path[path.shape[0] - 1]
        spread(grid, cols, along, cells[: 2 * n], grid.path)
        spread(grid, cols, along[along.shape[0] - 1 :], cells[: 2 * n : 2], grid.goal)
        # The nose's goal is as far beyond the path's end as the nose is in front of the center.
        bearing = elementary.atan2(last[1] - now.y, last[0] - now.x)
        ahead = np.empty((1, 2))
        c, s = elementary.cos_sin(bearing)
        ahead[0, 0] = last[0] + critics.nose * c
        ahead[0, 1] = last[1] + critics.nose * s
        beyond = cells_along(costs, frame, ahead)
        spread(
            grid, cols, beyond if beyond.shape[0] > 0 else along[along.shape[0] - 1 :], cells[1 : 2 * n : 2], grid.nose
        )
    # As in ROS, the distance of a nose in an unreachable cell is the number of cells of the costmap.
    lost = rows * cols
    for i in range(n):
        end, nose = cells[2 * i], cells[2 * i + 1]
        if grid.path[end] < 0 or grid.goal[end] < 0:
            out.scores[i] = np.inf
            continue
        off = grid.path[nose] if grid.path[nose] >= 0 else lost
        left = grid.nose[nose] if grid.nose[nose] >= 0 else lost
        out.scores[i] += critics.path * grid.path[end] + critics.alignment * off
        out.scores[i] += critics.goal * (grid.goal[end] + left)
    return best_safe_command(costs, frame, out, n, around, body, now, samples.sim_time, samples.at_once)


def _spaced(low: float, high: float, samples: int) -> FloatArray:
    """Return (k,) evenly spaced velocities from low to high. If 0 is between them, it is inserted."""
    if low >= high:
        return np.array([high])
    speeds = np.linspace(low, high, max(2, samples))
    return np.insert(speeds, np.searchsorted(speeds, 0.0), 0.0) if low < 0.0 < high and 0.0 not in speeds else speeds


class _OscillationCritic:
    """Critic that forbids a robot to reverse its direction immediately (oscillation_cost_function.cpp).

    Args:
        reset_dist: distance after which the robot may reverse, meters.
        reset_angle: turn after which the robot may reverse, radians.

    Attributes:
        only: required signs of v and w. 0 permits both.
    """

    def __init__(self, reset_dist: float, reset_angle: float) -> None:
        self._reset_dist = reset_dist
        self._reset_angle = reset_angle
        self._last = [0.0, 0.0]
        self.only = [0.0, 0.0]
        self._since = MotionState(0.0, 0.0, 0.0, 0.0, 0.0)

    def took(self, now: MotionState, v: float, w: float, least_v: float) -> None:
        """Record the command that was given to the robot."""
        for axis, speed in enumerate((v, w if abs(v) <= least_v else 0.0)):
            sign = math.copysign(1.0, speed) if speed else 0.0
            if sign and sign == -self._last[axis]:
                self.only[axis] = sign
                self._since = now
            self._last[axis] = sign or self._last[axis]
        moved = elementary.hypot(now.x - self._since.x, now.y - self._since.y)
        turned = abs(math.remainder(now.theta - self._since.theta, math.tau))
        if any(self.only) and (moved > self._reset_dist or turned > self._reset_angle):
            self._last, self.only = [0.0, 0.0], [0.0, 0.0]


class DwaPlanner(LocalPlanner):
    """The dynamic window approach for one robot.

    Args:
        parameters: parameters of dwa_local_planner.
        footprint: (n, 2) padded corners, base frame.
        inflation: inflation parameters of the costmap.
        shape: rows and columns of the local costmap.
        period: time between two commands, seconds.
        padding: padding of the corners, meters.
    """

    def __init__(
        self,
        parameters: DwaPlannerParameters,
        footprint: FloatArray,
        inflation: InflationParameters,
        shape: tuple[int, int],
        period: float,
        padding: float = USUAL_PADDING,
    ) -> None:
        self._parameters = parameters
        self._grids = map_grids(*shape)
        limits = PlannerLimits(
            acc_lim_x=parameters.acc_lim_x,
            acc_lim_theta=parameters.acc_lim_theta,
            max_vel_theta=parameters.max_vel_theta,
            min_in_place_vel_theta=parameters.min_vel_theta,
            escape_vel=ESCAPE_VEL,
            escape_reset_dist=ESCAPE_DIST,
            escape_reset_theta=math.pi / 2,
            heading_lookahead=parameters.forward_point_distance,
            oscillation_reset_dist=parameters.oscillation_reset_dist,
            sim_time=parameters.sim_time,
            sim_granularity=parameters.sim_granularity,
            xy_goal_tolerance=parameters.xy_goal_tolerance,
            yaw_goal_tolerance=parameters.yaw_goal_tolerance,
            latch_xy_goal_tolerance=parameters.latch_xy_goal_tolerance,
            trans_stopped_vel=parameters.trans_stopped_vel,
            theta_stopped_vel=parameters.theta_stopped_vel,
        )
        super().__init__(limits, footprint, inflation, period, padding)

    def reset(self) -> None:
        """Forget the present path."""
        super().reset()
        wanted = self._parameters
        self._oscillation = _OscillationCritic(wanted.oscillation_reset_dist, wanted.oscillation_reset_angle)

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
        samples = self._samples(now, greatest_v, stalled)
        left = elementary.hypot(path[-1, 0] - now.x, path[-1, 1] - now.y)
        ahead = wanted.forward_point_distance
        near = left * left <= ahead * ahead * wanted.cheat_factor
        critics = _Critics(
            wanted.path_distance_bias * frame.resolution,
            0.0 if near else wanted.path_distance_bias * frame.resolution,
            wanted.goal_distance_bias * frame.resolution,
            0.0 if stalled else wanted.occdist_scale,
            wanted.sum_scores,
            wanted.twirling_scale,
            wanted.forward_point_distance,
            wanted.scaling_speed,
            wanted.max_scaling_factor,
            wanted.max_vel_trans,
        )
        v, w, score = _best(costs, frame, self._grids, path, around, self._body, now, samples, critics)
        if score < math.inf:
            self._oscillation.took(now, v, w, wanted.min_vel_trans)
        return v, w, score

    def _samples(self, now: MotionState, greatest_v: float, stalled: bool) -> _Samples:
        wanted = self._parameters
        only_v, only_w = self._oscillation.only
        reach = self._body.period if wanted.use_dwa else wanted.sim_time
        fastest = min(wanted.max_vel_x, wanted.max_vel_trans, max(greatest_v, wanted.min_vel_trans))
        highest_v = min(fastest, max(now.v, 0.0) + wanted.acc_lim_x * reach)
        lowest_v = min(highest_v, max(wanted.min_vel_x, -wanted.max_vel_trans, now.v - wanted.acc_lim_x * reach))
        return _Samples(
            _spaced(lowest_v, highest_v, wanted.vx_samples),
            _spaced(
                max(-wanted.max_vel_theta, now.w - wanted.acc_lim_theta * reach),
                min(wanted.max_vel_theta, now.w + wanted.acc_lim_theta * reach),
                wanted.vth_samples,
            ),
            wanted.min_vel_trans,
            # Infinite if stalled, so that no command that only turns is tried.
            math.inf if stalled else wanted.min_vel_theta,
            only_v,
            only_w,
            wanted.use_dwa,
            wanted.sim_time,
            wanted.sim_granularity,
            wanted.angular_sim_granularity,
        )
