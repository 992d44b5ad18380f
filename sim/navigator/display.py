"""Showing a costmap to people, as often as its `publish_frequency` asks for."""

from collections.abc import Sequence

import numpy as np

from sim.costmap.costmap_2d import Costmap2D, Look
from sim.costmap.view import CostmapView
from sim.geometry import Pose2
from sim.navigator.turned import Turned
from sim.observations import TICKS_PER_SECOND, Neighbour


class Display:
    """Shows one costmap of one robot; that it is looked at changes nothing of it.

    Args:
        costmap: which.
        publish_frequency: Hz; 0: never.
        turned: of its map.
        robot: its index in the team: robots take turns.
        at_once: whether it is also shown when first asked, however seldom it is due.
    """

    def __init__(
        self, costmap: Costmap2D, publish_frequency: float, turned: Turned, robot: int, at_once: bool = False
    ) -> None:
        self._costmap = costmap
        self._turned = turned
        self._robot = robot
        self._first = at_once
        self.configure(publish_frequency)

    def configure(self, publish_frequency: float) -> None:
        """Show it as often as this from now on, Hz."""
        self._period = max(1, round(TICKS_PER_SECOND / publish_frequency)) if publish_frequency > 0.0 else 0

    def due(self, tick: int) -> bool:
        """Whether the costmap is to be shown in this tick."""
        return self._period > 0 and (self._first or (tick - self._robot) % self._period == 0)

    def show(self, tick: int, pose: Pose2, neighbours: Sequence[Neighbour], unseen: Look | None) -> CostmapView:
        """The costmap as an update in this tick would leave it.

        Args:
            tick: which one.
            pose: where the robot believes it is.
            neighbours: the others.
            unseen: a scan that the costmap has yet to take in.
        """
        self._first = False
        costs, frame = self._costmap.as_updated(pose.x, pose.y, neighbours, unseen)
        costs.setflags(write=False)
        corner = self._turned.poses(np.array([[frame.x, frame.y, 0.0]]))[0].tolist()
        return CostmapView(tick, Pose2(*corner), frame.resolution, costs)
