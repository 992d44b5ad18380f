"""Text of an editor with all its characters unchanged."""

from PySide6.QtWidgets import QPlainTextEdit

_BLOCK_END = "\u2029"


def exact_text(editor: QPlainTextEdit) -> str:
    """Return the exact text of an editor. Qt's `toPlainText` would replace non-breaking spaces by plain spaces."""
    return editor.document().toRawText().replace(_BLOCK_END, "\n")
