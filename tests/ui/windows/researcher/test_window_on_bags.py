"""The researcher's window on recordings."""

import time
from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QCheckBox, QComboBox, QDialog, QDockWidget, QLineEdit, QToolButton, QWidget
from pytestqt.qtbot import QtBot

from tests.support.hunts.recorded_hunts import record_beginning
from tests.support.windows.screen_reader import against_the_eye, nameless, stops
from tests.ui.windows.researcher.recording_times import go_to, place_of
from ui.model.shared.theme import DARK, LIGHT
from ui.windows.researcher.docks.displays import SWITCHES, MapDisplay
from ui.windows.researcher.docks.plots import PANELS
from ui.windows.researcher.feeds.recording import BagOpener, RecordingFeed
from ui.windows.researcher.map.tools import MapTool
from ui.windows.researcher.window import ResearcherWindow


def picture(window: ResearcherWindow) -> QImage:
    window.refresh()
    return window.canvas.grab().toImage()


def test_lists_robots_and_plots_are_filled(window: ResearcherWindow, qtbot: QtBot) -> None:
    assert window.team.model.rowCount() == 3
    assert (
        min(
            log.model.size
            for log in (window.logs["line"], window.logs["said"], window.logs["event"], window.logs["input"])
        )
        > 0
    )
    qtbot.waitUntil(lambda: all(window.plots.points(panel.name, robot) > 2 for panel in PANELS for robot in range(3)))
    assert window.playback.timeline.maximum() == pytest.approx(15_000, abs=1000)


def test_the_deviation_of_a_robot_that_stands_is_a_line(tmp_path: Path, qtbot: QtBot) -> None:
    feed = RecordingFeed(BagOpener(record_beginning(tmp_path / "short.bag", robots=2, seconds=0.5)))
    window = ResearcherWindow(feed, "short.bag", LIGHT, time.monotonic)
    qtbot.addWidget(window)
    window.show()
    qtbot.waitUntil(lambda: window.plots.points("error", 1) > 2)
    qtbot.waitUntil(lambda: [window.plots.points("sigma", robot) for robot in (0, 1)] == [2, 2])
    assert [len(feed.data.series.of(robot).deviations) for robot in (0, 1)] == [1, 1]
    window.close()
    window.deleteLater()


def test_seeking_moves_the_robots_and_the_time(window: ResearcherWindow) -> None:
    go_to(window, 3.0)
    early = picture(window)
    go_to(window, 9.0)
    assert picture(window) != early
    assert window.playback.time.text().startswith("0:09.00")
    go_to(window, 3.0)
    assert picture(window) == early


def test_steps_are_ticks(window: ResearcherWindow) -> None:
    go_to(window, 5.0)
    QTest.keyClick(window.canvas, ".")
    window.refresh()
    assert window.playback.time.text().startswith("0:05.02")
    for _ in range(2):
        QTest.keyClick(window.canvas, ",")
    window.refresh()
    assert window.playback.time.text().startswith("0:04.98")


def test_space_plays_and_pauses(window: ResearcherWindow, qtbot: QtBot) -> None:
    go_to(window, 2.0)
    QTest.keyClick(window.canvas, Qt.Key.Key_Space)
    qtbot.waitUntil(lambda: window.playback.timeline.value() > 2200)
    assert "Pause" in window.playback.play.text()
    QTest.keyClick(window.canvas, Qt.Key.Key_Space)
    window.refresh()
    stands = window.playback.timeline.value()
    window.refresh()
    assert window.playback.timeline.value() == stands
    assert "Play" in window.playback.play.text()


def test_space_pauses_wherever_the_focus_is_and_presses_nothing(window: ResearcherWindow, qtbot: QtBot) -> None:
    boxes = window.findChildren(QCheckBox)
    ticked = [box.isChecked() for box in boxes]
    for stop in stops(window):
        if isinstance(stop, QLineEdit):
            continue
        stop.setFocus()
        for _ in ("plays", "pauses"):
            with qtbot.waitSignal(window.playback.play_toggled):
                QTest.keyClick(stop, Qt.Key.Key_Space)
    assert {QCheckBox, QComboBox, QToolButton} <= {cls for stop in stops(window) for cls in type(stop).__mro__}
    assert [box.isChecked() for box in boxes] == ticked


