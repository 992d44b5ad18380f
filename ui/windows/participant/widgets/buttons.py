"""Buttons that show an `Action` by its label, its key, its cost, or the reason why it is not possible."""

from dataclasses import dataclass, replace
from typing import Literal

from PySide6.QtCore import QEvent, QRectF, QSize, Qt, Signal, SignalInstance
from PySide6.QtGui import QFocusEvent, QFont, QFontMetricsF, QHideEvent, QHoverEvent, QKeyEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QBoxLayout, QPushButton, QSizePolicy, QToolTip, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.keys import shown_key
from ui.model.playing.screen import Act, Action
from ui.windows import pointer
from ui.windows.look import GAP, Size, colours, font, px, smooth_painter
from ui.windows.participant.widgets import focus
from ui.windows.participant.widgets.painting import WRAPPED, box, key_cap, key_size, ring, sign, write

Weight = Literal["main", "large", "plain", "small", "quiet"]
"""Prominence of a button.

A "main" button is for the most likely action. "large", "plain" and "small" buttons are for one of several actions,
depending on the available space. A "quiet" button is for a minor action, and has no edge.
"""


@dataclass(frozen=True, slots=True)
class ButtonFace:
    """Content of a button. The attributes are the same as those of `Action`."""

    label: str
    key: str = ""
    enabled: bool = True
    hint: str = ""
    busy: bool = False


_ENTER = (Qt.Key.Key_Return, Qt.Key.Key_Enter)


class ParticipantButton(QPushButton):
    """Base class of the buttons in the participant's window. Each subclass paints itself.

    A button whose action is not possible at the moment can also get the focus. If this button is pressed, it shows the
    reason. A click does not give a button the focus, because Space and Enter would then press the button again.

    Args:
        texts: texts in the window's language.
        parent: parent widget.

    Attributes:
        requested: signal with the `Act` of the action shown.
        focused: signal with the button itself; it has got the focus.
    """

    requested = Signal(object)
    focused = Signal(QWidget)

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        self.face: ButtonFace | None = None
        # Name of the key as people see it.
        self._shown_key = ""
        self.act: Act | None = None
        self._pointed = False
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        self.clicked.connect(self._pressed)

    def bind(self, action: Action, name: str) -> None:
        """Set the action of the button; `name` is the name for screen readers."""
        if action.act != self.act:
            self.let_go()
        self.act = action.act
        self.show_face(ButtonFace(action.label, action.key, action.enabled, action.hint, action.pending), name)

    def show_face(self, face: ButtonFace, name: str) -> None:
        """Set the content of the button, and its name and description for screen readers.

        If the action is not possible, the description includes the reason.
        """
        self.face = face
        self._shown_key = shown_key(self._texts, face.key)
        state = "asked_for" if face.busy else "impossible"
        usual = face.enabled and not face.busy
        self.setAccessibleName(name if usual else self._texts.text(f"window.{state}", name=name))
        key = self._texts.text("window.key", key=self._shown_key) if face.key else ""
        self.setAccessibleDescription(" ".join(part for part in (face.hint, key) if part))
        self.setToolTip(face.hint)

    def pointed_at(self) -> bool:
        """Return True if the pointer was moved onto the button and the button can be pressed."""
        return self.face is not None and self.face.enabled and (self._pointed or self.isDown())

    def let_go(self) -> None:
        """Ignore the pointer and an unfinished press, because both were meant for the previous content."""
        self.setDown(False)
        self.set_pointed(False)

    def set_pointed(self, pointed: bool) -> None:
        """Store whether the pointer was moved onto the button."""
        if pointed != self._pointed:
            self._pointed = pointed
            self.update()

    def hideEvent(self, event: QHideEvent) -> None:
        """Store that the pointer is not on the button."""
        super().hideEvent(event)
        self.set_pointed(False)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Report that the button has got the focus, so that a scroll area can show the button."""
        super().focusInEvent(event)
        self.focused.emit(self)

    def event(self, event: QEvent) -> bool:
        """Follow the pointer, and let Enter press the button before the window's shortcuts receive Enter.

        Shortcuts receive Space, because Space is a blank while a person types a name.
        """
        if event.type() == QEvent.Type.HoverLeave:
            self.set_pointed(False)
        elif isinstance(event, QHoverEvent) and pointer.has_moved(self, event.position()):
            self.set_pointed(True)
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent) and _is_enter(event):
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Let Enter press the button, as Space does, and let arrow keys move the focus to a neighbor."""
        if event.key() in focus.ARROWS:
            focus.move_focus(self, event.key())
        elif event.key() in _ENTER:
            if not event.isAutoRepeat():
                self.click()
        else:
            super().keyPressEvent(event)

    def _pressed(self) -> None:
        face = self.face
        if face is None or face.busy:
            return
        if not face.enabled:
            QToolTip.showText(self.mapToGlobal(self.rect().bottomLeft()), face.hint, self)
        elif self.act is not None:
            self.requested.emit(self.act)


