"""Steps of `thbridge maps new`."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from sim.common.geometry import IDENTITY
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, interpret_image
from sim.common.traversability import Mask
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.costmap.footprint import radii
from thbridge.files.disk.whole import new_folder, write_whole
from thbridge.files.errors import BadFile
from thbridge.files.grid_files import FREE_THRESH, OCCUPIED_THRESH, unseen_walls, write_grid
from thbridge.files.image_files import read_image
from thbridge.files.map_files import FOOTPRINT, Map, check_map, write_rooms
from thbridge.files.map_times import MAP_TIMES, map_times
from thbridge.files.progress import Tell
from thbridge.hunt.rooms import Room
from thbridge.offline.arena import Arena, arena_of
from thbridge.offline.drawings import (
    CleanedDrawing,
    blocked_paths,
    closed_to_outside,
    joined,
    reached_floor,
    squared,
    turned,
    without_thin_lines,
)
from thbridge.offline.measure import MeasurementSetup, TripTimes
from thbridge.offline.room_finding import find_rooms
from ui.command_line.grids import grid_at
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, command, fail, note, say
from ui.commands.maps.trips import measure_trips, times_matrix, write_times

SEED = 1
LEFT_OUT = "left-out.pgm"
"""Image next to map.yaml: black where lines of the plan were removed, white elsewhere."""
MOST_FLOOR = 0.5
"""Minimum share of the floor that must be reachable, unless the user says that thin lines are walls."""
MOST_INK = 0.5
"""If more than this share of a plan's drawn area is removed, the removed lines probably include walls."""
MOST_PLACES = 4
"""Maximum number of blocked paths that a message names."""
LEAST_CELL, LARGEST_CELL = 0.001, 0.5
"""Minimum and maximum size of a cell, meters; a map with larger cells cannot show doors."""
MOST_STRETCH = 10.0
"""Ratio of an image's two scales. If the ratio is greater, one of the scales is probably a typing error."""
FINE, FINE_ENOUGH = 0.01, 0.02
"""Sizes in meters. Pixels smaller than the first size are merged into cells of at most the second size."""
MOST_CELLS, COARSE_ENOUGH = 4_000_000, 0.05
"""If an image has more pixels than the first number, they are merged into cells of at most the second size, meters."""
MANY = 15
"""Minimum number of rooms for which the command prints that the measurement can be stopped and continued."""
WIDEST = 300.0
"""Size in meters. The size of a larger map is probably wrong."""


@dataclass(frozen=True, slots=True)
class PaperSize:
    """Size of an image without a map.yaml, from the options of the command.

    Attributes:
        resolution: meters per pixel; if None, computed from `width`.
        width: width of the whole image, meters; if None, computed from `resolution`.
        height: height of the whole image, meters; if None, pixels are square.
        turn: angle by which the image is turned counterclockwise, degrees.
    """

    resolution: float | None = None
    width: float | None = None
    height: float | None = None
    turn: float = 0.0

    @property
    def given(self) -> str | None:
        """Return the name of the first of these options that the user gave."""
        return next((f"--{each.name}" for each in fields(self) if getattr(self, each.name) not in {None, 0.0}), None)


