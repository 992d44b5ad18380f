"""Arena that a person draws: rooms, start poses, changes, and undo."""

import dataclasses
import math
from collections.abc import Callable
from enum import StrEnum
from itertools import count

import numpy as np
from scipy.ndimage import binary_dilation, label

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OccupancyGrid
from sim.common.traversability import Point, Polygon
from sim.numerics.elementary import wrap_angle
from thbridge.files.map_files import FOOTPRINT, MapRoom
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.offline.arena import Arena, cells_inside
from ui.model.arena.floor import ArenaFloor, ArenaHandle, ArenaRefusalReason, Outcome, with_room

BRIDGE = 0.5
"""Maximum distance between two rooms that can be merged across a door or a thin wall, meters."""


class ArenaTool(StrEnum):
    """Tools of the pointer on the map."""

    MOVE = "move"
    ROOM = "room"
    CUT = "cut"
    START = "start"


class ArenaDraft:
    """Arena that a person is drawing.

    Methods that change the arena return None. If a change is impossible, they change nothing, and return a refusal
    with a sentence for people.

    Attributes:
        floor: the free floor, for checks of rooms and of the robot's footprint.
        arena: rooms and start poses as they are now.
    """

    def __init__(
        self, grid: OccupancyGrid, arena: Arena, *, is_saved: bool = False, footprint: Polygon = FOOTPRINT
    ) -> None:
        self.floor = ArenaFloor(grid, footprint)
        self.arena = arena
        self._saved = arena if is_saved else None
        self._past: list[Arena] = []
        self._future: list[Arena] = []

    # Undo -------------------------------------------------------------------------------------------------------------

    @property
    def dirty(self) -> bool:
        """True if the arena has unsaved changes."""
        return self.arena != self._saved

    @property
    def can_undo(self) -> bool:
        """True if there is a change that can be undone."""
        return bool(self._past)

    @property
    def can_redo(self) -> bool:
        """True if there is an undone change that can be redone."""
        return bool(self._future)

    def saved(self) -> None:
        """Mark the present arena as saved."""
        self._saved = self.arena

    def undo(self) -> None:
        """Undo the last change."""
        if self._past:
            self._future.append(self.arena)
            self.arena = self._past.pop()

    def redo(self) -> None:
        """Redo the last undone change."""
        if self._future:
            self._past.append(self.arena)
            self.arena = self._future.pop()

    def _take(self, outcome: Outcome) -> RequestRefused | None:
        if isinstance(outcome, RequestRefused):
            return outcome
        if outcome != self.arena:
            self._past.append(self.arena)
            self._future.clear()
            self.arena = outcome
        return None

    # Rooms ------------------------------------------------------------------------------------------------------------

    def rename(self, number: int, name: str) -> RequestRefused | None:
        """Change the name of a room."""
        name = " ".join(name.split())
        if not name:
            return RequestRefused(ArenaRefusalReason.NAME, "A room needs a name.")
        if any(room.name == name and room.room.people != number for room in self.arena.rooms):
            return RequestRefused(ArenaRefusalReason.NAME, f"Another room is already called {name}.")
        return self._take(with_room(self.arena, dataclasses.replace(self.arena.rooms[number - 1], name=name)))

    def renumber(self, number: int, wanted: int) -> RequestRefused | None:
        """Change the number of a room; the numbers of the rooms in between change by one."""
        rooms = list(self.arena.rooms)
        if not 1 <= wanted <= len(rooms):
            return RequestRefused(ArenaRefusalReason.NUMBER, f"The number of a room must be from 1 to {len(rooms)}.")
        rooms.insert(wanted - 1, rooms.pop(number - 1))
        return self._take(_numbered(self.arena, rooms))

    def remove_room(self, number: int) -> RequestRefused | None:
        """Remove a room; its floor then belongs to the corridor."""
        return self._take(_numbered(self.arena, [room for room in self.arena.rooms if room.room.people != number]))

    def draw_room(self, one: Point, other: Point) -> RequestRefused | None:
        """Add a room: the free floor in a box, limited by walls and other rooms."""
        (left, right), (low, high) = (sorted(pair) for pair in zip(one, other, strict=True))
        x, y = self.floor.map.centres(self.floor.map.everywhere)
        within = (x >= left) & (x <= right) & (y >= low) & (y <= high)
        taken = self.floor.taken(self.arena)
        free = within & (self.floor.map.grid.cells == FREE)
        made = self.floor.room_in(free, taken, len(self.arena.rooms) + 1, _free_name(self.arena))
        if isinstance(made, RequestRefused):
            return made
        return self._take(_numbered(self.arena, [*self.arena.rooms, made]))

    def cut_room(self, one: Point, other: Point) -> RequestRefused | None:
        """Divide a room by a line. The room contains the middle of the line; both ends are extended to the walls."""
        middle = (one[0] + other[0]) / 2, (one[1] + other[1]) / 2
        room = next((room for room in self.arena.rooms if room.holds(*middle)), None)
        if room is None:
            return RequestRefused(ArenaRefusalReason.CUT, "The middle of the line must be in a room.")
        along = other[0] - one[0], other[1] - one[1]
        x, y = self.floor.map.centres(self.floor.map.everywhere)
        side = along[0] * (y - one[1]) - along[1] * (x - one[0])
        number, cells = room.room.people, cells_inside(room.region, self.floor.map)
        taken = self.floor.taken(self.arena, number)
        first = self.floor.room_in(cells & (side > 0), taken, number, room.name)
        if isinstance(first, RequestRefused):
            return first
        taken |= cells_inside(first.region, self.floor.map)
        second = self.floor.room_in(cells & (side <= 0), taken, len(self.arena.rooms) + 1, _free_name(self.arena))
        if isinstance(second, RequestRefused):
            return second
        return self._take(_numbered(self.arena, [*with_room(self.arena, first).rooms, second]))

    def merge_rooms(self, one: int, other: int) -> RequestRefused | None:
        """Merge two neighboring rooms; the result has the number and the name of the room with the lower number."""
        keep, gone = sorted((one, other))
        if keep == gone:
            return RequestRefused(ArenaRefusalReason.MERGE, "Choose two rooms to merge.")
        reach = math.ceil(BRIDGE / self.floor.map.grid.resolution)
        masks = [cells_inside(self.arena.rooms[number - 1].region, self.floor.map) for number in (keep, gone)]
        near = [np.asarray(binary_dilation(mask, iterations=reach)) for mask in masks]
        taken = self.floor.taken(self.arena, keep, gone)
        both = masks[0] | masks[1] | (near[0] & near[1] & (self.floor.map.grid.cells == FREE) & ~taken)
        pieces = np.asarray(label(both)[0])
        if not set(np.unique(pieces[masks[0]])) & set(np.unique(pieces[masks[1]])):
            return RequestRefused(ArenaRefusalReason.MERGE, f"No opening leads from room {keep} to room {gone}.")
        made = self.floor.room_in(both, taken, keep, self.arena.rooms[keep - 1].name)
        if isinstance(made, RequestRefused):
            return made
        rooms = [made if room.room.people == keep else room for room in self.arena.rooms if room.room.people != gone]
        return self._take(_numbered(self.arena, rooms))

    # Goals, corners, start poses --------------------------------------------------------------------------------------

    def add_start(self, x: float, y: float) -> RequestRefused | None:
        """Add a start pose for one more robot."""
        starts = (*self.arena.starts, Pose2(round(x, 3), round(y, 3), 0.0))
        return self._take(self.floor.with_starts(self.arena, starts, len(starts) - 1))

    def move(self, handle: ArenaHandle, x: float, y: float) -> RequestRefused | None:
        """Move a goal, a corner or a start pose."""
        return self._take(self.floor.moved(self.arena, handle, x, y))

    def turn(self, handle: ArenaHandle, angle: float) -> RequestRefused | None:
        """Turn a goal or a start pose, counterclockwise, in radians."""
        if handle.is_start:
            starts = list(self.arena.starts)
            starts[handle.index] = _turned(starts[handle.index], angle)
            return self._take(dataclasses.replace(self.arena, starts=tuple(starts)))
        room = self.arena.rooms[handle.room - 1]
        return self._take(with_room(self.arena, dataclasses.replace(room, goal=_turned(room.goal, angle))))

    def remove_start(self, index: int) -> RequestRefused | None:
        """Remove a start pose; the numbers of later robots decrease by one."""
        starts = self.arena.starts
        return self._take(dataclasses.replace(self.arena, starts=(*starts[:index], *starts[index + 1 :])))


