"""Labels of robots: cached pictures, and positions at which labels avoid robots, words and other labels."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPen, QPixmap, QPolygonF

from sim.numerics.float_array import FloatArray
from ui.model.shared.theme import Palette
from ui.windows.map.lettering import text_scale

LABEL_HEIGHT = 20.0
"""Height of a label, pixels at the usual size of text."""

TEXT_HEIGHT = 12
"""Height of a label's letters, pixels."""

GAP = 4.0
"""Distance between a robot and its label, pixels."""

SIGN_WIDTH = 19.0
"""Width of a sign in a label, pixels."""

_SIDES = np.array([(0, -1), (0, 1), (1, 0), (-1, 0), (1, -1), (-1, -1), (1, 1), (-1, 1)], dtype=np.float64)
_REACHES = (1.0, 1.9, 2.8)
"""Possible directions of a label from its robot, the best first, and possible distances, in heights of the label."""

OVERLAP_WEIGHT, ROBOT_WEIGHT, WORDS_WEIGHT, RANK_WEIGHT, MOVE_WEIGHT = 4.0, 1.0, 2.0, 6.0, 30.0
"""Weights in the cost of a position: per square pixel over another label, over a robot, and over words; per rank of the
position; and for a change of the position."""


@dataclass(frozen=True, slots=True)
class Anchor:
    """Robot that needs a label: its middle and radius on the screen, and the size of its label, pixels."""

    x: float
    y: float
    radius: float
    width: float
    height: float


def place_labels(anchors: Sequence[Anchor], before: Sequence[int], words: FloatArray) -> tuple[FloatArray, list[int]]:
    """Choose positions for labels, one label after another.

    If no label overlaps anything at its old position, all labels stay there. Otherwise the search is greedy: each label
    gets the cheapest of 24 positions around its robot, given the labels placed so far.

    Args:
        anchors: the robots, in order of precedence.
        before: number of the previous position of each label, so that labels do not jump around; -1 if there is none.
        words: (m, 4) boxes that should stay readable: left, top, right, bottom.

    Returns:
        (n, 2) upper left corners, and the positions' numbers.
    """
    about = np.array([(a.x, a.y, a.radius, a.width, a.height) for a in anchors]).reshape(-1, 5)
    places = _places(about)
    bodies = np.concatenate((about[:, :2] - about[:, 2:3], about[:, :2] + about[:, 2:3]), axis=1)
    kept = places[np.arange(len(before)), before]
    near = all(0 <= had < len(_SIDES) for had in before)
    if near and not _crowded(kept, np.concatenate((bodies, words))):
        return kept[:, :2], list(before)
    numbers: list[int] = []
    taken = np.zeros((len(anchors), 4))
    best = RANK_WEIGHT * np.arange(len(_SIDES) * len(_REACHES), dtype=np.float64)
    for at, had in enumerate(before):
        boxes = places[at]
        cost = best + OVERLAP_WEIGHT * _overlap(boxes, taken[:at])
        cost += ROBOT_WEIGHT * _overlap(boxes, bodies) + WORDS_WEIGHT * _overlap(boxes, words)
        if had >= 0:
            cost[had] -= MOVE_WEIGHT
        number = int(np.argmin(cost))
        taken[at] = boxes[number]
        numbers.append(number)
    return taken[:, :2], numbers


def _places(about: FloatArray) -> FloatArray:
    """Return (n, k, 4) possible boxes of labels, given (n, 5) middles, radii and sizes."""
    half = about[:, None, 3:5] / 2.0
    rings = np.repeat(np.array(_REACHES) - 1.0, len(_SIDES))[None, :, None]
    reach = about[:, None, 2:3] + GAP + half + rings * about[:, None, 4:5]
    middles = about[:, None, 0:2] + np.tile(_SIDES, (len(_REACHES), 1))[None] * reach
    boxes: FloatArray = np.concatenate((middles - half, middles + half), axis=2)
    return boxes


def _crowded(boxes: FloatArray, others: FloatArray) -> bool:
    """Return True if a label overlaps another label or one of the other boxes."""
    own = np.sum((boxes[:, 2] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 1]))
    return bool(np.sum(_overlap(boxes, np.concatenate((boxes, others)))) > own + 1e-6)


def _overlap(boxes: FloatArray, others: FloatArray) -> FloatArray:
    """Return the (k,) areas that each of (k, 4) boxes shares with (m, 4) other boxes."""
    across = np.minimum(boxes[:, None, 2], others[None, :, 2]) - np.maximum(boxes[:, None, 0], others[None, :, 0])
    down = np.minimum(boxes[:, None, 3], others[None, :, 3]) - np.maximum(boxes[:, None, 1], others[None, :, 1])
    area: FloatArray = np.sum(np.clip(across, 0.0, None) * np.clip(down, 0.0, None), axis=1)
    return area