def read_drawing(source: Path, size: PaperSize, negate: bool) -> OccupancyGrid:
    """Return the grid of a map.yaml, or of an image with its size.

    Raises:
        BadFile: the file cannot be read.
    """
    if is_map_file(source):
        if (option := size.given or ("--negate" if negate else None)) is not None:
            fail(BAD_INPUT, f"{option}: {source} already contains this setting. Omit the option, or change the file.")
        grid = grid_at(source)
        decided = np.isin(grid.cells, (FREE, OCCUPIED))
        return OccupancyGrid(np.where(decided, grid.cells, UNKNOWN), grid.resolution, grid.origin)
    if not source.is_file():
        raise BadFile(source, "there is no such file", "Name a map.yaml or an image")
    pixels = read_image(source)
    rows, cols = pixels.shape[:2]
    resolution = size.resolution if size.width is None else size.width / cols
    if resolution is None:
        remedy = (
            "Write the width of the whole image in meters with --width, or the meters per pixel with --resolution. "
            f"With --resolution 0.05, this image is {cols * 0.05:.1f} m x {rows * 0.05:.1f} m"
        )
        raise BadFile(source, "the size of the image in meters is not known", remedy)
    if pixels.ndim == 3:
        colours = pixels[..., :3].mean(axis=2)
        # Transparent pixels count as white paper.
        opaque = pixels[..., 3] / 255.0 if pixels.shape[2] == 4 else 1.0
        pixels = np.rint(colours * opaque + 255.0 * (1.0 - opaque)).astype(np.uint8)
    if not LEAST_CELL <= resolution <= LARGEST_CELL:
        message = f"a pixel would be {resolution:g} m wide, which is not within {LEAST_CELL} to {LARGEST_CELL} m"
        fail(BAD_INPUT, f"--width: {message}. Write the width of the whole image in meters.")
    if size.height is not None:
        across = size.height / rows
        if not 1.0 / MOST_STRETCH <= across / resolution <= MOST_STRETCH:
            message = f"a pixel would be {across:g} m high and {resolution:g} m wide"
            fail(BAD_INPUT, f"--height: {message}. Write the height of the whole image in meters.")
        pixels = squared(pixels, size.height / rows / resolution)
    if size.turn:
        pixels = turned(pixels, size.turn)
    factor = _joined_pixels(pixels.size, resolution)
    if factor > 1:
        pixels = joined(pixels, factor)
        note(
            f"A pixel is only {resolution:g} m wide, so {factor} x {factor} pixels are merged into one cell "
            f"of {factor * resolution:g} m. The option --thinner counts cells."
        )
    cells = interpret_image(pixels, negate, OCCUPIED_THRESH, FREE_THRESH)
    if (doubt := unseen_walls(cells, pixels, negate)) is not None:
        remedy = (
            f"Write a map.yaml next to it: `image: {source.name}`, `resolution: {resolution:g}`, `origin: [0, 0, 0]`, "
            f"`negate: {int(negate)}`, `occupied_thresh: {doubt.occupied_thresh}` and `free_thresh: "
            f"{doubt.free_thresh}`, and use that file"
        )
        raise BadFile(source, doubt.problem, remedy)
    return OccupancyGrid(cells, factor * resolution, IDENTITY)


def _joined_pixels(count: int, resolution: float) -> int:
    """Return the number of pixels per side to merge into one cell, so that finding rooms takes only seconds."""
    largest = FINE_ENOUGH if resolution < FINE else COARSE_ENOUGH if count > MOST_CELLS else resolution
    return max(int(largest / resolution + 1e-9), 1)


def cleaned(source: Path, grid: OccupancyGrid, thinner: int | None) -> CleanedDrawing:
    """Return the plan without lines thinner than `thinner` pixels. If it is 0 or None, keep all lines.

    If it is None and thin lines block most of the floor, end the command. Close the openings of the building to the
    outside, except in a map.yaml whose lines are all kept, because a robot has probably made this map.
    """
    inscribed = radii(np.array(FOOTPRINT))[0]
    if thinner:
        drawing = without_thin_lines(grid, thinner)
        say(f"Removed: lines and letters thinner than {thinner} pixels, {drawing.left_out.mean():.1%} of the image")
        _note_lost_walls(grid, drawing, thinner, inscribed)
        _note_closed_floor(drawing.grid, inscribed, "Try another value of --thinner")
        return _closed(drawing, inscribed)
    closed = blocked_paths(grid, inscribed) if thinner is None else None
    if closed is not None:
        places = _listed([f"({x:.1f}, {y:.1f})" for x, y in closed.places])
        message = (
            f"{source}: only {closed.reached:.0%} of the floor is reachable. Lines thinner than {closed.thinner} "
            f"pixels block paths at {places}. If they are doors, "
            f"furniture or letters, remove them with --thinner {closed.thinner}; if they are walls, keep them with "
            "--thinner 0."
        )
        if closed.reached < MOST_FLOOR:
            fail(FAILED, message)
        note(message)
    else:
        _note_closed_floor(grid, inscribed, None)
    drawing = CleanedDrawing(grid, np.zeros(grid.cells.shape, dtype=np.bool_))
    return drawing if is_map_file(source) else _closed(drawing, inscribed)


def is_map_file(source: Path) -> bool:
    """Return True for a map.yaml, False for an image."""
    return source.suffix.lower() in {".yaml", ".yml"}


