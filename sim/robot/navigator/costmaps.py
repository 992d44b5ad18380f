"""The two costmaps of one robot, and their publication."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND, Neighbour, next_turn
from sim.numerics.float_array import FloatArray
from sim.parameters import RobotParameters
from sim.robot.costmap.costmap_2d import Costmap2D
from sim.robot.costmap.obstacle import CostmapObservation
from sim.robot.costmap.robot_costmap import RobotCostmap
from sim.robot.costmap.view import CostmapName, CostmapView, ShownCostmap
from sim.robot.navigator.rotated_map import RotatedMap
from sim.robot.navigator.stale_neighbours import StaleNeighbours


class CostmapPublisher:
    """Publisher of a costmap of a robot. It does not change the costmap.

    Args:
        costmap: the costmap.
        publish_frequency: frequency, Hz. If 0, the costmap is never published.
        turned: map of the robot, in the grid's frame.
        robot: index of the robot in the team. Robots take turns in publishing.
        at_once: True to publish the costmap also at the first opportunity, even with a low frequency.
    """

    def __init__(
        self, costmap: Costmap2D, publish_frequency: float, turned: RotatedMap, robot: int, at_once: bool = False
    ) -> None:
        self._costmap = costmap
        self._turned = turned
        self._robot = robot
        self._first = at_once
        self._last: ShownCostmap | None = None
        self.configure(publish_frequency)

    def configure(self, publish_frequency: float) -> None:
        """Publish the costmap at this frequency from now on, Hz."""
        self._period = max(1, round(TICKS_PER_SECOND / publish_frequency)) if publish_frequency > 0.0 else 0

    def due(self, tick: int) -> bool:
        """Return True if the costmap is to be published in this tick."""
        return self._period > 0 and (self._first or (tick - self._robot) % self._period == 0)

    def next_due(self, tick: int) -> int | None:
        """Return the next tick in which the costmap is to be published. If None, it is never published."""
        return next_turn(tick, self._robot, self._period) if self._period > 0 else None

    def show(
        self, tick: int, pose: Pose2, neighbours: Sequence[Neighbour], pending: CostmapObservation | None
    ) -> ShownCostmap:
        """Return the costmap as it would be after an update in this tick. It can be read until the next step.

        Args:
            tick: the present tick.
            pose: pose estimate of the robot.
            neighbours: the other robots.
            pending: a scan that the costmap has not processed yet.
        """
        self._first = False
        self._last = ShownCostmap(partial(self._view, tick, pose, neighbours, pending))
        return self._last

    def _view(
        self, tick: int, pose: Pose2, neighbours: Sequence[Neighbour], pending: CostmapObservation | None
    ) -> CostmapView:
        now = self.at(tick, pose, neighbours, pending)
        now.costs.setflags(write=False)
        return CostmapView(tick, now.origin, now.resolution, now.costs)

    def expire(self) -> None:
        """Record that the costmap changes now; see `ShownCostmap`."""
        if self._last is not None:
            self._last.expire()
            self._last = None

    def at(
        self, tick: int, pose: Pose2, neighbours: Sequence[Neighbour], pending: CostmapObservation | None
    ) -> RobotCostmap:
        """Return the costmap as it would be after an update in this tick, with the footprint; see `show`."""
        costmap = self._costmap
        costs, frame = costmap.as_updated(pose.x, pose.y, neighbours, pending)
        poses = np.array([[pose.x, pose.y, pose.theta], [frame.x, frame.y, 0.0]])
        base, corner = (Pose2(*each) for each in self._turned.poses_in_map(poses).tolist())
        return RobotCostmap(tick, base, corner, frame.resolution, costs, costmap.footprint, costmap.circular)


class Costmaps:
    """The two costmaps of one robot, with the operations that concern both.

    Args:
        parameters: parameters of this robot's software.
        footprint: (n, 2) corners of the robot's body, base frame, meters.
        turned: the map, with the conversion to the grid's frame.
        robot: index of the robot in the team.

    Attributes:
        global_costmap: costmap of the whole map, for plans.
        local_costmap: costmap around the robot, for commands.
    """

    def __init__(self, parameters: RobotParameters, footprint: FloatArray, turned: RotatedMap, robot: int) -> None:
        whole, around = parameters.global_costmap, parameters.local_costmap
        self.global_costmap = Costmap2D(whole, footprint, turned.grid)
        self.local_costmap = Costmap2D(around, footprint, turned.grid)
        # The global costmap is published seldom. So it is also published at the beginning, for viewers.
        self._whole_display = CostmapPublisher(
            self.global_costmap, whole.publish_frequency, turned, robot, at_once=True
        )
        self._around_display = CostmapPublisher(self.local_costmap, around.publish_frequency, turned, robot)

    def expire(self) -> None:
        """Record that the costmaps change now; see `ShownCostmap`."""
        self._whole_display.expire()
        self._around_display.expire()

    def configure(self, parameters: RobotParameters) -> None:
        """Continue with these parameters and the present marks."""
        self.expire()
        self.global_costmap.configure(parameters.global_costmap)
        self.local_costmap.configure(parameters.local_costmap)
        self._whole_display.configure(parameters.global_costmap.publish_frequency)
        self._around_display.configure(parameters.local_costmap.publish_frequency)

    @property
    def explained_range(self) -> float:
        """Robots farther from the laser than this are not needed to explain readings, meters."""
        return max(self.global_costmap.obstacles.explained_range, self.local_costmap.obstacles.explained_range)

    def clear(self) -> None:
        """Forget what the laser has seen."""
        self.expire()
        self.global_costmap.obstacles.clear()
        self.local_costmap.obstacles.clear()

    def clear_region(self, name: CostmapName, x: float, y: float, side: float | None, *, outside: bool = False) -> None:
        """Let one costmap forget what the laser has seen in a region.

        Args:
            name: name of the costmap.
            x: middle of a square in the grid's frame, with `y`.
            side: side of the square, meters. If None, the region is the whole costmap.
            outside: True if the region is outside the square.
        """
        self.expire()
        obstacles = (self.global_costmap if name == "global_costmap" else self.local_costmap).obstacles
        if side is None:
            obstacles.clear()
        elif outside:
            obstacles.clear_outside(x, y, side)
        else:
            obstacles.clear_inside(x, y, side)

    def clear_outside(self, x: float, y: float, side: float) -> None:
        """Forget what the laser has seen outside a square of this side around a map point."""
        self.expire()
        self.global_costmap.obstacles.clear_outside(x, y, side)
        self.local_costmap.obstacles.clear_outside(x, y, side)

    def next_due(self, tick: int) -> int | None:
        """Return the next tick in which one of the costmaps is to be published. If None, they are never published."""
        dues = (self._whole_display.next_due(tick), self._around_display.next_due(tick))
        return min((due for due in dues if due is not None), default=None)

    def shown(
        self, tick: int, pose: Pose2, stale: StaleNeighbours, pending: CostmapObservation | None
    ) -> tuple[ShownCostmap | None, ShownCostmap | None]:
        """Return the global and the local costmap, with None for a costmap that is not due.

        Args:
            tick: the present tick.
            pose: pose estimate of the robot.
            stale: the other robots: those that broadcast, and those that are remembered.
            pending: a scan that the local costmap has not processed yet.
        """
        whole, around = self._whole_display, self._around_display
        return (
            whole.show(tick, pose, stale.known(tick), None) if whole.due(tick) else None,
            around.show(tick, pose, stale.known(tick), pending) if around.due(tick) else None,
        )

    def at(
        self, name: CostmapName, tick: int, pose: Pose2, stale: StaleNeighbours, pending: CostmapObservation | None
    ) -> RobotCostmap:
        """Return one of the costmaps as it would be after an update in this tick; see `shown`."""
        if name == "global_costmap":
            return self._whole_display.at(tick, pose, stale.known(tick), None)
        return self._around_display.at(tick, pose, stale.known(tick), pending)
