"""The dock of the seats in the researcher's window, and the button with which a researcher takes a seat."""

import dataclasses

import pytest
from pytestqt.qtbot import QtBot

from ui.model.watching.seat_rows import SeatRow, TeamLine
from ui.windows.researcher.docks.seats import MOST_LINES, SeatsDock

DRIVER = SeatRow("driver", "The driver", "person", "robots 1, 2", "robot 2", "stops all robots")
NAMER = SeatRow("namer", "The namer", "away", "no robot", "", "names treasures")
TEXT = TeamLine("0:02.00", "The driver to all", "Hello.", "not read by the namer", True)


@pytest.fixture
def dock(qtbot: QtBot) -> SeatsDock:
    made = SeatsDock(live=True)
    qtbot.addWidget(made)
    made.show()
    return made


def test_each_seat_has_a_card_and_each_text_a_line(dock: SeatsDock) -> None:
    dock.show_seats([DRIVER, NAMER], [TEXT], "")
    assert [card.accessibleName() for card in dock.cards] == [
        "The driver: here. Commands robots 1, 2 · talks with robot 2. stops all robots",
        "The namer: away. Commands no robot. names treasures",
    ]
    assert dock.list.lines == ["0:02.00 The driver to all. Hello.. not read by the namer"]


def test_only_seats_without_a_player_can_be_taken(dock: SeatsDock, qtbot: QtBot) -> None:
    dock.show_seats([DRIVER, NAMER], [], "")
    assert [card.take.isHidden() for card in dock.cards] == [True, False]
    with qtbot.waitSignal(dock.wanted) as wanted:
        dock.cards[1].take.click()
    assert wanted.args == ["namer"]
    dock.show_seats([DRIVER, dataclasses.replace(NAMER, presence="researcher")], [], "")
    assert dock.cards[1].take.isHidden()


def test_the_button_shows_why_no_seat_can_be_taken(dock: SeatsDock) -> None:
    dock.show_seats([NAMER], [], "Your key only allows watching.")
    assert not dock.cards[0].take.isEnabled()
    assert dock.cards[0].take.toolTip() == "Your key only allows watching."


def test_a_recording_has_no_button(qtbot: QtBot) -> None:
    dock = SeatsDock(live=False)
    qtbot.addWidget(dock)
    dock.show()
    dock.show_seats([NAMER], [], "")
    assert dock.cards[0].take.isHidden()


def test_a_long_talk_shows_its_latest_lines(dock: SeatsDock) -> None:
    lines = [dataclasses.replace(TEXT, body=f"text {number}") for number in range(MOST_LINES + 50)]
    dock.show_seats([DRIVER], lines, "")
    assert len(dock.list.lines) == MOST_LINES
    assert f"text {MOST_LINES + 49}" in dock.list.lines[-1]
