"""What the windows cost while a hunt goes on, and how long they keep people waiting; offscreen, and on an X server.

The whole participant's window, on its real model, is shown a hunt of so many robots that was taken down before: where
they are 25 times a second, ways, ellipses, the truth, talks, treasures, pictures.
"""

import os
import subprocess
import sys
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from random import Random

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QEventLoop, QObject, QPoint, Qt, QTimer
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from tests.bench.budget import Budgets
from tests.bench.windows.filmed_hunt import Film, Shown, shoot
from tests.support.hunts.recorded_hunts import watched_hunt
from tests.support.windows.desktop import desktop, needs_desktop
from thbridge.watching.sockets.client import WatchClient
from ui.model.playing.screen import Screen
from ui.model.shared.theme import LIGHT
from ui.windows import look
from ui.windows.participant import ParticipantWindow
from ui.windows.participant.cards import Card
from ui.windows.researcher.feeds.session import SessionFeed, WatchConnection
from ui.windows.researcher.window import ResearcherWindow

pytestmark = pytest.mark.bench

SIZES = ((1200, 800), (1920, 1080))
COUNTS = (1, 4, 10, 20)
SECONDS = 30.0
FRAMES = 300
RATE = 60.0
PLAYED = 6.0
"""Seconds for which a window is watched at its own pace."""
PRESSES = 100
NOTICED = 100.0
"""Milliseconds after which people notice that a window has kept them waiting."""

film: Callable[[int], Film] = cache(lambda robots: shoot(robots, SECONDS))


class Clock:
    """Seconds since the film began: those of the machine, or set by hand."""

    def __init__(self) -> None:
        self._begin = time.monotonic()
        self.fixed: float | None = None

    def __call__(self) -> float:
        return time.monotonic() - self._begin if self.fixed is None else self.fixed


def opened(qtbot: QtBot, robots: int, size: tuple[int, int], clock: Clock) -> ParticipantWindow:
    look.apply_palette(QApplication.instance(), LIGHT)
    window = ParticipantWindow(Shown(film(robots), 0.0), clock, LIGHT)
    qtbot.addWidget(window)
    window.setWindowFlag(Qt.WindowType.FramelessWindowHint)
    window.resize(*size)
    with qtbot.waitExposed(window):
        window.show()
    window.activateWindow()
    return window


def tell(text: str) -> None:
    print(f"\n{os.environ['QT_QPA_PLATFORM']}: {text}", end="")


def judge(budgets: Budgets, what: str, seconds: float) -> None:
    budgets.time(f"windows, {os.environ['QT_QPA_PLATFORM']}: {what}", seconds)


def spread(milliseconds: list[float]) -> str:
    early, median, late = np.percentile(milliseconds, [5, 50, 95])
    return f"{early:.1f} undisturbed, median {median:.1f}, 95 % below {late:.1f}, longest {max(milliseconds):.1f} ms"


class Paints(QObject):
    """Takes down when a widget is painted."""

    def __init__(self, widget: QWidget) -> None:
        super().__init__(widget)
        self.times: list[float] = []
        widget.installEventFilter(self)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.Type.Paint:
            self.times.append(time.perf_counter())
        return False


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("robots", COUNTS)
def test_frames_flat_out(qtbot: QtBot, budgets: Budgets, robots: int, size: tuple[int, int]) -> None:
    clock = Clock()
    clock.fixed = 0.0
    window = opened(qtbot, robots, size, clock)
    for _ in range(30):  # until the house is there
        clock.fixed += 0.1
        window.refresh()
        QApplication.sendPostedEvents()
    walls: list[float] = []
    used = []
    paints = Paints(window.map.viewport())
    for _ in range(FRAMES):
        clock.fixed += 1.0 / RATE
        began, begun = time.perf_counter(), time.process_time()
        window.refresh()
        QApplication.sendPostedEvents()
        walls.append(1e3 * (time.perf_counter() - began))
        used.append(time.process_time() - begun)
    spent = 1e3 * float(np.mean(used))
    tell(
        f"{size[0]} x {size[1]}, {robots} robots, flat out: {1e3 / np.median(walls):.0f} frames/s; a frame takes "
        f"{spread(walls)}; {spent:.1f} ms of processor time: {spent * RATE / 10:.0f} % of a core at 60 frames/s "
        f"({len(paints.times)} of {FRAMES} painted)"
    )
    assert np.median(walls) < 1e3 / RATE
    judge(budgets, f"a frame of {robots} robots, {size[0]} x {size[1]}", 1e-3 * spent)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("robots", COUNTS)
