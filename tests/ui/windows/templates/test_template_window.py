"""The window of a template set."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QTextCursor
from PySide6.QtWidgets import QApplication, QFileDialog, QLineEdit
from pytestqt.qtbot import QtBot

from tests.support.windows.layout_faults import SIZES, TEXTS, misfits, settle
from tests.support.windows.questions import answering
from tests.support.windows.screen_reader import against_the_eye, nameless, stops
from tests.support.windows.template_windows import SHIPPED, append, open_templates
from ui.model.shared.theme import LIGHT
from ui.windows import look
from ui.windows.controls import ChoiceBox
from ui.windows.look import apply_palette
from ui.windows.templates.window import TemplateWindow


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return Path(shutil.copytree(SHIPPED / "four-properties", tmp_path / "mine"))


@pytest.fixture
def window(qtbot: QtBot, qapp: QApplication, folder: Path) -> Iterator[TemplateWindow]:
    apply_palette(qapp, LIGHT)
    window = open_templates(qtbot, folder)
    yield window
    with answering("Discard"):
        window.close()
    window.deleteLater()


def test_sentences_are_shown_as_robots_say_them_with_the_numbers_of_a_map(window: TemplateWindow, qtbot: QtBot) -> None:
    assert "Kitchen, room 4, costs me 13 of my 100 energy." in window.preview.toPlainText()
    window.place.setCurrentText("office")
    assert "room 8, costs me " in window.preview.toPlainText()
    window.treasure.setCurrentText("floor vase")
    assert "green, large and heavy" in window.preview.toPlainText()


def test_what_is_typed_is_checked_and_saved_and_nothing_else_changes(
    window: TemplateWindow, qtbot: QtBot, folder: Path
) -> None:
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    append(window, "DialogueText", "Is it £wieght£?\n")
    qtbot.waitUntil(lambda: window.faults.list.count() == 1)
    assert "DialogueText, line 9: unknown reserved word £wieght£. Write £weight£." in window.faults.list.item(0).text()
    window.pages["DialogueText"].undo()
    append(window, "DialogueText", "Is it £weight£?\n")
    qtbot.waitUntil(lambda: window.faults.list.count() == 0 and "Is it light?" in window.preview.toPlainText())
    qtbot.mouseClick(window.save_button, Qt.MouseButton.LeftButton)
    after = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    sentences = folder / "DialogueText"
    assert after.pop(sentences) == before.pop(sentences) + "Is it £weight£?\n".encode()
    assert after == before
    assert not window.isWindowModified()


def test_a_fault_leads_to_its_line(window: TemplateWindow, qtbot: QtBot) -> None:
    page = window.pages["treasures.yaml"]
    page.setPlainText(page.toPlainText().replace("weight: light, material: wood", "weight: lihgt, material: wood", 1))
    qtbot.waitUntil(lambda: window.faults.list.count() == 1)
    window.faults.list.setCurrentRow(0)
    window.tabs.setCurrentWidget(window.pages["DialogueText"])
    qtbot.keyClick(window.faults.list, Qt.Key.Key_Return)
    assert window.tabs.currentWidget() is page
    assert "lihgt" in page.textCursor().block().text()


def test_a_picture_is_replaced_when_the_set_is_saved(
    window: TemplateWindow, qtbot: QtBot, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = SHIPPED / "practice" / "pictures" / "green_can.jpg"
    replaced = folder / "pictures" / "toy_block.jpg"
    before = replaced.read_bytes()
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(other), ""))
    window.pictures.setCurrentRow(0)
    qtbot.keyClick(window.pictures, Qt.Key.Key_Return)
    assert replaced.read_bytes() == before
    assert window.isWindowModified()
    assert window.save()
    assert replaced.read_bytes() == other.read_bytes()
    assert not window.isWindowModified()


def test_a_picture_is_added_for_a_treasure_that_names_it(
    window: TemplateWindow, qtbot: QtBot, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = Path(shutil.copy(SHIPPED / "practice" / "pictures" / "green_can.jpg", tmp_path / "my can.jpg"))
    page = window.pages["treasures.yaml"]
    page.setPlainText(page.toPlainText().replace("image: toy_block.jpg", "image: my_can.jpg"))
    qtbot.waitUntil(lambda: window.faults.list.count() == 1)
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(other), ""))
    qtbot.mouseClick(window.add_picture, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: window.faults.list.count() == 0)
    assert window.save()
    assert (folder / "pictures" / "my_can.jpg").read_bytes() == other.read_bytes()


def test_a_file_that_is_no_picture_is_refused(
    window: TemplateWindow, qtbot: QtBot, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(folder / "DialogueText"), ""))
    with answering("OK"):
        qtbot.mouseClick(window.add_picture, Qt.MouseButton.LeftButton)
    assert window.changed() == []


def test_a_set_with_faults_is_saved_on_request_only(window: TemplateWindow, folder: Path) -> None:
    before = (folder / "DialogueText").read_text()
    append(window, "DialogueText", "Is it £wieght£?\n")
    with answering("Cancel"):
        assert not window.save()
    assert (folder / "DialogueText").read_text() == before
    with answering("Save anyway"):
        assert window.save()
    assert "£wieght£" in (folder / "DialogueText").read_text()


def test_what_another_program_wrote_is_not_overwritten_unasked(window: TemplateWindow, folder: Path) -> None:
    append(window, "DialogueText", "More?\n")
    (folder / "DialogueText").write_text("Theirs\nSpecificRoom:\n")
    with answering("Cancel"):
        assert not window.save()
    assert (folder / "DialogueText").read_text() == "Theirs\nSpecificRoom:\n"


@pytest.mark.parametrize(
    "strange", ["Signs\r\nSpecificRoom:\nA\r\n", "No\u00a0break\nSpecificRoom:\n", "Two\u2028rows\nSpecificRoom:\n"]
)
def test_a_text_that_nobody_edits_stays_to_the_byte(qtbot: QtBot, folder: Path, strange: str) -> None:
    sentences = folder / "DialogueText"
    sentences.write_text(strange, encoding="utf-8", newline="")
    window = TemplateWindow(folder)
    assert window.changed() == []
    append(window, "DialogueText", "More?\n")
    assert window.texts()["DialogueText"] == strange + "More?" + ("\r\n" if "\r" in strange else "\n")
    with answering("Discard"):
        window.close()


@pytest.mark.parametrize(
    ("line", "offered", "not_offered"),
    [(2, "£reason£", "£weight£"), (4, "£cost£", "£reason£"), (6, "£weight£", "£reason£"), (3, "", "£room£")],
)
def test_words_are_offered_where_they_hold(window: TemplateWindow, line: int, offered: str, not_offered: str) -> None:
    page = window.pages["DialogueText"]
    window.tabs.setCurrentWidget(page)
    page.setTextCursor(QTextCursor(page.document().findBlockByNumber(line - 1)))
    window.words.aboutToShow.emit()
    words = [action.data() for action in window.words.actions()]
    assert not_offered not in words
    if not offered:
        assert not any(action.isEnabled() for action in window.words.actions())
        return
    window.words.actions()[words.index(offered)].trigger()
    assert page.textCursor().block().text().startswith(offered)


def typed_into(window: TemplateWindow, qtbot: QtBot, title: str, row: int, column: int, text: str) -> None:
    """Type into a cell, over what was there."""
    window.tabs.setCurrentWidget(window.sheets[title])
    table = window.sheets[title].table
    table.setCurrentCell(row, column)
    table.setFocus()
    qtbot.keyClick(table, Qt.Key.Key_F2)
    line = table.findChild(QLineEdit)
    line.selectAll()
    qtbot.keyClicks(line, text)
    qtbot.keyClick(line, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: table.item(row, column).text() == text)


def test_a_cell_is_typed_and_saved_and_nothing_else_changes(window: TemplateWindow, qtbot: QtBot, folder: Path) -> None:
    before = (folder / "treasures.yaml").read_text()
    typed_into(window, qtbot, "Treasures", 1, 1, "25")
    assert window.save()
    assert (folder / "treasures.yaml").read_text() == before.replace(
        "{name: paint tin, points: 20,", "{name: paint tin, points: 25,"
    )


def test_a_value_is_chosen_by_keys_from_those_that_were_declared(
    window: TemplateWindow, qtbot: QtBot, folder: Path
) -> None:
    table = window.sheets["Treasures"].table
    table.setCurrentCell(0, 6)
    table.setFocus()
    qtbot.keyClick(table, Qt.Key.Key_F2)
    box = table.findChild(ChoiceBox)
    assert [box.itemText(index) for index in range(box.count())] == ["wood", "metal", "ceramic"]
    qtbot.keyClick(box, Qt.Key.Key_Down)
    qtbot.keyClick(box, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: "weight: light, material: metal" in window.texts()["treasures.yaml"].splitlines()[9])


def test_a_property_is_renamed_in_treasures_and_sentences_and_one_step_takes_it_back(
    window: TemplateWindow, qtbot: QtBot
) -> None:
    before = window.texts()
    typed_into(window, qtbot, "Properties", 2, 0, "mass")
    after = window.texts()
    assert "weight" not in after["treasures.yaml"].partition("properties:")[2]
    assert "£mass£" in after["DialogueText"]
    assert "£weight£" not in after["DialogueText"]
    assert "£mass£" in after["de/DialogueText"] and "name: mass, label: Gewicht" in after["de/words.yaml"]
    qtbot.waitUntil(lambda: window.draft is not None and window.draft.texts == after)
    assert window.draft is not None
    assert window.draft.faults == ()
    append(window, "DialogueText", "More?\n")
    page = window.pages["DialogueText"]
    window.tabs.setCurrentWidget(page)
    page.setFocus()
    qtbot.keyClick(page, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert window.texts() == after
    qtbot.keyClick(page, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert window.texts() == before
    assert window.changed() == []
    both = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
    qtbot.keyClick(page, Qt.Key.Key_Z, both)
    assert window.texts() == after


def test_rows_are_added_copied_and_removed(window: TemplateWindow, qtbot: QtBot) -> None:
    before, page = window.texts(), window.sheets["Treasures"]
    page.table.setCurrentCell(7, 0)
    qtbot.mouseClick(page.copy, Qt.MouseButton.LeftButton)
    assert page.table.item(8, 0).text() == "floor vase 2"
    assert page.table.currentRow() == 8
    qtbot.mouseClick(page.add, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: window.draft is not None and window.draft.texts == window.texts())
    assert window.draft is not None
    assert window.draft.faults == ()
    for _ in range(2):
        page.table.setCurrentCell(8, 0)
        qtbot.mouseClick(page.remove, Qt.MouseButton.LeftButton)
    assert window.texts() == before


def test_a_wrong_cell_is_marked_and_its_fault_leads_to_it(window: TemplateWindow, qtbot: QtBot) -> None:
    page = window.sheets["Treasures"]
    typed_into(window, qtbot, "Treasures", 3, 1, "many")
    qtbot.waitUntil(lambda: "many" in page.table.item(3, 1).toolTip())
    page.table.setCurrentCell(0, 0)
    qtbot.keyClick(window, Qt.Key.Key_F8)
    assert (page.table.currentRow(), page.table.currentColumn()) == (3, 1)
    typed_into(window, qtbot, "Treasures", 3, 1, "30")
    qtbot.waitUntil(lambda: page.table.item(3, 1).toolTip() == "")


def test_a_list_of_2016_is_a_sheet_too_and_its_copy_stays_alike(qtbot: QtBot, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(SHIPPED / "original-2016", tmp_path / "old"))
    window = open_templates(qtbot, folder)
    qtbot.addWidget(window)
    assert list(window.sheets) == ["Treasures"]
    typed_into(window, qtbot, "Treasures", 0, 3, "Amber Bottle")
    assert window.save()
    for name in ("treasures", "treasures.participant"):
        was = (SHIPPED / "original-2016" / name).read_bytes()
        assert (folder / name).read_bytes() == was.replace(b"Orange Bottle", b"Amber Bottle")
        assert was != (folder / name).read_bytes()


def test_files_and_pictures_that_others_wrote_are_asked_about_at_once(
    window: TemplateWindow, qtbot: QtBot, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    picture = folder / "pictures" / "toy_block.jpg"
    other = SHIPPED / "practice" / "pictures" / "green_can.jpg"
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(other), ""))
    window.pictures.setCurrentRow(0)
    qtbot.keyClick(window.pictures, Qt.Key.Key_Return)
    append(window, "DialogueText", "More?\n")
    typed_into(window, qtbot, "Treasures", 0, 1, "40")
    theirs = {folder / "DialogueText": b"Theirs\nSpecificRoom:\n", folder / "treasures.yaml": b"{}", picture: b"jpg"}
    for path, data in theirs.items():
        path.write_bytes(data)
    asked: list[str] = []
    monkeypatch.setattr(window, "_asked", lambda words, _yes: asked.append(words))
    assert not window.save()
    assert len(asked) == 1
    for path, data in theirs.items():
        assert path.name in asked[0]
        assert path.read_bytes() == data


def test_what_saving_would_change_is_shown(window: TemplateWindow, qtbot: QtBot) -> None:
    typed_into(window, qtbot, "Treasures", 1, 1, "25")
    told = window.changes.view.toPlainText()
    assert "+  - {name: paint tin, points: 25," in told
    assert len([line for line in told.splitlines() if line.startswith("+")]) == 2


def test_columns_follow_the_size_of_text(window: TemplateWindow, qapp: QApplication) -> None:
    table = window.sheets["Treasures"].table
    before = table.columnWidth(0)
    look.apply_text_size(qapp, 2.0)
    try:
        settle()
        assert table.columnWidth(0) > 1.5 * before
    finally:
        look.apply_text_size(qapp, 1.0)


def test_everything_has_a_name_and_tab_goes_as_the_eye_does(window: TemplateWindow) -> None:
    assert nameless(window) == []
    assert len(stops(window)) > 6
    assert against_the_eye(stops(window), window) == []


@pytest.mark.parametrize("text", TEXTS)
def test_nothing_is_cut_off_or_covered(window: TemplateWindow, qtbot: QtBot, qapp: QApplication, text: float) -> None:
    append(window, "DialogueText", "Is it £wieght£?\n")
    qtbot.waitUntil(lambda: window.faults.list.count() == 1)
    look.apply_text_size(qapp, text)
    try:
        for size in SIZES:
            window.resize(*size)
            settle()
            assert window.size().toTuple() == size, "nothing makes it larger"
            assert misfits(window) == [], size
    finally:
        look.apply_text_size(qapp, 1.0)
