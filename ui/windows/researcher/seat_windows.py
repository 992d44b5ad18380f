"""Participants' windows that a researcher opens to play seats. Each is a program of its own, as for a participant."""

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QObject, QProcess

from ui.command_line.terminal import THBRIDGE

STOP_TIMEOUT = 3000
"""Milliseconds that a window has to close by itself before its program is killed."""


class SeatWindows(QObject):
    """Participants' windows of a researcher. `close` closes those that are still open.

    Args:
        report: function that shows a sentence to the researcher.
        parent: the researcher's window.

    Attributes:
        running: programs of the open windows, by seat.
    """

    def __init__(self, report: Callable[[str], None], parent: QObject) -> None:
        super().__init__(parent)
        self._report = report
        self.running: dict[str, QProcess] = {}

    def open(self, seat: str, command: tuple[str, ...]) -> str:
        """Open the window of a seat with a command of `thbridge`. Return a sentence about it."""
        if seat in self.running:
            return f"You have already opened the window of the seat {seat}."
        process = self.running[seat] = QProcess(self)
        process.setStandardInputFile(QProcess.nullDevice())
        process.finished.connect(partial(self._ended, seat))
        process.start(THBRIDGE[0], [*THBRIDGE[1:], *command])
        return f"Opening the window of the seat {seat}. The recording will name a researcher as its player."

    def close(self) -> None:
        """Close all windows."""
        for process in self.running.values():
            process.finished.disconnect()
            process.terminate()
        for process in self.running.values():
            if not process.waitForFinished(STOP_TIMEOUT):
                process.kill()
                process.waitForFinished(STOP_TIMEOUT)
        self.running.clear()

    def _ended(self, seat: str, code: int, _status: QProcess.ExitStatus) -> None:
        process = self.running.pop(seat)
        said = bytes(process.readAllStandardError().data()).decode(errors="replace").strip()
        process.deleteLater()
        reason = f": {said.splitlines()[-1]}" if said and code else "."
        self._report(f"The window of the seat {seat} is closed{reason}")
