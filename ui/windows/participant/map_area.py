"""The map with the banner above it, and the place of pop-ups: below the rooms, or in a corner of the map."""

from collections.abc import Callable, Sequence

from PySide6.QtCore import QEvent, QPoint, QRect, QSize
from PySide6.QtGui import (
    QResizeEvent,
    QShowEvent,
)
from PySide6.QtWidgets import (
    QSizePolicy,
    QWidget,
)

from ui.windows.look import GAP, px
from ui.windows.map import MapView
from ui.windows.participant.column import SideColumn
from ui.windows.participant.top import BannerLine
from ui.windows.participant.widgets.panels import TitledPanel

MAX_PANEL_WIDTH = 620
"""Greatest width of a panel in the middle, and of a pop-up that needs it, `px`."""

POPUP = QSize(360, 320)
"""Usual width of a pop-up in a corner, and the height that is kept for it to grow in, `px`."""

LEAST_SCALE = 0.35
"""Least scale, as a share of the usual one, at which a map beside a pop-up can still be read."""

_CORNERS = ((True, True), (True, False), (False, True), (False, False))
"""Corners of the map: at the right or not, at the bottom or not."""


class MapArea(QWidget):
    """The map, a banner across its top, and the place of at most one panel.

    A pop-up is docked in the column, below the rooms, where there is space for it; else it lies in a corner of the map,
    and the whole map is shown beside or above it. A map that is followed or was moved stays as it is, and the corner is
    one away from what the pop-up is about. Any other panel is in the middle.
    """

    def __init__(self, map_view: MapView, column: SideColumn) -> None:
        super().__init__()
        self._map, self._column = map_view, column
        map_view.setParent(self)
        self.banner = BannerLine(self)
        self._panel: TitledPanel | None = None
        self._robot: int | None = None
        self._about: Callable[[], Sequence[QPoint]] = tuple
        self._foot: int | None = None
        self._corner: tuple[bool, bool] | None = None
        self.setMinimumSize(240, 160)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        column.laid_out.connect(self._place_panel)

    def show_panel(
        self, panel: TitledPanel | None, robot: int | None = None, about: Callable[[], Sequence[QPoint]] = tuple
    ) -> None:
        """Show this panel, or none.

        Args:
            panel: the panel.
            robot: index of the robot that a pop-up is about; pop-ups about the same robot stay in the same corner. None
                puts the panel in the middle.
            about: the points on the map that a pop-up should leave in sight, pixels, the most important one first.
        """
        self._about = about
        if robot != self._robot:
            self._robot, self._corner = robot, None
        if panel is not self._panel:
            if self._panel is not None:
                self._panel.hide()
            self._panel, self._foot = panel, None
            if panel is not None:
                panel.setParent(self)
                panel.show()
        self._place()

    def place_anew(self) -> None:
        """Lay everything out anew, since the map has changed; a pop-up may get another corner."""
        self._foot = self._corner = None
        self._place()

    def resizeEvent(self, _event: QResizeEvent) -> None:
        """Lay everything out anew."""
        self.place_anew()

    def showEvent(self, _event: QShowEvent) -> None:
        """Lay everything out anew: while it was hidden, Qt told the map no new size."""
        self.place_anew()

    def event(self, event: QEvent) -> bool:
        """Lay out anew when a panel's words have changed, which may need another size."""
        if event.type() == QEvent.Type.LayoutRequest:
            self._place()
        return super().event(event)

    def _place(self) -> None:
        self._map.setGeometry(self.rect())
        width = self.width() - 2 * GAP
        self.banner.setGeometry(GAP, GAP, width, self.banner.height_for(width))
        self.banner.raise_()
        self._place_panel()

    def _place_panel(self) -> None:
        panel = self._panel
        if panel is None:
            self._map.keep_within(None)
            return
        free = self._column.free
        docked = self._robot is not None and free.height() >= max(px(POPUP.height()), panel.least(free.width()))
        home = self._column if docked else self
        if panel.parentWidget() is not home:
            panel.setParent(home)
            panel.show()
        if docked:
            size = panel.wanted(free.width(), free.height())
            place = QRect(QPoint(free.left(), free.top() + free.height() - size.height()), size)
            self._map.keep_within(None)
        else:
            place = self._on_map(panel)
        panel.setGeometry(place)
        panel.raise_()

    def _on_map(self, panel: TitledPanel) -> QRect:
        """Return the place of a panel on the map."""
        high = self.banner.height_for(self.width() - 2 * GAP)
        top = high + 2 * GAP if high else GAP
        space = QRect(GAP, top, self.width() - 2 * GAP, self.height() - top - GAP)
        widest = min(px(MAX_PANEL_WIDTH), space.width())
        narrow = min(px(POPUP.width()), widest)
        if self._robot is not None and panel.least(narrow) <= space.height():
            widest = narrow
        size = panel.wanted(widest, space.height())
        left, foot = space.left() + (space.width() - size.width()) // 2, (space.bottom() + 1 + top + size.height()) // 2
        shown_in = None
        if self._robot is not None:
            kept = QSize(size.width(), max(size.height(), min(px(POPUP.height()), space.height())))
            # Where the room to grow is not there, the map gives way as the dialogue goes on.
            shown_in = self._beside(space, kept) or self._beside(space, size)
            if shown_in is not None:
                self._corner = (True, True)
            at_right, at_bottom = self._corner = self._corner or self._best_corner(space, kept)
            left = space.left() + at_right * (space.width() - size.width())
            foot = top + (space.height() if at_bottom else kept.height())
        self._map.keep_within(shown_in)
        if self._foot is None:
            self._foot = foot
        # It grows upwards as the dialogue goes on, so that the answers stay where they are, as far as that is possible.
        y = min(max(self._foot - size.height(), top), top + space.height() - size.height())
        return QRect(QPoint(left, y), size)

    def _beside(self, space: QRect, kept: QSize) -> QRect | None:
        """Return the part of the map that a pop-up at the right and the bottom leaves free; None: it is of no use."""
        if not self._map.fitted:
            return None
        left = QRect(0, 0, space.right() + 1 - kept.width(), self.height())
        above = QRect(0, 0, self.width(), space.bottom() + 1 - kept.height())
        usable = [free for free in (left, above) if free.width() > 0 and free.height() > 0]
        best = max(usable, key=self._map.scale_within, default=None)
        least = LEAST_SCALE * self._map.scale_within(self._map.rect())
        return best if best is not None and self._map.scale_within(best) >= least else None

    def _best_corner(self, space: QRect, kept: QSize) -> tuple[bool, bool]:
        """Return the corner (at the right, at the bottom) in which a pop-up covers least of what it is about."""
        apart = space.size() - kept
        about = self._about()

        def merit(corner: tuple[bool, bool]) -> tuple[list[bool], int]:
            at = QPoint(space.left() + corner[0] * apart.width(), space.top() + corner[1] * apart.height())
            place = QRect(at, kept)
            nearest = min(((place.center() - point).manhattanLength() for point in about), default=0)
            return [not place.contains(point) for point in about], nearest

        return max(_CORNERS, key=merit)
