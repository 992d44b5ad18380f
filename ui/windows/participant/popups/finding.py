"""Views of a found treasure: its picture, the robot's sensor readings, and the result of naming the treasure."""

from collections.abc import Sequence
from dataclasses import replace

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPaintEvent, QPixmap
from PySide6.QtWidgets import (
    QGridLayout,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.properties import PropertyDrawing
from ui.model.playing.keys import shown_key
from ui.model.playing.screen import Act, Action, EnlargePicture, TellPropertyAct, TreasureFact
from ui.windows import look
from ui.windows.look import GAP, RADIUS, colours, follow_text, font, px, smooth_painter, spaced
from ui.windows.participant.widgets.buttons import ActionButton, ParticipantButton
from ui.windows.participant.widgets.painting import WRAPPED, ring, sign, write
from ui.windows.participant.widgets.panels import TitledPanel

PICTURE = QSize(208, 156)
"""Size of a picture in a pop-up, logical pixels. It is the same in all pop-ups, at all sizes of text."""
FACTS_WIDTH = 112
"""Smallest width of the known facts about a treasure, `px`."""
_VALUES_A_ROW = 3


def find_size() -> QSize:
    """Return the usual size of a pop-up about a found treasure, logical pixels: names fit next to the picture."""
    return QSize(PICTURE.width() + 6 * GAP + px(240), px(330))


class TreasurePicture(ParticipantButton):
    """Picture of a treasure. A press enlarges the picture, and another press shrinks it again.

    If there is no picture, a frame with a note is shown.

    Args:
        texts: texts in the window's language.
        size: fixed size. If None, the picture fills the available space.
        parent: parent widget.
    """

    def __init__(self, texts: Texts, size: QSize | None = PICTURE, parent: QWidget | None = None) -> None:
        super().__init__(texts, parent)
        self._name = texts.text("window.picture_of_find")
        self._data: bytes | None = None
        self._note = ""
        self._pixmap = QPixmap()
        self.setAccessibleName(self._name)
        if size is None:
            self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        else:
            self.setFixedSize(size)

    def sizeHint(self) -> QSize:
        """Return the size of a picture in a pop-up."""
        return QSize(PICTURE)

    def minimumSizeHint(self) -> QSize:
        """Return the size of a picture in a pop-up, which is the smallest size of a picture."""
        return QSize(PICTURE)

    def show_picture(self, data: bytes | None, note: str = "", enlarge: Action | None = None) -> None:
        """Show a picture, or a note with the reason why there is no picture.

        Args:
            data: bytes of the image file; None if there is no picture.
            note: note to show if there is no picture.
            enlarge: action of a press.
        """
        if data != self._data:
            self._pixmap = QPixmap()
            if data is not None and not self._pixmap.loadFromData(data):
                note = self._texts.text("window.picture_broken")
        elif self._pixmap.isNull() and data is not None:
            note = self._note
        self._data, self._note = data, note
        if enlarge is not None and not self._pixmap.isNull():
            self.bind(enlarge, self._name)
        self.setEnabled(enlarge is not None and not self._pixmap.isNull())
        self.setAccessibleName(
            (note or self._texts.text("window.no_picture_yet")) if self._pixmap.isNull() else self._name
        )
        self.setCursor(Qt.CursorShape.PointingHandCursor if self.isEnabled() else Qt.CursorShape.ArrowCursor)
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the picture in the largest size that fits."""
        palette = colours()
        painter = smooth_painter(self)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        rect = QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        painter.setPen(QColor(palette.accent if self.pointed_at() and self.isEnabled() else palette.line))
        painter.setBrush(QColor(palette.track))
        painter.drawRoundedRect(rect, RADIUS - 2, RADIUS - 2)
        if self._pixmap.isNull():
            wrap = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            write(painter, rect.adjusted(GAP, GAP, -GAP, -GAP), self._note, font("small"), palette.muted, wrap)
            return
        inside = rect.adjusted(2, 2, -2, -2).size()
        size = self._pixmap.size().toSizeF().scaled(inside, Qt.AspectRatioMode.KeepAspectRatio)
        target = QRectF(0.0, 0.0, size.width(), size.height())
        target.moveCenter(rect.center())
        painter.drawPixmap(target, self._pixmap, QRectF(self._pixmap.rect()))
        if self.hasFocus():
            ring(painter, rect, palette.accent)


class PicturePlace(QWidget):
    """Place for a picture. Until there is a picture, a button that takes a picture is shown.

    The place has space for both, so that nothing moves when the picture appears.

    Attributes:
        picture: the picture.
        take: the button.
    """

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.picture, self.take = TreasurePicture(texts), ActionButton(texts, hints=True)
        grid = spaced(QGridLayout(self), 0, 0)
        grid.addWidget(self.picture, 0, 0, 1, 3, Qt.AlignmentFlag.AlignTop)
        grid.addWidget(self.take, 0, 1, Qt.AlignmentFlag.AlignVCenter)
        for margin in (0, 2):
            grid.setColumnMinimumWidth(margin, GAP)
        grid.setColumnStretch(1, 1)
        for part in (self.picture, self.take):
            keeping = part.sizePolicy()
            keeping.setRetainSizeWhenHidden(True)
            part.setSizePolicy(keeping)
        self.take.hide()
        self.setFixedWidth(PICTURE.width())
        follow_text(self, PicturePlace._fit)

    def _fit(self) -> None:
        """Set the height that the button's words need at the width of the picture."""
        self.take.setMinimumHeight(self.take.heightForWidth(PICTURE.width() - 2 * GAP))

    def show_place(self, picture: bytes | None, note: str, take: Action | None, enlarge: Action | None) -> None:
        """Show the picture, the button that takes it, or a note with the reason why there is neither."""
        self.picture.show_picture(picture, note, enlarge)
        if take is not None:
            self.take.show_action(take)
            self._fit()
        self.take.setVisible(take is not None)
        self.picture.setVisible(take is None)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the frame of the picture."""
        palette = colours()
        painter = smooth_painter(self)
        painter.setPen(QColor(palette.line))
        painter.setBrush(QColor(palette.track))
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), RADIUS - 2, RADIUS - 2)


class PicturePanel(TitledPanel):
    """Panel with an enlarged picture. A press shrinks the picture again."""

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(texts, texts.text("window.picture"), parent)
        self.picture = TreasurePicture(texts, None)
        self.picture.requested.connect(self.requested)
        self.close_button = ActionButton(texts)
        self.close_button.requested.connect(self.requested)
        self.top.addWidget(self.close_button)
        self.rows.addWidget(self.picture, 1)

    def show_large(self, data: bytes, title: str, robot: int) -> None:
        """Show this picture of a found treasure, with a title and the robot's chip."""
        close = Action(EnlargePicture(), self._texts.text("popups.close"), "Esc")
        self.entitle(title, robot)
        self.close_button.show_action(close)
        self.picture.show_picture(data, enlarge=close)

    def wanted(self, width: int, height: int) -> QSize:
        """Return the size of the available space."""
        return QSize(width, height)


class TreasureFacts(QWidget):
    """List of the known facts about a treasure. Each fact has a patch of color, a drawing of a shape, or a label."""

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        # Facts shown; None while the robot is still sensing.
        self._facts: tuple[TreasureFact, ...] | None = None
        follow_text(self, lambda it: it.setMinimumWidth(px(FACTS_WIDTH)))
        policy = QSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        policy.setHeightForWidth(True)
        self.setSizePolicy(policy)

    def sizeHint(self) -> QSize:
        """Return the size of all lines, at least of one line."""
        return QSize(px(FACTS_WIDTH), int(max(len(self._facts or ()), 1) * self._line()) + GAP)

    def heightForWidth(self, width: int) -> int:
        """Return the height of the wrapped lines."""
        return int(sum(self._height(fact, width) for fact in self._facts or ()) or self._line()) + GAP

    def show_facts(self, facts: tuple[TreasureFact, ...] | None) -> None:
        """Show the facts whose values are known. If `facts` is None, show that the robot is still sensing."""
        known = None if facts is None else tuple(fact for fact in facts if fact.value)
        if known == self._facts and self.accessibleName():
            return
        self._facts = known
        texts = self._texts
        spoken = [texts.text("window.fact_sentence", label=fact.label, value=fact.shown) for fact in known or ()]
        nothing = texts.text("window.still_looking" if known is None else "window.nothing_sensed")
        self.setAccessibleName(" ".join(spoken) or nothing)
        self.updateGeometry()
        self.update()

    def _line(self) -> float:
        return QFontMetricsF(font()).height() + GAP

    def _height(self, fact: TreasureFact, width: float) -> float:
        """Return the height of a fact's words next to its drawing."""
        frame = QRectF(0.0, 0.0, max(width - self._drawing_width(fact), 1.0), 10000.0)
        return (
            QFontMetricsF(font()).boundingRect(frame, int(Qt.TextFlag.TextWordWrap), self._words(fact)).height() + GAP
        )

    def _drawing_width(self, fact: TreasureFact) -> float:
        """Return the width of a fact's drawing and of the gap next to it."""
        return 0.0 if fact.drawn is PropertyDrawing.NONE else self._line() - 4.0 + 1.5 * GAP

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the lines."""
        palette = colours()
        painter = smooth_painter(self)
        if not self._facts:
            nothing = self._texts.text("window.looking" if self._facts is None else "window.nothing_sensed")
            write(painter, QRectF(self.rect()), nothing, font(), palette.muted)
            return
        top = 0.0
        for fact in self._facts:
            line = QRectF(0.0, top, self.width(), self._height(fact, self.width()))
            top = line.bottom() + GAP / 2
            side = self._line() - 4.0
            patch = QRectF(line.left() + 1, line.top() + 2, side, side)
            painter.setPen(QColor(palette.line))
            if fact.drawn is PropertyDrawing.COLOUR:
                swatch = QColor(fact.value.casefold().replace(" ", ""))
                painter.setBrush(swatch if swatch.isValid() else QColor(palette.track))
                painter.drawRoundedRect(patch, 4, 4)
            elif fact.drawn is PropertyDrawing.SHAPE:
                self._shape(painter, patch, fact.value.casefold())
            write(
                painter,
                line.adjusted(self._drawing_width(fact), 0, 0, 0),
                self._words(fact),
                font(),
                palette.text,
                WRAPPED,
            )

    @staticmethod
    def _shape(painter: QPainter, patch: QRectF, words: str) -> None:
        """Draw a shape that matches the words: round or square, and large or small."""
        inset = 0.28 * patch.width() if "small" in words else 0.04 * patch.width()
        shape = patch.adjusted(inset, inset, -inset, -inset)
        painter.setPen(QColor(colours().text))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if "round" in words:
            painter.drawEllipse(shape)
        elif "square" in words:
            painter.drawRect(shape)

    def _words(self, fact: TreasureFact) -> str:
        """Return a fact in words; a fact with a drawing needs no label."""
        drawn = fact.drawn is not PropertyDrawing.NONE
        return fact.shown if drawn else self._texts.text("window.fact", label=fact.label, value=fact.shown)


class FactActs(QWidget):
    """Buttons for further facts about a treasure: one for each property to measure, and one for each value to report.

    Signals:
        requested: a person has pressed a button; with its `Act`.
    """

    requested = Signal(object)

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        self._rows = spaced(QVBoxLayout(self), GAP, 0)
        # Buttons shown, by the label of their property.
        self._acts: list[tuple[str, list[Act]]] = []
        self._buttons: list[ActionButton] = []

    def show_facts(self, facts: Sequence[TreasureFact]) -> None:
        """Show the buttons for these facts."""
        offered = [fact for fact in facts if fact.acts]
        acts = [(fact.label, [action.act for action in fact.acts]) for fact in offered]
        if acts != self._acts:
            self._acts = acts
            self._lay_out(offered)
        actions = [action for fact in offered for action in fact.acts]
        for button, action in zip(self._buttons, actions, strict=True):
            # The key is shown next to the question, because it moves from one value to the next.
            button.show_action(replace(action, key="") if isinstance(action.act, TellPropertyAct) else action)
        self.setVisible(bool(offered))

    def _lay_out(self, offered: Sequence[TreasureFact]) -> None:
        self._buttons = []
        while (item := self._rows.takeAt(0)) is not None:
            if (row := item.widget()) is not None:
                row.hide()
                row.deleteLater()
        for fact in offered:
            row = QWidget(self)
            grid = spaced(QGridLayout(row), GAP // 2, 0)
            if fact.tell:
                key = shown_key(self._texts, next((action.key for action in fact.tell if action.key), ""))
                asked = f"{self._texts.text('window.as_you_see_it', label=fact.label)} {key}".rstrip()
                grid.addWidget(look.label(asked, "small", muted=True), 0, 0, 1, _VALUES_A_ROW)
            for number in range(len(fact.acts)):
                button = ActionButton(self._texts, hints=fact.sense is not None)
                button.requested.connect(self.requested)
                grid.addWidget(button, 1 + number // _VALUES_A_ROW, number % _VALUES_A_ROW)
                self._buttons.append(button)
            self._rows.addWidget(row)


class NamingResult(QWidget):
    """Result of naming a treasure: a sentence and the points."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._text = ""
        self._points: int | None = None
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)

    def sizeHint(self) -> QSize:
        """Return the size of a sign, the points, and a few lines of text."""
        return QSize(px(160), px(120))

    def show_verdict(self, text: str, points: int | None) -> None:
        """Show this result."""
        self._text, self._points = text, points
        self.setAccessibleName(text)
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw a tick and the points won, or a cross and the points lost, and the sentence.

        If the points are hidden, draw only the sentence.
        """
        palette = colours()
        painter = smooth_painter(self)
        rect = QRectF(self.rect())
        if self._points is None:
            centered = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            write(painter, rect, self._text, font(bold=True), palette.text, centered)
            return
        won = self._points > 0
        ink = palette.good if won else palette.bad if self._points < 0 else palette.text
        hero = font("hero", bold=True)
        high = QFontMetricsF(hero).height()
        words = f"{self._points:+d}".replace("-", "−")
        wide = QFontMetricsF(hero).horizontalAdvance(words)
        top = rect.top() + max(0.0, (rect.height() - high - 60) / 2)
        left = rect.center().x() - (wide + high) / 2
        sign(painter, QRectF(left, top, high * 0.8, high), "tick" if won else "cross", ink)
        write(painter, QRectF(left + high, top, wide + 4, high), words, hero, ink)
        wrap = Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop | Qt.TextFlag.TextWordWrap
        write(painter, rect.adjusted(0, top - rect.top() + high + GAP, 0, 0), self._text, font(), palette.text, wrap)
