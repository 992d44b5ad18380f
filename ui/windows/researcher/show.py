"""Entry point of the researcher's window."""

import time

from ui.windows.application import application
from ui.windows.look import Appearance, Choice, TextSize, colours, user_settings
from ui.windows.researcher.feeds.feed import Feed
from ui.windows.researcher.window import ResearcherWindow


def show(feed: Feed, title: str, choice: Choice) -> None:
    """Show a feed in the researcher's window until it is closed.

    Args:
        feed: the session or recording.
        title: its name, for people.
        choice: light, dark, or as the system has it.
    """
    app = application()
    appearance, text_size = Appearance(app, choice), TextSize(app, user_settings())
    window = ResearcherWindow(feed, title, colours(), time.monotonic)
    appearance.changed.connect(window.set_palette)
    text_size.add_keys(window)
    window.show()
    app.exec()
