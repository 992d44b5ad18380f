"""Page of a form, with its items in a column and the buttons to the previous and the next page."""

import time
from collections.abc import Callable, Sequence

from PySide6.QtCore import QEvent, QPoint, QRect, Qt, QTimer, Signal
from PySide6.QtGui import (
    QAccessible,
    QAccessibleAnnouncementEvent,
    QKeySequence,
    QResizeEvent,
    QShortcut,
    QShowEvent,
)
from PySide6.QtWidgets import QApplication, QFrame, QHBoxLayout, QScrollArea, QVBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.kiosk import FormToFill, ItemNews
from ui.windows import look
from ui.windows.kiosk.items.panel import ItemPanel
from ui.windows.kiosk.pages.text import READING
from ui.windows.look import GAP, follow_text, px, spaced
from ui.windows.participant.widgets.buttons import ActionButton, ButtonFace
from ui.windows.participant.widgets.focus import make_region
from ui.windows.participant.widgets.panels import set_text

LIMIT_STEP = 100
"""Milliseconds between two updates of time limits."""
WIDEST = 860
"""Maximum width of the column of items, `px`, because longer lines and scales are harder to read."""


class FormPage(QWidget):
    """Page of a form.

    Args:
        form: the page.
        texts: texts of the study.
        clock: monotonic clock, seconds.

    Attributes:
        news: signal with an `ItemNews`.
        went_on: signal: the person has answered all required items, and continues.
        went_back: signal: the person goes back to the previous page.
        back: button to the previous page; None if the person cannot go back.
    """

    news = Signal(object)
    went_on = Signal()
    went_back = Signal()

    def __init__(self, form: FormToFill, texts: Texts, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._form = form
        self._texts = texts
        self._clock, self._came = clock, clock()
        self._active: ItemPanel | None = None
        make_region(self, form.title)
        rows = spaced(QVBoxLayout(self), 0, 0)
        self._area = QScrollArea(widgetResizable=True)
        self._area.setFrameShape(QFrame.Shape.NoFrame)
        self._area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        rows.addWidget(self._area, 1)
        inside = QWidget()
        column = _column(inside)
        column.addWidget(look.label(form.title, "hero", bold=True))
        if form.instructions:
            column.addWidget(look.label(form.instructions))
        self.panels: list[ItemPanel] = []
        for number, item in enumerate(form.items, start=1):
            panel = ItemPanel(item, number, len(form.items), texts)
            if item.id in form.answers:
                panel.show_answer(form.answers[item.id])
            panel.news.connect(lambda what, characters, panel=panel: self._report(panel, what, characters))
            panel.passed.connect(lambda panel=panel: self._pass(panel))
            if item.id in form.timed_out:
                panel.close_item()
            column.addWidget(panel)
            self.panels.append(panel)
        column.addStretch(1)
        self._area.setWidget(inside)
        inside.setAutoFillBackground(False)
        self._count = look.label(muted=True)
        self.go_on = ActionButton(texts, "main")
        self.back = ActionButton(texts) if form.back else None
        self._build_foot(rows)
        self._limits = QTimer(self, interval=LIMIT_STEP)
        self._limits.timeout.connect(self._count_down)
        if any(item.seconds > 0.0 for item in form.items):
            self._limits.start()
        self._looking = QTimer(self, singleShot=True, interval=0)
        self._looking.timeout.connect(self._look)
        bar = self._area.verticalScrollBar()
        bar.valueChanged.connect(lambda _value: self._looking.start())
        bar.rangeChanged.connect(lambda _least, _most: self._looking.start())
        bar.rangeChanged.connect(lambda _least, most: self._align_foot(bar.sizeHint().width() if most > 0 else 0))
        QApplication.instance().focusChanged.connect(self._follow)  # type: ignore[union-attr]  # there is always one
        self._show_count()

    def _build_foot(self, rows: QVBoxLayout) -> None:
        self._foot = QWidget()
        rows.addWidget(self._foot)
        row = spaced(QHBoxLayout(), 2 * GAP)
        column = _column(self._foot, vertical=GAP)
        column.addLayout(row)
        row.addWidget(self._count, 1)
        if self.back is not None:
            self._add_to_foot(row, self.back, self._texts.text("kiosk.back"), "Alt+Left", "Alt+Left")
            self.back.clicked.connect(self._go_back)
        go_on = self._texts.text("kiosk.continue")
        self._add_to_foot(row, self.go_on, go_on, "Ctrl+Enter", "Ctrl+Return", "Ctrl+Enter")
        self.go_on.clicked.connect(self._leave)

    def _align_foot(self, scroll_bar: int) -> None:
        """Align the buttons at the bottom with the items, which have a scroll bar of this width next to them."""
        self._foot.setContentsMargins(0, 0, scroll_bar, 0)

    def _add_to_foot(self, row: QHBoxLayout, button: ActionButton, label: str, shown: str, *keys: str) -> None:
        button.show_face(ButtonFace(label, shown), label)
        row.addWidget(button)
        for key in keys:
            shortcut = QShortcut(QKeySequence(key), self)
            shortcut.setAutoRepeat(False)
            shortcut.activated.connect(button.click)

    def start(self) -> None:
        """Give the focus to the first missing answer that the host reported, or to the first item without an answer."""
        missing = [panel for panel in self.panels if panel.item.id in self._form.missing]
        for panel in missing:
            panel.point_at_missing(self._texts.text("forms.please_answer"))
        first = next(
            iter(missing),
            next((panel for panel in self.panels if panel.answer is None and not panel.closed), self.panels[0]),
        )
        first.focus_target().setFocus(Qt.FocusReason.OtherFocusReason)

    def focusNextPrevChild(self, forward: bool) -> bool:
        """Let Tab move from item to item, and from the last item to the buttons below.

        The button "not applicable" follows its item.
        """
        stops: list[QWidget] = []
        for panel in self.panels:
            stops.append(panel.focus_target())
            if panel.not_applicable is not None and panel.not_applicable not in stops:
                stops.append(panel.not_applicable)
        stops += [self.go_on] if self.back is None else [self.back, self.go_on]
        focused = QApplication.focusWidget()
        at = stops.index(focused) if focused in stops else self._stop_of(focused, stops)
        target = stops[(at + (1 if forward else -1)) % len(stops)]
        target.setFocus(Qt.FocusReason.TabFocusReason if forward else Qt.FocusReason.BacktabFocusReason)
        return True

    def _stop_of(self, focused: QWidget | None, stops: Sequence[QWidget]) -> int:
        """Return the index of the stop of the item that contains the focused widget; -1 if no item contains it."""
        panel = next((panel for panel in self.panels if focused is not None and panel.isAncestorOf(focused)), None)
        return -1 if panel is None else stops.index(panel.focus_target())

    def showEvent(self, event: QShowEvent) -> None:
        """Check which items are visible when the page appears."""
        super().showEvent(event)
        self._looking.start()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Check which items are visible after a change of size."""
        super().resizeEvent(event)
        self._looking.start()

    def event(self, event: QEvent) -> bool:
        """Check which items are visible after a change of the layout."""
        if event.type() == QEvent.Type.LayoutRequest:
            self._looking.start()
        return super().event(event)

    def _look(self) -> None:
        """Report the items that are fully visible.

        An item that is taller than the window counts as visible when its question is fully visible.
        """
        if not self.isVisible():
            return
        port = self._area.viewport()
        for panel in self.panels:
            place = QRect(panel.mapTo(port, QPoint(0, 0)), panel.size())
            if place.height() > port.height():
                place = QRect(panel.question.mapTo(port, QPoint(0, 0)), panel.question.size())
            if port.rect().adjusted(0, -1, 0, 1).contains(place.adjusted(0, 0, -1, -1)):
                panel.come_into_sight()

    def _follow(self, _before: QWidget | None, now: QWidget | None) -> None:
        """Scroll to the item that has the focus, and make it the person's current item."""
        panel = next((panel for panel in self.panels if now is panel or (now and panel.isAncestorOf(now))), None)
        if panel is not None:
            self._area.ensureWidgetVisible(panel, 0, 2 * GAP)
            self._enter(panel)

    def _enter(self, panel: ItemPanel | None) -> None:
        if self._active is not None and self._active is not panel:
            self._active.go_on()
        self._active = panel

    def _report(self, panel: ItemPanel, what: str, characters: int) -> None:
        if what in {"touched", "changed"}:
            self._enter(panel)
        moment = time.monotonic_ns()
        answer = panel.answer if what in {"changed", "given", "timed out"} else None
        self.news.emit(ItemNews(self._form.page, panel.item.id, what, moment, answer, characters))  # type: ignore[arg-type]
        if what in {"changed", "given", "timed out"}:
            self._show_count()

    def _count_down(self) -> None:
        """Show the remaining time of items with a time limit. If an item closes, focus the continue button."""
        for panel in self.panels:
            if panel.item.seconds > 0.0 and panel.show_left(self._came + panel.item.seconds - self._clock()):
                self.go_on.setFocus(Qt.FocusReason.OtherFocusReason)

    def _pass(self, panel: ItemPanel) -> None:
        """Go from an item to the next item."""
        at = self.panels.index(panel) + 1
        target = self.panels[at].focus_target() if at < len(self.panels) else self.go_on
        target.setFocus(Qt.FocusReason.TabFocusReason)
        if target is self.go_on:
            self._enter(None)

    def _leave(self) -> None:
        """Continue if no answer is missing; otherwise mark all missing answers and go to the first missing answer."""
        if self._is_new:
            return
        self._enter(None)
        lacking = [panel for panel in self.panels if panel.lacks]
        for panel in self.panels:
            panel.point_at_missing(panel.lacks)
        if not lacking:
            self.went_on.emit()
            return
        said = self._texts.text("forms.missing", count=len(lacking))
        set_text(self._count, said)
        QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, said))
        lacking[0].focus_target().setFocus(Qt.FocusReason.OtherFocusReason)
        self._area.ensureWidgetVisible(lacking[0], 0, 2 * GAP)

    def _go_back(self) -> None:
        if not self._is_new:
            self._enter(None)
            self.went_back.emit()

    @property
    def _is_new(self) -> bool:
        """True shortly after the page appears, because a press was then meant for the previous page."""
        return self._clock() - self._came < READING

    def _show_count(self) -> None:
        answered = sum(panel.answer is not None for panel in self.panels)
        parts = []
        if self._form.parts > 1:
            parts.append(self._texts.text("forms.page", page=self._form.part, pages=self._form.parts))
        if len(self.panels) > 1:
            parts.append(self._texts.text("forms.answered", answered=answered, total=len(self.panels)))
        set_text(self._count, " ".join(parts))


def _column(inside: QWidget, vertical: int = 2 * GAP) -> QVBoxLayout:
    """Return a column of limited width in the middle of a widget."""
    outer = spaced(QHBoxLayout(inside), 0, 2 * GAP, vertical, 2 * GAP, vertical)
    column = follow_text(QWidget(), lambda it: it.setMaximumWidth(px(WIDEST)))
    outer.addStretch(1)
    outer.addWidget(column, 40)
    outer.addStretch(1)
    return spaced(QVBoxLayout(column), int(1.5 * GAP), 0)
