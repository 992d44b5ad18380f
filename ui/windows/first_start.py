"""The window of the first start: a bar, seconds and Cancel. It is there before the program is loaded."""

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
    "Once on each computer, thbridge compiles its simulator. This can take some minutes, and longer if other "
    "programs are busy. What is compiled is kept, even if you cancel."
)


class FirstStartWindow(QWidget):
    """Shows how many kernels are compiled, and for how many seconds; closing it cancels."""

    cancelled = Signal()
    received = Signal(int, int)
    """How many kernels are compiled, of how many."""
    ended = Signal()
    """The program needs the window no more."""

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
        """Show how many kernels are compiled."""
        self.bar.setRange(0, total)
        self.bar.setValue(done)
        self._known = f"Compiled {done} of {total}, "
        self._show_seconds()

    def leave(self) -> None:
        """Close without cancelling: the program goes on, or is gone."""
        self._leaving = True
        self.close()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Cancel, unless the program closes the window."""
        if not self._leaving:
            self.cancelled.emit()
        event.accept()
        QApplication.quit()

    def _show_seconds(self) -> None:
        minutes, seconds = divmod(int(time.monotonic() - self._began), 60)
        self.state.setText(f"{self._known}{f'{minutes} min ' if minutes else ''}{seconds} s")


def show() -> None:
    """Run the window as a program: lines `DONE TOTAL` on standard input; it prints `cancel` if people cancel."""
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
