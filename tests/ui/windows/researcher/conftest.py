"""The researcher's window on a recorded hunt."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtWidgets import QApplication

from tests.support.hunts.recorded_hunts import record_beginning
from ui.model.shared.theme import LIGHT
from ui.windows.researcher.feeds.recording import BagOpener, RecordingFeed
from ui.windows.researcher.window import ResearcherWindow


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record_beginning(tmp_path_factory.mktemp("watched") / "hunt.bag")


@pytest.fixture(scope="module")
def opened(bag: Path, qapp: QApplication) -> Iterator[ResearcherWindow]:
    """One window for all tests: reading a bag takes its time."""
    made = ResearcherWindow(RecordingFeed(BagOpener(bag)), "hunt.bag", LIGHT, time.monotonic)
    made.show()
    while made.playback.state.text() != "recording" or not made.logs["line"].model.size:
        qapp.processEvents()
    yield made
    made.close()
    made.deleteLater()


@pytest.fixture
def window(opened: ResearcherWindow) -> ResearcherWindow:
    opened.activateWindow()
    opened.canvas.setFocus()
    opened.select(0)
    return opened
