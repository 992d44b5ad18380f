"""Following an itinerary: from the robot's position to the next command.

The local planner gets the path ahead, as far as the robot has the right of way and the laser sees no obstacle.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from sim.common.frozen import frozen
from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, TICKS_PER_SECOND, Neighbour, Twist
from sim.numerics import elementary, elementary_arrays
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.robot.costmap.costs import INSCRIBED, CostFrame, Costs
from sim.robot.global_planning.itinerary import (
    Itinerary,
    itineraries_of,
    reached_index,
    relevant_neighbours,
    right_of_way,
)
from sim.robot.global_planning.itinerary_planner import ItineraryPlanner
from sim.robot.global_planning.path import headings
from sim.robot.local_planning.braking import Surroundings
from sim.robot.local_planning.local_planner import PlannedCommand
from sim.robot.navigator.controller import Controller
from sim.robot.navigator.transitions import check_transition

HALT_DISTANCE = 0.12
"""Distance at which a robot waits before a point that it must not pass, meters."""
TURN_BACK_DISTANCE = 0.06
"""Minimum distance by which a path that turns back comes nearer to the robot again, meters."""
YIELD_TIME = 0.5
"""Minimum time in which a robot reaches a point that it must not pass, seconds. So it slows down before the point."""
STUCK_TIMEOUT = 2.0
"""A robot plans again after this number of seconds without progress, unless it waits for its right of way."""
QUEUE_TIMEOUT = 20.0
"""A robot that waits for its right of way plans again after this number of seconds without progress."""

NO_POSES: FloatArray = np.empty((0, 3))
NO_TIMES: FloatArray = np.empty(0)


@dataclass(frozen=True, slots=True)
class Following:
    """State in which the robot drives along the itinerary, or waits for its right of way."""


@dataclass(frozen=True, slots=True)
class AtEnd:
    """State in which the robot is at the last point. It stops, and turns to the heading there."""


@dataclass(frozen=True, slots=True)
class Escaping:
    """State in which the robot backs up, because no command makes progress.

    Attributes:
        begun: pose where the robot began to back up.
        then: state in which the robot continues.
    """

    begun: Pose2
    then: Following | AtEnd


FollowerState = Following | AtEnd | Escaping
FollowerEvent = Literal["end reached", "end left", "no command", "escaped"]

TRANSITIONS: set[tuple[type[FollowerState], FollowerEvent, type[FollowerState]]] = {
    (Following, "end reached", AtEnd),  # Stop, then turn to the heading there.
    (AtEnd, "end left", Following),  # Drive back, unless latch_xy_goal_tolerance is set.
    (Following, "no command", Escaping),  # Back up.
    (Escaping, "end reached", Escaping),  # Continue to back up, and then turn.
    (Escaping, "end left", Escaping),
    (Escaping, "escaped", Following),  # Turn to the path, and drive on.
    (Escaping, "escaped", AtEnd),
}
"""All changes of a follower's state. A new follower is in state Following."""


@frozen()
class FollowerOutput:
    """A command along an itinerary.

    Attributes:
        command: the velocity command.
        local_plan: (k, 3) map poses along its trajectory.
        arrived: True if the robot stands at the end of the itinerary.
        waiting: True while the robot waits for its right of way.
        waits_for: other robot for which this robot waits, because of that robot's itinerary or body.
        blocked_by_others: True while other robots keep this robot from driving farther.
        valid: True for a command with progress, or if there is a good reason to wait.
    """

    command: Twist
    local_plan: FloatArray
    arrived: bool = False
    waiting: bool = False
    waits_for: int | None = None
    blocked_by_others: bool = False
    valid: bool = False


STANDING = FollowerOutput(STANDSTILL, NO_POSES)


