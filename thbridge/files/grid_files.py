"""Occupancy grids in files: `map.yaml` and its image, in the format of map_server and map_saver."""

import math
import re
from dataclasses import dataclass, field, fields, replace
from difflib import get_close_matches
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, Cells, MapMode, OccupancyGrid, interpret_image
from sim.numerics.elementary import wrap_angle
from thbridge.files.disk.inside import fault_of_path
from thbridge.files.disk.regular_files import as_on_disk, is_regular
from thbridge.files.disk.text_files import read_text
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile
from thbridge.files.image_files import read_image
from thbridge.files.yaml.load import Loaded, load_tree
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section, parse

GREY_OF_CELL = {FREE: 254, OCCUPIED: 0, UNKNOWN: 205}
"""Gray values of cells, as map_saver writes them."""
UNKNOWN_GREY = GREY_OF_CELL[UNKNOWN]
OCCUPIED_THRESH = 0.65
FREE_THRESH = 0.196

LEAST_WALL = 0.05
"""Minimum share of occupied cells along the edge of the floor. If it is less, walls probably have another shade."""
TINTED, LARGE_SHARE = 0.02, 0.05
"""Minimum darkness of a floor that counts as tinted, and minimum share of the image that counts as a large area."""

POSE = {"unit": "m, m, rad"}
"""Declaration of a field with x, y, yaw."""


@dataclass(frozen=True, slots=True)
class _MapYaml:
    image: str
    resolution: float = field(metadata={"unit": "m", "minimum": 0.001, "maximum": 10})
    origin: tuple[float, float, float] = field(metadata=POSE)
    negate: int = field(metadata={"minimum": 0, "maximum": 1})
    occupied_thresh: float = field(metadata={"minimum": 0, "maximum": 1})
    free_thresh: float = field(metadata={"minimum": 0, "maximum": 1})
    mode: MapMode = "trinary"


@dataclass(frozen=True, slots=True)
class GridFile:
    """A `map.yaml`, and the occupancy grid that map_server makes from it."""

    yaml: Loaded[_MapYaml]
    grid: OccupancyGrid

    @property
    def doubts(self) -> tuple[BadFile, ...]:
        """Oddities of the file that map_server accepts."""
        return self.yaml.doubts


@dataclass(frozen=True, slots=True)
class UnseenWalls:
    """A map with a floor that ends at unknown cells. No laser sees these cells, so robots get lost.

    Attributes:
        problem: the problem in words.
        occupied_thresh: a threshold that makes the surroundings of the floor occupied.
        free_thresh: a threshold that excludes large areas from the floor if they are not quite white.
    """

    problem: str
    occupied_thresh: float
    free_thresh: float


def unseen_walls(cells: Cells, pixels: NDArray[np.uint8], negate: bool) -> UnseenWalls | None:
    """Return the fault of a map without walls around its floor.

    Return None if there are walls, or unknown cells in the shade that map savers use for them.
    """
    free = np.pad(cells == FREE, 1)
    beside = free[:-2, 1:-1] | free[2:, 1:-1] | free[1:-1, :-2] | free[1:-1, 2:]
    edge = beside & ~free[1:-1, 1:-1]
    seen = float((cells[edge] == OCCUPIED).mean()) if edge.any() else 1.0
    if seen >= LEAST_WALL:
        return None
    grays = (pixels[..., :3].mean(axis=2) if pixels.ndim == 3 else pixels)[::-1].astype(np.uint8)
    darkness = (np.arange(256) if negate else 255 - np.arange(256)) / 255.0
    gray = int(np.median(grays[edge]))
    if gray == UNKNOWN_GREY:
        return None
    problem = (
        f"{seen:.0%} of the cells around the floor are occupied; the rest is unknown, mostly gray {gray}. Lasers see "
        "only occupied cells, so robots would get lost"
    )
    shares = np.bincount(grays[free[1:-1, 1:-1]], minlength=256) / cells.size
    tinted = darkness[(shares >= LARGE_SHARE) & (darkness >= TINTED)]
    wall = float(darkness[gray])
    floor = min([FREE_THRESH, wall / 2, *(tinted / 2).tolist()])
    return UnseenWalls(problem, round(0.9 * wall, 3), round(floor, 3))


