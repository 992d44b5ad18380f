"""Functions that open the researcher's windows."""

import time
from pathlib import Path

from PySide6.QtCore import QObject, Qt
from PySide6.QtWidgets import QApplication, QWidget

from thbridge.files.errors import BadFile
from ui.windows.application import application
from ui.windows.look import Choice, colours
from ui.windows.preferences import Preferences, preferences_of, user_settings
from ui.windows.researcher.feeds.opening import OpenedFeed, open_feed
from ui.windows.researcher.memory import WatchMemory
from ui.windows.researcher.open_dialog import OpenDialog
from ui.windows.researcher.window import ResearcherWindow

OPEN_TIMEOUT = 0.5
"""Seconds for which the dialog waits for a recording to open. The recording's window shows faults found later."""


class WatchProgram(QObject):
    """Researcher's windows of one process. Each window shows one recording or session.

    Args:
        app: the application.
        preferences: preferences of the user.
        memory: storage of recently opened recordings and sessions.

    Attributes:
        windows: open windows.
        dialog: latest dialog *Open*; None before the first dialog.
    """

    def __init__(self, app: QApplication, preferences: Preferences, memory: WatchMemory) -> None:
        super().__init__(app)
        self._preferences, self._memory = preferences, memory
        self.windows: list[ResearcherWindow] = []
        self.dialog: OpenDialog | None = None

    def show(self, opened: OpenedFeed) -> ResearcherWindow:
        """Show a recording or session in a new window."""
        self._memory.add(opened.source)
        window = ResearcherWindow(opened.feed, opened.title, colours(), time.monotonic)
        # Delete the window when it closes. Lambdas below refer to it, so garbage collection would never delete it.
        window.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._preferences.changed.connect(window.set_palette)
        self._preferences.add_keys(window)
        self._preferences.keep_place(window)
        window.settings_wanted.connect(lambda: self._preferences.open(window))
        window.open_wanted.connect(lambda: self.ask(window))
        window.source_chosen.connect(lambda path: self._open_from(window, path))
        window.closed.connect(lambda: self.windows.remove(window))
        if not opened.feed.live:
            window.use_bookmarks(self._memory.bookmarks(opened.source))
            window.bookmarked.connect(lambda: self._memory.keep_bookmarks(opened.source, window.bookmarks.times))
        self.windows.append(window)
        window.show()
        return window

    def open(self, source: str, key: Path | None = None) -> str:
        """Open a path or an address in a window. Return the reason if that is not possible, otherwise an empty text."""
        try:
            self.show(open_feed(source, key, OPEN_TIMEOUT))
        except BadFile as fault:
            return str(fault)
        return ""

    def ask(self, parent: QWidget | None) -> None:
        """Open the dialog *Open*."""
        self.dialog = OpenDialog(self._memory.recent(), self.open, parent)
        self.dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.dialog.open()

    def _open_from(self, window: ResearcherWindow, path: str) -> None:
        problem = self.open(path)
        if problem:
            window.show_status(problem)


def show(opened: OpenedFeed | None, choice: Choice) -> None:
    """Show a recording or session. Return when its window and all windows opened from it are closed.

    Args:
        opened: recording or session to show. If None, the dialog *Open* asks for it first.
        choice: light, dark, or the system's colors.
    """
    app = application()
    program = WatchProgram(app, preferences_of(app, "watch", choice), WatchMemory(user_settings("watch")))
    if opened is None:
        program.ask(None)
    else:
        program.show(opened)
    app.exec()
