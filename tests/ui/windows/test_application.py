"""What all windows' programs have in common."""

import threading
import weakref

from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot


class Forgotten(QWidget):
    """A widget in a cycle, which only the collector can free."""

    def __init__(self) -> None:
        super().__init__()
        self.itself = self


def test_a_forgotten_widget_goes_between_two_events_and_at_no_other_time(qtbot: QtBot) -> None:
    forgotten, kept = weakref.ref(Forgotten()), []

    def allocate() -> None:
        kept.extend([] for _ in range(100_000))

    allocate()
    thread = threading.Thread(target=allocate)
    thread.start()
    thread.join()
    assert forgotten() is not None
    qtbot.waitUntil(lambda: forgotten() is None)
