"""History of the game as text."""

from PySide6.QtCore import QSize
from PySide6.QtGui import QColor, QFont, QTextCharFormat, QTextCursor
from PySide6.QtWidgets import QFrame, QPlainTextEdit, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import HistoryLine
from ui.model.playing.spoken import speaker_of
from ui.windows import look
from ui.windows.look import GAP, colours, follow_text, font, px

MAX_LINES = 500
"""Maximum number of lines shown."""


class HistoryView(QPlainTextEdit):
    """Text of all sentences and events of the game. It can be copied, and the newest line is at the bottom."""

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        look.style_as_panel(self)
        self.setAccessibleName(texts.text("window.history"))
        self.setReadOnly(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        follow_text(self, HistoryView._fit)
        self.setMaximumBlockCount(MAX_LINES)
        self.setTabChangesFocus(True)
        self.document().setDocumentMargin(GAP)
        self._shown: tuple[HistoryLine, ...] = ()

    def _fit(self) -> None:
        self.setFont(font("small"))
        self.setMinimumHeight(px(64))
        self.setMaximumHeight(px(160))

    def sizeHint(self) -> QSize:
        """Return the size of some lines; with little space, the view shrinks to two lines."""
        return QSize(px(300), px(160))

    def height_over(self, height: int) -> int:
        """Return the height of the history over a map of this height, logical pixels."""
        return max(self.minimumHeight(), min(self.maximumHeight(), height // 3))

    def show_history(self, history: tuple[HistoryLine, ...]) -> None:
        """Show this history; append only the new lines."""
        if history == self._shown:
            return
        new = _new(self._shown, history)
        if len(new) == len(history):
            self.clear()
        self._shown = history
        for line in new:
            self._write(line)

    def repaint_words(self) -> None:
        """Write the history again in the current colors."""
        shown, self._shown = self._shown, ()
        self.show_history(shown)

    def _write(self, line: HistoryLine) -> None:
        palette = colours()
        plain, strong = QTextCharFormat(), QTextCharFormat()
        plain.setForeground(QColor(palette.muted if line.speaker == "game" else palette.text))
        strong.setForeground(QColor(palette.text))
        strong.setFontWeight(QFont.Weight.DemiBold)
        cursor = QTextCursor(self.document())
        cursor.movePosition(QTextCursor.MoveOperation.End)
        if not self.document().isEmpty():
            cursor.insertBlock()
        speaker = speaker_of(self._texts, line)
        if speaker:
            cursor.insertText(f"{speaker}: ", strong)
        cursor.insertText(line.text, plain)
        bar = self.verticalScrollBar()
        bar.setValue(bar.maximum())


def _new(shown: tuple[HistoryLine, ...], history: tuple[HistoryLine, ...]) -> tuple[HistoryLine, ...]:
    """Return the lines of `history` after the lines shown. The oldest lines shown may be missing in `history`."""
    for gone in range(len(shown) + 1):
        kept = len(shown) - gone
        if shown[gone:] == history[:kept]:
            return history[kept:]
    return history
