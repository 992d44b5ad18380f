"""What runs along the edges of the window: score and tools above, what waits and what happened below, banners."""

from PySide6.QtCore import QEasingCurve, QPointF, QRectF, QSize, Qt, QVariantAnimation, Signal
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPaintEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QSizePolicy, QVBoxLayout, QWidget

from thbridge.hunt.rules import robot_name
from ui.model.screen import Action, Banner, Told, Waiting
from ui.windows import look
from ui.windows.look import GAP, RADIUS, colours, font
from ui.windows.participant.buttons import ActionButton, ActionRow, AskingButton, Face
from ui.windows.participant.painting import box, chip, chip_size, ring, sign
from ui.windows.participant.panels import set_text

COUNTING = 900
"""Milliseconds in which a score counts up and what was gained floats away."""


class Score(QWidget):
    """The score. When it changes it counts to the new one, and the gain is shown beside it for a moment."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._score: int | None = None
        self._from = 0
        self._counting = QVariantAnimation(self)
        self._counting.setStartValue(0.0)
        self._counting.setEndValue(1.0)
        self._counting.setDuration(COUNTING)
        self._counting.setEasingCurve(QEasingCurve.Type.OutCubic)
        self._counting.valueChanged.connect(lambda _value: self.update())
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def show_score(self, score: int, *, moving: bool) -> None:
        """Show this score; `moving`: count to it."""
        if score == self._score:
            return
        self._from = self._score if self._score is not None else score
        self._score = score
        self.setAccessibleName(f"Score {score}")
        self._counting.stop()
        if moving and self._from != score:
            self._counting.start()
        self.update()

    def sizeHint(self) -> QSize:
        """A word, four figures, and what was gained."""
        hero = QFontMetricsF(font("hero", bold=True))
        small = QFontMetricsF(font("small"))
        return QSize(
            int(small.horizontalAdvance("Score") + hero.horizontalAdvance("−0000  +00")) + 3 * GAP, int(hero.height())
        )

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw them."""
        worn = colours()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        rect = QRectF(self.rect())
        middle = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
        painter.setFont(font("small"))
        painter.setPen(QColor(worn.muted))
        painter.drawText(rect, middle, "Score")
        left = rect.left() + QFontMetricsF(font("small")).horizontalAdvance("Score") + GAP
        share = self._share()
        now, target = round(self._from + share * ((self._score or 0) - self._from)), self._score or 0
        hero = font("hero", bold=True)
        painter.setFont(hero)
        painter.setPen(QColor(worn.text))
        words = _signed(now)
        painter.drawText(rect.adjusted(left, 0, 0, 0), middle, words)
        gain = target - self._from
        if share < 1.0 and gain:
            left += QFontMetricsF(hero).horizontalAdvance(words) + GAP
            ink = QColor(worn.good if gain > 0 else worn.bad)
            ink.setAlphaF(min(1.0, 2.0 * (1.0 - share)))
            painter.setPen(ink)
            painter.setFont(font("title", bold=True))
            painter.drawText(
                rect.adjusted(left, -6.0 * share, 0, -6.0 * share), middle, f"{'+' if gain > 0 else ''}{_signed(gain)}"
            )

    @property
    def is_counting(self) -> bool:
        """Whether the figures move."""
        return self._counting.state() == QVariantAnimation.State.Running

    def _share(self) -> float:
        """How much of the counting is done."""
        if not self.is_counting:
            return 1.0
        value = self._counting.currentValue()
        return value if isinstance(value, float) else 1.0


