import shutil
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QImage, QTextCursor
from PySide6.QtWidgets import QApplication, QComboBox, QFileDialog, QLineEdit, QPushButton, QSlider, QWidget
from pytestqt.qtbot import QtBot

from tests.support.windows.questions import answering
from tests.support.windows.screen_reader import against_the_eye, nameless, stops
from tests.support.windows.study_windows import leave_study, open_study, retype, settled
from tests.ui.windows.study.conftest import TEXT
from ui.model.shared.theme import DARK, LIGHT
from ui.windows.look import apply_palette
from ui.windows.study import StudyWindow
from ui.windows.study.resource_list import ResourceList


def test_a_value_typed_is_saved_and_no_other_byte_moves(qtbot: QtBot, window: StudyWindow, file: Path) -> None:
    assert window.isWindowModified() is False
    retype(qtbot, window, "game.energy", "120")
    assert window.editor.history.text == TEXT.replace("90", "120")
    assert file.read_text() == TEXT
    assert window.isWindowModified()
    with qtbot.waitSignal(window.editor.saved):
        qtbot.keyClick(window, Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)
    assert file.read_text() == TEXT.replace("90", "120")
    assert window.isWindowModified() is False


def test_a_fault_appears_at_its_field_and_goes_again(qtbot: QtBot, window: StudyWindow) -> None:
    retype(qtbot, window, "game.energy", "-3")
    row = window.fields.rows["game.energy"]
    assert any("out of range" in label.text() for label in row.findChildren(QWidget) if hasattr(label, "text"))
    assert window.faults.list.count() == 1
    assert "⚠ 1" in texts_of(window)
    retype(qtbot, window, "game.energy", "3")
    assert window.faults.list.count() == 0


def texts_of(window: StudyWindow) -> str:
    return " ".join(window.sections.topLevelItem(index).text(0) for index in range(window.sections.topLevelItemCount()))


def test_a_faulty_study_is_saved_only_when_that_is_meant(qtbot: QtBot, window: StudyWindow, file: Path) -> None:
    retype(qtbot, window, "game.energy", "-3")
    with answering("Cancel"), qtbot.waitSignal(window.editor.found_faulty):
        window.save()
    qtbot.waitUntil(lambda: QApplication.activeModalWidget() is None)
    assert file.read_text() == TEXT
    with answering("Save anyway"), qtbot.waitSignal(window.editor.saved):
        window.save()
    assert "energy: -3" in file.read_text()


def test_reset_takes_the_key_out_of_the_file(qtbot: QtBot, window: StudyWindow) -> None:
    window.open_field("robots")
    button = window.fields.rows["robots"].findChild(QPushButton)
    assert button.accessibleName() == "Reset Robots"

    def can_be_clicked() -> bool:
        # The screen of tests is narrower than the form, which is being laid out: scroll there, until it is.
        window.fields.ensureWidgetVisible(button)
        return window.childAt(button.mapTo(window, button.rect().center())) is button

    qtbot.waitUntil(can_be_clicked)
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
    settled(qtbot, window)
    assert window.editor.history.text == TEXT.replace("robots: 4   # two pairs", "# two pairs")
    assert button.isVisible() is False
    assert window.fields.rows["robots"].text() == "2"


def test_undo_and_redo(qtbot: QtBot, window: StudyWindow) -> None:
    retype(qtbot, window, "game.energy", "120")
    window.sections.setFocus()
    settled(qtbot, window)
    qtbot.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    settled(qtbot, window)
    assert window.editor.history.text == TEXT
    assert window.fields.rows["game.energy"].text() == "90"
    qtbot.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier)
    settled(qtbot, window)
    assert "120" in window.editor.history.text


def test_a_choice_by_keyboard(qtbot: QtBot, window: StudyWindow) -> None:
    window.open_field("robot.localization")
    combo = QApplication.focusWidget()
    assert isinstance(combo, QComboBox)
    qtbot.keyClick(combo, Qt.Key.Key_Down)
    settled(qtbot, window)
    assert window.editor.history.text == TEXT + "robot:\n  localization: ekf\n"


