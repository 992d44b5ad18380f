"""An arena as it is drawn: rooms and start poses, the changes to them, and undo."""

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from itertools import count

import numpy as np
from scipy.ndimage import binary_dilation, label

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OccupancyGrid
from sim.common.robot_numbers import robot_name
from sim.common.traversability import Mask, Point, Polygon, TraversabilityMap, area, crosses_itself, inside
from sim.numerics.elementary import wrap_angle
from sim.robot.costmap.footprint import radii
from thbridge.files.map_files import FOOTPRINT, MapRoom
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.offline.arena import Arena, best_goal, cells_inside, simple_outline
from thbridge.offline.map_survey import Doorway, doorways

BRIDGE = 0.5
"""Metres between two rooms that are merged over a door or a thin wall."""


class ArenaTool(StrEnum):
    """Tools of the pointer on the map."""

    MOVE = "move"
    ROOM = "room"
    CUT = "cut"
    START = "start"


class ArenaRefusalReason(StrEnum):
    """Reasons why an arena is not changed, by what would have been changed."""

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
    """Something that can be chosen, moved and turned: a room's goal, one of its corners, or a start pose.

    Attributes:
        room: number of the room; 0 for a start pose.
        index: of the start pose, or of the room's corner; -1 for its goal.
    """

    room: int
    index: int = -1

    @property
    def is_start(self) -> bool:
        """True for a start pose."""
        return self.room == 0


Outcome = Arena | RequestRefused


