"""Draw the pictures of the treasures in `templates/*/pictures`. Every run gives the same pictures.

Each treasure is a signed distance field with a color for every point, drawn by sphere tracing. The light comes from the
upper left, and the treasure has a shadow on the floor.

    python scripts/draw/treasures.py [FOLDER]
"""

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

Floats = NDArray[np.float64]

SIZE = 320
OVERSAMPLING = 2
EYE = np.array([0.9, 2.2, 5.6])
LOOK_AT = np.array([0.0, 1.02, 0.0])
LIGHT = np.array([-0.55, 0.78, 0.50]) / np.linalg.norm([-0.55, 0.78, 0.50])
FLOOR = np.array([0.80, 0.76, 0.70])
WALL = np.array([0.62, 0.66, 0.71])


@dataclass(frozen=True)
class Solid:
    """Treasure: functions for distances (n,) of points (n, 3) to its surface and their colors (n, 3), and its shine."""

    distance: Callable[[Floats], Floats]
    colour: Callable[[Floats], Floats]
    gloss: float = 0.6
    sharpness: float = 60.0


def rgb(code: int) -> Floats:
    """Return a color such as 0xff8800 as three linear numbers in [0, 1]."""
    return (np.array([code >> 16 & 255, code >> 8 & 255, code & 255]) / 255.0) ** 2.2


