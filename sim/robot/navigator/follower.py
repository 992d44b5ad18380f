"""Following an itinerary: from where the robot is to the next command.

The path ahead goes to the local planner as far as the right of way and the obstacles seen allow.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import IDENTITY, FloatArray, Pose2, wrap_angle
from sim.common.grid import OccupancyGrid
from sim.common.kernels import njit
from sim.common.observations import STANDSTILL, TICK, TICKS_PER_SECOND, Neighbour, Scan, Twist
from sim.parameters import RobotParameters
from sim.robot.control.braking import LATENCY, Surroundings, beside_obstacles, surroundings
from sim.robot.control.local_planner import LocalPlanner, PlannedCommand
from sim.robot.control.planners import local_planner
from sim.robot.costmap.costmap_2d import Costmap2D, CostmapObservation
from sim.robot.costmap.costs import INSCRIBED, CostFrame, Costs
from sim.robot.navigator.scan_obstacles import may_turn, seen_around
from sim.robot.planning.itinerary import Itinerary, itineraries_of, reached_index, relevant_neighbours, right_of_way
from sim.robot.planning.itinerary_planner import ItineraryPlanner
from sim.robot.planning.path import headings

LOOK_AHEAD = 1.75
"""Metres of path given to the local planner at most."""
RIM_MARGIN = 0.25
"""Metres from it to the local costmap's rim, toward which the robot drives until the next update."""
HALT_DISTANCE = 0.12
"""Metres before a point that may not be passed at which a robot waits."""
TURN_BACK_DISTANCE = 0.06
"""Metres that a path comes nearer again before it counts as turning back."""
YIELD_TIME = 0.5
"""Seconds from such a point, at least, from which a robot slows down."""
STUCK_TIMEOUT = 2.0
"""Seconds that a robot may be held up, other than by right of way, before it plans anew."""
QUEUE_TIMEOUT = 20.0
"""Seconds that it may be held up by right of way before it plans anew."""

SEARCH_TURN = 0.5
"""Radians by which the heading that a lost robot turns to is ahead of its own: its rate of turn in rad/s."""
SEARCH_SPEED = 0.1
"""Metres a second at which it drives on where it cannot turn."""

NO_POSES: FloatArray = np.empty((0, 3))
NO_TIMES: FloatArray = np.empty(0)