class ArenaDraft:
    """An arena that is being drawn.

    Each change returns None, or a refusal with a sentence for people, and then changes nothing.

    Attributes:
        grid: the map.
        floor: the map for the robot's footprint.
        arena: rooms and start poses as they are now.
    """

    def __init__(
        self, grid: OccupancyGrid, arena: Arena, *, is_saved: bool = False, footprint: Polygon = FOOTPRINT
    ) -> None:
        self.grid = grid
        self.floor = TraversabilityMap.of(grid, *radii(np.array(footprint)))
        self.arena = arena
        self._footprint = footprint
        self._saved = arena if is_saved else None
        self._past: list[Arena] = []
        self._future: list[Arena] = []
        self._doors: tuple[Arena, tuple[Doorway, ...]] | None = None
        self._faults: tuple[Arena, tuple[str, ...]] | None = None

    # Undo -------------------------------------------------------------------------------------------------------------

    @property
    def dirty(self) -> bool:
        """True when there is something to save."""
        return self.arena != self._saved

    @property
    def can_undo(self) -> bool:
        """True when a change can be taken back."""
        return bool(self._past)

    @property
    def can_redo(self) -> bool:
        """True when a change that was taken back can be made again."""
        return bool(self._future)

    def saved(self) -> None:
        """Take the arena for saved."""
        self._saved = self.arena

    def undo(self) -> None:
        """Take the last change back."""
        if self._past:
            self._future.append(self.arena)
            self.arena = self._past.pop()

    def redo(self) -> None:
        """Make the change again that was taken back last."""
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
        """Give a room another name."""
        name = " ".join(name.split())
        if not name:
            return RequestRefused(ArenaRefusalReason.NAME, "A room needs a name.")
        if any(room.name == name and room.room.people != number for room in self.arena.rooms):
            return RequestRefused(ArenaRefusalReason.NAME, f"Another room is called {name} already.")
        return self._take(self._with_room(dataclasses.replace(self._room(number), name=name)))

    def renumber(self, number: int, wanted: int) -> RequestRefused | None:
        """Give a room another number; those between move up or down."""
        rooms = list(self.arena.rooms)
        if not 1 <= wanted <= len(rooms):
            return RequestRefused(ArenaRefusalReason.NUMBER, f"Rooms are numbered 1 to {len(rooms)}.")
        rooms.insert(wanted - 1, rooms.pop(number - 1))
        return self._take(self._numbered(rooms))

    def remove_room(self, number: int) -> RequestRefused | None:
        """Make a room corridor."""
        return self._take(self._numbered([room for room in self.arena.rooms if room.room.people != number]))

    def draw_room(self, one: Point, other: Point) -> RequestRefused | None:
        """Make a room of the free floor in a box, between walls and other rooms."""
        (left, right), (low, high) = (sorted(pair) for pair in zip(one, other, strict=True))
        x, y = self.floor.centres(self.floor.everywhere)
        within = (x >= left) & (x <= right) & (y >= low) & (y <= high)
        taken = self._taken()
        made = self._made(within & (self.grid.cells == FREE), taken, len(self.arena.rooms) + 1, self._free_name())
        return self._take(made if isinstance(made, RequestRefused) else self._numbered([*self.arena.rooms, made]))

    def cut_room(self, one: Point, other: Point) -> RequestRefused | None:
        """Divide the room in which the middle of a line lies by that line, made longer on both sides."""
        middle = (one[0] + other[0]) / 2, (one[1] + other[1]) / 2
        room = next((room for room in self.arena.rooms if room.holds(*middle)), None)
        if room is None:
            return RequestRefused(ArenaRefusalReason.CUT, "The middle of the line is in no room.")
        along = other[0] - one[0], other[1] - one[1]
        x, y = self.floor.centres(self.floor.everywhere)
        side = along[0] * (y - one[1]) - along[1] * (x - one[0])
        number, cells = room.room.people, cells_inside(room.region, self.floor)
        taken = self._taken(number)
        first = self._made(cells & (side > 0), taken, number, room.name)
        if isinstance(first, RequestRefused):
            return first
        taken |= cells_inside(first.region, self.floor)
        second = self._made(cells & (side <= 0), taken, len(self.arena.rooms) + 1, self._free_name())
        if isinstance(second, RequestRefused):
            return second
        return self._take(self._numbered([*self._with_room(first).rooms, second]))

    def merge_rooms(self, one: int, other: int) -> RequestRefused | None:
        """Make one room of two neighbours; it has the lower number and its name."""
        keep, gone = sorted((one, other))
        if keep == gone:
            return RequestRefused(ArenaRefusalReason.MERGE, "Choose two rooms to merge.")
        reach = math.ceil(BRIDGE / self.grid.resolution)
        masks = [cells_inside(self._room(number).region, self.floor) for number in (keep, gone)]
        near = [np.asarray(binary_dilation(mask, iterations=reach)) for mask in masks]
        taken = self._taken(keep, gone)
        both = masks[0] | masks[1] | (near[0] & near[1] & (self.grid.cells == FREE) & ~taken)
        pieces = np.asarray(label(both)[0])
        if not set(np.unique(pieces[masks[0]])) & set(np.unique(pieces[masks[1]])):
            return RequestRefused(ArenaRefusalReason.MERGE, f"No opening leads from room {keep} to room {gone}.")
        made = self._made(both, taken, keep, self._room(keep).name)
        if isinstance(made, RequestRefused):
            return made
        rooms = [made if room.room.people == keep else room for room in self.arena.rooms if room.room.people != gone]
        return self._take(self._numbered(rooms))

    # Goals, corners, start poses --------------------------------------------------------------------------------------

    def add_start(self, x: float, y: float) -> RequestRefused | None:
        """Add a start pose for one more robot."""
        starts = (*self.arena.starts, Pose2(round(x, 3), round(y, 3), 0.0))
        return self._take(self._with_starts(starts, len(starts) - 1))

    def move(self, handle: ArenaHandle, x: float, y: float) -> RequestRefused | None:
        """Move a goal, a corner or a start pose."""
        return self._take(self.moved(handle, x, y))

    def moved(self, handle: ArenaHandle, x: float, y: float) -> Outcome:
        """The arena after such a move, which is not made."""
        x, y = round(x, 3), round(y, 3)
        if handle.is_start:
            starts = list(self.arena.starts)
            starts[handle.index] = Pose2(x, y, starts[handle.index].theta)
            return self._with_starts(tuple(starts), handle.index)
        room = self._room(handle.room)
        if handle.index >= 0:
            return self._with_corner(room, handle.index, (x, y))
        pose = Pose2(x, y, room.goal.theta)
        if not room.holds(x, y):
            return RequestRefused(ArenaRefusalReason.GOAL, f"The goal of {room.name} has to stay in the room.")
        if self.floor.clearance_at(pose) <= self.floor.circumscribed:
            return self._too_narrow(ArenaRefusalReason.GOAL)
        return self._with_room(dataclasses.replace(room, goal=pose))

    def turn(self, handle: ArenaHandle, angle: float) -> RequestRefused | None:
        """Turn a goal or a start pose; radians, anticlockwise."""
        if handle.is_start:
            starts = list(self.arena.starts)
            starts[handle.index] = _turned(starts[handle.index], angle)
            return self._take(dataclasses.replace(self.arena, starts=tuple(starts)))
        room = self._room(handle.room)
        return self._take(self._with_room(dataclasses.replace(room, goal=_turned(room.goal, angle))))

    def remove_start(self, index: int) -> RequestRefused | None:
        """Take a start pose away; later robots move up."""
        starts = self.arena.starts
        return self._take(dataclasses.replace(self.arena, starts=(*starts[:index], *starts[index + 1 :])))

    def handle_at(self, x: float, y: float, reach: float, chosen: int | None = None) -> ArenaHandle | None:
        """The nearest handle within some metres of a point; corners are those of the chosen room alone."""
        near = [
            (math.hypot(start.x - x, start.y - y), ArenaHandle(0, index))
            for index, start in enumerate(self.arena.starts)
        ]
        near += [
            (math.hypot(room.goal.x - x, room.goal.y - y), ArenaHandle(room.room.people)) for room in self.arena.rooms
        ]
        if chosen is not None:
            region = self._room(chosen).region
            near += [
                (math.hypot(corner[0] - x, corner[1] - y), ArenaHandle(chosen, index))
                for index, corner in enumerate(region)
            ]
        distance, handle = min(near, key=lambda one: one[0], default=(math.inf, None))
        return handle if distance <= reach else None

    def room_at(self, x: float, y: float) -> int | None:
        """Number of the room with a point of the map frame."""
        return next((room.room.people for room in self.arena.rooms if room.holds(x, y)), None)

    def doors(self) -> tuple[Doorway, ...]:
        """The openings of the rooms that a robot fits through: they follow from the outlines and the walls."""
        if self._doors is None or self._doors[0] is not self.arena:
            owners = np.zeros(self.grid.cells.shape, dtype=np.int32)
            for room in self.arena.rooms:
                owners[cells_inside(room.region, self.floor)] = room.room.people
            self._doors = self.arena, tuple(doorways(self.floor, owners, self._footprint))
        return self._doors[1]

    def faults(self) -> tuple[str, ...]:
        """Sentences about all that keeps games from being played."""
        if self._faults is None or self._faults[0] is not self.arena:
            self._faults = self.arena, self._found_faults()
        return self._faults[1]

    def _found_faults(self) -> tuple[str, ...]:
        rooms, starts = self.arena.rooms, self.arena.starts
        told = [*(() if rooms else ("There is no room yet.",)), *(() if starts else ("There is no start pose yet.",))]
        if starts:
            reach = self.floor.reachable(starts[0])
            places = [(room.goal, f"{room.room} ({room.name})") for room in rooms]
            places += [(start, f"the start of robot {number}") for number, start in enumerate(starts[1:], start=2)]
            for pose, what in places:
                cell = self.grid.cell_of(pose.x, pose.y)
                if not (self.grid.contains(*cell) and reach[cell]):
                    told.append(f"No way leads from the start of robot 1 to {what}.")
        return tuple(told)

    # Parts ------------------------------------------------------------------------------------------------------------

    def _room(self, number: int) -> MapRoom:
        return self.arena.rooms[number - 1]

    def _too_narrow(self, reason: ArenaRefusalReason) -> RequestRefused:
        needed = self.floor.circumscribed
        return RequestRefused(reason, f"No robot can turn there: it needs {needed:.2f} m to the nearest wall.")

    def _with_room(self, room: MapRoom) -> Arena:
        rooms = tuple(room if other.room == room.room else other for other in self.arena.rooms)
        return dataclasses.replace(self.arena, rooms=rooms)

    def _numbered(self, rooms: list[MapRoom]) -> Arena:
        numbered = tuple(dataclasses.replace(room, room=Room(number)) for number, room in enumerate(rooms, start=1))
        return dataclasses.replace(self.arena, rooms=numbered)

    def _free_name(self) -> str:
        names = {room.name for room in self.arena.rooms}
        return next(name for number in count(len(names) + 1) if (name := f"Room {number}") not in names)

    def _taken(self, *but: int) -> Mask:
        taken = np.zeros(self.grid.cells.shape, dtype=np.bool_)
        for room in self.arena.rooms:
            if room.room.people not in but:
                taken |= cells_inside(room.region, self.floor)
        return taken

    def _made(self, mask: Mask, taken: Mask, number: int, name: str) -> MapRoom | RequestRefused:
        outline = simple_outline(mask, taken, self.floor)
        if outline is None:
            return RequestRefused(ArenaRefusalReason.ROOM, "There is no free floor for a room.")
        return self._room_of(outline, number, name)

    def _room_of(self, outline: Polygon, number: int, name: str) -> MapRoom | RequestRefused:
        turning = cells_inside(outline, self.floor) & (self.floor.clearance > self.floor.circumscribed)
        goal = best_goal(self.floor, outline, turning)
        if goal is None:
            return RequestRefused(ArenaRefusalReason.ROOM, "The room is too small: no robot can turn in it.")
        return MapRoom(Room(number), name, outline, goal)

    def _with_corner(self, room: MapRoom, index: int, corner: Point) -> Outcome:
        region = (*room.region[:index], corner, *room.region[index + 1 :])
        if crosses_itself(region) or area(region) <= 0.0:
            return RequestRefused(ArenaRefusalReason.CORNER, f"The outline of {room.name} would cross itself.")
        if not self.grid.contains(*self.grid.cell_of(*corner)):
            return RequestRefused(ArenaRefusalReason.CORNER, "The corner has to stay on the map.")
        if (cells_inside(region, self.floor) & self._taken(room.room.people)).any():
            return RequestRefused(ArenaRefusalReason.CORNER, f"{room.name} would overlap another room.")
        if inside(region, np.array([room.goal.x]), np.array([room.goal.y]))[0]:
            return self._with_room(dataclasses.replace(room, region=region))
        made = self._room_of(region, room.room.people, room.name)
        return made if isinstance(made, RequestRefused) else self._with_room(made)

    def _with_starts(self, starts: tuple[Pose2, ...], index: int) -> Outcome:
        start, needed = starts[index], self.floor.circumscribed
        if self.floor.clearance_at(start) <= needed:
            return self._too_narrow(ArenaRefusalReason.START)
        near = [
            number for number, other in enumerate(starts) if number != index and start.distance(other) <= 2 * needed
        ]
        if near:
            return RequestRefused(ArenaRefusalReason.START, f"That is too near to the start of {robot_name(near[0])}.")
        return dataclasses.replace(self.arena, starts=starts)


