"""A screen reader hears of all that the participant can press, and the focus goes as the eye does; so it is in the
researcher's window and the study's form, whose own tests ask for it by the same `screen_reader`.
"""

from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.support.windows import sample_screens
from tests.support.windows.participant_windows import STATES, Open, Opened, opened
from tests.support.windows.screen_reader import against_the_eye, nameless, stops
from thbridge.files.language_texts import shipped_texts
from ui.windows.participant.pages.start import StartPage
from ui.windows.participant.widgets.focus import reachable

__all__ = ["opened"]


def each_state(opened: Open) -> list[tuple[str, Opened]]:
    shown = {rooms: opened(sample_screens.playing(rooms=rooms), 1200, 800) for rooms in (8, 12)}
    return [(state, shown[len(screen.tiles)]) for state, screen in STATES.items()]


def test_all_that_can_be_pressed_speaks(opened: Open) -> None:
    for state, shown in each_state(opened):
        shown.show(STATES[state])
        assert nameless(shown.window) == [], state


def test_the_focus_goes_as_the_eye_does_in_each_region(opened: Open) -> None:
    for state, shown in each_state(opened):
        shown.show(STATES[state])
        for _ in range(5):
            QApplication.processEvents()
        for region in shown.window.regions:
            if region.isVisible():
                assert against_the_eye(reachable(region), region) == [], (state, region.accessibleName())


def test_the_page_before_a_game(qtbot: QtBot) -> None:
    page = StartPage(shipped_texts(), 1, 12, 2)
    qtbot.addWidget(page)
    page.resize(1200, 800)
    with qtbot.waitExposed(page):
        page.show()
    assert nameless(page) == []
    assert len(stops(page)) >= 14
    assert against_the_eye(stops(page), page) == []
