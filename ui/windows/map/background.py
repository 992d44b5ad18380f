"""Background of the map: floor, walls and rooms, painted once into a picture that is shifted with the view."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QPainter, QPen, QPixmap, QTransform

from sim.numerics.float_array import FloatArray
from ui.model.scene import RoomMark
from ui.model.theme import Palette
from ui.windows.map.camera import Camera
from ui.windows.map.geometry import Boxes, MapGeometry
from ui.windows.map.rooms import paint_floors, paint_signs

MARGIN = 0.25
"""The picture reaches so far beyond the view on each side, as a share of the view, for following and dragging."""


@dataclass(frozen=True, slots=True, eq=False)
class _Picture:
    """A painted piece of the map: the view of `camera`, in device pixels; `words` are (m, 4) boxes of text in it."""

    pixmap: QPixmap
    camera: Camera
    ratio: float
    words: FloatArray


class MapBackground:
    """The part of the map that stands still, repainted only when it changes or the view leaves the picture."""

    def __init__(self, palette: Palette) -> None:
        self._palette = palette
        self._geometry: MapGeometry | None = None
        self._rooms: tuple[RoomMark, ...] = ()
        self._picture: _Picture | None = None

    def show_geometry(self, geometry: MapGeometry) -> None:
        """Show another floor plan."""
        self._geometry, self._picture = geometry, None

    def show_rooms(self, rooms: Sequence[RoomMark]) -> None:
        """Show the rooms as they are now."""
        self._rooms, self._picture = tuple(rooms), None

    def set_palette(self, palette: Palette) -> None:
        """Use other colours."""
        self._palette, self._picture = palette, None

    def invalidate(self) -> None:
        """Repaint with the next frame, for example with another font."""
        self._picture = None

    def paint(self, painter: QPainter, camera: Camera, ratio: float, font: QFont, moving: bool) -> None:
        """Fill the view.

        Args:
            painter: in logical pixels of the view.
            camera: snapped to device pixels.
            ratio: device pixels per logical pixel.
            font: of names and numbers.
            moving: the view is likely to move on, so that a margin around it is worth painting.
        """
        picture = self._picture
        if picture is None or not _covers(picture, camera, ratio):
            picture = self._picture = self._painted(camera, ratio, font, MARGIN if moving else 0.0)
        px, py = picture.camera.pixel(*camera.point(0.0, 0.0))
        painter.drawPixmap(QPointF(-px, -py), picture.pixmap)

    def words(self, camera: Camera) -> FloatArray:
        """Return (m, 4) boxes of the text in the last picture: left, top, right and bottom, pixels of the view."""
        if self._picture is None:
            return np.empty((0, 4))
        px, py = self._picture.camera.pixel(*camera.point(0.0, 0.0))
        boxes: FloatArray = self._picture.words - np.array([px, py, px, py])
        return boxes

    def _painted(self, camera: Camera, ratio: float, font: QFont, margin: float) -> _Picture:
        # A multiple of four pixels is whole in device pixels at every scaling by quarters.
        border = (4 * math.ceil(camera.width * margin / 4.0), 4 * math.ceil(camera.height * margin / 4.0))
        wide = replace(camera, width=camera.width + 2 * border[0], height=camera.height + 2 * border[1])
        pixmap = QPixmap(math.ceil(wide.width * ratio), math.ceil(wide.height * ratio))
        pixmap.setDevicePixelRatio(ratio)
        pixmap.fill(QColor(self._palette.unknown))
        painter = QPainter(pixmap)
        if self._geometry is not None:
            self._fill(painter, wide, self._geometry, self._geometry.floor, self._palette.floor)
        paint_floors(painter, wide, self._rooms, self._palette)
        if self._geometry is not None:
            self._fill(painter, wide, self._geometry, self._geometry.walls, self._palette.wall)
        words = paint_signs(painter, wide, self._rooms, self._palette, font, self._geometry)
        painter.end()
        return _Picture(pixmap, wide, ratio, words)

    def _fill(self, painter: QPainter, camera: Camera, geometry: MapGeometry, boxes: Boxes, colour: str) -> None:
        painter.save()
        px, py = camera.pixel(geometry.origin.x, geometry.origin.y)
        cell = camera.scale * geometry.resolution
        transform = QTransform.fromTranslate(px, py).rotateRadians(-geometry.origin.theta).scale(cell, -cell)
        painter.setTransform(transform, True)
        turned = geometry.origin.theta % (math.pi / 2.0) != 0.0
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, turned)
        if turned:
            # Smooth edges of neighbours leave a hairline between them, which an outline covers.
            painter.setPen(QPen(QColor(colour), 0.0))
        else:
            painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(colour))
        painter.drawRects([QRectF(*box) for box in boxes.tolist()])
        painter.restore()


def _covers(picture: _Picture, camera: Camera, ratio: float) -> bool:
    """Return True when all that the camera sees is in the picture, at its scale."""
    if picture.ratio != ratio or picture.camera.scale != camera.scale:
        return False
    px, py = picture.camera.pixel(camera.x, camera.y)
    slack = 0.5 / ratio
    return (
        camera.width / 2.0 - slack <= px <= picture.camera.width - camera.width / 2.0 + slack
        and camera.height / 2.0 - slack <= py <= picture.camera.height - camera.height / 2.0 + slack
    )
