"""Parts of pop-ups, pages and sheets: a panel with a title, speech bubbles, and a dimming overlay behind."""

from typing import Literal

from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, QRect, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QFontMetricsF, QMouseEvent, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import (
    QApplication,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLayout,
    QScrollArea,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from thbridge.dialogue.wording.texts import Texts
from ui.windows import look, pointer
from ui.windows.look import GAP, colours, follow_text, font, px, smooth_painter, spaced
from ui.windows.participant.widgets.focus import go_round, make_region
from ui.windows.participant.widgets.painting import WRAPPED, chip, chip_size, write

PROMINENT = 2
"""Newest sentences of a dialogue that are not dimmed: what was said last, and the reply."""

OVERLAY_COLOUR = "#0b0f14"
"""Color of the overlay that dims the window, in light and dark."""


class RobotChip(QWidget):
    """A robot's color and number, beside a title."""

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        self._robot: int | None = None
        follow_text(self, lambda it: it.setFixedSize(int(chip_size()) + 2, int(chip_size()) + 2))
        self.hide()

    def show_robot(self, robot: int | None) -> None:
        """Show the chip of this robot; None hides it."""
        if robot == self._robot:
            return
        self._robot = robot
        self.setAccessibleName("" if robot is None else self._texts.text("window.robot", robot=robot))
        self.setVisible(robot is not None)
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the chip."""
        if self._robot is not None:
            painter = smooth_painter(self)
            chip(painter, QPointF(self.width() / 2.0, self.height() / 2.0), self._robot)


class TitledPanel(QFrame):
    """A panel above everything else, with a title.

    Args:
        texts: of the window's language.
        name: for screen readers.
        parent: as for any widget.

    Attributes:
        requested: carries the `Act` of the pressed button, or of the picked name.
        top: the row of the title; what is added goes to its right.
        rows: what is below it, which scrolls where there is too little space.
        foot: what is below that and always in sight.
        compact: there is less space than usual on the map.
    """

    requested = Signal(object)

    def __init__(self, texts: Texts, name: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        look.style_as_panel(self)
        make_region(self, name)
        inside = OpaqueBackground()
        self.rows = spaced(QVBoxLayout(inside), int(1.5 * GAP), GAP)
        self._around = spaced(QVBoxLayout(self), 0, GAP)
        self._inside, self._scrolling = inside, PanelScrollArea(inside, self.rows)
        self._around.addWidget(self._scrolling, 1)
        self.compact = False
        self.foot = spaced(QHBoxLayout(), GAP, 0)
        self._around.addLayout(self.foot)
        self._chip = RobotChip(texts)
        self._title = look.label(size="title", bold=True)
        self.top = spaced(QHBoxLayout(), GAP)
        self.top.addWidget(self._chip, 0, Qt.AlignmentFlag.AlignVCenter)
        self.top.addWidget(self._title, 1)
        self.rows.addLayout(self.top)

    def entitle(self, title: str, robot: int | None = None) -> None:
        """Set the title, and the robot that the panel is about."""
        set_text(self._title, title)
        self._chip.show_robot(robot)
        self.setAccessibleName(title)

    def usual_size(self) -> QSize:
        """Return its size as a pop-up on the map, logical pixels; it is higher only where its words need more."""
        return QSize(px(340), px(300))

    def arrange(self, space: QSize) -> None:
        """Arrange what it holds for the space that there is on the map, logical pixels."""
        usual = self.usual_size()
        self.compact = space.width() < usual.width() or space.height() < usual.height()
        self._title.setFont(font("body", bold=True))

    def room_beside(self, width: int, space: QSize) -> int:
        """Return the width left beside a part of this width, logical pixels, even where what it holds scrolls."""
        inside = min(self.usual_size().width(), space.width()) - self.edges().width()
        return inside - self._scrolling.verticalScrollBar().sizeHint().width() - width - self.rows.spacing()

    def reveal(self, part: QWidget) -> None:
        """Scroll to a part."""
        self._scrolling.ensureWidgetVisible(part, 0, GAP)

    def least(self, width: int) -> int:
        """Return the height that it needs at least in a width, logical pixels; with less it scrolls."""
        around = self.edges()
        foot = least_height(self.foot, width - around.width()) if self.foot.count() else 0
        return least_height(self.rows, width - around.width()) + foot + around.height()

    def wanted(self, width: int, height: int) -> QSize:
        """Return its size when there is at most so much space."""
        around = self.edges()
        wide = width - around.width()
        if self._inside.width() not in (wide, wide - self._scrolling.verticalScrollBar().sizeHint().width()):
            self._inside.resize(wide, self._inside.height())
        self.rows.activate()
        needed = self.rows.heightForWidth(wide) if self.rows.hasHeightForWidth() else self.rows.sizeHint().height()
        return QSize(width, min(max(needed, least_height(self.rows, wide)) + around.height(), height))

    def edges(self) -> QSize:
        """Return the size of its frame and of the space inside it."""
        return self.size() - self.contentsRect().size() + QSize(2 * GAP, 2 * GAP)


class PanelScrollArea(QScrollArea):
    """Scrolls what a panel holds, where there is less space than even its least size."""

    def __init__(self, inside: QWidget, rows: QVBoxLayout) -> None:
        super().__init__()
        self._inside, self._rows = inside, rows
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setWidget(inside)
        QApplication.instance().focusChanged.connect(self._reveal)  # type: ignore[union-attr]  # there is one

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fit what is inside."""
        super().resizeEvent(event)
        self._fit()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Fit what is inside anew when it needs another size, and report that to the layout."""
        if event.type() == QEvent.Type.LayoutRequest:
            self._fit()
            self.updateGeometry()
        return super().eventFilter(watched, event)

    def _fit(self) -> None:
        # A bar takes width, for want of which lines may break, so that it is needed only because it is there.
        fits = least_height(self._rows, self.width()) <= self.height()
        policy = Qt.ScrollBarPolicy.ScrollBarAlwaysOff if fits else Qt.ScrollBarPolicy.ScrollBarAsNeeded
        self.setVerticalScrollBarPolicy(policy)
        wide, high = self.viewport().width(), self.viewport().height()
        self._inside.resize(wide, max(high, least_height(self._rows, wide)))

    def _reveal(self, _before: QWidget | None, now: QWidget | None) -> None:
        if now is not None and self._inside.isAncestorOf(now):
            self.ensureWidgetVisible(now, 0, GAP)


def least_height(rows: QLayout, width: int) -> int:
    """Return the height that a layout needs at least in a width, logical pixels."""
    return rows.minimumHeightForWidth(width) if rows.hasHeightForWidth() else rows.minimumSize().height()


class OpaqueBackground(QWidget):
    """An opaque background. Qt knows that nothing shines through: the map may move below it without a redraw."""

    def __init__(self) -> None:
        super().__init__()
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Fill the background."""
        QPainter(self).fillRect(event.rect(), QColor(colours().panel))


class SpeechBubble(QWidget):
    """A sentence in a bubble: a robot's at the left with its color, the participant's at the right with the accent."""

    def __init__(self, texts: Texts, speaker: Literal["robot", "you"], text: str, robot: int) -> None:
        super().__init__()
        self._speaker = speaker
        self._text = text
        self._robot = robot
        self._older = False
        who = texts.text("window.robot", robot=robot) if speaker == "robot" else texts.text("window.you")
        self.setAccessibleName(texts.text("window.said", who=who, words=text))
        policy = QSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        policy.setHeightForWidth(True)
        self.setSizePolicy(policy)

    def show_older(self, older: bool) -> None:
        """Dim it once newer sentences are what matters."""
        if older != self._older:
            self._older = older
            self.update()

    def sizeHint(self) -> QSize:
        """Return the size with lines of a readable length."""
        return QSize(px(320), self.heightForWidth(px(320)))

    def minimumSizeHint(self) -> QSize:
        """Return the size on one line, should the width allow it."""
        return QSize(px(120), self.heightForWidth(10000))

    def heightForWidth(self, width: int) -> int:
        """Return the height of the broken lines."""
        return int(self._words(width).height() + 2.0 * GAP) + 1

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the bubble, its edge and the words."""
        palette = colours()
        painter = smooth_painter(self)
        words = self._words(self.width())
        robot = self._speaker == "robot"
        wide = words.width() + 3.0 * GAP + 1.0
        bubble = QRectF(0.0 if robot else self.width() - wide, 0.0, wide, float(self.height()))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(palette.track))
        painter.drawRoundedRect(bubble, 10, 10)
        painter.setBrush(QColor(palette.robot(self._robot) if robot else palette.accent))
        at = bubble.left() if robot else bubble.right() - 4.0
        painter.drawRoundedRect(QRectF(at, 7.0, 4.0, bubble.height() - 14.0), 2, 2)
        area = bubble.adjusted(1.5 * GAP, GAP, -1.5 * GAP, -GAP)
        write(painter, area, self._text, font(), palette.muted if self._older else palette.text, WRAPPED)

    def _words(self, width: int) -> QRectF:
        """Return the space of the words; bubbles leave a share of the width free, so that the sides differ."""
        frame = QRectF(0.0, 0.0, max(0.86 * width - 3.0 * GAP, 40.0), 10000.0)
        return QFontMetricsF(font()).boundingRect(frame, int(Qt.TextFlag.TextWordWrap), self._text)


class Transcript(QScrollArea):
    """The sentences of a dialogue so far, the newest at the bottom and in sight."""

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        inside = OpaqueBackground()
        self._lines = spaced(QVBoxLayout(inside), GAP, 0)
        self._lines.addStretch(1)
        self.setWidget(inside)
        self.setAccessibleName(texts.text("window.what_was_said"))
        self._sentences: tuple[tuple[Literal["robot", "you"], str], ...] = ()
        self._bubbles: list[SpeechBubble] = []
        self._robot: int | None = None
        self._room = 0
        self.verticalScrollBar().rangeChanged.connect(self._to_end)
        # New bubbles have their place once all events so far are through.
        self._settling = QTimer(self, singleShot=True, interval=0)
        self._settling.timeout.connect(self._to_end)

    def show_sentences(self, sentences: tuple[tuple[Literal["robot", "you"], str], ...], robot: int) -> None:
        """Show these sentences; bubbles that are shown already are kept."""
        if (sentences, robot) == (self._sentences, self._robot):
            return
        shown = len(self._sentences)
        keep = shown if robot == self._robot and sentences[:shown] == self._sentences else 0
        self._sentences, self._robot = sentences, robot
        while len(self._bubbles) > keep:
            gone = self._bubbles.pop()
            self._lines.removeWidget(gone)
            gone.hide()
            gone.deleteLater()
        for speaker, text in sentences[keep:]:
            self._bubbles.append(SpeechBubble(self._texts, speaker, text, robot))
            self._lines.insertWidget(self._lines.count() - 1, self._bubbles[-1])
        for at, bubble in enumerate(reversed(self._bubbles)):
            bubble.show_older(at >= PROMINENT)
        self.updateGeometry()

    def turn_page(self, pages: int) -> None:
        """Scroll back (-1) or on (1) by what is in sight."""
        bar = self.verticalScrollBar()
        bar.setValue(bar.value() + pages * bar.pageStep())

    def heightForWidth(self, width: int) -> int:
        """Return the height of all sentences."""
        return self._lines.heightForWidth(width) if self._sentences else 0

    def sizeHint(self) -> QSize:
        """Return the size of all sentences in the width it has."""
        return QSize(px(320), self.heightForWidth(self.width()))

    def minimumSizeHint(self) -> QSize:
        """Return the size of the newest sentence, as far as there is room for it."""
        newest = self._bubbles[-1].heightForWidth(self.width()) if self._bubbles else 0
        return QSize(px(120), min(self.sizeHint().height(), max(px(60), min(newest, self._room))))

    def keep_room(self, height: int) -> None:
        """Show the newest sentence whole up to this height, logical pixels."""
        if height != self._room:
            self._room = height
            self.updateGeometry()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Report another height for another width; where all fits, no bar takes width that would break lines."""
        super().resizeEvent(event)
        fits = self.height() >= self.heightForWidth(self.width())
        policy = Qt.ScrollBarPolicy.ScrollBarAlwaysOff if fits else Qt.ScrollBarPolicy.ScrollBarAsNeeded
        self.setVerticalScrollBarPolicy(policy)
        if event.size().width() != event.oldSize().width():
            self.updateGeometry()
        self._to_end()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Report another size to the layout, since bubbles are shown a moment after they were added."""
        if event.type() == QEvent.Type.LayoutRequest:
            self.updateGeometry()
            self._settling.start()
        return super().eventFilter(watched, event)

    def _to_end(self) -> None:
        """Show the newest sentence, from its beginning."""
        self._lines.activate()
        bar = self.verticalScrollBar()
        bar.setValue(min([bar.maximum(), *(bubble.y() for bubble in self._bubbles[-1:])]))


class ModalOverlay(QWidget):
    """A modal overlay: dims the window, which cannot be used meanwhile, and shows one panel in the middle."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._panel: TitledPanel | None = None
        self._widest = 520
        self.hide()

    def show_panel(self, panel: TitledPanel | None, widest: int = 520) -> None:
        """Show this panel, or hide the overlay."""
        if panel is self._panel:
            self._place()
            return
        if self._panel is not None:
            self._panel.hide()
        pointer.note_rest(self)
        self._panel, self._widest = panel, widest
        if panel is None:
            self.hide()
            return
        panel.setParent(self)
        panel.show()
        self._place()
        self.show()
        self.raise_()

    def keeps_tab(self, *, forward: bool) -> bool:
        """Move the focus by Tab inside the panel; return False while it is hidden, and Tab is not its own."""
        if self.isVisible():
            go_round(self, 1 if forward else -1)
        return self.isVisible()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Keep the press from what lies behind."""
        event.accept()

    def resizeEvent(self, _event: QResizeEvent) -> None:
        """Keep the panel in the middle."""
        self._place()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Dim the window."""
        painter = QPainter(self)
        dim = QColor(OVERLAY_COLOUR)
        dim.setAlphaF(0.45)
        painter.fillRect(self.rect(), dim)

    def _place(self) -> None:
        if self._panel is not None:
            size = self._panel.wanted(min(px(self._widest), self.width() - 4 * GAP), self.height() - 4 * GAP)
            corner = QPoint((self.width() - size.width()) // 2, (self.height() - size.height()) // 2)
            self._panel.setGeometry(QRect(corner, size))


def page_column(page: QWidget, width: int) -> QVBoxLayout:
    """Return a column in the middle of a page, at most so wide, `px`; it scrolls where the page is too low for it."""
    inside, area = QWidget(), QScrollArea(widgetResizable=True)
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
    area.setWidget(inside)
    spaced(QVBoxLayout(page), 0, 0).addWidget(area)
    outer = QHBoxLayout(inside)
    outer.setContentsMargins(4 * GAP, 4 * GAP, 4 * GAP, 4 * GAP)
    column = QWidget()
    follow_text(column, lambda it: it.setMaximumWidth(px(width)))
    outer.addStretch(1)
    outer.addWidget(column, 20)
    outer.addStretch(1)
    return QVBoxLayout(column)


def set_text(shown: QLabel, text: str) -> None:
    """Set a label's text only when it differs, which saves a layout."""
    if shown.text() != text:
        shown.setText(text)


def wrapped_height(shown: QLabel, text: str, width: int) -> int:
    """Return the height of a text as a label would show it in a width, logical pixels."""
    return shown.fontMetrics().boundingRect(QRect(0, 0, width, 10000), Qt.TextFlag.TextWordWrap, text).height()
