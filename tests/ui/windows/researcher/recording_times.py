"""Times of a recording in the researcher's window."""

from PySide6.QtCore import QPoint, QPointF

from ui.windows.researcher.docks.plots import Plots
from ui.windows.researcher.window import ResearcherWindow


def place_of(plots: Plots, time: float) -> QPoint:
    """Return the position of a time in the plots, on the first one."""
    box = plots.canvas.getItem(1, 0).getViewBox()
    return QPointF(plots.canvas.mapFromScene(box.mapViewToScene(QPointF(time, 0.0)))).toPoint()


def go_to(window: ResearcherWindow, seconds: float) -> None:
    window.playback.timeline.setValue(round(seconds * 1000.0))
    window.refresh()
