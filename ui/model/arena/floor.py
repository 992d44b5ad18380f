"""Floor of an arena for the robot's footprint: possible rooms, places where robots fit, and faults."""

import dataclasses
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.robot_numbers import robot_name
from sim.common.traversability import Mask, Point, Polygon, TraversabilityMap, area, crosses_itself, inside
from sim.robot.costmap.footprint import radii
from thbridge.files.map_files import MapRoom
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.offline.arena import Arena, best_goal, cells_inside, simple_outline
from thbridge.offline.map_survey import Doorway, doorways


class ArenaRefusalReason(StrEnum):
    """Reasons why an arena is not changed, each named after the part that a person tried to change."""

    NAME = "name"
    NUMBER = "number"
    ROOM = "room"
    CUT = "cut"
    MERGE = "merge"
    CORNER = "corner"
    GOAL = "goal"
    START = "start"


@dataclass(frozen=True, slots=True)
class ArenaHandle:
    """Part of an arena that a person can select and move: the goal or a corner of a room, or a start pose.

    Attributes:
        room: number of the room; 0 for a start pose.
        index: index of the start pose, or of the room's corner; -1 for a room's goal.
    """

    room: int
    index: int = -1

    @property
    def is_start(self) -> bool:
        """True for a start pose."""
        return self.room == 0


Outcome = Arena | RequestRefused


