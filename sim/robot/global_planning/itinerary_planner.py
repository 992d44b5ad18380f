"""Planning of itineraries for one robot: over the map, and in time among the other robots.

The first attempt is the global planner's path, driven without a stop. If it meets other robots' itineraries, a search
in space and time follows (`safe_interval`). If that fails, the result is the path that ignores the other robots. They
are asked to clear it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sim.common.distance_fields import clearance_field
from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import Neighbour
from sim.numerics import elementary, elementary_arrays
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.parameters import InflationParameters
from sim.robot.costmap.costmap_2d import Costmap2D
from sim.robot.costmap.costs import LETHAL, CostFrame, Costs
from sim.robot.costmap.inflation import cost_at
from sim.robot.global_planning.itinerary import (
    NEAR_START,
    POINT_SPACING,
    Itinerary,
    OtherItineraries,
    densified,
    executable,
    first_met,
    itineraries_of,
    keeps_separation,
    timed_itinerary,
)
from sim.robot.global_planning.path import Path, PathPlanner, PathSearch, PlanRefusal, with_edge
from sim.robot.global_planning.safe_interval import BoolArray, Roadmap, make_roadmap, refuge, route
from sim.robot.part_failure import PartFailed

PLANNED_GAP = 0.16
"""Minimum distance between two robots' circumscribed circles in a plan, meters."""
DRIVEN_GAP = 0.1
"""Minimum distance between these circles while robots follow the right of way, meters."""
ROOM_TO_TURN = 0.08
"""Minimum distance between walls and the circumscribed circle of a robot that waits or makes a detour, meters."""


@dataclass(frozen=True, slots=True)
class BlockedByRobots:
    """Result if a path exists, but other robots block it.

    Attributes:
        wanted_path: (m, 2) map points of the blocked path.
    """

    wanted_path: FloatArray


_PathCosts = Literal["present", "without robots", "without observations"]


@dataclass(slots=True)
class _Attempt:
    """State of a planning attempt. On large maps, an attempt takes several ticks.

    Attributes:
        start: pose of the robot when the attempt began.
        goal: the goal.
        found: results of finished searches, by the costs that they used.
        search: the present search, and the costs that it uses.
    """

    start: Pose2
    goal: Pose2
    found: dict[_PathCosts, Path | PlanRefusal] = field(default_factory=dict)
    search: tuple[_PathCosts, PathSearch] | None = None


