"""Floor plans as architects draw them: eight rooms along a corridor, with doors, furniture, labels and dimensions."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

WALL, DOOR, LEAF = 10, 36, 30
"""Thickness of walls, width of doors, and width of one leaf of a double door, pixels."""
SIZE = (1300, 900)
SCALE = 0.025
"""Resolution, meters per pixel."""


def plan(*, hatched: bool = False, furnished: bool = True, entrance: bool = False) -> Image.Image:
    """Draw a plan of 27.5 m by 17.5 m."""
    image = Image.new("L", SIZE, 255)
    pen = ImageDraw.Draw(image)
    for ends in _walls():
        (_hatched_wall if hatched else _solid_wall)(image, ends)
    for x in (180, 470, 740, 1010):
        _door(pen, x, 380, up=True)
        _door(pen, x, 520, up=False)
    if entrance:
        _double_door(pen, 100, 420)
    if furnished:
        for number, (x, y) in enumerate((x, y) for y in (150, 700) for x in (150, 430, 700, 980)):
            pen.text((x + 60, y), f"Office {number + 1}", fill=0, font=ImageFont.load_default(22))
            pen.text((x + 60, y + 24), "24.3 m2", fill=0, font=ImageFont.load_default(14))
            pen.rectangle((x - 30, y - 30, x + 20, y + 10), outline=0, width=2)
            pen.ellipse((x - 10, y + 16, x + 10, y + 36), outline=0, width=2)
        pen.line((100, 60, 1200, 60), fill=0, width=1)
        for x in (100, 375, 650, 925, 1200):
            pen.line((x - 6, 66, x + 6, 54), fill=0, width=2)
        pen.text((620, 36), "27.50", fill=0, font=ImageFont.load_default(16))
    return image


def pixels(image: Image.Image) -> NDArray[np.uint8]:
    return np.asarray(image, dtype=np.uint8)


def _walls() -> list[tuple[int, int, int, int]]:
    across = [(100, y, 1200, y) for y in (100, 380, 520, 800)]
    down = [(x, *rows) for x, *rows in ((100, 100, 800), (1200, 100, 800))]
    between = [(x, top, bottom) for x in (375, 650, 925) for top, bottom in ((100, 380), (520, 800))]
    return [*across, *((x, top, x, bottom) for x, top, bottom in (*down, *between))]


def _solid_wall(image: Image.Image, ends: tuple[int, int, int, int]) -> None:
    ImageDraw.Draw(image).line(ends, fill=0, width=WALL)


def _hatched_wall(image: Image.Image, ends: tuple[int, int, int, int]) -> None:
    """Draw a wall as two lines with slanted strokes between them."""
    half = WALL // 2 + 1
    left, top, right, bottom = ends[0] - half, ends[1] - half, ends[2] + half, ends[3] + half
    ImageDraw.Draw(image).rectangle((left, top, right, bottom), outline=0, fill=255, width=3)
    for start in range(left - (bottom - top), right, 7):
        for step in range(bottom - top):
            if left <= start + step <= right:
                image.putpixel((start + step, top + step), 0)


def _door(pen: ImageDraw.ImageDraw, x: int, y: int, *, up: bool) -> None:
    """Draw an opening with a leaf, its arc, and a line in place of the wall."""
    half = WALL // 2 + 3
    pen.rectangle((x, y - half, x + DOOR, y + half), fill=255)
    pen.line((x, y, x, y - DOOR if up else y + DOOR), fill=0, width=3)
    pen.arc((x - DOOR, y - DOOR, x + DOOR, y + DOOR), *((270, 360) if up else (0, 90)), fill=0, width=2)
    pen.line((x, y, x + DOOR, y), fill=0, width=1)


def _double_door(pen: ImageDraw.ImageDraw, x: int, y: int) -> None:
    """Draw an opening in a vertical wall with two leaves, whose arcs meet in its middle."""
    half = WALL // 2 + 3
    pen.rectangle((x - half, y, x + half, y + 2 * LEAF), fill=255)
    for hinge, angles in ((y, (0, 90)), (y + 2 * LEAF, (270, 360))):
        pen.line((x, hinge, x + LEAF, hinge), fill=0, width=2)
        pen.arc((x - LEAF, hinge - LEAF, x + LEAF, hinge + LEAF), *angles, fill=0, width=2)
