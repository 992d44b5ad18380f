"""Items of the map that paint in pixels, and images of cells."""

import sys

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QImage, QPainter, QTransform
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from sim.common.geometry import Pose2
from ui.windows.map.box import MapBox

Z_GROUND, Z_FLAT, Z_ROBOTS, Z_ABOVE, Z_SCALE_BAR = -1, 10, 20, 30, 40
"""Order of painting. Items in meters, such as costmaps, lie at 0."""


class MapItem(pg.GraphicsObject):  # type: ignore[misc]  # pyqtgraph has no types
    """Item that covers the whole map.

    It paints in logical pixels of the box, so that lines and letters keep their size.

    Args:
        box: view of the map.
        z: order of painting.
    """

    def __init__(self, box: MapBox, z: int) -> None:
        super().__init__(box)
        self.box = box
        self.setZValue(z)
        self.setAcceptedMouseButtons(Qt.MouseButton.NoButton)

    def boundingRect(self) -> QRectF:
        """Return the whole box."""
        whole: QRectF = self.box.rect()
        return whole

    def paint(self, painter: QPainter, _option: QStyleOptionGraphicsItem, _widget: QWidget | None = None) -> None:
        """Draw with smooth edges and in the map's font."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(self.box.letters)
        try:
            self.draw(painter, self.box.to_pixels())
        except Exception:  # Without this, Qt's bindings would end the process.
            sys.excepthook(*sys.exc_info())

    def draw(self, painter: QPainter, to_pixels: QTransform) -> None:
        """Draw in logical pixels of the box; the transform converts map meters to these pixels."""
        raise NotImplementedError


class CellImage(pg.ImageItem):  # type: ignore[misc]  # pyqtgraph has no types
    """Cells of a map as an image, without blur."""

    qimage: QImage

    def __init__(self) -> None:
        super().__init__(axisOrder="row-major")

    def show_cells(self, cells: NDArray[np.uint8], colors: NDArray[np.uint8], origin: Pose2, resolution: float) -> None:
        """Show cells.

        Args:
            cells: (rows, cols) values; row 0 lies at the origin.
            colors: (256, 4) red, green, blue and opacity of each value.
            origin: outer corner of the first cell, map frame.
            resolution: meters per cell.
        """
        self.setImage(cells, autoLevels=False, lut=colors)
        turned = QTransform.fromTranslate(origin.x, origin.y).rotateRadians(origin.theta)
        self.setTransform(turned.scale(resolution, resolution))

    def render(self) -> None:
        """Make the image in the format that Qt draws fastest."""
        super().render()
        self.qimage = self.qimage.convertToFormat(QImage.Format.Format_ARGB32_Premultiplied)
