"""Shipped map in the form in which the keeper sends it, with robots and rooms on it, for tests of the map view."""

import base64
import zlib
from pathlib import Path

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED
from sim.parameters import WorldParameters
from thbridge.files.map_files import Map, read_map
from thbridge.files.resources import shipped
from thbridge.roles.shared.notices import Ellipse, FloorPlan, RoomOutline
from ui.model.shared.scene import RobotMark, RoomMark

FOOTPRINT = np.array(WorldParameters().footprint)


def shipped_map(name: str) -> Map:
    return read_map(shipped().find("maps", name, Path()))


def house_of(shown: Map) -> FloorPlan:
    grid = shown.grid
    cells = np.where(grid.cells == FREE, 0, np.where(grid.cells == OCCUPIED, 1, 2)).astype(np.uint8)
    return FloorPlan(
        map=shown.name,
        resolution=grid.resolution,
        origin=(grid.origin.x, grid.origin.y, grid.origin.theta),
        width=cells.shape[1],
        height=cells.shape[0],
        cells=base64.b64encode(zlib.compress(cells.tobytes())).decode(),
        rooms=tuple(
            RoomOutline(room.room.people, room.name, room.region, (room.goal.x, room.goal.y, room.goal.theta))
            for room in shown.rooms
        ),
        footprint=tuple((float(x), float(y)) for x, y in FOOTPRINT),
    )


def rooms_of(shown: Map) -> list[RoomMark]:
    return [RoomMark(room.room.people, room.name, np.array(room.region), "unvisited") for room in shown.rooms]


def robot_at(number: int, x: float, y: float, theta: float = 0.0, selected: bool = False) -> RobotMark:
    nothing = np.empty((0, 2))
    return RobotMark(number, str(number + 1), Pose2(x, y, theta), FOOTPRINT, selected, False, nothing, nothing)


def busy_robots(shown: Map, count: int) -> list[RobotMark]:
    """Return robots at the start poses, each with a full trail, a path to a room and an ellipse; the first one is
    selected."""
    share = np.linspace(0.0, 1.0, 44)[:, None]
    robots = []
    for number in range(count):
        start, goal = shown.starts[number % len(shown.starts)], shown.rooms[number * 3 % len(shown.rooms)].goal
        here = np.array([[start.x, start.y]])
        bend = np.sin(6.0 * share)
        robots.append(
            RobotMark(
                robot=number,
                label=str(number + 1),
                pose=Pose2(start.x, start.y, 0.7 * number),
                footprint=FOOTPRINT,
                selected=number == 0,
                trouble=number == 2,
                trail=here - share[::-1] * [5.0, 0.3] + np.hstack((0.0 * bend, 0.3 * bend)),
                path=here + share * ([[goal.x, goal.y]] - here) + np.hstack((0.2 * bend, 0.0 * bend)),
                ellipse=Ellipse(0.5, 0.3, 0.5),
            )
        )
    return robots
