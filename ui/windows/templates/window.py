"""Window of a template set, with sheets of treasures and properties, all files as text, pictures, and a preview."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path

from PySide6.QtCore import QEvent, QObject, QSignalBlocker, QSize, Qt, QTimer, Slot
from PySide6.QtGui import QAction, QCloseEvent, QIcon, QKeyEvent, QKeySequence, QPixmap, QShortcut, QTextCursor
from PySide6.QtWidgets import (
    QFileDialog,
    QHBoxLayout,
    QListWidget,
    QListWidgetItem,
    QMainWindow,
    QMenu,
    QMessageBox,
    QPlainTextEdit,
    QPushButton,
    QSplitter,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from thbridge.dialogue.scripted.reserved_words import allowed_words
from thbridge.files.disk.edited_file import TextOnDisk, read_edited, write_edited
from thbridge.files.disk.inside import path_inside
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile
from thbridge.files.map_files import read_map
from thbridge.files.resources import shipped
from thbridge.files.template_files import DIALOGUE_TEXT, scenario_on
from thbridge.files.treasure_files import PICTURES
from thbridge.hunt.properties import TreasureProperty
from thbridge.hunt.treasures import name_in_words
from ui.model.shared.differences import differences
from ui.model.shared.line_ends import plain_lines, with_line_ends_of
from ui.model.template_set.draft import TemplateDraft, edited_names, template_draft
from ui.model.template_set.preview import NOWHERE, PreviewPlace, contents, place_on, sentences, translations
from ui.model.template_set.sheet import Texts
from ui.model.template_set.sheets import sheets_of
from ui.windows.controls import ChoiceBox
from ui.windows.editing.background import BackgroundWorker
from ui.windows.editing.changes import ChangesPage
from ui.windows.editing.exact_text import exact_text
from ui.windows.editing.faults import FaultList
from ui.windows.look import GAP, fixed_font, follow_text, label, open_within_screen, px, spaced
from ui.windows.templates.sheet_page import SheetPage
from ui.windows.untrusted_text import button_text, shown, title_text

_PAUSE = 250
"""The text is checked after this number of milliseconds without a key press."""
_ROW_NAMES = {"Treasures": "treasure", "Properties": "property"}
_LOOK = QSize(96, 96)
"""Size of a picture in the list, `px`."""


class TemplateWindow(QMainWindow):
    """Window with sheets and texts on the left, the preview and the pictures on the right, and faults below.

    Attributes:
        sheets: page of each sheet, by its title.
        pages: editor of each file, by its path in the folder.
        changes: page with the changes that saving would write.
        words: menu of the reserved words that are allowed at the cursor.
        draft: draft of the latest check; None before the first check.
        preview: all sentences, as a robot would say them.
        faults: list of all faults.
    """

    def __init__(self, folder: Path) -> None:
        """Open the template set in a folder.

        Raises:
            BadFile: one of its files cannot be read.
        """
        super().__init__()
        self.folder = folder
        self._on_disk: dict[str, TextOnDisk] = {name: read_edited(folder / name) for name in edited_names(folder)}
        self.pages = {name: self._made_page(name, disk.text) for name, disk in self._on_disk.items()}
        self.sheets = {title: self._made_sheet(title) for title in sheets_of(self._shown_texts()) or ("Treasures",)}
        self.changes = ChangesPage()
        # Names of the pages that each step of the person changed, the latest step last; the same for undone steps.
        self._done: list[tuple[str, ...]] = []
        self._undone: list[tuple[str, ...]] = []
        self._step: list[str] | None = None
        self.draft: TemplateDraft | None = None
        self._new_pictures: dict[str, bytes] = {}
        # Original bytes of the replaced pictures, by name.
        self._replaced: dict[str, bytes | None] = {}
        # Properties and pictures of the latest texts that had no faults.
        self._properties: tuple[TreasureProperty, ...] = ()
        self._pictures: Mapping[str, bytes] = {}
        self._pause = QTimer(self, singleShot=True, interval=_PAUSE)
        self._pause.timeout.connect(self._check)
        self._worker = BackgroundWorker(self, "templates")
        self._worker.done.connect(self._checked)
        self.preview = QPlainTextEdit(readOnly=True)
        self.preview.setAccessibleName("Preview of the robots' sentences")
        self.treasure, self.place = ChoiceBox(), ChoiceBox()
        self.treasure.setAccessibleName("Treasure in the sentences")
        self.place.setAccessibleName("Map for the numbers in the sentences")
        self.place.addItems(["no map", *shipped().names("maps")])
        self.treasure.currentIndexChanged.connect(self._show_preview)
        self.place.currentIndexChanged.connect(self._show_preview)
        self.pictures = QListWidget()
        self.pictures.setAccessibleName("Pictures of treasures")
        self.pictures.setIconSize(QSize(px(_LOOK.width()), px(_LOOK.height())))
        self.pictures.itemActivated.connect(self._change_picture)
        self.word_button = QPushButton("Insert a word")
        self.word_button.setAccessibleDescription("Insert a word that is replaced by a fact known at this line")
        self.words = QMenu(self.word_button)
        self.words.aboutToShow.connect(self._offer_words)
        self.words.triggered.connect(self._put_in_word)
        self.word_button.setMenu(self.words)
        self.add_picture = QPushButton("Add a picture …")
        self.add_picture.clicked.connect(self._add_picture)
        self.faults = FaultList(
            "No faults: games of this set can be played.",
            lambda sentence: sentence.removeprefix(f"{folder}/").removeprefix(f"{folder}: "),
        )
        self.faults.chosen.connect(self._open_fault)
        QShortcut(QKeySequence("F8"), self).activated.connect(self.faults.choose_next)
        self.undo_button, self.redo_button = QPushButton("Undo"), QPushButton("Redo")
        for button, keys, step in (
            (self.undo_button, "Ctrl+Z", self.undo),
            (self.redo_button, "Ctrl+Shift+Z", self.redo),
        ):
            button.setAccessibleDescription(f"Shortcut: {keys}")
            button.clicked.connect(step)
            QShortcut(QKeySequence(keys), self).activated.connect(step)
        self.save_button = QPushButton("Save")
        self.save_button.setAccessibleDescription("Shortcut: Ctrl+S")
        self.save_button.clicked.connect(self.save)
        QShortcut(QKeySequence("Ctrl+S"), self).activated.connect(self.save)
        self._lay_out()
        self.setWindowTitle(f"{title_text(folder.name)}[*] — template set")
        open_within_screen(self, QSize(1240, 820))
        self._check()

    # Texts ------------------------------------------------------------------------------------------------------------

    def texts(self) -> dict[str, str]:
        """Return the current texts, with the line ends of their files."""
        return {
            name: with_line_ends_of(self._on_disk[name].text, exact_text(page)) for name, page in self.pages.items()
        }

    def changed(self) -> list[str]:
        """Return the names of the texts that differ from the files on disk, and of the new pictures."""
        return [*self._changed_texts(), *self._new_pictures]

    def _changed_texts(self) -> list[str]:
        return [name for name, text in self.texts().items() if text != self._on_disk[name].text]

    def _shown_texts(self) -> dict[str, str]:
        """Return the current texts, with the line ends of the editors."""
        return {name: exact_text(page) for name, page in self.pages.items()}

    @Slot()
    def save(self) -> bool:
        """Write all changed files, each file in one step.

        Return False if the person declined to save, or if saving has failed.
        """
        faults = template_draft(self.folder, self.texts(), self._new_pictures).faults
        count = f"{len(faults)} {'fault remains' if len(faults) == 1 else 'faults remain'}"
        if faults and not self._asked(f"{count}. thbridge refuses a set with faults.", "Save anyway"):
            return False
        try:
            others = self._changed_by_others()
            question = f"Another program changed these files since this window read them: {', '.join(others)}."
            if others and not self._asked(question, "Overwrite"):
                return False
            for name in self._changed_texts():
                path = self.folder / name
                self._on_disk[name] = write_edited(path, self.texts()[name], self._on_disk[name].marked)
            for name in list(self._new_pictures):
                with suppress(OSError):  # The next statement reports the error.
                    (self.folder / PICTURES).mkdir(exist_ok=True)
                write_whole(path_inside(self.folder / PICTURES, name), self._new_pictures[name])
                del self._new_pictures[name]
        except BadFile as fault:
            self._show_problem(str(fault))
            return False
        finally:
            self._show_state()
        return True

    def _changed_by_others(self) -> list[str]:
        """Return the names of the files to write that other programs have changed since they were read."""
        texts = [name for name in self._changed_texts() if read_edited(self.folder / name) != self._on_disk[name]]
        return texts + [name for name in self._new_pictures if self._picture_on_disk(name) != self._replaced.get(name)]

    def _picture_on_disk(self, name: str) -> bytes | None:
        try:
            return path_inside(self.folder / PICTURES, name).read_bytes()
        except (OSError, BadFile):
            return None

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask for confirmation if changes would be lost."""
        if self.changed():
            box = QMessageBox(QMessageBox.Icon.Question, self.folder.name, "Save the changes?", parent=self)
            box.setObjectName("question")
            standard = QMessageBox.StandardButton
            box.setStandardButtons(standard.Save | standard.Discard | standard.Cancel)
            chosen = box.exec()
            if chosen == standard.Cancel or (chosen == standard.Save and not self.save()):
                event.ignore()
                return
        self._pause.stop()
        self._worker.close()
        super().closeEvent(event)

    # Checks and updates -----------------------------------------------------------------------------------------------

    @Slot()
    def _typed(self) -> None:
        self._pause.start()
        self._show_state()

    @Slot()
    def _check(self) -> None:
        self._worker.ask(partial(template_draft, self.folder, self.texts(), dict(self._new_pictures)))

    @Slot(object)
    def _checked(self, draft: TemplateDraft) -> None:
        self.draft = draft
        self.faults.show_faults(draft.faults)
        if draft.templates is not None:
            self._properties, self._pictures = draft.templates.properties, draft.templates.pictures
            kinds = [name_in_words(kind.name) for kind in draft.templates.kinds]
            if kinds != [self.treasure.itemText(row) for row in range(self.treasure.count())]:
                with QSignalBlocker(self.treasure):
                    self.treasure.clear()
                    self.treasure.addItems(kinds)
            self._show_pictures()
        self._refresh_sheets()
        self._show_preview()
        self._show_state()

    @Slot()
    def _refresh_sheets(self) -> None:
        faults = () if self.draft is None else self.draft.faults
        for page in self.sheets.values():
            page.refresh({**self._pictures, **self._new_pictures}, faults)

    @Slot()
    def _show_preview(self) -> None:
        draft = self.draft
        if draft is None or draft.templates is None:
            return
        kind = draft.templates.kinds[max(self.treasure.currentIndex(), 0)]
        place = self._place()
        said = [
            *sentences(draft.templates, place, kind),
            *translations(draft.templates, self.folder, place, kind),
        ]
        lines = [*said, "", *contents(draft.templates)]
        self.preview.setPlainText("\n".join(lines))

    def _place(self) -> PreviewPlace:
        if self.place.currentIndex() <= 0:
            return NOWHERE
        return place_on(read_map(shipped().root / "maps" / self.place.currentText()))

    def _show_pictures(self) -> None:
        self.pictures.clear()
        if self.draft is None or self.draft.templates is None:
            return
        for kind in self.draft.templates.kinds:
            item = QListWidgetItem(shown(f"{name_in_words(kind.name)}\n{kind.image}"))
            item.setData(Qt.ItemDataRole.UserRole, kind.image)
            picture = QPixmap()
            picture.loadFromData(self.draft.templates.pictures[kind.image or ""])
            item.setIcon(QIcon(picture))
            self.pictures.addItem(item)

    def _show_state(self) -> None:
        changed = self.changed()
        self.setWindowModified(bool(changed))
        self.save_button.setEnabled(bool(changed))
        self.undo_button.setEnabled(bool(self._done))
        self.redo_button.setEnabled(bool(self._undone))
        texts = self.texts()
        lines = [line for name, disk in self._on_disk.items() for line in differences(disk.text, texts[name], name)]
        self.changes.show_changes([*lines, *(f"+ {PICTURES}/{name}" for name in self._new_pictures)])

    @Slot(int)
    def _open_fault(self, row: int) -> None:
        fault = None if self.draft is None else self.draft.faults[row]
        if fault is None or not fault.path.is_relative_to(self.folder):
            return
        name = fault.path.relative_to(self.folder).as_posix()
        if name not in self.pages:
            return
        for page in self.sheets.values():
            if self.tabs.currentWidget() not in self.pages.values() and page.go_to(fault):
                self.tabs.setCurrentWidget(page)
                page.table.setFocus()
                return
        text = self.pages[name]
        self.tabs.setCurrentWidget(text)
        if fault.line is not None:
            text.setTextCursor(QTextCursor(text.document().findBlockByNumber(fault.line - 1)))
            text.centerCursor()
        text.setFocus()

    # Steps ------------------------------------------------------------------------------------------------------------

    @Slot(object)
    def _apply(self, changed: Texts) -> None:
        """Write new texts into their pages, as one step for undo."""
        self._step = []
        for name, text in changed.items():
            _replace_text(self.pages[name], text)
        step, self._step = tuple(self._step), None
        if step:
            self._note_step(step)
        self._refresh_sheets()

    def _stepped(self, name: str) -> None:
        """Record that a page has one more step that can be undone."""
        if self._step is not None:
            self._step.append(name)
        else:
            self._note_step((name,))

    def _note_step(self, step: tuple[str, ...]) -> None:
        self._done.append(step)
        self._undone.clear()
        self._show_state()

    @Slot()
    def undo(self) -> None:
        """Undo the last step in all files that it changed."""
        self._go(self._done, self._undone, QPlainTextEdit.undo)

    @Slot()
    def redo(self) -> None:
        """Redo the step that was undone last."""
        self._go(self._undone, self._done, QPlainTextEdit.redo)

    def _go(
        self, steps: list[tuple[str, ...]], others: list[tuple[str, ...]], act: Callable[[QPlainTextEdit], None]
    ) -> None:
        if steps:
            step = steps.pop()
            for name in step:
                act(self.pages[name])
            others.append(step)
            self._refresh_sheets()
            self._show_state()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Let the window receive the keys for undo and redo, because a page knows only its own steps."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent) and _is_of_steps(event):
            event.ignore()
            return True
        return super().eventFilter(watched, event)

    @Slot()
    def _offer_words(self) -> None:
        """Fill the menu with the reserved words that are allowed on the line of the cursor."""
        self.words.clear()
        page = self._questions()
        scenario = None if page is None else scenario_on(exact_text(page), page.textCursor().blockNumber() + 1)
        if scenario is None:
            self.words.addAction("Words can only be inserted in questions").setEnabled(False)
            return
        for name, meaning in allowed_words(scenario, self._properties).items():
            self.words.addAction(button_text(f"£{name}£ – {meaning}")).setData(f"£{name}£")

    @Slot(QAction)
    def _put_in_word(self, chosen: QAction) -> None:
        page = self._questions()
        if page is not None:
            page.insertPlainText(chosen.data())
            page.setFocus()

    def _questions(self) -> QPlainTextEdit | None:
        """Return the open page if it contains questions."""
        shown = self.tabs.currentWidget()
        pages = (page for name, page in self.pages.items() if Path(name).name == DIALOGUE_TEXT)
        return next((page for page in pages if page is shown), None)

    def _change_picture(self, item: QListWidgetItem) -> None:
        """Replace a treasure's picture by another image file. The file is written when the set is saved."""
        self._take_picture(item.data(Qt.ItemDataRole.UserRole))

    @Slot()
    def _add_picture(self) -> None:
        """Add an image file to the pictures, so that a treasure can use it."""
        self._take_picture(None)

    def _take_picture(self, name: str | None) -> None:
        picked, _ = QFileDialog.getOpenFileName(self, "Choose a picture", str(self.folder), "Images (*.png *.jpg)")
        if not picked:
            return
        try:
            data = Path(picked).read_bytes()
        except OSError as error:
            self._show_problem(f"{picked}: cannot be read ({error.strerror}). Choose another file.")
            return
        if QPixmap().loadFromData(data):
            # Replace blanks, because the list of treasures does not allow blanks in file names.
            taken = name or "_".join(Path(picked).name.split())
            self._replaced.setdefault(taken, self._picture_on_disk(taken))
            self._new_pictures[taken] = data
            self._typed()
        else:
            self._show_problem(f"{picked}: this is not a picture. Choose a PNG or JPEG file.")

    def _show_problem(self, words: str) -> None:
        box = QMessageBox(QMessageBox.Icon.Critical, self.folder.name, words, parent=self)
        box.setObjectName("question")
        box.exec()

    def _asked(self, words: str, yes: str) -> bool:
        box = QMessageBox(QMessageBox.Icon.Warning, self.folder.name, words, parent=self)
        box.setObjectName("question")
        agree = box.addButton(yes, QMessageBox.ButtonRole.AcceptRole)
        box.setDefaultButton(box.addButton(QMessageBox.StandardButton.Cancel))
        box.exec()
        return box.clickedButton() is agree

    # Layout -----------------------------------------------------------------------------------------------------------

    def _made_page(self, name: str, text: str) -> QPlainTextEdit:
        page = QPlainTextEdit(plain_lines(text), tabChangesFocus=True)
        page.setAccessibleName(name)
        follow_text(page, lambda it: it.setFont(fixed_font()))
        page.textChanged.connect(self._typed)
        page.document().undoCommandAdded.connect(partial(self._stepped, name))
        # Disable the context menu, because its undo would undo only the steps of this page.
        page.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
        page.installEventFilter(self)
        return page

    def _made_sheet(self, title: str) -> SheetPage:
        page = SheetPage(_ROW_NAMES[title], lambda: sheets_of(self._shown_texts(), self._picture_names()).get(title))
        page.changed.connect(self._apply)
        return page

    def _picture_names(self) -> list[str]:
        folder = self.folder / PICTURES
        there = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
        return sorted(there | set(self._new_pictures))

    def _lay_out(self) -> None:
        self.tabs = QTabWidget()
        self.tabs.setAccessibleName("Sheets and files of the set")
        self.tabs.setUsesScrollButtons(False)
        self.tabs.setElideMode(Qt.TextElideMode.ElideRight)
        for title, sheet in self.sheets.items():
            self.tabs.addTab(sheet, button_text(title))
        for name, page in self.pages.items():
            self.tabs.addTab(page, button_text(name))
        self.tabs.addTab(self.changes, "Changes")
        left, right = QWidget(), QWidget()
        column = spaced(QVBoxLayout(left), GAP, 0)
        column.addWidget(self.tabs, 1)
        column.addWidget(self.word_button)
        column = spaced(QVBoxLayout(right), GAP, 0)
        choices = spaced(QHBoxLayout(), GAP)
        column.addLayout(choices)
        choices.addWidget(self.treasure, 1)
        choices.addWidget(self.place, 1)
        column.addWidget(self.preview, 3)
        column.addWidget(label("Pictures. Press Enter to replace the selected picture.", "small", muted=True))
        column.addWidget(self.pictures, 2)
        column.addWidget(self.add_picture)
        self.tabs.currentChanged.connect(lambda _: self.word_button.setVisible(self._questions() is not None))
        self.word_button.setVisible(False)
        body = QSplitter(Qt.Orientation.Horizontal)
        body.setChildrenCollapsible(False)
        body.addWidget(left)
        body.addWidget(right)
        inside = QWidget()
        rows = spaced(QVBoxLayout(inside), GAP, 2 * GAP)
        head = spaced(QHBoxLayout(), GAP)
        rows.addLayout(head)
        head.addWidget(label(self.folder.name, "title", bold=True), 1)
        for button in (self.undo_button, self.redo_button, self.save_button):
            head.addWidget(button)
        rows.addWidget(body, 1)
        rows.addWidget(self.faults)
        self.setCentralWidget(inside)


def _is_of_steps(event: QKeyEvent) -> bool:
    return event.matches(QKeySequence.StandardKey.Undo) or event.matches(QKeySequence.StandardKey.Redo)


def _replace_text(page: QPlainTextEdit, text: str) -> None:
    """Write a text into a page as a single undo step. Change only the part of the text that differs."""
    before = exact_text(page)
    if before == text:
        return
    start = _same(before, text)
    end = _same(before[start:][::-1], text[start:][::-1])
    cursor = QTextCursor(page.document())
    cursor.setPosition(_units(before[:start]))
    cursor.setPosition(_units(before[: len(before) - end]), QTextCursor.MoveMode.KeepAnchor)
    cursor.insertText(text[start : len(text) - end])


def _same(one: str, other: str) -> int:
    """Return the length of the beginning that two texts have in common."""
    pairs = enumerate(zip(one, other, strict=False))
    return next((index for index, (a, b) in pairs if a != b), min(len(one), len(other)))


def _units(text: str) -> int:
    """Return the length of a text in UTF-16 units, as Qt counts it."""
    return len(text.encode("utf-16-le", "surrogatepass")) // 2
