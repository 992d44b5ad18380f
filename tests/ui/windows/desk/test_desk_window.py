"""The desk's window: it shows what the host tells, and asks before anything final."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from msgspec import structs
from PySide6.QtCore import QProcess, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDialog, QInputDialog, QMessageBox
from pytestqt.qtbot import QtBot

from tests.support.studies.rehearsed_studies import RehearsedStudy, clocks, rehearsed_study
from tests.support.windows.desk_windows import desk, state, study
from tests.support.windows.layout_faults import SIZES, TEXTS, misfits, settle
from tests.support.windows.screen_reader import against_the_eye, nameless, stops
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import LoggedEvent
from ui.model.desk.messages import (
    DeskClosed,
    DeskGroup,
    DeskSeat,
    DeskState,
    EndRun,
    ExcludeRun,
    NextParticipant,
    ShowRun,
    WithdrawRun,
    WriteNote,
)
from ui.model.desk.rows import GROUP_COLUMN
from ui.sources.experiment import ExperimentSource
from ui.windows import look
from ui.windows.desk.commands import CommandBox, TargetBox, latest_backup
from ui.windows.desk.program import READ_ONLY, LogWatch
from ui.windows.desk.questions import ReasonBox
from ui.windows.desk.window import DeskWindow

__all__ = ["desk", "state", "study"]


def answering(words: str, reason: str = "") -> list[str]:
    """Answer the next question by the button of these words; return what it says."""
    said: list[str] = []

    def answer() -> None:
        box = QApplication.activeModalWidget()
        if isinstance(box, ReasonBox):
            assert not box.agree.isEnabled(), "nothing without a reason"
            QTest.keyClicks(box.reason, "   ")
            assert not box.agree.isEnabled()
            QTest.keyClicks(box.reason, reason)
            buttons = [box.agree]
        else:
            assert isinstance(box, QMessageBox)
            said.append(box.text())
            buttons = box.buttons()
        chosen = next((button for button in buttons if button.text().startswith(words)), None)
        if chosen is None:
            assert isinstance(box, QDialog)
            box.reject()
        else:
            chosen.click()

    QTimer.singleShot(0, answer)
    return said


def column(model, number: int) -> list[str]:
    return [model.data(model.index(row, number)) for row in range(model.rowCount())]


def test_the_run_under_way_comes_first_and_is_selected(desk: DeskWindow, state: DeskState) -> None:
    under_way = next(run for run in state.runs if run.state == "under way")
    assert column(desk.run_model, 0)[0] == under_way.participant
    assert desk.run() == under_way
    assert desk.heard == [ShowRun(under_way.participant)]
    assert f"Required items without an answer: {', '.join(under_way.missing)}" in desk.details.text()
    assert desk.event_model.rowCount() == len(state.events) > 0
    assert [int(count) for count in column(desk.cell_model, 1)] == [cell.counted for cell in state.cells]


def test_the_run_selected_stays_so_while_others_come_and_go(desk: DeskWindow, state: DeskState) -> None:
    other = state.runs[0].participant
    desk.select(other)
    assert desk.heard[-1] == ShowRun(other)
    new = structs.replace(state.runs[-1], participant="P-NEWER", state="under way")
    desk.receive(structs.replace(state, runs=(*state.runs, new)))
    assert desk.run() == state.runs[0]
    desk.receive(structs.replace(state, runs=(*state.runs[1:], new)))
    assert desk.run() == new, "withdrawn: the topmost is selected instead"
    desk.receive(structs.replace(state, runs=()))
    assert desk.run() is None


def test_nothing_final_is_done_without_being_asked(desk: DeskWindow, qtbot: QtBot) -> None:
    someone, done = desk.run().participant, len(desk.heard)
    for answer, words in (("Cancel", ""), ("Cancel", "because")):
        said = answering(answer, words)
        desk.next.click()
        assert "next participant" in said[0]
        for button in (desk.end, desk.exclude):
            answering(answer, words)
            button.click()
    assert len(desk.heard) == done

    def press(key: str, words: str, reason: str = "") -> None:
        desk.activateWindow()
        qtbot.waitUntil(desk.isActiveWindow)
        answering(words, reason)
        QTest.keyClick(desk, key, Qt.KeyboardModifier.ControlModifier)

    press("N", "Start")
    press("E", "End", "felt sick")
    press("D", "Exclude", "knew the study")
    assert desk.heard[done:] == [
        NextParticipant(),
        EndRun(someone, "felt sick"),
        ExcludeRun(someone, "knew the study"),
    ]


def test_enter_in_a_reason_does_nothing_final(desk: DeskWindow) -> None:
    box = ReasonBox(desk, "End", "End it?", "End")
    box.open()
    QTest.keyClicks(box.reason, "felt sick")
    QTest.keyClick(box.reason, Qt.Key.Key_Return)
    assert box.isVisible() and box.result() == 0
    box.close()


def test_notes_go_to_the_log_about_the_study_or_a_person(desk: DeskWindow) -> None:
    someone = desk.run().participant
    QTest.keyClick(desk, Qt.Key.Key_M, Qt.KeyboardModifier.ControlModifier)
    for text in ("the heating is off", "   ", "came late"):
        desk.about.setChecked(text == "came late")
        QTest.keyClicks(desk.note, text)
        QTest.keyClick(desk.note, Qt.Key.Key_Return)
    assert desk.heard[1:] == [WriteNote("the heating is off"), WriteNote("came late", someone)]


def test_a_double_click_writes_one_note(desk: DeskWindow) -> None:
    done = len(desk.heard)
    QTest.keyClicks(desk.note, "came late")
    QTest.mouseClick(desk.add_note, Qt.MouseButton.LeftButton)
    QTest.mouseClick(desk.add_note, Qt.MouseButton.LeftButton)
    assert desk.heard[done:] == [WriteNote("came late")]


def test_buttons_say_why_they_are_off(desk: DeskWindow, state: DeskState) -> None:
    desk.receive(structs.replace(state, no_next="The study already has enough runs that count."))
    assert not desk.next.isEnabled()
    assert desk.next.accessibleDescription() == "The study already has enough runs that count."
    over = next(run for run in state.runs if run.state == "complete")
    desk.select(over.participant)
    assert not desk.end.isEnabled() and desk.exclude.isEnabled()
    assert desk.end.toolTip() == "This run is over."
    desk.receive(structs.replace(state, read_only=READ_ONLY))
    for button in (desk.next, desk.end, desk.exclude, desk.add_note):
        assert not button.isEnabled()
        assert button.toolTip() == READ_ONLY
    assert not desk.note.isEnabled()


def test_troubles_stand_out(desk: DeskWindow, state: DeskState) -> None:
    assert not desk.troubles.isVisible()
    desk.receive(structs.replace(state, troubles=("The disk is full.", "The kiosk is gone."), changed=("a was b",)))
    assert desk.troubles.isVisible()
    assert "The disk is full." in desk.troubles.text() and "The kiosk is gone." in desk.troubles.text()
    desk.receive(state)
    assert not desk.troubles.isVisible()


def test_closing_asks_where_it_cannot_be_undone(qtbot: QtBot, state: DeskState) -> None:
    desk = DeskWindow("Close the desk?")
    qtbot.addWidget(desk)
    desk.show()
    heard: list[object] = []
    desk.asked.connect(heard.append)
    answering("Cancel")
    assert not desk.close()
    answering("Close")
    assert desk.close()
    assert heard == [DeskClosed()]


def test_a_log_is_watched_as_it_grows(qtbot: QtBot, tmp_path: Path) -> None:
    study = rehearsed_study(tmp_path)
    desk = DeskWindow()
    qtbot.addWidget(desk)
    desk.show()
    watch = LogWatch(desk, ExperimentSource(study.folder, lambda: clocks(20_000).wall), period=10)
    qtbot.waitUntil(lambda: desk.state is not None and desk.state.shown != "")
    assert not desk.next.isEnabled() and desk.next.toolTip() == READ_ONLY
    with ExperimentLog(study.folder.log) as log:
        conductor = Conductor(study.design, log, lambda: clocks(20_000), lambda most: most - 1)
        conductor.note("it rains")
        qtbot.waitUntil(lambda: column(desk.note_model, 2)[-1] == "it rains")
        gone = study.entries[-1].event.participant
        conductor.withdraw(gone)
        qtbot.waitUntil(lambda: gone not in column(desk.run_model, 0))
    study.folder.log.write_bytes(b"")
    study.folder.log.with_name("log-head").write_bytes(b"nothing")
    qtbot.waitUntil(desk.troubles.isVisible)
    assert "log-head" in desk.troubles.text() or "log" in desk.troubles.text()
    watch.close()
    desk.leave()


def test_it_can_be_used_by_screen_readers_and_by_keys_alone(desk: DeskWindow, state: DeskState) -> None:
    desk.receive(structs.replace(state, no_next="", troubles=("The disk is full.",)))
    settle()
    assert nameless(desk) == []
    assert against_the_eye(stops(desk)[:4], desk) == []
    names = {table.accessibleName() for table in (desk.cells, desk.runs, desk.events, desk.notes)}
    assert names == {"Cells and quotas", "Runs", "Events of the selected run", "Notes"}
    desk.activateWindow()
    visited = []
    desk.next.setFocus()
    parts = [part for part in desk._parts if part.isVisible()]
    for _ in parts:
        visited.append(desk.focusWidget())
        QTest.keyClick(desk.focusWidget(), Qt.Key.Key_F6)
    assert visited == parts


@pytest.mark.parametrize("text", TEXTS)
def test_nothing_is_cut_off_or_covered(desk: DeskWindow, state: DeskState, qapp: QApplication, text: float) -> None:
    look.apply_text_size(qapp, text)
    try:
        for shown in (state, structs.replace(state, read_only=READ_ONLY, troubles=("The disk is full. " * 6,))):
            desk.receive(shown)
            for size in SIZES:
                desk.resize(*size)
                settle()
                assert desk.size().toTuple() == size, "nothing makes it larger"
                assert misfits(desk) == [], size
    finally:
        look.apply_text_size(qapp, 1.0)


@pytest.fixture
def at_folder(qtbot: QtBot, study: RehearsedStudy, state: DeskState, tmp_path: Path) -> Iterator[DeskWindow]:
    """The desk of a copy of the study, on whose folder commands are run."""
    shutil.copytree(study.folder.root, tmp_path / "study")
    made = DeskWindow(folder=ExperimentFolder(tmp_path / "study"))
    qtbot.addWidget(made)
    made.show()
    made.receive(state)
    yield made
    made.leave()


def finished(desk: DeskWindow, qtbot: QtBot) -> tuple[str, str]:
    """How the command of the desk ended, and what it printed."""
    (box,) = desk.findChildren(CommandBox)
    qtbot.waitUntil(lambda: box.words.text().endswith(("done.", "below.")), timeout=60_000)
    told = box.words.text(), box.output.toPlainText()
    box.accept()
    qtbot.waitUntil(lambda: not desk.findChildren(CommandBox))
    return told


def to_folder(folder: Path | None) -> None:
    """Answer the next question for a folder: this one, or the one suggested."""

    def answer() -> None:
        box = QApplication.activeModalWidget()
        assert isinstance(box, TargetBox)
        if folder is not None:
            box.folder.setText(str(folder))
        box.agree.click()

    QTimer.singleShot(0, answer)


def test_status_export_and_backup_are_commands_of_the_desk(
    at_folder: DeskWindow, qtbot: QtBot, tmp_path: Path, study: RehearsedStudy
) -> None:
    at_folder.status.click()
    words, printed = finished(at_folder, qtbot)
    assert words == "Status: done."
    assert all(run.participant in printed for run in at_folder.state.runs)
    to_folder(tmp_path / "backup")
    at_folder.back_up.click()
    assert finished(at_folder, qtbot)[0] == "Back up: done."
    assert read_log(tmp_path / "backup" / "store" / "log") == read_log(tmp_path / "study" / "store" / "log")
    assert latest_backup(ExperimentFolder(tmp_path / "study")) == str(tmp_path / "backup")
    to_folder(tmp_path)
    at_folder.export.click()
    words, printed = finished(at_folder, qtbot)
    assert words == "Export: failed. The reason is below."
    assert str(tmp_path) in "".join(printed.split())


@pytest.mark.slow
def test_an_export_is_a_command_of_the_desk(at_folder: DeskWindow, qtbot: QtBot, tmp_path: Path) -> None:
    to_folder(None)
    at_folder.export.click()
    assert finished(at_folder, qtbot)[0] == "Export: done."
    (written,) = (tmp_path / "study" / "exports").iterdir()
    assert (written / "tables" / "participants.parquet").exists()


def test_a_command_ends_with_its_box(at_folder: DeskWindow, qtbot: QtBot) -> None:
    at_folder.status.click()
    (box,) = at_folder.findChildren(CommandBox)
    process = box.findChild(QProcess)
    assert process.waitForStarted()
    box.reject()
    assert process.state() is QProcess.ProcessState.NotRunning


def test_a_desk_without_a_folder_has_no_commands(desk: DeskWindow) -> None:
    for button in (desk.status, desk.export, desk.back_up, desk.withdraw):
        assert not button.isEnabled()
        assert "folder" in button.accessibleDescription()


def naming(words: str, then: str) -> list[str]:
    """Type an id or code into the next question, and answer the one after it by the button of these words."""
    said: list[str] = []

    def second() -> None:
        box = QApplication.activeModalWidget()
        assert isinstance(box, QMessageBox)
        said.append(box.text())
        next(each for each in box.buttons() if each.text() == then).click()

    def first() -> None:
        box = QApplication.activeModalWidget()
        assert isinstance(box, QInputDialog)
        box.setTextValue(words)
        QTimer.singleShot(0, second)
        box.accept()

    QTimer.singleShot(0, first)
    return said


def test_a_withdrawal_shows_what_it_deletes_and_is_asked_of_the_host(at_folder: DeskWindow) -> None:
    asked: list[object] = []
    at_folder.asked.connect(asked.append)
    who = next(run.participant for run in at_folder.state.runs if run.state == "complete")
    for typed in ("P-NOBODY", "..", ""):
        said = naming(typed, "OK")
        at_folder.withdraw.click()
        assert "no participant with the ID" in said[0]
    said = naming(who.lower(), "Cancel")
    at_folder.withdraw.click()
    assert f"The withdrawal of {who} is permanent" in said[0]
    assert "will be deleted" in said[0]
    assert asked == []
    naming(who, f"Delete all data of {who}")
    at_folder.withdraw.click()
    assert asked == [WithdrawRun(who)]


def test_a_desk_that_only_watches_withdraws_by_the_command(
    at_folder: DeskWindow, state: DeskState, qtbot: QtBot, tmp_path: Path
) -> None:
    at_folder.receive(structs.replace(state, read_only=READ_ONLY))
    who = next(run.participant for run in state.runs if run.state == "complete")
    naming(who, f"Delete all data of {who}")
    at_folder.withdraw.click()
    assert finished(at_folder, qtbot)[0] == "Withdraw: done."
    log = read_log(tmp_path / "study" / "store" / "log")
    assert all(entry.event.participant != who for entry in log if isinstance(entry, LoggedEvent))


def test_only_studies_with_games_of_several_people_have_groups(desk: DeskWindow, state: DeskState) -> None:
    assert desk.groups.isHidden() and desk.runs.isColumnHidden(GROUP_COLUMN)
    seats = (DeskSeat("the driver", "person", state.runs[0].participant), DeskSeat("the namer", "empty", ""))
    desk.receive(structs.replace(state, groups=(DeskGroup("G-1", "trial", seats, False),)))
    assert desk.groups.isVisible() and not desk.runs.isColumnHidden(GROUP_COLUMN)
    settle()
    for size in SIZES:
        desk.resize(*size)
        settle()
        assert misfits(desk) == [], size