def room_at(arena: Arena, x: float, y: float) -> int | None:
    """Return the number of the room that contains a point of the map frame."""
    return next((room.room.people for room in arena.rooms if room.holds(x, y)), None)


def _numbered(arena: Arena, rooms: list[MapRoom]) -> Arena:
    numbered = tuple(dataclasses.replace(room, room=Room(number)) for number, room in enumerate(rooms, start=1))
    return dataclasses.replace(arena, rooms=numbered)


def _free_name(arena: Arena) -> str:
    names = {room.name for room in arena.rooms}
    return next(name for number in count(len(names) + 1) if (name := f"Room {number}") not in names)


def _turned(pose: Pose2, angle: float) -> Pose2:
    return Pose2(pose.x, pose.y, round(wrap_angle(pose.theta + angle), 3))


class ArenaPointer:
    """Effects of presses, drags and releases of the pointer on an arena, for the selected tool.

    Attributes:
        tool: the selected tool.
        chosen: number of the selected room, or None.
        start: index of the selected start pose, or None.
        stroke: both ends of the box or line that a person is drawing, in the map frame; None if there is no drawing.
        shown: the arena as it would be if the person released the pointer now.
        refusal: reason why a release of the pointer would not change the arena; empty if the arena would change.
    """

    def __init__(self, draft: ArenaDraft) -> None:
        self.draft = draft
        self.tool = ArenaTool.MOVE
        self.chosen: int | None = None
        self.start: int | None = None
        self.stroke: tuple[Point, Point] | None = None
        self.shown = draft.arena
        self.refusal = ""
        self._held: ArenaHandle | None = None
        self._at: Point | None = None

    def press(self, x: float, y: float, reach: float) -> None:
        """Begin a stroke or grab a handle within `reach` meters of the point."""
        self.refusal, self._at = "", None
        match self.tool:
            case ArenaTool.MOVE:
                self._held = self._handle_at(x, y, reach)
                self.choose(
                    room_at(self.draft.arena, x, y) if self._held is None else self._held.room or None,
                    self._held.index if self._held is not None and self._held.is_start else None,
                )
            case ArenaTool.ROOM | ArenaTool.CUT:
                self.stroke = ((x, y), (x, y))
            case ArenaTool.START:
                self._told(self.draft.add_start(x, y))

    def drag(self, x: float, y: float) -> None:
        """Continue the stroke or drag to this point."""
        if self.stroke is not None:
            self.stroke = (self.stroke[0], (x, y))
        elif self._held is not None:
            outcome = self.draft.floor.moved(self.draft.arena, self._held, x, y)
            self.refusal = outcome.sentence if isinstance(outcome, RequestRefused) else ""
            if not isinstance(outcome, RequestRefused):
                self.shown, self._at = outcome, (x, y)

    def release(self) -> None:
        """End the drag. If possible, change the arena."""
        stroke, held = self.stroke, self._held
        self.stroke = self._held = None
        if stroke is not None and stroke[0] != stroke[1]:
            change = self.draft.draw_room if self.tool is ArenaTool.ROOM else self.draft.cut_room
            before = len(self.draft.arena.rooms)
            self._told(change(*stroke))
            if len(self.draft.arena.rooms) > before:
                self.choose(len(self.draft.arena.rooms))
        elif held is not None and self._at is not None:
            self._told(self.draft.move(held, *self._at))
        self.shown = self.draft.arena

    def _handle_at(self, x: float, y: float, reach: float) -> ArenaHandle | None:
        """Return the nearest handle within `reach` meters of a point; only corners of the selected room are handles."""
        arena = self.draft.arena
        near = [
            (math.hypot(start.x - x, start.y - y), ArenaHandle(0, index)) for index, start in enumerate(arena.starts)
        ]
        near += [(math.hypot(room.goal.x - x, room.goal.y - y), ArenaHandle(room.room.people)) for room in arena.rooms]
        if self.chosen is not None:
            region = arena.rooms[self.chosen - 1].region
            near += [
                (math.hypot(corner[0] - x, corner[1] - y), ArenaHandle(self.chosen, index))
                for index, corner in enumerate(region)
            ]
        distance, handle = min(near, key=lambda one: one[0], default=(math.inf, None))
        return handle if distance <= reach else None

    def choose(self, room: int | None, start: int | None = None) -> None:
        """Select a room, a start pose, or nothing."""
        self.chosen, self.start = room, start

    @property
    def handle(self) -> ArenaHandle | None:
        """Selected goal or start pose."""
        if self.start is not None:
            return ArenaHandle(0, self.start)
        return None if self.chosen is None else ArenaHandle(self.chosen)

    def change(self, made: Callable[[], RequestRefused | None]) -> None:
        """Make a change, and keep the selection if the selected object still exists."""
        self._told(made())
        if self.chosen is not None and self.chosen > len(self.draft.arena.rooms):
            self.chosen = None
        if self.start is not None and self.start >= len(self.draft.arena.starts):
            self.start = None

    def _told(self, refused: RequestRefused | None) -> None:
        self.refusal = "" if refused is None else refused.sentence
        self.shown = self.draft.arena
