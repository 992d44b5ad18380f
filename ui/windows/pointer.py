"""The pointer: what it was moved onto, as opposed to what has come up below it while it rested.

Qt tells widgets of both alike. So a window notes where the pointer rests before it shows something else, and a pointer
that is still there points at nothing.
"""

from PySide6.QtCore import QPointF
from PySide6.QtGui import QCursor
from PySide6.QtWidgets import QWidget

RESTS_AT = "restsAt"
"""Name of the property of a window that keeps where the pointer rests."""


def note_rest(widget: QWidget) -> None:
    """Note where the pointer rests, before something else is shown in the window of this widget."""
    widget.window().setProperty(RESTS_AT, QCursor.pos())


def has_moved(widget: QWidget, position: QPointF) -> bool:
    """Return True when a position of the pointer, in pixels of this widget, is another than where it rested."""
    rests_at = widget.window().property(RESTS_AT)
    return rests_at is None or (widget.mapToGlobal(position) - QPointF(rests_at)).manhattanLength() >= 1.0