def _turned(pose: Pose2, angle: float) -> Pose2:
    return Pose2(pose.x, pose.y, round(wrap_angle(pose.theta + angle), 3))


class ArenaPointer:
    """The pointer on an arena: a press, a drag and a release, with each tool.

    Attributes:
        tool: the tool in hand.
        chosen: number of the chosen room, or None.
        start: index of the chosen start pose, or None.
        stroke: both ends of a box or line that is being drawn, map frame; else None.
        shown: the arena as it would be if the pointer were released here.
        refusal: why it would not be changed; empty where it would.
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
        """Begin; `reach` is how far from a handle it is still hit, metres."""
        self.refusal, self._at = "", None
        match self.tool:
            case ArenaTool.MOVE:
                self._held = self.draft.handle_at(x, y, reach, self.chosen)
                self.choose(
                    self.draft.room_at(x, y) if self._held is None else self._held.room or None,
                    self._held.index if self._held is not None and self._held.is_start else None,
                )
            case ArenaTool.ROOM | ArenaTool.CUT:
                self.stroke = ((x, y), (x, y))
            case ArenaTool.START:
                self._told(self.draft.add_start(x, y))

    def drag(self, x: float, y: float) -> None:
        """Go on."""
        if self.stroke is not None:
            self.stroke = (self.stroke[0], (x, y))
        elif self._held is not None:
            outcome = self.draft.moved(self._held, x, y)
            self.refusal = outcome.sentence if isinstance(outcome, RequestRefused) else ""
            if not isinstance(outcome, RequestRefused):
                self.shown, self._at = outcome, (x, y)

    def release(self) -> None:
        """End: make the change, where it can be made."""
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

    def choose(self, room: int | None, start: int | None = None) -> None:
        """Choose a room, a start pose, or nothing."""
        self.chosen, self.start = room, start

    @property
    def handle(self) -> ArenaHandle | None:
        """The chosen goal or start pose."""
        if self.start is not None:
            return ArenaHandle(0, self.start)
        return None if self.chosen is None else ArenaHandle(self.chosen)

    def change(self, made: Callable[[], RequestRefused | None]) -> None:
        """Make a change, and keep to what there is of what was chosen."""
        self._told(made())
        if self.chosen is not None and self.chosen > len(self.draft.arena.rooms):
            self.chosen = None
        if self.start is not None and self.start >= len(self.draft.arena.starts):
            self.start = None

    def _told(self, refused: RequestRefused | None) -> None:
        self.refusal = "" if refused is None else refused.sentence
        self.shown = self.draft.arena
