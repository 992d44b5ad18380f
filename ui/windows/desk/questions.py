"""Questions of the desk before anything final, with the reason that the log wants."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLineEdit, QPushButton, QVBoxLayout, QWidget

from ui.windows.look import GAP, follow_text, label, px, spaced


class ReasonBox(QDialog):
    """A question whose answer needs a reason; without one there is no yes.

    Args:
        parent: the window.
        title: of the box.
        question: what is asked, and what follows from it.
        yes: words of the button that does it.

    Attributes:
        reason: the field.
        agree: the button that does it.
    """

    def __init__(self, parent: QWidget, title: str, question: str, yes: str) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.setObjectName("question")
        self.reason = QLineEdit(placeholderText="The reason, for the log; it is needed")
        self.reason.setAccessibleName("Reason")
        buttons = QDialogButtonBox()
        self.agree = buttons.addButton(yes, QDialogButtonBox.ButtonRole.AcceptRole)
        cancel = buttons.addButton(QDialogButtonBox.StandardButton.Cancel)
        self.agree.setEnabled(False)
        self.agree.setAutoDefault(False)
        self.agree.setToolTip("Write a reason first")
        self.reason.textChanged.connect(lambda text: self.agree.setEnabled(bool(text.strip())))
        cancel.setAutoDefault(False)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        words = label(question)
        follow_text(words, lambda it: it.setMinimumWidth(px(380)))
        column = spaced(QVBoxLayout(self), GAP, 2 * GAP)
        column.addWidget(words)
        column.addWidget(self.reason)
        column.addWidget(buttons)
        self.reason.setFocus()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Let Enter press the button with the focus; in the field it only goes on to the button that does it."""
        if event.key() not in {Qt.Key.Key_Return, Qt.Key.Key_Enter}:
            super().keyPressEvent(event)
        elif isinstance(focus := self.focusWidget(), QPushButton):
            focus.click()
        elif self.agree.isEnabled():
            self.agree.setFocus()
