import pytest
from PySide6.QtCore import QSize, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDockWidget, QLabel, QPushButton
from pytestqt.qtbot import QtBot

from tests.support.windows.layout_faults import SIZES, TEXTS, misfits, settle
from thbridge.hunt.rooms import RoomNames
from ui.model.shared.theme import LIGHT
from ui.model.watching.scene import PendingAdvice, PendingTurn, Wizard
from ui.windows import look
from ui.windows.map import MapView
from ui.windows.researcher.docked_window import DockedWindow

TURN = PendingTurn(0, 0, 0, "select-room", 4, ("It will cost me 17 energy to go to room 4", "Are you sure?"))
ADVICE = PendingAdvice(1, tuple((room, 15.0) for room in range(1, 9)), 8)


@pytest.fixture(autouse=True)
def usual_text(qapp: QApplication) -> None:
    """The text of the product, not Qt's own, which is smaller."""
    look.apply_text_size(qapp, 1.0)


def opened(qtbot: QtBot, size: QSize) -> DockedWindow:
    window = DockedWindow("a session", LIGHT, True, MapView(LIGHT))
    qtbot.addWidget(window)
    window.resize(size)
    window.show()
    next(dock for dock in window.findChildren(QDockWidget) if dock.windowTitle() == "Wizard").raise_()
    qtbot.waitUntil(window.wizard.isVisible)
    return window


def hidden(window: DockedWindow) -> list[str]:
    """Return the reply buttons of which a part lies beyond an edge."""
    buttons = window.wizard.findChildren(QPushButton)
    assert buttons
    return [each.text() for each in buttons if each.visibleRegion().boundingRect() != each.rect()]


@pytest.mark.parametrize("size", [QSize(1024, 600), QSize(1200, 800), QSize(1366, 768)])
@pytest.mark.parametrize(("turns", "advice"), [((TURN,), ()), ((), (ADVICE,)), ((TURN,), (ADVICE,))])
def test_every_reply_is_in_sight_and_the_window_as_large_as_before(
    qtbot: QtBot, size: QSize, turns: tuple[PendingTurn, ...], advice: tuple[PendingAdvice, ...]
) -> None:
    window = opened(qtbot, size)
    window.wizard.show_wizard(Wizard((0, 1)), 3)
    settle()
    before = window.canvas.geometry()
    window.wizard.show_wizard(Wizard((0, 1), turns, advice), 3)
    qtbot.waitUntil(lambda: hidden(window) == [])
    assert window.size() == size
    assert window.canvas.geometry() == before, "what waits does not move the map"


def test_the_name_of_a_room_stands_beside_its_number(qtbot: QtBot) -> None:
    window = opened(qtbot, QSize(1200, 800))
    window.wizard.show_wizard(Wizard((0, 1), (TURN,), (ADVICE,)), 3, RoomNames({4: "Kitchen", 8: "Bath"}))
    assert "Robot 1 waits to speak about room 4 (Kitchen)" in [each.text() for each in window.findChildren(QLabel)]
    buttons = [button.text() for button in window.wizard.findChildren(QPushButton)]
    assert {"Room 3 (15)", "Room 4 (Kitchen; 15)", "Room 8 (Bath; 15; its own choice)"} <= set(buttons)


@pytest.mark.parametrize("text", TEXTS)
def test_all_that_waits_is_reached_at_all_sizes(qtbot: QtBot, qapp: QApplication, text: float) -> None:
    look.apply_text_size(qapp, text)
    try:
        for size in SIZES:
            window = opened(qtbot, QSize(*size))
            window.wizard.show_wizard(Wizard((0, 1), (TURN,), (ADVICE,)), 3)
            settle()
            assert misfits(window) == [], size
            assert window.size() == QSize(*size)
            window.close()
            window.deleteLater()
    finally:
        look.apply_text_size(qapp, 1.0)


def test_what_waits_beyond_the_share_of_the_list_is_scrolled_to(qtbot: QtBot) -> None:
    window = opened(qtbot, QSize(1024, 600))
    window.wizard.show_wizard(Wizard((0, 1), (TURN,) * 12), 3)
    qtbot.waitUntil(lambda: 0 < len(hidden(window)) < 24)
    first = window.wizard.findChildren(QPushButton)[0]
    assert first.visibleRegion().boundingRect() == first.rect()
    assert window.size() == QSize(1024, 600)


def test_a_reply_is_given_by_its_button_with_other_words(qtbot: QtBot) -> None:
    window = opened(qtbot, QSize(1024, 600))
    window.wizard.show_wizard(Wizard((0,), (TURN,)), 3)
    qtbot.waitUntil(lambda: hidden(window) == [])
    with qtbot.waitSignal(window.wizard.spoke) as spoke:
        QTest.mouseClick(window.wizard.findChildren(QPushButton)[1], Qt.MouseButton.LeftButton)
    assert spoke.args == [TURN, 1, ""]


@pytest.mark.parametrize("text", TEXTS)
def test_many_robots_and_a_reason_fit_at_all_sizes(qtbot: QtBot, qapp: QApplication, text: float) -> None:
    look.apply_text_size(qapp, text)
    try:
        for size in SIZES:
            window = opened(qtbot, QSize(*size))
            window.wizard.show_wizard(Wizard(), 10)
            window.wizard.refuse("This is a recording: nothing can be asked of its robots any more.")
            settle()
            assert misfits(window) == [], size
            assert window.size() == QSize(*size)
            window.close()
            window.deleteLater()
    finally:
        look.apply_text_size(qapp, 1.0)
