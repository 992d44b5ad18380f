"""Rooms on the map: sign, pattern and color show a room's state; a frame shows that the room can be chosen."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import (
    QBrush,
    QColor,
    QFont,
    QFontMetricsF,
    QPainter,
    QPainterPath,
    QPainterPathStroker,
    QPen,
    QPixmap,
    QTransform,
)

from sim.numerics.float_array import FloatArray
from ui.model.shared.map_geometry import MapGeometry, contains
from ui.model.shared.scene import RoomMark, RoomState
from ui.model.shared.theme import Palette
from ui.windows.map.lettering import sized, text_scale
from ui.windows.map.points import mapped, polygon

HATCH_SPACING = 11.0
"""Distance between two stripes of the pattern of a reserved room, pixels."""

DOT_SPACING = 16.0
"""Distance between two dots of the pattern of a visited room, pixels."""

SIGN_RADIUS = 11.0
"""Radius of a room's sign, pixels at the usual size of text."""

PATTERN_ALPHA = 46
"""Opacity of a pattern, 0 to 255: visible, but faint enough to see robots on it."""

NUMBER_MIN, NUMBER_MAX = 15.0, 40.0
"""Smallest and greatest height of a room's number, pixels at the usual size of text."""

POSITIONS = 14
"""Number of positions along each axis of a room that are tried for words and signs."""

FRAME_INSET = 4.0
"""Distance between a wall and the frame of a room that can be chosen, pixels."""

HALF_WALL = 0.06
"""Half the usual thickness of a wall, meters."""

NAME_HEIGHT = 13.0
"""Height of a room's name, pixels at the usual size of text."""


def paint_floors(painter: QPainter, to_pixels: QTransform, rooms: Sequence[RoomMark], palette: Palette) -> None:
    """Paint the floors of the rooms with their patterns. The walls are painted later, over the edges of the floors."""
    ratio = painter.device().devicePixelRatio()
    stripes, dots = _pattern("reserved", palette, ratio), _pattern("visited", palette, ratio)
    for mark in rooms:
        outline = polygon(mapped(to_pixels, mark.region))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(palette.room(mark.state)))
        painter.drawPolygon(outline)
        if mark.considered:
            painter.setBrush(_faint(palette.accent))
            painter.drawPolygon(outline)
        if mark.state != "unvisited":
            painter.setBrush(stripes if mark.state == "reserved" else dots)
            painter.setBrushOrigin(outline.boundingRect().topLeft())
            painter.drawPolygon(outline)


def paint_signs(
    painter: QPainter,
    to_pixels: QTransform,
    rooms: Sequence[RoomMark],
    palette: Palette,
    font: QFont,
    geometry: MapGeometry | None,
) -> FloatArray:
    """Paint frames, numbers, names, signs of state and finds. They cover walls, but neither robots nor furniture.

    Returns:
        (m, 4) left, top, right and bottom of all texts and signs, pixels.
    """
    written: list[tuple[float, float, float, float]] = []
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for mark in rooms:
        _paint_edge(painter, to_pixels, mark, palette)
        space = _Space(to_pixels, mark.region, geometry)
        _paint_words(painter, space, mark, palette, font)
        written += [(box.left(), box.top(), box.right(), box.bottom()) for box in space.taken]
    painter.restore()
    return np.array(written).reshape(-1, 4)


def _paint_edge(painter: QPainter, to_pixels: QTransform, mark: RoomMark, palette: Palette) -> None:
    """Paint a frame inside the walls of a room that can be chosen.

    The frame is stronger while a person considers the room.
    """
    if not mark.choosable and not mark.considered:
        return
    path = QPainterPath()
    path.addPolygon(polygon(mapped(to_pixels, mark.region)))
    path.closeSubpath()
    border = QPainterPathStroker()
    border.setWidth(2.0 * (FRAME_INSET + HALF_WALL * to_pixels.m11()))
    pen = QPen(QColor(palette.accent), 4.0 if mark.considered else 2.0)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    if not mark.choosable:
        pen.setDashPattern([1.0, 2.0])
    painter.setPen(pen)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawPath(path.subtracted(border.createStroke(path)))


def _from_corner() -> FloatArray:
    """Return (n, 2) places in a unit square, beginning with the places nearest to the corner (0, 0)."""
    shares = np.linspace(0.0, 1.0, POSITIONS)
    places: FloatArray = np.stack(np.meshgrid(shares, shares), axis=-1).reshape(-1, 2)
    return places[np.argsort(places.sum(axis=1), kind="stable")]


_FROM_CORNER = _from_corner()


