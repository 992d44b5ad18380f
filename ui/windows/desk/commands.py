"""Commands that the desk runs on a study's folder: status, export, backup. Each command has its own process."""

from pathlib import Path

from PySide6.QtCore import QProcess, Qt
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QTextCursor
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QHBoxLayout,
    QLineEdit,
    QPlainTextEdit,
    QProgressBar,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from thbridge.experiment.folder import ExperimentFolder
from thbridge.files.errors import BadFile
from ui.command_line.terminal import THBRIDGE
from ui.windows.look import GAP, fixed_font, follow_text, label, px, spaced

STOP_TIMEOUT = 5000
"""Milliseconds that a command has to stop by itself before it is killed."""


class CommandBox(QDialog):
    """Dialog that runs a command and shows its output; closing the dialog stops the command.

    Args:
        parent: the window.
        title: title of the dialog.
        arguments: arguments of `thbridge`.

    Attributes:
        output: output of the command.
        words: label with the state of the command: running, done, or failed.
    """

    def __init__(self, parent: QWidget, title: str, *arguments: str) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.words = label(f"{title}: running ...", bold=True)
        self.output = QPlainTextEdit(readOnly=True)
        self.output.setAccessibleName("Output")
        follow_text(self.output, lambda it: it.setFont(fixed_font()))
        self._bar = QProgressBar(textVisible=False)
        self._bar.setRange(0, 0)
        self._buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self._buttons.rejected.connect(self.reject)
        column = spaced(QVBoxLayout(self), GAP, 2 * GAP)
        for part in (self.words, self.output, self._bar, self._buttons):
            column.addWidget(part, part is self.output)
        follow_text(self, lambda it: it.resize(px(720), px(380)))
        self._process = QProcess(self)
        self._process.setProcessChannelMode(QProcess.ProcessChannelMode.MergedChannels)
        self._process.setStandardInputFile(QProcess.nullDevice())
        self._process.readyReadStandardOutput.connect(self._read)
        self._process.finished.connect(self._finish)
        self._process.start(THBRIDGE[0], [*THBRIDGE[1:], *arguments])

    def done(self, result: int) -> None:
        """Stop the command if it is still running, and close the dialog."""
        if self._process.state() is not QProcess.ProcessState.NotRunning:
            # The dialog closes, so signals of the process must not change it any longer.
            self._process.finished.disconnect(self._finish)
            self._process.terminate()
            if not self._process.waitForFinished(STOP_TIMEOUT):
                self._process.kill()
                self._process.waitForFinished(STOP_TIMEOUT)
        super().done(result)

    def _read(self) -> None:
        text = bytes(self._process.readAllStandardOutput().data()).decode(errors="replace")
        self.output.moveCursor(QTextCursor.MoveOperation.End)
        self.output.insertPlainText(text)

    def _finish(self, code: int, status: QProcess.ExitStatus) -> None:
        self._read()
        is_done = status is QProcess.ExitStatus.NormalExit and code == 0
        self.words.setText(f"{self.windowTitle()}: {'done.' if is_done else 'failed. The reason is below.'}")
        self._bar.hide()
        self._buttons.setStandardButtons(QDialogButtonBox.StandardButton.Close)
        self._buttons.button(QDialogButtonBox.StandardButton.Close).setFocus()
        QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, self.words.text()))


class TargetBox(QDialog):
    """Dialog that asks for the target folder of a command.

    Args:
        parent: the window.
        title: title of the dialog.
        question: description of the output and of the allowed folders.
        suggested: folder to suggest. If empty, no folder is suggested.
        yes: text of the button that starts the command.

    Attributes:
        folder: field with the folder.
    """

    def __init__(self, parent: QWidget, title: str, question: str, suggested: str, yes: str) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.setObjectName("question")
        self.folder = QLineEdit(suggested)
        self.folder.setAccessibleName("Folder")
        browse = QPushButton("Browse ...")
        browse.setAutoDefault(False)
        browse.clicked.connect(self._browse)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.agree = buttons.addButton(yes, QDialogButtonBox.ButtonRole.AcceptRole)
        self.folder.textChanged.connect(lambda text: self.agree.setEnabled(bool(text.strip())))
        self.agree.setEnabled(bool(suggested))
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        words = label(question)
        follow_text(words, lambda it: it.setMinimumWidth(px(420)))
        column = spaced(QVBoxLayout(self), GAP, 2 * GAP)
        column.addWidget(words)
        line = QHBoxLayout()
        line.addWidget(self.folder, 1)
        line.addWidget(browse)
        column.addLayout(line)
        column.addWidget(buttons)
        self.folder.setFocus()

    def _browse(self) -> None:
        if chosen := QFileDialog.getExistingDirectory(self, self.windowTitle(), self.folder.text()):
            self.folder.setText(chosen)


def new_export(study: ExperimentFolder, today: str) -> Path:
    """Return the path of a folder that does not exist yet, for an export on this day (YYYY-MM-DD)."""
    names = (today, *(f"{today}-{number}" for number in range(2, 1000)))
    return next((path for path in map(study.export, names) if not path.exists()), study.export(today))


def latest_backup(study: ExperimentFolder) -> str:
    """Return the path of the latest backup's folder. Return an empty text if there is no backup."""
    try:
        known = study.backups_known.paths()
    except BadFile:
        return ""
    return str(known[-1]) if known else ""