class ItineraryPlanner:
    """Planner of one robot's itineraries through a map.

    Args:
        static: the map.
        costmap: the robot's global costmap.
        inflation: parameters of its inflation layer.
        planner: planner of paths without regard to other robots.

    Attributes:
        fault: failure of an installed planner, until it is read. Empty if nothing failed.
    """

    def __init__(
        self,
        static: OccupancyGrid,
        costmap: Costmap2D,
        inflation: InflationParameters,
        planner: PathPlanner,
    ) -> None:
        self.fault = ""
        self._static = static
        self._frame = CostFrame(static.origin.x, static.origin.y, static.resolution)
        self.costmap = costmap
        self.configure(inflation, planner)

    def configure(self, inflation: InflationParameters, planner: PathPlanner) -> None:
        """Continue with this planner and with the changed parameters of the costmap.

        Args:
            inflation: parameters of the costmap's inflation layer.
            planner: planner of paths without regard to other robots.
        """
        costmap = self.costmap
        self._planner = planner
        self._attempt: _Attempt | None = None
        self._alone_query: tuple[Pose2, Pose2] | None = None
        self._alone_answer: BlockedByRobots | PlanRefusal | None = None
        self._walls = costmap.without_observations()
        circumscribed = costmap.circumscribed_radius
        self.separation = 2 * circumscribed + PLANNED_GAP
        self.separation_driven = 2 * circumscribed + DRIVEN_GAP
        self._roadmap, self._cells = _coarse(self._static, circumscribed + ROOM_TO_TURN)
        self._too_near = cost_at(circumscribed, costmap.inscribed_radius, inflation.cost_scaling_factor)

    def update_neighbours(self, neighbours: Sequence[Neighbour]) -> None:
        """Update the costmap with the last broadcasts of the other robots."""
        self.costmap.update_neighbours(neighbours)
        self.costmap.update(0.0, 0.0)

    @property
    def searching(self) -> bool:
        """True from the first call of `plan` without a result until a call with a result."""
        return self._attempt is not None

    def search_on(self) -> None:
        """Continue the present search with one portion in this tick."""
        attempt = self._attempt
        if attempt is None or attempt.search is None:
            return
        over, search = attempt.search
        try:
            next(search)
        except StopIteration as done:
            attempt.found[over], attempt.search = done.value, None
        except PartFailed as failed:
            self.fault = str(failed)
            attempt.found[over], attempt.search = PlanRefusal("no_way", self.fault), None

    def give_up(self) -> None:
        """Stop the present search."""
        attempt, self._attempt = self._attempt, None
        if attempt is not None and attempt.search is not None:
            attempt.search[1].close()

    def plan(
        self, start: Pose2, goal: Pose2, time: float, others: OtherItineraries
    ) -> Itinerary | BlockedByRobots | PlanRefusal | None:
        """Plan an itinerary that keeps clear of all others: the planner's path, or else the quickest itinerary.

        Args:
            start: pose of the base.
            goal: pose at the end.
            time: start time of the itinerary.
            others: itineraries of the other robots.

        Returns:
            The itinerary, or the reason why there is none. None while the search continues: call `search_on` once per
            tick, and then `plan` again. Partial results are kept while the goal does not change and the robot does not
            drive far.
        """
        attempt = self._attempt
        if attempt is None or attempt.goal != goal or attempt.start.distance(start) > NEAR_START:
            self.give_up()
            attempt = self._attempt = _Attempt(start, goal)
        planned = self._planned(attempt, start, time, others)
        if planned is not None:
            self.give_up()
        return planned

    def _path(self, attempt: _Attempt, over: _PathCosts, costs: Costs) -> Path | PlanRefusal | None:
        """Return the path over these costs, or None while the search continues."""
        if over not in attempt.found and attempt.search is None:
            attempt.search = over, self._planner.search(costs, self._frame, attempt.start, attempt.goal)
            self.search_on()
        return attempt.found.get(over)

    def _planned(
        self, attempt: _Attempt, start: Pose2, time: float, others: OtherItineraries
    ) -> Itinerary | BlockedByRobots | PlanRefusal | None:
        path = self._path(attempt, "present", self.costmap.costs)
        if path is None:
            return None
        if not isinstance(path, PlanRefusal):
            # Distances are not enough: robots that already stand too close could block each other's next points.
            direct = timed_itinerary(thinned(path.poses[:, :2], POINT_SPACING), time)
            if keeps_separation(direct.points, direct.times, others, self.separation) and self._executable(
                direct, others
            ):
                return direct
        free, walls = self._free_space()
        goal = attempt.goal
        start_point, goal_point = np.array([start.x, start.y]), np.array([goal.x, goal.y])
        among = route(self._roadmap, free, start_point, goal_point, time, others, self.separation)
        if among is not None:
            among = densified(among)
            if self._executable(among, others):
                return among
        alone = self._alone(attempt, walls)
        return self._refusal(attempt, alone) if isinstance(alone, PlanRefusal) else alone

    def _alone(self, attempt: _Attempt, walls: Costs) -> BlockedByRobots | PlanRefusal | None:
        """Plan the path that would exist without the other robots.

        A robot that waits for others needs the same path again and again. So the path is planned only once.
        """
        asked = (attempt.start, attempt.goal)
        if walls is self._walls and asked == self._alone_query and self._alone_answer is not None:
            return self._alone_answer
        path = self._path(attempt, "without robots", walls)
        if path is None:
            return None
        answer = path if isinstance(path, PlanRefusal) else BlockedByRobots(thinned(path.poses[:, :2], POINT_SPACING))
        if walls is self._walls:
            self._alone_query, self._alone_answer = asked, answer
        return answer

    def _refusal(self, attempt: _Attempt, refused: PlanRefusal) -> PlanRefusal | None:
        """Return the refusal. If a path exists on the map alone, name an obstacle seen by the laser as the cause."""
        bare: Path | PlanRefusal | None = refused
        # Without marks of the laser, the path was already searched on the map alone.
        if self.costmap.obstacles.any_marks:
            bare = self._path(attempt, "without observations", self._walls)
        if isinstance(bare, PlanRefusal):
            shape, radius = self._walls.shape, self.costmap.circumscribed_radius
            return with_edge(bare, shape, self._frame, attempt.start, attempt.goal, radius)
        if bare is None:
            return None
        return PlanRefusal("blocked_by_obstacle", "an obstacle that is not on the map blocks the way")

    def obstructed(self, points: FloatArray) -> bool:
        """Return True if an obstacle seen by the laser is on (m, 2) points of a path."""
        radius = self.costmap.inscribed_radius - self._frame.resolution
        seen = self.costmap.obstacles
        return seen.any_marks and bool(_touched(points, seen.marks, self._frame, radius))

    def refuge(self, start: Pose2, wanted_path: FloatArray, time: float, others: OtherItineraries) -> Itinerary | None:
        """Plan an itinerary to a place off another robot's path. Return None if there is no such place.

        Args:
            start: pose of the base.
            wanted_path: (m, 2) map points of the path that the other robot wants to drive.
            time: start time of the itinerary.
            others: itineraries of the other robots.
        """
        free, _ = self._free_space()
        away = refuge(self._roadmap, free, np.array([start.x, start.y]), wanted_path, time, others, self.separation)
        if away is None:
            return None
        away = densified(away)
        return away if self._executable(away, others) else None

    def made_way_for(self, itinerary: Itinerary, others: OtherItineraries) -> int | None:
        """Return the first robot for which an itinerary makes way, or None if there is none.

        Without other robots, this robot would drive on another path. On that path it would meet the returned robot
        first.
        """
        # The robot drives as it would without other robots.
        if itinerary.unhindered_from == -math.inf:
            return None
        free, _ = self._free_space()
        start, goal, time = itinerary.points[0], itinerary.points[-1], float(itinerary.times[0])
        alone = route(self._roadmap, free, start, goal, time, itineraries_of(()), self.separation)
        if alone is None:
            return None
        alone = densified(alone)
        met = int(first_met(alone.points, alone.times, others, self.separation))
        return None if met < 0 else met

    def obstructs(self, place: FloatArray, wanted_path: FloatArray) -> bool:
        """Return True if a robot at a (2,) place blocks another robot on its (m, 2) path."""
        return bool(
            (
                elementary_arrays.hypot(wanted_path[:, 0] - place[0], wanted_path[:, 1] - place[1]) < self.separation
            ).any()
        )

    def first_obstructing(self, neighbours: Sequence[Neighbour], wanted_path: FloatArray) -> int | None:
        """Return the first robot along a (m, 2) path that stands on it or will arrive on it."""
        met: list[tuple[int, int]] = []
        for other in neighbours:
            place = other.path[-1] if len(other.times) else other.base_in_map.array()[:2]
            near = np.flatnonzero(elementary_arrays.hypot(*(wanted_path - place).T) < self.separation)
            if len(near):
                met.append((int(near[0]), other.robot))
        return min(met)[1] if met else None

    def _executable(self, itinerary: Itinerary, others: OtherItineraries) -> bool:
        return bool(executable(itinerary.points, itinerary.times, others, self.separation_driven))

    def _free_space(self) -> tuple[BoolArray, Costs]:
        """Return a mask of coarse cells without walls and obstacles, and the costs without the other robots."""
        if not self.costmap.obstacles.any_marks:
            return self._roadmap.free, self._walls
        walls = self.costmap.without_robots()
        near = walls[self._cells[:, 0], self._cells[:, 1]].reshape(self._roadmap.free.shape)
        return self._roadmap.free & (near <= self._too_near), walls


