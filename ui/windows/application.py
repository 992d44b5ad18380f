"""Qt application of a window's program."""

import gc
import signal
import sys
from pathlib import Path

from PySide6.QtCore import QEvent, QObject
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QApplication

COLLECTING_PERIOD = 250
"""Milliseconds between two checks for garbage."""


def application() -> QApplication:
    """Return the application of this process.

    The first call creates it; Ctrl-C ends it, and garbage is collected between events.
    """
    app = QApplication.instance()
    if not isinstance(app, QApplication):
        app = QApplication(sys.argv[:1])
        gc.freeze()  # Everything loaded so far is never freed, so garbage collection can skip it.
        GarbageTimer(app)
        app.setDesktopFileName("thbridge")  # Desktops use this name to choose the icon of the windows.
        app.setWindowIcon(QIcon(str(Path(__file__).with_name("thbridge.svg"))))
    # Without this, Ctrl-C raises an exception in the slot that is running, and Qt only prints it.
    signal.signal(signal.SIGINT, lambda _number, _frame: app.quit())
    return app


class GarbageTimer(QObject):
    """Timer that collects reference cycles between two events of Qt's thread, and at no other time.

    Python itself collects in any thread and at any allocation. A closed window in a reference cycle could then be
    destroyed by another thread, or while Qt iterates over its widgets. Both crash the program.

    Args:
        app: owner; the timer lives as long as this object.
    """

    def __init__(self, app: QApplication) -> None:
        super().__init__(app)
        gc.disable()
        self.startTimer(COLLECTING_PERIOD)

    def timerEvent(self, _event: QEvent) -> None:
        """Collect the oldest generation that is due according to Python's own thresholds."""
        due = [
            generation
            for generation, (count, threshold) in enumerate(zip(gc.get_count(), gc.get_threshold(), strict=True))
            if count > threshold
        ]
        if due:
            gc.collect(due[-1])
