"""The bar under the map: play, pause, step, how fast, and when."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFontDatabase, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSlider, QStyle, QStyleOptionSlider, QToolButton, QWidget

from ui.model.theme import Palette
from ui.windows.controls import ChoiceBox

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
"""Simulated seconds per second."""
UTTERANCE_ARM, EVENT_ARM = 3.0, 5.0
"""Half height of a mark of an utterance, and of an event, on the timeline; pixels."""


@dataclass(frozen=True, slots=True)
class TimelineMark:
    """Something to jump to.

    Attributes:
        time: seconds since the beginning.
        text: what happened.
        robot: to whom; None: to nobody.
        talk: something was said; else something was done.
    """

    time: float
    text: str
    robot: int | None
    is_utterance: bool


class Timeline(QSlider):
    """A slider over the time of a recording, with marks of what happened; above the line what was done, below what was
    said. Its values are milliseconds."""

    def __init__(self, palette: Palette) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self._palette = palette
        self._marks: Sequence[TimelineMark] = ()
        self.setAccessibleName("Time")
        self.setSingleStep(1000)
        self.setPageStep(10_000)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    def set_marks(self, marks: Sequence[TimelineMark]) -> None:
        """What can be jumped to."""
        self._marks = marks
        self.update()

    def set_palette(self, palette: Palette) -> None:
        """Other colours."""
        self._palette = palette
        self.update()

    def sizeHint(self) -> QSize:
        """Room for marks on both sides."""
        return QSize(200, 32)

    def paintEvent(self, event: QPaintEvent) -> None:
        """The line, what is past of it, the marks, the handle."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        middle = self.height() / 2.0
        left, right, here = self._x(self.minimum()), self._x(self.maximum()), self._x(self.value())
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(self._palette.line))
        painter.drawRoundedRect(QRectF(left, middle - 1.5, right - left, 3.0), 1.5, 1.5)
        painter.setBrush(QColor(self._palette.accent))
        painter.drawRoundedRect(QRectF(left, middle - 1.5, here - left, 3.0), 1.5, 1.5)
        width, start = (right - left) / max(1, self.maximum() - self.minimum()), self.minimum()
        for mark in self._marks:
            x = left + (mark.time * 1000.0 - start) * width
            colour = self._palette.muted if mark.robot is None else self._palette.robot(mark.robot)
            painter.setPen(QPen(QColor(colour), 1.5))
            y, arm = (middle + 7.0, UTTERANCE_ARM) if mark.is_utterance else (middle - 8.0, EVENT_ARM)
            painter.drawLine(
                QRectF(x, y - arm, 0.0, 2.0 * arm).topLeft(), QRectF(x, y - arm, 0.0, 2.0 * arm).bottomLeft()
            )
        painter.setBrush(QColor(self._palette.panel))
        painter.setPen(QPen(QColor(self._palette.accent), 3.0 if self.hasFocus() else 2.0))
        painter.drawEllipse(QRectF(here - 6.5, middle - 6.5, 13.0, 13.0))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Go to where the pointer is, at once, and on with it."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.setSliderDown(True)
            self.setSliderPosition(self._value(event.position().x()))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Go along, or say what the mark under the pointer is."""
        if self.isSliderDown():
            self.setSliderPosition(self._value(event.position().x()))
            return
        near = [mark for mark in self._marks if abs(self._x(mark.time * 1000.0) - event.position().x()) <= 3.0]
        self.setToolTip("\n".join(f"{mark.time:.1f} s  {mark.text}" for mark in near[:8]))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Stay there."""
        self.setSliderDown(False)

    def _margin(self) -> float:
        option = QStyleOptionSlider()
        self.initStyleOption(option)
        return max(8.0, self.style().pixelMetric(QStyle.PixelMetric.PM_SliderLength, option, self) / 2.0)

    def _x(self, value: float) -> float:
        span = max(1, self.maximum() - self.minimum())
        return self._margin() + (value - self.minimum()) / span * (self.width() - 2.0 * self._margin())

    def _value(self, x: float) -> int:
        share = (x - self._margin()) / max(1.0, self.width() - 2.0 * self._margin())
        return round(self.minimum() + min(1.0, max(0.0, share)) * (self.maximum() - self.minimum()))


