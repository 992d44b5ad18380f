"""The page before a game."""

from pathlib import Path

import pytest
from msgspec import structs
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QLabel
from pytestqt.qtbot import QtBot

from tests.support.windows.preferences import preferred
from thbridge.files.language_texts import shipped_texts
from ui.model.lobby import ChooseLanguage, FromWindow, Offer
from ui.model.playing.rules_sheet import rules_lines
from ui.windows.participant import StartPage
from ui.windows.participant.pages.pages import KeyCap
from ui.windows.participant_program import ParticipantMainWindow
from ui.windows.preferences import SettingsDialog


@pytest.fixture
def page(qtbot: QtBot) -> StartPage:
    made = StartPage(shipped_texts(), 2, 6, 3, rules_lines(shipped_texts(), picture_cost=7.0, identify_cost=2.0))
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
    assert any("A picture costs 7 energy, naming costs 2" in text for text in shown)
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


def test_the_open_sheet_has_enter_and_tab_to_itself(page: StartPage, qtbot: QtBot) -> None:
    page.choices[4].setFocus()
    for opened in range(2):
        qtbot.keyClick(QApplication.focusWidget(), Qt.Key.Key_F1)
        reached = []
        for _ in range(5):
            focused = QApplication.focusWidget()
            assert page.help.isAncestorOf(focused)
            reached.append(focused)
            qtbot.keyClick(focused, Qt.Key.Key_Tab if opened == 0 else Qt.Key.Key_Backtab)
        assert len(set(reached)) == 2, "the button that closes it, and the text, round and round"
        with qtbot.assertNotEmitted(page.start):
            qtbot.keyClick(QApplication.focusWidget(), Qt.Key.Key_Return)
        assert not page.help.isVisible()
    with qtbot.waitSignal(page.start):
        qtbot.keyClick(page, Qt.Key.Key_Return)


@pytest.mark.parametrize(("least", "most", "keys"), [(2, 6, "2 to 6"), (1, 12, "1 to 9"), (3, 3, None)])
def test_the_sheet_lists_the_keys_of_this_page(qtbot: QtBot, least: int, most: int, keys: str | None) -> None:
    page = StartPage(shipped_texts(), least, most, least)
    qtbot.addWidget(page)
    page.show()
    page.sheet.click()
    shown = [cap.accessibleName() for cap in page.help.findChildren(KeyCap)]
    assert [name for name in shown if " to " in name] == ([] if keys is None else [keys])
    assert not any("F6" in name for name in shown)


def test_trying_it_out(page: StartPage, qtbot: QtBot) -> None:
    with qtbot.waitSignal(page.tutorial):
        qtbot.keyClick(page, Qt.Key.Key_T)
    with qtbot.waitSignal(page.tutorial):
        qtbot.mouseClick(page.practise, Qt.MouseButton.LeftButton)


def test_one_size_of_team_is_no_question(qtbot: QtBot) -> None:
    page = StartPage(shipped_texts(), 1, 1, 1)
    qtbot.addWidget(page)
    page.show()
    assert not page.choices[1].isVisible()
    assert "You will command 1 robot." in [label.text() for label in page.findChildren(QLabel)]
    assert page.begin.accessibleName() == "Start with 1 robot"


def test_the_language_is_chosen_in_the_settings_and_kept(
    qtbot: QtBot, qapp: QApplication, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(QApplication, "quit", lambda: None)
    offer = Offer(shipped_texts(), 1, 2, 2, languages={"en": "English", "de": "Deutsch"})
    german = structs.replace(offer, texts=shipped_texts("de"))
    sent: list[FromWindow] = []
    window = ParticipantMainWindow(preferred(qapp, tmp_path), sent.append)
    qtbot.addWidget(window, before_close_func=lambda it: it.leave())
    window.receive(offer)
    window.show()
    page = window.findChild(StartPage)
    assert page is not None
    qtbot.mouseClick(page.settings, Qt.MouseButton.LeftButton)
    dialog = window.findChild(SettingsDialog)
    assert dialog is not None and dialog.language.currentText() == "English"
    qtbot.keyClick(dialog.language, Qt.Key.Key_End)
    assert sent == [ChooseLanguage("de")] and not dialog.isVisible()
    window.receive(german)
    assert window.windowTitle() == shipped_texts("de").text("window.title")
    later = ParticipantMainWindow(preferred(qapp, tmp_path), sent.append)
    qtbot.addWidget(later, before_close_func=lambda it: it.leave())
    later.receive(offer)
    assert sent[1:] == [ChooseLanguage("de")], "without being asked again"
    later.receive(Offer(shipped_texts(), 2, 2, 2))
    assert sent[2:] == [], "a study that has chosen its language keeps it"
