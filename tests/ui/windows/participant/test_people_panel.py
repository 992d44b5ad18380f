"""Panel of the people in the participant's window."""

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel

from tests.support.windows import sample_screens
from ui.model.playing.screen import ChooseAddressee, ChooseRobot, MarkReadAct, NextRobot, SayToPeopleAct, WriteText

PEOPLE = sample_screens.states()["people"]


def written(shown):
    return [act for act in shown.done if isinstance(act, WriteText | SayToPeopleAct)]


def test_a_game_of_one_participant_has_no_panel_and_no_button(opened):
    shown = opened(sample_screens.states()["playing"], 1400, 800)
    assert not shown.window.people.isVisible()
    assert not shown.window.waiting.people.isVisible()


def test_keys_write_a_text_and_enter_sends_it(opened):
    shown = opened(PEOPLE, 1400, 800)
    field = shown.window.people.field
    assert field.toPlainText() == "1 2 3"
    QTest.keyClick(shown.window, Qt.Key.Key_T)
    assert field.hasFocus()
    field.selectAll()
    QTest.keyClicks(field, "x 4")
    QTest.keyClick(field, Qt.Key.Key_Return)
    assert written(shown) == [
        *(WriteText(text) for text in ("x", "x ", "x 4")),
        SayToPeopleAct("", "x 4"),
    ]
    assert field.toPlainText() == ""
    QTest.keyClick(field, Qt.Key.Key_Tab)
    assert shown.done[-1] == NextRobot(1)
    QTest.keyClick(field, Qt.Key.Key_Escape)
    assert not field.hasFocus()


def test_a_draft_stays_while_other_parts_change_and_is_replaced_when_the_game_puts_a_text_back(opened):
    shown = opened(PEOPLE, 1400, 800)
    field, panel = shown.window.people.field, PEOPLE.people
    field.setPlainText("mine")
    shown.show(replace(PEOPLE, people=replace(panel, draft="", unread=0, news="", read=None)))
    assert field.toPlainText() == "mine"
    shown.show(replace(PEOPLE, people=replace(panel, draft="refused mine", restored=1)))
    assert field.toPlainText() == "refused mine"


def test_the_addressee_is_chosen_from_the_list(opened):
    shown = opened(PEOPLE, 1400, 800)
    shown.window.people.chooser.setCurrentIndex(2)
    shown.window.people.chooser.activated.emit(2)
    assert shown.done[-1] == ChooseAddressee("scout")


def test_visible_texts_are_reported_as_read_once(opened, qtbot):
    shown = opened(PEOPLE, 1400, 800)
    qtbot.waitUntil(lambda: MarkReadAct(3) in shown.done)
    shown.window.people.list.to_end()
    assert shown.done.count(MarkReadAct(3)) == 1


def test_a_narrow_window_shows_the_people_in_place_of_the_robots(opened, qtbot):
    shown = opened(PEOPLE, 900, 600)
    window = shown.window
    assert (window.people.isVisible(), window.column.isVisible()) == (False, True)
    assert MarkReadAct(3) not in shown.done
    assert window.waiting.people.face.label == "Team · 1"
    QTest.mouseClick(window.waiting.people, Qt.MouseButton.LeftButton)
    assert (window.people.isVisible(), window.column.isVisible()) == (True, False)
    qtbot.waitUntil(lambda: MarkReadAct(3) in shown.done)
    QTest.mouseClick(window.waiting.people, Qt.MouseButton.LeftButton)
    assert window.column.isVisible()


def test_hostile_texts_are_shown_literally_and_never_widen_the_panel(opened):
    panel = PEOPLE.people
    text = "<b>bold</b><img src=x>" + "w" * 400
    hostile = replace(panel, texts=tuple(replace(each, who=text[:40], text=text) for each in panel.texts))
    shown = opened(replace(PEOPLE, people=hostile), 1400, 800)
    people = shown.window.people
    labels = [label for label in people.list.findChildren(QLabel) if "<b>bold" in label.text()]
    assert len(labels) == 8
    assert {label.textFormat() for label in labels} == {Qt.TextFormat.PlainText}
    assert people.list.widget().width() <= people.list.viewport().width()


@pytest.mark.parametrize("letter", "XEAFMWH")
def test_letters_in_the_field_are_no_keys_of_the_game(opened, letter):
    shown = opened(PEOPLE, 1400, 800)
    shown.window.people.go_to()
    QTest.keyClicks(shown.window.people.field, letter)
    assert [act for act in shown.done if not isinstance(act, WriteText | MarkReadAct)] == []
    assert ChooseRobot(1) not in shown.done
