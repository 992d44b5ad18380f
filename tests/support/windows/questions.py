"""Answers to the questions that windows ask."""

from collections.abc import Iterator
from contextlib import contextmanager

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication, QMessageBox


@contextmanager
def answering(words: str) -> Iterator[list[str]]:
    """Press the button with these words in each question of a window, until the end of the block; yield the questions
    asked."""
    asked: list[str] = []

    def look() -> None:
        for box in QApplication.topLevelWidgets():
            if isinstance(box, QMessageBox) and box.isVisible():
                asked.append(box.text())
                next(button for button in box.buttons() if words in button.text()).click()

    timer = QTimer(interval=20)
    timer.timeout.connect(look)
    timer.start()
    yield asked
    timer.stop()
