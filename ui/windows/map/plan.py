"""The house as the map draws it: boxes of equal cells, its extent, and where in a room there is space for words."""

import base64
import binascii
import zlib
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sim.floor import inside
from sim.geometry import FloatArray, Pose2
from thbridge.roles.notices import House

FREE, WALL, UNKNOWN = 0, 1, 2

Boxes = NDArray[np.int64]
"""(n, 4): first column, first row, columns, rows; in cells."""

Box = tuple[float, float, float, float]
"""Least x, least y, most x, most y; metres."""

ROOM_LINES = 12
"""Lines each way on which the corners of a room's box for words may lie, beside the room's own corners."""


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """A house, unpacked.

    Attributes:
        origin: of the cells, map frame.
        resolution: metres a cell.
        floor: boxes of free cells.
        walls: boxes of walls.
        bounds: box around all that is known, map frame.
    """

    origin: Pose2
    resolution: float
    floor: Boxes
    walls: Boxes
    bounds: Box


def unpack(house: House) -> Plan:
    """The plan of a house; one whose cells cannot be read has rooms and no walls."""
    cells = _cells(house)
    origin = Pose2(*house.origin)
    rows, cols = np.nonzero(cells != UNKNOWN)
    corners = [np.array(room.region, dtype=np.float64).reshape(-1, 2) for room in house.rooms]
    if len(rows):
        left, right = cols.min() * house.resolution, (cols.max() + 1) * house.resolution
        bottom, top = rows.min() * house.resolution, (rows.max() + 1) * house.resolution
        corners.append(origin.transform(np.array([[left, bottom], [right, bottom], [right, top], [left, top]])))
    known = np.concatenate(corners) if corners else np.array([[-1.0, -1.0], [1.0, 1.0]])
    (least_x, least_y), (most_x, most_y) = known.min(axis=0).tolist(), known.max(axis=0).tolist()
    return Plan(
        origin, house.resolution, boxes(cells == FREE), boxes(cells == WALL), (least_x, least_y, most_x, most_y)
    )


def _cells(house: House) -> NDArray[np.uint8]:
    size = house.width * house.height
    try:
        packed = base64.b64decode(house.cells, validate=True)
        cells = np.frombuffer(zlib.decompressobj().decompress(packed, size), dtype=np.uint8)
    except (binascii.Error, zlib.error):
        cells = np.empty(0, dtype=np.uint8)
    if len(cells) != size:
        cells = np.full(size, UNKNOWN, dtype=np.uint8)
    return cells.reshape(house.height, house.width)


def boxes(mask: NDArray[np.bool_]) -> Boxes:
    """Boxes that cover the true cells of a (rows, cols) mask once each: runs of a row, stacked where they agree."""
    found: list[tuple[int, int, int, int]] = []
    growing: dict[tuple[int, int], int] = {}
    padded = np.pad(mask, ((0, 1), (1, 1))).astype(np.int8)
    for row in range(len(padded)):
        edges = np.flatnonzero(np.diff(padded[row])).tolist()
        runs = set(zip(edges[::2], edges[1::2], strict=True))
        for run in [run for run in growing if run not in runs]:
            start = growing.pop(run)
            found.append((run[0], start, run[1] - run[0], row - start))
        for run in runs:
            growing.setdefault(run, row)
    return np.array(sorted(found), dtype=np.int64).reshape(-1, 4)


def holds(region: FloatArray, x: float, y: float) -> bool:
    """Whether a point of the map frame lies in a region of (n, 2) corners."""
    corners = tuple((float(one), float(other)) for one, other in region)
    return bool(inside(corners, np.array([x]), np.array([y]))[0])


def room_box(region: FloatArray) -> Box:
    """The largest upright box inside a room, for its words and signs: map frame, metres."""
    return _room_box(tuple((float(x), float(y)) for x, y in region))


@lru_cache(maxsize=256)
def _room_box(region: tuple[tuple[float, float], ...]) -> Box:
    corners = np.array(region)
    (left, bottom), (right, top) = corners.min(axis=0), corners.max(axis=0)
    if set(region) == {(left, bottom), (left, top), (right, bottom), (right, top)}:
        return float(left), float(bottom), float(right), float(top)
    xs = np.unique(np.concatenate((corners[:, 0], np.linspace(left, right, ROOM_LINES))))
    ys = np.unique(np.concatenate((corners[:, 1], np.linspace(bottom, top, ROOM_LINES))))
    middle_x, middle_y = np.meshgrid((xs[1:] + xs[:-1]) / 2.0, (ys[1:] + ys[:-1]) / 2.0)
    held = inside(region, middle_x.ravel(), middle_y.ravel()).reshape(middle_x.shape)
    best, box = 0.0, (float(left), float(bottom), float(right), float(top))
    for low in range(len(ys) - 1):
        columns = np.ones(len(xs) - 1, dtype=bool)
        for high in range(low, len(ys) - 1):
            columns &= held[high]
            edges = np.flatnonzero(np.diff(np.pad(columns, 1).astype(np.int8)))
            for first, last in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
                size = float((xs[last] - xs[first]) * (ys[high + 1] - ys[low]))
                if size > best:
                    best, box = size, (float(xs[first]), float(ys[low]), float(xs[last]), float(ys[high + 1]))
    return box
