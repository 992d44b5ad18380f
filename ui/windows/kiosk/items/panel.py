"""Panel of an item: the question, its field, "not applicable", and a note if the answer is missing."""

import math
from typing import Literal

from PySide6.QtCore import QRectF, Qt, QTimer, Signal
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QKeyEvent, QPaintEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QVBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.questionnaires.scoring import NOT_APPLICABLE
from ui.model.kiosk import Answer, FormItem
from ui.windows import look
from ui.windows.kiosk.items.field import AnswerField
from ui.windows.kiosk.items.line import LineField
from ui.windows.kiosk.items.options import ChoiceField, OptionButton, PointsField
from ui.windows.kiosk.items.written import LineOfTextField, NumberField, TextField
from ui.windows.look import GAP, colours, smooth_painter, spaced
from ui.windows.participant.widgets.focus import ARROWS, make_region, reachable
from ui.windows.participant.widgets.painting import ring

PAUSE = 700
"""The typed text is reported after this number of milliseconds without typing."""

LIMIT_WARNING = 10
"""Remaining seconds of a time limit. When only these seconds remain, a screen reader announces them."""

What = Literal["shown", "touched", "changed", "given", "pasted", "timed out"]

_FIELDS: dict[str, type[AnswerField]] = {
    "likert": PointsField,
    "differential": PointsField,
    "analogue": LineField,
    "choice": ChoiceField,
    "number": NumberField,
    "text": TextField,
}