def turned(points: Floats, angle: float) -> Floats:
    """Return the points in a frame that is turned about the vertical axis."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack(
        [cos * points[:, 0] - sin * points[:, 2], points[:, 1], sin * points[:, 0] + cos * points[:, 2]], axis=1
    )


def lathe(profile: Sequence[tuple[float, float]]) -> Callable[[Floats], Floats]:
    """Return the solid swept by a profile of (radius, height) corners, lowest first, closed along the axis."""
    corners = np.array([(0.0, profile[0][1]), *profile, (0.0, profile[-1][1])])

    def distance(points: Floats) -> Floats:
        flat = np.stack([np.hypot(points[:, 0], points[:, 2]), points[:, 1]], axis=1)
        nearest = np.full(len(flat), np.inf)
        for start, end in pairwise(corners):
            edge = end - start
            along = np.clip((flat - start) @ edge / (edge @ edge), 0.0, 1.0)
            nearest = np.minimum(nearest, np.linalg.norm(flat - start - along[:, None] * edge, axis=1))
        height = np.array([corner[1] for corner in profile])
        radius = np.interp(flat[:, 1], height, [corner[0] for corner in profile])
        inside = (flat[:, 0] < radius) & (flat[:, 1] > height[0]) & (flat[:, 1] < height[-1])
        return np.where(inside, -nearest, nearest) - 0.02

    return distance


def smooth(profile: Sequence[tuple[float, float]], rounds: int = 3) -> list[tuple[float, float]]:
    """Return the profile with its corners cut repeatedly (Chaikin 1974)."""
    line = np.array(profile)
    for _ in range(rounds):
        near, far = 0.75 * line[:-1] + 0.25 * line[1:], 0.25 * line[:-1] + 0.75 * line[1:]
        line = np.concatenate([line[:1], np.stack([near, far], axis=1).reshape(-1, 2), line[-1:]])
    return [(float(radius), float(height)) for radius, height in line]


def box(half: Sequence[float], centre: Sequence[float], rounding: float) -> Callable[[Floats], Floats]:
    """Return a box with rounded edges."""

    def distance(points: Floats) -> Floats:
        beyond = np.abs(points - np.array(centre)) - (np.array(half) - rounding)
        gap: Floats = np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0)
        return gap - rounding

    return distance


def painted(points: Floats, ground: Floats) -> Floats:
    """Return the same color for all points, as a base coat."""
    return np.broadcast_to(ground, points.shape).copy()


def soft_drink_bottle(body: int, liquid: int) -> Solid:
    """Return a curved bottle with a white label and a cap."""
    profile = smooth(
        [(0.42, 0.0), (0.50, 0.06), (0.50, 0.50), (0.42, 0.72), (0.50, 0.98), (0.49, 1.25), (0.20, 1.66), (0.17, 1.80)]
    )
    shape = lathe([*profile, (0.17, 1.84), (0.23, 1.85), (0.23, 1.90), (0.19, 1.91), (0.21, 1.92), (0.21, 2.08)])

    def colour(points: Floats) -> Floats:
        height = points[:, 1]
        angle = np.arctan2(points[:, 0], points[:, 2])
        paint = painted(points, rgb(body))
        paint[height < 1.30] = rgb(liquid)
        label = (height > 0.62) & (height < 1.02)
        paint[label] = rgb(0xF7F3EA)
        wave = 0.82 + 0.07 * np.sin(5.0 * angle)
        paint[label & (np.abs(height - wave) < 0.06)] = rgb(body)
        paint[label & ((height < 0.66) | (height > 0.98))] = rgb(liquid)
        cap = height > 1.90
        paint[cap] = rgb(0xF2F2F2)
        paint[cap & (np.sin(40.0 * angle) > 0.55)] = rgb(0xB9BEC4)
        return paint

    return Solid(shape, colour, gloss=1.1, sharpness=90.0)


def beer_bottle() -> Solid:
    """Return a long-necked bottle of green glass with a crown cap, and a mug of beer on its label."""
    profile = smooth([(0.34, 0.0), (0.40, 0.05), (0.40, 0.45), (0.40, 1.02), (0.37, 1.22), (0.15, 1.50), (0.13, 2.02)])
    shape = lathe([*profile, (0.17, 2.03), (0.17, 2.10), (0.15, 2.12), (0.21, 2.13), (0.20, 2.19), (0.13, 2.24)])

    def colour(points: Floats) -> Floats:
        height = points[:, 1]
        # The label faces the camera, which is slightly to the right.
        angle = np.arctan2(points[:, 0], points[:, 2]) - 0.16
        across = angle * 0.40
        paint = painted(points, rgb(0x12692A))
        paint[height < 1.36] = rgb(0x0B4A1C)
        oval = (across / 0.40) ** 2 + ((height - 0.66) / 0.40) ** 2
        paint[oval < 1.0] = rgb(0xC79A2B)
        paint[oval < 0.86] = rgb(0xF6EFD9)
        front = np.abs(angle) < 1.5
        mug = front & (np.abs(across + 0.03) < 0.13) & (np.abs(height - 0.62) < 0.18)
        handle = np.hypot((across - 0.12) / 0.8, height - 0.62)
        paint[front & (across > 0.09) & (handle > 0.07) & (handle < 0.12)] = rgb(0x8A5A12)
        paint[mug] = rgb(0xF0A81C)
        paint[mug & (np.sin((across + 0.03) * 72.0) > 0.80)] = rgb(0xC77F0E)
        for bubble, up, size in ((-0.13, 0.83, 0.065), (-0.03, 0.86, 0.085), (0.08, 0.83, 0.065), (-0.03, 0.81, 0.06)):
            paint[front & (np.hypot(across - bubble, height - up) < size)] = rgb(0xFFFFFF)
        paint[front & (np.hypot(across + 0.12, height - 0.77) < 0.04)] = rgb(0xFFFFFF)
        neck = (height > 1.60) & (height < 1.86)
        paint[neck] = rgb(0xF6EFD9)
        paint[neck & ((height < 1.63) | (height > 1.83))] = rgb(0xC79A2B)
        cap = height > 2.12
        paint[cap] = rgb(0xD8B23A)
        paint[cap & (height < 2.2) & (np.sin(21.0 * angle) > 0.3)] = rgb(0x8E6C14)
        return paint

    return Solid(shape, colour, gloss=1.5, sharpness=120.0)


def can(body: int, accent: int) -> Solid:
    """Return a beverage can, which is narrower at both ends and has a silver lid with a ring pull."""
    wall = lathe(
        [(0.36, 0.0), (0.36, 0.03), (0.46, 0.14), (0.46, 1.28), (0.38, 1.42), (0.38, 1.46), (0.34, 1.46), (0.33, 1.40)]
    )
    ring = box((0.07, 0.02, 0.13), (0.02, 1.46, 0.10), 0.02)

    def distance(points: Floats) -> Floats:
        return np.minimum(wall(points), ring(turned(points, 0.5)))

    def colour(points: Floats) -> Floats:
        height = points[:, 1]
        radius = np.hypot(points[:, 0], points[:, 2])
        angle = np.arctan2(points[:, 0], points[:, 2]) - 0.16
        paint = painted(points, rgb(body))
        sweep = height - 0.72 - 0.30 * np.sin(angle * 1.5)
        paint[np.abs(sweep) < 0.17] = rgb(0xFFFFFF)
        paint[np.abs(sweep) < 0.12] = rgb(accent)
        for around, up, size in ((-0.75, 1.06, 0.07), (-0.45, 1.16, 0.045), (0.55, 0.36, 0.07), (0.85, 0.26, 0.045)):
            paint[np.hypot((angle - around) * 0.46, height - up) < size] = rgb(0xFFFFFF)
        paint[(height < 0.11) | (height > 1.33)] = rgb(0xC9CED3)
        paint[(height > 1.40) & (radius < 0.33)] = rgb(0xA4ABB2)
        spun = turned(points, 0.5)
        mouth = np.hypot(spun[:, 0] / 0.8, spun[:, 2] - 0.2) < 0.11
        paint[(height > 1.38) & (height < 1.445) & mouth] = rgb(0x6B7278)
        paint[height > 1.452] = np.where(radius[height > 1.452, None] < 0.31, rgb(0xE6E9EC), rgb(0xC9CED3))
        return paint

    return Solid(distance, colour, gloss=1.0, sharpness=45.0)


def basketball() -> Solid:
    """Return an orange ball with black seams and a rough skin."""
    radius, centre = 0.95, np.array([0.0, 0.95, 0.0])

    def tilted(points: Floats) -> Floats:
        away = turned(points - centre, 0.55)
        cos, sin = np.cos(0.45), np.sin(0.45)
        return np.stack([cos * away[:, 0] - sin * away[:, 1], sin * away[:, 0] + cos * away[:, 1], away[:, 2]], axis=1)

    def seam(points: Floats) -> Floats:
        unit = tilted(points) / radius
        # There are two great circles, and on each side a curve that bulges toward the poles.
        bulge = np.abs(np.abs(unit[:, 0]) - 0.48 - 0.24 * unit[:, 1] ** 2)
        return np.minimum(np.minimum(np.abs(unit[:, 0]), np.abs(unit[:, 1])), bulge)

    def distance(points: Floats) -> Floats:
        unit = tilted(points)
        pebbles: Floats = 0.004 * np.prod(np.sin(46.0 * unit), axis=1)
        groove = 0.022 * np.exp(-((seam(points) / 0.02) ** 2))
        gap: Floats = np.linalg.norm(points - centre, axis=1) - radius
        return gap + groove + pebbles

    def colour(points: Floats) -> Floats:
        paint = painted(points, rgb(0xE06A16))
        paint[seam(points) < 0.022] = rgb(0x1A1512)
        return paint

    return Solid(distance, colour, gloss=0.35, sharpness=18.0)


def fuzzy_die() -> Solid:
    """Return a pink plush die with white pips and fur."""
    half, angle = 0.72, 0.55
    cube = box((half, half, half), (0.0, half, 0.0), 0.17)
    pips = {
        0: [(-0.36, -0.36), (0.36, 0.36), (-0.36, 0.36), (0.36, -0.36), (0.0, 0.0)],
        1: [(-0.36, -0.36), (0.36, 0.36), (0.0, 0.0)],
        2: [(-0.36, -0.36), (-0.36, 0.0), (-0.36, 0.36), (0.36, -0.36), (0.36, 0.0), (0.36, 0.36)],
    }

    def fur(points: Floats) -> Floats:
        shag = np.sin(
            29.0 * points + 6.0 * np.sin(17.0 * points[:, [1, 2, 0]] + 3.0 * np.sin(7.0 * points[:, [2, 0, 1]]))
        )
        fine = np.sin(83.0 * points[:, [2, 0, 1]] + 4.0 * np.sin(61.0 * points))
        length: Floats = 0.6 * np.abs(shag).prod(axis=1) + 0.4 * np.abs(fine).prod(axis=1)
        return length

    def distance(points: Floats) -> Floats:
        spun = turned(points, angle)
        return cube(spun) - 0.06 * fur(spun)

    def colour(points: Floats) -> Floats:
        spun = turned(points, angle) - np.array([0.0, half, 0.0])
        paint = painted(points, rgb(0xFF6DB4))
        face = np.abs(spun).argmax(axis=1)
        for axis, centres in pips.items():
            across = np.delete(spun, axis, axis=1)
            for centre in centres:
                near = np.linalg.norm(across - np.array(centre), axis=1)
                paint[(face == axis) & (near < 0.15)] = rgb(0xFFFFFF)
        return paint * (0.95 + 0.7 * fur(turned(points, angle)))[:, None]

    return Solid(distance, colour, gloss=0.05, sharpness=8.0)


def candy_box() -> Solid:
    """Return an open green box full of sweets, with a wrapped sweet painted on its front."""
    angle = 0.42
    outer = box((0.95, 0.55, 0.70), (0.0, 0.55, 0.0), 0.04)
    inner = box((0.88, 0.55, 0.63), (0.0, 0.70, 0.0), 0.03)
    lid = box((0.95, 0.48, 0.05), (0.0, 1.55, -0.68), 0.04)
    sweets = [
        (x, 1.02 + 0.10 * ((index * 5) % 3), z)
        for index, (x, z) in enumerate(
            (x + (0.14 if row % 2 else 0.0), z)
            for row, z in enumerate((-0.42, -0.14, 0.14, 0.42))
            for x in (-0.66, -0.36, -0.06, 0.24, 0.52)
        )
    ]
    wrappers = [rgb(code) for code in (0xE8262B, 0xFFD21F, 0x2C7BE5, 0xFF7AC0, 0xFF8A1E, 0x9A3FD5, 0xFFFFFF)]

    def nearest_sweet(points: Floats) -> tuple[Floats, NDArray[np.int64]]:
        distances = np.stack([np.linalg.norm(points - np.array(sweet), axis=1) for sweet in sweets])
        return distances.min(axis=0) - 0.19, distances.argmin(axis=0)

    def distance(points: Floats) -> Floats:
        spun = turned(points, angle)
        walls = np.maximum(outer(spun), -inner(spun))
        return np.minimum(np.minimum(walls, lid(spun)), nearest_sweet(spun)[0])

    def colour(points: Floats) -> Floats:
        spun = turned(points, angle)
        paint = painted(points, rgb(0x2BA84A))
        x, y = spun[:, 0], spun[:, 1]
        front = (spun[:, 2] > 0.66) & (y < 1.12)
        side = np.abs(x) > 0.92
        paint[side & (np.sin(14.0 * (spun[:, 2] + y)) > 0.2) & (y < 1.12)] = rgb(0xBDEBC6)
        paint[front & ((y < 0.12) | (y > 0.98))] = rgb(0xBDEBC6)
        away = np.hypot(x, y - 0.55)
        spiral = np.sin(5.0 * np.arctan2(y - 0.55, x) + 13.0 * away) > 0.0
        wings = (np.abs(x) > 0.26) & (np.abs(x) < 0.66) & (np.abs(y - 0.55) < 0.62 * (np.abs(x) - 0.20))
        paint[front & wings] = rgb(0xFFFFFF)
        paint[front & wings & (np.sin(26.0 * np.arctan2(y - 0.55, np.abs(x) - 0.2)) > 0.3)] = rgb(0xE8262B)
        paint[front & (away < 0.32)] = rgb(0xFFFFFF)
        paint[front & (away < 0.30) & spiral] = rgb(0xE8262B)
        inside = (spun[:, 2] > -0.64) & (y > 1.1) & ~front
        paint[inside & (spun[:, 2] < -0.55)] = rgb(0x2BA84A)
        distance_to_sweet, which = nearest_sweet(spun)
        on_sweet = distance_to_sweet < 0.004
        stripes = np.sin(22.0 * (x + 0.6 * y)) > 0.45
        paint[on_sweet] = np.array(wrappers)[which[on_sweet] % len(wrappers)]
        paint[on_sweet & stripes] = 0.5 * paint[on_sweet & stripes] + 0.5
        return paint

    return Solid(distance, colour, gloss=0.6, sharpness=50.0)


def wooden(shape: Callable[[Floats], Floats], body: int, board: float) -> Solid:
    """Return an object of painted boards of this width, with the grain of the wood in the paint."""

    def colour(points: Floats) -> Floats:
        grain = np.sin(9.0 * points[:, 1] + 40.0 * np.sin(1.7 * points[:, 0] + 0.6 * points[:, 2]))
        paint = painted(points, rgb(body)) * (0.90 + 0.10 * grain)[:, None]
        bare = np.sin(23.0 * points[:, 0] + 5.0 * np.sin(3.0 * points[:, 1])) > 0.95
        paint[bare] *= 0.55
        paint[np.abs((points[:, 1] / board) % 1.0 - 0.5) > 0.46] = rgb(0x4A3520)
        return paint

    return Solid(shape, colour, gloss=0.15, sharpness=12.0)


def metallic(shape: Callable[[Floats], Floats], body: int, rims: Sequence[float]) -> Solid:
    """Return an object of painted sheet metal, with bare metal at rims of these heights."""

    def colour(points: Floats) -> Floats:
        paint = painted(points, rgb(body))
        for height in rims:
            paint[np.abs(points[:, 1] - height) < 0.05] = rgb(0xC9CED3)
        return paint

    return Solid(shape, colour, gloss=1.5, sharpness=140.0)


def ceramic(shape: Callable[[Floats], Floats], glaze: int, foot: float) -> Solid:
    """Return an object of fired clay with a glaze above its foot."""

    def colour(points: Floats) -> Floats:
        paint = painted(points, rgb(glaze))
        drip = foot + 0.07 * np.sin(5.0 * np.arctan2(points[:, 0], points[:, 2]))
        paint[points[:, 1] < drip] = rgb(0xB5653A)
        return paint

    return Solid(shape, colour, gloss=0.9, sharpness=45.0)


def joined(*shapes: Callable[[Floats], Floats]) -> Callable[[Floats], Floats]:
    """Return the union of shapes."""

    def distance(points: Floats) -> Floats:
        gap: Floats = np.minimum.reduce([shape(points) for shape in shapes])
        return gap

    return distance


def ring(centre: Sequence[float], radius: float, thickness: float) -> Callable[[Floats], Floats]:
    """Return an upright ring, such as the handle of a jug."""

    def distance(points: Floats) -> Floats:
        offset = points - np.array(centre)
        gap: Floats = np.hypot(np.hypot(offset[:, 0], offset[:, 1]) - radius, offset[:, 2]) - thickness
        return gap

    return distance


_TIN = [(0.50, 0.0), (0.50, 1.00), (0.46, 1.02), (0.46, 1.06), (0.05, 1.07)]
_JUG = [(0.30, 0.0), (0.52, 0.30), (0.50, 0.65), (0.28, 0.95), (0.34, 1.20)]
_VASE = [(0.45, 0.0), (0.86, 0.70), (0.74, 1.30), (0.34, 1.70), (0.52, 2.10)]
_BARREL = [(0.62, 0.0), (0.90, 0.70), (0.90, 1.30), (0.62, 2.00)]
_HANDLE = ring((0.0, 1.25, 0.0), 0.32, 0.06)


def march(solid: Solid, start: Floats, direction: Floats, far: float) -> tuple[Floats, Floats]:
    """Follow rays (n, 3) to the solid by sphere tracing (Hart 1996): each step is as long as the distance to the solid.

    Returns:
        (n,) distances along the ray, infinite for a miss, and (n,) closeness of each miss: the smallest ratio of the
        gap to the distance traveled, which is the softness of a shadow.
    """
    gone = np.full(len(start), 0.02)
    narrow = np.full(len(start), np.inf)
    hit = np.zeros(len(start), dtype=bool)
    active = np.arange(len(start))
    for _ in range(160):
        gap = solid.distance(start[active] + gone[active, None] * direction[active])
        narrow[active] = np.minimum(narrow[active], np.maximum(gap, 0.0) / gone[active])
        hit[active[gap < 0.0015]] = True
        # Patterns in a surface slightly distort the distances. With short steps, no ray jumps through the surface.
        gone[active] += np.maximum(0.7 * gap, 0.001)
        active = active[(gap >= 0.0015) & (gone[active] < far)]
        if not active.size:
            break
    return np.where(hit, gone, np.inf), narrow


def normals(solid: Solid, points: Floats) -> Floats:
    """Return (n, 3) unit normals of the surface, outward."""
    step = 0.002
    slope: Floats = np.stack(
        [solid.distance(points + step * axis) - solid.distance(points - step * axis) for axis in np.eye(3)], axis=1
    )
    slope /= np.linalg.norm(slope, axis=1, keepdims=True)
    return slope


def draw(solid: Solid) -> Image.Image:
    """Draw the solid on its floor, SIZE x SIZE pixels."""
    side = SIZE * OVERSAMPLING
    forward = (LOOK_AT - EYE) / np.linalg.norm(LOOK_AT - EYE)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    steps = (np.arange(side) + 0.5) / side * 2.0 - 1.0
    across, along = np.meshgrid(steps, -steps)
    direction = forward + 0.245 * (across.reshape(-1, 1) * right + along.reshape(-1, 1) * up)
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    eye = np.broadcast_to(EYE, direction.shape)

    light = background(solid, eye, direction)
    # Follow only rays that pass near the treasure.
    nearest = -((EYE - LOOK_AT) * direction).sum(axis=1)
    passing = np.flatnonzero(np.linalg.norm(EYE + nearest[:, None] * direction - LOOK_AT, axis=1) < 1.6)
    reach, _ = march(solid, eye[passing], direction[passing], 12.0)
    seen = passing[np.isfinite(reach)]
    points = EYE + reach[np.isfinite(reach), None] * direction[seen]
    light[seen] = lit(solid, points, direction[seen])

    picture = np.clip(light, 0.0, 1.0) ** (1.0 / 2.2)
    picture = picture.reshape(SIZE, OVERSAMPLING, SIZE, OVERSAMPLING, 3).mean(axis=(1, 3))
    return Image.fromarray(np.round(picture * 255.0).astype(np.uint8))


def background(solid: Solid, eye: Floats, direction: Floats) -> Floats:
    """Return the (n, 3) light of the floor with the treasure's shadow; the floor fades into the wall."""
    below = direction[:, 1] < -0.02
    reach = np.where(below, -eye[:, 1] / np.where(below, direction[:, 1], -1.0), 40.0)
    points = eye + reach[:, None] * direction
    fade = np.clip((np.hypot(points[:, 0], points[:, 2]) - 2.5) / 6.0, 0.0, 1.0)[:, None]
    light = (1.0 - fade) * FLOOR**2.2 + fade * WALL**2.2
    near = np.flatnonzero(below & (np.hypot(points[:, 0], points[:, 2]) < 4.0))
    _, narrow = march(solid, points[near], np.broadcast_to(LIGHT, (len(near), 3)), 5.0)
    shadow = 0.42 + 0.58 * np.clip(narrow * 7.0, 0.0, 1.0)
    contact = 0.45 + 0.55 * np.clip(solid.distance(points[near]) / 0.35, 0.0, 1.0) ** 0.6
    light[near] *= (shadow * contact)[:, None]
    return light