def _closed(drawing: CleanedDrawing, inscribed: float) -> CleanedDrawing:
    """Return the plan with its openings to the outside closed, and print the places of the openings."""
    grid, openings = closed_to_outside(drawing.grid, inscribed)
    if openings:
        places = _listed([f"({x:.1f}, {y:.1f})" for x, y in openings])
        say(f"Closed: openings to the outside, such as entrances and windows, at {places}, so that robots stay inside")
    return CleanedDrawing(grid, drawing.left_out)


def _listed(places: Sequence[str]) -> str:
    more = len(places) - MOST_PLACES
    return f"{', '.join(places[:MOST_PLACES])}{f' and {more} more places' if more > 0 else ''}"


def _note_lost_walls(grid: OccupancyGrid, drawing: CleanedDrawing, thinner: int, inscribed: float) -> None:
    """Print a warning if walls were probably removed, and suggest a value of --thinner that keeps the walls."""
    share = float(drawing.left_out.sum() / max(np.count_nonzero(grid.cells != FREE), 1))
    if share > MOST_INK:
        closed = blocked_paths(grid, inscribed)
        better = "a smaller number" if closed is None or closed.thinner == thinner else f"--thinner {closed.thinner}"
        note(f"This is {share:.0%} of the drawn area, so walls were probably removed. Use {better}.")


def _note_closed_floor(grid: OccupancyGrid, inscribed: float, remedy: str | None) -> None:
    """Print a warning if most of the floor is unreachable.

    If `remedy` is given, also print a warning if a room is unreachable.
    """
    reached, others = reached_floor(grid, inscribed)
    if 0.0 < reached < MOST_FLOOR:
        message = f"Only {reached:.0%} of the floor is reachable"
        remedy = remedy or "If lines, furniture or letters close doors, use --thinner"
    elif others and remedy is not None:
        places = _listed([f"({x:.1f}, {y:.1f}), {area:.1f} m²" for (x, y), area in others])
        message = f"Parts of the floor are not reachable, at {places}"
    else:
        return
    note(
        f"{message}: doors may be closed, or narrower than a robot. {remedy}. Otherwise use an image with more pixels, "
        "or open the doors in the image."
    )


def find_arena(grid: OccupancyGrid, rooms: int | None, robots: int, names: Sequence[str]) -> Arena:
    """Find rooms and start poses, and print them."""
    found = find_rooms(grid, *radii(np.array(FOOTPRINT)), wanted=rooms)
    arena = arena_of(grid, found, robots, names)
    names_found = ", ".join(f"{entry.room.people} {entry.name}" for entry in arena.rooms)
    wanted = "" if rooms is None or rooms == len(arena.rooms) else f" ({rooms} requested)"
    say(f"Rooms: {len(arena.rooms)} found{wanted}{': ' if names_found else ''}{names_found}")
    say(f"Start poses: {len(arena.starts)}{'' if len(arena.starts) == robots else f' of {robots} (no space for more)'}")
    return arena


def require_rooms(arena: Arena, grid: OccupancyGrid, source: Path, *, negated: bool) -> None:
    """End the command if there are no rooms or start poses, and print possible reasons."""
    if arena.rooms and arena.starts:
        return
    free, occupied = float((grid.cells == FREE).mean()), float((grid.cells == OCCUPIED).mean())
    seen = f"{free:.0%} of the image is free, {occupied:.0%} occupied, {1 - free - occupied:.0%} unknown"
    inverted = (
        "--negate is for bright walls and a dark floor: if walls are dark, omit it. "
        if negated
        else "If walls are bright and the floor is dark, the image is inverted: use --negate, or `negate: 1` in its "
        "map.yaml. "
    )
    remedy = f"{inverted}If rooms are too small for robots, correct the resolution. Otherwise draw rooms with --draw"
    fail(FAILED, f"{source}: no rooms were found; {seen}. {remedy}.")


def note_size(grid: OccupancyGrid) -> None:
    """Print the size of a map, and a warning if it is probably wrong."""
    width, height = grid.cols * grid.resolution, grid.rows * grid.resolution
    say(f"Map: {width:.1f} m x {height:.1f} m, {grid.cols} x {grid.rows} cells of {grid.resolution:g} m")
    if max(width, height) > WIDEST:
        door = 1.0 / grid.resolution
        note(
            f"This map is very large: a door of 1 m would be {door:.1f} pixels wide. Check the resolution, or use "
            "--width METERS."
        )


