"""Building blocks of pop-ups, pages and sheets: a panel with a title, speech bubbles, and a dimming overlay."""

from typing import Literal, TypeAlias

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
"""Number of newest sentences of a dialogue that are not dimmed: the last two sentences."""

OVERLAY_COLOUR = "#0b0f14"
"""Color of the overlay that dims the window, in the light and in the dark style."""


SpeakerName: TypeAlias = Literal["robot", "you", "teammate", "objection"]
"""Speaker of a sentence in a dialogue. The sentence of an objection says who objects."""


class RobotChip(QWidget):
    """Chip next to a title, with the color and number of a robot."""

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        self._robot: int | None = None
        follow_text(self, lambda it: it.setFixedSize(int(chip_size()) + 2, int(chip_size()) + 2))
        self.hide()

    def show_robot(self, robot: int | None) -> None:
        """Show the chip of this robot. If None, hide the chip."""
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
    """Panel with a title, in front of the other parts of the window.

    Args:
        texts: texts in the window's language.
        name: name for screen readers.
        parent: parent widget.

    Attributes:
        requested: signal with the `Act` of the pressed button, or of the picked name.
        top: row of the title; more widgets can be added to the right of the title.
        rows: content below the title; it scrolls if there is too little space.
        foot: part below the content that is always visible.
        compact: True if there is less space than usual on the map.
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
        """Set the title and the robot that the panel is about."""
        set_text(self._title, title)
        self._chip.show_robot(robot)
        self.setAccessibleName(title)

    def usual_size(self) -> QSize:
        """Return the usual size of a pop-up on the map, logical pixels. The pop-up is higher if its words need this."""
        return QSize(px(340), px(300))

    def arrange(self, space: QSize) -> None:
        """Arrange the content for the available space on the map, logical pixels."""
        usual = self.usual_size()
        self.compact = space.width() < usual.width() or space.height() < usual.height()
        self._title.setFont(font("body", bold=True))

    def room_beside(self, width: int, space: QSize) -> int:
        """Return the width that remains next to a part of this width, even with a scroll bar, logical pixels."""
        inside = min(self.usual_size().width(), space.width()) - self.edges().width()
        return inside - self._scrolling.verticalScrollBar().sizeHint().width() - width - self.rows.spacing()

    def reveal(self, part: QWidget) -> None:
        """Scroll the content to a part."""
        self._scrolling.ensureWidgetVisible(part, 0, GAP)

    def least(self, width: int) -> int:
        """Return the smallest height at a width, logical pixels. If the height is smaller, the content scrolls."""
        around = self.edges()
        foot = least_height(self.foot, width - around.width()) if self.foot.count() else 0
        return least_height(self.rows, width - around.width()) + foot + around.height()

    def wanted(self, width: int, height: int) -> QSize:
        """Return the preferred size, limited to this width and height."""
        around = self.edges()
        wide = width - around.width()
        if self._inside.width() not in (wide, wide - self._scrolling.verticalScrollBar().sizeHint().width()):
            self._inside.resize(wide, self._inside.height())
        self.rows.activate()
        needed = self.rows.heightForWidth(wide) if self.rows.hasHeightForWidth() else self.rows.sizeHint().height()
        return QSize(width, min(max(needed, least_height(self.rows, wide)) + around.height(), height))

    def edges(self) -> QSize:
        """Return the total size of the frame and the margins inside the frame."""
        return self.size() - self.contentsRect().size() + QSize(2 * GAP, 2 * GAP)


class PanelScrollArea(QScrollArea):
    """Scroll area for the content of a panel. It scrolls if there is less space than the content's smallest size."""

    def __init__(self, inside: QWidget, rows: QVBoxLayout) -> None:
        super().__init__()
        self._inside, self._rows = inside, rows
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setWidget(inside)
        QApplication.instance().focusChanged.connect(self._reveal)  # type: ignore[union-attr]  # there is always one

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Adapt the content to the new size."""
        super().resizeEvent(event)
        self._fit()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Adapt to another size of the content, and ask the layout for this size."""
        if event.type() == QEvent.Type.LayoutRequest:
            self._fit()
            self.updateGeometry()
        return super().eventFilter(watched, event)

    def _fit(self) -> None:
        # A scroll bar narrows the content. The content may then wrap, and may need the scroll bar only for this reason.
        fits = least_height(self._rows, self.width()) <= self.height()
        policy = Qt.ScrollBarPolicy.ScrollBarAlwaysOff if fits else Qt.ScrollBarPolicy.ScrollBarAsNeeded
        self.setVerticalScrollBarPolicy(policy)
        wide, high = self.viewport().width(), self.viewport().height()
        self._inside.resize(wide, max(high, least_height(self._rows, wide)))

    def _reveal(self, _before: QWidget | None, now: QWidget | None) -> None:
        if now is not None and self._inside.isAncestorOf(now):
            self.ensureWidgetVisible(now, 0, GAP)


