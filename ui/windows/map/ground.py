"""Ground of the map: floor, walls and rooms, painted once into a picture that moves with the view."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QColor, QPainter, QPixmap, QTransform

from sim.numerics.float_array import FloatArray
from ui.model.shared.map_geometry import FREE, WALL, MapGeometry
from ui.model.shared.scene import RoomMark
from ui.windows.map.box import MapBox
from ui.windows.map.item import Z_GROUND, CellImage, MapItem
from ui.windows.map.rooms import paint_floors, paint_signs

MARGIN = 0.25
"""Width of the margin that the picture of a moving view has on each side, as a share of the view."""


@dataclass(frozen=True, slots=True, eq=False)
class _Picture:
    """Picture of a part of the map.

    Attributes:
        pixmap: the picture.
        to_pixels: transform from map meters to logical pixels of the picture.
        words: (m, 4) boxes of text in the picture: left, top, right and bottom, logical pixels.
    """

    pixmap: QPixmap
    to_pixels: QTransform
    words: FloatArray

    def corner(self, to_pixels: QTransform) -> QPointF:
        """Return the position of the upper left corner in a view."""
        return QPointF(to_pixels.dx() - self.to_pixels.dx(), to_pixels.dy() - self.to_pixels.dy())


class Ground(MapItem):
    """Static part of the map. It is painted again only if it changes, or if the view extends beyond the picture."""

    def __init__(self, box: MapBox) -> None:
        super().__init__(box, Z_GROUND)
        self._geometry: MapGeometry | None = None
        self._rooms: tuple[RoomMark, ...] = ()
        self._floor, self._walls = CellImage(), CellImage()
        self._picture: _Picture | None = None

    def show_geometry(self, geometry: MapGeometry) -> None:
        """Show another floor plan."""
        self._geometry = geometry
        self.change_colors()

    def show_rooms(self, rooms: Sequence[RoomMark]) -> None:
        """Show the current rooms."""
        self._rooms = tuple(rooms)
        self.invalidate()

    def change_colors(self) -> None:
        """Use the colors of the box."""
        geometry = self._geometry
        if geometry is not None:
            colors = self.box.colors
            for image, cell, color in ((self._floor, FREE, colors.floor), (self._walls, WALL, colors.wall)):
                table = np.zeros((256, 4), dtype=np.uint8)
                table[cell] = pg.mkColor(color).getRgb()
                image.show_cells(geometry.cells, table, geometry.origin, geometry.resolution)
        self.invalidate()

    def invalidate(self) -> None:
        """Paint the ground again in the next frame."""
        self._picture = None
        self.update()

    @property
    def picture(self) -> object:
        """Latest picture of the ground, replaced at each painting; None before the first painting."""
        return self._picture

    def words(self, to_pixels: QTransform) -> FloatArray:
        """Return (m, 4) boxes of the text in the latest picture: left, top, right and bottom, pixels of the view."""
        if self._picture is None:
            return np.empty((0, 4))
        corner = self._picture.corner(to_pixels)
        moved: FloatArray = self._picture.words + np.array([corner.x(), corner.y(), corner.x(), corner.y()])
        return moved

    def draw(self, painter: QPainter, to_pixels: QTransform) -> None:
        """Draw the picture. In an export to a file, draw floor, walls and rooms directly."""
        if self._exportOpts:
            self._paint_all(painter, to_pixels, self.box.rect())
            return
        picture, ratio = self._picture, self.box.getViewWidget().devicePixelRatioF()
        # The scale can differ in its last digits even if the view has only moved.
        moving = picture is not None and math.isclose(picture.to_pixels.m11(), to_pixels.m11(), rel_tol=1e-9)
        if not moving or picture is None or not self._covered(picture, to_pixels, ratio):
            picture = self._picture = self._painted(to_pixels, ratio, MARGIN if moving else 0.0)
        painter.drawPixmap(picture.corner(to_pixels), picture.pixmap)

    def _covered(self, picture: _Picture, to_pixels: QTransform, ratio: float) -> bool:
        """Return True if a picture covers the whole view."""
        place = QRectF(picture.corner(to_pixels), picture.pixmap.deviceIndependentSize())
        slack = 0.5 / ratio
        return picture.pixmap.devicePixelRatio() == ratio and place.adjusted(-slack, -slack, slack, slack).contains(
            self.box.rect()
        )

    def _painted(self, to_pixels: QTransform, ratio: float, margin: float) -> _Picture:
        view = self.box.rect()
        # If the screen is scaled by a multiple of 0.25, four logical pixels are a whole number of device pixels.
        x, y = (4 * math.ceil(side * margin / 4.0) for side in (view.width(), view.height()))
        width, height = view.width() + 2 * x, view.height() + 2 * y
        pixmap = QPixmap(math.ceil(width * ratio), math.ceil(height * ratio))
        pixmap.setDevicePixelRatio(ratio)
        # Fill the picture completely. Next to an axis, the box is not a whole number of pixels wide, and its last
        # pixels would contain noise.
        place = QRectF(QPointF(), pixmap.deviceIndependentSize())
        moved = to_pixels * QTransform.fromTranslate(x, y)
        painter = QPainter(pixmap)
        words = self._paint_all(painter, moved, place)
        painter.end()
        return _Picture(pixmap, moved, words)

    def _paint_all(self, painter: QPainter, to_pixels: QTransform, place: QRectF) -> FloatArray:
        """Paint floor, rooms, walls and signs; return the boxes of text."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        painter.fillRect(place, QColor(self.box.colors.unknown))
        self._paint_cells(painter, to_pixels, self._floor)
        paint_floors(painter, to_pixels, self._rooms, self.box.colors)
        self._paint_cells(painter, to_pixels, self._walls)
        return paint_signs(painter, to_pixels, self._rooms, self.box.colors, self.box.letters, self._geometry)

    def _paint_cells(self, painter: QPainter, to_pixels: QTransform, image: CellImage) -> None:
        if self._geometry is not None:
            turned = self._geometry.origin.theta % (math.pi / 2.0) != 0.0
            painter.save()
            painter.setRenderHint(QPainter.RenderHint.Antialiasing, turned)
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, turned)
            painter.setTransform(image.transform() * to_pixels, True)
            image.paint(painter)
            painter.restore()