class Follower:
    """Follower of one itinerary.

    Args:
        controller: controller that chooses the commands.
        itinerary_planner: planner that made the itinerary.
        tick: the present tick.
        itinerary: itinerary that begins at the robot's position.
        heading: heading of the pose at the itinerary's last point.
        turns_at_end: True if the robot must turn to this heading.
        before: previous follower, if its itinerary is replaced while the robot drives on. Maneuvers of this follower
            and of the local planner then continue. Otherwise a robot with ten plans per second would start to back up
            ten times per second.

    Attributes:
        ahead: (m, 3) poses that the robot has not passed yet, their (m,) times, and the length of this path in meters.
    """

    def __init__(
        self,
        controller: Controller,
        itinerary_planner: ItineraryPlanner,
        tick: int,
        itinerary: Itinerary,
        heading: float,
        turns_at_end: bool,
        before: "Follower | None" = None,
    ) -> None:
        self._controller = controller
        self._itinerary_planner = itinerary_planner
        self._itinerary = itinerary
        self._poses = headings(itinerary.points, heading)
        steps = elementary_arrays.hypot(*np.diff(itinerary.points, axis=0).T)
        self._left = np.append(np.cumsum(steps[::-1])[::-1], 0.0)
        self._turns_at_end = turns_at_end
        self._state: FollowerState = Following()
        self._blocked_by_others = False
        self._pass(0)
        self._came_on(tick)
        if before is None:
            controller.planner.reset()
        elif isinstance(before._state, Escaping):
            self._state = replace(before._state, then=Following())

    def _pass(self, index: int) -> None:
        """Record that the robot has reached this point of the itinerary."""
        self._index = index
        self.ahead = (self._poses[index:], self._itinerary.times[index:], float(self._left[index]))

    def _came_on(self, tick: int) -> None:
        """Record that the robot is making progress."""
        self._held_up_since = tick
        # True if, since then, something other than the right of way has stopped the robot.
        self._stuck = False

    @property
    def time(self) -> float:
        """Time of the itinerary point that the robot has reached."""
        return float(self._itinerary.times[self._index])

    @property
    def hindered(self) -> bool:
        """True until the time after which the itinerary is the same as it would be without other robots."""
        return self.time < self._itinerary.unhindered_from

    @property
    def remaining(self) -> float:
        """Remaining length of the itinerary, meters."""
        return self.ahead[2]

    def held_up(self, tick: int) -> bool:
        """Return True if the robot has not advanced along the itinerary for too long."""
        timeout = STUCK_TIMEOUT if self._stuck else QUEUE_TIMEOUT
        return tick - self._held_up_since > timeout * TICKS_PER_SECOND

    def obstructed(self) -> bool:
        """Return True if an obstacle seen by the laser is on the itinerary ahead."""
        return self._itinerary_planner.obstructed(self.ahead[0][:, :2])

    def step(self, tick: int, pose: Pose2, twist: Twist, neighbours: Sequence[Neighbour]) -> FollowerOutput:
        """Return the next command along the itinerary.

        Args:
            tick: the present tick, in which a command is due.
            pose: pose estimate of the robot.
            twist: velocity of the robot.
            neighbours: last states of the other robots.
        """
        if self._controller.update_due(tick) or self._held_up_since == tick:
            self._controller.update_costmap(pose, neighbours)
        index = int(reached_index(self._itinerary.points, self._index, pose.x, pose.y))
        if index > self._index:
            self._pass(index)
            self._came_on(tick)
        around = self._controller.surroundings(pose, neighbours)
        self._look_for_end(pose)
        match self._state:
            case Following():
                return self._drive_on(tick, pose, twist, neighbours, around)
            case AtEnd():
                return self._finish(tick, pose, twist, around)
            case Escaping():
                return self._escape(self._state, pose, twist, around)

    def _enter(self, event: FollowerEvent, state: FollowerState) -> None:
        """Change the state."""
        check_transition(TRANSITIONS, self._state, event, state)
        self._state = state

    def _output(self, drive: PlannedCommand) -> FollowerOutput:
        blocked = self._blocked_by_others
        return FollowerOutput(drive.command, drive.local_plan, blocked_by_others=blocked, valid=not drive.stuck)

    def _look_for_end(self, pose: Pose2) -> None:
        """Record whether the robot is at the end of the itinerary."""
        limits, state = self._controller.planner.limits, self._state
        x, y, _ = self._poses[-1].tolist()
        # A path may pass near its end before it gets there, so the remaining length must also be short.
        off = elementary.hypot(x - pose.x, y - pose.y)
        at_end = bool(self._left[self._index] < 3 * limits.xy_goal_tolerance and off <= limits.xy_goal_tolerance)
        now: Following | AtEnd = AtEnd() if at_end else Following()
        # As in ROS, a robot with a latched tolerance does not drive back if it leaves the goal while it turns.
        if not at_end and limits.latch_xy_goal_tolerance:
            return
        event: FollowerEvent = "end reached" if at_end else "end left"
        if not isinstance(state, Escaping) and now != state:
            self._enter(event, now)
        elif isinstance(state, Escaping) and now != state.then:
            self._enter(event, replace(state, then=now))

    def _drive_on(
        self, tick: int, pose: Pose2, twist: Twist, neighbours: Sequence[Neighbour], around: Surroundings
    ) -> FollowerOutput:
        """Drive as far as the right of way and obstacles allow."""
        controller, itinerary = self._controller, self._itinerary
        separation = self._itinerary_planner.separation_driven
        last = _as_far_as(self._left, self._index, controller.reach)
        x, y, _ = self._poses[self._index].tolist()
        # Robots that stand farther away cannot block the part of the path that is examined.
        others = relevant_neighbours(neighbours, x, y, controller.reach + separation)
        allowed, barring, stands = right_of_way(
            itinerary.points, itinerary.times, self._index, last, pose.x, pose.y, itineraries_of(others), separation
        )
        self._blocked_by_others = blocked = allowed < last
        path, slow_down, obstructed = self._drivable_stretch(pose, int(allowed), blocked)
        if path is None:
            waiting = blocked and not stands
            waits_for = others[barring].robot if barring >= 0 and not obstructed else None
            self._stuck = self._stuck or not waiting
            return replace(STANDING, waiting=waiting, waits_for=waits_for, blocked_by_others=blocked, valid=waiting)
        costmap = controller.costmap
        drive = controller.planner.follow(pose, twist, costmap.costs, costmap.frame, path, slow_down, around)
        if drive.stuck:
            self._stuck = True
            self._enter("no command", escaping := Escaping(pose, Following()))
            return self._escape(escaping, pose, twist, around)
        if drive.command.linear == 0.0 and drive.command.angular != 0.0:
            # Turning toward the path is progress, although the robot reaches no further point.
            self._came_on(tick)
        return self._output(drive)

    def _escape(self, state: Escaping, pose: Pose2, twist: Twist, around: Surroundings) -> FollowerOutput:
        """Move away from the place where no command made progress, then turn toward the path."""
        planner, begun = self._controller.planner, state.begun
        drive = planner.escape(pose, twist, around)
        limits = planner.limits
        turned = abs(wrap_angle(pose.theta - begun.theta))
        if drive.stuck or begun.distance(pose) > limits.escape_reset_dist or turned > limits.escape_reset_theta:
            self._enter("escaped", state.then)
            planner.turn_first()
        return self._output(drive)

    def _finish(self, tick: int, pose: Pose2, twist: Twist, around: Surroundings) -> FollowerOutput:
        """Stop at the end of the itinerary, turn to its heading if necessary, and arrive."""
        planner = self._controller.planner
        limits = planner.limits
        heading = float(self._poses[-1, 2])
        standing = abs(twist.linear) < limits.trans_stopped_vel and abs(twist.angular) < limits.theta_stopped_vel
        if not self._turns_at_end or abs(wrap_angle(heading - pose.theta)) <= limits.yaw_goal_tolerance:
            return replace(STANDING, arrived=standing, blocked_by_others=self._blocked_by_others)
        self._came_on(tick)
        return self._output(planner.turn(pose, twist, heading, around))

    def _drivable_stretch(self, pose: Pose2, allowed: int, yields: bool) -> tuple[FloatArray | None, float, bool]:
        """Return the part of the path to drive along now, or None if the robot has to wait.

        Also return how many seconds before the end of this part the robot slows down, and True if an obstacle ends the
        part.
        """
        points, costmap = self._itinerary.points[self._index : allowed + 1], self._controller.costmap
        count, stopped, turns = _drivable(points, costmap.costs, costmap.frame, pose.x, pose.y)
        points = points[:count]
        yields = stopped or (yields and not turns)
        if len(points) == 0 or (
            yields and elementary.hypot(points[-1, 0] - pose.x, points[-1, 1] - pose.y) < HALT_DISTANCE
        ):
            return None, 0.0, stopped
        ends = not yields and self._index + len(points) == len(self._poses)
        slow_down = self._controller.planner.limits.sim_time if ends else YIELD_TIME if yields else 0.1
        return points, slow_down, stopped