def read_left_out(folder: Path, grid: OccupancyGrid) -> Mask | None:
    """Return the cells that were removed from the plan of a map; None if the map has no file `LEFT_OUT`.

    Raises:
        BadFile: the file cannot be read.
    """
    path = folder / LEFT_OUT
    pixels = read_image(path) if path.is_file() else None
    return None if pixels is None or pixels.shape != grid.cells.shape else pixels[::-1] == 0


def write_map(folder: Path, drawing: CleanedDrawing, arena: Arena) -> None:
    """Write the folder of a map.

    Raises:
        BadFile: the folder cannot be written.
    """
    if folder.exists():
        # The person may save several times in the window.
        write_rooms(folder, arena.rooms, arena.starts)
    else:
        with new_folder(folder, "choose another place with --to") as new:
            write_grid(new, drawing.grid)
            if drawing.left_out.any():
                header = f"P5\n{drawing.grid.cols} {drawing.grid.rows}\n255\n".encode("ascii")
                shades = np.where(drawing.left_out[::-1], 0, 255).astype(np.uint8)
                write_whole(new / LEFT_OUT, header + shades.tobytes())
            write_rooms(new, arena.rooms, arena.starts)
    say(f"Wrote {folder}: map.yaml, map.pgm, rooms.yaml")


def check_written(folder: Path) -> None:
    """Check the written map, and print the findings; end the command if no game can be played on it."""
    check = check_map(folder)
    for finding in check.findings:
        say(f"{finding.severity}: {finding.fault}")
    say(f"Checked: {len(check.errors)} errors, {len(check.findings) - len(check.errors)} warnings")
    if check.errors:
        remedy = f"Correct rooms.yaml, or draw the rooms with `{command('maps', 'edit', folder)}`"
        fail(BAD_INPUT, f"{folder}: no game can be played on this map. {remedy}.")


def same_trips(one: Arena, other: Arena) -> bool:
    """Return True if two versions of a map have the same start poses and, in each room, the same goal pose."""
    return one.starts == other.starts and [room.goal for room in one.rooms] == [room.goal for room in other.rooms]


def measure_map(folder: Path, place: Map, runs: int, jobs: int, tell: Tell) -> bool:
    """Measure all trips and write `mapTimes`; return True if each room was reached from every other place.

    `tell` receives the progress.
    """
    count = len(place.rooms)
    again = command("maps", "measure", folder, "--runs", runs, "--out", folder / MAP_TIMES)
    message = f"Measuring {runs * count * count} trips on {jobs} cores. To skip the measurement, use --no-times."
    note(message if count < MANY else f"{message} You can stop the measurement, and continue it with `{again}`.")
    course = MeasurementSetup(place, WorldParameters(), RobotParameters(), SEED)
    with bad_input():
        times = measure_trips(course, runs, jobs, folder / MAP_TIMES, tell, f"`{again}`")
        write_times(folder / MAP_TIMES, map_times(times_matrix(times, count)))
    means = [pair.mean for pair in times if pair.mean is not None]
    span = f"{min(means):.0f} s to {max(means):.0f} s per trip" if means else "no trip arrived"
    say(f"Measured: {len(means)} of {len(times)} paths, {span}; wrote {folder / MAP_TIMES}")
    if len(means) < len(times):
        note(unreached_words(times, folder))
    return len(means) == len(times)


def unreached_words(times: Sequence[TripTimes], folder: Path) -> str:
    """Return sentences about the paths that no trip completed: their rooms, the main reason, and remedies."""
    failed = [pair for pair in times if pair.mean is None]
    ends = Counter(place for pair in failed for place in (pair.start, pair.goal) if not place.is_corridor)
    rooms = ", ".join(
        f"room {room.people} ({count} paths)" for room, count in sorted(ends.items(), key=_most_first)[:3]
    )
    reason = Counter(refusal for pair in failed for refusal in pair.refusals).most_common(1)[0][0]
    return (
        f"{len(failed)} of {len(times)} paths were not completed, so games do not allow these moves (99 in mapTimes). "
        f"Main reason: {reason}. Most of these paths begin or end in {rooms}. Remove obstacles there in the image, "
        f"delete rooms with `{command('maps', 'edit', folder)}`, or play without these moves."
    )


def _most_first(counted: tuple[Room, int]) -> tuple[int, int]:
    return -counted[1], counted[0].people