def least_height(rows: QLayout, width: int) -> int:
    """Return the smallest height of a layout at a width, logical pixels."""
    return rows.minimumHeightForWidth(width) if rows.hasHeightForWidth() else rows.minimumSize().height()


class OpaqueBackground(QWidget):
    """Opaque background.

    Qt does not redraw an opaque widget when the map below the widget moves.
    """

    def __init__(self) -> None:
        super().__init__()
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Fill the background."""
        QPainter(self).fillRect(event.rect(), QColor(colours().panel))


class SpeechBubble(QWidget):
    """Speech bubble with a sentence.

    The bubble of a robot is on the left in the robot's color. The participant's bubble is on the right in the accent
    color. The bubbles of a teammate and of an objection are on the right, too, with a gray or red edge.
    """

    def __init__(self, texts: Texts, speaker: SpeakerName, text: str, robot: int, teammate: str = "") -> None:
        super().__init__()
        self._speaker = speaker
        self._text = text
        self._robot = robot
        self._older = False
        names = {"robot": texts.text("window.robot", robot=robot), "you": texts.text("window.you")}
        who = names.get(speaker, teammate)
        self.setAccessibleName(text if speaker == "objection" else texts.text("window.said", who=who, words=text))
        policy = QSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        policy.setHeightForWidth(True)
        self.setSizePolicy(policy)

    def show_older(self, older: bool) -> None:
        """Dim the sentence if `older` is True."""
        if older != self._older:
            self._older = older
            self.update()

    def sizeHint(self) -> QSize:
        """Return a size that gives lines a readable length."""
        return QSize(px(320), self.heightForWidth(px(320)))

    def minimumSizeHint(self) -> QSize:
        """Return the height of one line, because a wide layout puts all words on one line."""
        return QSize(px(120), self.heightForWidth(10000))

    def heightForWidth(self, width: int) -> int:
        """Return the height of the wrapped lines."""
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
        edge = {"you": palette.accent, "objection": palette.bad}.get(self._speaker, palette.muted)
        painter.setBrush(QColor(palette.robot(self._robot) if robot else edge))
        at = bubble.left() if robot else bubble.right() - 4.0
        painter.drawRoundedRect(QRectF(at, 7.0, 4.0, bubble.height() - 14.0), 2, 2)
        area = bubble.adjusted(1.5 * GAP, GAP, -1.5 * GAP, -GAP)
        write(painter, area, self._text, font(), palette.muted if self._older else palette.text, WRAPPED)

    def _words(self, width: int) -> QRectF:
        """Return the area of the words. Bubbles leave a part of the width free, to show the speaker's side."""
        frame = QRectF(0.0, 0.0, max(0.86 * width - 3.0 * GAP, 40.0), 10000.0)
        return QFontMetricsF(font()).boundingRect(frame, int(Qt.TextFlag.TextWordWrap), self._text)