@dataclass(frozen=True, slots=True)
class BadgeText:
    """Text and state on a robot's label.

    Attributes:
        label: name of the robot.
        `colour`: color of the robot.
        selected: True if the robot is selected; the label is then filled.
        trouble: True if the robot has a problem; the label then has a warning sign.
        commander: name of another commander of the robot, shown after the sign of a mast; empty if there is none.
    """

    label: str
    colour: str
    selected: bool
    trouble: bool
    commander: str


@dataclass(frozen=True, slots=True)
class Badge:
    """Picture of a label and its size in logical pixels."""

    picture: QPixmap
    width: float
    height: float


class Badges:
    """Cache of the pictures of labels."""

    def __init__(self) -> None:
        self._made: dict[tuple[BadgeText, float, str, float], Badge] = {}

    def clear(self) -> None:
        """Delete all pictures, because the palette or the font changes."""
        self._made.clear()

    def of(self, badge_text: BadgeText, palette: Palette, font: QFont, ratio: float) -> Badge:
        """Return the picture of a label."""
        key = (badge_text, ratio, palette.panel, text_scale(font))
        badge = self._made.get(key)
        if badge is None:
            badge = self._made[key] = _made(badge_text, palette, font, ratio)
        return badge


def _made(badge_text: BadgeText, palette: Palette, font: QFont, ratio: float) -> Badge:
    face = QFont(font)
    face.setPixelSize(TEXT_HEIGHT)
    face.setWeight(QFont.Weight.Bold)
    metrics = QFontMetricsF(face)
    warning = SIGN_WIDTH if badge_text.trouble else 0.0
    own, other = metrics.horizontalAdvance(badge_text.label), metrics.horizontalAdvance(badge_text.commander)
    mast = SIGN_WIDTH + other + GAP if badge_text.commander else 0.0
    width = float(round(max(own + warning + mast + 13.0, LABEL_HEIGHT)))
    scale = text_scale(font)
    picture = QPixmap(round(width * ratio * scale), round(LABEL_HEIGHT * ratio * scale))
    picture.setDevicePixelRatio(ratio)
    picture.fill(Qt.GlobalColor.transparent)
    painter = QPainter(picture)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.scale(scale, scale)
    colour, selected = badge_text.colour, badge_text.selected
    ink = QColor(palette.panel if selected else palette.text)
    painter.setPen(QPen(QColor(palette.panel if selected else colour), 1.5))
    painter.setBrush(QColor(colour if selected else palette.panel))
    pill = QRectF(0.75, 0.75, width - 1.5, LABEL_HEIGHT - 1.5)
    painter.drawRoundedRect(pill, pill.height() / 2.0, pill.height() / 2.0)
    if badge_text.trouble:
        _paint_warning(painter, palette, face, on_colour=selected)
    painter.setFont(face)
    painter.setPen(ink)
    baseline = (LABEL_HEIGHT + metrics.capHeight()) / 2.0
    left = warning + (width - warning - mast - own) / 2.0
    painter.drawText(QPointF(left, baseline), badge_text.label)
    if badge_text.commander:
        _paint_mast(painter, left + own + GAP, ink)
        painter.drawText(QPointF(left + own + SIGN_WIDTH + GAP, baseline), badge_text.commander)
    painter.end()
    return Badge(picture, width * scale, LABEL_HEIGHT * scale)


def _paint_mast(painter: QPainter, left: float, ink: QColor) -> None:
    """Paint the sign of another commander: a radio mast with waves on both sides."""
    painter.setPen(QPen(ink, 1.4))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    middle = left + SIGN_WIDTH / 2.0 - 2.0
    painter.drawLine(QPointF(middle, 8.0), QPointF(middle, 15.0))
    for reach in (3.0, 6.0):
        around = QRectF(middle - reach, 8.0 - reach, 2.0 * reach, 2.0 * reach)
        # Qt counts angles in sixteenths of a degree.
        painter.drawArc(around, -45 * 16, 90 * 16)
        painter.drawArc(around, 135 * 16, 90 * 16)


def _paint_warning(painter: QPainter, palette: Palette, font: QFont, *, on_colour: bool) -> None:
    """Paint a triangle with an exclamation mark on the left of a label.

    A red triangle would not be visible on a robot's color.
    """
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(palette.panel if on_colour else palette.bad))
    painter.drawPolygon(QPolygonF([QPointF(13.0, 2.5), QPointF(20.5, 16.0), QPointF(5.5, 16.0)]))
    painter.setPen(QColor(palette.bad if on_colour else palette.panel))
    mark = QFont(font)
    mark.setPixelSize(10)
    painter.setFont(mark)
    painter.drawText(QRectF(6.0, 5.0, 14.0, 11.0), Qt.AlignmentFlag.AlignCenter, "!")