def test_frames_at_its_own_pace(qtbot: QtBot, budgets: Budgets, robots: int, size: tuple[int, int]) -> None:
    window = opened(qtbot, robots, size, Clock())
    qtbot.wait(3000)
    paints = Paints(window.map.viewport())
    began, begun = time.perf_counter(), time.process_time()
    qtbot.wait(int(1e3 * PLAYED))
    share = (time.process_time() - begun) / (time.perf_counter() - began)
    gaps = [1e3 * gap for gap in np.diff(paints.times)]
    kept = np.mean(np.array(gaps) < 1.5 * 1e3 / RATE)
    tell(
        f"{size[0]} x {size[1]}, {robots} robots, at its own pace: {len(gaps) / PLAYED:.0f} frames/s, "
        f"{100 * kept:.0f} % within one and a half sixtieths, {spread(gaps)} apart; {100 * share:.0f} % of a core"
    )
    assert np.median(gaps) < 1.5 * 1e3 / RATE
    what = f"a frame of {robots} robots at its own pace, {size[0]} x {size[1]}"
    judge(budgets, what, share * PLAYED / len(paints.times))


def test_nothing_holds_the_window_up(qtbot: QtBot) -> None:
    """The longest time in which the event loop did not turn, in a hunt with arrivals, talks and pictures."""
    opened(qtbot, 10, SIZES[0], Clock())
    beats: list[tuple[float, float]] = []
    timer = QTimer()
    timer.setTimerType(Qt.TimerType.PreciseTimer)
    timer.timeout.connect(lambda: beats.append((time.perf_counter(), time.thread_time())))
    timer.start(5)
    qtbot.wait(int(1e3 * SECONDS))
    wall, own = 1e3 * np.diff(np.array(beats), axis=0).T
    tell(
        f"10 robots, a timer of 5 ms in {SECONDS:.0f} s of a hunt: longest gaps {np.sort(wall)[-5:].round(1)} ms, "
        f"of which the window itself worked at most {own.max():.1f} ms"
    )
    assert own.max() < NOTICED


class Presses(QObject):
    """Presses by xdotool at moments that the window does not know, and how long until what changed was painted."""

    def __init__(self, window: ParticipantWindow, state: Callable[[Screen], object]) -> None:
        super().__init__(window)
        self._window = window
        self._state = state
        self._tool = subprocess.Popen(["xdotool", "-"], stdin=subprocess.PIPE, text=True, bufsize=1)
        self._pressed: float | None = None
        self._before: object = None
        self._painted = False
        self._used = 0.0
        self.took: list[float] = []
        self.worked: list[float] = []
        window.installEventFilter(self)

    def press(self, command: str) -> None:
        assert self._tool.stdin is not None
        self._before = self._state(self._screen)
        self._painted = False
        self._used = time.process_time()
        self._pressed = time.perf_counter()
        self._tool.stdin.write(command + "\n")
        self._tool.stdin.flush()

    @property
    def answered(self) -> bool:
        return self._pressed is None

    @property
    def _screen(self) -> Screen:
        screen = self._window._screen  # what was drawn last
        assert screen is not None
        return screen

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        changed = self._pressed is not None and self._state(self._screen) != self._before
        if event.type() == QEvent.Type.UpdateRequest and changed and not self._painted:
            self._painted = True
            QTimer.singleShot(0, self._done)  # once it is painted and handed to the screen
        return False

    def _done(self) -> None:
        if self._pressed is not None:
            self.took.append(1e3 * (time.perf_counter() - self._pressed))
            self.worked.append(1e3 * (time.process_time() - self._used))
            self._pressed = None

    def give_up(self) -> None:
        self._pressed = None

    def close(self) -> None:
        self._tool.terminate()
        self._tool.wait()


