"""Text of an editor with all its signs."""

from PySide6.QtWidgets import QPlainTextEdit

_BLOCK_END = "\u2029"


def exact_text(editor: QPlainTextEdit) -> str:
    """Return what is written in an editor; `toPlainText` would make blanks of the blanks that keep words together."""
    return editor.document().toRawText().replace(_BLOCK_END, "\n")
