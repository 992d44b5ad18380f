"""Keyboard focus. Arrow keys move the focus within a region, and F6 moves it to the next region.

Tab cannot move the focus, because it selects the next robot in this game.
"""

from collections.abc import Sequence

from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtWidgets import QApplication, QWidget

REGION = "region"
"""Name of the property that marks a widget as a region."""

ARROWS: dict[int, tuple[int, int]] = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}


def make_region(widget: QWidget, name: str) -> None:
    """Mark a widget as a region with this name."""
    widget.setProperty(REGION, name)
    widget.setAccessibleName(name)


def reachable(inside: QWidget) -> list[QWidget]:
    """Return the widgets that can have the focus inside another widget, row by row, from left to right."""
    found = [
        widget
        for widget in inside.findChildren(QWidget)
        if widget.focusPolicy() & Qt.FocusPolicy.TabFocus and widget.isVisibleTo(inside) and widget.isEnabled()
    ]

    rows: list[list[tuple[QRect, QWidget]]] = []
    for place, widget in sorted(
        ((QRect(widget.mapTo(inside, QPoint(0, 0)), widget.size()), widget) for widget in found),
        key=lambda each: (each[0].center().y(), each[0].x()),
    ):
        # Widgets next to each other form a row, even if their heights differ.
        if rows and place.top() <= rows[-1][0][0].bottom():
            rows[-1].append((place, widget))
        else:
            rows.append([(place, widget)])
    return [widget for row in rows for _, widget in sorted(row, key=lambda each: each[0].x())]


def move_focus(widget: QWidget, key: int) -> None:
    """Give the focus to a neighbor inside the widget's region.

    The keys Left and Right follow the reading order, so that all widgets are reachable. Up and Down go to the nearest
    widget above or below; horizontal distances have three times the weight.
    """
    home: QWidget | None = widget
    while home is not None and home.property(REGION) is None:
        home = home.parentWidget()
    if home is None:
        return
    others = reachable(home)
    x, y = ARROWS[key]
    if x and widget in others:
        target = others[min(max(others.index(widget) + x, 0), len(others) - 1)]
        target.setFocus(Qt.FocusReason.OtherFocusReason)
        return
    here = widget.mapTo(home, widget.rect().center())
    best: tuple[float, QWidget] | None = None
    for other in others:
        there = other.mapTo(home, other.rect().center())
        ahead = (there.y() - here.y()) * y
        far = ahead + 3.0 * abs(there.x() - here.x())
        if ahead > 0 and (best is None or far < best[0]):
            best = (far, other)
    if best is not None:
        best[1].setFocus(Qt.FocusReason.OtherFocusReason)


def go_round(inside: QWidget, step: int) -> None:
    """Give the focus to the next (`step` 1) or previous (-1) widget inside a widget, in a cycle."""
    others = reachable(inside)
    if others:
        focused = QApplication.focusWidget()
        at = others.index(focused) + step if focused in others else min(step, 0)
        others[at % len(others)].setFocus(Qt.FocusReason.OtherFocusReason)


def next_region(regions: Sequence[QWidget], step: int) -> None:
    """Give the focus to the first reachable widget of the next (`step` 1) or previous (-1) region."""
    open_ones = [one for one in regions if one.isVisible() and (_takes(one) or reachable(one))]
    if not open_ones:
        return
    focused = QApplication.focusWidget()
    inside = [
        at for at, one in enumerate(open_ones) if focused is not None and (one is focused or one.isAncestorOf(focused))
    ]
    at = (inside[0] + step) % len(open_ones) if inside else (0 if step > 0 else -1)
    focus_region(open_ones[at])


def focus_region(home: QWidget) -> None:
    """Give the focus to a region, or to the first widget in the region that accepts the focus."""
    target = home if _takes(home) else next(iter(reachable(home)), home)
    target.setFocus(Qt.FocusReason.OtherFocusReason)


def _takes(widget: QWidget) -> bool:
    return bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus)
