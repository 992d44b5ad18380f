"""Base class of the answer fields, one for each kind of scale."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.kiosk import Answer, FormItem


class AnswerField(QWidget):
    """Base class of the answer fields.

    Args:
        item: item that the field answers.
        texts: texts of the study.

    Attributes:
        touched: signal: a person has begun to answer.
        changed: signal: the answer has changed.
        typed: signal: the answer has changed, and the person may still be typing.
        pasted: signal with the number of pasted characters.
        passed: signal: a person has pressed a key to go to the next item.
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
        """Answer that the field shows; None if it shows no answer."""
        raise NotImplementedError

    @property
    def problem(self) -> str:
        """Sentence with the reason why an entry is not a valid answer; empty if the entry is valid."""
        return ""

    def show_answer(self, answer: Answer) -> None:
        """Show an earlier answer. If `answer` is None, show no answer."""
        raise NotImplementedError

    def take_key(self, text: str) -> bool:
        """Select the answer with this digit or letter. Return True if the field has an answer with this key."""
        return False

    def focus_target(self) -> QWidget | None:
        """Return the widget that gets the focus together with the item; None if the focus would look like an answer."""
        raise NotImplementedError

    def number(self, number: float) -> str:
        """Return a number as text in the study's notation, with all its decimal places."""
        return f"{number:g}".replace(".", self.texts.forms.decimal)

    def told(self, answer: Answer) -> str:
        """Return an answer in words."""
        return self.number(answer) if isinstance(answer, float) else str(answer)
