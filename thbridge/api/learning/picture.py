"""Images of a hunt: the map, the rooms, and the true and believed poses of robots."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED
from sim.common.robot_numbers import robot_numbers
from sim.numerics import elementary
from thbridge.api.snapshot import Floats
from thbridge.app.compose.setting import StudySetting

PIXELS = 480
"""Length of the longer side of an image, in pixels."""
_SHADES = {"free": 255, "occupied": 31, "unknown": 213}
_VISITED, _OPEN = "#009E73", "#D55E00"
_BODY, _BELIEF = "#0072B2", "#7A5195"
_RADIUS = 0.25
"""Radius of a robot's body, meters."""


def picture_of(setting: StudySetting, visited: Sequence[bool], believed: Floats, true: Floats) -> NDArray[np.uint8]:
    """Return an image (rows, cols, 3) with room numbers (green after a visit), robots, and believed poses (violet).

    Args:
        setting: the study with its map.
        visited: True for each visited room.
        believed: (n, 3) believed poses.
        true: (n, 3) true poses.
    """
    grid = setting.map.grid
    cells = grid.cells[::-1]
    shades = np.full(cells.shape, _SHADES["unknown"], np.uint8)
    shades[cells == FREE] = _SHADES["free"]
    shades[cells == OCCUPIED] = _SHADES["occupied"]
    scale = PIXELS / max(cells.shape)
    size = round(grid.cols * scale), round(grid.rows * scale)
    image = Image.fromarray(shades).resize(size, Image.Resampling.NEAREST).convert("RGB")
    draw = ImageDraw.Draw(image)
    per_metre = scale / grid.resolution

    def place(x: float, y: float) -> tuple[float, float]:
        here = grid.origin.inverse().compose(Pose2(x, y, 0.0))
        return here.x * per_metre, size[1] - here.y * per_metre

    for number, room in enumerate(setting.map.rooms):
        colour = _VISITED if visited[number] else _OPEN
        draw.text(place(room.goal.x, room.goal.y), str(room.room.people), fill=colour, anchor="mm", font_size=18)
    for colour, poses in ((_BELIEF, believed), (_BODY, true)):
        for number, (x, y, theta) in zip(robot_numbers(len(poses)), poses.tolist(), strict=True):
            column, row = place(x, y)
            draw.circle((column, row), _RADIUS * per_metre, outline=colour, width=2)
            cosine, sine = elementary.cos_sin(theta)
            draw.line((column, row, *place(x + 2 * _RADIUS * cosine, y + 2 * _RADIUS * sine)), fill=colour, width=2)
            if colour == _BODY:
                draw.text((column, row), str(number), fill=colour, anchor="mm")
    return np.asarray(image)
