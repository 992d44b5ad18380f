"""Encoders of maps, costmaps, outlines of bodies and names of rooms."""

from collections.abc import Iterable
from struct import Struct
from typing import NamedTuple

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.numerics.float_array import FloatArray
from sim.robot.costmap.view import CostmapView
from thbridge.ros.messages.pack.fields import UINT32, header, pose_fields, stamp, string
from thbridge.ros.messages.stamps import stamp_ns

_MARKER = Struct("<3i7d3d4f2iB")
_GRID_META = Struct("<fII")

ADD = 0
_DELETEALL = 3
_LINE_STRIP = 4
_TEXT = 9
"""Codes of visualization_msgs/Marker."""
_LINE_WIDTH, _TEXT_HEIGHT = 0.05, 0.5
_LINE_COLOUR, _TEXT_COLOUR = (0.9, 0.4, 0.0, 1.0), (0.2, 0.2, 0.2, 1.0)
"""Sizes in meters, and colors as red, green, blue and opacity."""


class RoomLabel(NamedTuple):
    """Name of a room on the map.

    Attributes:
        room: number of the room for people.
        name: its name for people.
        x: x of the position of the name, meters.
        y: y of this position.
    """

    room: int
    name: str
    x: float
    y: float


def map_meta_data(tick: int, grid: OccupancyGrid) -> bytes:
    """Encode nav_msgs/MapMetaData. The map counts as loaded at this tick."""
    return _meta_data(tick, grid.resolution, grid.cols, grid.rows, grid.origin)


def _meta_data(tick: int, resolution: float, cols: int, rows: int, origin: Pose2) -> bytes:
    return b"".join(
        (
            stamp(stamp_ns(tick)),
            _GRID_META.pack(resolution, cols, rows),
            pose_fields(origin.x, origin.y, origin.theta),
        )
    )


def occupancy_grid(tick: int, frame: str, grid: OccupancyGrid) -> bytes:
    """Encode nav_msgs/OccupancyGrid."""
    return b"".join(
        (header(tick, frame), map_meta_data(tick, grid), UINT32.pack(grid.cells.size), grid.cells.tobytes())
    )


def _occupancy_of_costs() -> bytes:
    """Return a table: the value of nav_msgs/OccupancyGrid for each of costmap_2d's 256 costs."""
    costs = np.arange(256)
    occupancy = 1 + (97 * (costs - 1)) // 251
    occupancy[[0, 253, 254, 255]] = 0, 99, 100, -1
    return occupancy.astype(np.int8).tobytes()


_OCCUPANCY_OF_COSTS = _occupancy_of_costs()


def costmap(frame: str, view: CostmapView) -> bytes:
    """Encode nav_msgs/OccupancyGrid of a costmap: 0 free, 1 to 98 other costs, 99 inscribed, 100 lethal, -1 unknown.

    Source: ros-planning/navigation, costmap_2d/src/costmap_2d_publisher.cpp.
    """
    rows, cols = view.costs.shape
    return b"".join(
        (
            header(view.tick, frame),
            _meta_data(view.tick, view.resolution, cols, rows, view.origin),
            UINT32.pack(view.costs.size),
            view.costs.tobytes().translate(_OCCUPANCY_OF_COSTS),
        )
    )


def outlines(tick: int, frame: str, bodies: Iterable[tuple[str, FloatArray]]) -> bytes:
    """Encode visualization_msgs/MarkerArray with the outlines of bodies. The message deletes all earlier outlines.

    Args:
        tick: time stamp of the bodies.
        frame: frame of their corners.
        bodies: name, and (v, 2) corners in order, meters, of each body.
    """
    parts = [_line(tick, frame, _DELETEALL, 0, "", np.empty((0, 2)))]
    for number, (name, corners) in enumerate(bodies):
        # A line strip does not return to its first point, so that point is added at the end.
        parts.append(_line(tick, frame, ADD, number, name, np.vstack((corners, corners[:1]))))
    return UINT32.pack(len(parts)) + b"".join(parts)


def room_labels(tick: int, frame: str, labels: Iterable[RoomLabel]) -> bytes:
    """Encode visualization_msgs/MarkerArray with the names of rooms. The id of a marker is the room's number."""
    parts = [_text(tick, frame, label) for label in labels]
    return UINT32.pack(len(parts)) + b"".join(parts)


def _line(tick: int, frame: str, action: int, number: int, name: str, line: FloatArray) -> bytes:
    """Encode visualization_msgs/Marker with a line strip. Its namespace and its text are the body's name."""
    look = (_LINE_WIDTH, 0.0, 0.0, *_LINE_COLOUR)
    return _marker(tick, frame, name, (number, _LINE_STRIP, action), (0.0, 0.0), look, line, name)


def _text(tick: int, frame: str, label: RoomLabel) -> bytes:
    """Encode visualization_msgs/Marker with a text that always faces the viewer."""
    look = (0.0, 0.0, _TEXT_HEIGHT, *_TEXT_COLOUR)
    kind = (label.room, _TEXT, ADD)
    return _marker(tick, frame, "rooms", kind, (label.x, label.y), look, np.empty((0, 2)), label.name)


def _marker(
    tick: int,
    frame: str,
    namespace: str,
    kind: tuple[int, int, int],
    place: tuple[float, float],
    look: tuple[float, ...],
    line: FloatArray,
    text: str,
) -> bytes:
    """Encode visualization_msgs/Marker that is displayed without a time limit.

    Args:
        tick: time stamp.
        frame: frame of its position.
        namespace: namespace of its id.
        kind: its id, and the codes of its type and of its action.
        place: x and y, meters.
        look: its scale and its color.
        line: (n, 2) points relative to its position, meters.
        text: its text.
    """
    points = np.zeros((len(line), 3))
    points[:, :2] = line
    for_ever, unlocked, none = (0, 0), 0, UINT32.pack(0)
    return b"".join(
        (
            header(tick, frame),
            string(namespace),
            _MARKER.pack(*kind, *place, 0.0, 0.0, 0.0, 0.0, 1.0, *look, *for_ever, unlocked),
            UINT32.pack(len(points)),
            points.astype("<f8", copy=False).tobytes(),
            none,  # Colors of single points.
            string(text),
            none,  # Mesh.
            bytes((0,)),
        )
    )
