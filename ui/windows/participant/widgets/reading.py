"""Text to read in a panel; it uses only the height that its lines need."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QTextBlockFormat, QTextCursor
from PySide6.QtWidgets import QFrame, QTextBrowser, QWidget

from ui.windows import look
from ui.windows.look import GAP

_LINES = 130.0
"""Height of lines, percent of the normal height."""


class ReadingText(QTextBrowser):
    """Plain text or Markdown, as high as its lines. If there is less space, the text scrolls.

    Args:
        name: name for screen readers.
        parent: parent widget.
        whole: True to keep the full height, so that the area around the text scrolls instead.
    """

    def __init__(self, name: str, parent: QWidget | None = None, *, whole: bool = False) -> None:
        super().__init__(parent)
        self._shown: tuple[str, bool] | None = None
        self._whole = whole
        self.setOpenLinks(False)
        self.setTabChangesFocus(True)
        self.setCursorWidth(0)
        self.setTextInteractionFlags(
            Qt.TextInteractionFlag.TextSelectableByKeyboard | Qt.TextInteractionFlag.TextSelectableByMouse
        )
        self.document().setDocumentMargin(2 * GAP)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setAccessibleName(name)
        look.style_as_panel(self)
        self.document().documentLayout().documentSizeChanged.connect(self._fit)

    def show_text(self, text: str, *, markdown: bool = False) -> None:
        """Show the text; do nothing if it is already shown."""
        if self._shown == (text, markdown):
            return
        self._shown = text, markdown
        if markdown:
            self.setMarkdown(text)
        else:
            self.setPlainText(text.rstrip())
        spacing = QTextBlockFormat()
        spacing.setLineHeight(_LINES, QTextBlockFormat.LineHeightTypes.ProportionalHeight.value)
        cursor = QTextCursor(self.document())
        cursor.select(QTextCursor.SelectionType.Document)
        cursor.mergeBlockFormat(spacing)

    def _fit(self) -> None:
        # Keep the size hint small. With a large hint, a page that scrolls would give all its height to the text, and
        # hide its buttons.
        high = int(self.document().size().height()) + 1 + self.height() - self.viewport().height()
        if self._whole:
            self.setMinimumHeight(high)
        self.setMaximumHeight(high)