def lit(solid: Solid, points: Floats, direction: Floats) -> Floats:
    """Return the (n, 3) light of points on the treasure, seen along `direction`."""
    normal = normals(solid, points)
    _, narrow = march(solid, points + 0.03 * normal, np.broadcast_to(LIGHT, points.shape), 4.0)
    sun = np.clip(normal @ LIGHT, 0.0, 1.0) * np.clip(narrow * 9.0, 0.0, 1.0)
    sky = 0.5 + 0.5 * normal[:, 1]
    floor = np.clip(0.55 + points[:, 1], 0.55, 1.0)
    halfway = LIGHT - direction
    halfway /= np.linalg.norm(halfway, axis=1, keepdims=True)
    shine = solid.gloss * np.clip((normal * halfway).sum(axis=1), 0.0, 1.0) ** solid.sharpness * (narrow > 0.0)
    rim = 0.25 * solid.gloss * (1.0 + np.clip((normal * direction).sum(axis=1), -1.0, 0.0)) ** 4
    paint = solid.colour(points)
    ambient = floor * (0.16 + 0.30 * sky)
    light: Floats = paint * (ambient + 0.85 * sun)[:, None] + (0.75 * shine + rim * floor)[:, None]
    return light


PICTURES: Mapping[str, Callable[[], Solid]] = {
    "practice/pictures/green_bottle.jpg": lambda: soft_drink_bottle(0x3FB861, 0x1F8A44),
    "practice/pictures/green_can.jpg": lambda: can(0x49C46B, 0x14622F),
    "original-2016/pictures/rsz_t1.jpg": lambda: soft_drink_bottle(0xF58A12, 0xE06A00),
    "original-2016/pictures/rsz_t2.jpg": lambda: soft_drink_bottle(0x2E86E8, 0x0F55C4),
    "original-2016/pictures/rsz_t3.jpg": lambda: can(0xF7CF1D, 0xD9480F),
    "original-2016/pictures/rsz_t4.jpg": lambda: can(0xFF6FB5, 0x8E2BB8),
    "sklar-azhar-2015/pictures/basketball.jpg": basketball,
    "sklar-azhar-2015/pictures/fuzzy_die.jpg": fuzzy_die,
    "sklar-azhar-2015/pictures/candy_box.jpg": candy_box,
    "sklar-azhar-2015/pictures/beer_bottle.jpg": beer_bottle,
    "everyday-things/pictures/basketball.jpg": basketball,
    "everyday-things/pictures/fuzzy_die.jpg": fuzzy_die,
    "everyday-things/pictures/candy_box.jpg": candy_box,
    "everyday-things/pictures/beer_bottle.jpg": beer_bottle,
    "four-properties/pictures/toy_block.jpg": lambda: wooden(box((0.45,) * 3, (0.0, 0.45, 0.0), 0.05), 0xC8332B, 0.9),
    "four-properties/pictures/paint_tin.jpg": lambda: metallic(lathe(_TIN), 0xC8332B, (0.04, 1.0)),
    "four-properties/pictures/fruit_crate.jpg": lambda: wooden(
        box((1.05, 0.70, 0.75), (0.0, 0.70, 0.0), 0.03), 0xC8332B, 0.28
    ),
    "four-properties/pictures/tool_box.jpg": lambda: metallic(
        joined(box((1.05, 0.60, 0.55), (0.0, 0.60, 0.0), 0.06), _HANDLE), 0xC8332B, (0.85,)
    ),
    "four-properties/pictures/tea_tin.jpg": lambda: metallic(
        box((0.38, 0.55, 0.38), (0.0, 0.55, 0.0), 0.04), 0x2E9E55, (0.86,)
    ),
    "four-properties/pictures/milk_jug.jpg": lambda: ceramic(
        joined(lathe(smooth(_JUG)), ring((0.50, 0.70, 0.0), 0.24, 0.06)), 0x2E9E55, 0.18
    ),
    "four-properties/pictures/barrel.jpg": lambda: wooden(lathe(smooth(_BARREL)), 0x2E9E55, 0.50),
    "four-properties/pictures/floor_vase.jpg": lambda: ceramic(lathe(smooth(_VASE)), 0x2E9E55, 0.22),
}


def main() -> None:
    """Draw all pictures into the template folders."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    shipped = Path(__file__).parents[2] / "templates"
    parser.add_argument(
        "templates",
        nargs="?",
        type=Path,
        metavar="FOLDER",
        default=shipped,
        help="folder of the template sets (default templates)",
    )
    templates: Path = parser.parse_args().templates
    for name, solid in PICTURES.items():
        path = templates / name
        path.parent.mkdir(parents=True, exist_ok=True)
        draw(solid()).save(path, quality=92, subsampling=0)
        print(path)


if __name__ == "__main__":
    main()