class ArenaFloor:
    """Floor of a map for rooms and robots.

    Args:
        grid: the map.
        footprint: corners of a robot in its own frame, meters.

    Attributes:
        map: traversability map for the footprint.
    """

    def __init__(self, grid: OccupancyGrid, footprint: Polygon) -> None:
        self.map = TraversabilityMap.of(grid, *radii(np.array(footprint)))
        self._footprint = footprint
        self._doors: tuple[Arena, tuple[Doorway, ...]] | None = None
        self._faults: tuple[Arena, tuple[str, ...]] | None = None

    def doors(self, arena: Arena) -> tuple[Doorway, ...]:
        """Return the openings of rooms that are wide enough for a robot, computed from room outlines and walls."""
        if self._doors is None or self._doors[0] is not arena:
            owners = np.zeros(self.map.grid.cells.shape, dtype=np.int32)
            for room in arena.rooms:
                owners[cells_inside(room.region, self.map)] = room.room.people
            self._doors = arena, tuple(doorways(self.map, owners, self._footprint))
        return self._doors[1]

    def faults(self, arena: Arena) -> tuple[str, ...]:
        """Return sentences about all faults that make games impossible."""
        if self._faults is None or self._faults[0] is not arena:
            self._faults = arena, self._found_faults(arena)
        return self._faults[1]

    def _found_faults(self, arena: Arena) -> tuple[str, ...]:
        rooms, starts = arena.rooms, arena.starts
        told = [*(() if rooms else ("There is no room yet.",)), *(() if starts else ("There is no start pose yet.",))]
        if starts:
            reach = self.map.reachable(starts[0])
            places = [(room.goal, f"{room.room} ({room.name})") for room in rooms]
            places += [(start, f"the start of robot {number}") for number, start in enumerate(starts[1:], start=2)]
            for pose, what in places:
                cell = self.map.grid.cell_of(pose.x, pose.y)
                if not (self.map.grid.contains(*cell) and reach[cell]):
                    told.append(f"No path leads from the start of robot 1 to {what}.")
        return tuple(told)

    def taken(self, arena: Arena, *but: int) -> Mask:
        """Return the cells of all rooms except the rooms in `but`."""
        taken = np.zeros(self.map.grid.cells.shape, dtype=np.bool_)
        for room in arena.rooms:
            if room.room.people not in but:
                taken |= cells_inside(room.region, self.map)
        return taken

    def room_in(self, mask: Mask, taken: Mask, number: int, name: str) -> MapRoom | RequestRefused:
        """Return a room with a goal, made of the largest connected piece of `mask` without the cells `taken`."""
        outline = simple_outline(mask, taken, self.map)
        if outline is None:
            return RequestRefused(ArenaRefusalReason.ROOM, "There is no free floor for a room.")
        return self._room_of(outline, number, name)

    def _room_of(self, outline: Polygon, number: int, name: str) -> MapRoom | RequestRefused:
        turning = cells_inside(outline, self.map) & (self.map.clearance > self.map.circumscribed)
        goal = best_goal(self.map, outline, turning)
        if goal is None:
            return RequestRefused(ArenaRefusalReason.ROOM, "The room is too small: a robot cannot turn in it.")
        return MapRoom(Room(number), name, outline, goal)

    def moved(self, arena: Arena, handle: ArenaHandle, x: float, y: float) -> Outcome:
        """Return the arena after a move of a goal, a corner or a start pose."""
        x, y = round(x, 3), round(y, 3)
        if handle.is_start:
            starts = list(arena.starts)
            starts[handle.index] = Pose2(x, y, starts[handle.index].theta)
            return self.with_starts(arena, tuple(starts), handle.index)
        room = arena.rooms[handle.room - 1]
        if handle.index >= 0:
            return self._with_corner(arena, room, handle.index, (x, y))
        pose = Pose2(x, y, room.goal.theta)
        if not room.holds(x, y):
            return RequestRefused(ArenaRefusalReason.GOAL, f"The goal of {room.name} must stay in the room.")
        if self.map.clearance_at(pose) <= self.map.circumscribed:
            return self._too_narrow(ArenaRefusalReason.GOAL)
        return with_room(arena, dataclasses.replace(room, goal=pose))

    def _with_corner(self, arena: Arena, room: MapRoom, index: int, corner: Point) -> Outcome:
        region = (*room.region[:index], corner, *room.region[index + 1 :])
        if crosses_itself(region) or area(region) <= 0.0:
            return RequestRefused(ArenaRefusalReason.CORNER, f"The outline of {room.name} would cross itself.")
        if not self.map.grid.contains(*self.map.grid.cell_of(*corner)):
            return RequestRefused(ArenaRefusalReason.CORNER, "The corner must stay on the map.")
        if (cells_inside(region, self.map) & self.taken(arena, room.room.people)).any():
            return RequestRefused(ArenaRefusalReason.CORNER, f"{room.name} would overlap another room.")
        if inside(region, np.array([room.goal.x]), np.array([room.goal.y]))[0]:
            return with_room(arena, dataclasses.replace(room, region=region))
        made = self._room_of(region, room.room.people, room.name)
        return made if isinstance(made, RequestRefused) else with_room(arena, made)

    def with_starts(self, arena: Arena, starts: tuple[Pose2, ...], index: int) -> Outcome:
        """Return the arena with other start poses; the start pose at `index` is new or moved."""
        start, needed = starts[index], self.map.circumscribed
        if self.map.clearance_at(start) <= needed:
            return self._too_narrow(ArenaRefusalReason.START)
        near = [
            number for number, other in enumerate(starts) if number != index and start.distance(other) <= 2 * needed
        ]
        if near:
            near_to = f"the start pose of {robot_name(near[0])}"
            return RequestRefused(ArenaRefusalReason.START, f"This start pose is too near to {near_to}.")
        return dataclasses.replace(arena, starts=starts)

    def _too_narrow(self, reason: ArenaRefusalReason) -> RequestRefused:
        needed = self.map.circumscribed
        return RequestRefused(reason, f"A robot cannot turn there. It needs {needed:.2f} m to the nearest wall.")


def with_room(arena: Arena, room: MapRoom) -> Arena:
    """Return an arena in which this room replaces the room with the same number."""
    rooms = tuple(room if other.room == room.room else other for other in arena.rooms)
    return dataclasses.replace(arena, rooms=rooms)
