"""Trajectory rollout: try commands in thought, score where they lead, take the best that is safe.

Source: ros-planning/navigation, base_local_planner/src/trajectory_planner.cpp and trajectory_planner_ros.cpp
(dwa false, meter_scoring true); Gerkey, Konolige, Planning and Control in Unstructured Terrain (2008).
Differs: a robot that faces away from its path first turns in place; obstacles are scored under the robot's centre, and
under its outline only looked at for collisions; a command must also be safe (`sim.control.braking`), and the speed
falls toward a point that may not be passed yet.
"""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from sim.control.braking import Surroundings, safe
from sim.control.map_grid import Steps, spread
from sim.costmap.costs import CostFrame, Costs, cost_at
from sim.costmap.footprint import footprint_cost, outline, radii
from sim.geometry import FloatArray, Pose2, wrap_angle
from sim.observations import STANDSTILL, Twist
from sim.parameters import TrajectoryPlannerParameters

ESCAPE_VELOCITY = -0.1
"""Metres a second backwards, when nothing else is left."""
LOOKAHEAD = 0.4
"""Metres along the path to the point that a robot turns to before it sets out."""
TURN_FIRST = 1.0
"""Radians off the path beyond which it turns in place, and TURNED within which it sets out."""
TURNED = 0.3
OUTLINE_SPACING = 0.1


@dataclass(frozen=True, slots=True)
class Drive:
    """A command, and what came of the search for it.

    Attributes:
        command: the velocity asked for.
        local_plan: (k, 3) map poses it leads through.
        stuck: whether every command that leads on was unsafe or blocked.
    """

    command: Twist
    local_plan: FloatArray
    stuck: bool


@njit(cache=True)
def rollout(
    x: float, y: float, theta: float, v: float, w: float, wanted_v: float, wanted_w: float, acc_lim_x: float,
    acc_lim_theta: float, sim_time: float, steps: int,
) -> FloatArray:  # fmt: skip
    """(steps, 3) poses that a command leads through, the present one first."""
    out = np.empty((steps, 3))
    dt = sim_time / steps
    for i in range(steps):
        out[i, 0], out[i, 1], out[i, 2] = x, y, theta
        v = min(v + acc_lim_x * dt, wanted_v) if wanted_v > v else max(v - acc_lim_x * dt, wanted_v)
        w = min(w + acc_lim_theta * dt, wanted_w) if wanted_w > w else max(w - acc_lim_theta * dt, wanted_w)
        x += v * math.cos(theta) * dt
        y += v * math.sin(theta) * dt
        theta += w * dt
    return out


@njit(cache=True)
def _score(
    costs: Costs, frame: CostFrame, path_steps: Steps, goal_steps: Steps, footprint: FloatArray, surely_free: int,
    poses: FloatArray, pdist_scale: float, gdist_scale: float, occdist_scale: float,
) -> float:  # fmt: skip
    """The cost of a rollout; negative when it collides or leads nowhere."""
    rows, cols = costs.shape
    occupied = 0.0
    row = col = 0
    for i in range(poses.shape[0]):
        row = math.floor((poses[i, 1] - frame.y) / frame.resolution)
        col = math.floor((poses[i, 0] - frame.x) / frame.resolution)
        if row < 0 or col < 0 or row >= rows or col >= cols:
            return -1.0
        cost = costs[row, col]
        # Where the centre's cost says that the whole circumscribed circle is free, the outline need not be drawn.
        if i > 0 and cost >= surely_free:
            if cost >= 253:
                return -1.0
            if footprint_cost(costs, frame, footprint, poses[i, 0], poses[i, 1], poses[i, 2]) < 0.0:
                return -1.0
        occupied = max(occupied, float(cost))
    if path_steps[row, col] < 0 or goal_steps[row, col] < 0:
        return -2.0
    metres = frame.resolution * (pdist_scale * path_steps[row, col] + gdist_scale * goal_steps[row, col])
    score: float = metres + occdist_scale * occupied
    return score


@njit(cache=True)
def _steps(v: float, w: float, sim_time: float, granularity: float) -> int:
    """How many poses of a rollout are looked at."""
    return max(1, int(max(abs(v) * sim_time / granularity, abs(w) * sim_time * 0.35 / granularity) + 0.5))


