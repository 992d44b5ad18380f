"""The page before a game."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel
from pytestqt.qtbot import QtBot

from ui.model.rules_sheet import rules_lines
from ui.windows.participant import StartPage


@pytest.fixture
def page(qtbot: QtBot) -> StartPage:
    made = StartPage(2, 6, 3, rules_lines(picture_cost=7.0, identify_cost=2.0))
    qtbot.addWidget(made)
    made.show()
    made.activateWindow()
    qtbot.waitUntil(made.isActiveWindow)
    return made


def test_as_many_robots_as_the_study_allows(page: StartPage) -> None:
    assert list(page.choices) == [2, 3, 4, 5, 6]
    assert [number for number, button in page.choices.items() if button.isChecked()] == [3]
    assert all(button.accessibleName() == f"{number} robots" for number, button in page.choices.items())


def test_a_game_by_mouse(page: StartPage, qtbot: QtBot) -> None:
    qtbot.mouseClick(page.choices[5], Qt.MouseButton.LeftButton)
    with qtbot.waitSignal(page.start) as started:
        qtbot.mouseClick(page.begin, Qt.MouseButton.LeftButton)
    assert started.args == [5]


def test_a_game_by_keyboard(page: StartPage, qtbot: QtBot) -> None:
    qtbot.keyClick(page, Qt.Key.Key_4)
    with qtbot.waitSignal(page.start) as started:
        qtbot.keyClick(page, Qt.Key.Key_Return)
    assert started.args == [4]
    qtbot.keyClick(page, Qt.Key.Key_9)
    assert page.choices[4].isChecked(), "a number that is not offered changes nothing"


def test_rules_and_keys_are_there_before_a_game(page: StartPage, qtbot: QtBot) -> None:
    qtbot.keyClick(page, Qt.Key.Key_F1)
    assert page.help.isVisible()
    shown = [label.text() for label in page.help.findChildren(QLabel)]
    assert any("a picture 7, naming 2" in text for text in shown)
    with qtbot.assertNotEmitted(page.start), qtbot.assertNotEmitted(page.tutorial):
        qtbot.keyClick(page.help.close_button, Qt.Key.Key_T)
    qtbot.keyClick(page.help.close_button, Qt.Key.Key_Escape)
    assert not page.help.isVisible()
    qtbot.mouseClick(page.sheet, Qt.MouseButton.LeftButton)
    assert page.help.isVisible()
    qtbot.mouseClick(page.help.close_button, Qt.MouseButton.LeftButton)
    assert not page.help.isVisible()
    with qtbot.waitSignal(page.tutorial):
        qtbot.keyClick(page, Qt.Key.Key_T)


def test_trying_it_out(page: StartPage, qtbot: QtBot) -> None:
    with qtbot.waitSignal(page.tutorial):
        qtbot.keyClick(page, Qt.Key.Key_T)
    with qtbot.waitSignal(page.tutorial):
        qtbot.mouseClick(page.practise, Qt.MouseButton.LeftButton)


def test_one_size_of_team_is_no_question(qtbot: QtBot) -> None:
    page = StartPage(1, 1, 1)
    qtbot.addWidget(page)
    page.show()
    assert not page.choices[1].isVisible()
    assert "You will command 1 robot." in [label.text() for label in page.findChildren(QLabel)]
    assert page.begin.accessibleName() == "Start with 1 robot"