class PlaybackBar(QWidget):
    """Play, pause, step, speed, time.

    Args:
        palette: the colours.
        live: a session under way: there is no way back, and its clock is asked to stop and go.

    Signals:
        play_toggled: play where it is paused, pause where it plays.
        stepped: so many steps forward, or back where negative.
        speed_chosen: simulated seconds per second.
        seek: to this moment, seconds since the beginning.
    """

    play_toggled = Signal()
    stepped = Signal(int)
    speed_chosen = Signal(float)
    seek = Signal(float)

    def __init__(self, palette: Palette, live: bool) -> None:
        super().__init__()
        self._live = live
        self._playing = False
        self._shows = False
        self.play = QToolButton()
        self.play.setText("▶  Play")
        self.play.setMinimumWidth(self.fontMetrics().averageCharWidth() * 14)
        self.play.setToolTip("Play or pause (Space)")
        self.play.clicked.connect(self.play_toggled)
        self.back = QToolButton()
        self.back.setText("◀|")
        self.back.setAccessibleName("One step back")
        self.back.setToolTip("One step back (,)")
        self.back.clicked.connect(lambda: self.stepped.emit(-1))
        self.forward = QToolButton()
        self.forward.setText("|▶")
        self.forward.setAccessibleName("One step forward")
        self.forward.setToolTip("One step forward (.)")
        self.forward.clicked.connect(lambda: self.stepped.emit(1))
        self.speed = ChoiceBox()
        self.speed.setAccessibleName("Speed, simulated seconds per second")
        for speed in SPEEDS:
            self.speed.addItem(f"{speed:g} x", speed)
        self.speed.setCurrentIndex(SPEEDS.index(1.0))
        self.speed.activated.connect(lambda number: self.speed_chosen.emit(SPEEDS[number]))
        self.timeline = Timeline(palette)
        self.timeline.valueChanged.connect(self._moved)
        self.time = QLabel("0:00.00")
        self.time.setAccessibleDescription("Time shown")
        self.time.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        self.state = QLabel()
        self.state.setAccessibleDescription("What is shown, and how it is")
        layout = QHBoxLayout(self)
        layout.setContentsMargins(12, 6, 12, 6)
        layout.setSpacing(8)
        for widget in (self.play, self.back, self.forward, self.speed):
            layout.addWidget(widget)
        layout.addWidget(self.timeline, 1)
        layout.addWidget(self.time)
        layout.addWidget(self.state)
        self.back.setVisible(not live)
        self.timeline.setVisible(not live)
        if live:
            layout.insertStretch(4, 1)

    def show_span(self, seconds: float, marks: Sequence[TimelineMark]) -> None:
        """How long it is, and what happened when."""
        self._shows = True
        self.timeline.setRange(0, round(seconds * 1000.0))
        self._shows = False
        self.timeline.set_marks(marks)

    @property
    def span(self) -> float:
        """How long it is, seconds, to the millisecond."""
        return self.timeline.maximum() / 1000.0

    def show_time(self, now: float) -> None:
        """Where we are, seconds since the beginning."""
        end = self.timeline.maximum() / 1000.0
        self.time.setText(clock(now) if self._live else f"{clock(now)} / {clock(end)}")
        if not self.timeline.isSliderDown():
            self._shows = True
            self.timeline.setValue(round(now * 1000.0))
            self._shows = False

    def show_playing(self, playing: bool) -> None:
        """Whether time goes on."""
        if playing != self._playing:
            self._playing = playing
            self.play.setText("❚❚  Pause" if playing else "▶  Play")

    def show_speed(self, speed: float) -> None:
        """How fast; one of `SPEEDS`, or the nearest is shown."""
        nearest = min(range(len(SPEEDS)), key=lambda number: abs(SPEEDS[number] - speed))
        self.speed.setCurrentIndex(nearest)

    def show_state(self, text: str) -> None:
        """Where it comes from and how it is, in words."""
        self.state.setText(text)

    def set_palette(self, palette: Palette) -> None:
        """Other colours."""
        self.timeline.set_palette(palette)

    def _moved(self, value: int) -> None:
        if not self._shows:
            self.seek.emit(value / 1000.0)


def clock(seconds: float) -> str:
    """Minutes and seconds: "12:03.40"."""
    minutes, rest = divmod(round(max(0.0, seconds) * 100.0), 6000)
    return f"{minutes}:{rest / 100.0:05.2f}"
