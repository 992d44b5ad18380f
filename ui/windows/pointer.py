"""Test whether the pointer was moved onto a widget, or whether the widget appeared under the resting pointer.

Qt reports both cases in the same way. Therefore a window stores the place of the pointer before it shows new contents.
While the pointer remains at this place, it has no effect on the new contents.
"""

from PySide6.QtCore import QPointF
from PySide6.QtGui import QCursor
from PySide6.QtWidgets import QWidget

RESTS_AT = "restsAt"
"""Name of a window's property that stores the resting place of the pointer."""


def note_rest(widget: QWidget) -> None:
    """Store the place of the pointer. Call this before the widget's window shows new contents."""
    widget.window().setProperty(RESTS_AT, QCursor.pos())


def has_moved(widget: QWidget, position: QPointF) -> bool:
    """Return True if the pointer's position, in pixels of this widget, differs from the stored place."""
    rests_at = widget.window().property(RESTS_AT)
    return rests_at is None or (widget.mapToGlobal(position) - QPointF(rests_at)).manhattanLength() >= 1.0