class Follower:
    """Follows one itinerary after the other.

    Args:
        parameters: this robot's software's.
        static: the map.
        clearance: (rows, cols) metres from each of its cells to the nearest wall.
        costmap: the local one.
        seen: the global costmap, for the obstacles that the laser has seen; the navigator keeps it up to date.
        separation: metres between robots' centres by right of way.
        robot: its index in the team.

    Attributes:
        control_ticks: from one command to the next.
        last_valid: the last tick with a valid command, or with a good reason to wait.
        itinerary: the one that is followed; None without one.
        arrived: True when the robot stands at its end.
        waiting: True while it waits for its right of way.
        waits_for: the robot before whose itinerary or body it stands.
        blocked_by_others: True while others keep it from going farther.
        local_plan: (k, 3) map poses the last command would lead through.
        pending: the last scan, until the costmap has taken it in.
        ahead: (m, 3) poses still to be passed, their (m,) times, and their length in metres.
    """

    def __init__(
        self,
        parameters: RobotParameters,
        static: OccupancyGrid,
        clearance: NDArray[np.float32],
        costmap: Costmap2D,
        seen: Costmap2D,
        separation: float,
        robot: int,
    ) -> None:
        self._costmap = costmap
        self._clearance = clearance
        self._seen = seen
        self._frame = CostFrame(static.origin.x, static.origin.y, static.resolution)
        self._robot = robot
        self._use(parameters, separation)
        self._planner = self._chosen_planner(parameters)
        self.pending: CostmapObservation | None = None
        self.last_valid = 0
        self.drop()

    def _use(self, parameters: RobotParameters, separation: float) -> None:
        self._parameters, self._separation = parameters, separation
        costmap, local = self._costmap, parameters.local_costmap
        self._width = max(local.width, local.height)
        self._reach = min(LOOK_AHEAD, min(costmap.costs.shape) / 2 * costmap.frame.resolution - RIM_MARGIN)
        self.control_ticks = max(1, round(TICKS_PER_SECOND / parameters.move_base.controller_frequency))
        self._costmap_ticks = max(1, round(TICKS_PER_SECOND / local.update_frequency))
        self._hold = self.control_ticks * TICK + LATENCY

    def _chosen_planner(self, parameters: RobotParameters) -> LocalPlanner:
        costmap = self._costmap
        return local_planner(parameters, costmap.footprint, costmap.costs.shape, self.control_ticks * TICK)

    def configure(self, parameters: RobotParameters, separation: float) -> None:
        """Go on along the itinerary with these parameters; the costmap has been configured already.

        A planner that they change begins as with a new itinerary: it forgets, say, that it was turning.

        Args:
            parameters: this robot's software's.
            separation: metres between robots' centres by right of way.
        """
        before = self._parameters
        self._use(parameters, separation)
        if _made_from(parameters) != _made_from(before):
            self._planner = self._chosen_planner(parameters)

    def restart(self, tick: int) -> None:
        """Begin with another goal."""
        self.last_valid = tick

    def drop(self) -> None:
        """Stand, and follow nothing."""
        self.itinerary: Itinerary | None = None
        self.arrived = False
        self.waiting = False
        self.waits_for: int | None = None
        self.blocked_by_others = False
        self.local_plan = NO_POSES
        self.ahead = (NO_POSES, NO_TIMES, 0.0)
        self._poses = NO_POSES
        self._left = NO_TIMES
        self._index = 0
        self._turns_at_end = False
        self._at_end = False
        self._escaping_from: Pose2 | None = None

    def follow(self, tick: int, itinerary: Itinerary, heading: float, turns_at_end: bool) -> None:
        """Follow an itinerary from now on.

        Args:
            tick: the present one.
            itinerary: its first point is where the robot is.
            heading: that of the pose at its last point.
            turns_at_end: True when the robot has to turn to it there.
        """
        self.drop()
        self.itinerary = itinerary
        self._poses = headings(itinerary.points, heading)
        steps = np.hypot(*np.diff(itinerary.points, axis=0).T)
        self._left = np.append(np.cumsum(steps[::-1])[::-1], 0.0)
        self._turns_at_end = turns_at_end
        self._pass(itinerary, 0)
        self._progress, self._free = tick, tick - 1
        self._planner.reset()

    def _pass(self, itinerary: Itinerary, index: int) -> None:
        """Take note that this point of the itinerary is reached."""
        self._index = index
        self.ahead = (self._poses[index:], itinerary.times[index:], float(self._left[index]))

    @property
    def time(self) -> float:
        """Time of the point of the itinerary that has been reached; -inf without one."""
        return float(self.itinerary.times[self._index]) if self.itinerary is not None else -math.inf

    @property
    def remaining(self) -> float:
        """Metres of the itinerary that are left."""
        return self.ahead[2]

    def held_up(self, tick: int) -> bool:
        """Return True when the robot has not come on along the itinerary for too long."""
        timeout = STUCK_TIMEOUT if self._progress <= self._free else QUEUE_TIMEOUT
        return tick - self._progress > timeout * TICKS_PER_SECOND

    def obstructed(self, router: ItineraryPlanner) -> bool:
        """Return True when an obstacle that was seen lies on the itinerary ahead."""
        return router.obstructed(self.ahead[0][:, :2])

    def step(self, tick: int, pose: Pose2, twist: Twist, neighbours: Sequence[Neighbour]) -> Twist:
        """Return the command that leads on; `arrived`, `waiting` and the other attributes hold the state.

        Args:
            tick: the present one; a command is due.
            pose: believed pose of the robot.
            twist: its velocity.
            neighbours: the last states of the others.
        """
        self.local_plan, self.waiting, self.waits_for = NO_POSES, False, None
        itinerary = self.itinerary
        if itinerary is None:
            return STANDSTILL
        if (tick - self._robot) % self._costmap_ticks < self.control_ticks or self._progress == tick:
            self._update_costmap(pose, neighbours)
        index = int(reached_index(itinerary.points, self._index, pose.x, pose.y))
        if index > self._index:
            self._pass(itinerary, index)
            self._progress = tick
        drive = self._drive(tick, pose, twist, itinerary, neighbours)
        if drive is None:
            return STANDSTILL
        if not drive.stuck:
            self.last_valid = tick
        self.local_plan = drive.local_plan
        return drive.command

    def keep_scan(self, pose: Pose2, scan: Scan, discs: FloatArray) -> None:
        """Keep a scan for the costmap's next update; as in ROS, the last one before it counts.

        Args:
            pose: pose of the robot when it scanned.
            scan: the readings.
            discs: (n, 3) x, y and radius of the other robots, metres.
        """
        self.pending = CostmapObservation(pose, scan, discs)

    def rotate_recovery(self, pose: Pose2, twist: Twist, neighbours: Sequence[Neighbour]) -> PlannedCommand:
        """Turn in place (rotate_recovery)."""
        return self._planner.turn(pose, twist, pose.theta + 0.5 * math.pi, self._surroundings(pose, neighbours))

    def look_around(self, twist: Twist, scan: Scan) -> Twist:
        """Turn slowly to see more; without room for that drive on slowly; without room for that stand.

        A robot that does not know where it is may trust its laser, but no map.

        Args:
            twist: its velocity.
            scan: the latest.
        """
        around = seen_around(scan, len(self._costmap.footprint))
        if may_turn(scan, self._costmap.circumscribed_radius):
            drive = self._planner.turn(IDENTITY, twist, SEARCH_TURN, around)
            if not drive.stuck:
                return drive.command
        ahead = Twist(SEARCH_SPEED, 0.0)
        return ahead if self._planner.safe(IDENTITY, twist, ahead, around) else STANDSTILL

    def _update_costmap(self, pose: Pose2, neighbours: Sequence[Neighbour]) -> None:
        if self.pending is not None:
            self._costmap.observe(*self.pending)
            self.pending = None
        reach = self._width
        self._costmap.update_neighbours(
            [
                other
                for other in neighbours
                if abs(other.base_in_map.x - pose.x) < reach and abs(other.base_in_map.y - pose.y) < reach
            ]
        )
        self._costmap.update(pose.x, pose.y)

    def _surroundings(self, pose: Pose2, neighbours: Sequence[Neighbour]) -> Surroundings:
        clearance, frame = self._clearance, self._frame
        if self._seen.any_marks:
            clearance, frame = beside_obstacles(clearance, self._seen.marks, frame, pose.x, pose.y)
        return surroundings(
            clearance, frame, self._costmap.footprint, pose, neighbours, self._planner.limits.acc_lim_x, self._hold
        )

    def _drive(
        self, tick: int, pose: Pose2, twist: Twist, itinerary: Itinerary, neighbours: Sequence[Neighbour]
    ) -> PlannedCommand | None:
        limits = self._planner.limits
        around = self._surroundings(pose, neighbours)
        end_x, end_y, end_heading = self._poses[-1].tolist()
        off = math.hypot(end_x - pose.x, end_y - pose.y)
        if self._left[self._index] < 3 * limits.xy_goal_tolerance and off <= limits.xy_goal_tolerance:
            self._at_end = True
        elif not limits.latch_xy_goal_tolerance:
            self._at_end = False
        if self._escaping_from is not None:
            return self._escape(self._escaping_from, pose, twist, around)
        if self._at_end:
            return self._finish(tick, pose, twist, end_heading, around)
        last = _as_far_as(self._left, self._index, self._reach)
        x, y, _ = self._poses[self._index].tolist()
        others = relevant_neighbours(neighbours, x, y, self._reach + self._separation)
        allowed, barring, stands = right_of_way(
            itinerary.points,
            itinerary.times,
            self._index,
            last,
            pose.x,
            pose.y,
            itineraries_of(others),
            self._separation,
        )
        self.blocked_by_others = allowed < last
        path, slow_down, obstructed = self._drivable_stretch(pose, itinerary, int(allowed), allowed < last)
        if path is None:
            self.waiting = allowed < last and not stands
            if barring >= 0 and not obstructed:
                self.waits_for = others[barring].robot
            if self.waiting:
                self.last_valid = tick
            else:
                self._free = tick
            return None
        drive = self._planner.follow(pose, twist, self._costmap.costs, self._costmap.frame, path, slow_down, around)
        if drive.stuck:
            self._free = tick
            self._escaping_from = pose
            return self._escape(pose, pose, twist, around)
        if drive.command.linear == 0.0 and drive.command.angular != 0.0:
            # Turning toward the path is progress, although no further point is reached by it.
            self._progress = tick
        return drive

    def _escape(self, begun: Pose2, pose: Pose2, twist: Twist, around: Surroundings) -> PlannedCommand:
        """Get a little off the place where no command led on, then turn toward the path."""
        drive = self._planner.escape(pose, twist, around)
        limits = self._planner.limits
        turned = abs(wrap_angle(pose.theta - begun.theta))
        if drive.stuck or begun.distance(pose) > limits.escape_reset_dist or turned > limits.escape_reset_theta:
            self._escaping_from = None
            self._planner.turn_first()
        return drive

    def _finish(
        self, tick: int, pose: Pose2, twist: Twist, heading: float, around: Surroundings
    ) -> PlannedCommand | None:
        """Stop at the end of the itinerary, turn to its heading if need be, and arrive."""
        limits = self._planner.limits
        standing = abs(twist.linear) < limits.trans_stopped_vel and abs(twist.angular) < limits.theta_stopped_vel
        off = abs(wrap_angle(heading - pose.theta))
        if not self._turns_at_end or off <= limits.yaw_goal_tolerance:
            self.arrived = standing
            return None
        self._progress = tick
        return self._planner.turn(pose, twist, heading, around)

    def _drivable_stretch(
        self, pose: Pose2, itinerary: Itinerary, allowed: int, yields: bool
    ) -> tuple[FloatArray | None, float, bool]:
        """Return the part of the path to drive along now, None where the robot has to wait.

        Also return how early to slow down, in seconds, and whether an obstacle ends that part.
        """
        points = itinerary.points[self._index : allowed + 1]
        count, stopped, turns = _drivable(points, self._costmap.costs, self._costmap.frame, pose.x, pose.y)
        points = points[:count]
        yields = stopped or (yields and not turns)
        if len(points) == 0 or (yields and math.hypot(points[-1, 0] - pose.x, points[-1, 1] - pose.y) < HALT_DISTANCE):
            return None, 0.0, stopped
        ends = not yields and self._index + len(points) == len(itinerary.points)
        slow_down = self._planner.limits.sim_time if ends else YIELD_TIME if yields else 0.1
        return points, slow_down, stopped


