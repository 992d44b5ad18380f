"""Qt application of a program with windows."""

import gc
import signal
import sys
from pathlib import Path

from PySide6.QtCore import QEvent, QObject
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QApplication

COLLECTING_PERIOD = 250
"""Milliseconds between two checks whether garbage collection is due."""


def application() -> QApplication:
    """Return the application of this process.

    The first call creates the application. Ctrl-C ends the application. Garbage is collected between events.
    """
    app = QApplication.instance()
    if not isinstance(app, QApplication):
        app = QApplication(sys.argv[:1])
        gc.freeze()  # Objects loaded so far are never freed, so garbage collection can skip them.
        GarbageTimer(app)
        app.setDesktopFileName("thbridge")  # Desktops use this name to choose the icon of the windows.
        app.setWindowIcon(QIcon(str(Path(__file__).with_name("thbridge.svg"))))
    # Without this, Ctrl-C raises an exception in the running slot, and Qt only prints the exception.
    signal.signal(signal.SIGINT, lambda _number, _frame: app.quit())
    return app


class GarbageTimer(QObject):
    """Timer that collects reference cycles between two events of Qt's thread, and at no other time.

    Python itself collects garbage in any thread and at any allocation. Another thread could then destroy a closed
    window in a reference cycle, or the window could be destroyed while Qt iterates over its widgets. Both cases crash
    the program.

    Args:
        app: application that owns the timer; Qt deletes both together.
    """

    def __init__(self, app: QApplication) -> None:
        super().__init__(app)
        gc.disable()
        self.startTimer(COLLECTING_PERIOD)

    def timerEvent(self, _event: QEvent) -> None:
        """Collect the oldest generation of objects that is due according to Python's own thresholds."""
        due = [
            generation
            for generation, (count, threshold) in enumerate(zip(gc.get_count(), gc.get_threshold(), strict=True))
            if count > threshold
        ]
        if due:
            gc.collect(due[-1])
