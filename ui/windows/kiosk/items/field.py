"""Base class of the fields for answers, for items of all scales."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.kiosk import Answer, FormItem


class AnswerField(QWidget):
    """Base class of the fields.

    Args:
        item: item that is answered.
        texts: texts of the study.

    Attributes:
        touched: signal: a person begins to answer.
        changed: signal: the answer has changed.
        typed: signal: the answer has changed, and the person still types.
        pasted: signal with the number of pasted characters.
        passed: signal: a person has finished the item with the keyboard.
    """

    touched = Signal()
    changed = Signal()
    typed = Signal()
    pasted = Signal(int)
    passed = Signal()

    def __init__(self, item: FormItem, texts: Texts) -> None:
        super().__init__()
        self.item = item
        self.texts = texts

    @property
    def answer(self) -> Answer:
        """Answer shown; None if there is none."""
        raise NotImplementedError

    @property
    def problem(self) -> str:
        """Sentence that says why an entry is not a valid answer; empty if it is valid."""
        return ""

    def show_answer(self, answer: Answer) -> None:
        """Show an earlier answer. If None, show no answer."""
        raise NotImplementedError

    def take_key(self, text: str) -> bool:
        """Answer by a digit or letter; return True if an answer of the field has this key."""
        return False

    def focus_target(self) -> QWidget | None:
        """Return the widget that gets the focus when the item does; None if the focus would look like an answer."""
        raise NotImplementedError

    def number(self, number: float) -> str:
        """Return a number of the item with all its decimal places."""
        return f"{number:g}".replace(".", self.texts.forms.decimal)

    def told(self, answer: Answer) -> str:
        """Return an answer in words."""
        return self.number(answer) if isinstance(answer, float) else str(answer)
