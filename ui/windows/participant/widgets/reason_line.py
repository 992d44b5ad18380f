"""Line in which a person types a reason."""

from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QLineEdit

from thbridge.roles.shared.team_notices import LONGEST_REASON
from ui.windows.look import px


class ReasonLine(QLineEdit):
    """Line for a text that a person types. While it has the focus, all keys belong to it.

    Enter does nothing, because it must not press a button of the window. Esc gives the focus back to the window.
    """

    def __init__(self, words: str) -> None:
        super().__init__()
        self.setMaxLength(LONGEST_REASON)
        self.setPlaceholderText(words)
        self.setAccessibleName(words)
        self.setMinimumWidth(px(120))
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    def event(self, event: QEvent) -> bool:
        """Keep keys from the window's shortcuts, except those that move from part to part."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            moves = event.key() == Qt.Key.Key_F6 or (event.key() == Qt.Key.Key_Tab and event.modifiers())
            if not moves:
                event.accept()
                return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Handle Enter and Esc; see the class."""
        if event.key() == Qt.Key.Key_Escape:
            self.window().setFocus()
        elif event.key() not in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            super().keyPressEvent(event)
