import pytest
from PySide6.QtGui import QFontMetrics
from pytestqt.qtbot import QtBot

from ui.windows.look import font
from ui.windows.researcher.docks.team import TITLES, RobotRow, TeamTable


@pytest.mark.parametrize("characters", [18, 26, 34, 44])
def test_names_have_their_room_and_the_figures_what_is_left(qtbot: QtBot, characters: int) -> None:
    view = TeamTable()
    qtbot.addWidget(view)
    view.show_rows([RobotRow("robot 1", "drives", 0.003, 0.042, 100.0, 0.5, False)], 0)
    letter = QFontMetrics(font()).averageCharWidth()
    view.resize(characters * letter, 200)
    view.show()
    qtbot.waitUntil(lambda: view.table.columnWidth(0) >= 14 * letter)
    shown = [title for column, title in enumerate(TITLES) if not view.table.isColumnHidden(column)]
    assert (
        shown
        == {
            18: ["Robot"],
            26: ["Robot", "Error, m"],
            34: ["Robot", "Error, m", "Energy"],
            44: list(TITLES),
        }[characters]
    )