def read_grid(map_yaml: Path) -> OccupancyGrid:
    """Return the occupancy grid of a `map.yaml`; see `read_grid_file`."""
    return read_grid_file(map_yaml).grid


def read_grid_file(map_yaml: Path) -> GridFile:
    """Read a `map.yaml` and its image.

    If the image is not at its path in the file, an image next to `map.yaml` is used, because the map may come from
    another machine.

    Raises:
        BadFile: the file or its image does not exist or has a fault.
    """
    doubts: list[BadFile] = []
    loaded = load_tree(map_yaml, _as_map_server(map_yaml, parse(map_yaml, read_text(map_yaml)), doubts), _MapYaml)
    entry = loaded.value
    if entry.free_thresh > entry.occupied_thresh:
        problem = f"{entry.free_thresh} is above occupied_thresh {entry.occupied_thresh}"
        raise loaded.fault("free_thresh", problem, "Write a lower value; map_saver writes 0.196 and 0.65")
    if problem := fault_of_path(entry.image):
        raise loaded.fault("image", problem, "Name the image, next to map.yaml or with its full path")
    image = _image_of(map_yaml, entry.image)
    if image is None:
        remedy = "Name the image, next to map.yaml or with its full path"
        raise loaded.fault("image", f"file {map_yaml.parent / entry.image} does not exist", remedy)
    if image != as_on_disk(map_yaml.parent / entry.image):
        problem = f"file {entry.image} does not exist, so {image.name} next to {map_yaml.name} is used"
        doubts.append(loaded.fault("image", problem, f"Write image: {image.name}"))
    pixels = read_image(image)
    cells = interpret_image(pixels, entry.negate == 1, entry.occupied_thresh, entry.free_thresh, entry.mode)
    if entry.mode != "raw" and not entry.negate and entry.free_thresh > 1.0 - UNKNOWN_GREY / 255.0:
        unknown = (pixels[..., :3].mean(axis=2) if pixels.ndim == 3 else pixels) == UNKNOWN_GREY
        if unknown.any():
            share = 100.0 * float(unknown.mean())
            problem = f"gray {UNKNOWN_GREY}, map savers' shade for unknown, is free here ({share:.0f} % of the image)"
            remedy = f"Write free_thresh: {FREE_THRESH}, unless this gray is free; map_server and Nav2 treat it as free"
            doubts.append(loaded.fault("free_thresh", problem, remedy))
    if entry.mode != "raw" and (unseen := unseen_walls(cells, pixels, entry.negate == 1)) is not None:
        remedy = (
            f"If these are walls, write occupied_thresh: {unseen.occupied_thresh}, free_thresh: {unseen.free_thresh}"
        )
        doubts.append(loaded.fault("occupied_thresh", unseen.problem, remedy))
    if pixels.ndim == 3 and pixels.shape[2] == 4 and entry.mode == "trinary":
        opaque = interpret_image(pixels[..., :3], entry.negate == 1, entry.occupied_thresh, entry.free_thresh)
        if (differing := float((cells != opaque).mean())) > 0.0:
            problem = (
                "the image has an alpha channel (transparency). map_server and Nav2 average it with the colors, so "
                f"{100.0 * differing:.0f} % of the cells differ from the colors shown"
            )
            doubts.append(loaded.fault("image", problem, "Save the image without an alpha channel"))
    whole = replace(loaded, doubts=(*doubts, *loaded.doubts))
    return GridFile(whole, OccupancyGrid(cells, entry.resolution, pose_of(*entry.origin)))