class TopStrip(QWidget):
    """Score at the left, tools at the right.

    Attributes:
        asked: the `Act` of what was pressed.
    """

    asked = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        row = QHBoxLayout(self)
        row.setContentsMargins(2 * GAP, GAP, 2 * GAP, GAP)
        row.setSpacing(GAP)
        self._game = look.label(size="small", muted=True)
        self._game.setWordWrap(False)
        self.score = Score()
        row.addWidget(self._game)
        row.addSpacing(GAP)
        row.addWidget(self.score)
        row.addStretch(1)
        tools = QHBoxLayout()
        tools.setSpacing(GAP // 2)
        row.addLayout(tools)
        self.tools = ActionRow(tools.addWidget, self._made)

    def show_strip(self, game: int, score: int, *, moving: bool, tools: tuple[Action, ...]) -> None:
        """Show this."""
        set_text(self._game, f"Game {game}" if game else "")
        self.score.show_score(score, moving=moving)
        self.tools.show_actions(tools)

    def _made(self) -> ActionButton:
        button = ActionButton("quiet")
        button.asked.connect(self.asked)
        return button


class BannerLine(QWidget):
    """A line across the top of the map, which moves nothing."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._banner: Banner | None = None
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.hide()

    def show_banner(self, banner: Banner | None) -> bool:
        """Show this, or nothing; tells whether that changed anything."""
        if banner == self._banner:
            return False
        self._banner = banner
        self.setAccessibleName(banner.text if banner is not None else "")
        self.setVisible(banner is not None)
        self.update()
        return True

    def height_for(self, width: int) -> int:
        """What its text needs."""
        if self._banner is None:
            return 0
        frame = QRectF(0, 0, max(1.0, width - 6.0 * GAP), 1000.0)
        text = QFontMetricsF(font(bold=True)).boundingRect(frame, int(Qt.TextFlag.TextWordWrap), self._banner.text)
        return int(text.height() + 2 * GAP)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Bad news on red with a warning sign, a note on the panel's ground."""
        if self._banner is None:
            return
        worn = colours()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        rect = QRectF(self.rect())
        bad = self._banner.kind == "bad"
        ink = worn.panel if bad else worn.text
        box(painter, rect, worn.bad if bad else worn.panel, worn.bad if bad else worn.line, radius=RADIUS)
        side = QFontMetricsF(font()).height()
        mark = QRectF(rect.left() + 1.5 * GAP, rect.center().y() - side / 2, side, side)
        sign(painter, mark, "trouble" if bad else "talk", ink)
        painter.setFont(font(bold=bad))
        painter.setPen(QColor(ink))
        area = rect.adjusted(2.5 * GAP + side, 0, -GAP, 0)
        painter.drawText(area, Qt.AlignmentFlag.AlignVCenter | Qt.TextFlag.TextWordWrap, self._banner.text)


class WaitingChip(AskingButton):
    """One thing that waits: whose, and what, in two lines."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._waiting: Waiting | None = None
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def show_waiting(self, waiting: Waiting) -> None:
        """Show this."""
        if waiting == self._waiting:
            return
        self._waiting = waiting
        self.take(waiting.show, waiting.text)
        self.setToolTip(waiting.text)
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        """Two lines of words."""
        metrics = QFontMetricsF(font("small"))
        text = self._waiting.text if self._waiting is not None else ""
        wide = min(190.0, max(90.0, metrics.horizontalAdvance(text) / 2.0 + 2 * GAP))
        return QSize(int(wide + chip_size() + 3 * GAP), int(2 * metrics.height() + GAP))

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the chip and the words."""
        if self._waiting is None:
            return
        worn = colours()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        rect = QRectF(self.rect())
        box(painter, rect, worn.track if self.pointed_at() else worn.panel, worn.accent, radius=RADIUS)
        if self.hasFocus():
            ring(painter, rect, worn.text)
        chip(painter, QPointF(rect.left() + GAP + chip_size() / 2, rect.center().y()), self._waiting.robot)
        painter.setFont(font("small"))
        painter.setPen(QColor(worn.text))
        area = rect.adjusted(1.75 * GAP + chip_size(), 2, -GAP, -2)
        painter.drawText(area, Qt.AlignmentFlag.AlignVCenter | Qt.TextFlag.TextWordWrap, self._waiting.text)


class WaitingStrip(QWidget):
    """What waits for the participant, oldest first; its height never changes, so that nothing jumps.

    Attributes:
        asked: the `Act` of what was pressed.
        history: the button that opens the history.
    """

    asked = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GAP)
        self._count = look.label(size="small", muted=True)
        self._count.setWordWrap(False)
        row.addWidget(self._count)
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        area.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        inside = QWidget()
        self._chips = QHBoxLayout(inside)
        self._chips.setContentsMargins(0, 0, 0, 0)
        self._chips.setSpacing(GAP)
        self._chips.addStretch(1)
        area.setWidget(inside)
        self._area = area
        row.addWidget(area, 1)
        self.history = ActionButton()
        self.history.setCheckable(True)
        self.history.wear(Face("History"), "History: what was said and what happened")
        row.addWidget(self.history)
        self.chips: list[WaitingChip] = []
        self._shown: tuple[Waiting, ...] | None = None
        probe = WaitingChip()
        self.setFixedHeight(probe.sizeHint().height() + 2)
        probe.deleteLater()

    def show_waiting(self, waiting: tuple[Waiting, ...]) -> None:
        """Show these; nothing is done when they are shown already."""
        if waiting == self._shown:
            return
        self._shown = waiting
        set_text(self._count, f"Waiting for\nyou: {len(waiting)}" if waiting else "Nothing waits\nfor you")
        while len(self.chips) < len(waiting):
            chip_ = WaitingChip()
            chip_.asked.connect(self.asked)
            self._chips.insertWidget(len(self.chips), chip_)
            self.chips.append(chip_)
        for shown, one in zip(self.chips, waiting, strict=False):
            shown.show_waiting(one)
            shown.show()
        for spare in self.chips[len(waiting) :]:
            spare.hide()

    def reveal(self, widget: QWidget) -> None:
        """Scroll to a chip that got the focus."""
        self._area.ensureWidgetVisible(widget)