def test_space_in_a_field_of_text_is_a_space(window: ResearcherWindow, qtbot: QtBot) -> None:
    QTest.keyClick(window.canvas, Qt.Key.Key_F, Qt.KeyboardModifier.ControlModifier)
    field = window.focusWidget()
    assert isinstance(field, QLineEdit)
    with qtbot.assertNotEmitted(window.playback.play_toggled):
        QTest.keyClicks(field, "a b")
    assert field.text() == "a b"
    field.clear()


def test_enter_ticks_the_box_and_opens_the_choices_with_the_focus(window: ResearcherWindow) -> None:
    box = next(box for box in window.displays.findChildren(QCheckBox) if box.isEnabled())
    ticked = box.isChecked()
    box.setFocus()
    QTest.keyClick(box, Qt.Key.Key_Return)
    assert box.isChecked() is not ticked
    QTest.keyClick(box, Qt.Key.Key_Enter)
    assert box.isChecked() is ticked
    choices = window.playback.speed
    choices.setFocus()
    QTest.keyClick(choices, Qt.Key.Key_Return)
    assert choices.view().isVisible()
    choices.hidePopup()


@pytest.mark.parametrize(
    "display",
    [display for display in MapDisplay if display not in {MapDisplay.THINGS, MapDisplay.ELLIPSES, MapDisplay.TRUTH}],
)
def test_what_is_switched_on_is_seen(window: ResearcherWindow, display: MapDisplay) -> None:
    go_to(window, 8.0)
    before = picture(window)
    if SWITCHES[display].key:
        QTest.keyClick(window.canvas, SWITCHES[display].key)
    else:
        window.displays.toggle(display)
    assert picture(window) != before


def test_robots_are_selected_by_tab_click_and_list(window: ResearcherWindow) -> None:
    go_to(window, 8.0)
    window.canvas.setFocus()
    QTest.keyClick(window.canvas, Qt.Key.Key_Tab)
    assert window.team.table.currentIndex().row() == 1
    QTest.keyClick(window.canvas, Qt.Key.Key_Backtab)
    assert window.team.table.currentIndex().row() == 0
    window.team.table.setFocus()
    QTest.keyClick(window.team.table, Qt.Key.Key_Down)
    QTest.keyClick(window.team.table, Qt.Key.Key_Down)
    one = picture(window)
    window.select(1)
    assert picture(window) != one


def test_a_row_takes_us_to_its_moment(window: ResearcherWindow) -> None:
    window.logs["event"].table.setFocus()
    last = window.logs["event"].model.rowCount() - 1
    window.logs["event"].table.setCurrentIndex(window.logs["event"].model.index(last, 0))
    QTest.keyClick(window.logs["event"].table, Qt.Key.Key_Return)
    window.refresh()
    assert window.playback.timeline.value() == pytest.approx(
        1000.0 * window.logs["event"].model.row(last).time, abs=1.0
    )


def test_page_keys_go_from_mark_to_mark(window: ResearcherWindow) -> None:
    go_to(window, 0.0)
    QTest.keyClick(window.canvas, Qt.Key.Key_PageDown)
    window.refresh()
    first = window.playback.timeline.value()
    QTest.keyClick(window.canvas, Qt.Key.Key_PageDown)
    window.refresh()
    assert 0 < first < window.playback.timeline.value()
    QTest.keyClick(window.canvas, Qt.Key.Key_Home)
    window.refresh()
    assert window.playback.timeline.value() == 0


