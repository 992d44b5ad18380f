"""The researcher's window on a running session, through its watch server."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QAccessible
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QCheckBox, QLineEdit, QMessageBox, QPushButton
from pytestqt.qtbot import QtBot

from sim.common.geometry import Pose2
from tests.support.hunts.recorded_hunts import watched_hunt
from thbridge.sockets.reconnecting import ConnectionLost, LossReason
from thbridge.watching.sockets.client import WatchClient, WatchConnected, WatchEvent
from thbridge.watching.wire import STATUS, SessionMessage, WatchStatus
from ui.model.shared.theme import LIGHT
from ui.model.watching.scene import RobotScene
from ui.windows.researcher.feeds.session import SessionFeed, WatchConnection
from ui.windows.researcher.map.tools import MapTool
from ui.windows.researcher.window import ResearcherWindow


def window_on(port: int) -> ResearcherWindow:
    address = f"127.0.0.1:{port}"
    return ResearcherWindow(
        SessionFeed(WatchConnection(WatchClient("127.0.0.1", port)), address), address, LIGHT, time.monotonic
    )


@pytest.fixture(scope="module")
def port(tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    """One session for all tests: to begin one takes its time."""
    with watched_hunt(tmp_path_factory.mktemp("watched") / "hunt.bag") as port:
        yield port


@pytest.fixture(scope="module")
def opened(port: int, qapp: QApplication) -> Iterator[ResearcherWindow]:
    made = window_on(port)
    made.show()
    yield made
    made.close()
    made.deleteLater()


@pytest.fixture
def window(opened: ResearcherWindow, qtbot: QtBot) -> ResearcherWindow:
    qtbot.waitUntil(lambda: opened.scene is not None and len(opened.scene.robots) == 2)
    opened.activateWindow()
    opened.canvas.setFocus()
    opened.select_tool(MapTool.LOOK)
    opened.select(0)
    return opened


def robot(window: ResearcherWindow, number: int) -> RobotScene:
    assert window.scene is not None
    return window.scene.robots[number]


def truth(window: ResearcherWindow, number: int) -> Pose2:
    pose = robot(window, number).truth
    assert pose is not None
    return pose


def stroke(window: ResearcherWindow, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Press, drag and let go, in map meters."""
    pixels = [window.canvas.pixel(*point).toPoint() for point in (start, end)]
    QTest.mousePress(window.canvas.viewport(), Qt.MouseButton.LeftButton, pos=pixels[0])
    QTest.mouseMove(window.canvas.viewport(), pixels[1])
    QTest.mouseRelease(window.canvas.viewport(), Qt.MouseButton.LeftButton, pos=pixels[1])


def asked(window: ResearcherWindow) -> list[str]:
    rows = (window.logs["input"].model.row(number) for number in range(window.logs["input"].model.rowCount()))
    return [row.cells[2] for row in rows if row.cells[0] == "watch"]


def waits(qtbot: QtBot, until: Callable[[], bool]) -> None:
    qtbot.waitUntil(until)


def test_it_shows_the_session_live(window: ResearcherWindow, qtbot: QtBot) -> None:
    waits(qtbot, lambda: window.playback.state.text().startswith("live"))
    waits(qtbot, lambda: window.plots.points("speed", 1) > 3 and window.team.model.rowCount() == 2)
    assert window.sign.text() == ""
    assert "Pause" in window.playback.play.text()


def test_a_goal_by_mouse_is_an_input_of_the_session(window: ResearcherWindow, qtbot: QtBot) -> None:
    QTest.keyClick(window.canvas, "g")
    assert window.tool is MapTool.GOAL
    stroke(window, (3.0, -4.0), (3.0, -3.0))
    assert window.tool is MapTool.LOOK
    waits(qtbot, lambda: any(line.startswith("SimpleGoal") for line in asked(window)))
    waits(qtbot, lambda: (goal := robot(window, 0).goal) is not None and goal.distance(Pose2(3.0, -4.0, 0.0)) < 0.1)


def test_a_pose_by_mouse_is_an_input_of_the_session(window: ResearcherWindow, qtbot: QtBot) -> None:
    window.select(1)
    here = truth(window, 1)
    QTest.keyClick(window.canvas, "p")
    stroke(window, (here.x, here.y), (here.x + 1.0, here.y))
    waits(qtbot, lambda: any(line.startswith("InitialPose") for line in asked(window)))


def test_a_robot_is_kidnapped_by_dragging_it(window: ResearcherWindow, qtbot: QtBot) -> None:
    QTest.keyClick(window.canvas, "k")
    here = truth(window, 1)
    stroke(window, (here.x, here.y), (3.5, 0.0))
    waits(qtbot, lambda: truth(window, 1).distance(Pose2(3.5, 0.0, 0.0)) < 1.0)


