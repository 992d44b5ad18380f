"""Drawings of noise. A separate thread paints them, and the window shows them when they are finished."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, cast

import numpy as np
from pyqtgraph.functions import arrayToQPolygonF
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QPen, QPolygonF, QResizeEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from sim.numerics.float_array import FloatArray
from thbridge.offline.noise import PathSpread, RoomScan
from ui.model.shared.theme import Palette
from ui.model.study_form.noise import NoisePreview
from ui.windows.look import GAP, follow_text, px

_EDGE = 1.5 * GAP
_RULER = 1.0
"""Length of the ruler, meters."""


@dataclass(frozen=True, slots=True)
class Canvas:
    """Target of a drawing: size in logical pixels, pixels per logical pixel, colors, and height of letters in logical
    pixels."""

    size: QSize
    ratio: float
    palette: Palette
    letters: int


PaintFunction = Callable[[NoisePreview, Canvas], QImage]


class NoisePicture(QWidget):
    """Widget that shows one drawing.

    Attributes:
        paint: function that makes the drawing.
    """

    def __init__(self, paint: PaintFunction, name: str, height: int, resized: Callable[[], None]) -> None:
        super().__init__()
        self.paint = paint
        self.setAccessibleName(name)
        follow_text(self, lambda it: it.setMinimumSize(120, px(height)))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self._image = QImage()
        self._resized = resized

    def canvas(self, palette: Palette) -> Canvas:
        """Return the target of the drawing."""
        return Canvas(self.size(), self.devicePixelRatioF(), palette, px(11))

    def show_image(self, image: QImage, words: str) -> None:
        """Show a finished drawing."""
        self._image = image
        self.setAccessibleDescription(words)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the image. Until an image in the new size is finished, draw the old image in the new size."""
        painter = QPainter(self)
        if not self._image.isNull():
            painter.drawImage(self.rect(), self._image)
        painter.end()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Request a drawing in the new size."""
        super().resizeEvent(event)
        self._resized()


class _Sheet:
    """Image with a scale in meters. x points right, y points up, and both axes have the same scale."""

    def __init__(self, canvas: Canvas, points: FloatArray) -> None:
        self.palette = canvas.palette
        size = canvas.size * canvas.ratio
        self.image = QImage(size, QImage.Format.Format_ARGB32_Premultiplied)
        self.image.setDevicePixelRatio(canvas.ratio)
        self.image.fill(QColor(canvas.palette.panel))
        low, high = points.min(axis=0), points.max(axis=0)
        width, height = canvas.size.width() - 2 * _EDGE, canvas.size.height() - 2 * _EDGE
        spans = np.maximum(high - low, 1e-6)
        self._scale = max(1e-3, float(min(width / spans[0], height / spans[1])))
        middle = 0.5 * (low + high)
        self._x = 0.5 * canvas.size.width() - self._scale * float(middle[0])
        self._y = 0.5 * canvas.size.height() + self._scale * float(middle[1])
        self._size, self._letters = canvas.size, canvas.letters
        self.painter = QPainter(self.image)
        self.painter.setRenderHint(QPainter.RenderHint.Antialiasing)

    def polygon(self, points: FloatArray) -> QPolygonF:
        """Convert points in meters to a Qt polygon."""
        xs, ys = self._x + self._scale * points[:, 0], self._y - self._scale * points[:, 1]
        return cast(QPolygonF, arrayToQPolygonF(xs, ys))

    def line(self, points: FloatArray, colour: str, width: float, *, dashed: bool = False) -> None:
        """Draw a line through points."""
        pen = QPen(QColor(colour), width)
        if dashed:
            pen.setStyle(Qt.PenStyle.DashLine)
        self.painter.setPen(pen)
        self.painter.drawPolyline(self.polygon(points))

    def hairs(self, paths: FloatArray, colour: str, alpha: int) -> None:
        """Draw many lines, (n, k, 2), one pixel wide. Thicker lines would take ten times as long."""
        ink = QColor(colour)
        ink.setAlpha(alpha)
        pen = QPen(ink, 1.0)
        pen.setCosmetic(True)
        self.painter.setPen(pen)
        for path in paths:
            self.painter.drawPolyline(self.polygon(path))

    def dots(self, points: FloatArray, colour: str, size: float) -> None:
        """Draw round dots."""
        pen = QPen(QColor(colour), size)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        self.painter.setPen(pen)
        self.painter.drawPoints(self.polygon(points))

    def crosses(self, points: FloatArray, colour: str, size: float) -> None:
        """Draw small crosses, which differ from dots even without color."""
        self.painter.setPen(QPen(QColor(colour), 1.4))
        for point in self.polygon(points).toList():
            x, y = point.x(), point.y()
            self.painter.drawLine(QPointF(x - size, y - size), QPointF(x + size, y + size))
            self.painter.drawLine(QPointF(x - size, y + size), QPointF(x + size, y - size))

    def finished(self) -> QImage:
        """Return the image, with a ruler in its corner."""
        length = _RULER * self._scale
        y = self._size.height() - _EDGE * 0.6
        pen = QPen(QColor(self.palette.muted), 1.5)
        self.painter.setPen(pen)
        self.painter.drawLine(QPointF(_EDGE, y), QPointF(_EDGE + length, y))
        for x in (_EDGE, _EDGE + length):
            self.painter.drawLine(QPointF(x, y - 3), QPointF(x, y + 3))
        font = self.painter.font()
        font.setPixelSize(self._letters)
        self.painter.setFont(font)
        box = QRectF(_EDGE + length + 6, y - self._letters, 6 * self._letters, 2 * self._letters)
        self.painter.drawText(box, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, "1 m")
        self.painter.end()
        return self.image


def fan_image(fan: PathSpread, other: PathSpread, canvas: Canvas, colour: str, *, dashed: bool) -> QImage:
    """Draw the commanded drive, 200 resulting paths, and the ellipse of their end points.

    The scale is chosen so that `other` fits as well, and both drawings can be compared.
    """
    everything = np.concatenate([each.reshape(-1, 2) for one in (fan, other) for each in (one.paths, one.ellipse)])
    sheet = _Sheet(canvas, np.concatenate([everything, fan.driven]))
    sheet.hairs(fan.paths, colour, 70)
    sheet.dots(fan.paths[:, -1], colour, 3.0)
    sheet.line(fan.driven, canvas.palette.text, 2.0)
    sheet.line(fan.ellipse, canvas.palette.text, 1.8, dashed=dashed)
    sheet.dots(fan.driven[-1:], canvas.palette.text, 7.0)
    return sheet.finished()


def scan_image(scan: RoomScan, canvas: Canvas) -> QImage:
    """Draw a laser sweep: the walls, and the true and the measured end points of the beams."""
    sheet = _Sheet(canvas, np.concatenate([scan.walls.reshape(-1, 2), scan.seen]))
    palette = canvas.palette
    for wall in scan.walls:
        sheet.line(wall, palette.wall, 3.0)
    sheet.hairs(np.stack([np.broadcast_to(scan.laser, scan.true.shape), scan.true], axis=1), palette.line, 70)
    sheet.dots(scan.true, palette.text, 3.0)
    sheet.crosses(scan.seen, palette.robot(1), 3.0)
    sheet.dots(scan.laser[None, :], palette.text, 9.0)
    return sheet.finished()


def fan_painter(course: Literal["straight", "square"], *, believed: bool) -> PaintFunction:
    """Return a function that draws a drive by the wheels' odometry, or by the prediction of the particle filter."""

    def paint(preview: NoisePreview, canvas: Canvas) -> QImage:
        drive = preview.straight if course == "straight" else preview.square
        one, other = (drive.believed, drive.wheels) if believed else (drive.wheels, drive.believed)
        return fan_image(one, other, canvas, canvas.palette.robot(1 if believed else 0), dashed=believed)

    return paint


def room(preview: NoisePreview, canvas: Canvas) -> QImage:
    """Draw a laser sweep in a room."""
    return scan_image(preview.scan, canvas)