@lru_cache(maxsize=8)
def _coarse(static: OccupancyGrid, radius: float) -> tuple[Roadmap, NDArray[np.int32]]:
    """Return the coarse grid for robots of a radius (meters), and the (n, 2) map cells that contain its cells' centers.

    All robots of the same size share these arrays, so they must not be changed.
    """
    made = make_roadmap(static, clearance_field(static), radius)
    return made, static.cells_of(made.centres.reshape(-1, 2)).astype(np.int32)


@njit(cache=True)
def _touched(points: FloatArray, marks: Costs, frame: CostFrame, radius: float) -> bool:
    """Return True if the center of a marked cell is within `radius` of one of (m, 2) points."""
    span = int(radius / frame.resolution) + 1
    for k in range(points.shape[0]):
        row = math.floor((points[k, 1] - frame.y) / frame.resolution)
        col = math.floor((points[k, 0] - frame.x) / frame.resolution)
        for r in range(max(0, row - span), min(marks.shape[0], row + span + 1)):
            for c in range(max(0, col - span), min(marks.shape[1], col + span + 1)):
                if marks[r, c] == LETHAL and elementary.hypot(r - row, c - col) * frame.resolution < radius:
                    return True
    return False


@njit(cache=True)
def thinned(points: FloatArray, spacing: float) -> FloatArray:
    """Select (k, 2) of (m, 2) points: both ends, and points at least `spacing` meters apart."""
    kept = np.empty((points.shape[0] + 1, 2))
    kept[0] = points[0]
    count = 1
    for i in range(1, points.shape[0] - 1):
        dx, dy = points[i, 0] - kept[count - 1, 0], points[i, 1] - kept[count - 1, 1]
        if dx * dx + dy * dy >= spacing * spacing:
            kept[count] = points[i]
            count += 1
    kept[count] = points[-1]
    return kept[: count + 1].copy()