def test_who_drags_nobody_is_told_so(window: ResearcherWindow) -> None:
    QTest.keyClick(window.canvas, "k")
    before = len(asked(window))
    stroke(window, (-4.9, 6.9), (3.0, 0.0))
    assert "No robot is there" in window.statusBar().currentMessage()
    assert len(asked(window)) == before


def test_an_obstacle_is_put_and_taken_away(window: ResearcherWindow, qtbot: QtBot) -> None:
    QTest.keyClick(window.canvas, "o")
    stroke(window, (-3.0, 1.5), (-2.7, 1.5))
    waits(qtbot, lambda: window.scene is not None and len(window.scene.things) == 1)
    stroke(window, (-3.0, 1.5), (-3.0, 1.5))
    waits(qtbot, lambda: window.scene is not None and not window.scene.things)


def test_a_robot_is_killed_only_when_that_is_meant_and_revived(window: ResearcherWindow, qtbot: QtBot) -> None:
    window.select(1)

    def answer(label: str) -> None:
        QTest.keyClick(window.canvas, Qt.Key.Key_Delete)
        box = next(box for box in window.findChildren(QMessageBox) if box.isVisible())
        button = next(button for button in box.findChildren(QPushButton) if button.text() == label)
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)
        window.activateWindow()
        waits(qtbot, window.isActiveWindow)

    answer("Leave it alive")
    assert not any(line.startswith("Die") for line in asked(window))
    answer("Kill it")
    waits(qtbot, lambda: any(line.startswith("Die") for line in asked(window)))
    waits(qtbot, lambda: robot(window, 1).dead)
    QTest.keyClick(window.canvas, "g")
    stroke(window, (3.0, -4.0), (3.0, -3.0))
    assert "Revive the robot first (R)" in window.statusBar().currentMessage()
    QTest.keyClick(window.canvas, "r")
    waits(qtbot, lambda: not robot(window, 1).dead)


def test_who_comes_late_to_a_paused_session_sees_what_those_see_who_were_there(
    window: ResearcherWindow, port: int, qtbot: QtBot
) -> None:
    def known(window: ResearcherWindow) -> list[object]:
        models = [window.logs[kind].model for kind in ("line", "event", "said", "input")]
        rows = [[model.row(number) for number in range(model.rowCount())] for model in models]
        robots = () if window.scene is None else window.scene.robots
        rooms = () if window.scene is None else window.scene.rooms
        return [
            *rows,
            [(room.room, room.state, room.found, room.robot) for room in rooms],
            [(robot.state, robot.energy, robot.goal, robot.dead, len(robot.scan)) for robot in robots],
        ]

    waits(qtbot, lambda: window.scene is not None and {room.state for room in window.scene.rooms} > {"unvisited"})
    window.playback.play_toggled.emit()
    waits(qtbot, lambda: "paused" in window.playback.state.text())
    late = window_on(port)
    late.show()
    try:
        waits(qtbot, lambda: known(late)[0] != [] and known(late) == known(window))
    finally:
        late.close()
        late.deleteLater()
        window.playback.play_toggled.emit()


def test_costmaps_are_cleared_by_a_key(window: ResearcherWindow, qtbot: QtBot) -> None:
    QTest.keyClick(window.canvas, "c")
    waits(qtbot, lambda: any(line.startswith("ClearCostmaps") for line in asked(window)))


def test_the_session_pauses_steps_and_goes_on(window: ResearcherWindow, qtbot: QtBot) -> None:
    QTest.keyClick(window.canvas, Qt.Key.Key_Space)
    waits(qtbot, lambda: window.playback.state.text() == "live, paused")
    stands = window.scene.stamp_ns if window.scene else 0
    QTest.keyClick(window.canvas, ".")
    waits(qtbot, lambda: window.scene is not None and window.scene.stamp_ns > stands)
    assert window.scene is not None
    assert window.scene.stamp_ns - stands < 100_000_000
    QTest.keyClick(window.canvas, Qt.Key.Key_Space)
    waits(qtbot, lambda: window.playback.state.text() != "live, paused")


def test_its_speed_is_asked_for(window: ResearcherWindow, qtbot: QtBot) -> None:
    QTest.keyClick(window.canvas, "]")
    waits(qtbot, lambda: window.playback.speed.currentText() == "2 x")
    QTest.keyClick(window.canvas, "[")
    waits(qtbot, lambda: window.playback.speed.currentText() == "1 x")