class _Space:
    """Free space in a room for words and signs, pixels; they must not cover walls or each other.

    Attributes:
        taken: boxes that are already used.
    """

    def __init__(self, to_pixels: QTransform, region: FloatArray, geometry: MapGeometry | None) -> None:
        corners = mapped(to_pixels, region)
        (self._left, self._top), (right, bottom) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
        self.width, self.height = right - self._left, bottom - self._top
        self.inset = (
            FRAME_INSET + HALF_WALL * to_pixels.m11() + min(max(0.04 * min(self.width, self.height), 4.0), 14.0)
        )
        self._to_map, _ = to_pixels.inverted()
        self._region = region
        self._geometry = geometry
        self.taken: list[QRectF] = []

    def put(self, width: float, height: float, right: bool, low: bool) -> QRectF | None:
        """Reserve a box of this size as near as possible to a corner of the room; return None if no box fits."""
        slack = np.array([self.width - width, self.height - height]) - 2.0 * self.inset
        if slack.min() < 0.0:
            return None
        shares = np.abs((float(right), float(low)) - _FROM_CORNER)
        places = shares * slack + (self._left + self.inset, self._top + self.inset)
        # Usually the corner is free, and no other place needs to be tested.
        for some in (places[:1], places[1:]):
            for x, y in some[self._is_free(some, width, height)].tolist():
                box = QRectF(x, y, width, height)
                if not any(box.adjusted(-4.0, -4.0, 4.0, 4.0).intersects(taken) for taken in self.taken):
                    self.taken.append(box)
                    return box
        return None

    def _is_free(self, places: FloatArray, width: float, height: float) -> NDArray[np.bool_]:
        """Return (n,) True for each of (n, 2) upper left corners whose box is in the room and covers no wall."""
        x, y = width + self.inset / 2.0, height + self.inset / 2.0
        least = -self.inset / 2.0
        around = np.array([[least, least], [x, least], [x, y], [least, y]])
        corners = mapped(self._to_map, (places[:, None] + around).reshape(-1, 2))
        free: NDArray[np.bool_] = np.all(contains(self._region, corners).reshape(-1, 4), axis=1)
        return free if self._geometry is None else free & self._geometry.is_clear(corners.reshape(-1, 4, 2))


def _paint_words(painter: QPainter, space: _Space, mark: RoomMark, palette: Palette, font: QFont) -> None:
    # If a room is too small for large letters, use the normal size, because state and number are most important.
    for scale in sorted({text_scale(font), min(text_scale(font), 1.0)}, reverse=True):
        sign = space.put(2.0 * SIGN_RADIUS * scale, 2.0 * SIGN_RADIUS * scale, right=True, low=False)
        if sign is not None:
            _paint_sign(painter, sign.center(), mark, palette, scale)
            break
    # If there is space for only one of the two texts, show the answer, because it is new.
    texts = (mark.answer, *mark.answer_shorter), (mark.found, *mark.found_shorter)
    pills = [_Pill(space, words, font, shorter) for words, *shorter in texts if words]
    for scale in sorted({text_scale(font), min(text_scale(font), 1.0)}, reverse=True):
        if _paint_title(painter, space, mark, palette, font, scale, pills if mark.answer else ()):
            for pill in pills:
                _paint_pill(painter, pill, palette)
            break


def _paint_title(
    painter: QPainter,
    space: _Space,
    mark: RoomMark,
    palette: Palette,
    font: QFont,
    scale: float,
    before_name: "Sequence[_Pill]",
) -> bool:
    """Paint a room's number, and also its name if there is space for it.

    Return False if there is no space for the number.
    """
    number = min(max(min(space.width, space.height) * 0.2, NUMBER_MIN * scale), NUMBER_MAX * scale)
    large, small = sized(font, number, QFont.Weight.DemiBold), sized(font, NAME_HEIGHT * scale, QFont.Weight.Normal)
    heading, caption = QFontMetricsF(large), QFontMetricsF(small)
    name = caption.elidedText(mark.name, Qt.TextElideMode.ElideRight, space.width - 2.0 * space.inset)
    text = str(mark.room)
    tall = heading.capHeight() + 0.3 * caption.height() + caption.height()
    wide = max(heading.horizontalAdvance(text), caption.horizontalAdvance(name))
    title = space.put(wide, tall, right=False, low=False)
    if title is not None and not _have_space(space, before_name):
        space.taken.remove(title)
        title = None
    if title is None:
        name = ""
        title = space.put(heading.horizontalAdvance(text), heading.capHeight(), right=False, low=False)
    if title is None:
        return False
    painter.setPen(QColor(palette.text))
    painter.setFont(large)
    painter.drawText(QPointF(title.left(), title.top() + heading.capHeight()), text)
    painter.setPen(QColor(palette.muted))
    painter.setFont(small)
    painter.drawText(QPointF(title.left(), title.bottom() - caption.descent()), name)
    return True


class _Pill:
    """Words in a frame in a lower corner of a room. If there is too little space, the words are shortened."""

    def __init__(self, space: _Space, text: str, font: QFont, shorter: Sequence[str] = ()) -> None:
        self.font = sized(font, NAME_HEIGHT * text_scale(font), QFont.Weight.Medium)
        metrics = QFontMetricsF(self.font)
        width = space.width - 2.0 * space.inset - 16.0
        texts = text, *shorter, *_first_words((text, *shorter)[-1])
        # If not even one word fits, nothing is shown.
        self.words = next((each for each in texts if metrics.horizontalAdvance(each) <= width), "")
        self._size = metrics.horizontalAdvance(self.words) + 16.0, metrics.height() + 6.0
        self._space = space

    def put(self) -> QRectF | None:
        """Reserve a box for the words. Return None if there are no words, or if there is no space."""
        return self._space.put(*self._size, right=False, low=True) if self.words else None


