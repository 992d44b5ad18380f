"""Names that a screen reader reads in a window, and the order in which Tab visits its widgets."""

from collections.abc import Iterator
from itertools import pairwise

from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QAbstractScrollArea, QLabel, QLineEdit, QWidget

from ui.windows.participant.widgets.buttons import ParticipantButton


def stops(inside: QWidget) -> list[QWidget]:
    """Return the widgets inside a widget that can now have the focus, in Tab's order."""
    found: list[QWidget] = []
    at = inside
    while True:
        if at is not inside and inside.isAncestorOf(at) and _stops_at(at):
            found.append(at)
        at = at.nextInFocusChain()
        if at is inside:
            return found


def _stops_at(widget: QWidget) -> bool:
    return bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus) and widget.isVisible() and widget.isEnabled()


def nameless(inside: QWidget) -> list[str]:
    """Return the widgets that can be used or have the focus, but have no name for a screen reader."""
    return [
        f"{type(widget).__name__} {widget.objectName()} in {type(widget.parent()).__name__}"
        for widget in inside.findChildren(QWidget)
        if widget.isVisible() and (_stops_at(widget) or isinstance(widget, ParticipantButton)) and not _spoken(widget)
    ]


def _spoken(widget: QWidget) -> str:
    parent = widget.parentWidget()
    if isinstance(parent, QAbstractScrollArea) and parent.viewport() is widget:
        return _spoken(parent)
    return QAccessible.queryAccessibleInterface(widget).text(QAccessible.Text.Name).strip()


def words_in(inside: QWidget) -> list[str]:
    """Return all words that a widget shows, or that a screen reader reads."""
    found = [inside.windowTitle()]
    for widget in inside.findChildren(QWidget):
        shown = widget.face.label if isinstance(widget, ParticipantButton) and widget.face is not None else ""
        written = widget.text() if isinstance(widget, QLabel) else ""
        asked = widget.placeholderText() if isinstance(widget, QLineEdit) else ""
        found += [shown, written, asked, widget.accessibleName(), widget.accessibleDescription(), widget.toolTip()]
    return found


def against_the_eye(stops: list[QWidget], inside: QWidget) -> list[tuple[str, str]]:
    """Return pairs of neighbors in a Tab order, if the second widget lies above the first, or left of it in the same
    row."""
    return list(_wrong(stops, inside))


def _wrong(stops: list[QWidget], inside: QWidget) -> Iterator[tuple[str, str]]:
    for one, other in pairwise(stops):
        first, second = one.mapTo(inside, QPoint(0, 0)), other.mapTo(inside, QPoint(0, 0))
        above = second.y() + other.height() <= first.y()
        same_row = second.y() < first.y() + one.height() and first.y() < second.y() + other.height()
        if (above and second.x() < first.x() + one.width()) or (same_row and second.x() + other.width() <= first.x()):
            yield _spoken(one), _spoken(other)
