"""Map that all windows use, drawn with pyqtgraph."""

from ui.windows.map.view import MapView

__all__ = ["MapView"]
