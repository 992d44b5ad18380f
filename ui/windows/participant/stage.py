"""The map, and what lies above it."""

from PySide6.QtCore import QEvent
from PySide6.QtGui import (
    QResizeEvent,
)
from PySide6.QtWidgets import (
    QSizePolicy,
    QWidget,
)

from ui.windows.look import GAP
from ui.windows.map import MapView
from ui.windows.participant.panels import Panel, centre
from ui.windows.participant.top import BannerLine


class Stage(QWidget):
    """The map, a banner across its top, and at most one panel in its middle."""

    def __init__(self, map_view: MapView) -> None:
        super().__init__()
        self._map = map_view
        map_view.setParent(self)
        self.banner = BannerLine(self)
        self._panel: Panel | None = None
        self.setMinimumSize(360, 300)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def hold(self, panel: Panel | None) -> None:
        """Have this panel in the middle."""
        if panel is not self._panel:
            if self._panel is not None:
                self._panel.hide()
            self._panel = panel
            if panel is not None:
                panel.setParent(self)
                panel.show()
        self._place()

    def resizeEvent(self, _event: QResizeEvent) -> None:
        """Everything keeps its place."""
        self._place()

    def event(self, event: QEvent) -> bool:
        """A panel whose words have changed may need another size."""
        if event.type() == QEvent.Type.LayoutRequest:
            self._place()
        return super().event(event)

    def _place(self) -> None:
        self._map.setGeometry(self.rect())
        width = self.width() - 2 * GAP
        high = self.banner.height_for(width)
        self.banner.setGeometry(GAP, GAP, width, high)
        self.banner.raise_()
        if self._panel is not None:
            centre(self._panel, self.width(), self.height(), 620, high + 2 * GAP if high else GAP)
            self._panel.raise_()
