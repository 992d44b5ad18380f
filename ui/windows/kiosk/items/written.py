"""Fields for typed answers: numbers, free texts, and codes."""

from PySide6.QtCore import QMimeData, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPlainTextEdit, QVBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.kiosk import Answer, FormItem
from ui.windows import look
from ui.windows.kiosk.items.field import AnswerField
from ui.windows.look import GAP, follow_text, px, spaced

LONGEST = 20_000
"""Maximum number of characters in a free text."""


class NumberField(AnswerField):
    """Field for a number, with its unit."""

    def __init__(self, item: FormItem, texts: Texts) -> None:
        super().__init__(item, texts)
        self.line = follow_text(QLineEdit(), lambda it: it.setMaximumWidth(px(160)))
        self.line.setMaxLength(20)
        least, greatest = self.number(item.minimum), self.number(item.maximum)
        self._wanted = texts.text("forms.number_wanted", least=least, greatest=greatest)
        self.line.setPlaceholderText(texts.text("forms.range", least=least, greatest=greatest))
        name = "forms.number_field_unit" if item.unit else "forms.number_field"
        named = texts.text(name, question=item.text, unit=item.unit, least=least, greatest=greatest)
        self.line.setAccessibleName(named)
        row = spaced(QHBoxLayout(self), GAP, 0)
        row.addWidget(self.line)
        row.addWidget(look.label(item.unit, muted=True), 1)
        self.line.textEdited.connect(self.touched)
        self.line.textEdited.connect(self.typed)
        self.line.returnPressed.connect(self.passed)

    @property
    def answer(self) -> Answer:
        """See `AnswerField`."""
        number = self._number()
        return number if number is not None and self.item.minimum <= number <= self.item.maximum else None

    @property
    def problem(self) -> str:
        """See `AnswerField`."""
        if not self.line.text().strip() or self.answer is not None:
            return ""
        return self._wanted

    def show_answer(self, answer: Answer) -> None:
        """See `AnswerField`."""
        self.line.setText(self.number(answer) if isinstance(answer, float) else "")

    def focus_target(self) -> QWidget:
        """See `AnswerField`."""
        return self.line

    def _number(self) -> float | None:
        text = self.line.text().strip().replace(",", ".")
        try:
            return float(text) if text.isascii() and "_" not in text else None
        except ValueError:
            return None


class LineOfTextField(AnswerField):
    """Field for a text of one line, such as a code."""

    def __init__(self, item: FormItem, texts: Texts) -> None:
        super().__init__(item, texts)
        self.line = follow_text(QLineEdit(), lambda it: it.setMaximumWidth(px(420)))
        self.line.setMaxLength(LONGEST)
        self.line.setAccessibleName(texts.text("forms.line_of_text", question=item.text))
        row = spaced(QHBoxLayout(self), 0, 0)
        row.addWidget(self.line, 20)
        row.addStretch(1)
        self.line.textEdited.connect(self.touched)
        self.line.textEdited.connect(self.typed)
        self.line.returnPressed.connect(self.passed)

    @property
    def answer(self) -> Answer:
        """See `AnswerField`."""
        return self.line.text() if self.line.text().strip() else None

    def show_answer(self, answer: Answer) -> None:
        """See `AnswerField`."""
        self.line.setText(answer if isinstance(answer, str) else "")

    def focus_target(self) -> QWidget:
        """See `AnswerField`."""
        return self.line


class FreeText(QPlainTextEdit):
    """Editor for a free text, which reports pasted and dropped text.

    Args:
        field: answer field that contains this editor.
    """

    def __init__(self, field: AnswerField) -> None:
        super().__init__()
        self._field = field
        self.setTabChangesFocus(True)
        follow_text(self, lambda it: it.setFixedHeight(px(88)))

    def insertFromMimeData(self, source: QMimeData) -> None:
        """Insert pasted text, and report its length."""
        before = len(self.toPlainText())
        super().insertFromMimeData(source)
        if source.hasText():
            self._field.pasted.emit(max(len(source.text()), len(self.toPlainText()) - before))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Ignore Ctrl+Enter, so that the page receives these keys."""
        with_ctrl = event.modifiers() & Qt.KeyboardModifier.ControlModifier
        if with_ctrl and event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            event.ignore()
        else:
            super().keyPressEvent(event)


class TextField(AnswerField):
    """Field for a free text."""

    def __init__(self, item: FormItem, texts: Texts) -> None:
        super().__init__(item, texts)
        self.text = FreeText(self)
        self.text.setAccessibleName(texts.text("forms.free_text", question=item.text))
        self._showing = False
        spaced(QVBoxLayout(self), 0, 0).addWidget(self.text)
        self.text.textChanged.connect(self._edited)

    @property
    def answer(self) -> Answer:
        """See `AnswerField`."""
        return self.text.toPlainText()[:LONGEST] if self.text.toPlainText().strip() else None

    def show_answer(self, answer: Answer) -> None:
        """See `AnswerField`."""
        self._showing = True
        self.text.setPlainText(answer if isinstance(answer, str) else "")
        self._showing = False

    def focus_target(self) -> QWidget:
        """See `AnswerField`."""
        return self.text

    def _edited(self) -> None:
        if not self._showing:
            self.touched.emit()
            self.typed.emit()
