"""Row of the form for a field: its name, description, value, the origin of the value, and its faults."""

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QPointF, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QColor, QFocusEvent, QIcon, QKeyEvent, QPainter, QPen, QPixmap, QWheelEvent
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QSlider, QVBoxLayout, QWidget

from thbridge.files.errors import BadFile
from ui.model.study_form.form import FieldKind, FormField, editable_text, hint_of
from ui.model.study_form.resources import NamedResource, is_named, names_form
from ui.windows.controls import ChoiceBox
from ui.windows.look import GAP, FoldingRow, follow_text, font, label, px, spaced
from ui.windows.study.resource_list import ResourceList

_EDITOR_WIDTH = 240
_WIDE = 340
"""Width of the editor of a list, `px`."""
_WIDEST = 360
"""Maximum width of an editor, logical pixels. In a small window, a button also fits next to the editor."""
_NARROW = 128
"""Width of an editor if drawings are next to the fields, `px`."""
_WORDS = 240
"""Width of the text next to an editor, `px`."""
_NEVER_BESIDE = 10_000
_STEPS = 1000
"""Number of steps of a slider."""


class _Line(QLineEdit):
    """Text field that reports when it loses the focus, and when a person requests the list of choices."""

    left = Signal()
    listed = Signal()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Request the list of choices if the pressed key usually opens lists."""
        if event.key() == Qt.Key.Key_Down:
            self.listed.emit()
        else:
            super().keyPressEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        self.left.emit()


class _Combo(ChoiceBox):
    """Combo box that ignores the mouse wheel unless it has the focus, to prevent accidental changes."""

    def wheelEvent(self, event: QWheelEvent) -> None:
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


class _Slider(QSlider):
    """Slider that ignores the mouse wheel, to prevent accidental changes on a page that scrolls."""

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()


class FieldRow(FoldingRow):
    """Row of a field.

    Args:
        field: field shown.
        study_folder: folder of the study.
        named: function that returns the resources that the field can name at the moment.
        narrow: True if drawings are next to the row.

    Attributes:
        field: field shown.
        editor: widget in which a person types or chooses the value.
        last_widget: last widget of the row in the order of Tab.
        edited: signal: a person typed or chose a value; with the key of the field and the text.
        edit_finished: signal: a person finished editing the field; with its key.
        reset: signal: a person wants to reset the field to its default; with its key.
        file_wanted: signal: a person wants to edit the file that the field names; with the key of the field.
    """

    edited = Signal(str, str)
    edit_finished = Signal(str)
    reset = Signal(str)
    file_wanted = Signal(str)

    def __init__(
        self,
        field: FormField,
        study_folder: Path,
        named: Callable[[], tuple[NamedResource, ...]],
        *,
        narrow: bool = False,
    ) -> None:
        words, values = spaced(QVBoxLayout(), GAP // 4), spaced(QHBoxLayout(), GAP)
        super().__init__(words, values, _NEVER_BESIDE if narrow else _WORDS, 2 * GAP)
        self.field = field
        self._study_folder = study_folder
        self._named = named
        self.setObjectName(field.key)
        self._name = label(field.label, bold=True)
        self._help = label(_sentence(field.help), "small", muted=True)
        self._origin = label("", "small", muted=True)
        self._fault = label("", "small")
        self._fault.setProperty("bad", True)
        self._line: _Line | None = None
        self._combo: _Combo | None = None
        editor = (
            self._made_combo(field) if field.kind in {FieldKind.CHOICE, FieldKind.BOOLEAN} else self._made_line(field)
        )
        self._slider = self._made_slider(field) if narrow and _slides(field) else None
        wide = _NARROW if narrow else _WIDE if field.kind is FieldKind.LIST else _EDITOR_WIDTH
        follow_text(editor, lambda it: it.setFixedWidth(min(px(wide), _WIDEST)))
        editor.setAccessibleName(field.label if not field.unit else f"{field.label}, {field.unit}")
        self.editor = editor
        unit = label(field.unit, "small", muted=True)
        unit.setWordWrap(False)
        unit.setMinimumWidth((2 if narrow else 6) * GAP)
        what = "Remove" if field.own_key else "Reset"
        self.last_widget = QPushButton(what)
        self.last_widget.setAccessibleName(f"{what} {field.label}")
        self.last_widget.clicked.connect(self._reset_clicked)
        policy = self.last_widget.sizePolicy()
        policy.setRetainSizeWhenHidden(True)
        self.last_widget.setSizePolicy(policy)
        for part in (self._name, self._help, self._origin, self._fault):
            words.addWidget(part)
        self.parts.setContentsMargins(0, GAP, 0, GAP)
        self.parts.setAlignment(values, Qt.AlignmentFlag.AlignTop)
        values.addWidget(editor)
        values.addWidget(unit)
        if self._slider is not None:
            values.addWidget(self._slider, 1)
        elif narrow:
            values.addStretch(1)
        if names_form(field.key):
            edit = QPushButton("Edit …")
            edit.setAccessibleName(f"Edit the form of {field.key.partition('.')[0]}")
            edit.clicked.connect(lambda: self.file_wanted.emit(self.field.key))
            values.addWidget(edit)
        values.addWidget(self.last_widget)
        self.show_field(field, ())

    def text(self) -> str:
        """Return the text in the editor."""
        if self._combo is not None:
            return self._combo.currentText()
        return "" if self._line is None else self._line.text()

    def show_field(self, field: FormField, faults: tuple[BadFile, ...]) -> None:
        """Show the field's current value, but do not replace a text that a person is typing."""
        self.field = field
        text = editable_text(field)
        if self._line is not None and not (self._line.hasFocus() and self._line.isModified()):
            if self._line.text() != text:
                with QSignalBlocker(self._line):
                    self._line.setText(text)
                    self._line.setCursorPosition(0)
            _set_muted(self._line, field.written is None)
        if self._combo is not None and self._combo.currentText() != text:
            with QSignalBlocker(self._combo):
                if self._combo.findText(text) < 0:
                    self._combo.addItem(text)
                self._combo.setCurrentText(text)
        self._show_slider(text)
        self.last_widget.setVisible(field.written is not None)
        origin = "default" if field.written is None else f"written in line {field.line}"
        if field.written is not None and field.place != field.key and not field.own_key:
            origin += f" as {field.place}"
        default = f" · default {field.default}" if field.written is not None and field.default else ""
        hint = hint_of(field)
        self._origin.setText(" · ".join([field.key, origin]) + default + (f" · {hint}" if hint else ""))
        self._name.setText(f"● {field.label}" if field.written is not None else field.label)
        self.show_faults(tuple(f"{fault.problem}. {fault.remedy}" for fault in faults))
        self.editor.setAccessibleDescription(f"{field.help}. {origin}. {self._fault.text()}".strip())

    def show_faults(self, sentences: tuple[str, ...]) -> None:
        """Show the field's faults."""
        text = "\n".join(f"⚠ {sentence[:1].upper()}{sentence[1:].rstrip('.')}." for sentence in sentences)
        self._fault.setText(text)
        self._fault.setVisible(bool(text))

    def _made_line(self, field: FormField) -> QWidget:
        line = self._line = follow_text(_Line(), lambda it: _set_muted(it, it.font().italic()))
        line.textChanged.connect(self._typed)
        line.left.connect(self._done)
        line.returnPressed.connect(self._done)
        if field.optional:
            line.setPlaceholderText("null")
        if is_named(field.key):
            self._list = line.addAction(
                _arrow(line.palette().text().color()), QLineEdit.ActionPosition.TrailingPosition
            )
            self._list.setToolTip("Choose from a list (Down)")
            self._list.triggered.connect(self.open_list)
            line.listed.connect(self.open_list)
        return line

    def open_list(self) -> None:
        """Open the list of resources that the field can name."""
        shown = ResourceList(self.field.key, self._named(), self._study_folder, self.editor)
        shown.chosen.connect(self._chosen)
        shown.open_below(self.editor)

    def _chosen(self, value: str) -> None:
        if self._line is not None:
            self._line.setText(value)
            self._done()

    def _made_combo(self, field: FormField) -> QWidget:
        combo = self._combo = _Combo()
        choices = field.choices if field.kind is FieldKind.CHOICE else ("true", "false")
        combo.addItems([*choices, *(["null"] if field.optional else [])])
        combo.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        combo.currentTextChanged.connect(self._typed)
        return combo

    def _made_slider(self, field: FormField) -> QSlider:
        slider = _Slider(Qt.Orientation.Horizontal)
        slider.setProperty("fine", True)
        slider.setRange(0, _STEPS)
        slider.setPageStep(_STEPS // 20)
        slider.setAccessibleName(f"{field.label}, slider")
        slider.valueChanged.connect(self._slid)
        slider.sliderReleased.connect(self._done)
        return slider

    def _slid(self, place: int) -> None:
        if self._line is None:
            return
        self._line.setText(_value_at(self.field, place))

    def _show_slider(self, text: str) -> None:
        if self._slider is None or self._slider.isSliderDown():
            return
        try:
            place = _place_of(self.field, float(text))
        except ValueError:
            return
        if _value_at(self.field, self._slider.value()) != text:
            with QSignalBlocker(self._slider):
                self._slider.setValue(place)

    def _typed(self, text: str) -> None:
        if self._line is not None:
            _set_muted(self._line, False)
        self._show_slider(text)
        self.edited.emit(self.field.key, text)

    def _done(self) -> None:
        if self._line is not None:
            self._line.setModified(False)
        self.edit_finished.emit(self.field.key)

    def _reset_clicked(self) -> None:
        if self._line is not None:
            self._line.setModified(False)
        self.editor.setFocus()
        self.reset.emit(self.field.key)


def _arrow(colour: QColor) -> QIcon:
    """Return the icon of a button that opens a list."""
    side = px(16)
    pixmap = QPixmap(side, side)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(QPen(colour, 1.5))
    painter.drawPolyline([QPointF(x * side, y * side) for x, y in ((0.25, 0.4), (0.5, 0.65), (0.75, 0.4))])
    painter.end()
    return QIcon(pixmap)


def _set_muted(line: QLineEdit, muted: bool) -> None:
    """Show a default value in italics. The text below the field also says that this is the default."""
    wanted = font()
    wanted.setItalic(muted)
    line.setFont(wanted)


def _sentence(words: str) -> str:
    return words[:1].upper() + words[1:].rstrip(".") + "." if words else ""


def _slides(field: FormField) -> bool:
    return field.kind is FieldKind.NUMBER and abs(field.minimum) < 1e9 and field.maximum < 1e9


def _value_at(field: FormField, place: int) -> str:
    """Return the number at a slider's position. Small numbers have more space, because most noise values are small."""
    share = place / _STEPS
    if field.minimum < 0:
        return f"{field.minimum + (field.maximum - field.minimum) * share:.3g}"
    return f"{field.minimum + (field.maximum - field.minimum) * share**3:.3g}"


def _place_of(field: FormField, value: float) -> int:
    share = min(1.0, max(0.0, (value - field.minimum) / (field.maximum - field.minimum)))
    return round(_STEPS * (share if field.minimum < 0 else share ** (1 / 3)))
