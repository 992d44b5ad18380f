"""The controller of move_base: the local planner with its costmap.

It also makes the turns that follow no path: the recovery rotation, and the search of a robot that is lost.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

from sim.common.distance_fields import clearance_field
from sim.common.geometry import IDENTITY, Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import STANDSTILL, TICK, TICKS_PER_SECOND, Neighbour, Scan, Twist, next_turn
from sim.parameters import RobotParameters
from sim.robot.costmap.costs import CostFrame
from sim.robot.costmap.obstacle import CostmapObservation
from sim.robot.local_planning.braking import LATENCY, WALL_MARGIN, Surroundings, beside_obstacles, surroundings
from sim.robot.local_planning.local_planner import LocalPlanner, PlannedCommand
from sim.robot.local_planning.planners import local_planner
from sim.robot.navigator.costmaps import Costmaps
from sim.robot.navigator.scan_obstacles import may_turn, room_ahead, seen_around

LOOK_AHEAD = 1.75
"""Meters of path given to the local planner at most."""
RIM_MARGIN = 0.25
"""Meters from it to the local costmap's rim, toward which the robot drives until the next update."""

SEARCH_TURN = 0.5
"""Radians by which the heading that a lost robot turns to is ahead of its own: its rate of turn in rad/s."""
SEARCH_SPEED = 0.1
"""Meters a second at which it drives on where it cannot turn."""


class Controller:
    """The local planner of one robot, with its costmap.

    Args:
        parameters: this robot's software's.
        static: the map.
        costmaps: the robot's; the navigator keeps the global one, for the obstacles seen, up to date.
        robot: its index in the team.

    Attributes:
        costmap: the local one.
        planner: the local planner.
        reach: meters of path that it may be given.
        control_ticks: from one command to the next.
        pending: the last scan, until the costmap has taken it in.
    """

    def __init__(self, parameters: RobotParameters, static: OccupancyGrid, costmaps: Costmaps, robot: int) -> None:
        self.costmap = costmaps.local_costmap
        self._whole = costmaps.global_costmap
        self._clearance = clearance_field(static)
        self._frame = CostFrame(static.origin.x, static.origin.y, static.resolution)
        self._robot = robot
        self._use(parameters)
        self.planner = self._chosen_planner()
        self.pending: CostmapObservation | None = None

    def _use(self, parameters: RobotParameters) -> None:
        costmap = self.costmap
        self._parameters = parameters
        self.reach = min(LOOK_AHEAD, min(costmap.costs.shape) / 2 * costmap.frame.resolution - RIM_MARGIN)
        self.control_ticks = _ticks(parameters.move_base.controller_frequency)

    def _chosen_planner(self) -> LocalPlanner:
        costmap = self.costmap
        return local_planner(self._parameters, costmap.footprint, costmap.costs.shape, self.control_ticks * TICK)

    def configure(self, parameters: RobotParameters) -> None:
        """Go on with these parameters; the costmaps have been configured already.

        A planner that they change begins as with a new itinerary: it forgets, say, that it was turning.
        """
        before = self._parameters
        self._use(parameters)
        if _made_from(parameters) != _made_from(before):
            self.planner = self._chosen_planner()

    def command_due(self, tick: int) -> bool:
        """Return True if a command is due in this tick."""
        return (tick - self._robot) % self.control_ticks == 0

    def next_command(self, tick: int) -> int:
        """Return the first tick after this one in which a command is due."""
        return next_turn(tick, self._robot, self.control_ticks)

    def update_due(self, tick: int) -> bool:
        """Return True if the costmap is to be updated before the command of this tick."""
        return (tick - self._robot) % _ticks(self._parameters.local_costmap.update_frequency) < self.control_ticks

    def keep_scan(self, seen: CostmapObservation) -> None:
        """Keep a scan for the costmap's next update; as in ROS, the last one before it counts."""
        self.pending = seen

    def update_costmap(self, pose: Pose2, neighbours: Sequence[Neighbour]) -> None:
        """Bring the costmap up to date with the last scan and the other robots."""
        if self.pending is not None:
            self.costmap.observe(self.pending)
            self.pending = None
        reach = max(self._parameters.local_costmap.width, self._parameters.local_costmap.height)
        self.costmap.update_neighbours(
            [
                other
                for other in neighbours
                if abs(other.base_in_map.x - pose.x) < reach and abs(other.base_in_map.y - pose.y) < reach
            ]
        )
        self.costmap.update(pose.x, pose.y)

    def surroundings(self, pose: Pose2, neighbours: Sequence[Neighbour]) -> Surroundings:
        """Return the walls, obstacles seen and neighbors that the robot may hit."""
        clearance, frame = self._clearance, self._frame
        seen = self._whole.obstacles
        if seen.any_marks:
            clearance, frame = beside_obstacles(clearance, seen.marks, frame, pose.x, pose.y)
        hold = self.control_ticks * TICK + LATENCY
        return surroundings(
            clearance, frame, self.costmap.footprint, pose, neighbours, self.planner.limits.acc_lim_x, hold
        )

    def rotate_recovery(self, pose: Pose2, twist: Twist, neighbours: Sequence[Neighbour]) -> PlannedCommand:
        """Turn in place (rotate_recovery)."""
        return self.planner.turn(pose, twist, pose.theta + 0.5 * math.pi, self.surroundings(pose, neighbours))

    def look_around(self, twist: Twist, scan: Scan) -> Twist:
        """Turn slowly to see more; without room for that drive on slowly; without room for that stand.

        A robot that does not know where it is may trust its laser, but no map.

        Args:
            twist: its velocity.
            scan: the latest.
        """
        around = seen_around(scan, len(self.costmap.footprint))
        if may_turn(scan, self.costmap.circumscribed_radius):
            drive = self.planner.turn(IDENTITY, twist, SEARCH_TURN, around)
            if not drive.stuck:
                return drive.command
        # All scans are taken from the same place as far as the planner knows: what barred a turn in this one must not
        # bar it for good.
        self.planner.reset()
        ahead = Twist(SEARCH_SPEED, 0.0)
        # What `safe` grants a robot that is near a wall adds up to a collision, as noise lets the wall seem farther off
        # in some of the scans. So here the whole margin is to be free ahead.
        free = room_ahead(scan, self.costmap.footprint) > WALL_MARGIN
        return ahead if free and self.planner.safe(IDENTITY, twist, ahead, around) else STANDSTILL


def _ticks(frequency: float) -> int:
    """Return the ticks from one time to the next of what is done so often, Hz."""
    return max(1, round(TICKS_PER_SECOND / frequency))


def _made_from(parameters: RobotParameters) -> tuple[object, ...]:
    """Return all parameters that a local planner depends on."""
    return (
        parameters.move_base.base_local_planner,
        parameters.move_base.controller_frequency,
        parameters.TrajectoryPlannerROS,
        parameters.DWAPlannerROS,
        replace(parameters.local_costmap, publish_frequency=0.0),
    )