@njit(cache=True)
def _best(
    costs: Costs, frame: CostFrame, path_steps: Steps, goal_steps: Steps, queue: Steps, path: FloatArray,
    around: Surroundings, footprint: FloatArray, outline_points: FloatArray, surely_free: int, own_radius: float,
    x: float, y: float, theta: float, v: float, w: float, max_v: float, min_v: float, max_w: float, vx_samples: int,
    vtheta_samples: int, acc_lim_x: float, acc_lim_theta: float, sim_time: float, granularity: float, hold: float,
    pdist_scale: float, gdist_scale: float, occdist_scale: float,
) -> tuple[float, float, bool]:  # fmt: skip
    """The best safe command (v, w), and whether there is one."""
    spread(costs, frame, path, x, y, own_radius, path_steps, queue)
    spread(costs, frame, path[path.shape[0] - 1 :], x, y, own_radius, goal_steps, queue)
    highest_v = max(min(max_v, v + acc_lim_x * sim_time), min_v)
    lowest_v = max(min_v, v - acc_lim_x * sim_time)
    highest_w = min(max_w, w + acc_lim_theta * sim_time)
    lowest_w = max(-max_w, w - acc_lim_theta * sim_time)
    total = vx_samples * (vtheta_samples + 1)
    commands = np.empty((total, 2))
    scores = np.empty(total)
    n = 0
    for i in range(vx_samples):
        wanted_v = lowest_v + (highest_v - lowest_v) * i / max(1, vx_samples - 1)
        for j in range(-1, vtheta_samples):
            wanted_w = 0.0 if j < 0 else lowest_w + (highest_w - lowest_w) * j / max(1, vtheta_samples - 1)
            steps = _steps(wanted_v, wanted_w, sim_time, granularity)
            poses = rollout(x, y, theta, v, w, wanted_v, wanted_w, acc_lim_x, acc_lim_theta, sim_time, steps)
            score = _score(
                costs, frame, path_steps, goal_steps, footprint, surely_free, poses, pdist_scale, gdist_scale,
                occdist_scale,
            )  # fmt: skip
            if score >= 0.0:
                commands[n, 0], commands[n, 1] = wanted_v, wanted_w
                scores[n] = score
                n += 1
    # Safety is dear to check and the best command mostly safe: check them from the best on.
    for _ in range(n):
        best = 0
        for i in range(1, n):
            if scores[i] < scores[best]:
                best = i
        if scores[best] == np.inf:
            break
        wanted_v, wanted_w = commands[best, 0], commands[best, 1]
        if safe(
            around, footprint, outline_points, x, y, theta, v, w, wanted_v, wanted_w, hold, acc_lim_x, acc_lim_theta
        ):
            return wanted_v, wanted_w, True
        scores[best] = np.inf
    return 0.0, 0.0, False