def test_bookmarks_are_set_gone_to_and_looped_between(window: ResearcherWindow, qtbot: QtBot) -> None:
    QTest.keyClick(window.canvas, "l")
    assert "needs two bookmarks" in window.statusBar().currentMessage() and not window.loop.isChecked()
    for seconds in (7.0, 7.4):
        go_to(window, seconds)
        QTest.keyClick(window.canvas, "b")
    assert window.bookmarks.times == (7.0, 7.4)
    go_to(window, 7.2)
    QTest.keyClick(window.canvas, Qt.Key.Key_PageUp)
    window.refresh()
    assert window.playback.timeline.value() == 7000
    window.playback.speed_chosen.emit(5.0)
    QTest.keyClick(window.canvas, "l")
    seen = set()
    qtbot.waitUntil(lambda: seen.add(window.playback.timeline.value()) or len(seen) > 12)
    assert window.playback.timeline.value() != window.playback.timeline.maximum()
    assert min(seen) >= 7000 and max(seen) <= 7400
    QTest.keyClick(window.canvas, "l")
    QTest.keyClick(window.canvas, Qt.Key.Key_Space)
    window.playback.speed_chosen.emit(1.0)
    window.use_bookmarks([])


def test_of_a_recording_nothing_can_be_asked_and_the_buttons_say_why(window: ResearcherWindow) -> None:
    for action in window.tool_actions:
        assert not action.isEnabled()
        assert "recording" in action.toolTip()
    QTest.keyClick(window.canvas, "g")
    assert window.tool is MapTool.LOOK


def test_the_sheet_of_keys(window: ResearcherWindow, qtbot: QtBot) -> None:
    QTest.keyClick(window.canvas, Qt.Key.Key_F1)
    sheet = next(dialog for dialog in window.findChildren(QDialog) if dialog.isVisible())
    QTest.keyClick(sheet, Qt.Key.Key_Escape)
    assert not sheet.isVisible()


def test_dark_and_light_can_be_changed_while_it_is_open(window: ResearcherWindow) -> None:
    day = picture(window)
    window.set_palette(DARK)
    assert picture(window) != day


def test_whatever_takes_the_focus_has_a_name_and_tab_goes_as_the_eye_does(window: ResearcherWindow) -> None:
    docks = window.findChildren(QDockWidget)
    assert len(docks) == 11
    for dock in docks:
        dock.raise_()
        for _ in range(5):
            QApplication.processEvents()
        assert nameless(window) == [], dock.windowTitle()
        assert against_the_eye(stops(dock), dock) == [], dock.windowTitle()
        places = [QRect(stop.mapTo(window, QPoint(0, 0)), stop.size()) for stop in stops(window)]
        assert all(window.rect().intersects(place) for place in places), "Tab goes nowhere that nobody sees"
    next(dock for dock in docks if dock.windowTitle() == "Lines").raise_()
    QApplication.processEvents()
    parts = (window.displays, window.canvas, window.logs["line"], window.playback)
    firsts = [next(at for at, stop in enumerate(stops(window)) if _within(stop, part)) for part in parts]
    assert firsts == sorted(firsts)


def _within(widget: QWidget, part: QWidget) -> bool:
    return widget is part or part.isAncestorOf(widget)


def test_f6_goes_around_the_parts(window: ResearcherWindow, qtbot: QtBot) -> None:
    window.canvas.setFocus()
    seen = []
    for _ in range(12):
        QTest.keyClick(window.focusWidget(), Qt.Key.Key_F6)
        seen.append(window.focusWidget())
    assert window.canvas in seen
    assert window.team.table in seen
    assert len(set(map(id, seen))) >= 4


def test_a_bag_that_is_none_is_told_in_the_window(tmp_path: Path, qtbot: QtBot) -> None:
    path = tmp_path / "none.bag"
    path.write_bytes(b"this is no bag, whatever it is called")
    opening = BagOpener(path)
    window = ResearcherWindow(RecordingFeed(opening), path.name, LIGHT, time.monotonic)
    qtbot.addWidget(window)
    window.show()
    qtbot.waitUntil(lambda: "not a ROS 1 bag" in window.sign.text())
    window.close()
    window.deleteLater()


def test_a_click_on_a_plot_goes_there(window: ResearcherWindow) -> None:
    place = place_of(window.plots, 6.0) - QPoint(0, 5)
    QTest.mouseClick(window.plots.canvas.viewport(), Qt.MouseButton.LeftButton, pos=place)
    window.refresh()
    assert window.playback.timeline.value() == pytest.approx(6000.0, abs=400.0)
