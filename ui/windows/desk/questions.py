"""Questions of the desk before actions that cannot be undone; the log records the given reason."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLineEdit, QPushButton, QVBoxLayout, QWidget

from ui.windows.look import GAP, follow_text, label, px, spaced


class ReasonBox(QDialog):
    """Question that a person can confirm only with a reason.

    Args:
        parent: the window.
        title: title of the dialog.
        question: the question, and the consequences of confirming it.
        yes: text of the button that confirms.

    Attributes:
        reason: field for the reason.
        agree: button that confirms.
    """

    def __init__(self, parent: QWidget, title: str, question: str, yes: str) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.setObjectName("question")
        self.reason = QLineEdit(placeholderText="Reason for the log (required)")
        self.reason.setAccessibleName("Reason")
        buttons = QDialogButtonBox()
        self.agree = buttons.addButton(yes, QDialogButtonBox.ButtonRole.AcceptRole)
        cancel = buttons.addButton(QDialogButtonBox.StandardButton.Cancel)
        self.agree.setEnabled(False)
        self.agree.setAutoDefault(False)
        self.agree.setToolTip("Enter a reason first")
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
        """Let Enter press the focused button. In the text field, Enter only moves the focus to the confirm button."""
        if event.key() not in {Qt.Key.Key_Return, Qt.Key.Key_Enter}:
            super().keyPressEvent(event)
        elif isinstance(focus := self.focusWidget(), QPushButton):
            focus.click()
        elif self.agree.isEnabled():
            self.agree.setFocus()
