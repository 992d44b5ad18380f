"""Functions that show untrusted text literally.

Untrusted texts are names of files, rooms, treasures, topics and people, and lines that programs print. In labels, tool
tips and message boxes, Qt treats text like HTML as HTML, and would open the pictures and links in the text. In buttons
and menus, & marks a key. In window titles, [*] is replaced by the sign of unsaved changes. Some other characters
reverse the direction of writing. `PlainTextStyle` forbids HTML in all labels, including labels that Qt creates itself.
The functions handle the other cases.
"""

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QApplication, QLabel, QProxyStyle, QWidget

from thbridge.files.errors import visible

LONGEST, LONGEST_TITLE = 20_000, 160
"""Maximum number of characters shown of a text, and of a title. Untrusted names can have half a million characters."""


def shown(text: str, longest: int = LONGEST) -> str:
    """Return an untrusted text in a form that can be shown.

    A long text is cut. Control characters, except line ends and tabs, are replaced by escapes.
    """
    return visible(text if len(text) <= longest else f"{text[: longest - 1]}…", keep="\n\t")


def button_text(text: str) -> str:
    """Return an untrusted text for a button, a menu or a tab, in which a single & would mark a key."""
    return shown(text).replace("&", "&&")


def title_text(text: str) -> str:
    """Return an untrusted text for a window title. Qt would replace [*] in it by the sign of unsaved changes."""
    return visible(shown(text, LONGEST_TITLE)).replace("[*]", "[*][*]")


def breakable(text: str, longest: int = 16) -> str:
    """Return a text in which long words have places where a line can end."""
    words = ("\u200b".join(word[at : at + longest] for at in range(0, len(word), longest)) for word in text.split(" "))
    return " ".join(words)


class PlainLabel(QLabel):
    """Label that shows text literally."""

    def __init__(self, text: str = "", parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setText(text)

    def setText(self, text: str) -> None:
        """Show this text."""
        super().setText(shown(text))


class PlainTextStyle(QProxyStyle):
    """Qt's style "Fusion" with labels that show their text literally, also in tool tips and message boxes."""

    def __init__(self) -> None:
        super().__init__("Fusion")

    def polish(self, dressed: QWidget | QApplication | QPalette | Qt.GlobalColor | QColor, /) -> None:
        """Prepare a widget before it is shown for the first time."""
        if isinstance(dressed, QLabel):
            dressed.setTextFormat(Qt.TextFormat.PlainText)
        super().polish(dressed)
