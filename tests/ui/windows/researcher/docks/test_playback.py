"""The time bar: buttons, slider, marks."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from ui.model.watching.bookmarks import clock
from ui.windows.look import colours
from ui.windows.researcher.docks.playback import SPEEDS, PlaybackBar, TimelineBar, TimelineMark


@pytest.fixture
def bar(qtbot: QtBot) -> PlaybackBar:
    made = PlaybackBar(live=False)
    qtbot.addWidget(made)
    made.resize(900, 50)
    made.show()
    made.show_span(100.0, [TimelineMark(50.0, "Robot 1 is in room 4.", 0, is_utterance=False)])
    return made


def test_buttons_say_what_is_wanted(bar: PlaybackBar, qtbot: QtBot) -> None:
    with qtbot.waitSignal(bar.play_toggled):
        QTest.mouseClick(bar.play, Qt.MouseButton.LeftButton)
    with qtbot.waitSignal(bar.stepped) as forward:
        QTest.mouseClick(bar.forward, Qt.MouseButton.LeftButton)
    with qtbot.waitSignal(bar.stepped) as back:
        QTest.mouseClick(bar.back, Qt.MouseButton.LeftButton)
    assert (forward.args, back.args) == ([1], [-1])


def test_a_press_on_the_line_goes_there(bar: PlaybackBar, qtbot: QtBot) -> None:
    line = bar.timeline
    with qtbot.waitSignal(bar.seek) as asked:
        QTest.mouseClick(line, Qt.MouseButton.LeftButton, pos=QPoint(line.width() // 2, line.height() // 2))
    assert asked.args[0] == pytest.approx(50.0, abs=0.5)


def test_arrow_keys_go_a_second(bar: PlaybackBar, qtbot: QtBot) -> None:
    bar.show_time(20.0)
    bar.timeline.setFocus()
    with qtbot.waitSignal(bar.seek) as asked:
        QTest.keyClick(bar.timeline, Qt.Key.Key_Right)
    assert asked.args == [21.0]


def test_showing_the_time_asks_for_nothing(bar: PlaybackBar, qtbot: QtBot) -> None:
    with qtbot.assertNotEmitted(bar.seek):
        bar.show_time(33.0)
    assert (bar.time.text(), bar.end.text()) == ("0:33.00", "/ 1:40.00")
    assert bar.timeline.value() == 33_000


def test_a_typed_time_is_gone_to_and_stays_while_it_is_typed(bar: PlaybackBar, qtbot: QtBot) -> None:
    bar.ask_time()
    QTest.keyClicks(bar.time, "1:0")
    bar.show_time(12.0)
    assert bar.time.text() == "1:0"
    with qtbot.waitSignal(bar.seek) as asked:
        QTest.keyClicks(bar.time, "3,5\r")
    assert asked.args == [63.5]
    bar.ask_time()
    with qtbot.assertNotEmitted(bar.seek), qtbot.waitSignal(bar.refused):
        QTest.keyClicks(bar.time, "soon\r")


def test_speed_is_chosen_from_a_list(bar: PlaybackBar, qtbot: QtBot) -> None:
    bar.speed.setFocus()
    with qtbot.waitSignal(bar.speed_chosen) as asked:
        QTest.keyClick(bar.speed, Qt.Key.Key_Down)
    assert asked.args == [SPEEDS[SPEEDS.index(1.0) + 1]]


def test_a_bar_is_drawn_in_its_robots_colour_and_told_under_the_pointer(bar: PlaybackBar) -> None:
    line = bar.timeline
    bar.show_span(100.0, (), [TimelineBar(40.0, 60.0, "robot 2 makes way for robot 1", 1)])
    picture = line.grab().toImage()
    foot = [picture.pixelColor(x, picture.height() - 3).name() for x in range(picture.width())]
    drawn = [x for x, colour in enumerate(foot) if colour == colours().robot(1).lower()]
    assert len(drawn) == pytest.approx(0.2 * line.width(), abs=12)
    assert sum(drawn) / len(drawn) == pytest.approx(line.width() / 2, abs=3)
    for share, told in ((0.5, "40.0 s to 60.0 s  robot 2 makes way for robot 1"), (0.2, "")):
        QTest.mouseMove(line, QPoint(round(share * line.width()), line.height() // 2))
        assert line.toolTip() == told


def test_the_mark_under_the_pointer_is_told(bar: PlaybackBar) -> None:
    line = bar.timeline
    QTest.mouseMove(line, QPoint(line.width() // 2, line.height() // 2))
    assert "Robot 1 is in room 4." in line.toolTip()


def test_a_session_has_no_way_back(qtbot: QtBot) -> None:
    live = PlaybackBar(live=True)
    qtbot.addWidget(live)
    live.show()
    assert not live.back.isVisible()
    assert not live.timeline.isVisible()


@pytest.mark.parametrize(("seconds", "text"), [(0.0, "0:00.00"), (59.999, "1:00.00"), (723.4, "12:03.40")])
def test_the_clock_is_read_in_minutes(seconds: float, text: str) -> None:
    assert clock(seconds) == text