def _have_space(space: _Space, pills: Sequence[_Pill]) -> bool:
    """Return True if there is space for all pills, without reserving it."""
    boxes = [pill.put() for pill in pills if pill.words]
    for box in boxes:
        if box is not None:
            space.taken.remove(box)
    return None not in boxes


def _first_words(text: str) -> tuple[str, ...]:
    """Return shorter and shorter beginnings of a text, each followed by an ellipsis."""
    words = text.split(" ")
    return tuple(f"{' '.join(words[:count])} …" for count in range(len(words) - 1, 0, -1))


def _paint_pill(painter: QPainter, pill: _Pill, palette: Palette) -> None:
    box = pill.put()
    if box is None:
        return
    painter.setPen(QPen(QColor(palette.line), 1.0))
    painter.setBrush(QColor(palette.panel))
    painter.drawRoundedRect(box, box.height() / 2.0, box.height() / 2.0)
    painter.setPen(QColor(palette.text))
    painter.setFont(pill.font)
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, pill.words)


_STROKES: dict[RoomState, list[list[tuple[float, float]]]] = {
    "visited": [[(-0.6, 0.0), (0.6, 0.0)]],
    "won": [[(-5.0, 0.5), (-1.5, 4.0), (5.0, -3.5)]],
    "lost": [[(-4.0, -4.0), (4.0, 4.0)], [(-4.0, 4.0), (4.0, -4.0)]],
}
"""Lines on the disc of a visited room, pixels from its middle at the normal size of text."""


def _paint_sign(painter: QPainter, centre: QPointF, mark: RoomMark, palette: Palette, scale: float) -> None:
    """Paint the state of a room.

    An open circle means that the room is not visited. Arrows mean that a robot is on its way. A disc means that the
    room is visited: with a dot, or with a tick for won points, or with a cross for lost points. Arrows and discs have
    the robot's color.
    """
    painter.save()
    painter.translate(centre)
    painter.scale(scale, scale)
    _paint_sign_of_usual_size(painter, mark, palette)
    painter.restore()


def _paint_sign_of_usual_size(painter: QPainter, mark: RoomMark, palette: Palette) -> None:
    centre = QPointF(0.0, 0.0)
    colour = QColor(palette.line if mark.robot is None else palette.robot(mark.robot))
    if mark.state == "unvisited":
        painter.setPen(QPen(QColor(palette.line), 2.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(centre, SIGN_RADIUS - 3.0, SIGN_RADIUS - 3.0)
        return
    if mark.state == "reserved":
        painter.setPen(QPen(colour, 2.0))
        painter.setBrush(QColor(palette.panel))
        painter.drawEllipse(centre, SIGN_RADIUS, SIGN_RADIUS)
        strokes = [[(-5.0, -4.5), (-0.5, 0.0), (-5.0, 4.5)], [(0.5, -4.5), (5.0, 0.0), (0.5, 4.5)]]
    else:
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(colour)
        painter.drawEllipse(centre, SIGN_RADIUS, SIGN_RADIUS)
        colour = QColor(palette.panel)
        strokes = _STROKES[mark.state]
    pen = QPen(colour, 5.0 if mark.state == "visited" else 2.4)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    painter.setPen(pen)
    for stroke in strokes:
        painter.drawPolyline(polygon(np.array(stroke)))


def _pattern(state: str, palette: Palette, ratio: float) -> QBrush:
    """Return a brush with stripes for a reserved room, or with dots for a visited room.

    Filling a room with a tile is faster than drawing single strokes.
    """
    step = HATCH_SPACING if state == "reserved" else DOT_SPACING
    tile = QPixmap(round(step * ratio), round(step * ratio))
    tile.fill(Qt.GlobalColor.transparent)
    size = float(tile.width())
    painter = QPainter(tile)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    if state == "reserved":
        painter.setPen(QPen(_faint(palette.text), 1.4 * ratio))
        # In addition to the stripe itself, draw the corners of its neighbors that reach into the tile.
        for shift in (-size, 0.0, size):
            painter.drawLine(QLineF(shift - size, 2.0 * size, shift + 2.0 * size, -size))
    else:
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(_faint(palette.text))
        painter.drawEllipse(QPointF(size / 2.0, size / 2.0), 1.3 * ratio, 1.3 * ratio)
    painter.end()
    brush = QBrush(tile)
    brush.setTransform(QTransform.fromScale(1.0 / ratio, 1.0 / ratio))
    return brush


def _faint(colour: str) -> QColor:
    faint = QColor(colour)
    faint.setAlpha(PATTERN_ALPHA)
    return faint
