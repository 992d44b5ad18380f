"""The steps of `thbridge maps new`."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sim.common.geometry import IDENTITY
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, interpret_image
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.costmap.footprint import radii
from thbridge.files.disk.whole import new_folder, write_whole
from thbridge.files.errors import BadFile
from thbridge.files.grid_files import FREE_THRESH, OCCUPIED_THRESH, write_grid
from thbridge.files.image_files import read_image
from thbridge.files.map_files import FOOTPRINT, Map, check_map, write_rooms
from thbridge.files.map_times import MAP_TIMES, map_times
from thbridge.hunt.rooms import Room
from thbridge.offline.arena import Arena, arena_of
from thbridge.offline.measure import MeasurementSetup, TripTimes
from thbridge.offline.room_finding import find_rooms
from ui.actions.maps.measure import measure_trips, times_matrix
from ui.grids import grid_at
from ui.terminal import BAD_INPUT, FAILED, bad_input, command, fail, note, say

SEED = 1


def read_drawing(source: Path, resolution: float | None, negate: bool) -> OccupancyGrid:
    """The grid of a map.yaml, or of a bare image with the size of its cells.

    Raises:
        BadFile: it cannot be read.
    """
    if source.suffix.lower() in {".yaml", ".yml"}:
        if resolution is not None or negate:
            option = "--negate" if resolution is None else "--resolution"
            fail(BAD_INPUT, f"{option}: {source} says that itself. Leave the option out, or change the file.")
        grid = grid_at(source)
        decided = np.isin(grid.cells, (FREE, OCCUPIED))
        return OccupancyGrid(np.where(decided, grid.cells, UNKNOWN), grid.resolution, grid.origin)
    if not source.is_file():
        raise BadFile(source, "there is no such file", "Give a map.yaml or an image")
    pixels = read_image(source)
    if resolution is None:
        rows, cols = pixels.shape[:2]
        remedy = (
            "Say by --resolution how many metres a pixel is: the length of a wall in metres, divided by its pixels; "
            f"with 0.05 this image is {cols * 0.05:.1f} m x {rows * 0.05:.1f} m"
        )
        raise BadFile(source, "an image does not say how large it is", remedy)
    if pixels.ndim == 3:
        colours = pixels[..., :3].mean(axis=2)
        # What is transparent is white paper.
        opaque = pixels[..., 3] / 255.0 if pixels.shape[2] == 4 else 1.0
        pixels = np.rint(colours * opaque + 255.0 * (1.0 - opaque)).astype(np.uint8)
    return OccupancyGrid(interpret_image(pixels, negate, OCCUPIED_THRESH, FREE_THRESH), resolution, IDENTITY)


def find_arena(grid: OccupancyGrid, rooms: int | None, robots: int, names: Sequence[str]) -> Arena:
    """Find rooms and start poses, and tell them."""
    found = find_rooms(grid, *radii(np.array(FOOTPRINT)), wanted=rooms)
    arena = arena_of(grid, found, robots, names)
    told = ", ".join(f"{entry.room.people} {entry.name}" for entry in arena.rooms)
    wanted = "" if rooms is None or rooms == len(arena.rooms) else f" of {rooms} wanted"
    say(f"Rooms: {len(arena.rooms)}{wanted} found{': ' if told else ''}{told}")
    say(f"Start poses: {len(arena.starts)}{'' if len(arena.starts) == robots else f' of {robots}: no more have room'}")
    return arena


def require_rooms(arena: Arena, grid: OccupancyGrid, source: Path, *, negated: bool) -> None:
    """End the command where there is nothing to play in, and tell why that may be."""
    if arena.rooms and arena.starts:
        return
    free, occupied = float((grid.cells == FREE).mean()), float((grid.cells == OCCUPIED).mean())
    seen = f"{free:.0%} of the image is free, {occupied:.0%} occupied, {1 - free - occupied:.0%} unknown"
    inverted = (
        "--negate is for bright walls and dark floor: if walls are dark, leave it out. "
        if negated
        else "If walls are bright and floor is dark, the image is inverted: give --negate, or `negate: 1` in its "
        "map.yaml. "
    )
    remedy = f"{inverted}If rooms are there but too small, the resolution is wrong. Else draw the rooms by --draw"
    fail(FAILED, f"{source}: no rooms were found; {seen}. {remedy}.")


def write_map(folder: Path, grid: OccupancyGrid, arena: Arena) -> None:
    """Write the folder.

    Raises:
        BadFile: it cannot be written.
    """
    if folder.exists():
        # The window saves again.
        write_rooms(folder, arena.rooms, arena.starts)
    else:
        with new_folder(folder, "choose another place by --to") as new:
            write_grid(new, grid)
            write_rooms(new, arena.rooms, arena.starts)
    say(f"Wrote {folder}: map.yaml, map.pgm, rooms.yaml")


def check_written(folder: Path) -> None:
    """Check what was written, and tell; end the command where no game can be played on it."""
    check = check_map(folder)
    for finding in check.findings:
        say(f"{finding.severity}: {finding.fault}")
    say(f"Checked: {len(check.errors)} errors, {len(check.findings) - len(check.errors)} warnings")
    if check.errors:
        fail(BAD_INPUT, f"{folder}: mend rooms.yaml, or draw the rooms by `{command('maps', 'edit', folder)}`.")


def same_trips(one: Arena, other: Arena) -> bool:
    """Return True when trips on two drawings of a map begin and end at the same poses, room by room."""
    return one.starts == other.starts and [room.goal for room in one.rooms] == [room.goal for room in other.rooms]


def measure_map(folder: Path, place: Map, runs: int, jobs: int) -> bool:
    """Measure all trips and write `mapTimes`; return True when every room was reached from everywhere."""
    count = len(place.rooms)
    note(f"Measuring {runs * count * count} trips on {jobs} cores; without times: --no-times.")
    course = MeasurementSetup(place, WorldParameters(), RobotParameters(), SEED)
    times = measure_trips(course, runs, jobs)
    with bad_input():
        write_whole(folder / MAP_TIMES, map_times(times_matrix(times, count)).encode("ascii"), "make room")
    means = [pair.mean for pair in times if pair.mean is not None]
    span = f"{min(means):.0f} s to {max(means):.0f} s a trip" if means else "no trip arrived"
    say(f"Measured: {len(means)} of {len(times)} ways, {span}; wrote {folder / MAP_TIMES}")
    if len(means) < len(times):
        note(unreached_words(times, folder))
    return len(means) == len(times)


def unreached_words(times: Sequence[TripTimes], folder: Path) -> str:
    """A sentence about ways that were not driven to the end: where, why, and what to do."""
    failed = [pair for pair in times if pair.mean is None]
    ends = Counter(place for pair in failed for place in (pair.start, pair.goal) if not place.is_corridor)
    rooms = ", ".join(f"room {room.people} ({count} ways)" for room, count in sorted(ends.items(), key=_most_first)[:3])
    reason = Counter(refusal for pair in failed for refusal in pair.refusals).most_common(1)[0][0]
    return (
        f"{len(failed)} of {len(times)} ways were not driven to the end and are no moves (99); mostly: {reason}. "
        f"Most begin or end in {rooms}. Clear the way there in the image, "
        f"delete rooms by `{command('maps', 'edit', folder)}`, or play without these moves."
    )


def _most_first(counted: tuple[Room, int]) -> tuple[int, int]:
    return -counted[1], counted[0].people
