"""Pages of the study window that show a section, search results, or the file as text."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from PySide6.QtCore import QElapsedTimer, QSignalBlocker, QTimer, Signal, SignalInstance, Slot
from PySide6.QtGui import QColor, QPalette, QTextCharFormat, QTextCursor
from PySide6.QtWidgets import (
    QHBoxLayout,
    QPlainTextEdit,
    QPushButton,
    QScrollArea,
    QTextEdit,
    QVBoxLayout,
    QWidget,
)

from ui.model.shared.line_ends import plain_lines, with_line_ends_of
from ui.model.study_form.draft import StudyDraft, search_fields
from ui.model.study_form.form import FormField, FormGroup, RepeatKind
from ui.model.study_form.resources import NamedResource, resources_for
from ui.windows.editing.exact_text import exact_text
from ui.windows.look import GAP, colours, fixed_font, follow_text, label, spaced, style_as_panel
from ui.windows.study.row import FieldRow
from ui.windows.untrusted_text import button_text

_FOUND = "found"
_MOST_FOUND = 40
_SLICE = 15
"""Milliseconds during which rows are built before the window handles other events."""


class FieldsPage(QScrollArea):
    """Page with rows of fields, and headings.

    Attributes:
        rows: rows shown, by the keys of the fields.
        edited: signal: a person typed or chose a value; with the key of the field and the text.
        edit_finished: signal: a person finished editing a field; with its key.
        reset: signal: a person wants to reset a field to its default; with its key.
        file_wanted: signal: a person wants to edit the file that a field names; with the key of the field.
        preview_wanted: signal: a person wants to see a step in the form that participants see; with its key.
        opened: signal: a person wants to see a section; with its key.
        added: signal: a person wants to add an item to a section; with the key of the section.
        removed: signal: a person wants to remove an item; with its key.
        moved: signal: a person wants to move an item one place down (1) or up (-1); with its key.
        cleared: signal: a person wants to reset all fields of a section to their defaults.
        built: signal: all rows of the page are built.
    """

    edited = Signal(str, str)
    edit_finished = Signal(str)
    reset = Signal(str)
    file_wanted = Signal(str)
    preview_wanted = Signal(str)
    opened = Signal(str)
    added = Signal(str)
    removed = Signal(str)
    moved = Signal(str, int)
    cleared = Signal(str)
    built = Signal()

    def __init__(self) -> None:
        super().__init__(widgetResizable=True)
        self.setAccessibleName("Settings")
        self.rows: dict[str, FieldRow] = {}
        self._clearing: dict[str, QPushButton] = {}
        self._naming: dict[str, list[Callable[[str], object]]] = {}
        self._moving: dict[tuple[str, int], QPushButton] = {}
        self._wanted: tuple[str, int] | str = ""
        """Target of the focus after the page is rebuilt: a button, a row, or an item whose first row gets the focus."""
        self._shape: tuple[str, ...] = ()
        self._draft: StudyDraft | None = None
        self._building: Iterator[None] = iter(())
        self._next = QTimer(self, singleShot=True, interval=0)
        self._next.timeout.connect(self._build_on)
        self._in_sight: QWidget | None = None
        """Part of the page that has the focus.

        It is kept visible until people scroll, because the page grows in several passes.
        """
        self.verticalScrollBar().rangeChanged.connect(self._keep_in_sight)
        self.verticalScrollBar().actionTriggered.connect(self._let_go)

    def show_groups(self, draft: StudyDraft, groups: tuple[FormGroup, ...], *, narrow: bool = False) -> None:
        """Show the fields of these sections. The first section has the large heading."""
        shape = tuple(part for group in groups for part in _shape_of(group))
        self._draft = draft
        if shape == self._shape:
            self._refresh(draft, groups)
            return
        if not self._wanted:
            self._wanted = next((key for key, row in self.rows.items() if row.editor.hasFocus()), "")
        self._shape, self.rows, self._in_sight = shape, {}, None
        self._building = self._build(groups, narrow=narrow)
        self._build_on()

    def go_to_added(self, key: str) -> None:
        """Go to this row, or to the first row of this item, as soon as the page shows it."""
        self._wanted = key

    def finish(self) -> None:
        """Build all remaining rows of the page now."""
        for _ in self._building:
            pass

    def _build_on(self) -> None:
        """Build rows for some more milliseconds.

        A page with many fields is built in parts, because building it at once would block the window.
        """
        began = QElapsedTimer()
        began.start()
        for _ in self._building:
            if began.elapsed() >= _SLICE:
                self._next.start()
                return

    def show_found(self, draft: StudyDraft, words: str) -> None:
        """Show the fields that a search found."""
        fields = search_fields(draft.form.all_fields(), words)
        count = f"{len(fields)} found" if len(fields) <= _MOST_FOUND else f"{len(fields)} found, {_MOST_FOUND} shown"
        group = FormGroup(
            _FOUND, f"“{words}”: {count}" if fields else f"“{words}”: nothing found", "", fields[:_MOST_FOUND], ()
        )
        self.show_groups(draft, (group,))

    def _refresh(self, draft: StudyDraft, shown: tuple[FormGroup, ...]) -> None:
        self._draft = draft
        fields = draft.fields()
        for key, row in self.rows.items():
            if key in fields:
                row.show_field(fields[key], draft.faults_of(fields[key]))
        groups = draft.groups()
        for key, button in self._clearing.items():
            button.setEnabled(key in groups and groups[key].written() > 0)
        for key, name in ((each.key, each.label) for group in shown for each in (group, *group.groups)):
            for show in self._naming.get(key, ()):
                show(name)

    def _name(self, group: FormGroup, show: Callable[[str], object]) -> None:
        """Pass a section's name to a function that shows the name, now and after each change of the name."""
        self._naming.setdefault(group.key, []).append(show)
        show(group.label)

    def _refresh_row(self, row: FieldRow) -> None:
        draft = self._draft
        if draft is not None and draft.faults:
            field = draft.fields().get(row.field.key, row.field)
            row.show_field(field, draft.faults_of(field))

    def _build(self, groups: tuple[FormGroup, ...], *, narrow: bool) -> Iterator[None]:
        """Rebuild the page, row by row."""
        inside = QWidget()
        column = spaced(QVBoxLayout(inside), 2 * GAP, 2 * GAP, GAP, 2 * GAP, 2 * GAP)
        column.addStretch(1)
        self.setWidget(inside)
        self._clearing, self._naming, self._moving = {}, {}, {}
        for index, group in enumerate(groups):
            column.insertLayout(column.count() - 1, self._head(group, first=index == 0, whole=groups[0]))
            if group.fields:
                card = QWidget()
                column.insertWidget(column.count() - 1, card)
                yield from self._fill_card(card, group.fields, narrow=narrow)
            if group.repeats is not None:
                self._fill_adding(_row(column), group)
            for inner in group.groups if index == 0 else ():
                if not any(inner.key == shown.key for shown in groups):
                    self._fill_link(_row(column), inner, removable=group.repeats is not None)
        self.built.emit()
        self._take_focus()

    def _take_focus(self) -> None:
        """Give the focus to the part that had the focus before the page was rebuilt."""
        wanted, self._wanted = self._wanted, ""
        part: QWidget | None = None
        if isinstance(wanted, tuple):
            key, by = wanted
            # At the ends of the list, an item can move in only one direction.
            part = next((b for step in (by, -by) if (b := self._moving.get((key, step))) and b.isEnabled()), None)
        elif wanted:
            part = next(
                (row.editor for key, row in self.rows.items() if key == wanted or key.startswith(f"{wanted}.")), None
            )
        if part is not None:
            # A new widget accepts the focus only after it has become visible.
            QTimer.singleShot(0, part, partial(self.focus_on, part))

    def focus_on(self, part: QWidget) -> None:
        """Give a part of the page the focus, and scroll it into view."""
        part.setFocus()
        self._in_sight = part
        self._keep_in_sight()

    @Slot()
    def _keep_in_sight(self) -> None:
        part, focused = self._in_sight, self.focusWidget()
        if part is not None and focused is not None and (part is focused or part.isAncestorOf(focused)):
            self.ensureWidgetVisible(part)

    @Slot()
    def _let_go(self) -> None:
        self._in_sight = None

    def _move(self, key: str, by: int) -> None:
        at, _, number = key.rstrip("]").rpartition("[")
        self._wanted = f"{at}[{int(number) + by}]", by
        self.moved.emit(key, by)

    def _head(self, group: FormGroup, *, first: bool, whole: FormGroup) -> QVBoxLayout:
        """Return a layout with a section's name, description and buttons."""
        head = spaced(QVBoxLayout(), GAP // 2)
        row = QHBoxLayout()
        name = label(group.label, "title" if first else "body", bold=True)
        self._name(group, name.setText)
        row.addWidget(name, 1)
        if not first and whole.repeats is RepeatKind.STEPS:
            places = [item.key for item in whole.groups]
            for words, by, end in (("Up", -1, places[0]), ("Down", 1, places[-1])):
                button = QPushButton(words)
                self._name(group, partial(_say, button, "Move {} " + words.lower()))
                button.setEnabled(group.key != end)
                button.clicked.connect(partial(self._move, group.key, by))
                self._moving[group.key, by] = button
                row.addWidget(button)
        if not first and whole.key == "steps":
            row.addWidget(self._button("Preview", group, self.preview_wanted))
        if not first and whole.repeats in {RepeatKind.ITEMS, RepeatKind.STEPS}:
            row.addWidget(self._button("Remove", group, self.removed))
        elif first and group.key not in {"", _FOUND} and group.repeats is None:
            clear = self._button("Reset all", group, self.cleared)
            clear.setEnabled(group.written() > 0)
            self._clearing[group.key] = clear
            row.addWidget(clear)
        head.addLayout(row)
        if group.help:
            head.addWidget(label(group.help[:1].upper() + group.help[1:] + ".", muted=True))
        return head

    def _button(self, words: str, group: FormGroup, signal: SignalInstance) -> QPushButton:
        button = QPushButton(words)
        self._name(group, partial(_say, button, words + (" of {}" if words == "Reset all" else " {}")))
        button.clicked.connect(lambda: signal.emit(group.key))
        return button

    def _fill_card(self, card: QWidget, fields: tuple[FormField, ...], *, narrow: bool) -> Iterator[None]:
        style_as_panel(card)
        column = spaced(QVBoxLayout(card), 0, 2 * GAP, GAP, 2 * GAP, GAP)
        folder = Path() if self._draft is None else self._draft.path.parent
        for index, field in enumerate(fields):
            if index:
                column.addWidget(_rule())
            row = FieldRow(field, folder, partial(self._named, field.key), narrow=narrow)
            row.edited.connect(self.edited)
            row.edit_finished.connect(self.edit_finished)
            row.reset.connect(self.reset)
            row.file_wanted.connect(self.file_wanted)
            column.addWidget(row)
            self.rows[field.key] = row
            self._refresh_row(row)
            yield

    def _named(self, key: str) -> tuple[NamedResource, ...]:
        return () if self._draft is None else resources_for(key, self._draft)

    def _fill_adding(self, row: QHBoxLayout, group: FormGroup) -> None:
        words = {RepeatKind.ROBOTS: "Add a robot with different software", RepeatKind.KEYS: "Add a key …"}
        what = words.get(group.repeats or RepeatKind.ITEMS, f"Add to {button_text(group.label)}")
        button = QPushButton(what)
        button.clicked.connect(lambda: self.added.emit(group.key))
        row.addWidget(button)
        row.addStretch(1)

    def _fill_link(self, row: QHBoxLayout, group: FormGroup, *, removable: bool) -> None:
        open_it = QPushButton()
        self._name(group, lambda name: open_it.setText(button_text(f"{name} ›")))
        open_it.setAccessibleDescription(group.help)
        open_it.clicked.connect(lambda: self.opened.emit(group.key))
        row.addWidget(open_it)
        if group.help and not removable:
            row.addWidget(label(group.help, "small", muted=True), 1)
        if removable:
            row.addWidget(self._button("Remove", group, self.removed))
        row.addStretch(1 if removable else 0)


def _row(column: QVBoxLayout) -> QHBoxLayout:
    """Insert an empty row before the stretch at the end of a column.

    Add the row to the column before anything is added to the row. If a stretch is added first, PySide 6.11 crashes
    when the window closes.
    """
    row = QHBoxLayout()
    column.insertLayout(column.count() - 1, row)
    return row


def _say(button: QPushButton, words: str, name: str) -> None:
    """Set the accessible name of a button: its action, and the name of the section."""
    button.setAccessibleName(words.format(name))


def _rule() -> QWidget:
    """Return a thin line between rows."""
    rule = QWidget()
    rule.setFixedHeight(1)
    rule.setAutoFillBackground(True)
    rule.setBackgroundRole(QPalette.ColorRole.Midlight)
    return rule


def _shape_of(group: FormGroup) -> tuple[str, ...]:
    """Return names that describe the widgets of a section. While they are the same, the page need not be rebuilt."""
    return (group.key, *(field.key for field in group.fields), *(inner.key for inner in group.groups))


class TextPage(QWidget):
    """Page with the file as text.

    Attributes:
        edited: signal: a person changed the text; with the whole text.
    """

    edited = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.editor = QPlainTextEdit(tabChangesFocus=True)
        self.editor.setAccessibleName("The study file as text")
        follow_text(self.editor, lambda it: it.setFont(fixed_font()))
        self._fault = label("", "small")
        self._fault.setProperty("bad", True)
        column = spaced(QVBoxLayout(self), GAP, 2 * GAP, GAP, 2 * GAP, 2 * GAP)
        column.addWidget(label("The file as text", "title", bold=True))
        column.addWidget(self._fault)
        column.addWidget(self.editor, 1)
        self.editor.textChanged.connect(self._typed)
        self._read = ""

    def show_draft(self, draft: StudyDraft) -> None:
        """Show the text of the draft, and mark its faults."""
        self._read = draft.text
        text = plain_lines(draft.text)
        if text != exact_text(self.editor) and not (self.editor.hasFocus() and self.editor.document().isModified()):
            with QSignalBlocker(self.editor):
                self.editor.setPlainText(text)
            self.mark_unmodified()
        lines = [fault.line for fault in draft.faults if fault.line is not None and fault.path == draft.path]
        self.editor.setExtraSelections([self._selection(line) for line in lines])
        sentences = "\n".join(
            f"⚠ Line {fault.line}: {fault.problem}. {fault.remedy}." for fault in draft.faults if fault.line is not None
        )
        self._fault.setText(sentences)
        self._fault.setVisible(bool(sentences))

    def go_to(self, line: int) -> None:
        """Put the cursor into a line, counted from 1."""
        block = self.editor.document().findBlockByNumber(line - 1)
        self.editor.setTextCursor(QTextCursor(block))
        self.editor.centerCursor()
        self.editor.setFocus()

    def mark_unmodified(self) -> None:
        """Mark the text shown as equal to the text of the draft."""
        self.editor.document().setModified(False)

    def _typed(self) -> None:
        self.edited.emit(with_line_ends_of(self._read, exact_text(self.editor)))

    def _selection(self, line: int) -> QTextEdit.ExtraSelection:
        selection = QTextEdit.ExtraSelection()
        ground = QColor(colours().bad)
        ground.setAlpha(48)
        form = QTextCharFormat()
        form.setBackground(ground)
        form.setProperty(QTextCharFormat.Property.FullWidthSelection, True)
        selection.format = form
        selection.cursor = QTextCursor(self.editor.document().findBlockByNumber(line - 1))
        return selection