def _made_from(parameters: RobotParameters) -> tuple[object, ...]:
    """All parameters that a local planner depends on."""
    return (
        parameters.move_base.base_local_planner,
        parameters.move_base.controller_frequency,
        parameters.TrajectoryPlannerROS,
        parameters.DWAPlannerROS,
        replace(parameters.local_costmap, publish_frequency=0.0),
    )


@njit(cache=True)
def _as_far_as(left: FloatArray, index: int, reach: float) -> int:
    """Last point of a path within `reach` metres along it from point `index`; (m,) metres are left at each."""
    last = index
    while last + 1 < left.shape[0] and left[index] - left[last + 1] <= reach:
        last += 1
    return last


@njit(cache=True)
def _drivable(points: FloatArray, costs: Costs, frame: CostFrame, x: float, y: float) -> tuple[int, bool, bool]:
    """Count those of (m, 2) points that the local planner may be given at once for a robot at (x, y).

    Where the path turns back, to a place to wait and on again, they end at the turning point, since the local planner
    makes for the last point. They also end before the first point, HALT_DISTANCE away or more, that lies within an
    obstacle's inscribed radius or off the costmap.

    Returns:
        Their number; whether an obstacle ends them; whether a turning point does.
    """
    farthest = 0.0
    end, turns = points.shape[0], False
    top = 0
    for i in range(points.shape[0]):
        away = math.hypot(points[i, 0] - x, points[i, 1] - y)
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
        if math.hypot(points[i, 0] - x, points[i, 1] - y) > HALT_DISTANCE:
            return i, True, turns
    return end, False, turns
