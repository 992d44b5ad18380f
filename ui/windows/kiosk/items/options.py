"""Fields with answers to choose from: points of a scale, options, and "not applicable"."""

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtGui import QFocusEvent, QKeyEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.kiosk import Answer, FormItem
from ui.windows import look
from ui.windows.kiosk.items.field import AnswerField
from ui.windows.look import GAP, spaced
from ui.windows.participant.widgets.buttons import ActionButton, ButtonFace, Weight

_SHORT = 14
"""Maximum number of characters of an option that shares a row with other options."""
_BESIDE = 4
"""Maximum number of options in a row."""


class OptionButton(ActionButton):
    """Button for an answer. Enter chooses the answer; a second Enter goes to the next item.

    Args:
        field: field that contains the button.
        label: text on the button.
        name: name for screen readers.
        key: key that chooses the answer; empty if the label already shows this key.
        weight: weight of the button.
        alone: True if this answer excludes all others.
    """

    def __init__(
        self, field: AnswerField, label: str, name: str, key: str = "", weight: Weight = "plain", *, alone: bool = True
    ) -> None:
        super().__init__(field.texts, weight, hints=len(label) > _SHORT)
        self._field = field
        self._alone = alone
        self.setCheckable(True)
        self.show_face(ButtonFace(label, key), name)
        self.setAccessibleDescription(field.item.text)
        self.pressed.connect(field.touched)
        # Set the focus, so that the keyboard continues from the place of the click. Do this only after the click has
        # ended, because a change of focus may scroll the page.
        self.clicked.connect(lambda: self.setFocus(Qt.FocusReason.MouseFocusReason))
        self.choose(False)

    def choose(self, chosen: bool) -> None:
        """Show whether the answer is chosen. For screen readers, an exclusive answer is a radio button."""
        self.setAutoExclusive(False)
        self.setChecked(chosen)
        self.setAutoExclusive(self._alone)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Keep all buttons reachable by arrow keys; Qt would allow only one radio button of a group."""
        super().focusInEvent(event)
        for other in self._field.findChildren(OptionButton):
            other.setFocusPolicy(Qt.FocusPolicy.TabFocus)

    def nextCheckState(self) -> None:
        """Do nothing, because the field decides which answer is chosen."""

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Handle Enter: if this answer is already chosen, go to the next item."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self.isChecked() and not event.isAutoRepeat():
            self._field.passed.emit()
        else:
            super().keyPressEvent(event)


class PointsField(AnswerField):
    """Field with the points of a scale. Either each point has a word, or only the first and the last point."""

    def __init__(self, item: FormItem, texts: Texts) -> None:
        super().__init__(item, texts)
        self.buttons: list[OptionButton] = []
        count, words = len(item.words), item.words
        has_words = any(words[1:-1])
        grid = spaced(QGridLayout(self), GAP // 2, 0)
        for index, word in enumerate(words):
            number = str(index + 1)
            if word:
                name = texts.text("forms.point_word", point=number, points=count, word=word)
            elif not has_words and words[0] and words[-1]:
                name = texts.text("forms.point_ends", point=number, points=count, low=words[0], high=words[-1])
            else:
                name = texts.text("forms.point", point=number, points=count)
            button = OptionButton(self, number, name)
            button.clicked.connect(lambda _=False, value=index + 1.0: self._choose(value))
            grid.addWidget(button, 0, index)
            grid.setColumnStretch(index, 1)
            self.buttons.append(button)
            if has_words:
                label = look.label(word, "small", muted=True)
                label.setAlignment(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop)
                grid.addWidget(label, 1, index)
        if not has_words:
            half = max(count // 2, 1)
            low, high = look.label(words[0], "small", muted=True), look.label(words[-1], "small", muted=True)
            high.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignTop)
            grid.addWidget(low, 1, 0, 1, half)
            grid.addWidget(high, 1, count - half, 1, half)

    @property
    def answer(self) -> Answer:
        """See `AnswerField`."""
        return next((index + 1.0 for index, button in enumerate(self.buttons) if button.isChecked()), None)

    def show_answer(self, answer: Answer) -> None:
        """See `AnswerField`."""
        for index, button in enumerate(self.buttons):
            button.choose(answer == index + 1.0)

    def take_key(self, text: str) -> bool:
        """See `AnswerField`."""
        if not text.isdecimal() or not 1 <= int(text) <= len(self.buttons):
            return False
        self.touched.emit()
        self._choose(float(text))
        return True

    def focus_target(self) -> QWidget | None:
        """See `AnswerField`."""
        return next((button for button in self.buttons if button.isChecked()), None)

    def _choose(self, value: float) -> None:
        if self.answer != value:
            self.show_answer(value)
            self.changed.emit()


class ChoiceField(AnswerField):
    """Field with options. A person chooses one or several options."""

    def __init__(self, item: FormItem, texts: Texts) -> None:
        super().__init__(item, texts)
        self._labels = dict(zip(item.options, item.labels or item.options, strict=True))
        in_a_row = len(item.options) <= _BESIDE and max(map(len, self._labels.values())) <= _SHORT
        rows = spaced(QHBoxLayout(self) if in_a_row else QVBoxLayout(self), GAP // 2, 0)
        self.buttons: list[OptionButton] = []
        for number, (option, label) in enumerate(self._labels.items(), start=1):
            button = OptionButton(self, label, label, str(number) if number < 10 else "", alone=not item.several)
            button.clicked.connect(lambda _=False, chosen=option: self._choose(chosen))
            rows.addWidget(button)
            self.buttons.append(button)

    @property
    def answer(self) -> Answer:
        """See `AnswerField`."""
        chosen = self._chosen()
        if self.item.several:
            return tuple(chosen) or None
        return chosen[0] if chosen else None

    def show_answer(self, answer: Answer) -> None:
        """See `AnswerField`."""
        chosen = answer if isinstance(answer, tuple) else (answer,)
        for option, button in zip(self.item.options, self.buttons, strict=True):
            button.choose(option in chosen)

    def take_key(self, text: str) -> bool:
        """See `AnswerField`."""
        if not text.isdecimal() or not 1 <= int(text) <= len(self.buttons):
            return False
        self.touched.emit()
        self._choose(self.item.options[int(text) - 1])
        return True

    def focus_target(self) -> QWidget | None:
        """See `AnswerField`."""
        return next((button for button in self.buttons if button.isChecked()), None)

    def told(self, answer: Answer) -> str:
        """See `AnswerField`."""
        chosen = answer if isinstance(answer, tuple) else (answer,)
        return ", ".join(label for option, label in self._labels.items() if option in chosen)

    def _chosen(self) -> Sequence[str]:
        return [option for option, button in zip(self.item.options, self.buttons, strict=True) if button.isChecked()]

    def _choose(self, option: str) -> None:
        before = self.answer
        if self.item.several:
            chosen = set(self._chosen()) ^ {option}
            self.show_answer(tuple(one for one in self.item.options if one in chosen))
        else:
            self.show_answer(option)
        if self.answer != before:
            self.changed.emit()