def test_a_noise_value_redraws_what_it_does(qtbot: QtBot, window: StudyWindow) -> None:
    window.open_section("noise")
    qtbot.waitUntil(lambda: window.noise.drawn > 0)
    before = picture(window)
    drawn = window.noise.drawn
    window.noise_fields.finish()
    slider = window.noise_fields.rows["noise.odometry.alpha2"].findChild(QSlider)
    qtbot.keyClick(slider, Qt.Key.Key_PageUp)
    qtbot.waitUntil(lambda: window.noise.drawn > drawn)
    assert picture(window) != before
    settled(qtbot, window)
    assert "alpha2:" in window.editor.history.text


def picture(window: StudyWindow) -> QImage:
    return window.noise.grab().toImage()


def test_search_finds_and_edits(qtbot: QtBot, window: StudyWindow) -> None:
    qtbot.keyClick(window, Qt.Key.Key_F, Qt.KeyboardModifier.ControlModifier)
    qtbot.keyClicks(window.search, "kld_err")
    assert next(iter(window.found.rows)) == "robot.amcl.kld_err"
    line = window.found.rows["robot.amcl.kld_err"].editor
    assert isinstance(line, QLineEdit)
    line.setFocus()
    line.selectAll()
    qtbot.keyClicks(line, "0.02")
    settled(qtbot, window)
    assert "kld_err: 0.02" in window.editor.history.text


def test_things_are_added_and_removed(qtbot: QtBot, window: StudyWindow) -> None:
    window.open_section("things")
    press(qtbot, window, "Add to Things")
    settled(qtbot, window)
    assert window.editor.draft.study is not None
    assert len(window.editor.draft.study.things) == 1
    press(qtbot, window, "Remove")
    settled(qtbot, window)
    assert window.editor.history.text == TEXT


def press(qtbot: QtBot, window: StudyWindow, words: str) -> None:
    window.fields.finish()
    button = next(button for button in window.fields.findChildren(QPushButton) if button.text() == words)
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)


def test_changes_show_what_will_be_written(qtbot: QtBot, window: StudyWindow) -> None:
    retype(qtbot, window, "game.energy", "120")
    qtbot.keyClick(window, Qt.Key.Key_D, Qt.KeyboardModifier.ControlModifier)
    assert "-  energy: 90  # enough\n+  energy: 120  # enough" in window.changes.view.toPlainText()


def test_a_file_changed_by_others_is_noticed_and_not_written_over(
    qtbot: QtBot, window: StudyWindow, file: Path
) -> None:
    retype(qtbot, window, "game.energy", "120")
    file.write_text("robots: 3\n")
    with answering("Cancel"), qtbot.waitSignal(window.editor.conflicted):
        window.save()
    assert file.read_text() == "robots: 3\n"
    banner = next(button for button in window.findChildren(QPushButton) if button.text() == "Load the new version")
    qtbot.waitUntil(banner.isVisible)
    qtbot.mouseClick(banner, Qt.MouseButton.LeftButton)
    settled(qtbot, window)
    assert window.editor.history.text == "robots: 3\n"
    assert window.isWindowModified() is False


def test_typing_in_the_text_leaves_other_lines_to_the_byte(qtbot: QtBot, tmp_path: Path) -> None:
    path = tmp_path / "mixed.yaml"
    path.write_text("# kept\u00a0together\r\nrobots: 4\n", encoding="utf-8", newline="")
    window = open_study(qtbot, path)
    window.show_text()
    page = window.text.editor
    page.moveCursor(QTextCursor.MoveOperation.End)
    qtbot.keyClicks(page, "seed: 3")
    qtbot.waitUntil(lambda: window.editor.settled and window.editor.dirty)
    assert window.editor.draft.text == "# kept\u00a0together\r\nrobots: 4\nseed: 3"
    leave_study(window)


def test_a_file_that_is_no_yaml_opens_as_text(qtbot: QtBot, tmp_path: Path) -> None:
    path = tmp_path / "broken.yaml"
    path.write_text("robots: 2\ngame: {\n")
    window = open_study(qtbot, path)
    assert window.text.isVisible()
    assert window.editor.draft.faults[0].line is not None
    window.text.editor.setPlainText("robots: 3\n")
    settled(qtbot, window)
    assert window.editor.draft.study is not None
    window.open_section("")
    assert window.fields.rows["robots"].text() == "3"
    leave_study(window)


