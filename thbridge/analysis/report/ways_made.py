"""Times in which robots made way for robots with right of way, gathered from diagnostics."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from thbridge.analysis.report.report import WayMade
from thbridge.ros.messages.pack import DiagnosticStatus
from thbridge.ros.names import MAKES_WAY_FOR, NAVIGATION


class WaysMade:
    """Times in which robots made way, as far as diagnostics report them.

    Attributes:
        robots: times of each robot that made way, in order, by the robot's name for programs; the last time may not
            have ended.
        changes: number of their beginnings and ends.
    """

    def __init__(self) -> None:
        self.changes = 0
        self.robots: defaultdict[str, list[WayMade]] = defaultdict(list)

    def take(self, time: float, statuses: Sequence[DiagnosticStatus]) -> None:
        """Add the diagnostics of a time; the diagnostics of several robots may arrive separately."""
        # A robot whose software has stopped reports no state of its navigation.
        makes_way_for: dict[str, str | None] = dict.fromkeys(each.hardware_id for each in statuses)
        for each in statuses:
            if each.name == f"{each.hardware_id}: {NAVIGATION}":
                makes_way_for[each.hardware_id] = each.values.get(MAKES_WAY_FOR)
        for robot, other in makes_way_for.items():
            self._note(robot, time, other)

    def _note(self, robot: str, time: float, other: str | None) -> None:
        made = self.robots.get(robot, [])
        if made and made[-1].end == np.inf:
            if made[-1].robot == other:
                return
            made[-1] = replace(made[-1], end=time)
            self.changes += 1
        if other is not None:
            self.changes += 1
            self.robots[robot].append(WayMade(time, np.inf, other))

    def of(self, robot: str, end: float) -> tuple[WayMade, ...]:
        """Return the periods of a robot, in order; a period that has not ended lasts until `end`."""
        return tuple(replace(made, end=min(made.end, end)) for made in self.robots.get(robot, ()))