@njit(cache=True)
def _as_far_as(left: FloatArray, index: int, reach: float) -> int:
    """Return the last point within `reach` meters of the path after point `index`. `left` has the remaining lengths."""
    last = index
    while last + 1 < left.shape[0] and left[index] - left[last + 1] <= reach:
        last += 1
    return last


@njit(cache=True)
def _drivable(points: FloatArray, costs: Costs, frame: CostFrame, x: float, y: float) -> tuple[int, bool, bool]:
    """Count the (m, 2) points that the local planner may get at once for a robot at (x, y).

    If the path turns back, for example at a waiting place, the points end at the turn, because the local planner drives
    toward the last point. They also end before the first point that is at least HALT_DISTANCE away, and is within an
    obstacle's inscribed radius or outside the costmap.

    Returns:
        Number of the points, True if an obstacle ends them, and True if a turn ends them.
    """
    farthest = 0.0
    end, turns = points.shape[0], False
    top = 0
    for i in range(points.shape[0]):
        away = elementary.hypot(points[i, 0] - x, points[i, 1] - y)
        if away > farthest or i == 0:
            farthest, top = away, i
        if away < farthest - TURN_BACK_DISTANCE:
            end, turns = top + 1, True
            break
    for i in range(end):
        row = math.floor((points[i, 1] - frame.y) / frame.resolution)
        col = math.floor((points[i, 0] - frame.x) / frame.resolution)
        inside = row >= 0 and col >= 0 and row < costs.shape[0] and col < costs.shape[1]
        if inside and costs[row, col] < INSCRIBED:
            continue
        if elementary.hypot(points[i, 0] - x, points[i, 1] - y) > HALT_DISTANCE:
            return i, True, turns
    return end, False, turns
