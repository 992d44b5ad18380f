"""Places on the plots of the researcher's window."""

from PySide6.QtCore import QPoint, QPointF

from ui.windows.researcher.docks.plots import Plots


def place_of(plots: Plots, time: float) -> QPoint:
    """Return the position of a time in the plots, on the first one."""
    box = plots.canvas.getItem(1, 0).getViewBox()
    return QPointF(plots.canvas.mapFromScene(box.mapViewToScene(QPointF(time, 0.0)))).toPoint()
