"""Dialog *Open*, for a recording, a folder with a recording, or the address of a running session."""

from collections.abc import Callable
from pathlib import Path

from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QHBoxLayout,
    QLineEdit,
    QListWidget,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from ui.windows.look import GAP, follow_text, label, px, spaced
from ui.windows.untrusted_text import shown

RECORDINGS = "Recordings (*.bag *.mcap *.db3 *.active);;All files (*)"


class OpenDialog(QDialog):
    """Dialog that asks for a source and opens it. If that fails, the dialog stays open and shows the reason.

    Args:
        recent: previously opened paths and addresses, the latest first.
        open_source: function that opens a path or an address with a key file. If that fails, it returns the reason,
            otherwise an empty text.
        parent: window that opens the dialog. If None, there is no window.

    Attributes:
        source: field for a path or an address.
        key: field for a key file.
        recent: list of recently opened sources.
        fault: reason why the source could not be opened.
    """

    def __init__(
        self, recent: list[str], open_source: Callable[[str, Path | None], str], parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._open_source = open_source
        self.setWindowTitle("Open - thbridge watch" if parent is None else "Open")
        self.source = QLineEdit()
        self.source.setPlaceholderText("hunt.bag, a folder, or 127.0.0.1:6010")
        self.source.setAccessibleName("Recording, or address of a running session")
        self.key = QLineEdit()
        self.key.setPlaceholderText("needed only if the session requires a key")
        self.key.setAccessibleName("Key file")
        self.recent = QListWidget()
        self.recent.setAccessibleName("Recently opened")
        self.recent.addItems([shown(source) for source in recent])
        self._sources = recent
        self.recent.currentRowChanged.connect(lambda row: self.source.setText(self._sources[row]))
        self.recent.itemActivated.connect(lambda _: self._open())
        self.fault = label()
        self.fault.hide()
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.agree = buttons.addButton("Open", QDialogButtonBox.ButtonRole.AcceptRole)
        self.agree.setDefault(True)
        self.agree.setEnabled(False)
        self.source.textChanged.connect(lambda text: self.agree.setEnabled(bool(text.strip())))
        buttons.accepted.connect(self._open)
        buttons.rejected.connect(self.reject)
        column = spaced(QVBoxLayout(self), GAP, 2 * GAP)
        column.addWidget(label("Recording (a bag of ROS 1 or ROS 2, MCAP), or address of a running session:"))
        column.addLayout(_row(self.source, ("File…", self._browse_file), ("Folder…", self._browse_folder)))
        column.addWidget(label("Key file:"))
        column.addLayout(_row(self.key, ("Key…", self._browse_key)))
        if recent:
            column.addWidget(label("Recently opened:"))
        column.addWidget(self.recent, 1)
        self.recent.setVisible(bool(recent))
        column.addWidget(self.fault)
        column.addStretch()
        column.addWidget(buttons)
        follow_text(self, lambda it: it.resize(px(640), it.sizeHint().height()))

    def _open(self) -> None:
        key = self.key.text().strip()
        problem = self._open_source(self.source.text().strip(), Path(key) if key else None)
        if not problem:
            self.accept()
            return
        self.fault.setText(problem)
        self.fault.show()

    def _browse_file(self) -> None:
        chosen, _ = QFileDialog.getOpenFileName(self, "Open a recording", self._folder(), RECORDINGS)
        if chosen:
            self.source.setText(chosen)

    def _browse_folder(self) -> None:
        chosen = QFileDialog.getExistingDirectory(self, "Open a recording of ROS 2 (a folder)", self._folder())
        if chosen:
            self.source.setText(chosen)

    def _browse_key(self) -> None:
        chosen, _ = QFileDialog.getOpenFileName(self, "Choose a key file", self._folder())
        if chosen:
            self.key.setText(chosen)

    def _folder(self) -> str:
        """Return the folder in which a file dialog starts: that of the latest recording, or the current folder."""
        folders = (Path(source).parent for source in [self.source.text(), *self._sources] if Path(source).is_absolute())
        return str(next((folder for folder in folders if folder.is_dir()), Path.cwd()))


def _row(field: QLineEdit, *buttons: tuple[str, Callable[[], None]]) -> QHBoxLayout:
    row = QHBoxLayout()
    row.addWidget(field, 1)
    for text, do in buttons:
        button = QPushButton(text)
        button.setAutoDefault(False)
        button.clicked.connect(lambda _=False, do=do: do())
        row.addWidget(button)
    return row
