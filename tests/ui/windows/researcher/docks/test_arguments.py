"""The dock in which a researcher reads a robot's dialogue."""

import math
from itertools import combinations

import pytest
from PySide6.QtCore import QLineF, QPointF, QRectF, QSize, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDockWidget
from pytestqt.qtbot import QtBot

from tests.support.ros.watched_messages import SECOND, watched
from tests.support.windows.layout_faults import SIZES, TEXTS, misfits, settle
from tests.support.windows.screen_reader import nameless
from thbridge.dialogue.portrait import DialoguePortrait, PortrayedArgument
from ui.model.shared.theme import LIGHT
from ui.model.watching.dialogue_log import DialogueCourse
from ui.model.watching.dialogue_rows import DialogueList
from ui.windows import look
from ui.windows.map import MapView
from ui.windows.researcher.docked_window import DockedWindow
from ui.windows.researcher.docks.arguments import ArgumentsDock
from ui.windows.researcher.docks.attack_graph import AttackGraph, edge_point


@pytest.fixture
def course() -> DialogueCourse:
    return watched().dialogue(0, 4 * SECOND)


@pytest.fixture
def dock(qtbot: QtBot, course: DialogueCourse) -> ArgumentsDock:
    made = ArgumentsDock()
    qtbot.addWidget(made)
    made.resize(400, 700)
    made.show()
    made.show_course(0, course, SECOND)
    return made


def test_the_course_of_a_dialogue_is_listed_and_leads_to_its_times(dock: ArgumentsDock, course: DialogueCourse) -> None:
    assert dock.moves.rowCount() == len(course.moves)
    assert dock.heading.text().startswith("Robot 1, dialogue 1")
    chosen: list[float] = []
    dock.chosen.connect(chosen.append)
    dock.course.setFocus()
    dock.course.selectRow(2)
    QTest.keyClick(dock.course, Qt.Key.Key_Return)
    assert chosen == [(course.moves[2][0] - SECOND) / 1e9]


@pytest.mark.parametrize("shown", DialogueList)
def test_each_list_is_chosen_and_named(dock: ArgumentsDock, course: DialogueCourse, shown: DialogueList) -> None:
    dock.list.setCurrentText(shown)
    assert dock.table.accessibleName() == shown
    assert dock.details.rowCount() > 0
    dock.show_course(1, DialogueCourse(), 0)
    assert dock.details.rowCount() == dock.moves.rowCount() == 0


def test_a_screen_reader_hears_of_the_attacks(dock: ArgumentsDock, course: DialogueCourse) -> None:
    assert nameless(dock) == []
    told = dock.graph.accessibleDescription()
    assert "; accepted; not attacked" in told
    dock.show_course(0, DialogueCourse(), 0)
    assert dock.graph.accessibleDescription() == "There are no arguments."


@pytest.mark.parametrize("count", range(9))
def test_arguments_have_each_their_place_in_the_picture(qtbot: QtBot, count: int) -> None:
    graph = AttackGraph()
    qtbot.addWidget(graph)
    graph.resize(380, 300)
    arguments = tuple(PortrayedArgument((), str(place), ()) for place in range(count))
    graph.show_portrait(DialoguePortrait(arguments=arguments))
    boxes = graph.boxes()
    assert len(boxes) == count and all(QRectF(graph.rect()).contains(box) for box in boxes)
    assert not any(one.intersects(other) for one, other in combinations(boxes, 2))


def test_what_stands_is_told_apart_without_colours(qtbot: QtBot) -> None:
    graph = AttackGraph()
    qtbot.addWidget(graph)
    graph.resize(200, 150)
    pictures = []
    for grounded in ((), (0,)):
        graph.show_portrait(DialoguePortrait(arguments=(PortrayedArgument((), "a", ()),), grounded=grounded))
        grey = graph.grab().toImage().convertToFormat(graph.grab().toImage().Format.Format_Mono)
        pictures.append(bytes(grey.constBits()))
    assert pictures[0] != pictures[1]


def test_an_arrow_ends_at_the_edge_of_what_it_attacks() -> None:
    box = QRectF(10.0, 10.0, 40.0, 20.0)
    for angle in range(0, 360, 15):
        start = box.center() + 100.0 * QPointF(math.cos(math.radians(angle)), math.sin(math.radians(angle)))
        tip = edge_point(box, QLineF(start, box.center()))
        off = tip - box.center()
        assert max(abs(off.x()) / 20.0, abs(off.y()) / 10.0) == pytest.approx(1.0)


@pytest.mark.parametrize("text", TEXTS)
def test_all_is_reached_at_all_sizes(qtbot: QtBot, qapp: QApplication, course: DialogueCourse, text: float) -> None:
    look.apply_text_size(qapp, text)
    try:
        for size in SIZES:
            window = DockedWindow("a session", LIGHT, True, MapView(LIGHT))
            qtbot.addWidget(window)
            window.resize(QSize(*size))
            window.show()
            next(dock for dock in window.findChildren(QDockWidget) if dock.windowTitle() == "Arguments").raise_()
            window.arguments.show_course(0, course, 0)
            qtbot.waitUntil(window.arguments.isVisible)
            settle()
            assert misfits(window) == [], size
            assert window.size() == QSize(*size)
            window.close()
            window.deleteLater()
    finally:
        look.apply_text_size(qapp, 1.0)
