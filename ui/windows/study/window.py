"""Main window of the study editor, which shows a study file as a form."""

from functools import partial
from itertools import pairwise
from pathlib import Path

from PySide6.QtCore import QProcess, QSignalBlocker, QSize, Qt, Slot
from PySide6.QtGui import QCloseEvent, QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMainWindow,
    QMessageBox,
    QPushButton,
    QSplitter,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from thbridge.experiment.questionnaires.form import shipped_form
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile
from ui.command_line.terminal import THBRIDGE
from ui.model.study_form.experiment import language_of
from ui.model.study_form.files import all_well
from ui.model.study_form.form import FieldKind, RepeatKind, editable_text
from ui.model.study_form.questionnaire import START
from ui.windows.editing.changes import ChangesPage
from ui.windows.editing.faults import FaultList
from ui.windows.look import GAP, FoldingRow, follow_text, label, open_within_screen, px, spaced, style_as_panel
from ui.windows.study.editor import StudyEditor
from ui.windows.study.key_chooser import KeyChooser
from ui.windows.study.noise_page import NoisePage, NoiseView
from ui.windows.study.pages import FieldsPage, TextPage
from ui.windows.study.sections import NOISE, SectionTree
from ui.windows.untrusted_text import title_text


class StudyWindow(QMainWindow):
    """Window of a study file.

    Sections are on the left, fields in the middle, drawings of noise on the right, and faults below.
    """

    def __init__(self, path: Path) -> None:
        """Open a study file.

        Raises:
            BadFile: the file cannot be read.
        """
        super().__init__()
        self.editor = StudyEditor(path)
        self._typed: dict[str, str] = {}
        self._key = ""
        self._closing = False
        self.search = QLineEdit(placeholderText="Find a setting   Ctrl+F", clearButtonEnabled=True)
        self.search.setAccessibleName("Find a setting by its name, meaning or ROS name")
        self.sections = SectionTree()
        self.fields = FieldsPage()
        self.noise_fields = FieldsPage()
        self.noise = NoiseView()
        self.found = FieldsPage()
        self.text = TextPage()
        self.changes = ChangesPage()
        self.faults = FaultList(
            all_well(path, self.editor.draft.text),
            lambda sentence: sentence.removeprefix(f"{path}, ").removeprefix(f"{path}: "),
        )
        self._title = label(path.name, "title", bold=True)
        self._state = label("", "small", muted=True)
        self._buttons: dict[str, QPushButton] = {}
        self._banner, self._banner_words = self._made_banner()
        self._stack = QStackedWidget()
        self._noise_page = NoisePage(self.noise_fields, self.noise)
        for page in (self.fields, self._noise_page, self.found, self.text, self.changes):
            self._stack.addWidget(page)
        self._lay_out()
        self._connect()
        self._show()
        if self.editor.draft.tree is None:
            self.show_text()
        self.setWindowTitle(f"{title_text(path.name)}[*] — study")
        open_within_screen(self, QSize(1240, 860))
        self.sections.setFocus()

    # Contents ---------------------------------------------------------------------------------------------------------

    def open_section(self, key: str) -> None:
        """Show the section with this key."""
        if self.sections.select(key):
            self._section_chosen(key)

    def open_field(self, key: str) -> None:
        """Show a field, and give its editor the focus."""
        section = key.rpartition(".")[0]
        while section and not self.sections.select(section):
            section = section.rpartition(".")[0]
        self.open_section(section)
        page = self.noise_fields if self._stack.currentWidget() is self._noise_page else self.fields
        page.finish()
        row = page.rows.get(key)
        if row is not None:
            page.focus_on(row.editor)

    @Slot()
    def show_text(self) -> None:
        """Show the file as text."""
        self._stack.setCurrentWidget(self.text)
        self._show()
        self.text.editor.setFocus()

    @Slot()
    def show_changes(self) -> None:
        """Show the changes that saving would write."""
        self._stack.setCurrentWidget(self.changes)
        self._show()
        self.changes.view.setFocus()

    @Slot()
    def show_form(self) -> None:
        """Show the form instead of the text or the changes."""
        self._open(self._key)
        self.sections.setFocus()

    @Slot()
    def repaint_all(self) -> None:
        """Show the window in the current colors."""
        self.noise.redraw()
        self._show()

    def _open(self, key: str) -> None:
        self._key = key
        self._stack.setCurrentWidget(self._noise_page if key.split(".", maxsplit=1)[0] == NOISE else self.fields)
        self._show()

    @Slot()
    def _show(self) -> None:
        """Update everything that is visible."""
        draft, editor = self.editor.draft, self.editor
        groups = draft.groups()
        group = groups.get(self._key, draft.form)
        page = self._stack.currentWidget()
        if page is self.fields:
            items = group.groups if group.repeats in {RepeatKind.ITEMS, RepeatKind.STEPS} else ()
            self.fields.show_groups(draft, (group, *items))
        elif page is self._noise_page:
            self.noise_fields.show_groups(draft, tuple(groups[NOISE].all_groups()), narrow=True)
            self.noise.draw(draft, self._typed)
        elif page is self.found:
            self.found.show_found(draft, self.search.text().strip())
        elif page is self.text:
            self.text.show_draft(draft)
        elif page is self.changes:
            self.changes.show_changes(draft.differences(editor.on_disk.text))
        self.sections.show_draft(draft, self._key)
        self.faults.show_faults(draft.faults, draft.notices)
        self.setWindowModified(editor.dirty)
        self._buttons["undo"].setEnabled(bool(editor.history.past))
        self._buttons["redo"].setEnabled(bool(editor.history.future))
        self._let_save(editor.dirty)
        on_form = page not in {self.text, self.changes}
        for name, shown in (("form", on_form), ("text", page is self.text), ("changes", page is self.changes)):
            self._buttons[name].setChecked(shown)
        where = str(editor.path.parent.resolve())
        state = "not saved yet" if not editor.on_disk.exists else "changed" if editor.dirty else "saved"
        self._state.setText(f"{state} · {where}")

    def _open_fault(self, row: int) -> None:
        draft = self.editor.draft
        if row >= len(draft.faults):
            return
        fault = draft.faults[row]
        field = draft.field_of(fault)
        if field is not None and draft.tree is not None:
            self.open_field(field.key)
        elif fault.path == draft.path and fault.key and fault.key in draft.groups() and draft.tree is not None:
            self.open_section(fault.key)
        elif fault.line is not None and fault.path == draft.path:
            self.show_text()
            self.text.go_to(fault.line)

    # Changes ----------------------------------------------------------------------------------------------------------

    def _field_edited(self, key: str, text: str) -> None:
        self._typed[key] = text
        field = self.editor.draft.fields().get(key)
        chosen = field is not None and field.kind in {FieldKind.CHOICE, FieldKind.BOOLEAN}
        self.editor.set(key, text, at_once=chosen)
        if key.startswith(f"{NOISE}."):
            self.noise.draw(self.editor.draft, self._typed)
        self.setWindowModified(True)
        self._let_save(True)

    def _let_save(self, wanted: bool) -> None:
        self._buttons["save"].setEnabled(wanted)
        self._buttons["save"].setDefault(wanted)

    def _field_finished(self, key: str) -> None:
        if self._typed.get(key) is not None:
            self.editor.settle()

    def _field_reset(self, key: str) -> None:
        self._typed.pop(key, None)
        self.editor.reset(key)

    @Slot()
    def _drafted(self) -> None:
        if self.editor.settled:
            self._typed.clear()
            self.text.mark_unmodified()
        self._show()

    def _refused(self, key: str, sentence: str) -> None:
        for page in (self.fields, self.noise_fields, self.found):
            if key in page.rows:
                page.rows[key].show_faults((sentence,))

    def _searched(self, words: str) -> None:
        if words.strip():
            self._stack.setCurrentWidget(self.found)
        elif self._stack.currentWidget() is self.found:
            self._open(self._key)
            return
        self._show()

    def _section_chosen(self, key: str) -> None:
        with QSignalBlocker(self.search):
            self.search.clear()
        self._open(key)

    def _add(self, key: str) -> None:
        group = self.editor.draft.groups()[key]
        if group.repeats is RepeatKind.KEYS:
            self._add_key(key)
            return
        if group.repeats is not RepeatKind.ROBOTS:
            self.fields.go_to_added(f"{key}[{len(group.groups)}]")
        self.editor.change(f"+{key}", lambda draft: draft.add(draft.groups()[key]), at_once=True)

    def _add_key(self, key: str) -> None:
        """Ask for the key to add to a section, and add the key."""
        draft = self.editor.draft
        group = draft.groups()[key]
        chooser = KeyChooser(group.label, draft.keys_for(group), self, own_names=draft.allows_own_names(group))
        if chooser.exec() and (name := chooser.chosen):
            self.fields.go_to_added(f"{key}.{name}")
            self.editor.change(f"+{key}.{name}", lambda draft: draft.add_key(draft.groups()[key], name), at_once=True)

    def _open_form(self, key: str) -> None:
        """Open a separate window for the questionnaire that a step names.

        If the questionnaire's file does not exist, ask for confirmation, and create the file.
        """
        name = editable_text(self.editor.draft.fields()[key])
        folder, shipped = self.editor.path.parent, shipped_form(name, language_of(self.editor.draft))
        path, start = folder / (name or "questionnaire.yaml"), START
        if not path.is_file():
            path = path if path.suffix else path.with_suffix(".yaml")
            words = f"{path.name} does not exist in the study's folder."
            if shipped.is_file():
                words = f"{name} comes with the program. This creates a copy, {path.name}, in the study's folder."
                start = shipped.read_text(encoding="utf-8")
            if not path.is_file() and not self._asked(words, f"Create {path.name}"):
                return
            try:
                if not path.is_file():
                    write_whole(path, start.encode())
            except BadFile as fault:
                self._failed(str(fault))
                return
            self.editor.set(key, path.name, at_once=True)
        try:
            window = StudyWindow(path)
        except BadFile as fault:
            self._failed(str(fault))
            return
        window.setParent(self, Qt.WindowType.Window)
        window.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        window.editor.saved.connect(self.editor.check_again)
        window.show()

    def _preview(self, key: str) -> None:
        """Show a step in a separate window, in the form that participants see."""
        if self.editor.dirty or self.editor.draft.faults:
            what = "Save the file" if self.editor.dirty else "Correct the faults"
            self._failed(f"A preview shows only a saved file without faults. {what} first.")
            return
        number = int(key.removeprefix("steps[").removesuffix("]")) + 1
        program, *arguments = (*THBRIDGE, "study", "preview", str(self.editor.path.parent.resolve()), str(number))
        QProcess.startDetached(program, arguments)

    def _move(self, key: str, by: int) -> None:
        self.editor.change(f"~{key}", lambda draft: draft.move(draft.groups()[key], by), at_once=True)

    def _remove(self, key: str) -> None:
        self.editor.change(f"-{key}", lambda draft: draft.remove(draft.groups()[key]), at_once=True)

    def _clear(self, key: str) -> None:
        self._typed.clear()
        self.editor.change(f"0{key}", lambda draft: draft.reset_group(draft.groups()[key]), at_once=True)

    @Slot()
    def save(self) -> None:
        """Write the file. Ask for confirmation if the file has faults, or if another program has changed it."""
        self._closing = False
        self.editor.save()

    @Slot()
    def _saved(self) -> None:
        self._banner.hide()
        self._show()
        if self._closing:
            self.close()

    @Slot()
    def _ask_unsound(self) -> None:
        count = len(self.editor.draft.faults)
        words = "fault remains" if count == 1 else "faults remain"
        if self._asked(f"{count} {words}. thbridge refuses a study with faults.", "Save anyway"):
            self.editor.save(with_faults=True)
        else:
            self._closing = False

    @Slot()
    def _ask_over(self) -> None:
        if self._asked("Another program changed the file since this window read it.", "Overwrite"):
            self.editor.save(with_faults=True, overwrite=True)
        else:
            self._closing = False
            self._changed_outside()

    def _asked(self, words: str, yes: str) -> bool:
        box = QMessageBox(QMessageBox.Icon.Warning, self.editor.path.name, words, parent=self)
        box.setObjectName("question")
        agree = box.addButton(yes, QMessageBox.ButtonRole.AcceptRole)
        box.setDefaultButton(box.addButton(QMessageBox.StandardButton.Cancel))
        box.exec()
        return box.clickedButton() is agree

    @Slot(str)
    def _failed(self, words: str) -> None:
        self._closing = False
        box = QMessageBox(QMessageBox.Icon.Critical, self.editor.path.name, words, parent=self)
        box.setObjectName("question")
        box.exec()

    @Slot()
    def _changed_outside(self) -> None:
        self._banner_words.setText("Another program changed this file. This window shows the earlier version.")
        self._banner.show()

    @Slot()
    def _load_again(self) -> None:
        self._banner.hide()
        self.editor.load_again()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask for confirmation if changes would be lost."""
        touched = bool(self.editor.history.past) or not self.editor.settled
        if self.editor.dirty and touched and not self._closing:
            box = QMessageBox(QMessageBox.Icon.Question, self.editor.path.name, "Save the changes?", parent=self)
            box.setObjectName("question")
            standard = QMessageBox.StandardButton
            box.setStandardButtons(standard.Save | standard.Discard | standard.Cancel)
            chosen = box.exec()
            if chosen == standard.Save:
                event.ignore()
                self._closing = True
                self.editor.save()
                return
            if chosen == standard.Cancel:
                event.ignore()
                return
        self.noise.close_work()
        self.editor.close()
        super().closeEvent(event)

    # Layout -----------------------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        head, tools = spaced(QHBoxLayout(), GAP), spaced(QHBoxLayout(), GAP)
        row = FoldingRow(head, tools)
        names = spaced(QVBoxLayout(), 0)
        names.addWidget(self._title)
        names.addWidget(self._state)
        head.addLayout(names, 1)
        follow_text(self.search, lambda it: it.setMinimumWidth(px(160)))
        follow_text(self.search, lambda it: it.setMaximumWidth(px(300)))
        head.addWidget(self.search, 1)
        for name, words, key, slot in (
            ("form", "Form", "Ctrl+E", self.show_form),
            ("text", "Text", "Ctrl+T", self.show_text),
            ("changes", "Changes", "Ctrl+D", self.show_changes),
            ("undo", "Undo", "Ctrl+Z", self.editor.undo),
            ("redo", "Redo", "Ctrl+Shift+Z", self.editor.redo),
            ("save", "Save", "Ctrl+S", self.save),
        ):
            button = QPushButton(words)
            button.setToolTip(f"{words} ({key})")
            button.setAccessibleDescription(f"Shortcut: {key}")
            button.setCheckable(name in {"form", "text", "changes"})
            button.clicked.connect(slot)
            QShortcut(QKeySequence(key), self).activated.connect(slot)
            self._buttons[name] = button
            tools.addWidget(button)
        body = QSplitter(Qt.Orientation.Horizontal)
        body.setChildrenCollapsible(False)
        body.addWidget(self.sections)
        body.addWidget(self._stack)
        body.setStretchFactor(1, 1)
        body.setSizes([px(230), px(1010)])
        inside = QWidget()
        column = spaced(QVBoxLayout(inside), GAP, 2 * GAP, 2 * GAP, 2 * GAP, GAP)
        column.addWidget(row)
        column.addWidget(self._banner)
        column.addWidget(body, 1)
        column.addWidget(self.faults)
        self.setCentralWidget(inside)

    def _order(self, page: FieldsPage) -> None:
        """Let Tab follow the reading order: buttons at the top, sections, fields, drawings of noise, faults."""
        order = [self.search, *self._buttons.values(), self.sections]
        for before, after in pairwise(order):
            self.setTabOrder(before, after)
        if page.rows:
            order = [list(page.rows.values())[-1].last_widget, *([self.noise] if page is self.noise_fields else [])]
            for before, after in pairwise([*order, self.faults.list]):
                self.setTabOrder(before, after)

    def _made_banner(self) -> tuple[QWidget, QLabel]:
        banner = QWidget()
        style_as_panel(banner)
        row = QHBoxLayout(banner)
        words = label("")
        row.addWidget(words, 1)
        load, keep = QPushButton("Load the new version"), QPushButton("Keep my version")
        load.clicked.connect(self._load_again)
        keep.clicked.connect(banner.hide)
        row.addWidget(load)
        row.addWidget(keep)
        banner.hide()
        return banner, words

    def _connect(self) -> None:
        editor = self.editor
        editor.drafted.connect(self._drafted)
        editor.refused.connect(self._refused)
        editor.saved.connect(self._saved)
        editor.found_faulty.connect(self._ask_unsound)
        editor.conflicted.connect(self._ask_over)
        editor.changed_outside.connect(self._changed_outside)
        editor.failed.connect(self._failed)
        for page in (self.fields, self.noise_fields, self.found):
            page.edited.connect(self._field_edited)
            page.edit_finished.connect(self._field_finished)
            page.reset.connect(self._field_reset)
            page.opened.connect(self.open_section)
            page.file_wanted.connect(self._open_form)
            page.preview_wanted.connect(self._preview)
            page.added.connect(self._add)
            page.removed.connect(self._remove)
            page.moved.connect(self._move)
            page.cleared.connect(self._clear)
            page.built.connect(partial(self._order, page))
        self.text.edited.connect(editor.say)
        self.search.textChanged.connect(self._searched)
        self.sections.chosen.connect(self._section_chosen)
        self.faults.chosen.connect(self._open_fault)
        QShortcut(QKeySequence("F8"), self).activated.connect(self.faults.choose_next)
        QShortcut(QKeySequence("Ctrl+F"), self).activated.connect(self.search.setFocus)
