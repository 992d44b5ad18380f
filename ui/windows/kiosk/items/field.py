"""Field for the answer to an item, whatever its scale."""

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
        touched: a person starts to answer.
        changed: the answer changed.
        typed: the answer changed in the middle of typing.
        pasted: number of characters that were pasted.
        passed: a person finished the item with the keyboard.
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
        """Sentence about an entry that is not a valid answer; empty if nothing is wrong."""
        return ""

    def show_answer(self, answer: Answer) -> None:
        """Show an earlier answer. If None, show no answer."""
        raise NotImplementedError

    def take_key(self, text: str) -> bool:
        """Answer by a digit or letter; return True if the field has an answer with this key."""
        return False

    def focus_target(self) -> QWidget | None:
        """Return the widget that gets the focus when the item does; None if focus would look like an answer."""
        raise NotImplementedError

    def number(self, number: float) -> str:
        """Return a number of the item with all its decimals."""
        return f"{number:g}".replace(".", self.texts.forms.decimal)

    def told(self, answer: Answer) -> str:
        """Return an answer in words."""
        return self.number(answer) if isinstance(answer, float) else str(answer)