def test_a_new_file_is_made_when_it_is_saved(qtbot: QtBot, tmp_path: Path) -> None:
    path = tmp_path / "new.yaml"
    window = open_study(qtbot, path)
    retype(qtbot, window, "robots", "3")
    assert not path.exists()
    with qtbot.waitSignal(window.editor.saved):
        window.save()
    assert path.read_text().startswith("# A study.")
    assert path.read_text().endswith("robots: 3\n")
    leave_study(window)


@pytest.mark.parametrize("section", ["game", "noise", "participant", "robot"])
def test_everything_has_a_name_and_tab_goes_as_the_eye_does(qtbot: QtBot, window: StudyWindow, section: str) -> None:
    window.resize(1240, 860)
    window.open_section(section)
    for page in (window.fields, window.noise_fields):
        page.finish()
    QApplication.processEvents()
    assert nameless(window) == []
    assert len(stops(window)) > 6
    assert against_the_eye(stops(window), window) == []


def test_closing_asks_and_saves(qtbot: QtBot, window: StudyWindow, file: Path) -> None:
    retype(qtbot, window, "game.energy", "120")
    with answering("Save"):
        window.close()
        qtbot.waitUntil(lambda: not window.isVisible())
    assert file.read_text() == TEXT.replace("90", "120")


def test_tab_follows_the_eye(qtbot: QtBot, window: StudyWindow) -> None:
    window.open_section("game")
    window.fields.finish()
    editors = [row.editor for row in window.fields.rows.values()]
    qtbot.waitUntil(lambda: all(editor.isVisible() for editor in editors))
    stops: list[QWidget] = []
    at: QWidget | None = window.search
    while at is not None and at not in stops:
        if at.focusPolicy() & Qt.FocusPolicy.TabFocus and at.isVisible() and at.isEnabled():
            stops.append(at)
        at = at.nextInFocusChain()
    wanted = [window.search, window.sections, *editors]
    places = [stops.index(stop) for stop in wanted]
    assert places == sorted(places)
    assert [stop.text() for stop in stops[1:4] if isinstance(stop, QPushButton)] == ["Form", "Text", "Changes"]


def test_a_section_goes_back_to_its_defaults(qtbot: QtBot, window: StudyWindow) -> None:
    window.open_section("game")
    press(qtbot, window, "Reset all")
    settled(qtbot, window)
    assert window.editor.history.text == "# our pilot\nrobots: 4   # two pairs\n  # enough\n"


def test_light_and_dark_differ(qtbot: QtBot, qapp: QApplication, window: StudyWindow) -> None:
    light = window.grab().toImage().pixelColor(5, 5)
    apply_palette(qapp, DARK)
    window.repaint_all()
    assert window.grab().toImage().pixelColor(5, 5) != light
    apply_palette(qapp, LIGHT)


def test_a_map_is_chosen_from_a_list_with_a_look_at_it(window: StudyWindow, qtbot: QtBot, file: Path) -> None:
    window.open_field("map")
    row = window.fields.rows["map"]
    qtbot.keyClick(row.editor, Qt.Key.Key_Down)
    shown = next(each for each in QApplication.topLevelWidgets() if isinstance(each, ResourceList) and each.isVisible())
    entries = [shown.list.item(number) for number in range(shown.list.count())]
    office = next(entry for entry in entries if entry.text().startswith("office\n"))
    assert " rooms, " in office.text() and " start poses" in office.text()
    assert not office.icon().isNull()
    shown.list.setCurrentItem(office)
    qtbot.keyClick(shown.list, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: window.editor.draft.study is not None and window.editor.draft.study.map == "office")
    window.save()
    qtbot.waitUntil(lambda: "map: office" in file.read_text())


