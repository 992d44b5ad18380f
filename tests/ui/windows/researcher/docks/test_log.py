"""Lists keep up with the time, hold what they can, and find words."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit
from pytestqt.qtbot import QtBot

from tests.support.windows.log_rows import rows
from ui.model.shared.theme import DARK, LIGHT
from ui.windows.look import apply_palette
from ui.windows.researcher.docks.log import MAX_ROWS, LogModel, LogView


@pytest.fixture
def log(qtbot: QtBot) -> LogView:
    made = LogView("Dialogue", ("Who", "What"))
    qtbot.addWidget(made)
    made.resize(500, 300)
    made.show()
    return made


def test_rows_show_time_and_cells(log: LogView) -> None:
    log.extend(rows(0, 3))
    assert log.model.index(2, 0).data() == "2.00"
    assert log.model.index(2, 2).data() == "sentence 2"


def test_the_oldest_go_when_it_is_full(log: LogView) -> None:
    log.extend(rows(0, MAX_ROWS))
    log.extend(rows(MAX_ROWS, 5))
    assert log.model.size <= MAX_ROWS
    assert log.model.row(log.model.rowCount() - 1).time == MAX_ROWS + 4
    log.model.set_filter(f"{MAX_ROWS + 4}")
    assert [log.model.row(n).time for n in range(log.model.rowCount())] == [MAX_ROWS + 4]


def test_more_than_it_holds_at_once_leaves_the_newest(log: LogView) -> None:
    log.extend(rows(0, MAX_ROWS + 100))
    assert log.model.size <= MAX_ROWS
    assert log.model.row(log.model.rowCount() - 1).time == MAX_ROWS + 99


def test_all_words_of_the_filter_are_wanted_in_any_order_and_case(log: LogView) -> None:
    log.extend(rows(0, 20))
    QTest.keyClicks(log.findChild(QLineEdit), "Sentence WHO 3")
    assert [log.model.row(n).time for n in range(log.model.rowCount())] == [3.0, 10.0, 13.0, 17.0]
    log.extend(rows(31, 1))
    assert log.model.rowCount() == 5


def test_what_is_still_to_come_is_dimmed(qapp: QApplication) -> None:
    apply_palette(qapp, LIGHT)
    model = LogModel(("Who", "What"))
    model.extend(rows(0, 10))
    model.show_time(4.5)
    colours = [model.index(n, 2).data(Qt.ItemDataRole.ForegroundRole) for n in range(10)]
    assert colours[:5] == [None] * 5
    assert all(colour.name() == LIGHT.muted for colour in colours[5:])
    apply_palette(qapp, DARK)
    assert model.index(9, 2).data(Qt.ItemDataRole.ForegroundRole).name() == DARK.muted
    apply_palette(qapp, LIGHT)


def test_it_keeps_to_the_time_until_somebody_scrolls_up_and_again_when_they_come_back(
    log: LogView, qtbot: QtBot
) -> None:
    log.extend(rows(0, 500))
    bar = log.table.verticalScrollBar()
    bottom = bar.value()
    assert bottom == bar.maximum()
    bar.setValue(0)
    log.extend(rows(500, 10))
    assert bar.value() == 0
    qtbot.waitUntil(lambda: bar.maximum() > bottom)
    bar.setValue(bar.maximum())
    log.extend(rows(510, 10))
    assert bar.value() == bar.maximum()


def test_it_goes_to_the_moment_shown(log: LogView) -> None:
    log.extend(rows(0, 500))
    log.show_time(250.0)
    place = log.table.visualRect(log.model.index(250, 0))
    assert log.table.viewport().rect().contains(place)


def test_rows_are_copied_as_a_table(log: LogView) -> None:
    log.extend(rows(0, 3))
    log.table.selectAll()
    log.table.setFocus()
    QTest.keySequence(log.table, "Ctrl+C")
    assert QGuiApplication.clipboard().text().splitlines()[1] == "1.000\twho 1\tsentence 1"


def test_enter_on_a_row_asks_for_its_moment(log: LogView, qtbot: QtBot) -> None:
    log.extend(rows(0, 30))
    log.table.setFocus()
    log.table.setCurrentIndex(log.model.index(7, 0))
    with qtbot.waitSignal(log.chosen) as asked:
        QTest.keyClick(log.table, Qt.Key.Key_Return)
    assert asked.args == [7.0]