def _as_map_server(path: Path, tree: Node, doubts: list[BadFile]) -> Node:
    """Return a tree as map_server reads it.

    map_server accepts numbers in quotes and ignores unknown keys (yaml-cpp). Nav2's map_server also accepts true and
    false for `negate`, and capital letters in `mode` (map_io.cpp).
    """
    if not isinstance(tree, Section):
        return tree
    known = {each.name for each in fields(_MapYaml)}
    missing = known - {key.text for key, _ in tree.entries}
    entries: list[tuple[Scalar, Node]] = []
    for key, child in tree.entries:
        if key.text not in known and not get_close_matches(key.text, missing, n=1):
            remedy = "Delete the line if it is a typing error"
            doubts.append(BadFile(path, "map_server ignores this key", remedy, key.line, key.text))
        elif isinstance(child, Scalar) and key.text == "mode":
            entries.append((key, replace(child, text=child.text.lower())))
        elif isinstance(child, Scalar) and key.text != "image":
            text = _NEGATE.get(child.text.lower(), child.text) if key.text == "negate" else child.text
            entries.append((key, replace(child, text=text, plain=True)))
        elif isinstance(child, Listing) and key.text == "origin":
            items = [replace(each, plain=True) if isinstance(each, Scalar) else each for each in child.items]
            if len(items) == 3 and isinstance(items[2], Scalar) and items[2].text.lstrip("+-.").lower() == "nan":
                problem = f"{items[2].text} is not a heading; map savers write it if no orientation was set"
                raise BadFile(path, problem, "Write 0, unless the map is turned", child.line, "origin[2]")
            entries.append((key, replace(child, items=items)))
        else:
            entries.append((key, child))
    return replace(tree, entries=entries)


_NEGATE = {"true": "1", "false": "0", "yes": "1", "no": "0", "on": "1", "off": "0"}


def _image_of(map_yaml: Path, written: str) -> Path | None:
    """Return the image that a `map.yaml` names, otherwise an image of the same name next to it, otherwise None."""
    image = as_on_disk(map_yaml.parent / written)
    if is_regular(image):
        return image
    name = re.split(r"[/\\]", written)[-1]
    beside = sorted(
        each for each in map_yaml.parent.iterdir() if each.name.lower() == name.lower() and is_regular(each)
    )
    return next((each for each in beside if each.name == name), beside[0] if beside else None)


def pose_of(x: float, y: float, yaw: float) -> Pose2:
    """Return a pose with its heading from -pi to less than pi."""
    # Wrapping causes rounding errors, so an angle that needs no wrapping is not changed.
    return Pose2(x, y, yaw if -math.pi <= yaw < math.pi else wrap_angle(yaw))


def write_grid(folder: Path, grid: OccupancyGrid) -> None:
    """Write `map.yaml` and `map.pgm` as map_saver does; a missing folder is created.

    Raises:
        ValueError: some cells are not free, occupied or unknown; these files cannot store such cells.
        OSError: the folder cannot be created.
        BadFile: a file cannot be written.
    """
    shades = np.full(256, 1, dtype=np.uint8)
    for cell, grey in GREY_OF_CELL.items():
        shades[cell % 256] = grey
    pixels = shades[grid.cells.view(np.uint8)][::-1]
    if (pixels == 1).any():
        raise ValueError("only cells 0, 100 and -1 can be written")
    folder.mkdir(parents=True, exist_ok=True)
    header = f"P5\n{grid.cols} {grid.rows}\n255\n".encode("ascii")
    write_whole(folder / "map.pgm", header + pixels.tobytes())
    text = (
        "image: map.pgm\n"
        f"resolution: {grid.resolution!r}\n"
        f"origin: [{grid.origin.x!r}, {grid.origin.y!r}, {grid.origin.theta!r}]\n"
        "negate: 0\n"
        f"occupied_thresh: {OCCUPIED_THRESH}\n"
        f"free_thresh: {FREE_THRESH}\n"
    )
    write_whole(folder / "map.yaml", text.encode())
