"""Words that come from outside, shown as they are: names of files, rooms, treasures, topics, people; lines of programs.

Qt takes what looks like HTML in a label, a tool tip or a message box for HTML, and would open the pictures and links in
it; in buttons and menus & stands for a key, in titles of windows [*] for a sign. Other characters turn the direction of
writing round. `PlainTextStyle` forbids HTML wherever Qt makes a label, its own ones included; the rest are functions.
"""

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QApplication, QLabel, QProxyStyle, QWidget

from thbridge.files.errors import visible

LONGEST, LONGEST_TITLE = 20_000, 160
"""Characters that are shown of a text, and of a title: names of others may have half a million."""


def shown(text: str, longest: int = LONGEST) -> str:
    """A text of others as it can be shown: control characters as escapes, but for ends of lines and tabs; cut."""
    return visible(text if len(text) <= longest else f"{text[: longest - 1]}…", keep="\n\t")


def button_text(text: str) -> str:
    """A text of others for a button, a menu or a tab, where a single & would be a key."""
    return shown(text).replace("&", "&&")


def title_text(text: str) -> str:
    """A text of others for the title of a window, where a single [*] would be the sign of changes."""
    return visible(shown(text, LONGEST_TITLE)).replace("[*]", "[*][*]")


class PlainLabel(QLabel):
    """A label that shows text as it is."""

    def __init__(self, text: str = "", parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setText(text)

    def setText(self, text: str) -> None:
        """Show this text."""
        super().setText(shown(text))


class PlainTextStyle(QProxyStyle):
    """Qt's style "Fusion" in which every label takes its text as it is: those of tool tips and message boxes, too."""

    def __init__(self) -> None:
        super().__init__("Fusion")

    def polish(self, dressed: QWidget | QApplication | QPalette | Qt.GlobalColor | QColor, /) -> None:
        """Dress a widget that is shown for the first time."""
        if isinstance(dressed, QLabel):
            dressed.setTextFormat(Qt.TextFormat.PlainText)
        super().polish(dressed)
