"""The participant's window can be used at all sizes, with text of all sizes."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QFontMetricsF
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.support.windows import sample_screens
from tests.support.windows.layout_faults import misfits, settle
from tests.support.windows.participant_windows import STATES, Open, Opened, covered, room_on_map
from tests.support.windows.preferences import preferred
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.language_texts import shipped_texts
from ui.model.shared.theme import LIGHT
from ui.windows import look
from ui.windows.link import ParticipantLink
from ui.windows.participant import cards
from ui.windows.participant.pages.start import StartPage
from ui.windows.participant.popups.finding import PICTURE
from ui.windows.participant.widgets import painting
from ui.windows.participant_program import ParticipantMainWindow

SIZES = ((800, 500), (1024, 600), (1366, 768), (1920, 1080))
"""Sizes of windows, logical pixels."""

TEXTS = (*(pytest.param(each, marks=pytest.mark.slow) for each in (1.0, 1.25, 2.0)), 1.5)
"""Sizes of text, multiples of the usual one; the largest of what most people use is tested by default."""

in_each_size = pytest.mark.parametrize("text", TEXTS, indirect=True)
in_each_language = pytest.mark.parametrize("texts", [pytest.param("en", marks=pytest.mark.slow), "de"], indirect=True)
"""German has the longer words; it is tested by default."""


def sizes(text: float) -> tuple[tuple[int, int], ...]:
    """Sizes of windows for a size of text: the default one in the least and the greatest window, others in all.

    The least window has no place for text twice as large as usual.
    """
    return SIZES[::3] if text == 1.5 else SIZES if text < 1.5 else SIZES[1:]


@pytest.fixture
def text(request: pytest.FixtureRequest, qapp: QApplication) -> Iterator[float]:
    yield request.param
    look.apply_text_size(qapp, 1.0)


@pytest.fixture
def texts(request: pytest.FixtureRequest) -> Texts:
    return shipped_texts(request.param)


@pytest.fixture
def cut(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """Texts that were painted and cut off since the set was cleared last."""
    found: set[str] = set()

    def elided(words: str, width: float, metrics: QFontMetricsF) -> str:
        shown = painting_elided(words, width, metrics)
        if shown != words:
            found.add(words)
        return shown

    painting_elided = painting.elided
    for module in (painting, cards):
        monkeypatch.setattr(module, "elided", elided)
    return found


def set_text(qapp: QApplication, size: float) -> None:
    """Show text at a multiple of 10.5 points, whatever is usual on this computer."""
    look.apply_palette(qapp, LIGHT)
    look.apply_text_size(qapp, 1.0)
    look.apply_text_size(qapp, size * 1000 / look.px(1000))


def windows(opened: Open, texts: Texts) -> dict[int, Opened]:
    return {rooms: opened(sample_screens.playing(rooms=rooms, texts=texts), texts=texts) for rooms in (8, 12)}


@in_each_language
@in_each_size
def test_nothing_is_cut_off_or_covered(
    opened: Open, qapp: QApplication, cut: set[str], text: float, texts: Texts
) -> None:
    shown = windows(opened, texts)
    look.apply_text_size(qapp, text)
    for one in shown.values():
        settle()
        assert misfits(one.window) == [], "also where only the text has changed"
    for name, screen in sample_screens.states(texts).items():
        one = shown[len(screen.tiles)]
        one.show(screen)
        for size in sizes(text):
            one.window.resize(*size)
            settle()
            assert misfits(one.window) == [], (name, size)
            cut.clear()
            one.window.grab()
            assert cut == set(), (name, size)
            names = one.window.treasure.names
            if names.isVisible():
                assert names.sizeHintForColumn(0) <= names.viewport().width(), (name, size)


@in_each_language
@pytest.mark.parametrize("text", [1.25], indirect=True)
@pytest.mark.parametrize("size", [(1280, 720), (1366, 768)])
def test_a_find_covers_at_most_half_of_the_map_and_shows_all_names(
    opened: Open, qapp: QApplication, size: tuple[int, int], text: float, texts: Texts
) -> None:
    set_text(qapp, text)
    usual = sample_screens.playing(texts=texts)
    shown = opened(usual, *size, texts=texts)
    for find in (
        sample_screens.treasure(texts=texts),
        sample_screens.treasure(texts=texts, picture=True, picked="Pink can"),
    ):
        shown.show(replace(usual, popup=replace(find, worth=(10, 20, 30, 20), called=("Bonbonschachtel",) * 4)))
        settle()
        panel, area = shown.window.treasure, shown.window.map_area
        assert panel.width() * panel.height() <= area.width() * area.height() / 2
        names = panel.names
        assert names.verticalScrollBar().maximum() == 0
        assert names.visibleRegion().boundingRect() == names.rect()
        assert names.mapTo(panel, QPoint(0, 0)).x() > PICTURE.width(), "they are beside the picture"


@in_each_language
@pytest.mark.parametrize("text", [1.25], indirect=True)
def test_a_question_about_a_far_room_is_low_enough_to_hide_neither_robot_nor_room(
    opened: Open, qapp: QApplication, text: float, texts: Texts
) -> None:
    set_text(qapp, text)
    usual = sample_screens.playing(texts=texts)
    shown = opened(usual, 1280, 720, texts=texts)
    view, robots = shown.window.map, shown.model.robots(0.0)
    x, y = view.point(QPointF(0.42 * view.width(), 0.39 * view.height()))
    shown.model.robots = lambda _now: tuple(  # type: ignore[method-assign]
        replace(mark, pose=replace(mark.pose, x=x, y=y)) if mark.robot == 0 else mark for mark in robots
    )
    shown.window.refresh()
    question = sample_screens.dialogue(texts=texts)
    shown.show(
        replace(
            usual,
            popup=replace(question, robot=0, room=7, sentences=question.sentences[:2], choices=question.choices[:2]),
        )
    )
    settle()
    panel = covered(shown, shown.window.dialogue)
    assert not panel.contains(view.pixel(x, y).toPoint())
    assert not panel.contains(room_on_map(shown, 7))


def test_a_narrow_list_of_names_has_no_bar_below_instead_of_a_name(opened: Open) -> None:
    shown = opened(STATES["treasure"])
    names = shown.window.treasure.names
    names.setFixedSize(names.sizeHintForColumn(0) - 20, names.minimumSizeHint().height())
    settle()
    assert names.verticalScrollBar().maximum() > 0, "there is no room for all"
    assert not names.horizontalScrollBar().isVisible()
    assert names.viewport().height() >= 2 * names.sizeHintForRow(0)


@pytest.mark.parametrize("text", [1.25], indirect=True)
@pytest.mark.parametrize("texts", ["de"], indirect=True)
def test_energy_is_shown_whole_beside_a_long_key(
    opened: Open, qapp: QApplication, cut: set[str], text: float, texts: Texts
) -> None:
    set_text(qapp, text)
    usual = sample_screens.playing(texts=texts)
    waits = replace(usual.cards[1], cost=19.0, energy=100.0, waits=1)
    waits = replace(waits, select=replace(waits.select, key="Shift+Tab"))
    shown = opened(replace(usual, cards=(usual.cards[0], waits, usual.cards[2])), 1280, 720, texts=texts)
    shown.window.grab()
    assert cut == set()


@in_each_language
@in_each_size
def test_the_history_leaves_room_for_the_map(
    opened: Open, qtbot: QtBot, qapp: QApplication, text: float, texts: Texts
) -> None:
    shown = opened(sample_screens.states(texts)["six"], texts=texts)
    look.apply_text_size(qapp, text)
    qtbot.mouseClick(shown.window.waiting.history, Qt.MouseButton.LeftButton)
    for size in sizes(text):
        shown.window.resize(*size)
        settle()
        assert misfits(shown.window) == [], size
        assert shown.window.history.height() >= 2 * shown.window.history.fontMetrics().height()


@in_each_language
@in_each_size
def test_the_pages_before_a_game_fit(qtbot: QtBot, qapp: QApplication, text: float, texts: Texts) -> None:
    look.apply_palette(qapp, LIGHT)
    look.apply_text_size(qapp, text)
    for page in (StartPage(texts, 1, 12, 2), StartPage(texts, 2, 2, 2)):
        qtbot.addWidget(page)
        page.show()
        for size in sizes(text):
            page.resize(*size)
            settle()
            assert misfits(page) == [], size


@in_each_language
@in_each_size
def test_the_practice_game_fits(qtbot: QtBot, qapp: QApplication, tmp_path: Path, text: float, texts: Texts) -> None:
    look.apply_palette(qapp, LIGHT)
    window = ParticipantMainWindow(preferred(qapp, tmp_path), lambda _message: None, texts=texts)
    qtbot.addWidget(window)
    window.join(ParticipantLink("127.0.0.1", 1, "token"), practice=True)
    look.apply_text_size(qapp, text)
    window.show()
    for size in sizes(text):
        window.resize(*size)
        settle()
        assert window.size().toTuple() == size, "nothing makes it larger"
        # Meanwhile the window learns that there is no game, and shows another sentence.
        qtbot.waitUntil(lambda: misfits(window) == [])
    window.leave()
