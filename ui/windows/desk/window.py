"""Window of the desk: cells, runs, events of the selected run, notes, and requests to the host."""

import os
from collections.abc import Callable, Sequence
from itertools import pairwise

from PySide6.QtCore import QModelIndex, QSize, Qt, Signal
from PySide6.QtGui import (
    QAccessible,
    QAccessibleAnnouncementEvent,
    QCloseEvent,
    QKeySequence,
    QResizeEvent,
    QShortcut,
)
from PySide6.QtWidgets import (
    QCheckBox,
    QInputDialog,
    QLineEdit,
    QMainWindow,
    QMessageBox,
    QPushButton,
    QScrollArea,
    QSplitter,
    QTableView,
    QVBoxLayout,
    QWidget,
)

from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.withdrawal import NobodyWithdraws, plan_withdrawal
from thbridge.files.errors import BadFile
from thbridge.timing.wall_clock import utc_now
from ui.model.desk.messages import (
    DeskClosed,
    DeskRun,
    DeskState,
    EndRun,
    ExcludeRun,
    FromDesk,
    NextParticipant,
    ShowRun,
    WithdrawRun,
    WriteNote,
)
from ui.model.desk.rows import (
    CELLS,
    EVENTS,
    GROUP_COLUMN,
    GROUPS,
    NOTES,
    RUNS,
    cell_rows,
    count_words,
    event_rows,
    freeze_words,
    group_rows,
    note_rows,
    ordered_runs,
    run_rows,
    run_words,
)
from ui.model.desk.withdrawal import plan_lines
from ui.windows.desk.commands import CommandBox, TargetBox, latest_backup, new_export
from ui.windows.desk.questions import ReasonBox
from ui.windows.flow import FlowLayout
from ui.windows.key_sheet import KeyLines, KeySheet
from ui.windows.look import GAP, follow_text, label, open_within_screen, px, spaced, style_as_panel
from ui.windows.tables import GrowingModel, TextModel, row_table
from ui.windows.untrusted_text import shown, title_text

KEYS: tuple[tuple[str, KeyLines], ...] = (
    (
        "Runs",
        (
            ("Ctrl+N", "let the next participant start, after confirmation"),
            ("Ctrl+E", "end the selected run, with a reason"),
            ("Ctrl+D", "exclude the selected run, with a reason"),
        ),
    ),
    (
        "Study",
        (
            ("Ctrl+Shift+S", "show the status of the study"),
            ("Ctrl+Shift+E", "export tables to a folder"),
            ("Ctrl+Shift+B", "write or update a backup in a folder"),
            ("Ctrl+Shift+W", "delete all data of a participant who withdraws, after confirmation"),
        ),
    ),
    (
        "Window",
        (
            ("F6", "go to the next part of the window; with Shift, to the previous part"),
            ("Ctrl +, Ctrl -", "enlarge text, shrink text; Ctrl 0 restores the usual size"),
            ("Ctrl+,", "open the settings: colors, text size"),
            ("F1", "open this sheet"),
        ),
    ),
    ("Notes", (("Ctrl+M", "write a note; Enter adds the note to the log"),)),
)
_WANTED = QSize(1280, 860)
_NO_RUN = "Select a run in the table first."
_OVER = "This run is over."
_EXCLUDED = "This run is already excluded."


