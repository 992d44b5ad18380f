"""How long the researcher's window keeps people waiting while it opens, reads and plays a recording."""

import time
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QTimer
from pytestqt.qtbot import QtBot

from tests.bench.budget import Budgets
from tests.support.hunts.recorded_hunts import record_beginning
from ui.model.shared.theme import LIGHT
from ui.windows.researcher.feeds.recording import BagOpener, RecordingFeed
from ui.windows.researcher.window import ResearcherWindow

pytestmark = pytest.mark.bench


def clocks() -> tuple[float, float]:
    """Seconds by the clock, and of processor time."""
    return time.perf_counter(), time.process_time()


def test_gaps_of_the_event_loop(tmp_path: Path, budgets: Budgets, qtbot: QtBot) -> None:
    bag = record_beginning(tmp_path / "hunt.bag", robots=3, seconds=120.0)
    window = ResearcherWindow(RecordingFeed(BagOpener(bag)), "hunt.bag", LIGHT, time.monotonic)
    qtbot.addWidget(window)
    beats: list[float] = []
    timer = QTimer()
    timer.timeout.connect(lambda: beats.append(time.perf_counter()))
    timer.start(1)
    window.show()
    megabytes = bag.stat().st_size / 1e6

    def judge(what: str, began: tuple[float, float]) -> None:
        gaps = 1000.0 * np.diff(beats)
        spent, cpu = (now - before for now, before in zip(clocks(), began, strict=True))
        print(
            f"\n{what} {megabytes:.0f} MB: {spent:.1f} s, {cpu:.1f} s of processor time; "
            f"gaps of the event loop: 99 % below {np.percentile(gaps, 99):.0f} ms, longest {gaps.max():.0f} ms",
            end="",
        )
        beats.clear()
        assert np.percentile(gaps, 99) < 100.0
        budgets.time(f"researcher's window: {what} a recording", cpu)

    began = clocks()
    qtbot.waitUntil(lambda: window.playback.state.text() == "recording", timeout=120_000)
    judge("opening and reading", began)
    window.playback.speed_chosen.emit(10.0)
    window.playback.play_toggled.emit()
    began = clocks()
    qtbot.wait(3000)
    judge("playing 3 s at 10 x of", began)
    began = clocks()
    for share in range(20):
        window.playback.seek.emit(window.playback.timeline.maximum() / 1000.0 * share / 20.0)
        qtbot.wait(50)
    judge("seeking 20 times in", began)
    window.close()
