"""Fixtures of all tests of windows."""

import gc
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager

import pytest
from PySide6.QtCore import QEvent, SignalInstance
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot
from pytestqt.wait_signal import SignalBlocker

from ui.windows.application import GarbageTimer

PATIENCE = 60_000
"""Milliseconds; pytest-qt itself waits for 5000, which a busy machine may need for a window."""


class PatientBot(QtBot):
    """Waits for what comes for as long as a busy machine may need."""

    def waitUntil(self, callback: Callable[[], bool | None], *, timeout: int = PATIENCE) -> None:
        super().waitUntil(callback, timeout=timeout)

    def waitSignal(
        self, signal: SignalInstance, *, timeout: int = PATIENCE, raising: bool | None = None
    ) -> SignalBlocker:
        return super().waitSignal(signal, timeout=timeout, raising=raising)

    def waitActive(self, widget: QWidget, *, timeout: int = PATIENCE) -> AbstractContextManager[object]:
        return super().waitActive(widget, timeout=timeout)

    def waitExposed(self, widget: QWidget, *, timeout: int = PATIENCE) -> AbstractContextManager[object]:
        return super().waitExposed(widget, timeout=timeout)


@pytest.fixture
def qtbot(qapp: QApplication, request: pytest.FixtureRequest) -> PatientBot:
    return PatientBot(request)


@pytest.fixture(autouse=True)
def garbage_timer(qapp: QApplication) -> Iterator[None]:
    """Garbage goes between events, as in the programs; no window of one test is left to the next."""
    # What is there by now stays: programs that were run in this process have freed it for looking through again, which
    # takes more than a second after each test.
    gc.freeze()
    timer = GarbageTimer(qapp)
    yield
    timer.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    gc.collect()
    gc.enable()
