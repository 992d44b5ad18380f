"""View of the map, a ViewBox of pyqtgraph. It shows the whole map until a person zooms or drags the map."""

import math

import pyqtgraph as pg
from PySide6.QtCore import QRectF
from PySide6.QtGui import QFont, QRegion, QTransform
from PySide6.QtWidgets import QGraphicsSceneResizeEvent, QMenu

from ui.model.shared.theme import Palette
from ui.windows.map.export import repair_export

MAX_SCALE = 400.0
"""Largest scale, pixels per meter."""

FIT_MARGIN = 30.0
"""Margin around the floor plan when the whole map is shown, pixels."""

LEAST_FIT = 0.5
"""Smallest scale, as a share of the scale at which the whole map is shown."""


class MapBox(pg.ViewBox):  # type: ignore[misc]  # pyqtgraph has no types
    """View straight down with north (+y) up, in meters of the map frame.

    The middle of the view never leaves the map, so that a part of the map is always visible.

    Args:
        palette: the colors.
        letters: the font.
        menu: True if the right mouse button opens a menu, which includes pyqtgraph's export.

    Attributes:
        colors: palette for drawing items.
        letters: font for drawing items.
        fitted: True while the whole map is shown, because no person has zoomed or dragged it.
        bounds: box around the map, meters.
        exposed: part to paint, logical pixels of this box. If None, the whole box is being exported to a file.
    """

    def __init__(self, palette: Palette, letters: QFont, *, menu: bool) -> None:
        super().__init__(lockAspect=True, enableMenu=False, defaultPadding=0.0)
        self.colors = palette
        self.letters = letters
        self.fitted = True
        self.exposed: QRegion | None = None
        self.bounds = QRectF(-1.0, -1.0, 2.0, 2.0)
        self._menu = QMenu() if menu else None
        if self._menu is not None:
            self._menu.addAction("Show the whole map").triggered.connect(self.fit)
            repair_export()
        self.sigRangeChangedManually.connect(self._moved)
        self.sigRangeChanged.connect(lambda: self._limit(self.viewRect()))

    def fit(self) -> None:
        """Show the whole map, now and after each change of the box's size."""
        self.fitted = True
        middle = self.bounds.center()
        self._show_scale(self.fit_scale(), middle.x(), middle.y())

    def fit_scale(self) -> float:
        """Return the scale at which the whole map is shown, pixels per meter."""
        across: float = max(self.rect().width() - 2.0 * FIT_MARGIN, 1.0) / self.bounds.width()
        down: float = max(self.rect().height() - 2.0 * FIT_MARGIN, 1.0) / self.bounds.height()
        return min(across, down, MAX_SCALE)

    @property
    def middle(self) -> tuple[float, float]:
        """Return the map point in the middle of the view."""
        middle = self.viewRect().center()
        return middle.x(), middle.y()

    def zoom(self, factor: float, x: float, y: float) -> None:
        """Enlarge the map by a factor; the map point (x, y) stays at its place on the screen."""
        self.fitted = False
        self.scaleBy((1.0 / factor, 1.0 / factor), (x, y))

    def to_pixels(self) -> QTransform:
        """Return the transform from map meters to logical pixels of this box."""
        to_pixels: QTransform = self.childTransform()
        return to_pixels

    def repaint_part(self, part: QRegion) -> None:
        """Request a repaint of a part of this box, logical pixels; `update` of an item would repaint everything."""
        self.getViewWidget().viewport().update(part.translated(self.scenePos().toPoint()))

    def updateMatrix(self, changed: object = None) -> None:
        """Put the map's origin on a whole device pixel, so that cached pictures move without blur."""
        if self._matrixNeedsUpdate:
            super().updateMatrix(changed)
            exact, ratio = self.childGroup.transform(), self.getViewWidget().devicePixelRatioF()
            x, y = (math.floor(at * ratio + 0.5) / ratio for at in (exact.dx(), exact.dy()))
            self.childGroup.setTransform(QTransform(exact.m11(), 0.0, 0.0, -exact.m11(), x, y))

    def resizeEvent(self, event: QGraphicsSceneResizeEvent) -> None:
        """Keep the scale and the middle of the view. If the whole map was shown, show it in the new size."""
        middle, scale = self.middle, event.oldSize().width() / self.viewRect().width()
        super().resizeEvent(event)
        if self.fitted:
            self.fit()
        else:
            self._show_scale(scale, *middle)

    def menuEnabled(self) -> bool:
        """Return True if the right button opens a menu."""
        return self._menu is not None

    def getMenu(self, _event: object) -> QMenu | None:
        """Return the menu of the right button."""
        return self._menu

    def _moved(self) -> None:
        self.fitted = False
        self._limit(self.viewRect())

    def _show_scale(self, scale: float, x: float, y: float) -> None:
        """Show a map point in the middle of the box at a scale."""
        wide, high = max(self.rect().width(), 1.0) / scale, max(self.rect().height(), 1.0) / scale
        view = QRectF(x - wide / 2.0, y - high / 2.0, wide, high)
        self._limit(view)
        self.setRange(view, padding=0.0)

    def _limit(self, view: QRectF) -> None:
        """Keep the middle of the view on the map, and the scale within its bounds."""
        width, height = self.rect().width(), self.rect().height()
        widest = self.fit_scale() * LEAST_FIT
        x, y = view.width() / 2.0, view.height() / 2.0
        shown = self.bounds.adjusted(-x, -y, x, y)
        self.setLimits(
            xMin=shown.left(),
            xMax=shown.right(),
            yMin=shown.top(),
            yMax=shown.bottom(),
            minXRange=width / MAX_SCALE,
            maxXRange=width / widest,
            minYRange=height / MAX_SCALE,
            maxYRange=height / widest,
        )
