"""Which piece of the map is seen, and how large: map metres to pixels and back."""

import math
from dataclasses import dataclass, replace

from sim.common.geometry import FloatArray

MAX_SCALE = 400.0
"""Most pixels a metre."""

MIN_SCALE = 2.0
"""Fewest pixels a metre."""


@dataclass(frozen=True, slots=True)
class Camera:
    """A view straight down with north (+y) up; pixels are logical ones, from the upper left corner.

    Attributes:
        x: map metres in the middle of the view.
        y: the same.
        scale: pixels a metre.
        width: of the view, pixels.
        height: of the view, pixels.
    """

    x: float
    y: float
    scale: float
    width: float
    height: float

    @classmethod
    def fitted(cls, bounds: tuple[float, float, float, float], width: float, height: float, margin: float) -> "Camera":
        """All of a box (least x, least y, most x, most y; metres) with a margin of so many pixels around it."""
        left, bottom, right, top = bounds
        across = max(width - 2.0 * margin, 1.0) / max(right - left, 1e-6)
        up = max(height - 2.0 * margin, 1.0) / max(top - bottom, 1e-6)
        scale = min(max(min(across, up), MIN_SCALE), MAX_SCALE)
        return cls((left + right) / 2.0, (bottom + top) / 2.0, scale, width, height)

    def to_screen(self, points: FloatArray) -> FloatArray:
        """(n, 2) pixels of (n, 2) map points."""
        pixels: FloatArray = (points - (self.x, self.y)) * (self.scale, -self.scale)
        pixels += (self.width / 2.0, self.height / 2.0)
        return pixels

    def to_map(self, pixels: FloatArray) -> FloatArray:
        """(n, 2) map points under (n, 2) pixels."""
        points: FloatArray = (pixels - (self.width / 2.0, self.height / 2.0)) / (self.scale, -self.scale)
        points += (self.x, self.y)
        return points

    def pixel(self, x: float, y: float) -> tuple[float, float]:
        """Where a map point is seen."""
        return self.width / 2.0 + (x - self.x) * self.scale, self.height / 2.0 - (y - self.y) * self.scale

    def point(self, px: float, py: float) -> tuple[float, float]:
        """The map point under a pixel."""
        return self.x + (px - self.width / 2.0) / self.scale, self.y - (py - self.height / 2.0) / self.scale

    def zoomed(self, factor: float, px: float, py: float) -> "Camera":
        """Larger by a factor; the map point under a pixel stays under it."""
        scale = min(max(self.scale * factor, MIN_SCALE), MAX_SCALE)
        x, y = self.point(px, py)
        keep = self.scale / scale
        return replace(self, x=x + (self.x - x) * keep, y=y + (self.y - y) * keep, scale=scale)

    def dragged(self, dx: float, dy: float) -> "Camera":
        """The map moved by so many pixels."""
        return replace(self, x=self.x - dx / self.scale, y=self.y + dy / self.scale)

    def centred(self, x: float, y: float) -> "Camera":
        """With this map point in the middle."""
        return replace(self, x=x, y=y)

    def resized(self, width: float, height: float) -> "Camera":
        """The same middle in a view of another size."""
        return replace(self, width=width, height=height)

    def snapped(self, ratio: float) -> "Camera":
        """With the map's origin on a whole device pixel, so that pictures made once can be shifted without blur.

        Args:
            ratio: device pixels a logical pixel.
        """
        px, py = self.pixel(0.0, 0.0)
        dx, dy = math.floor(px * ratio + 0.5) / ratio - px, math.floor(py * ratio + 0.5) / ratio - py
        # One that is snapped already stays the same to the bit, by which those know it who keep what they have painted.
        return self if math.hypot(dx, dy) < 1e-6 else self.dragged(dx, dy)

    def sees(self, x: float, y: float, margin: float) -> bool:
        """Whether a map point lies in the view, widened by a margin in pixels."""
        px, py = self.pixel(x, y)
        return -margin <= px <= self.width + margin and -margin <= py <= self.height + margin
