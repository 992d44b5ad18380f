"""Sentence about a problem, at the top of the map."""

from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent
from PySide6.QtWidgets import QWidget

from ui.windows.look import px, style_as_panel
from ui.windows.untrusted_text import PlainLabel

WIDEST, EDGE = 640, 16
"""Maximum width of the label, `px`, and its distance from the edges of the map, pixels."""


class TroubleSign(PlainLabel):
    """Label with a sentence about a problem, or about the reason why the window waits.

    Args:
        view: map below the label.
    """

    def __init__(self, view: QWidget) -> None:
        super().__init__(parent=view)
        self.setAccessibleDescription("Problem")
        self.setWordWrap(True)
        self.setMargin(8)
        style_as_panel(self)
        self.hide()

    def show_sentence(self, text: str) -> None:
        """Show a sentence. If it is empty, hide the label."""
        if text == self.text() and self.isHidden() == (not text):
            return
        if text.partition("(")[0] != self.text().partition("(")[0]:
            QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, text))
        self.setText(text)
        view = self.parentWidget()
        self.setFixedWidth(px(WIDEST) if view is None else min(px(WIDEST), view.width() - 2 * EDGE))
        self.adjustSize()
        self.move(EDGE, EDGE)
        self.setVisible(bool(text))
