"""Test if the pointer was moved onto a widget, or if the widget appeared under the resting pointer.

Qt reports both in the same way. Therefore a window stores the place of the pointer before it shows new contents. While
the pointer is still at this place, it points at nothing.
"""

from PySide6.QtCore import QPointF
from PySide6.QtGui import QCursor
from PySide6.QtWidgets import QWidget

RESTS_AT = "restsAt"
"""Name of a window's property that stores the resting place of the pointer."""


def note_rest(widget: QWidget) -> None:
    """Store the resting place of the pointer, before this widget's window shows new contents."""
    widget.window().setProperty(RESTS_AT, QCursor.pos())


def has_moved(widget: QWidget, position: QPointF) -> bool:
    """Return True if a position of the pointer, in pixels of this widget, differs from its resting place."""
    rests_at = widget.window().property(RESTS_AT)
    return rests_at is None or (widget.mapToGlobal(position) - QPointF(rests_at)).manhattanLength() >= 1.0