class History(QFrame):
    """All that was said and all that happened, the newest at the bottom."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        look.panel(self)
        self._area = QScrollArea()
        self._area.setWidgetResizable(True)
        self._area.setFrameShape(QFrame.Shape.NoFrame)
        self._area.setAccessibleName("History")
        self._area.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        inside = QWidget()
        self._lines = QVBoxLayout(inside)
        self._lines.setContentsMargins(GAP, GAP, GAP, GAP)
        self._lines.setSpacing(GAP // 2)
        self._lines.addStretch(1)
        self._area.setWidget(inside)
        self._area.viewport().setAutoFillBackground(False)
        inside.setAutoFillBackground(False)
        rows = QVBoxLayout(self)
        rows.setContentsMargins(2, 2, 2, 2)
        rows.addWidget(self._area)
        self.setFixedHeight(180)
        self._shown: tuple[Told, ...] = ()
        self._area.verticalScrollBar().rangeChanged.connect(self._to_end)

    def show_history(self, history: tuple[Told, ...]) -> None:
        """Show this; lines that are shown already are kept."""
        if history == self._shown:
            return
        keep = len(self._shown) if history[: len(self._shown)] == self._shown else 0
        while self._lines.count() - 1 > keep:
            item = self._lines.takeAt(self._lines.count() - 2)
            gone = item.widget() if item is not None else None
            if gone is not None:
                gone.deleteLater()
        for told in history[keep:]:
            line = look.label(f"{_speaker(told)}: {told.text}" if _speaker(told) else told.text, "small")
            line.setProperty("muted", told.speaker == "game")
            self._lines.insertWidget(self._lines.count() - 1, line)
        self._shown = history

    def _to_end(self) -> None:
        bar = self._area.verticalScrollBar()
        bar.setValue(bar.maximum())


def _speaker(told: Told) -> str:
    if told.speaker == "game":
        return ""
    robot = robot_name(told.robot).capitalize() if told.robot is not None else ""
    if told.speaker == "you":
        return f"You to {robot.lower()}" if robot else "You"
    return robot


def _signed(number: int) -> str:
    return f"{number}".replace("-", "−")