@pytest.mark.skipif(os.environ.get("QT_QPA_PLATFORM") != "xcb", reason="xdotool presses on an X server")
@pytest.mark.parametrize("what", ["card clicked", "room pointed at", "Tab pressed"])
def test_from_a_press_to_the_screen(qtbot: QtBot, budgets: Budgets, what: str) -> None:
    chance = Random(1)
    window = opened(qtbot, 10, SIZES[0], Clock())
    qtbot.wait(3000)

    def selected(screen: Screen) -> object:
        return next((card.robot for card in screen.cards if card.selected), None)

    def considered(screen: Screen) -> object:
        return next((tile.room for tile in screen.tiles if tile.considered), None)

    def card(number: int) -> str:
        shown = [one for one in window.column.cards.findChildren(Card) if not one.visibleRegion().isEmpty()]
        return f"{at(shown[number % 2].mapToGlobal(shown[0].rect().center() / 2))} click 1"

    def room(number: int) -> str:
        places = [window.map.pixel(*mark.region.mean(axis=0)).toPoint() for mark in window._model.rooms(0.0)]
        free = [
            window.map.mapToGlobal(place) for place in places if window.map_area.childAt(place) is window.map.viewport()
        ]
        return at(free[number % len(free)])

    command, state = {
        "card clicked": (card, selected),
        "room pointed at": (room, considered),
        "Tab pressed": (lambda _: "key Tab", selected),
    }[what]
    presses = Presses(window, state)
    for number in range(PRESSES):
        qtbot.wait(chance.randint(40, 90))
        presses.press(command(number))
        pause = time.perf_counter() + 1.0
        while not presses.answered and time.perf_counter() < pause:
            QApplication.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents, 5)
        presses.give_up()
    presses.close()
    tell(
        f"{what} with 10 robots moving, to the screen: {spread(presses.took)}, in which the window works "
        f"{spread(presses.worked)}; {len(presses.took)} of {PRESSES} changed something"
    )
    assert len(presses.took) > 0.9 * PRESSES
    assert np.median(presses.took) < NOTICED
    judge(budgets, f"work until the screen shows: {what}", 1e-3 * float(np.median(presses.worked)))


def at(place: QPoint) -> str:
    return f"mousemove {place.x()} {place.y()}"


def test_a_researcher_watches_ten_robots(qtbot: QtBot, budgets: Budgets, tmp_path: Path) -> None:
    """A session under way in another process, with clouds, scans, plans and plots."""
    with watched_hunt(tmp_path / "hunt.bag", "--robots", "10", "--map", "warehouse12") as port:
        session = SessionFeed(WatchConnection(WatchClient("127.0.0.1", port)), "the session")
        window = ResearcherWindow(session, "the session", LIGHT, time.monotonic)
        qtbot.addWidget(window)
        window.show()
        qtbot.waitUntil(lambda: window.scene is not None and len(window.scene.robots) == 10, timeout=120_000)
        qtbot.wait(3000)
        paints = Paints(window.canvas.viewport())
        beats: list[float] = []
        timer = QTimer()
        timer.timeout.connect(lambda: beats.append(time.thread_time()))
        timer.start(5)
        began, begun = time.perf_counter(), time.process_time()
        qtbot.wait(int(1e3 * PLAYED))
        share = (time.process_time() - begun) / (time.perf_counter() - began)
        window.close()
    gaps = [1e3 * gap for gap in np.diff(paints.times)]
    tell(
        f"researcher's window, 10 robots: {len(gaps) / PLAYED:.0f} frames/s, {spread(gaps)} apart; "
        f"{100 * share:.0f} % of a core; it works at most {1e3 * np.diff(beats).max():.0f} ms at once"
    )
    assert np.median(gaps) < NOTICED
    assert 1e3 * np.diff(beats).max() < 2 * NOTICED
    judge(budgets, "a frame of the researcher's, 10 robots", share * PLAYED / len(paints.times))


@needs_desktop
def test_the_same_on_an_x_server(pytestconfig: pytest.Config) -> None:
    """All of the above once more, in a process of its own."""
    if os.environ.get("QT_QPA_PLATFORM") == "xcb":
        pytest.skip("this is that process")
    command = [sys.executable, "-m", "pytest", "-m", "bench", "-s", "-q", "-p", "no:randomly", __file__]
    if pytestconfig.getoption("--write-budgets"):
        command.append("--write-budgets")
    with desktop(1920, 1080) as there:
        done = subprocess.run(
            command, env={**there.environment, "QT_QPA_PLATFORM": "xcb"}, capture_output=True, text=True, check=False
        )
    print("\n".join(line for line in done.stdout.splitlines() if "xcb:" in line))
    assert done.returncode == 0, done.stdout
