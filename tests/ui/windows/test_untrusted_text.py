"""Words of others are shown as they are in every window: no HTML, no keys, no signs, no turned direction of writing."""

import dataclasses
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from msgspec import structs
from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtWidgets import QApplication, QLabel, QMessageBox, QPushButton, QToolTip, QWidget
from pytestqt.qtbot import QtBot

from tests.support.maps.small_arenas import FOUND, GRID
from tests.support.windows import sample_screens
from tests.support.windows.desk_windows import desk, state, study
from tests.support.windows.participant_windows import Open, Opened, opened
from tests.support.windows.template_windows import open_templates
from thbridge.hunt.rooms import RoomNames
from ui.model.desk.messages import DeskState
from ui.model.shared.theme import LIGHT
from ui.model.watching.scene import PendingAdvice, PendingTurn, Wizard
from ui.windows.arena.window import ArenaWindow
from ui.windows.desk.window import DeskWindow
from ui.windows.look import apply_palette
from ui.windows.map import MapView
from ui.windows.researcher.docked_window import DockedWindow
from ui.windows.researcher.docks.log import LogRow
from ui.windows.study import study_window
from ui.windows.untrusted_text import LONGEST, LONGEST_TITLE, PlainLabel, button_text, shown, title_text

__all__ = ["desk", "opened", "state", "study"]

HOSTILE = '<img src="a.png"><b>A&B</b>[*]'
WORDS = {"name", "found", "text", "title", "label", "hint", "note", "outcome", "names"}
TURNED = f"{HOSTILE}\u202e\x1b[2J"


@pytest.fixture(autouse=True)
def dressed(qapp: QApplication) -> None:
    apply_palette(qapp, LIGHT)


def rich(*inside: QWidget) -> list[str]:
    """Labels in these windows and of Qt's own that would take HTML."""
    tips = [widget for widget in QApplication.topLevelWidgets() if isinstance(widget, QLabel)]
    labels = [*tips, *(each for window in inside for each in window.findChildren(QLabel))]
    assert labels
    return [repr(each.text()) for each in labels if each.textFormat() != Qt.TextFormat.PlainText]


def texts(inside: QWidget) -> list[str]:
    return [each.text() for each in inside.findChildren(QLabel)]


def hostile(value: object, field: str = "") -> object:
    """A value with hostile words in the place of all that a game's files or people may have written."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        changed = {each.name: hostile(getattr(value, each.name), each.name) for each in dataclasses.fields(value)}
        return dataclasses.replace(value, **changed)
    if isinstance(value, tuple):
        return tuple(hostile(each, field) for each in value)
    if isinstance(value, str) and field in {
        "name",
        "found",
        "text",
        "title",
        "label",
        "hint",
        "note",
        "outcome",
        "names",
    }:
        return HOSTILE
    return value


@pytest.mark.parametrize("name", ["playing", "arguing", "treasure", "question", "refused", "over"])
def test_the_participants_window(opened: Open, name: str) -> None:
    shown_: Opened = opened(sample_screens.playing())
    shown_.show(hostile(sample_screens.states()[name]))  # type: ignore[arg-type]
    assert rich(shown_.window) == []


def test_the_researchers_window(qtbot: QtBot) -> None:
    window = DockedWindow(f"{HOSTILE}.bag", LIGHT, True, MapView(LIGHT))
    qtbot.addWidget(window)
    with qtbot.waitExposed(window):
        window.show()
    turn, advice = PendingTurn(0, 0, 0, "say", 4, (HOSTILE,)), PendingAdvice(1, ((4, 15.0),), 4)
    window.wizard.show_wizard(Wizard((0, 1), (turn,), (advice,)), 3, RoomNames({4: HOSTILE}))
    log = window.logs["line"].model
    log.extend([LogRow(1.0, tuple([TURNED] * (log.columnCount() - 1)))])
    assert rich(window) == []
    assert f"{HOSTILE}.bag" in window.windowHandle().title()
    buttons = [button for button in window.wizard.findChildren(QPushButton) if "img" in button.text()]
    assert len(buttons) == 2
    assert all(button.shortcut().isEmpty() and "A&&B" in button.text() for button in buttons)
    cell = log.index(0, 1).data()
    assert cell == HOSTILE + r"\u202e\x1b[2J"


def test_the_desks_window(desk: DeskWindow, state: DeskState) -> None:
    runs = tuple(structs.replace(run, participant=TURNED, cell=TURNED) for run in state.runs)
    desk.receive(structs.replace(state, title=HOSTILE, troubles=(TURNED,), kiosk=TURNED, runs=runs))
    assert rich(desk) == []
    assert desk.windowHandle().title() == f"{HOSTILE} - thbridge study"
    told = [text for text in texts(desk) if "img" in text]
    assert told
    assert not any("\u202e" in text or "\x1b" in text for text in told)


@pytest.fixture
def no_questions() -> Iterator[list[str]]:
    """Boxes that are asked meanwhile are read and closed without saving."""
    asked: list[str] = []

    def look() -> None:
        for box in QApplication.topLevelWidgets():
            if isinstance(box, QMessageBox) and box.isVisible():
                asked.extend(rich(box))
                asked.append(box.windowTitle())
                next(button for button in box.buttons() if "Discard" in button.text()).click()

    timer = QTimer(interval=20)
    timer.timeout.connect(look)
    timer.start()
    yield asked
    timer.stop()


def test_the_windows_of_files(qtbot: QtBot, tmp_path: Path, no_questions: list[str]) -> None:
    name = HOSTILE.replace("/", "\u2215")
    (tmp_path / f"{name}.yaml").write_text("robots: 2\n")
    source = Path(__file__).parents[3] / "templates" / "four-properties"
    windows = [
        study_window(tmp_path / f"{name}.yaml"),
        open_templates(qtbot, Path(shutil.copytree(source, tmp_path / name))),
        ArenaWindow(name, GRID, FOUND, lambda _: None),
    ]
    for window in windows:
        with qtbot.waitExposed(window):
            window.show()
        assert rich(window) == []
        assert name in window.windowHandle().title()
        window.close()
        window.deleteLater()


def test_a_question_and_a_tool_tip_take_no_html(qtbot: QtBot) -> None:
    window = QWidget(toolTip=HOSTILE)
    qtbot.addWidget(window)
    with qtbot.waitExposed(window):
        window.show()
    box = QMessageBox(QMessageBox.Icon.Question, HOSTILE, HOSTILE, parent=window)
    box.setInformativeText(HOSTILE)
    box.open()
    QToolTip.showText(window.mapToGlobal(QPoint(1, 1)), HOSTILE, window)
    tips = [each for each in QApplication.topLevelWidgets() if isinstance(each, QLabel) and each.text() == HOSTILE]
    assert tips
    assert rich(box) == []
    assert texts(box).count(HOSTILE) == 2
    QToolTip.hideText()
    box.close()


def test_a_label_shows_the_signs_of_html(qtbot: QtBot) -> None:
    plain, bold = PlainLabel("<b>A</b>"), PlainLabel("A")
    for label in (plain, bold):
        qtbot.addWidget(label)
        label.adjustSize()
    assert plain.width() > 3 * bold.width()


def test_functions_for_untrusted_text() -> None:
    assert shown(f"a\n\t{TURNED}") == f"a\n\t{HOSTILE}\\u202e\\x1b[2J"
    assert len(shown("x" * 10**6)) == LONGEST
    assert button_text("salt & pepper") == "salt && pepper"
    assert title_text("a[*]\n") == r"a[*][*]\n"
    assert len(title_text("x" * 10**6)) == LONGEST_TITLE
