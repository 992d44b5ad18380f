"""Page with the changes that saving would write."""

from collections.abc import Sequence

from PySide6.QtGui import QColor, QTextCharFormat, QTextCursor
from PySide6.QtWidgets import QPlainTextEdit, QVBoxLayout, QWidget

from ui.windows.look import GAP, colours, fixed_font, follow_text, label, spaced


class ChangesPage(QWidget):
    """Page with the changes that saving would write."""

    def __init__(self) -> None:
        super().__init__()
        self.view = QPlainTextEdit(readOnly=True)
        self.view.setAccessibleName("Changes to write")
        follow_text(self.view, lambda it: it.setFont(fixed_font()))
        self._words = label("", muted=True)
        column = spaced(QVBoxLayout(self), GAP, 2 * GAP, GAP, 2 * GAP, 2 * GAP)
        column.addWidget(label("Changes to write", "title", bold=True))
        column.addWidget(self._words)
        column.addWidget(self.view, 1)

    def show_changes(self, lines: Sequence[str]) -> None:
        """Show the lines that differ from the file on disk, in the format of `diff -u`."""
        added = sum(line.startswith("+") and not line.startswith("+++") for line in lines)
        gone = sum(line.startswith("-") and not line.startswith("---") for line in lines)
        self._words.setText(
            f"+ marks {added} new lines, - marks {gone} removed lines. All other lines stay unchanged."
            if lines
            else "There are no changes to write."
        )
        self.view.setPlainText("\n".join(lines))
        cursor = QTextCursor(self.view.document())
        cursor.beginEditBlock()
        for index, line in enumerate(lines):
            colour = {"+": colours().good, "-": colours().bad, "@": colours().muted}.get(line[:1])
            if colour is not None:
                block = self.view.document().findBlockByNumber(index)
                form = QTextCharFormat()
                form.setForeground(QColor(colour))
                cursor.setPosition(block.position())
                cursor.movePosition(QTextCursor.MoveOperation.EndOfBlock, QTextCursor.MoveMode.KeepAnchor)
                cursor.setCharFormat(form)
        cursor.endEditBlock()
