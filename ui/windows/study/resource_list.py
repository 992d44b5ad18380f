"""List of the maps, template sets, files, words or programs that a field can name, with previews."""

from pathlib import Path

from PySide6.QtCore import QPoint, QSize, Qt, Signal
from PySide6.QtGui import QIcon, QKeyEvent, QPixmap
from PySide6.QtWidgets import QFileDialog, QListWidget, QListWidgetItem, QPushButton, QVBoxLayout, QWidget

from ui.model.study_form.resources import NamedResource, is_path
from ui.windows.look import GAP, px, spaced, style_as_panel
from ui.windows.untrusted_text import shown

_LOOK = QSize(96, 64)
"""Size of the picture next to a name, `px`."""
_LINES = 40
"""Height of an entry without a picture, `px`."""
_FOLDERS = frozenset({"map", "templates", "dialogue.games", "dialogue.words"})
"""Fields that name folders."""
_LISTS = frozenset({"ros_parameters"})
"""Fields that name several files."""


class ResourceList(QWidget):
    """List that opens below a field and closes after a choice.

    Signals:
        chosen: a person chose this value for the study.

    Args:
        key: key of the field.
        resources: resources that the field can name.
        study_folder: folder of the study, to which paths are relative.
        parent: editor of the field.
    """

    chosen = Signal(str)

    def __init__(self, key: str, resources: tuple[NamedResource, ...], study_folder: Path, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Popup)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        style_as_panel(self)
        self._key, self._study_folder = key, study_folder
        self.list = QListWidget()
        self.list.setAccessibleName("Choices for the field")
        self.list.setIconSize(QSize(px(_LOOK.width()), px(_LOOK.height())))
        self.list.setWordWrap(True)
        for each in resources:
            item = QListWidgetItem(shown(f"{each.value}\n{each.words}"))
            item.setData(Qt.ItemDataRole.UserRole, each.value)
            if each.picture is not None:
                item.setIcon(QIcon(QPixmap(str(each.picture))))
            self.list.addItem(item)
        if not resources and not is_path(key):
            self.list.addItem(QListWidgetItem("None installed"))
            self.list.item(0).setFlags(Qt.ItemFlag.NoItemFlags)
        self.list.itemClicked.connect(self._choose)
        self.list.itemActivated.connect(self._choose)
        self.other = QPushButton("Browse …")
        self.other.clicked.connect(self._browse)
        self.other.setVisible(is_path(key))
        column = spaced(QVBoxLayout(self), GAP, GAP)
        column.addWidget(self.list)
        column.addWidget(self.other)
        height = _LOOK.height() if any(each.picture for each in resources) else _LINES
        self.resize(px(380), px(min(4, max(1, len(resources))) * (height + 12) + (60 if is_path(key) else 20)))

    def open_below(self, editor: QWidget) -> None:
        """Show the list below a widget, or above it if there is no space below; give the list the focus."""
        below, above = editor.mapToGlobal(QPoint(0, editor.height())), editor.mapToGlobal(QPoint(0, -self.height()))
        fits = below.y() + self.height() <= editor.screen().availableGeometry().bottom()
        self.move(below if fits else above)
        self.show()
        self.list.setCurrentRow(0)
        (self.list if self.list.count() else self.other).setFocus()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Close the list if Esc is pressed."""
        if event.key() == Qt.Key.Key_Escape:
            self.close()
        else:
            super().keyPressEvent(event)

    def _choose(self, item: QListWidgetItem) -> None:
        value: str = item.data(Qt.ItemDataRole.UserRole)
        self.close()
        self.chosen.emit(value)

    def _browse(self) -> None:
        here, start = self.parentWidget(), str(self._study_folder)
        self.hide()
        if self._key in _FOLDERS:
            picked = QFileDialog.getExistingDirectory(here, "Choose a folder", start)
        else:
            picked, _ = QFileDialog.getOpenFileName(here, "Choose a file", start)
        if picked:
            written = _as_written(Path(picked), self._study_folder, folder=self._key in _FOLDERS)
            self.chosen.emit(f"[{written}]" if self._key in _LISTS else written)
        self.close()


def _as_written(path: Path, study_folder: Path, *, folder: bool) -> str:
    """Return a path in the form for a study file.

    A path in the study's folder becomes relative, and a folder then starts with `./`.
    """
    if not path.resolve().is_relative_to(study_folder.resolve()):
        return str(path)
    inside = path.resolve().relative_to(study_folder.resolve())
    return f"./{inside}" if folder else str(inside)
