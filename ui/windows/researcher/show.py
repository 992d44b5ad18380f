"""Opens the researcher's window and runs it until it is closed."""

import time

from PySide6.QtWidgets import QApplication

from ui.windows.look import Appearance, Choice
from ui.windows.researcher.feed import Feed
from ui.windows.researcher.window import ResearcherWindow


def show(feed: Feed, title: str, choice: Choice) -> None:
    """Show what is watched until the window is closed.

    Args:
        feed: what is watched.
        title: what it is, for people.
        choice: light, dark, or as the system has it.
    """
    app = QApplication.instance()
    if not isinstance(app, QApplication):
        app = QApplication(["thbridge"])
    appearance = Appearance(app, choice)
    window = ResearcherWindow(feed, title, appearance.palette, time.monotonic)
    appearance.changed.connect(window.set_palette)
    window.show()
    app.exec()
