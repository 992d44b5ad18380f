"""A field in which an item is answered, whatever its scale."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.kiosk import Answer, FormItem


class AnswerField(QWidget):
    """Base class of the fields.

    Args:
        item: what is answered.
        texts: of the study.

    Attributes:
        touched: a person begins to answer.
        changed: the answer is another one.
        typed: likewise, in the middle of typing.
        pasted: so many characters were pasted.
        passed: a person is done with it, by the keyboard.
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
        """The answer that is shown; None: none."""
        raise NotImplementedError

    @property
    def problem(self) -> str:
        """A sentence about what is there and is no answer; empty where nothing is wrong."""
        return ""

    def show_answer(self, answer: Answer) -> None:
        """Show an answer that was given before; None shows none."""
        raise NotImplementedError

    def take_key(self, text: str) -> bool:
        """Answer by a digit or letter, if it stands for something here; True if it does."""
        return False

    def focus_target(self) -> QWidget | None:
        """Return the widget that gets the focus when the item does; None where it would look like an answer."""
        raise NotImplementedError

    def number(self, number: float) -> str:
        """Return a number of the item with all its decimals."""
        return f"{number:g}".replace(".", self.texts.forms.decimal)

    def told(self, answer: Answer) -> str:
        """Return an answer in words."""
        return self.number(answer) if isinstance(answer, float) else str(answer)