class ItemPanel(QFrame):
    """Panel with one item of a form.

    Args:
        item: item to show.
        number: number of the item on its page, from 1.
        of: number of items on the page.
        texts: texts of the study.

    Attributes:
        news: signal with an event of the item: the kind of the event, and the number of pasted characters.
        passed: signal: the person has pressed a key to go to the next item.
    """

    news = Signal(str, int)
    passed = Signal()

    def __init__(self, item: FormItem, number: int, of: int, texts: Texts) -> None:
        super().__init__()
        self.item = item
        self._texts = texts
        self._number, self._of = number, of
        self._touched = self._is_shown = self._ungiven = False
        look.style_as_panel(self)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        rows = spaced(QVBoxLayout(self), GAP, 2 * GAP, GAP, 2 * GAP, GAP)
        self.question = look.label(item.text or texts.text("forms.either", low=item.low, high=item.high), bold=True)
        rows.addWidget(self.question)
        self.closed = False
        self._left = math.ceil(item.seconds)
        self._limit = look.label(size="small", muted=True)
        rows.addWidget(self._limit)
        self._limit.setVisible(item.seconds > 0.0)
        if item.several:
            rows.addWidget(look.label(texts.text("forms.several"), "small", muted=True))
        self.field = LineOfTextField(item, texts) if item.one_line else _FIELDS[item.scale](item, texts)
        rows.addWidget(self.field)
        foot = spaced(QHBoxLayout(), GAP)
        rows.addLayout(foot)
        self.missing = look.label(size="small")
        self.missing.setProperty("bad", True)
        foot.addWidget(self.missing, 20)
        self.not_applicable: OptionButton | None = None
        if item.not_applicable:
            words = texts.text("forms.not_applicable")
            self.not_applicable = OptionButton(self.field, words, words, "N", "small", alone=False)
            self.not_applicable.clicked.connect(self._refuse)
            foot.addStretch(1)
            foot.addWidget(self.not_applicable)
        elif not item.required:
            foot.addWidget(look.label(texts.text("forms.optional"), "small", muted=True))
        self.missing.setVisible(False)
        self._pause = QTimer(self, singleShot=True, interval=PAUSE)
        self._pause.timeout.connect(self._changed)
        self.field.touched.connect(self._touch)
        self.field.changed.connect(self._answered)
        self.field.typed.connect(self._typing)
        self.field.pasted.connect(lambda characters: self.news.emit("pasted", characters))
        self.field.passed.connect(self.passed)
        self._show_limit()
        self._name()

    @property
    def answer(self) -> Answer:
        """Answer that the panel shows; None if it shows no answer."""
        if self.not_applicable is not None and self.not_applicable.isChecked():
            return NOT_APPLICABLE
        return self.field.answer

    @property
    def lacks(self) -> str:
        """Sentence about a missing or invalid answer; empty if there is no problem."""
        if self.closed:
            return ""
        if self.answer is None and self.field.problem:
            return self.field.problem
        return self._texts.text("forms.please_answer") if self.answer is None and self.item.required else ""

    def show_answer(self, answer: Answer) -> None:
        """Show an earlier answer."""
        refused = answer == NOT_APPLICABLE and self.not_applicable is not None
        if self.not_applicable is not None:
            self.not_applicable.choose(refused)
        self.field.show_answer(None if refused else answer)
        self._name()

    def point_at_missing(self, sentence: str) -> None:
        """Show a sentence about a missing answer. If `sentence` is empty, hide the earlier sentence."""
        self.missing.setText(sentence)
        self.missing.setVisible(bool(sentence))
        self._name()

    def show_left(self, seconds: float) -> bool:
        """Show the remaining time of the item, and close the item when no time remains.

        Return True if this call closed the item.
        """
        before, self._left = self._left, max(math.ceil(seconds), 0)
        if self.closed or self._left == before:
            return False
        self._show_limit()
        if self._left <= LIMIT_WARNING < before:
            self._announce(self._limit.text())
        if self._left == 0:
            self.close_item()
            self.news.emit("timed out", 0)
        return self.closed

    def close_item(self) -> None:
        """Close the item at the end of its time limit; its answer at this moment counts."""
        self.closed, self._ungiven = True, False
        self._pause.stop()
        self.field.setEnabled(False)
        if self.not_applicable is not None:
            self.not_applicable.setEnabled(False)
        self._limit.setText(self._texts.text("forms.time_is_over"))
        self.point_at_missing("")
        self._announce(self._limit.text())

    def _show_limit(self) -> None:
        self._limit.setText(self._texts.text("forms.seconds_left", count=self._left))

    def _announce(self, sentence: str) -> None:
        QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, sentence))

    def come_into_sight(self) -> None:
        """Report the first moment at which the item is fully visible."""
        if not self._is_shown:
            self._is_shown = True
            self.news.emit("shown", 0)

    def go_on(self) -> None:
        """Report the answer as given, because the person went on to another part of the page."""
        if self._pause.isActive():
            self._changed()
        if self._ungiven:
            self._ungiven = False
            self.news.emit("given", 0)

    def focus_target(self) -> QWidget:
        """Return the widget that gets the focus together with the item: the chosen answer, or the panel itself."""
        if self.closed:
            return self
        if self.not_applicable is not None and self.not_applicable.isChecked():
            return self.not_applicable
        return self.field.focus_target() or self

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the focus ring."""
        super().paintEvent(event)
        if self.hasFocus():
            ring(smooth_painter(self), QRectF(self.rect()).adjusted(-2, -2, 2, 2), colours().accent)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Select an answer by its digit, or "not applicable" by N, unless the focus is in a text field."""
        text = event.text().upper()
        keypad = Qt.KeyboardModifier.KeypadModifier
        if self.closed or event.modifiers() & ~keypad or event.isAutoRepeat():
            super().keyPressEvent(event)
        elif self.hasFocus() and event.key() in ARROWS:
            reachable(self.field)[0].setFocus(Qt.FocusReason.OtherFocusReason)
        elif self.hasFocus() and event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.passed.emit()
        elif text == "N" and self.not_applicable is not None:
            self._touch()
            self._refuse()
        elif not self.field.take_key(text):
            super().keyPressEvent(event)

    def _touch(self) -> None:
        if not self._touched:
            self._touched = True
            self.come_into_sight()
            self.news.emit("touched", 0)

    def _answered(self) -> None:
        if self.not_applicable is not None:
            self.not_applicable.choose(False)
        self._changed()

    def _typing(self) -> None:
        if self.not_applicable is not None:
            self.not_applicable.choose(False)
        self._pause.start()
        self._name()

    def _refuse(self) -> None:
        if self.not_applicable is not None and not self.not_applicable.isChecked():
            self._pause.stop()
            self.field.show_answer(None)
            self.not_applicable.choose(True)
            self._changed()

    def _changed(self) -> None:
        self._pause.stop()
        self._ungiven = True
        if self.answer is not None:
            self.point_at_missing("")
        self._name()
        self.news.emit("changed", 0)

    def _name(self) -> None:
        """Set the item's name for screen readers: question, state, note about a missing answer, and time limit."""
        texts, answer = self._texts, self.answer
        parts = [texts.text("forms.question", number=self._number, total=self._of, question=self.question.text())]
        if answer is None:
            parts.append(texts.text("forms.state_open"))
        else:
            spoken = texts.text("forms.not_applicable") if answer == NOT_APPLICABLE else self.field.told(answer)
            parts.append(texts.text("forms.state_answered", answer=spoken))
        if not self.missing.isHidden():
            parts.append(self.missing.text())
        if self.closed:
            parts.append(self._limit.text())
        elif self.item.seconds:
            parts.append(texts.text("forms.time_limit", count=math.ceil(self.item.seconds)))
        make_region(self, " ".join(parts))
