"""Map folders: `map.yaml` and its image in the format of map_server, and `rooms.yaml` with rooms and start poses.

For each further language, such as `de`, a subfolder has the names of the rooms in a `words.yaml`.

All files of a folder are checked together. If a map loads, every robot can stand at its start, drive to the goal of
every room, and turn there.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Literal, TypeVar

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OccupancyGrid
from sim.common.traversability import CrowdedFloor, Polygon, TraversabilityMap, area, crosses_itself, inside
from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from sim.parameters import WorldParameters
from sim.robot.costmap.footprint import radii
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.grid_files import POSE, GridFile, pose_of, read_grid_file
from thbridge.files.map_times import MAP_TIMES, read_map_times
from thbridge.files.set_words import WORDS, languages_beside, nearest
from thbridge.files.yaml.load import Loaded, load
from thbridge.hunt.rooms import Room, RoomNames

T = TypeVar("T")

FOOTPRINT: Polygon = WorldParameters().footprint
"""Corners of the robot of the 2016 study, meters."""

LEAST_FLOOR = 0.01
"""Smallest area of a region, square meters; a smaller area is a mistake."""
MOST_AMISS = 0.75
"""If at least this share of goals and starts is off the floor, only the image is reported as faulty."""
MOST_STARTS = 1000
"""Maximum number of start poses in a row; a longer row is a mistake."""


@dataclass(frozen=True, slots=True)
class MapRoom:
    """A room of a map.

    Attributes:
        room: number of the room.
        name: name of the room for people.
        region: corners of the room's floor in the map frame, meters; a simple polygon inside the map.
        goal: goal pose of robots that are sent there, map frame.
    """

    room: Room
    name: str
    region: Polygon
    goal: Pose2

    def holds(self, x: float, y: float) -> bool:
        """Return True if a point of the map frame is in the room."""
        return bool(inside(self.region, np.array([x]), np.array([y]))[0])


@dataclass(frozen=True, slots=True)
class Map:
    """A checked map.

    Attributes:
        name: name of the folder.
        grid: the occupancy grid.
        rooms: the rooms in the order of their numbers, 1, 2, ...; at least one.
        starts: start poses of robot 1, 2, ... in the map frame; at least one.
        costs: the map's own cost file `mapTimes`, which replaces the file of a template folder; None if the map has
            none.
        language: language of the rooms' names. If None, these names are used in every language.
        words: names of the rooms in further languages, by the language and the name in `rooms.yaml`.
        warnings: warnings of the check; games can be played in spite of warnings.
    """

    name: str
    grid: OccupancyGrid
    rooms: tuple[MapRoom, ...]
    starts: tuple[Pose2, ...]
    costs: Path | None
    language: str | None = None
    words: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    warnings: tuple[BadFile, ...] = ()

    @property
    def room_names(self) -> RoomNames:
        """Names of the rooms."""
        return RoomNames.of((entry.room.people, entry.name) for entry in self.rooms)

    def room_names_in(self, language: str) -> RoomNames:
        """Return the names of the rooms in a language. A room without a name in this language keeps its own name."""
        words = {} if language == self.language else self.words.get(language, {})
        named = self.room_names.named
        return RoomNames({number: words.get(name, name) for number, name in named.items()})

    def room_at(self, x: float, y: float) -> Room | None:
        """Return the room with a point of the map frame, or None in a corridor."""
        return next((entry.room for entry in self.rooms if entry.holds(x, y)), None)


@dataclass(frozen=True, slots=True)
class MapFinding:
    """A fault of a map. A map with an error does not load; a map with a warning does."""

    severity: Literal["error", "warning"]
    fault: BadFile


@dataclass(frozen=True, slots=True)
class MapCheck:
    """The readable contents of a map folder, and all faults of the folder.

    Attributes:
        map: the map, with its faults, or None if `map.yaml`, the image or `rooms.yaml` cannot be read.
        findings: all errors and warnings.
    """

    map: Map | None
    findings: tuple[MapFinding, ...]

    @property
    def errors(self) -> tuple[BadFile, ...]:
        """Faults that prevent the map from loading."""
        return tuple(finding.fault for finding in self.findings if finding.severity == "error")


def read_map(folder: Path, footprint: Polygon = FOOTPRINT, *, with_costs: bool = True) -> Map:
    """Read a map folder, and check that a team can play on it.

    Args:
        folder: the folder of `map.yaml`, its image, `rooms.yaml` and, optionally, `mapTimes`.
        footprint: corners of a robot in its own frame, meters.
        with_costs: False to ignore `mapTimes`; the map then has no costs.

    Raises:
        BadFile: the map has a fault. Several faults are raised together, as BadFiles.
    """
    check = check_map(folder, footprint, with_costs=with_costs)
    if check.map is None or check.errors:
        raise BadFiles(check.errors)
    return replace(check.map, warnings=tuple(finding.fault for finding in check.findings))


# The files ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _RoomEntry:
    number: int = field(metadata={"minimum": 1, "maximum": 999})
    name: str
    region: tuple[tuple[float, float], ...]
    goal: tuple[float, float, float] = field(metadata=POSE)


@dataclass(frozen=True, slots=True)
class _StartsEntry:
    poses: tuple[tuple[float, float, float], ...] = field(metadata=POSE)
    rows: tuple[tuple[tuple[float, float], tuple[float, float]], ...] = ()
    spacing: float = field(default=1.0, metadata={"unit": "m", "minimum": 0.1, "maximum": 100})
    yaw: float = field(default=0.0, metadata={"unit": "rad"})


@dataclass(frozen=True, slots=True)
class _RoomsYaml:
    rooms: tuple[_RoomEntry, ...]
    starts: _StartsEntry
    language: str | None = None


@dataclass(frozen=True, slots=True)
class _RoomWords:
    rooms: Mapping[str, str]


def write_rooms(
    folder: Path, rooms: Sequence[MapRoom], starts: Sequence[Pose2], *, language: str | None = None
) -> None:
    """Write or replace `rooms.yaml`. Raises BadFile if this fails; an older file is then unchanged."""
    write_whole(folder / "rooms.yaml", rooms_text(rooms, starts, language).encode())


def rooms_text(rooms: Sequence[MapRoom], starts: Sequence[Pose2], language: str | None = None) -> str:
    """Return the text of `rooms.yaml`."""
    lines = [
        "# Meters and radians in the map frame. region: two opposite corners of a box, or all corners in order.",
        "# goal and poses: x, y, yaw.",
        *([] if language is None else [f"language: {json.dumps(language, ensure_ascii=False)}"]),
        "rooms:",
    ]
    for entry in rooms:
        lines += [
            f"  - number: {entry.room.people}",
            f"    name: {json.dumps(entry.name, ensure_ascii=False)}",
            f"    region: [{', '.join(f'[{x!r}, {y!r}]' for x, y in _short_region(entry.region))}]",
            f"    goal: {_pose_text(entry.goal)}",
        ]
    if not rooms:
        lines[-1] = "rooms: []"
    lines += ["starts:", f"  poses: [{', '.join(_pose_text(start) for start in starts)}]"]
    return "\n".join(lines) + "\n"


def _pose_text(pose: Pose2) -> str:
    return f"[{pose.x!r}, {pose.y!r}, {pose.theta!r}]"


def _short_region(region: Polygon) -> Polygon:
    """Return two opposite corners if the region is a box, and otherwise the region unchanged."""
    left, right = min(x for x, _ in region), max(x for x, _ in region)
    low, high = min(y for _, y in region), max(y for _, y in region)
    box = ((left, low), (right, low), (right, high), (left, high))
    return ((left, low), (right, high)) if region in [box[turn:] + box[:turn] for turn in range(4)] else region


# The checks -----------------------------------------------------------------------------------------------------------


def check_map(folder: Path, footprint: Polygon = FOOTPRINT, *, with_costs: bool = True) -> MapCheck:
    """Read a map folder and find all its faults. Arguments are as for `read_map`."""
    if not folder.is_dir():
        remedy = "Name a folder that contains map.yaml and rooms.yaml"
        return MapCheck(None, (MapFinding("error", BadFile(folder, "there is no such folder", remedy)),))
    findings: list[MapFinding] = []
    drawing = _attempt(lambda: read_grid_file(folder / "map.yaml"), findings)
    loaded = _attempt(lambda: load(folder / "rooms.yaml", _RoomsYaml), findings)
    costs = folder / MAP_TIMES
    own_costs = costs if with_costs and costs.is_file() else None
    if own_costs is not None:
        findings.extend(_findings_of_costs(own_costs, None if loaded is None else len(loaded.value.rooms)))
    if loaded is None:
        return MapCheck(None, tuple(findings))
    findings.extend(MapFinding("error", fault) for fault in _faults_of_rooms(loaded))
    doubts = (*loaded.doubts, *(() if drawing is None else drawing.doubts))
    findings.extend(MapFinding("warning", doubt) for doubt in doubts)
    if drawing is None:
        return MapCheck(None, tuple(findings))
    grid = drawing.grid
    findings.extend(_findings_on_floor(drawing, loaded, footprint))
    drawn = Map(
        name=folder.resolve().name,
        grid=grid,
        rooms=tuple(sorted((_room(entry) for entry in loaded.value.rooms), key=lambda entry: entry.room)),
        starts=tuple(start for _, start in _starts(loaded.value.starts)),
        costs=own_costs,
        language=loaded.value.language,
        words=_read_words(folder, [entry.name for entry in loaded.value.rooms], findings),
    )
    return MapCheck(drawn, tuple(findings))


def _read_words(folder: Path, names: Sequence[str], findings: list[MapFinding]) -> dict[str, Mapping[str, str]]:
    """Read the names of rooms in further languages. A name without a room may belong to a room that was renamed."""
    words: dict[str, Mapping[str, str]] = {}
    for language in languages_beside(folder, (WORDS,)):
        path = folder / language / WORDS
        loaded = _attempt(partial(load, path, _RoomWords), findings)
        if loaded is None:
            continue
        words[language] = loaded.value.rooms
        for name, said in loaded.value.rooms.items():
            if name not in names:
                fault = loaded.fault(f"rooms.{name}", f"no room has the name {name!r}", nearest(name, names))
                findings.append(MapFinding("warning", fault))
            elif not said.strip():
                fault = loaded.fault(f"rooms.{name}", "the name is empty", "Write the name in this language")
                findings.append(MapFinding("error", fault))
    return words


def missing_room_names(place: Map, folder: Path, language: str) -> Iterator[BadFile]:
    """Yield a fault if a map is in another language, and some of its rooms have no name in this language.

    Args:
        place: the map.
        folder: folder of the map.
        language: name of the language.
    """
    words = place.words.get(language, {})
    unnamed = [name for name in place.room_names.named.values() if name not in words]
    if place.language not in {None, language} and unnamed:
        problem = f"the map is in {place.language}, but these rooms have no name in {language}: {', '.join(unnamed)}"
        yield BadFile(folder / language / WORDS, problem, "Write the names under rooms", key="rooms")


def _attempt(read: Callable[[], T], findings: list[MapFinding]) -> T | None:
    try:
        return read()
    except BadFiles as error:
        findings.extend(MapFinding("error", fault) for fault in error.faults)
    except BadFile as error:
        findings.append(MapFinding("error", error))
    return None


def _findings_of_costs(path: Path, rooms: int | None) -> Iterator[MapFinding]:
    findings: list[MapFinding] = []
    matrix = _attempt(lambda: read_map_times(path), findings)
    yield from findings
    if matrix is not None and rooms is not None and len(matrix.rooms) != rooms:
        problem = f"costs for {len(matrix.rooms)} rooms, but rooms.yaml has {rooms}"
        remedy = "Write one row and one column for the corridor and for every room, or measure the map again"
        yield MapFinding("error", BadFile(path, problem, remedy, line=1))


def _room(entry: _RoomEntry) -> MapRoom:
    region: Polygon = entry.region
    if len(region) == 2:
        (x0, y0), (x1, y1) = region
        region = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    return MapRoom(Room(entry.number), entry.name, region, pose_of(*entry.goal))


def _starts(entry: _StartsEntry) -> Iterator[tuple[str, Pose2]]:
    """Yield the key path and pose of every start: first the poses, then the rows, each row from its first end.

    Rows that are too long are left out.
    """
    for index, (x, y, yaw) in enumerate(entry.poses):
        yield f"starts.poses[{index}]", pose_of(x, y, yaw)
    for index, ((x0, y0), (x1, y1)) in enumerate(entry.rows):
        length = elementary.hypot(x1 - x0, y1 - y0)
        if length > MOST_STARTS * entry.spacing:
            continue
        for step in range(math.floor(length / entry.spacing + 1e-9) + 1):
            share = step * entry.spacing / length if length else 0.0
            yield f"starts.rows[{index}]", Pose2(x0 + share * (x1 - x0), y0 + share * (y1 - y0), wrap_angle(entry.yaw))


def _faults_of_rooms(loaded: Loaded[_RoomsYaml]) -> Iterator[BadFile]:
    """Yield faults that can be found without the grid, in numbers, names and shapes."""
    rooms = loaded.value.rooms
    if not rooms:
        yield loaded.fault("rooms", "the map has no rooms", "Add at least one room")
    by_number: dict[int, int] = {}
    by_name: dict[str, int] = {}
    for index, entry in enumerate(rooms):
        key = f"rooms[{index}]"
        line = loaded.lines[key]
        if entry.number in by_number:
            problem = f"room {entry.number} is defined twice, first in line {by_number[entry.number]}"
            yield loaded.fault(f"{key}.number", problem, "Give every room its own number")
        if entry.name in by_name:
            problem = f"{entry.name!r} is also the name of the room in line {by_name[entry.name]}"
            yield loaded.fault(f"{key}.name", problem, "Give every room its own name")
        by_number.setdefault(entry.number, line)
        by_name.setdefault(entry.name, line)
        room = _room(entry)
        if len(entry.region) < 2 or area(room.region) < LEAST_FLOOR:
            remedy = "Write two opposite corners of a box, or three or more corners in order"
            yield loaded.fault(f"{key}.region", "these corners enclose no area", remedy)
        elif crosses_itself(room.region):
            remedy = "Write the corners in order around the room"
            yield loaded.fault(f"{key}.region", "the sides of the region cross each other", remedy)
        elif not room.holds(room.goal.x, room.goal.y):
            problem = f"({room.goal.x:g}, {room.goal.y:g}) is not in the room's region"
            yield loaded.fault(f"{key}.goal", problem, "Move the goal into the region, or correct the region")
    gaps = sorted(set(range(1, len(by_number) + 1)) - set(by_number))
    if gaps:
        problem = f"no room has the number {gaps[0]}, but there is a room {max(by_number)}"
        yield loaded.fault("rooms", problem, f"Number the {len(by_number)} rooms 1 to {len(by_number)}")
    starts = loaded.value.starts
    for index, (first, last) in enumerate(starts.rows):
        if elementary.hypot(last[0] - first[0], last[1] - first[1]) > MOST_STARTS * starts.spacing:
            problem = f"more than {MOST_STARTS} starts in a row"
            yield loaded.fault(f"starts.rows[{index}]", problem, "Shorten the row, or increase starts.spacing")
    if not starts.poses and not starts.rows:
        yield loaded.fault("starts", "the map has no start poses", "Add at least one pose to starts.poses")


@dataclass(frozen=True, slots=True)
class _Place:
    """A goal or a start, at which a robot must be able to stand, with its key in the file."""

    key: str
    pose: Pose2
    what: str


def _findings_on_floor(image: GridFile, loaded: Loaded[_RoomsYaml], footprint: Polygon) -> Iterator[MapFinding]:
    """Yield faults found with the grid: robots too close to walls or each other, overlapping rooms, missing paths."""
    rooms = [_room(entry) for entry in loaded.value.rooms]
    goals = [_Place(f"rooms[{index}].goal", room.goal, str(room.room)) for index, room in enumerate(rooms)]
    starts = [
        _Place(key, pose, f"the start of robot {number}")
        for number, (key, pose) in enumerate(_starts(loaded.value.starts), start=1)
    ]
    floor = TraversabilityMap.of(image.grid, *radii(np.array(footprint)))
    yield from _findings_of_regions(loaded, floor)
    doubtful = _doubt_of_image(image, floor, goals + starts)
    if doubtful is not None:
        yield MapFinding("error", doubtful)
        return
    yield from _too_narrow(loaded, floor, goals + starts)
    close = list(_too_close(loaded, floor, starts))
    yield from close
    for start in starts:
        room = next((room.room for room in rooms if room.holds(start.pose.x, start.pose.y)), None)
        if room is not None:
            fault = loaded.fault(start.key, f"{start.what} is in {room}", "Start robots in a corridor")
            yield MapFinding("warning", fault)
    yield from _findings_of_ways(loaded, floor, goals, starts, crowded=not close)


def _doubt_of_image(image: GridFile, floor: TraversabilityMap, places: list[_Place]) -> BadFile | None:
    """Return a fault of the image if most places are off its floor, because then the image is probably wrong."""
    grid = floor.grid
    values = [grid.value_at(place.pose.x, place.pose.y) for place in places]
    amiss = sum(value != FREE for value in values)
    if amiss < 3 or amiss < MOST_AMISS * len(places):
        return None
    on_map = sum(grid.contains(*grid.cell_of(place.pose.x, place.pose.y)) for place in places)  # of integers
    if 2 * on_map < len(places):
        problem = f"{len(places) - on_map} of {len(places)} goals and starts lie outside the image"
        return image.yaml.fault("origin", problem, "Correct the origin or the resolution")
    problem = f"{amiss} of {len(places)} goals and starts are in walls or in unknown space"
    other = 1 - image.yaml.value.negate
    remedy = f"If the image is inverted, write `negate: {other}`; if not, correct the origin or the resolution"
    return image.yaml.fault("negate", problem, remedy)


def _has_room(floor: TraversabilityMap, place: _Place) -> bool:
    """Return True if a robot at this place can turn on the spot."""
    return floor.clearance_at(place.pose) > floor.circumscribed


def _too_narrow(loaded: Loaded[_RoomsYaml], floor: TraversabilityMap, places: list[_Place]) -> Iterator[MapFinding]:
    for place in places:
        clearance = floor.clearance_at(place.pose)
        if not _has_room(floor, place):
            problem = (
                f"at ({place.pose.x:g}, {place.pose.y:g}) the nearest cell that is not free is {clearance:.2f} m away; "
                f"a robot needs more than {floor.circumscribed:.2f} m to turn"
            )
            yield MapFinding("error", loaded.fault(place.key, problem, "Move this pose away from the wall"))


def _too_close(loaded: Loaded[_RoomsYaml], floor: TraversabilityMap, starts: list[_Place]) -> Iterator[MapFinding]:
    for second, start in enumerate(starts):
        for other in starts[:second]:
            distance = start.pose.distance(other.pose)
            if distance <= 2 * floor.circumscribed:
                problem = (
                    f"{start.what} is {distance:.2f} m from {other.what}; "
                    f"robots need more than {2 * floor.circumscribed:.2f} m"
                )
                yield MapFinding(
                    "error", loaded.fault(start.key, problem, "Move one of the two, or increase starts.spacing")
                )


def _findings_of_regions(loaded: Loaded[_RoomsYaml], floor: TraversabilityMap) -> Iterator[MapFinding]:
    grid = floor.grid
    slack = grid.resolution / 2
    width, height = grid.cols * grid.resolution, grid.rows * grid.resolution
    owner = np.zeros(grid.cells.shape, dtype=np.int16)
    for index, entry in enumerate(loaded.value.rooms):
        if len(entry.region) < 2:
            continue
        key, room = f"rooms[{index}].region", _room(entry)
        corners = grid.origin.inverse().transform(np.array(room.region))
        outside = (corners < -slack).any(axis=1) | (corners > np.array([width, height]) + slack).any(axis=1)
        if outside.any():
            x, y = room.region[int(outside.argmax())]
            problem = f"the corner ({x:g}, {y:g}) is outside the map, which is {width:g} m x {height:g} m"
            yield MapFinding("error", loaded.fault(key, problem, "Correct the region, or the origin or resolution"))
        box, held = floor.held_by(room.region)
        own = owner[box]
        shared = own[held & (own > 0)]
        if shared.size:
            area = shared.size * grid.resolution * grid.resolution
            problem = f"this region overlaps the region of room {shared[0]} by {area:.2f} m^2"
            yield MapFinding("error", loaded.fault(key, problem, "Move the regions apart"))
        own[held] = entry.number


def _findings_of_ways(
    loaded: Loaded[_RoomsYaml], floor: TraversabilityMap, goals: list[_Place], starts: list[_Place], crowded: bool
) -> Iterator[MapFinding]:
    """Yield faults of goals and starts at which a robot can stand, but which no path from a start reaches.

    Args:
        loaded: rooms.yaml.
        floor: floor for the robot's footprint.
        goals: goals of all rooms.
        starts: starts of all robots.
        crowded: True to look for starts that are enclosed when all robots stand at their starts.
    """
    goals = [place for place in goals if _has_room(floor, place)]
    standing = [place for place in starts if _has_room(floor, place)]
    if not standing:
        return
    first = standing[0]
    reach = floor.reachable(first.pose)
    cut_off = [place for place in goals + standing if not reach[floor.grid.cell_of(place.pose.x, place.pose.y)]]
    for place in cut_off:
        problem = f"no path that is {2 * floor.inscribed:g} m wide leads from {first.what} to {place.what}"
        yield MapFinding("error", loaded.fault(place.key, problem, "Widen a door, or move this pose"))
    if cut_off or not crowded or standing != starts:
        return
    crowded_floor = CrowdedFloor(floor, [start.pose for start in starts])
    cells = [floor.grid.cell_of(goal.pose.x, goal.pose.y) for goal in goals]
    for robot, start in enumerate(starts):
        ways = zip(goals, crowded_floor.reached(robot, cells), strict=True)
        blocked = next((goal.what for goal, reached in ways if not reached), None)
        if blocked is not None:
            problem = f"with {len(starts)} robots at their starts no path leads from {start.what} to {blocked}"
            yield MapFinding("warning", loaded.fault(start.key, problem, "Leave a free lane between the starts"))
