"""The view on the map: its position and scale, and transforms from map metres to pixels and back."""

import math
from dataclasses import dataclass, replace

from sim.numerics.float_array import FloatArray

MAX_SCALE = 400.0
"""Largest scale, pixels a metre."""

MIN_SCALE = 2.0
"""Smallest scale, pixels a metre."""


@dataclass(frozen=True, slots=True)
class Camera:
    """A view straight down with north (+y) up; pixels are logical ones, from the upper left corner.

    Attributes:
        x: of the middle of the view, map frame, metres.
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
        """Return a view of a box (least x, least y, most x, most y; metres) with a margin around it, pixels."""
        left, bottom, right, top = bounds
        across = max(width - 2.0 * margin, 1.0) / max(right - left, 1e-6)
        up = max(height - 2.0 * margin, 1.0) / max(top - bottom, 1e-6)
        scale = min(max(min(across, up), MIN_SCALE), MAX_SCALE)
        return cls((left + right) / 2.0, (bottom + top) / 2.0, scale, width, height)

    def moved_within(self, left: float, top: float, width: float, height: float) -> "Camera":
        """Return this view of a part of a wider one, which begins so many pixels right of and below its corner."""
        x, y = self.point(width / 2.0 - left, height / 2.0 - top)
        return replace(self, x=x, y=y, width=width, height=height)

    def to_screen(self, points: FloatArray) -> FloatArray:
        """Return the (n, 2) pixels of (n, 2) map points."""
        pixels: FloatArray = (points - (self.x, self.y)) * (self.scale, -self.scale)
        pixels += (self.width / 2.0, self.height / 2.0)
        return pixels

    def to_map(self, pixels: FloatArray) -> FloatArray:
        """Return the (n, 2) map points under (n, 2) pixels."""
        points: FloatArray = (pixels - (self.width / 2.0, self.height / 2.0)) / (self.scale, -self.scale)
        points += (self.x, self.y)
        return points

    def pixel(self, x: float, y: float) -> tuple[float, float]:
        """Return the pixel of a map point."""
        return self.width / 2.0 + (x - self.x) * self.scale, self.height / 2.0 - (y - self.y) * self.scale

    def point(self, px: float, py: float) -> tuple[float, float]:
        """The map point under a pixel."""
        return self.x + (px - self.width / 2.0) / self.scale, self.y - (py - self.height / 2.0) / self.scale

    def zoomed(self, factor: float, px: float, py: float) -> "Camera":
        """Return a view at a larger scale, by a factor; the map point under a pixel stays under it."""
        scale = min(max(self.scale * factor, MIN_SCALE), MAX_SCALE)
        x, y = self.point(px, py)
        keep = self.scale / scale
        return replace(self, x=x + (self.x - x) * keep, y=y + (self.y - y) * keep, scale=scale)

    def dragged(self, dx: float, dy: float) -> "Camera":
        """Return the view after the map was dragged by so many pixels."""
        return replace(self, x=self.x - dx / self.scale, y=self.y + dy / self.scale)

    def snapped(self, ratio: float) -> "Camera":
        """Return the view with the map's origin on a whole device pixel, so that cached pictures shift without blur.

        Args:
            ratio: device pixels per logical pixel.
        """
        px, py = self.pixel(0.0, 0.0)
        dx, dy = math.floor(px * ratio + 0.5) / ratio - px, math.floor(py * ratio + 0.5) / ratio - py
        # A snapped camera must come back bit for bit: painters compare cameras to see if a cached picture still holds.
        return self if math.hypot(dx, dy) < 1e-6 else self.dragged(dx, dy)

    def sees(self, x: float, y: float, margin: float) -> bool:
        """Return True when a map point lies in the view, widened by a margin in pixels."""
        px, py = self.pixel(x, y)
        return -margin <= px <= self.width + margin and -margin <= py <= self.height + margin
