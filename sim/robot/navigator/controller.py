"""The controller of move_base: the local planner with its costmap.

It also makes turns without a path: the recovery rotation, and the turns of a lost robot.
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
"""Maximum length of the path that the local planner receives, meters."""
RIM_MARGIN = 0.25
"""Minimum distance between the end of this path and the local costmap's border, meters. Until the next update, the
robot drives toward this end."""

SEARCH_TURN = 0.5
"""Angle between a lost robot's heading and the heading to which it turns, radians.

The same value is the angular velocity, rad/s.
"""
SEARCH_SPEED = 0.1
"""Velocity at which a lost robot drives on if it cannot turn, m/s."""


class Controller:
    """The local planner of one robot, with its costmap.

    Args:
        parameters: parameters of this robot's software.
        static: the map.
        costmaps: costmaps of the robot. The navigator itself marks obstacles seen by the laser in the global costmap.
        robot: index of the robot in the team.

    Attributes:
        costmap: the local costmap.
        planner: the local planner.
        reach: maximum length of path for the planner, meters.
        control_ticks: ticks between two commands.
        pending: the last scan, until the costmap has processed it.
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
        """Continue with these parameters. The costmaps are already configured.

        If the parameters change the planner, the planner starts as with a new itinerary. For example, it forgets that
        the robot was turning.
        """
        before = self._parameters
        self._use(parameters)
        if _made_from(parameters) != _made_from(before):
            self.planner = self._chosen_planner()

    def command_due(self, tick: int) -> bool:
        """Return True if a command is due in this tick."""
        return (tick - self._robot) % self.control_ticks == 0

    def next_command(self, tick: int) -> int:
        """Return the first tick after this tick in which a command is due."""
        return next_turn(tick, self._robot, self.control_ticks)

    def update_due(self, tick: int) -> bool:
        """Return True if the costmap must be updated before the command of this tick."""
        return (tick - self._robot) % _ticks(self._parameters.local_costmap.update_frequency) < self.control_ticks

    def keep_scan(self, seen: CostmapObservation) -> None:
        """Keep a scan for the costmap's next update. As in ROS, only the last scan before the update is used."""
        self.pending = seen

    def update_costmap(self, pose: Pose2, neighbours: Sequence[Neighbour]) -> None:
        """Update the costmap with the last scan and the other robots."""
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
        """Return the walls, obstacles seen by the laser, and neighbors that the robot may hit."""
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
        """Turn slowly to see more. If there is no room to turn, drive on slowly. If there is no room ahead, stand.

        A lost robot can rely on its laser, but not on maps.

        Args:
            twist: velocity of the robot.
            scan: the latest scan.
        """
        around = seen_around(scan, len(self.costmap.footprint))
        if may_turn(scan, self.costmap.circumscribed_radius):
            drive = self.planner.turn(IDENTITY, twist, SEARCH_TURN, around)
            if not drive.stuck:
                return drive.command
        # For the planner, all scans come from the same place. An obstacle that blocks a turn in this scan must not
        # block turns forever.
        self.planner.reset()
        ahead = Twist(SEARCH_SPEED, 0.0)
        # Near a wall, `safe` tolerates small approaches. Here they could add up to a collision, because noise makes the
        # wall seem farther away in some scans. So the whole margin must be free ahead.
        free = room_ahead(scan, self.costmap.footprint) > WALL_MARGIN
        return ahead if free and self.planner.safe(IDENTITY, twist, ahead, around) else STANDSTILL


def _ticks(frequency: float) -> int:
    """Return the number of ticks between events of this frequency, Hz."""
    return max(1, round(TICKS_PER_SECOND / frequency))


def _made_from(parameters: RobotParameters) -> tuple[object, ...]:
    """Return all parameters on which a local planner depends."""
    return (
        parameters.move_base.base_local_planner,
        parameters.move_base.controller_frequency,
        parameters.TrajectoryPlannerROS,
        parameters.DWAPlannerROS,
        replace(parameters.local_costmap, publish_frequency=0.0),
    )
