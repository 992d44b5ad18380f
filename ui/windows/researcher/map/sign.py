"""A sentence about trouble across the top of the map."""

from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent
from PySide6.QtWidgets import QWidget

from ui.windows.look import px, style_as_panel
from ui.windows.words_of_others import PlainLabel

WIDEST, EDGE = 640, 16
"""Greatest width of the sign, `px`, and its distance from the map's edges, pixels."""


class TroubleSign(PlainLabel):
    """A label that says what is wrong, or what is waited for.

    Args:
        view: the map that it lies on.
    """

    def __init__(self, view: QWidget) -> None:
        super().__init__(parent=view)
        self.setAccessibleDescription("Trouble")
        self.setWordWrap(True)
        self.setMargin(8)
        style_as_panel(self)
        self.hide()

    def show_sentence(self, text: str) -> None:
        """Show a sentence; an empty one hides the sign."""
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
