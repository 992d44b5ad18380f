"""Base of local planners: maneuvers and limits that all of them share. Subclasses search for the commands.

A robot that faces away from its path turns in place before it starts. If no command makes progress, the robot backs up.
After every command, the robot can still stop in time (`sim.robot.local_planning.braking`).
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

from sim.common.frozen import frozen
from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Twist
from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.parameters import InflationParameters
from sim.robot.costmap.costs import CostFrame, Costs
from sim.robot.costmap.footprint import outline, pad, radii
from sim.robot.local_planning.braking import LATENCY, SLIGHT_MARGIN, WALL_MARGIN, Surroundings, left_of
from sim.robot.local_planning.rollout import COMFORT, MotionState, RobotBody, command_safe, rollout

TURN_IN_PLACE = 1.0
"""A robot turns in place if its angle to the path is above this, radians. Below TURNED it starts to drive."""
TURNED = 0.3
ALIGNED = 0.05
"""After a turn to a heading that brings progress, a robot drives if the remaining angle is below this, radians."""
OUTLINE_SPACING = 0.1
STALL_TIMEOUT = 3.0
"""A robot is stalled if it has not moved STALL_DISTANCE meters in this number of seconds of driving.

Then obstacles count only where the robot would touch them.
"""
STALL_DISTANCE = 0.3
FREE_AGAIN_DISTANCE = 1.0
"""After a robot has moved this distance, it is no longer stalled, and the costs of obstacles count again, meters."""
BACK_ALONG = 0.1
"""Maximum change of heading since a robot last drove forward, radians. After a larger change, a robot with little
margin must not back up. Costmaps forget obstacles under the padded outline, and a laser does not see behind the robot.
So only the space where the body has been is certainly free."""
MIN_ARC_RADIUS = 0.05
"""Minimum radius of arcs for backing up, meters. It also applies to robots with a smaller radius, even to a point."""


@frozen()
class PlannedCommand:
    """A command, its trajectory, and the success of the search for a command.

    Attributes:
        command: the velocity command.
        local_plan: (k, 3) map poses along its trajectory.
        stuck: True if every command that makes progress was unsafe or blocked.
    """

    command: Twist
    local_plan: FloatArray
    stuck: bool


@dataclass(frozen=True, slots=True)
class PlannerLimits:
    """Parameters of a local planner that are used by the navigator and by maneuvers of all planners.

    Attributes:
        acc_lim_x: limit of acceleration, m/s^2. `acc_lim_theta` is the limit for turns, rad/s^2.
        max_vel_theta: maximum angular velocity, rad/s. In place, the minimum is `min_in_place_vel_theta`.
        escape_vel: velocity for backing up, negative, m/s. Backing up ends after `escape_reset_dist` meters or
            `escape_reset_theta` radians.
        heading_lookahead: distance along the path to the point that a robot faces before it starts, meters.
        oscillation_reset_dist: distance after which a robot may turn in the opposite direction, meters.
        sim_time: duration of a rollout, seconds.
        sim_granularity: distance between the points of a rollout, meters.
        xy_goal_tolerance: tolerance of the position, meters. `yaw_goal_tolerance` is for the heading, radians.
        latch_xy_goal_tolerance: True if a robot that has reached the goal only turns from then on.
        trans_stopped_vel: velocity below which a robot counts as standing, m/s. `theta_stopped_vel` is the limit for
            turns, rad/s.
    """

    acc_lim_x: float
    acc_lim_theta: float
    max_vel_theta: float
    min_in_place_vel_theta: float
    escape_vel: float
    escape_reset_dist: float
    escape_reset_theta: float
    heading_lookahead: float
    oscillation_reset_dist: float
    sim_time: float
    sim_granularity: float
    xy_goal_tolerance: float
    yaw_goal_tolerance: float
    latch_xy_goal_tolerance: bool
    trans_stopped_vel: float
    theta_stopped_vel: float


@njit(cache=True)
def _toward(path: FloatArray, x: float, y: float, lookahead: float) -> tuple[float, float]:
    """Return the heading from (x, y) to the first point `lookahead` away, and the meters to the last point."""
    last = path.shape[0] - 1
    target = last
    for i in range(last):
        if elementary.hypot(path[i, 0] - x, path[i, 1] - y) >= lookahead:
            target = i
            break
    heading = elementary.atan2(path[target, 1] - y, path[target, 0] - x)
    return heading, elementary.hypot(path[last, 0] - x, path[last, 1] - y)


class LocalPlanner(ABC):
    """Planner of commands for one robot. After each command, the robot can still stop in time.

    Commands are sampled and rolled out. Subclasses define the samples and their scores.

    Args:
        limits: limits from the planner's parameters.
        footprint: (n, 2) padded corners, base frame.
        inflation: inflation parameters of the costmap.
        period: time between two commands, seconds.
        padding: padding of the corners, meters.

    Attributes:
        limits: parameters that the navigator also uses.
    """

    def __init__(
        self,
        limits: PlannerLimits,
        footprint: FloatArray,
        inflation: InflationParameters,
        period: float,
        padding: float,
    ) -> None:
        inscribed, circumscribed = radii(footprint)
        margin = max(SLIGHT_MARGIN, left_of(WALL_MARGIN, padding))
        self.limits = limits
        self._body = RobotBody(
            footprint,
            pad(footprint, max(0.0, left_of(COMFORT, padding))),
            outline(footprint, min(OUTLINE_SPACING, 2.0 * margin)),
            inscribed,
            circumscribed,
            inflation.cost_scaling_factor,
            inflation.inflation_radius,
            limits.acc_lim_x,
            limits.acc_lim_theta,
            period,
            period + LATENCY,
            margin,
        )
        self.reset()

    def reset(self) -> None:
        """Forget the present path."""
        self._turning = False
        self._side = 0.0
        self._turned_at: Pose2 | None = None
        self._barred: tuple[float, ...] = ()
        self._escape_speed = self.limits.escape_vel
        self._mark: Pose2 | None = None
        self._stalled_for = 0.0
        self._heading: float | None = None
        self._came: float | None = None

    def turn_first(self) -> None:
        """Let the robot turn to its path before it drives on."""
        self._turning = True
        self._escape_speed = self.limits.escape_vel

    def safe(self, pose: Pose2, twist: Twist, command: Twist, around: Surroundings) -> bool:
        """Return True if the robot can still stop in time after a command."""
        return bool(command_safe(around, self._body, _motion(pose, twist), command.linear, command.angular))

    def turn(self, pose: Pose2, twist: Twist, heading: float, around: Surroundings) -> PlannedCommand:
        """Turn in place toward a heading, and slow down near it.

        If the turn is blocked, turn in the other direction.
        """
        # A robot that still drives must stop first, because otherwise it would turn in an arc.
        if abs(twist.linear) > 0.1:
            return PlannedCommand(STANDSTILL, self._preview(pose, twist, STANDSTILL), False)
        limits = self.limits
        difference = wrap_angle(heading - pose.theta)
        speed = min(limits.max_vel_theta, max(limits.min_in_place_vel_theta, abs(difference)))
        if self._turned_at is None or self._turned_at.distance(pose) > limits.oscillation_reset_dist:
            self._turned_at, self._side, self._barred = pose, 0.0, ()
        if self._side == 0.0 or abs(difference) < TURN_IN_PLACE:
            self._side = math.copysign(1.0, difference)
        # A robot that turns through the larger angle continues to do so, and a blocked direction remains blocked until
        # the robot drives. Otherwise the robot would turn back and forth between two obstacles.
        for side in (self._side, -self._side):
            if side in self._barred:
                continue
            command = Twist(0.0, side * speed)
            if self.safe(pose, twist, command, around):
                self._side = side
                return PlannedCommand(command, self._preview(pose, twist, command), False)
            self._barred = (*self._barred, side)
        return PlannedCommand(STANDSTILL, self._preview(pose, twist, STANDSTILL), True)

    def escape(self, pose: Pose2, twist: Twist, around: Surroundings) -> PlannedCommand:
        """Drive slowly backward, in an arc if necessary.

        If there is no space behind the robot, drive forward, provided that this is safe.
        """
        # With little margin, a robot may back up only the way that it came, see `BACK_ALONG`.
        backs_up = self._body.margin == WALL_MARGIN or (
            self._came is not None and abs(wrap_angle(pose.theta - self._came)) < BACK_ALONG
        )
        # Try the last direction first, so that a robot does not return to an obstacle that it has left.
        for speed in (self._escape_speed, -self._escape_speed):
            if speed < 0.0 and not backs_up:
                continue
            # If driving straight would approach a corner, an arc may lead away from it.
            arc = 2.0 * speed / max(self._body.circumscribed, MIN_ARC_RADIUS)
            for turn in (0.0, arc, -arc):
                command = Twist(speed, turn)
                if self.safe(pose, twist, command, around):
                    self._escape_speed = speed
                    return PlannedCommand(command, self._preview(pose, twist, command), False)
        return PlannedCommand(STANDSTILL, self._preview(pose, twist, STANDSTILL), True)

    def follow(
        self,
        pose: Pose2,
        twist: Twist,
        costs: Costs,
        frame: CostFrame,
        path: FloatArray,
        slow_down: float,
        around: Surroundings,
    ) -> PlannedCommand:
        """Choose the command that follows a path best.

        Args:
            pose: pose of the base in the map.
            twist: velocity of the base.
            costs: (cells, cells) local costmap.
            frame: frame of the costmap in the map.
            path: (m, 2) map points from the robot on, within the costmap. The last point is the target.
            slow_down: minimum time until the robot reaches the last point, seconds. It limits the velocity.
            around: walls and neighbors that the robot may hit.
        """
        aligning = self._align(pose, twist, around)
        if aligning is not None:
            return aligning
        heading, to_end = _toward(path, pose.x, pose.y, self.limits.heading_lookahead)
        off = abs(wrap_angle(heading - pose.theta))
        # With two limits, small changes of the heading do not make the robot switch between turning and driving.
        self._turning = off > (TURNED if self._turning else TURN_IN_PLACE)
        if self._turning:
            return self.turn(pose, twist, heading, around)
        if self._turned_at is not None and self._turned_at.distance(pose) > self.limits.oscillation_reset_dist:
            self._side, self._turned_at = 0.0, None
        greatest = to_end / slow_down
        stalled = self._is_stalled(pose)
        now = _motion(pose, twist)
        v, w, score = self._search(now, costs, frame, path, greatest, around, stalled)
        if score == math.inf:
            self._heading = self._leading_heading(now, costs, frame, path, greatest, around)
            aligning = self._align(pose, twist, around)
            if aligning is not None:
                return aligning
        if v > 0.0:
            self._came = pose.theta
        command = Twist(v, w)
        return PlannedCommand(command, self._preview(pose, twist, command), score == math.inf)

    def _align(self, pose: Pose2, twist: Twist, around: Surroundings) -> PlannedCommand | None:
        """Return the command that turns the robot to the stored heading that brings progress.

        If there is no such heading, if the robot has reached it, or if something blocks the turn, forget the heading
        and return None.
        """
        if self._heading is None:
            return None
        limits, difference = self.limits, wrap_angle(self._heading - pose.theta)
        speed = min(limits.max_vel_theta, max(limits.min_in_place_vel_theta, abs(difference)))
        command = STANDSTILL if abs(twist.linear) > 0.1 else Twist(0.0, math.copysign(speed, difference))
        # A single command at the minimum rate must not turn the robot past the heading. Otherwise it would have to turn
        # back.
        tolerance = max(ALIGNED, limits.min_in_place_vel_theta * self._body.period)
        if abs(difference) < tolerance or not self.safe(pose, twist, command, around):
            self._heading = None
            return None
        return PlannedCommand(command, self._preview(pose, twist, command), False)

    def _leading_heading(
        self,
        now: MotionState,
        costs: Costs,
        frame: CostFrame,
        path: FloatArray,
        greatest_v: float,
        around: Surroundings,
    ) -> float | None:
        """Return a heading that brings progress and to which the robot can turn in place; None if there is none.

        See `_search` for the arguments.
        """
        return None

    @abstractmethod
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
        """Return the best safe command (v, w) and its score. Lower is better. If there is no command, it is infinite.

        Args:
            now: pose and velocities of the robot.
            costs: see `follow`.
            frame: see `follow`.
            path: see `follow`.
            greatest_v: maximum velocity, m/s. The maximum in the parameters also applies.
            around: see `follow`.
            stalled: True if obstacles count only where the robot would touch them, and the robot must not stand still.
        """

    def _is_stalled(self, pose: Pose2) -> bool:
        """Return True if the robot has driven for a long time without progress.

        ROS's planners may prefer to turn back and forth forever, or to stand, if all commands with progress have a
        cost.
        """
        stalled = self._stalled_for > STALL_TIMEOUT
        if self._mark is None or self._mark.distance(pose) > (FREE_AGAIN_DISTANCE if stalled else STALL_DISTANCE):
            self._mark, self._stalled_for = pose, 0.0
        self._stalled_for += self._body.period
        return stalled

    def _preview(self, pose: Pose2, twist: Twist, command: Twist) -> FloatArray:
        time, granularity = self.limits.sim_time, self.limits.sim_granularity
        # The length of a turn is the length of the path of the body's farthest corner.
        arc = abs(command.linear) + abs(command.angular) * self._body.circumscribed
        return rollout(
            _motion(pose, twist),
            command.linear,
            command.angular,
            self._body,
            time,
            max(1, round(arc * time / granularity)),
        )


def _motion(pose: Pose2, twist: Twist) -> MotionState:
    return MotionState(pose.x, pose.y, pose.theta, twist.linear, twist.angular)
