"""Map of all windows, on pyqtgraph."""

from ui.windows.map.view import MapView

__all__ = ["MapView"]