class DeskWindow(QMainWindow):
    """Experimenter's window of a study with people. Actions that cannot be undone ask for confirmation.

    Args:
        closing: question that the window asks before it closes. If empty, the window closes at once.
        folder: folder of the study, for status, export, backup and withdrawal. If None, these commands are disabled.

    Attributes:
        state: state of the study that the window shows; None before the first state has arrived.
        asked: signal with a request to the host, a `FromDesk`.
    """

    asked = Signal(object)

    def __init__(self, closing: str = "", folder: ExperimentFolder | None = None) -> None:
        super().__init__()
        self.setWindowTitle("thbridge study")
        self._folder = folder
        open_within_screen(self, _WANTED)
        self._closing = closing
        self._chosen = ""
        self._runs: tuple[DeskRun, ...] = ()
        self.state: DeskState | None = None
        self._title = label("Reading the study ...", "title", bold=True)
        self._counts, self._frozen, self._kiosk = label(), label("", "small"), label()
        self._pace = label("", "small")
        self._why = label("", "small", muted=True)
        self.troubles = label("", bold=True)
        style_as_panel(self.troubles)
        self.troubles.setProperty("bad", True)
        self.troubles.setMargin(GAP)
        self.troubles.hide()
        single = QTableView.SelectionMode.SingleSelection
        self.cell_model, self.run_model = GrowingModel(CELLS, self), GrowingModel(RUNS, self)
        self.group_model = TextModel(GROUPS, self)
        self.event_model = GrowingModel(EVENTS, self, has_time=True)
        self.note_model = GrowingModel(NOTES, self, has_time=True)
        self.cells = row_table("Cells and quotas", self.cell_model, single, 1, (26, 9, 9, 12))
        self.runs = row_table("Runs", self.run_model, single, 1, (11, 12, 30, 24, 7, 9, 12, 26, 40))
        self.groups = row_table("Games of several people", self.group_model, single, 1, (12, 18, 60))
        self.events = row_table("Events of the selected run", self.event_model, single, 1, (9, 44, 11))
        self.notes = row_table("Notes", self.note_model, single, 1, (13, 11, 50))
        for table in (self.cells, self.runs, self.groups, self.events, self.notes):
            table.horizontalHeader().setStretchLastSection(True)
        # Only studies with games of several people have these.
        self.groups.hide()
        self.runs.setColumnHidden(GROUP_COLUMN, True)
        self.runs.selectionModel().currentRowChanged.connect(self._row_chosen)
        self.details = label("No run is selected.")
        self.note = QLineEdit(placeholderText="Note for the log; press Enter to add it")
        self.note.setAccessibleName("Note")
        self.note.returnPressed.connect(self._write_note)
        self.about = QCheckBox("Note about the selected run")
        self.next = self._button("Next participant ...", "Ctrl+N", self._ask_next)
        self.end = self._button("End run ...", "Ctrl+E", self._ask_end)
        self.exclude = self._button("Exclude run ...", "Ctrl+D", self._ask_exclude)
        self.add_note = QPushButton("Add note")
        self.add_note.clicked.connect(self._write_note)
        self.status = self._button("Status ...", "Ctrl+Shift+S", self._show_status)
        self.export = self._button("Export ...", "Ctrl+Shift+E", self._ask_export)
        self.back_up = self._button("Back up ...", "Ctrl+Shift+B", self._ask_backup)
        self.withdraw = self._button("Withdraw ...", "Ctrl+Shift+W", self._ask_withdrawal)
        self._commands = (self.status, self.export, self.back_up, self.withdraw)
        self._keys = self._button("Keys", "F1", lambda: KeySheet(self, KEYS).open())
        self._lay_out()
        for key, do in (
            ("Ctrl+M", self.note.setFocus),
            ("F6", lambda: self._next_part(1)),
            ("Shift+F6", lambda: self._next_part(-1)),
        ):
            QShortcut(QKeySequence(key), self).activated.connect(do)
        follow_text(self, lambda it: it._fit_cells())
        self._show_buttons()

    # State

    def receive(self, state: DeskState) -> None:
        """Show this state of the study. The selection and the typed text do not change."""
        before, self.state = self.state, state
        self.setWindowTitle(f"{title_text(state.title)} - thbridge study")
        self._title.setText(state.title)
        self._counts.setText(count_words(state))
        self._frozen.setText(freeze_words(state))
        _mark(self._frozen, bad=bool(state.changed))
        self._pace.setText(state.pace)
        self._pace.setVisible(bool(state.pace))
        self._kiosk.setText(f"At the kiosk: {state.kiosk}")
        self._kiosk.setVisible(bool(state.kiosk))
        self._show_troubles(state.troubles, () if before is None else before.troubles)
        self.cell_model.show_rows(list(cell_rows(state)))
        self._show_runs(state)
        has_groups = state.groups is not None
        self.runs.setColumnHidden(GROUP_COLUMN, not has_groups)
        self.groups.setVisible(has_groups)
        self.group_model.show_rows(list(group_rows(state)))
        self._fit_cells()
        if self.note_model.show_rows(list(note_rows(state.notes))):
            self.notes.scrollToBottom()
        self._show_run()
        self._show_buttons()

    def _show_runs(self, state: DeskState) -> None:
        """Show the runs. A selected run stays selected if its row moves. If no run is selected, select the top row."""
        self._runs = ordered_runs(state)
        self.run_model.show_rows(list(run_rows(state)))
        self.runs.selectRow(max(self._row(self._chosen), 0))
        self._row_chosen(self.runs.currentIndex())

    def run(self) -> DeskRun | None:
        """Return the selected run; None if no run is selected."""
        return next((run for run in self._runs if run.participant == self._chosen), None)

    def select(self, participant: str) -> None:
        """Select the run of this participant."""
        self.runs.selectRow(self._row(participant))

    def _row(self, participant: str) -> int:
        return next((row for row, run in enumerate(self._runs) if run.participant == participant), -1)

    def _row_chosen(self, now: QModelIndex) -> None:
        if not 0 <= now.row() < len(self._runs):
            return
        chosen = self._runs[now.row()].participant
        if chosen != self._chosen:
            self._chosen = chosen
            self.asked.emit(ShowRun(chosen))
            self._show_run()
            self._show_buttons()

    def _show_run(self) -> None:
        run, state = self.run(), self.state
        self.details.setText("No run is selected." if run is None else run_words(run))
        known = state is not None and run is not None and state.shown == run.participant
        if self.event_model.show_rows(list(event_rows(state.events)) if state is not None and known else []):
            self.events.scrollToBottom()

    def _show_troubles(self, troubles: Sequence[str], before: Sequence[str]) -> None:
        self.troubles.setText("\n".join(f"⚠ {trouble}" for trouble in troubles))
        self.troubles.setVisible(bool(troubles))
        for trouble in troubles:
            if trouble not in before:
                QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, trouble))

    def _show_buttons(self) -> None:
        state, run = self.state, self.run()
        off = "The study is still being read." if state is None else state.read_only
        no_next = off or ("" if state is None else state.no_next)
        no_run = off or (_NO_RUN if run is None else "")
        _allow(self.next, no_next, "Let the next participant start at the kiosk, after confirmation")
        _allow(
            self.end,
            no_run or ("" if run and run.state == "under way" else _OVER),
            "End the run now, with a reason",
        )
        _allow(
            self.exclude,
            no_run or ("" if run and run.state != "excluded" else _EXCLUDED),
            "Exclude the run from the analysis, with a reason",
        )
        no_folder = "" if self._folder is not None else "This window was opened without the study's folder."
        _allow(self.status, no_folder, "Show the participants and the missing data")
        _allow(self.export, no_folder, "Export tables for pandas and R")
        _allow(self.back_up, no_folder, "Copy the study to another disk")
        _allow(self.withdraw, no_folder, "List the data of a participant, and delete all of them after confirmation")
        _allow(self.add_note, off, "Add the note to the log")
        self.note.setEnabled(not off)
        self.note.setToolTip(off)
        self.about.setEnabled(not no_run)
        self.about.setToolTip(no_run)
        self.about.setText(f"Note about {run.participant}" if run is not None else "Note about the selected run")
        self._why.setText(no_next)
        self._why.setVisible(bool(no_next))

    # Questions and requests

    def _ask_next(self) -> None:
        now = "" if self.state is None or not self.state.kiosk else f" The kiosk at the moment: {self.state.kiosk}."
        words = f"Let the next participant start at the kiosk? This participant gets the next open place.{now}"
        box = QMessageBox(QMessageBox.Icon.Question, "Next participant", words, parent=self)
        self._do_if(box, "Start", NextParticipant())

    def _ask_end(self) -> None:
        if (run := self.run()) is not None:
            words = (
                f"End the run of {run.participant}? The run stops and does not count. "
                "Its place is then open for another participant."
            )
            box = ReasonBox(self, "End a run", words, f"End {run.participant}")
            if box.exec():
                self.asked.emit(EndRun(run.participant, box.reason.text().strip()))

    def _ask_exclude(self) -> None:
        if (run := self.run()) is not None:
            words = (
                f"Exclude the run of {run.participant}? The recorded data remain, but the run no longer counts. "
                "Its place is then open for another participant. You cannot undo this."
            )
            box = ReasonBox(self, "Exclude a run", words, f"Exclude {run.participant}")
            if box.exec():
                self.asked.emit(ExcludeRun(run.participant, box.reason.text().strip()))

    def _show_status(self) -> None:
        self._run("Status", "study", "status")

    def _ask_export(self) -> None:
        if self._folder is not None:
            words = (
                "Write the tables, the scripts and the methods text to a new or empty folder. Participants may "
                "continue during the export."
            )
            target = os.fspath(new_export(self._folder, utc_now()[:10]))
            self._run_to("Export", words, target, "export")

    def _ask_backup(self) -> None:
        if self._folder is not None:
            words = (
                "Copy the log, the recordings and the files to a folder on another disk. Choose a new folder, or the "
                "folder of an earlier backup to update it. Participants may continue during the backup."
            )
            self._run_to("Back up", words, latest_backup(self._folder), "backup")

    def _ask_withdrawal(self) -> None:
        """Ask for the ID or code of a participant, list this person's data, and delete the data after confirmation."""
        if self._folder is None:
            return
        words = "ID or completion code of the participant who withdraws:"
        named, yes = QInputDialog.getText(self, "Withdraw", words, text=self._chosen)
        if not yes:
            return
        try:
            plan = plan_withdrawal(self._folder, self._folder.read(), named)
        except NobodyWithdraws:
            self._say("Withdraw", f"The study has no participant with the ID or code {shown(named)}.")
            return
        except BadFile as fault:
            self._say("Withdraw", str(fault))
            return
        who = plan.withdrawal.participant
        box = QMessageBox(QMessageBox.Icon.Warning, "Withdraw", "\n".join(plan_lines(self._folder, plan)), parent=self)
        if self.state is not None and self.state.read_only:
            if self._agreed(box, f"Delete all data of {who}"):
                self._run("Withdraw", "study", "withdraw", "--yes", after=(who,))
        else:
            self._do_if(box, f"Delete all data of {who}", WithdrawRun(who))

    def _say(self, title: str, words: str) -> None:
        box = QMessageBox(QMessageBox.Icon.Warning, title, words, parent=self)
        box.setObjectName("question")
        box.exec()

    def _run_to(self, title: str, question: str, suggested: str, command: str) -> None:
        box = TargetBox(self, title, question, suggested, title)
        if box.exec():
            self._run(title, "study", command, "--to", box.folder.text().strip())

    def _run(self, title: str, *arguments: str, after: tuple[str, ...] = ()) -> None:
        """Run a command on the study's folder, and show its output."""
        if self._folder is not None:
            CommandBox(self, title, *arguments, os.fspath(self._folder.root.absolute()), *after).open()

    def _do_if(self, box: QMessageBox, yes: str, message: FromDesk) -> None:
        if self._agreed(box, yes):
            self.asked.emit(message)

    def _agreed(self, box: QMessageBox, yes: str) -> bool:
        box.setObjectName("question")
        agree = box.addButton(yes, QMessageBox.ButtonRole.AcceptRole)
        box.setDefaultButton(box.addButton(QMessageBox.StandardButton.Cancel))
        box.exec()
        return box.clickedButton() is agree

    def _write_note(self) -> None:
        text, run = self.note.text().strip(), self.run()
        if text and self.add_note.isEnabled():
            about = run.participant if run is not None and self.about.isChecked() else ""
            self.asked.emit(WriteNote(text, about))
            self.note.clear()

    def leave(self) -> None:
        """Close the window without a question."""
        self._closing = ""
        self.close()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask the closing question if there is one; inform the host when the window closes."""
        if self._closing:
            box = QMessageBox(QMessageBox.Icon.Question, "Close the desk", self._closing, parent=self)
            box.setObjectName("question")
            agree = box.addButton("Close", QMessageBox.ButtonRole.AcceptRole)
            box.setDefaultButton(box.addButton(QMessageBox.StandardButton.Cancel))
            box.exec()
            if box.clickedButton() is not agree:
                event.ignore()
                return
            self.asked.emit(DeskClosed())
        super().closeEvent(event)

    # Layout

    def _button(self, words: str, key: str, do: Callable[[], object]) -> QPushButton:
        button = QPushButton(f"{words} ({key})")
        button.clicked.connect(do)
        QShortcut(QKeySequence(key), self).activated.connect(button.click)
        return button

    def _lay_out(self) -> None:
        buttons = FlowLayout()
        buttons.setSpacing(GAP)
        for button in (
            self.next,
            self.end,
            self.exclude,
            self.status,
            self.export,
            self.back_up,
            self.withdraw,
            self._keys,
        ):
            buttons.addWidget(button)
        left, right = QWidget(), _Column()
        column = spaced(QVBoxLayout(left), GAP, 0)
        column.addWidget(self.cells)
        column.addWidget(self.runs, 1)
        column.addWidget(self.groups)
        column = spaced(QVBoxLayout(right), GAP, 0)
        column.addWidget(self.details)
        column.addWidget(self.events, 2)
        column.addWidget(self.notes, 1)
        writing = FlowLayout()
        writing.setSpacing(GAP)
        for part in (self.note, self.about, self.add_note):
            writing.addWidget(part)
        column.addLayout(writing)
        body = _Body(Qt.Orientation.Horizontal)
        body.setChildrenCollapsible(False)
        body.addWidget(left)
        body.addWidget(right)
        body.setSizes([560, 440])
        for table in (self.runs, self.events, self.notes):
            follow_text(table, lambda it: it.setMinimumSize(px(200), px(96)))
        inside, area = QWidget(), QScrollArea(widgetResizable=True)
        head = spaced(QVBoxLayout(), GAP // 2)
        for words in (self._title, self._counts, self._frozen, self._pace, self._kiosk, self.troubles):
            head.addWidget(words)
        column = spaced(QVBoxLayout(inside), GAP, 2 * GAP, GAP, 2 * GAP, GAP)
        column.addLayout(head)
        column.addLayout(buttons)
        column.addWidget(self._why)
        column.addWidget(body, 1)
        area.setWidget(inside)
        area.setAccessibleName("The study")
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setCentralWidget(area)
        self._parts = (self.next, self.cells, self.runs, self.groups, self.events, self.notes, self.note)
        order = (self.next, self.end, self.exclude, *self._commands, self._keys)
        tables = (self.cells, self.runs, self.groups, self.events, self.notes)
        for before, after in pairwise((*order, *tables, self.note, self.about, self.add_note)):
            self.setTabOrder(before, after)
        self.runs.setFocus()

    def _fit_cells(self) -> None:
        """Give the tables of cells and of games of several people the height of all their rows, at most six rows."""
        for table, rows in ((self.cells, self.cell_model.rowCount()), (self.groups, self.group_model.rowCount())):
            table.setFixedHeight(
                table.horizontalHeader().sizeHint().height()
                + min(rows, 6) * table.verticalHeader().defaultSectionSize()
                + 2 * table.frameWidth()
                + table.horizontalScrollBar().sizeHint().height()
            )

    def _next_part(self, step: int) -> None:
        parts = [part for part in self._parts if part.isEnabled() and not part.isHidden()]
        focus = self.focusWidget()
        at = parts.index(focus) if focus in parts else -1
        parts[(at + step) % len(parts)].setFocus(Qt.FocusReason.ShortcutFocusReason)


class _Body(QSplitter):
    """Splitter that uses the available height, not the preferred height of its tables."""

    def sizeHint(self) -> QSize:
        """Return the minimum size."""
        return self.minimumSizeHint()


class _Column(QWidget):
    """Column of widgets. Its minimum height is the height that its text needs at the current width, because a splitter
    does not compute this height."""

    def minimumSizeHint(self) -> QSize:
        """Return the minimum width of the widgets, and their minimum height at the current width."""
        hint, layout = super().minimumSizeHint(), self.layout()
        return hint if layout is None else QSize(hint.width(), layout.minimumHeightForWidth(self.width()))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Adapt the height to the new width."""
        super().resizeEvent(event)
        self.updateGeometry()


def _allow(button: QPushButton, why_not: str, hint: str) -> None:
    """Enable a button, or disable it and show the reason."""
    button.setEnabled(not why_not)
    button.setToolTip(why_not or hint)
    button.setAccessibleDescription(why_not or hint)


def _mark(words: QWidget, *, bad: bool) -> None:
    """Show text in the color of problems, or in the normal color."""
    words.setProperty("bad", bad)
    words.style().unpolish(words)
    words.style().polish(words)
