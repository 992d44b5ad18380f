"""Window of the first start, with a progress bar, the elapsed time and a Cancel button.

It opens before the program is loaded.
"""

import sys
import time
from threading import Thread

from PySide6.QtCore import QSize, Qt, QTimer, Signal
from PySide6.QtGui import QCloseEvent, QKeySequence, QShortcut
from PySide6.QtWidgets import QApplication, QHBoxLayout, QProgressBar, QPushButton, QScrollArea, QVBoxLayout, QWidget

from ui.windows import look
from ui.windows.application import application
from ui.windows.look import GAP, spaced
from ui.windows.preferences import preferences_of

TITLE = "Starting thbridge"
EXPLANATION = (
    "On its first start on a computer, thbridge compiles its simulator. This can take some minutes, or longer if other "
    "programs are busy. If you cancel, the parts compiled so far are kept."
)


class FirstStartWindow(QWidget):
    """Window with the number of compiled kernels and the elapsed seconds. Closing the window cancels the start."""

    cancelled = Signal()
    received = Signal(int, int)
    """Signal with the number of compiled kernels and the total number of kernels."""
    ended = Signal()
    """Signal: the program that opened the window no longer needs it."""

    def __init__(self) -> None:
        super().__init__()
        self._began = time.monotonic()
        self._known = ""
        self._leaving = False
        self.setWindowTitle(TITLE)
        inside = QWidget()
        column = spaced(QVBoxLayout(inside), GAP, 2 * GAP, 2 * GAP, 2 * GAP, 2 * GAP)
        column.addWidget(look.label(TITLE, "title", bold=True))
        column.addWidget(look.label(EXPLANATION))
        self.bar = QProgressBar()
        self.bar.setRange(0, 0)
        self.bar.setTextVisible(False)
        self.bar.setAccessibleName("Progress")
        column.addWidget(self.bar)
        self.state = look.label(muted=True)
        column.addWidget(self.state)
        column.addStretch(1)
        row = spaced(QHBoxLayout(), GAP, 2 * GAP, GAP, 2 * GAP, 2 * GAP)
        row.addStretch(1)
        self.cancel = QPushButton("Cancel")
        self.cancel.clicked.connect(self.close)
        row.addWidget(self.cancel)
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setFrameShape(QScrollArea.Shape.NoFrame)
        area.setWidget(inside)
        outer = spaced(QVBoxLayout(self), 0, 0)
        outer.addWidget(area)
        outer.addLayout(row)
        QShortcut(QKeySequence(Qt.Key.Key_Escape), self, self.close)
        look.open_within_screen(self, QSize(480, 240))
        self.received.connect(self.show_progress)
        self.ended.connect(self.leave)
        ticking = QTimer(self)
        ticking.timeout.connect(self._show_seconds)
        ticking.start(250)
        self._show_seconds()

    def show_progress(self, done: int, total: int) -> None:
        """Show the number of compiled kernels."""
        self.bar.setRange(0, total)
        self.bar.setValue(done)
        self._known = f"Compiled {done} of {total}, "
        self._show_seconds()

    def leave(self) -> None:
        """Close the window without canceling, because the program continues or has ended."""
        self._leaving = True
        self.close()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Cancel if a person closes the window."""
        if not self._leaving:
            self.cancelled.emit()
        event.accept()
        QApplication.quit()

    def _show_seconds(self) -> None:
        minutes, seconds = divmod(int(time.monotonic() - self._began), 60)
        self.state.setText(f"{self._known}{f'{minutes} min ' if minutes else ''}{seconds} s")


def show() -> None:
    """Run the window as a program, which reads lines `DONE TOTAL` from standard input.

    If the user cancels, it prints `cancel`.
    """
    app = application()
    preferences_of(app, "participant", sys.argv[1])  # type: ignore[arg-type]  # one of the choices of --look
    window = FirstStartWindow()
    window.cancelled.connect(lambda: print("cancel", flush=True))  # noqa: T201 - to the program that opened it

    def listen() -> None:
        for line in sys.stdin:
            done, total = map(int, line.split())
            window.received.emit(done, total)
        window.ended.emit()

    Thread(target=listen, daemon=True).start()
    window.show()
    app.exec()