@pytest.mark.slow
def test_the_wizard_speaks_in_a_robots_place(tmp_path: Path, qtbot: QtBot) -> None:
    with watched_hunt(tmp_path / "hunt.bag", "--rate", "2") as port:
        window = window_on(port)
        qtbot.addWidget(window)
        window.show()
        waits(qtbot, lambda: window.scene is not None and len(window.scene.robots) == 2)
        wizard = window.wizard
        waits(qtbot, lambda: len(wizard.findChildren(QCheckBox)) == 2)
        for box in wizard.findChildren(QCheckBox):
            box.click()
        waits(qtbot, lambda: bool(window.scene and (window.scene.wizard.advice or window.scene.wizard.turns)))
        # The simulated participant asks for advice, which waits for the wizard, too.
        while not (window.scene and window.scene.wizard.turns):
            waits(qtbot, lambda: bool(window.scene and (window.scene.wizard.advice or window.scene.wizard.turns)))
            room = next((each for each in wizard.findChildren(QPushButton) if each.text().startswith("Room")), None)
            if room is not None:
                room.click()
            qtbot.wait(200)
        turn = window.scene.wizard.turns[0]

        def reply() -> QPushButton | None:
            sentences = {" ".join(button.text().split()): button for button in wizard.findChildren(QPushButton)}
            return sentences.get(turn.sentences[0])

        waits(qtbot, lambda: reply() is not None)
        next(edit for edit in wizard.findChildren(QLineEdit) if edit.isEnabled()).setText("By the way, hello.")
        button = reply()
        assert button is not None
        button.click()
        rows = window.logs["said"].model
        waits(qtbot, lambda: any("By the way, hello." in rows.row(n).cells for n in range(rows.rowCount())))
        said = next(row for n in range(rows.rowCount()) if "By the way, hello." in (row := rows.row(n)).cells)
        assert "wizard" in said.cells[0]
        window.close()
        window.deleteLater()


def test_where_nobody_answers_it_says_so_and_waits(qtbot: QtBot) -> None:
    window = window_on(1)
    qtbot.addWidget(window)
    window.show()
    waits(qtbot, lambda: "No answer from 127.0.0.1:1" in window.sign.text())
    sign = QAccessible.queryAccessibleInterface(window.sign)
    assert sign.parent().indexOfChild(sign) >= 0, "a screen reader finds it"
    window.close()
    window.deleteLater()


class Ended(WatchClient):
    """A client of a session that has ended, with this bag."""

    def __init__(self, bag: Path) -> None:
        super().__init__("127.0.0.1", 1)
        status = WatchStatus(paused=False, rate=1.0, lag=0.0, watchers=1, dropped=0, bag=str(bag), ended=True)
        last = SessionMessage(STATUS, "std_msgs/String", 0, status.data())
        self._events: list[WatchEvent] = [WatchConnected(), last, ConnectionLost(LossReason.BROKEN)]

    def take(self) -> list[WatchEvent]:
        events, self._events = self._events, []
        return events


def test_the_end_of_a_session_is_no_trouble_and_offers_its_recording(tmp_path: Path, qtbot: QtBot) -> None:
    bag = tmp_path / "hunt.bag"
    for is_here in (False, True):
        if is_here:
            bag.write_bytes(b"")
        window = ResearcherWindow(SessionFeed(WatchConnection(Ended(bag)), "here"), "here", LIGHT, time.monotonic)
        qtbot.addWidget(window)
        window.show()
        window.refresh()
        assert window.playback.state.text() == "session ended"
        assert window.sign.text() == "" and not window.sign.isVisible()
        assert str(bag) in window.statusBar().currentMessage()
        assert window.playback.recording.isVisible() is is_here
        if is_here:
            with qtbot.waitSignal(window.source_chosen) as wanted:
                QTest.mouseClick(window.playback.recording, Qt.MouseButton.LeftButton)
            assert wanted.args == [str(bag)]
        window.close()


@pytest.mark.slow
def test_a_session_that_ends_is_told_and_the_next_one_is_shown(tmp_path: Path, qtbot: QtBot) -> None:
    with watched_hunt(tmp_path / "one.bag") as port:
        window = window_on(port)
        qtbot.addWidget(window)
        window.show()
        waits(qtbot, lambda: window.scene is not None and bool(window.scene.robots))
    waits(qtbot, lambda: window.playback.state.text() == "session ended")
    assert window.playback.recording.isVisible() and window.sign.text() == ""
    assert window.scene is not None
    with watched_hunt(tmp_path / "two.bag", "--watch", str(port)):
        waits(qtbot, lambda: window.playback.state.text().startswith("live"))
        waits(qtbot, lambda: not window.playback.recording.isVisible())
    window.close()
    window.deleteLater()