class Transcript(QScrollArea):
    """Sentences of a dialogue so far. The newest sentence is at the bottom and visible."""

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
        self._sentences: tuple[tuple[SpeakerName, str], ...] = ()
        self._bubbles: list[SpeechBubble] = []
        self._robot: int | None = None
        self._room = 0
        self.verticalScrollBar().rangeChanged.connect(self._to_end)
        # New bubbles get their place only after Qt has handled all pending events.
        self._settling = QTimer(self, singleShot=True, interval=0)
        self._settling.timeout.connect(self._to_end)

    def show_sentences(self, sentences: tuple[tuple[SpeakerName, str], ...], robot: int, teammate: str = "") -> None:
        """Show these sentences; reuse the bubbles of sentences that are already shown.

        `teammate` is the label of a teammate who talks with the robot.
        """
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
            self._bubbles.append(SpeechBubble(self._texts, speaker, text, robot, teammate))
            self._lines.insertWidget(self._lines.count() - 1, self._bubbles[-1])
        for at, bubble in enumerate(reversed(self._bubbles)):
            bubble.show_older(at >= PROMINENT)
        self.updateGeometry()

    def turn_page(self, pages: int) -> None:
        """Scroll by this number of pages, back (-1) or forward (1)."""
        bar = self.verticalScrollBar()
        bar.setValue(bar.value() + pages * bar.pageStep())

    def heightForWidth(self, width: int) -> int:
        """Return the height of all sentences."""
        return self._lines.heightForWidth(width) if self._sentences else 0

    def sizeHint(self) -> QSize:
        """Return the size of all sentences at the current width."""
        return QSize(px(320), self.heightForWidth(self.width()))

    def minimumSizeHint(self) -> QSize:
        """Return the size of the newest sentence, limited to the available space."""
        newest = self._bubbles[-1].heightForWidth(self.width()) if self._bubbles else 0
        return QSize(px(120), min(self.sizeHint().height(), max(px(60), min(newest, self._room))))

    def keep_room(self, height: int) -> None:
        """Keep space for the newest sentence, up to this height, logical pixels."""
        if height != self._room:
            self._room = height
            self.updateGeometry()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Report the new height after a change of width.

        If all sentences fit, hide the scroll bar, because its width would wrap lines.
        """
        super().resizeEvent(event)
        fits = self.height() >= self.heightForWidth(self.width())
        policy = Qt.ScrollBarPolicy.ScrollBarAlwaysOff if fits else Qt.ScrollBarPolicy.ScrollBarAsNeeded
        self.setVerticalScrollBarPolicy(policy)
        if event.size().width() != event.oldSize().width():
            self.updateGeometry()
        self._to_end()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Report a new size to the layout, because bubbles appear a moment after they are added."""
        if event.type() == QEvent.Type.LayoutRequest:
            self.updateGeometry()
            self._settling.start()
        return super().eventFilter(watched, event)

    def _to_end(self) -> None:
        """Scroll to the newest sentence. If it does not fit, its beginning is at the top."""
        self._lines.activate()
        bar = self.verticalScrollBar()
        bar.setValue(min([bar.maximum(), *(bubble.y() for bubble in self._bubbles[-1:])]))


class ModalOverlay(QWidget):
    """Overlay that dims the window, blocks it, and shows one panel in the middle."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._panel: TitledPanel | None = None
        self._widest = 520
        self.hide()

    def show_panel(self, panel: TitledPanel | None, widest: int = 520) -> None:
        """Show this panel. If None, hide the overlay."""
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
        """Move the focus within the panel. Return False if no panel is shown, so that Tab has its usual effect."""
        if self.isVisible():
            go_round(self, 1 if forward else -1)
        return self.isVisible()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Accept the press, so that the widgets behind the overlay do not receive it."""
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
    """Return a column in the middle of a page, at most this wide, `px`. If the page is too low, the column scrolls."""
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
    """Set a label's text only if the text has changed, to avoid a new layout."""
    if shown.text() != text:
        shown.setText(text)


def wrapped_height(shown: QLabel, text: str, width: int) -> int:
    """Return the height that a label needs for a text at a width, logical pixels."""
    return shown.fontMetrics().boundingRect(QRect(0, 0, width, 10000), Qt.TextFlag.TextWordWrap, text).height()
