"""A text to read in a panel, no higher than it needs."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QTextBlockFormat, QTextCursor
from PySide6.QtWidgets import QFrame, QTextBrowser, QWidget

from ui.windows import look
from ui.windows.look import GAP

_LINES = 130.0
"""Height of lines, per cent."""


class ReadingText(QTextBrowser):
    """A text, plain or in Markdown, as high as its lines; it scrolls where there is less space.

    Args:
        name: for screen readers.
        parent: of the widget.
        whole: it is never lower than its lines: what it stands in scrolls.
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
        """Show it, unless it is shown already."""
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
        # Its size hint stays small: a page that scrolls would make room for all of it, and its buttons be out of sight.
        high = int(self.document().size().height()) + 1 + self.height() - self.viewport().height()
        if self._whole:
            self.setMinimumHeight(high)
        self.setMaximumHeight(high)
