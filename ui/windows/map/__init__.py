"""The map of both windows."""

from ui.windows.map.view import MapLayer, MapView

__all__ = ["MapLayer", "MapView"]