class TrajectoryRollout:
    """The local planner of one robot.

    Args:
        parameters: base_local_planner's.
        footprint: (n, 2) padded corners, base frame.
        shape: rows and columns of the local costmap.
        hold: seconds from one command to the next, latency included.
        cost_scaling_factor: of the costmap's inflation; inflation_radius too.
    """

    def __init__(
        self,
        parameters: TrajectoryPlannerParameters,
        footprint: FloatArray,
        shape: tuple[int, int],
        hold: float,
        cost_scaling_factor: float,
        inflation_radius: float,
    ) -> None:
        self._parameters = parameters
        self._footprint = footprint
        self._outline = outline(footprint, OUTLINE_SPACING)
        self._hold = hold
        self._inscribed, circumscribed = radii(footprint)
        self._surely_free = (
            cost_at(circumscribed, self._inscribed, cost_scaling_factor) if circumscribed < inflation_radius else 0
        )
        self._path_steps = np.empty(shape, dtype=np.int32)
        self._goal_steps = np.empty(shape, dtype=np.int32)
        self._queue = np.empty(shape[0] * shape[1], dtype=np.int32)
        self._turning = False
        self._side = 0.0

    def reset(self) -> None:
        """Forget the path that was followed."""
        self._turning = False
        self._side = 0.0

    def turn_first(self) -> None:
        """Turn to the path before setting out again."""
        self._turning = True

    def safe(self, pose: Pose2, twist: Twist, command: Twist, around: Surroundings) -> bool:
        """Whether a command leaves room to stop."""
        return bool(
            safe(
                around,
                self._footprint,
                self._outline,
                pose.x,
                pose.y,
                pose.theta,
                twist.linear,
                twist.angular,
                command.linear,
                command.angular,
                self._hold,
                self._parameters.acc_lim_x,
                self._parameters.acc_lim_theta,
            )
        )

    def turn(self, pose: Pose2, twist: Twist, heading: float, around: Surroundings) -> Drive:
        """Turn in place toward a heading, the other way round if something is near; slower as it gets there."""
        wanted = self._parameters
        if abs(twist.linear) > 0.1:
            return Drive(STANDSTILL, self._preview(pose, twist, STANDSTILL), False)
        difference = wrap_angle(heading - pose.theta)
        speed = min(wanted.max_vel_theta, max(wanted.min_in_place_vel_theta, abs(difference)))
        if self._side == 0.0 or abs(difference) < TURN_FIRST:
            self._side = math.copysign(1.0, difference)
        # Having begun to turn the long way round, go on with it.
        for side in (self._side, -self._side):
            command = Twist(0.0, side * speed)
            if self.safe(pose, twist, command, around):
                self._side = side
                return Drive(command, self._preview(pose, twist, command), False)
        return Drive(STANDSTILL, self._preview(pose, twist, STANDSTILL), True)

    def back_up(self, pose: Pose2, twist: Twist, around: Surroundings) -> Drive:
        """Drive slowly backwards, if that is safe."""
        command = Twist(ESCAPE_VELOCITY, 0.0)
        if self.safe(pose, twist, command, around):
            return Drive(command, self._preview(pose, twist, command), False)
        return Drive(STANDSTILL, self._preview(pose, twist, STANDSTILL), True)

    def follow(
        self,
        pose: Pose2,
        twist: Twist,
        costs: Costs,
        frame: CostFrame,
        path: FloatArray,
        slow_down: float,
        around: Surroundings,
    ) -> Drive:
        """The command that leads along a path.

        Args:
            pose: of the base in the map.
            twist: how it moves.
            costs: (rows, cols) the local costmap.
            frame: where it lies.
            path: (m, 2) map points from the robot on, within the costmap; it leads to the last one.
            slow_down: seconds left to reach the last point at the present speed, at least.
            around: what may be bumped into.
        """
        wanted = self._parameters
        ahead = path - np.array([pose.x, pose.y])
        distances = np.hypot(ahead[:, 0], ahead[:, 1])
        beyond = np.flatnonzero(distances >= LOOKAHEAD)
        target = ahead[beyond[0]] if len(beyond) else ahead[-1]
        off = abs(wrap_angle(math.atan2(target[1], target[0]) - pose.theta))
        self._turning = off > (TURNED if self._turning else TURN_FIRST)
        self._side = self._side if self._turning else 0.0
        if self._turning:
            return self.turn(pose, twist, math.atan2(target[1], target[0]), around)
        v, w, found = _best(
            costs,
            frame,
            self._path_steps,
            self._goal_steps,
            self._queue,
            path,
            around,
            self._footprint,
            self._outline,
            self._surely_free,
            self._inscribed,
            pose.x,
            pose.y,
            pose.theta,
            twist.linear,
            twist.angular,
            min(wanted.max_vel_x, distances[-1] / slow_down),
            wanted.min_vel_x,
            wanted.max_vel_theta,
            wanted.vx_samples,
            wanted.vtheta_samples,
            wanted.acc_lim_x,
            wanted.acc_lim_theta,
            wanted.sim_time,
            wanted.sim_granularity,
            self._hold,
            wanted.pdist_scale,
            wanted.gdist_scale,
            wanted.occdist_scale,
        )
        command = Twist(v, w)
        return Drive(command, self._preview(pose, twist, command), not found)

    def _preview(self, pose: Pose2, twist: Twist, command: Twist) -> FloatArray:
        wanted = self._parameters
        poses: FloatArray = rollout(
            pose.x,
            pose.y,
            pose.theta,
            twist.linear,
            twist.angular,
            command.linear,
            command.angular,
            wanted.acc_lim_x,
            wanted.acc_lim_theta,
            wanted.sim_time,
            _steps(command.linear, command.angular, wanted.sim_time, wanted.sim_granularity),
        )
        return poses
