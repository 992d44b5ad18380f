"""Questions of the desk before anything final, with the reason that the log wants."""

from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLineEdit, QVBoxLayout, QWidget

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
        # Enter in the field only goes on to the buttons: nothing final follows from one key.
        cancel.setAutoDefault(False)
        self.reason.returnPressed.connect(self._go_on)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        words = label(question)
        follow_text(words, lambda it: it.setMinimumWidth(px(380)))
        column = spaced(QVBoxLayout(self), GAP, 2 * GAP)
        column.addWidget(words)
        column.addWidget(self.reason)
        column.addWidget(buttons)
        self.reason.setFocus()

    def _go_on(self) -> None:
        if self.agree.isEnabled():
            self.agree.setFocus()
