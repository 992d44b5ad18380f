"""Dialog to choose a key for a section, with a search field above a list."""

from collections.abc import Mapping

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLineEdit, QListWidget, QListWidgetItem, QVBoxLayout, QWidget

from ui.model.study_form.draft import keys_like
from ui.model.study_form.form import FormField
from ui.windows.look import GAP, follow_text, label, px, spaced
from ui.windows.untrusted_text import shown

_TO_LIST = frozenset({Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_PageUp, Qt.Key.Key_PageDown})
"""Keys that move the selection in the list while the search field has the focus."""


class KeyChooser(QDialog):
    """Dialog to choose the key that is added to a section with freely chosen keys.

    Args:
        title: name of the section.
        keys: keys that can be added, each with its field.
        parent: the window.
        own_names: True if the person may also type another name.

    Attributes:
        chosen: chosen key, or other name that the person typed; empty until the person has chosen.
    """

    def __init__(self, title: str, keys: Mapping[str, FormField], parent: QWidget | None, *, own_names: bool) -> None:
        super().__init__(parent)
        self.setWindowTitle("Add a key")
        self.chosen = ""
        self._keys = keys
        self._allows_own_names = own_names
        self.search = QLineEdit(placeholderText="Find a key by its name or meaning", clearButtonEnabled=True)
        self.search.setAccessibleName("Find a key by its name or meaning")
        self.search.textChanged.connect(self._find)
        self.search.installEventFilter(self)
        self.list = QListWidget()
        self.list.setAccessibleName("Keys")
        self.list.setWordWrap(True)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.itemActivated.connect(self.accept)
        self.list.currentRowChanged.connect(self._allow)
        self.words = label("", "small", muted=True)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.add = buttons.addButton("Add", QDialogButtonBox.ButtonRole.AcceptRole)
        self.own = buttons.addButton("", QDialogButtonBox.ButtonRole.ActionRole)
        self.own.clicked.connect(self._choose_own)
        self.own.setVisible(False)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = spaced(QVBoxLayout(self), GAP, 2 * GAP)
        for part in (label(title, bold=True), self.search, self.list, self.words, buttons):
            column.addWidget(part, part is self.list)
        follow_text(self, lambda it: it.resize(px(520), px(460)))
        self._find("")

    def accept(self) -> None:
        """Choose the key that is selected in the list."""
        item = self.list.currentItem()
        if item is not None:
            self.chosen = item.data(Qt.ItemDataRole.UserRole)
            super().accept()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Let arrow keys move the selection in the list while the search field has the focus."""
        if event.type() == QEvent.Type.KeyPress and isinstance(event, QKeyEvent) and event.key() in _TO_LIST:
            self.list.keyPressEvent(event)
            return True
        return super().eventFilter(watched, event)

    def _find(self, words: str) -> None:
        self.list.clear()
        found = keys_like(words, self._keys)
        for field in found:
            item = QListWidgetItem(shown(f"{field.key}\n{field.help}"))
            item.setData(Qt.ItemDataRole.UserRole, field.key)
            self.list.addItem(item)
        name = _plain(words)
        is_similar = bool(found) and not any(name.lower() in field.key for field in found)
        self.words.setText(
            "No key matches."
            if not found
            else "No key has this name. The most similar keys are listed."
            if name and is_similar
            else f"{len(found)} keys"
        )
        # Only a factor may have a name that is not a key. Each level of this factor then sets several keys.
        self.own.setVisible(self._allows_own_names and bool(name) and all(field.key != name for field in found))
        self.own.setText(f"Use \u201c{shown(name)}\u201d as a factor whose levels set several keys")
        self.list.setCurrentRow(0 if found else -1)
        self._allow(self.list.currentRow())

    def _allow(self, row: int) -> None:
        self.add.setEnabled(row >= 0)
        self.add.setDefault(row >= 0)

    def _choose_own(self) -> None:
        self.chosen = _plain(self.search.text())
        super().accept()


def _plain(words: str) -> str:
    """Return a name without spaces at its ends, and without quotes, which the file does not allow in names."""
    return words.strip().replace('"', "")
