"""Keys of the window. Each key has one shortcut, so that the focused widget does not receive the key as well."""

import string
from collections.abc import Callable

from PySide6.QtGui import QKeyEvent, QKeySequence, QShortcut
from PySide6.QtWidgets import QWidget

from ui.model.playing.keys import act_for, is_letter
from ui.model.playing.screen import Act, Screen

_NAMES = {
    **{key: key for key in f"{string.digits}{string.ascii_uppercase}?"},
    **{f"Ctrl+{letter}": f"Ctrl+{letter}" for letter in string.ascii_uppercase},
    **{f"Ctrl+{digit}": f"Ctrl+{digit}" for digit in "123456789"},
    **{key: key for key in ("Tab", "Shift+Tab", "Enter", "Esc", "Space", "Up", "Down", "Home", "End", "F1")},
    "Return": "Enter",
}
"""Names of keys in `ui.model.playing.keys`, by the names that Qt uses."""

_REPEATING = ("Tab", "Shift+Tab", "Up", "Down")


class KeyboardShortcuts:
    """Shortcuts that turn keys into acts.

    If a key has no act on the current screen, the focused widget receives it. On a page of text, for example, Tab then
    moves from button to button, and arrow keys scroll.

    Args:
        window: window with the keys.
        do: function to call with the act of a pressed key.
    """

    def __init__(self, window: QWidget, do: Callable[[Act], None]) -> None:
        self._do = do
        self._screen: Screen | None = None
        self._acts: dict[str, Act | None] = {}
        self._shortcuts = {key: self._shortcut(window, key) for key in _NAMES}

    def show_screen(self, screen: Screen) -> None:
        """Set the act of each key on this screen."""
        self._screen = screen
        for key, shortcut in self._shortcuts.items():
            act = act_for(_NAMES[key], screen)
            self._acts[key] = act
            shortcut.setEnabled(act is not None)

    def type(self, event: QKeyEvent) -> None:
        """Do the act of a letter that has no shortcut because it belongs to another alphabet."""
        letter = event.text().upper()
        if is_letter(letter) and letter not in _NAMES and self._screen is not None and not event.isAutoRepeat():
            act = act_for(letter, self._screen)
            if act is not None:
                self._do(act)

    def _shortcut(self, window: QWidget, key: str) -> QShortcut:
        shortcut = QShortcut(QKeySequence(key), window)
        shortcut.setAutoRepeat(key in _REPEATING)
        shortcut.activated.connect(lambda: self._pressed(key))
        return shortcut

    def _pressed(self, key: str) -> None:
        act = self._acts.get(key)
        if act is not None:
            self._do(act)
