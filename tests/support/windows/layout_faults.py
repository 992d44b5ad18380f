"""Faults in a window's layout: parts that are cut off, unreachable, or covered by other parts."""

from collections.abc import Iterator
from itertools import combinations

import pytest
from PySide6.QtCore import QEvent, QPoint, QRect, Qt
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractScrollArea,
    QApplication,
    QComboBox,
    QDockWidget,
    QLabel,
    QLineEdit,
    QScrollArea,
    QSizeGrip,
    QTabBar,
    QWidget,
)

from ui.windows.map import MapView
from ui.windows.participant.cards import Card
from ui.windows.participant.map_area import MapArea
from ui.windows.participant.waiting import HorizontalScrollArea
from ui.windows.participant.widgets.buttons import ActionButton, ParticipantButton
from ui.windows.participant.widgets.panels import ModalOverlay

SIZES = ((1000, 560), (1024, 600), (1200, 800), (1920, 1080))
"""Sizes of windows, logical pixels."""

TEXTS = (*(pytest.param(each, marks=pytest.mark.slow) for each in (0.8, 1.0, 1.5)), 2.0)
"""Sizes of text, as multiples of the normal size; the default tests use only the largest, which needs most space."""


def settle() -> None:
    """Process events until layouts are stable; a change of one layout may change another one."""
    for _ in range(6):
        QApplication.processEvents()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


def misfits(window: QWidget) -> list[str]:
    """Return the faults in the layout of a window as it is shown; the search scrolls the window."""
    return [*_cut_off(window), *_words_cut(window), *_overlapping(window), *_too_wide(window)]


def _cut_off(window: QWidget) -> Iterator[str]:
    """Yield the buttons that are not completely visible, even after scrolling."""
    for button in window.findChildren(QAbstractButton):
        if not button.isVisible() or not _is_own(button):
            continue
        _scroll_to(button)
        at: QWidget = button
        while at is not window and at.parentWidget() is not None:
            parent = at.parentWidget()
            place = QRect(button.mapTo(parent, QPoint(0, 0)), button.size())
            if not parent.rect().contains(place):
                yield f"{_name(button)} is cut off by {type(parent).__name__}: {place} in {parent.rect()}"
                break
            at = parent


def _words_cut(window: QWidget) -> Iterator[str]:
    """Yield the buttons and labels that are too small for their text."""
    for button in window.findChildren(QAbstractButton):
        if not button.isVisible() or not _is_own(button):
            continue
        least = button.minimumSizeHint()
        if isinstance(button, ActionButton):
            least.setHeight(button.heightForWidth(button.width()))
        if isinstance(button, ParticipantButton) and not isinstance(button, ActionButton):
            least.setWidth(0)
        if button.width() < least.width() or button.height() < least.height():
            yield f"{_name(button)} has {button.size()} and needs {least}"
    for label in window.findChildren(QLabel):
        if not label.isVisible() or not label.text():
            continue
        high = label.heightForWidth(label.width()) if label.wordWrap() else label.sizeHint().height()
        wide = 0 if label.wordWrap() else label.sizeHint().width()
        if label.width() < wide or label.height() < high:
            yield f"label '{label.text()[:40]}' has {label.size()} and needs {wide} x {high}"


def _overlapping(window: QWidget) -> Iterator[str]:
    """Yield neighboring parts that overlap, and parts that extend beyond the part around them."""
    for home in (window, *window.findChildren(QWidget)):
        if not home.isVisible() or isinstance(home, _LAYERED):
            continue
        parts = [part for part in home.children() if isinstance(part, QWidget) and _is_laid_out(part)]
        for one, other in combinations(parts, 2):
            if one.geometry().intersects(other.geometry()):
                yield f"{_name(one)} and {_name(other)} overlap: {one.geometry()}, {other.geometry()}"
        for part in parts:
            if not home.rect().contains(part.geometry()):
                yield f"{_name(part)} sticks out of {type(home).__name__}: {part.geometry()} in {home.rect()}"


def _too_wide(window: QWidget) -> Iterator[str]:
    """Yield scrolled parts that are wider than their visible area, and cannot be scrolled sideways."""
    for area in window.findChildren(QScrollArea):
        seen, off = area.viewport().width(), Qt.ScrollBarPolicy.ScrollBarAlwaysOff
        fixed = area.horizontalScrollBarPolicy() == off and not isinstance(area, HorizontalScrollArea)
        if area.isVisible() and fixed and area.widget().width() > seen:
            yield f"{_name(area)} shows {seen} of {area.widget().width()} pixels"


_LAYERED = (Card, MapArea, MapView, QAbstractScrollArea, QComboBox, QLineEdit, QTabBar)
"""Kinds of widgets that intentionally put parts over each other, or scroll them; the arrows of Qt's tab bars
overlap."""


def _is_laid_out(part: QWidget) -> bool:
    """Return False for parts that are hidden, lie above all others, or are behind another tab, where Qt moves them out
    of sight."""
    scrolled = isinstance(part.parent(), QWidget) and isinstance(part.parent().parent(), QAbstractScrollArea)
    hidden = not part.isVisible() or part.isWindow() or (isinstance(part, QDockWidget) and part.x() < 0)
    return not (hidden or scrolled or isinstance(part, ModalOverlay | QSizeGrip) or part.objectName().startswith("qt_"))


def _scroll_to(widget: QWidget) -> None:
    """Scroll all scroll areas around a widget so that it is visible."""
    at = widget.parentWidget()
    while at is not None:
        if isinstance(at, QScrollArea):
            at.ensureWidgetVisible(widget, 0, 0)
        at = at.parentWidget()


def _is_own(button: QAbstractButton) -> bool:
    """Return False for buttons that Qt itself adds to tab bars, title bars and text fields."""
    return not button.objectName().startswith("qt_") and not isinstance(button.parentWidget(), QTabBar | QLineEdit)


def _name(widget: QWidget) -> str:
    words = widget.accessibleName() or (widget.text() if isinstance(widget, QAbstractButton) else "")
    return f"{type(widget).__name__} '{words}'"
