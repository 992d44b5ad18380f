"""The map of both windows."""

from ui.windows.map.view import Layer, MapView

__all__ = ["Layer", "MapView"]
