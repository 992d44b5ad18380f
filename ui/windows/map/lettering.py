"""Letters on the map: their heights are in pixels, and depend on the size of text."""

from PySide6.QtGui import QFont

USUAL = 10.5
"""Size of text in points at which lengths on the map have their nominal values."""


LEAST = 400
"""If a map is larger than this width and height, its letters may be larger than usual, logical pixels."""


def fitting_font(font: QFont, width: int, height: int) -> QFont:
    """Return the font of a map of this size. On a small map, large letters would cover the labeled objects."""
    made = QFont(font)
    made.setPointSizeF(min(font.pointSizeF(), USUAL * max(1.0, min(width, height) / LEAST)))
    return made


def text_scale(font: QFont) -> float:
    """Return the current size of letters, signs and labels, as a multiple of their nominal size."""
    return font.pointSizeF() / USUAL if font.pointSizeF() > 0.0 else 1.0


def sized(font: QFont, pixels: float, weight: QFont.Weight) -> QFont:
    """Return a font with letters of this height and this weight."""
    made = QFont(font)
    made.setPixelSize(max(1, round(pixels)))
    made.setWeight(weight)
    return made
