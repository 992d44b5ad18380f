"""Window with a study file as a form, and window with template sets as sheets."""

import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit, QTableWidget

from pictured.shot import Shot, Story
from thbridge.files.resources import shipped
from ui.windows.study import study_window
from ui.windows.study.resource_list import ResourceList
from ui.windows.study.window import StudyWindow
from ui.windows.templates.window import TemplateWindow

SIZE = (1240, 860)
TEXT = """\
# our pilot
robots: 4   # two pairs
game:
  energy: 90  # enough for six rooms
noise:
  preset: bad wheels
"""


def edited() -> Iterator[Shot]:
    """Yield a small study file in the editor: a section, the noise, a fault, and the unsaved changes."""
    # The window shows the folder's path, so use the same folder each time.
    folder = Path(tempfile.gettempdir()) / "studies"
    folder.mkdir(exist_ok=True)
    file = folder / "pilot.yaml"
    file.write_text(TEXT, encoding="utf-8")
    window = study_window(file)
    window.resize(*SIZE)
    window.show()
    window.open_section("game")
    yield shot("study-section", window)
    window.open_section("noise")
    yield shot("study-noise", window)
    window.search.setText("pdist_scale")
    yield shot("study-search", window)
    window.search.clear()
    window.open_field("map")
    window.fields.rows["map"].open_list()
    shown = window.fields.rows["map"].findChild(ResourceList)
    if shown is not None:
        # On an invisible screen, no window has the focus, and lists close without a key press.
        shown.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose, False)
    yield Shot("study-list", window, lambda _: window.repaint_all(), over=shown)
    if shown is not None:
        shown.deleteLater()
    _type(window, "game.energy", "-3")
    yield shot("study-fault", window)
    _type(window, "game.energy", "120")
    _type(window, "game.picture_cost", "2")
    window.show_changes()
    yield shot("study-changes", window)
    window.show_text()
    yield shot("study-text", window)
    window.editor.load_again()
    _wait(lambda: window.editor.settled)
    window.close()
    shutil.rmtree(folder)


def templates() -> Iterator[Shot]:
    """Yield a template set in the editor: its sheets, a cell with a fault, and the changes that saving would write."""
    folder = Path(tempfile.gettempdir()) / "finds"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(shipped().root / "templates" / "four-properties", folder)
    window = TemplateWindow(folder)
    window.resize(*SIZE)
    window.show()
    _wait(lambda: window.draft is not None)
    sheet, properties = window.sheets["Treasures"].table, window.sheets["Properties"].table
    sheet.setCurrentCell(2, 0)
    yield Shot("templates-treasures", window)
    window.tabs.setCurrentWidget(window.sheets["Properties"])
    properties.setCurrentCell(2, 7)
    yield Shot("templates-properties", window)
    window.tabs.setCurrentWidget(window.sheets["Treasures"])
    sheet.setCurrentCell(4, 3)
    _write(sheet, 4, 3, "gren")
    _wait(lambda: bool(window.draft is not None and window.draft.faults))
    yield Shot("templates-fault", window)
    _write(sheet, 4, 3, "green")
    _write(sheet, 5, 1, "25")
    _wait(lambda: bool(window.draft is not None and not window.draft.faults))
    window.tabs.setCurrentWidget(window.changes)
    yield Shot("templates-changes", window)
    while window.changed():
        window.undo()
    window.close()
    shutil.rmtree(folder)


def shot(name: str, window: StudyWindow) -> Shot:
    """Return a picture of the window."""
    return Shot(
        name,
        window,
        lambda _: window.repaint_all(),
        settled=lambda: window.editor.settled and not window.noise.busy,
    )


def _write(sheet: QTableWidget, row: int, column: int, text: str) -> None:
    sheet.model().setData(sheet.model().index(row, column), text)


def _type(window: StudyWindow, key: str, text: str) -> None:
    """Type into a field like a person."""
    window.open_field(key)
    line = window.fields.rows[key].findChild(QLineEdit)
    if line is not None:
        line.selectAll()
        QTest.keyClicks(line, text)
    _wait(lambda: window.editor.settled)


def _wait(holds: Callable[[], bool]) -> None:
    while not holds():
        QApplication.processEvents()


STORIES = (
    Story(
        "The admin: a study file",
        {
            "study-section": "A section of the form",
            "study-noise": "Settings of the noise, and their effect",
            "study-search": "A search by the old ROS name of a setting",
            "study-list": "Maps to choose from, each with a preview",
            "study-fault": "A fault, shown at its field and in the list of faults",
            "study-changes": "Changes that saving the file would make",
            "study-text": "The file as text",
        },
        edited,
    ),
    Story(
        "The admin: a template set",
        {
            "templates-treasures": "Treasures as a sheet, with sentences and pictures",
            "templates-properties": "Properties as a sheet",
            "templates-fault": "A fault, shown at its cell and in the list of faults",
            "templates-changes": "Changes that saving the file would make",
        },
        templates,
    ),
)
