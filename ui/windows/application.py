"""The Qt application of a window's program."""

import gc
import signal
import sys
from pathlib import Path

from PySide6.QtCore import QEvent, QObject
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QApplication

COLLECTING_PERIOD = 250
"""Milliseconds between two looks at how much garbage there may be."""


def application() -> QApplication:
    """Return the application of this process, made by the first call: Ctrl-C ends it, garbage goes between events."""
    app = QApplication.instance()
    if not isinstance(app, QApplication):
        app = QApplication(sys.argv[:1])
        gc.freeze()  # what is loaded by now stays for good: nobody need look through it again
        GarbageTimer(app)
        app.setDesktopFileName("thbridge")  # by which a desktop knows which icon belongs to its windows
        app.setWindowIcon(QIcon(str(Path(__file__).with_name("thbridge.svg"))))
    # Without this, Ctrl-C raises an exception in whatever slot runs just then, which Qt only prints.
    signal.signal(signal.SIGINT, lambda _number, _frame: app.quit())
    return app


class GarbageTimer(QObject):
    """Collects reference cycles between two events of Qt's thread, and at no other time.

    Python by itself collects in any thread and at any allocation. A forgotten window in a cycle would then be
    destroyed by another thread, or while Qt goes through its list of widgets, and the program would crash.

    Args:
        app: it lives as long as this.
    """

    def __init__(self, app: QApplication) -> None:
        super().__init__(app)
        gc.disable()
        self.startTimer(COLLECTING_PERIOD)

    def timerEvent(self, _event: QEvent) -> None:
        """Collect the oldest generation whose turn it is, by Python's own thresholds."""
        due = [
            generation
            for generation, (count, threshold) in enumerate(zip(gc.get_count(), gc.get_threshold(), strict=True))
            if count > threshold
        ]
        if due:
            gc.collect(due[-1])
