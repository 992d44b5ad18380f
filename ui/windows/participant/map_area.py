"""The map with the banner and the panel above it."""

from PySide6.QtCore import QEvent
from PySide6.QtGui import (
    QResizeEvent,
)
from PySide6.QtWidgets import (
    QSizePolicy,
    QWidget,
)

from ui.windows.look import GAP, px
from ui.windows.map import MapView
from ui.windows.participant.top import BannerLine
from ui.windows.participant.widgets.panels import TitledPanel

MAX_PANEL_WIDTH = 620
"""Greatest width of a panel, `px`."""


class MapArea(QWidget):
    """The map, a banner across its top, and at most one panel in its middle."""

    def __init__(self, map_view: MapView) -> None:
        super().__init__()
        self._map = map_view
        map_view.setParent(self)
        self.banner = BannerLine(self)
        self._panel: TitledPanel | None = None
        self._foot: int | None = None
        self.setMinimumSize(240, 160)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def show_panel(self, panel: TitledPanel | None) -> None:
        """Show this panel in the middle, or none."""
        if panel is not self._panel:
            if self._panel is not None:
                self._panel.hide()
            self._panel, self._foot = panel, None
            if panel is not None:
                panel.setParent(self)
                panel.show()
        self._place()

    def resizeEvent(self, _event: QResizeEvent) -> None:
        """Lay everything out anew."""
        self._foot = None
        self._place()

    def event(self, event: QEvent) -> bool:
        """Lay out anew when a panel's words have changed, which may need another size."""
        if event.type() == QEvent.Type.LayoutRequest:
            self._place()
        return super().event(event)

    def _place(self) -> None:
        self._map.setGeometry(self.rect())
        width = self.width() - 2 * GAP
        high = self.banner.height_for(width)
        self.banner.setGeometry(GAP, GAP, width, high)
        self.banner.raise_()
        panel = self._panel
        if panel is None:
            return
        top = high + 2 * GAP if high else GAP
        size = panel.wanted(min(px(MAX_PANEL_WIDTH), self.width() - 2 * GAP), self.height() - top - GAP)
        if self._foot is None:
            self._foot = (top + self.height() - GAP + size.height()) // 2
        # It grows upwards as the dialogue goes on, so that the answers stay where they are, as far as that is possible.
        y = min(max(self._foot - size.height(), top), self.height() - GAP - size.height())
        panel.setGeometry((self.width() - size.width()) // 2, y, size.width(), size.height())
        panel.raise_()