class ActionButton(ParticipantButton):
    """Usual button, with a label, an optional hint below the label, and the key on the right.

    While the key is not shown, its space stays free, so that nothing moves.
    """

    def __init__(
        self, texts: Texts, weight: Weight = "plain", *, hints: bool = False, parent: QWidget | None = None
    ) -> None:
        super().__init__(texts, parent)
        self._action: Action | None = None
        self._weight = weight
        self._hints = self._breaks = hints
        self._kept: ButtonFace | None = None
        # Latest key of the act on the button.
        self._last_key = ""
        # A wrapped label needs more than the usual height.
        policy = QSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Fixed)
        if hints:
            policy = QSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        policy.setHeightForWidth(True)
        self.setSizePolicy(policy)

    def show_action(self, action: Action, longest: Action | None = None) -> None:
        """Show this action; do nothing if it is already shown.

        Args:
            action: action to show.
            longest: action with the longest texts. It determines the size, so that nothing moves when it is shown.
        """
        if longest is not None:
            kept = ButtonFace(longest.label, longest.key, longest.enabled, longest.hint, longest.pending)
            if kept != self._kept:
                self._kept = kept
                self.updateGeometry()
        if action != self._action:
            if self._action is None or action.act != self._action.act:
                self._last_key = ""
            self._action = action
            self.bind(action, action.label)

    def show_hints(self, shown: bool) -> None:
        """If `shown` is True, show the hint below the label, otherwise only as a tool tip."""
        if shown != self._hints:
            self._hints = shown
            self.updateGeometry()
            self.update()

    def show_face(self, face: ButtonFace, name: str) -> None:
        """Show this content of the button."""
        before = self.face
        super().show_face(face, name)
        self._last_key = self._shown_key or self._last_key
        if before is None or replace(before, enabled=face.enabled) != face:
            self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        """Return the size of the label on one line, with the hint below it."""
        face = self.face
        if face is None:
            return QSize(0, 0)
        wide = QFontMetricsF(self._font()).horizontalAdvance(face.label) + self._width_next_to_label(face)
        if self._hints and face.hint:
            hint = min(px(260), QFontMetricsF(font("small")).horizontalAdvance(face.hint))
            wide = max(wide, hint + self._width_next_to_label(face, below=True))
        width = int(wide) + 2
        return QSize(width, self.heightForWidth(width))

    def minimumSizeHint(self) -> QSize:
        """Return the smallest size. Labels can wrap if the button can have hints."""
        hint = self.sizeHint()
        return QSize(min(hint.width(), px(96)), hint.height()) if self._breaks else hint

    def heightForWidth(self, width: int) -> int:
        """Return the height that the wrapped lines need."""
        high = max((self._words_high(face, width) for face in (self.face, self._kept) if face is not None), default=0.0)
        return int(max(high, key_size("X")[1]) + 2.0 * self._above()) + 1 if self.face is not None else 0

    def _words_high(self, face: ButtonFace, width: int) -> float:
        """Return the height of the wrapped label and hint."""
        below = not self._has_room_for_key(face, width)
        text = self._height(face.label, self._font(), width - self._width_next_to_label(face, below=below))
        if self._hints and face.hint:
            text += self._height(face.hint, font("small"), width - self._width_next_to_label(face, below=True)) + 2.0
        return text

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the background, the words, the key, and the focus ring."""
        face, palette = self.face, colours()
        if face is None:
            return
        painter = smooth_painter(self)
        rect = QRectF(self.rect())
        ready = face.enabled and not face.busy
        filled = (self._weight == "main" or self.isChecked()) and ready
        ink = palette.on_accent if filled else palette.text if ready else palette.muted
        edge = palette.accent if filled else palette.line
        ground = palette.accent if filled else palette.track if self.pointed_at() or face.busy else palette.panel
        if self._weight != "quiet" or self.pointed_at() or self.hasFocus() or not ready:
            box(painter, rect, ground, edge, dashed=not ready)
        if filled and self.pointed_at():
            box(painter, rect.adjusted(2, 2, -2, -2), palette.accent, palette.on_accent)
        if self.hasFocus():
            ring(painter, rect, palette.on_accent if filled else palette.accent)
        key_wide, key_high = key_size(self._last_key) if self._has_room_for_key(face, rect.width()) else (0.0, 0.0)
        text = rect.adjusted(1.5 * GAP, self._above(), -1.5 * GAP, -self._above())
        line = QFontMetricsF(self._font()).height()
        if key_wide:
            # The key is next to the label, because a hint below the label uses the whole width.
            middle = text.top() + line / 2.0 if self._hints and face.hint else rect.center().y()
            cap = QRectF(text.right() - key_wide, middle - key_high / 2.0, key_wide, key_high)
            if face.key:
                key_cap(painter, cap, self._shown_key, palette.on_accent if filled else palette.muted)
        if face.busy:
            side = key_size("X")[1]
            busy = QRectF(text.left(), rect.center().y() - side / 2.0, side, side)
            sign(painter, busy.adjusted(2, 2, -2, -2), "busy", ink)
            text.setLeft(text.left() + side + GAP / 2.0)
        taken = key_wide + GAP if key_wide else 0.0
        self._words(painter, text, taken, face, ink, palette.on_accent if filled else palette.muted)

    def _words(self, painter: QPainter, area: QRectF, taken: float, face: ButtonFace, ink: str, faint: str) -> None:
        """Draw the label and the hint in an area; `taken` is the width of the key on the right of the label."""
        label = area.adjusted(0, 0, -taken, 0)
        if not (self._hints and face.hint):
            centred = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            write(painter, label, face.label, self._font(), ink, WRAPPED if self._last_key else centred)
            return
        high = self._height(face.label, self._font(), label.width())
        above = Qt.AlignmentFlag.AlignTop | Qt.TextFlag.TextWordWrap
        write(painter, label, face.label, self._font(), ink, above)
        write(painter, area.adjusted(0, high + 2.0, 0, 4.0), face.hint, font("small"), faint, above)

    def _font(self) -> QFont:
        sizes: dict[Weight, Size] = {"large": "title", "small": "small"}
        return font(sizes.get(self._weight, "body"), bold=self._weight in ("main", "large"))

    def _above(self) -> float:
        return {"main": GAP, "large": 1.5 * GAP, "plain": GAP, "quiet": 0.6 * GAP, "small": 1.5}[self._weight]

    def _has_room_for_key(self, face: ButtonFace, width: float) -> bool:
        """Return True if each word of the label fits next to the key. If not, only the tool tip shows the key."""
        metrics = QFontMetricsF(self._font())
        longest = max(map(metrics.horizontalAdvance, face.label.split()), default=0.0)
        return longest <= width - self._width_next_to_label(face)

    def _width_next_to_label(self, face: ButtonFace, *, below: bool = False) -> float:
        """Return the width of all parts next to the label, or next to the hint below the label."""
        busy = key_size("X")[1] + GAP / 2.0 if face.busy else 0.0
        key = 0.0 if below else key_size(self._last_key)[0]
        return 3.0 * GAP + (key + GAP if key else 0.0) + busy

    @staticmethod
    def _height(text: str, type_: QFont, width: float) -> float:
        frame = QRectF(0.0, 0.0, max(width, 1.0), 10000.0)
        return QFontMetricsF(type_).boundingRect(frame, int(Qt.TextFlag.TextWordWrap), text).height()


def _is_enter(event: QKeyEvent) -> bool:
    return event.key() in _ENTER and event.modifiers() in (
        Qt.KeyboardModifier.NoModifier,
        Qt.KeyboardModifier.KeypadModifier,
    )


class ActionWidget(QWidget):
    """Base class of the parts of the window that contain buttons.

    Attributes:
        requested: signal with the `Act` of the pressed button.
    """

    requested = Signal(object)


class ActionRow:
    """Buttons in a layout, one for each action. They have the same style, and are reused when the actions change.

    Args:
        texts: texts in the window's language.
        layout: layout that gets the buttons.
        requested: signal that passes on the acts of pressed buttons.
        weight: weight of each button.
        hints: True to show the actions' hints.
    """

    def __init__(
        self,
        texts: Texts,
        layout: QBoxLayout,
        requested: SignalInstance,
        weight: Weight = "plain",
        *,
        hints: bool = False,
    ) -> None:
        self._texts = texts
        self._layout = layout
        self._requested = requested
        self._weight: Weight = weight
        self._hints = hints
        self.buttons: list[ActionButton] = []

    def show_actions(self, actions: tuple[Action, ...]) -> None:
        """Show these actions on the buttons, in this order."""
        while len(self.buttons) < len(actions):
            made = ActionButton(self._texts, self._weight, hints=self._hints)
            made.requested.connect(self._requested)
            self.buttons.append(made)
            self._layout.addWidget(made)
        for button, action in zip(self.buttons, actions, strict=False):
            button.show_action(action)
            button.show()
        for spare in self.buttons[len(actions) :]:
            spare.hide()