def test_files_of_ros_beside_the_study_are_offered_and_other_yaml_is_not(
    window: StudyWindow, qtbot: QtBot, file: Path
) -> None:
    (file.parent / "amcl.yaml").write_text("amcl: {max_particles: 300}\n")
    (file.parent / "broken.yaml").write_text("amcl: [\n")
    window.open_field("ros_parameters")
    qtbot.keyClick(window.fields.rows["ros_parameters"].editor, Qt.Key.Key_Down)
    shown = next(each for each in QApplication.topLevelWidgets() if isinstance(each, ResourceList) and each.isVisible())
    assert [shown.list.item(row).text() for row in range(shown.list.count())] == [
        "[amcl.yaml]\nparameters of ROS nodes"
    ]
    qtbot.keyClick(shown.list, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: "ros_parameters: [amcl.yaml]" in window.editor.draft.text)
    study = window.editor.draft.study
    assert study is not None
    assert study.robot.amcl.max_particles == 300


def test_a_language_of_the_studys_own_words_is_chosen_from_a_list_and_no_file_is(
    window: StudyWindow, qtbot: QtBot, file: Path
) -> None:
    (file.parent / "words" / "nl").mkdir(parents=True)
    (file.parent / "words" / "nl" / "dutch.yaml").write_text("language: {title: Nederlands, falls_back_on: en}\n")
    for key, entry in (
        ("dialogue.words", "./words\nnl: Nederlands"),
        ("dialogue.language", "nl\nNederlands, with words from the folder words"),
    ):
        window.open_field(key)
        qtbot.keyClick(window.fields.rows[key].editor, Qt.Key.Key_Down)
        shown = next(
            each for each in QApplication.topLevelWidgets() if isinstance(each, ResourceList) and each.isVisible()
        )
        assert shown.other.isVisible() == (key == "dialogue.words")
        (item,) = (
            found for row in range(shown.list.count()) if (found := shown.list.item(row)).text().startswith(entry)
        )
        shown.list.setCurrentItem(item)
        qtbot.keyClick(shown.list, Qt.Key.Key_Return)
        qtbot.waitUntil(lambda key=key: window.editor.draft.fields()[key].written is not None)
        settled(qtbot, window)
    study = window.editor.draft.study
    assert study is not None
    assert (study.dialogue.words, study.dialogue.language) == (Path("words"), "nl")


def test_a_list_that_would_leave_the_screen_opens_above_its_field(window: StudyWindow, qtbot: QtBot) -> None:
    window.open_field("dialogue.author")
    editor = window.fields.rows["dialogue.author"].editor
    edge = window.screen().availableGeometry().bottom()
    for lower in (-300, 0):
        window.move(0, window.y() + edge - editor.mapToGlobal(editor.rect().bottomLeft()).y() + lower)
        qtbot.keyClick(editor, Qt.Key.Key_Down)
        shown = next(
            each for each in QApplication.topLevelWidgets() if isinstance(each, ResourceList) and each.isVisible()
        )
        top = editor.mapToGlobal(editor.rect().topLeft()).y()
        assert (shown.y() > top) == (lower < 0)
        assert shown.geometry().bottom() <= edge
        qtbot.keyClick(shown, Qt.Key.Key_Escape)


def test_where_no_program_is_installed_the_list_says_so(window: StudyWindow, qtbot: QtBot) -> None:
    window.open_field("dialogue.author")
    qtbot.keyClick(window.fields.rows["dialogue.author"].editor, Qt.Key.Key_Down)
    shown = next(each for each in QApplication.topLevelWidgets() if isinstance(each, ResourceList) and each.isVisible())
    assert [shown.list.item(row).text() for row in range(shown.list.count())] == ["None installed"]
    qtbot.keyClick(shown.list, Qt.Key.Key_Return)
    assert window.editor.draft.fields()["dialogue.author"].written is None
    qtbot.keyClick(shown, Qt.Key.Key_Escape)


def test_another_folder_is_written_from_that_of_the_study(
    window: StudyWindow, qtbot: QtBot, file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(Path(__file__).parents[4] / "templates" / "practice", file.parent / "mine")
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(file.parent / "mine"))
    window.open_field("templates")
    qtbot.keyClick(window.fields.rows["templates"].editor, Qt.Key.Key_Down)
    shown = next(each for each in QApplication.topLevelWidgets() if isinstance(each, ResourceList) and each.isVisible())
    assert "./mine\n" in "".join(shown.list.item(number).text() for number in range(shown.list.count()))
    qtbot.mouseClick(shown.other, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: window.editor.draft.study is not None and window.editor.draft.study.templates == "./mine")
