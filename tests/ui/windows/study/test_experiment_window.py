"""A study with people in the editor of study files."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QProcess, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QComboBox, QLabel, QLineEdit, QMessageBox, QPushButton
from pytestqt.qtbot import QtBot

from tests.support.windows.layout_faults import SIZES, misfits, settle
from tests.support.windows.screen_reader import nameless
from tests.support.windows.study_windows import leave_study, open_study
from thbridge.experiment.questionnaires.form import SHIPPED
from ui.model.study_form.form import editable_text
from ui.windows.study import StudyWindow
from ui.windows.study.key_chooser import KeyChooser

EXAMPLE = Path(__file__).parents[3] / "system" / "studies_of_0_1" / "with-people"
"""A study whose steps stay where they are."""


@pytest.fixture
def window(qtbot: QtBot, tmp_path: Path) -> Iterator[StudyWindow]:
    shutil.copytree(EXAMPLE, tmp_path / "arguing")
    made = open_study(qtbot, tmp_path / "arguing" / "experiment.yaml")
    yield made
    leave_study(made)


def settled(window: StudyWindow, qtbot: QtBot) -> None:
    qtbot.waitUntil(lambda: window.editor.settled)
    window.fields.finish()


def button(window: StudyWindow, name: str) -> QPushButton:
    return next(each for each in window.fields.findChildren(QPushButton) if each.accessibleName() == name)


def labels(window: StudyWindow) -> list[str]:
    return [step.label for step in window.editor.draft.groups()["steps"].groups]


def test_steps_are_moved_by_keys_alone(window: StudyWindow, qtbot: QtBot) -> None:
    window.open_section("steps")
    settled(window, qtbot)
    assert not button(window, "Move 1: instructions up").isEnabled()
    up = button(window, "Move 4: check (understood.yaml) up")
    qtbot.waitUntil(up.isVisible)
    up.setFocus()
    QTest.keyClicks(window.focusWidget(), " ")
    settled(window, qtbot)
    assert labels(window)[2:4] == ["3: check (understood.yaml)", "4: practice"]
    qtbot.waitUntil(lambda: button(window, "Move 3: check (understood.yaml) up").hasFocus())
    assert "no earlier step has the name practice" in " ".join(map(str, window.editor.draft.faults))
    QTest.keyClicks(window.focusWidget(), " ")
    settled(window, qtbot)
    assert labels(window)[1] == "2: check (understood.yaml)"
    window.editor.undo()
    window.editor.undo()
    settled(window, qtbot)
    assert window.editor.draft.text == (EXAMPLE / "experiment.yaml").read_text()


def test_a_step_that_was_added_is_in_sight_and_has_the_focus(window: StudyWindow, qtbot: QtBot) -> None:
    window.open_section("steps")
    settled(window, qtbot)
    added = f"steps[{len(labels(window))}].step"
    next(each for each in window.fields.findChildren(QPushButton) if each.text() == "Add to Steps").click()
    settled(window, qtbot)
    kind = window.fields.rows[added].editor
    qtbot.waitUntil(lambda: kind.hasFocus() and not kind.visibleRegion().isEmpty())


def test_typing_a_steps_name_keeps_the_focus(window: StudyWindow, qtbot: QtBot) -> None:
    window.open_field("steps[4].name")
    line = window.focusWidget()
    assert isinstance(line, QLineEdit)
    for typed in ("ga", "me"):
        QTest.keyClicks(line, typed)
        settled(window, qtbot)
    assert window.focusWidget() is line
    assert line.text() == "game"
    assert labels(window)[4] == "5: trial (game)"
    window.open_section("steps")
    settled(window, qtbot)
    button(window, "Remove 5: trial (game)")
    line = window.fields.rows["steps[4].name"].findChild(QLineEdit)
    line.setText("hunt")
    settled(window, qtbot)
    button(window, "Remove 5: trial (hunt)")
    button(window, "Move 5: trial (hunt) down")


def test_the_heading_of_a_search_follows_its_words(window: StudyWindow) -> None:
    for words in ("in_bloc", "in_block"):
        window.search.setText(words)
        window.found.finish()
        assert next(each.text() for each in window.found.findChildren(QLabel)) == f"“{words}”: 1 found"


def test_another_kind_of_step_has_other_keys(window: StudyWindow, qtbot: QtBot) -> None:
    window.open_section("steps[8]")
    settled(window, qtbot)
    box = window.fields.rows["steps[8].step"].findChild(QComboBox)
    box.setFocus()
    box.setCurrentText("check")
    settled(window, qtbot)
    qtbot.waitUntil(lambda: "steps[8].attempts" in window.fields.rows)
    settled(window, qtbot)
    qtbot.waitUntil(window.fields.rows["steps[8].step"].editor.hasFocus)
    fault = window.fields.rows["steps[8].step"]
    assert "The step check has no form" in fault._fault.text()


def test_a_factor_is_chosen_among_the_keys_of_studies(window: StudyWindow, qtbot: QtBot) -> None:
    window.open_section("between")
    settled(window, qtbot)

    def answer() -> None:
        box = QApplication.activeModalWidget()
        assert isinstance(box, KeyChooser)
        QTest.keyClicks(box.search, "noise preset")
        QTest.keyClick(box.search, Qt.Key.Key_Return)

    QTimer.singleShot(0, answer)
    next(each for each in window.fields.findChildren(QPushButton) if each.text().startswith("Add")).click()
    settled(window, qtbot)
    qtbot.waitUntil(lambda: "between.noise.preset" in window.fields.rows)
    row = window.fields.rows["between.noise.preset"]
    assert row.text().startswith("[none, ")
    line = row.findChild(QLineEdit)
    line.setFocus()
    line.selectAll()
    QTest.keyClicks(line, "[none, awful]")
    settled(window, qtbot)
    assert "awful" in row._fault.text()
    line.selectAll()
    QTest.keyClicks(line, "[none, bad wheels]")
    settled(window, qtbot)
    assert not row._fault.isVisible()
    with qtbot.waitSignal(window.editor.saved):
        window.save()
    before, after = (EXAMPLE / "experiment.yaml").read_text(), window.editor.path.read_text()
    gone = [line for line in before.splitlines() if line not in after.splitlines()]
    assert len(gone) == 1 and gone[0].startswith("between: {}")
    assert "# each person meets one level" in after
    assert "noise.preset: [none, bad wheels]" in after
    button(window, "Remove noise.preset").click()
    qtbot.waitUntil(lambda: "between.noise.preset" not in window.fields.rows)


def test_a_fault_of_a_section_opens_it(window: StudyWindow, qtbot: QtBot) -> None:
    window.editor.say(window.editor.draft.text.replace("{step: trial, each_condition: true, ", "{step: trial, "))
    settled(window, qtbot)
    window.faults.choose_next()
    assert window._key == "steps"


def test_it_fits_and_speaks(window: StudyWindow, qtbot: QtBot) -> None:
    for section in ("", "within", "steps"):
        window.open_section(section)
        for size in SIZES:
            window.resize(*size)
            settled(window, qtbot)
            settle()
            assert misfits(window) == [], (section, size)
        assert nameless(window) == []


def choosing(window: StudyWindow, words: str) -> KeyChooser:
    return choosing_in(window, "between", words)


def choosing_in(window: StudyWindow, section: str, words: str) -> KeyChooser:
    draft = window.editor.draft
    group = draft.groups()[section]
    chooser = KeyChooser(group.label, draft.keys_for(group), window, own_names=draft.allows_own_names(group))
    chooser.search.setText(words)
    return chooser


@pytest.mark.parametrize(
    ("words", "first"),
    [
        ("condition", "dialogue.condition"),
        ("conditon", "dialogue.condition"),
        ("game.enrgy", "game.energy"),
        ("collaborator", "dialogue.condition"),
    ],
)
def test_the_nearest_key_is_offered_first(window: StudyWindow, words: str, first: str) -> None:
    chooser = choosing(window, words)
    chooser.accept()
    assert chooser.chosen == first


def test_a_name_of_ones_own_is_chosen_by_its_own_button_alone(window: StudyWindow) -> None:
    chooser = choosing(window, "zzqx 9")
    chooser.accept()
    assert chooser.chosen == ""
    assert not chooser.add.isEnabled()
    chooser.own.click()
    assert chooser.chosen == "zzqx 9"
    base = choosing_in(window, "base", "zzqx")
    assert base.own.isHidden()


def test_keys_that_are_there_are_not_offered_again(window: StudyWindow) -> None:
    within = choosing_in(window, "within", "dialogue.condition")
    assert "dialogue.condition" not in [within.list.item(row).data(256) for row in range(within.list.count())]


def answered(words: str) -> None:
    """Answer the next question by the button of these words."""

    def answer() -> None:
        box = QApplication.activeModalWidget()
        assert isinstance(box, QMessageBox)
        next(each for each in box.buttons() if each.text() == words).click()

    QTimer.singleShot(0, answer)


def form_window(window: StudyWindow) -> StudyWindow:
    (found,) = (each for each in window.findChildren(StudyWindow) if each.isVisible())
    return found


def test_the_form_of_a_step_is_edited_in_a_window_of_its_own(window: StudyWindow, qtbot: QtBot) -> None:
    folder = window.editor.path.parent
    window.open_section("steps")
    settled(window, qtbot)
    button(window, "Edit the form of steps[3]").click()
    form = form_window(window)
    assert form.editor.path == folder / "understood.yaml"
    form.editor.set("items[0].id", "who")
    qtbot.waitUntil(lambda: form.editor.settled)
    with qtbot.waitSignal(form.editor.saved):
        form.save()
    assert "id: who" in (folder / "understood.yaml").read_text()
    form.close()
    # A form that comes with the program is copied before it is changed.
    answered("Create trust.yaml")
    button(window, "Edit the form of steps[6]").click()
    settled(window, qtbot)
    assert editable_text(window.editor.draft.fields()["steps[6].form"]) == "trust.yaml"
    assert (folder / "trust.yaml").read_text() == (SHIPPED / "trust.yaml").read_text()
    qtbot.waitUntil(lambda: len([each for each in window.findChildren(StudyWindow) if each.isVisible()]) == 1)
    form_window(window).close()


def test_a_form_that_was_mended_is_checked_again(window: StudyWindow, qtbot: QtBot) -> None:
    path = window.editor.path.parent / "understood.yaml"
    right = path.read_text()
    path.write_text(right.replace("id: costs", "id: decides"))
    window.editor.check_again()
    qtbot.waitUntil(lambda: bool(window.editor.draft.faults))
    window.open_section("steps")
    settled(window, qtbot)
    button(window, "Edit the form of steps[3]").click()
    form = form_window(window)
    form.editor.say(right)
    form.editor.settle()
    qtbot.waitUntil(lambda: form.editor.settled and not form.editor.draft.faults)
    with qtbot.waitSignal(form.editor.saved):
        form.save()
    qtbot.waitUntil(lambda: not window.editor.draft.faults)
    form.close()


def test_a_step_is_previewed_from_the_saved_file_alone(
    window: StudyWindow, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: list[list[str]] = []
    monkeypatch.setattr(QProcess, "startDetached", lambda _program, arguments: started.append(arguments))
    window.open_section("steps")
    settled(window, qtbot)
    button(window, "Preview 4: check (understood.yaml)").click()
    assert started[0][-4:] == ["study", "preview", str(window.editor.path.parent), "4"]
    window.editor.set("title", "Another title")
    settled(window, qtbot)
    answered("OK")
    button(window, "Preview 4: check (understood.yaml)").click()
    assert len(started) == 1
