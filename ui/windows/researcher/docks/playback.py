"""Bar below the map, with controls to play, pause, step, and set the speed and the time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QMouseEvent, QPaintEvent, QPen
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QSlider, QStyle, QStyleOptionSlider, QToolButton, QWidget

from ui.model.watching.bookmarks import clock, parse_clock
from ui.windows.controls import ChoiceBox
from ui.windows.look import colours, fixed_font, follow_text, font, smooth_painter, spaced
from ui.windows.untrusted_text import PlainLabel

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
"""Speeds to choose from, simulated seconds per second."""
UTTERANCE_ARM, EVENT_ARM = 3.0, 5.0
"""Half the height of marks for utterances and for events on the timeline, pixels."""

LOOP, FLAG = 3.0, 5.0
"""Half the height of a loop and half the width of a bookmark on the timeline, pixels."""
BAR, BAR_ROWS = 2.0, 2
"""Height of a bar at the bottom of the timeline, pixels; number of rows of bars."""


@dataclass(frozen=True, slots=True)
class TimelineMark:
    """Mark on the timeline.

    Attributes:
        time: seconds since the beginning.
        text: description of the event or utterance.
        robot: index of the robot of the event or utterance; None if there is none.
        is_utterance: True for a sentence of a dialogue, False for an event.
    """

    time: float
    text: str
    robot: int | None
    is_utterance: bool


@dataclass(frozen=True, slots=True)
class TimelineBar:
    """Bar on the timeline for an activity of a robot.

    Attributes:
        start: seconds since the beginning.
        end: seconds since the beginning.
        text: description of the activity.
        robot: index of the robot.
    """

    start: float
    end: float
    text: str
    robot: int


class Timeline(QSlider):
    """Slider for the time of a recording, in milliseconds.

    Marks of events are above the line, marks of utterances below it, and bars at the bottom.
    """

    def __init__(self) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self._marks: Sequence[TimelineMark] = ()
        self._bars: Sequence[TimelineBar] = ()
        self._bookmarks: Sequence[float] = ()
        self._loop: tuple[float, float] | None = None
        self.setAccessibleName("Time")
        self.setSingleStep(1000)
        self.setPageStep(10_000)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    def set_marks(self, marks: Sequence[TimelineMark], bars: Sequence[TimelineBar] = ()) -> None:
        """Show these marks and bars."""
        self._marks, self._bars = marks, bars
        self.update()

    def set_bookmarks(self, times: Sequence[float], loop: tuple[float, float] | None) -> None:
        """Show these bookmarks, and the loop between two of them."""
        self._bookmarks, self._loop = times, loop
        self.update()

    def sizeHint(self) -> QSize:
        """Return a size with space for marks above and below the line."""
        return QSize(200, 32)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the line and its elapsed part, the marks, bars, bookmarks and loop, and the handle."""
        painter, palette = smooth_painter(self), colours()
        middle = self.height() / 2.0
        left, right, here = self._x(self.minimum()), self._x(self.maximum()), self._x(self.value())
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(palette.line))
        painter.drawRoundedRect(QRectF(left, middle - 1.5, right - left, 3.0), 1.5, 1.5)
        painter.setBrush(QColor(palette.accent))
        painter.drawRoundedRect(QRectF(left, middle - 1.5, here - left, 3.0), 1.5, 1.5)
        width, start = (right - left) / max(1, self.maximum() - self.minimum()), self.minimum()
        for mark in self._marks:
            x = left + (mark.time * 1000.0 - start) * width
            colour = palette.muted if mark.robot is None else palette.robot(mark.robot)
            painter.setPen(QPen(QColor(colour), 1.5))
            y, arm = (middle + 7.0, UTTERANCE_ARM) if mark.is_utterance else (middle - 8.0, EVENT_ARM)
            painter.drawLine(QPointF(x, y - arm), QPointF(x, y - arm + 2.0 * arm))
        painter.setPen(Qt.PenStyle.NoPen)
        for bar in self._bars:
            x, wide = left + (bar.start * 1000.0 - start) * width, max(1.0, (bar.end - bar.start) * 1000.0 * width)
            painter.setBrush(QColor(palette.robot(bar.robot)))
            painter.drawRect(QRectF(x, self.height() - BAR * (1 + bar.robot % BAR_ROWS), wide, BAR))
        if self._loop is not None:
            painter.setBrush(QColor(palette.accent))
            first, last = (left + (time * 1000.0 - start) * width for time in self._loop)
            painter.drawRect(QRectF(first, middle - LOOP, last - first, 2.0 * LOOP))
        painter.setBrush(QColor(palette.text))
        for time in self._bookmarks:
            x = left + (time * 1000.0 - start) * width
            painter.drawPolygon([QPointF(x - FLAG, 1.0), QPointF(x + FLAG, 1.0), QPointF(x, middle - 2.0)])
        painter.setBrush(QColor(palette.panel))
        painter.setPen(QPen(QColor(palette.accent), 3.0 if self.hasFocus() else 2.0))
        painter.drawEllipse(QRectF(here - 6.5, middle - 6.5, 13.0, 13.0))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Move the handle to the pointer, and start to follow the pointer."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.setSliderDown(True)
            self.setSliderPosition(self._value(event.position().x()))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Follow the pointer, or describe the marks and bars under the pointer in the tool tip."""
        if self.isSliderDown():
            self.setSliderPosition(self._value(event.position().x()))
            return
        x = event.position().x()
        near = [mark for mark in self._marks if abs(self._x(mark.time * 1000.0) - x) <= 3.0]
        lines = [f"{time:.1f} s  bookmark" for time in self._bookmarks if abs(self._x(time * 1000.0) - x) <= FLAG]
        lines += [f"{mark.time:.1f} s  {mark.text}" for mark in near[:8]]
        under = [bar for bar in self._bars if self._x(bar.start * 1000.0) <= x <= self._x(bar.end * 1000.0) + 1.0]
        lines += [f"{bar.start:.1f} s to {bar.end:.1f} s  {bar.text}" for bar in under[:8]]
        self.setToolTip("\n".join(lines))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Stop following the pointer."""
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
    """Bar with controls to play, pause, step, and set the speed and the time.

    Args:
        live: True for a running session, whose time cannot go back.

    Signals:
        play_toggled: a person wants to play, or to pause.
        stepped: a person wants to go this number of steps forward, or back if it is negative.
        speed_chosen: a person chose this speed, simulated seconds per second.
        seek: a person wants to go to this time, seconds since the beginning.
        recording_wanted: a person wants to open the recording of the session that has ended.
        refused: a typed time is not valid; with the reason.
    """

    play_toggled = Signal()
    stepped = Signal(int)
    speed_chosen = Signal(float)
    seek = Signal(float)
    recording_wanted = Signal()
    refused = Signal(str)

    def __init__(self, live: bool) -> None:
        super().__init__()
        self._playing = False
        self.play = _button("▶  Play", "", "Play or pause (Space)", self.play_toggled.emit)
        follow_text(self.play, lambda it: it.setMinimumWidth(QFontMetrics(font()).averageCharWidth() * 11))
        self.back = _button("◀|", "One step back", "One step back (,)", lambda: self.stepped.emit(-1))
        self.forward = _button("|▶", "One step forward", "One step forward (.)", lambda: self.stepped.emit(1))
        self.speed = ChoiceBox()
        self.speed.setAccessibleName("Speed, simulated seconds per second")
        for speed in SPEEDS:
            self.speed.addItem(f"{speed:g} x", speed)
        self.speed.setCurrentIndex(SPEEDS.index(1.0))
        self.speed.activated.connect(lambda number: self.speed_chosen.emit(SPEEDS[number]))
        self.timeline = Timeline()
        self.timeline.valueChanged.connect(lambda value: self.seek.emit(value / 1000.0))
        self.time = QLineEdit("0:00.00")
        self.time.setAccessibleName("Time shown")
        self.time.setToolTip(
            "Time shown" if live else "Time shown. To go to another time, type it and press Enter (Ctrl+T)"
        )
        self.time.setReadOnly(live)
        self.time.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.time.returnPressed.connect(self._go_to_typed)
        self.end = PlainLabel()
        self.end.setAccessibleDescription("Length of the recording")
        self.end.setVisible(not live)
        follow_text(self.time, lambda it: it.setFont(fixed_font()))
        follow_text(self.end, lambda it: it.setFont(fixed_font()))
        follow_text(
            self.time, lambda it: it.setFixedWidth(QFontMetrics(fixed_font()).horizontalAdvance("000:00.00") + 16)
        )
        self.state = PlainLabel()
        self.state.setAccessibleDescription("State of the session or recording")
        self.recording = _button("Open recording", "", "", self.recording_wanted.emit)
        self.recording.hide()
        layout = spaced(QHBoxLayout(self), 8, 12, 6, 12, 6)
        for widget in (self.play, self.back, self.forward, self.speed):
            layout.addWidget(widget)
        layout.addWidget(self.timeline, 1)
        layout.addWidget(self.time)
        layout.addWidget(self.end)
        layout.addWidget(self.state)
        layout.addWidget(self.recording)
        self.back.setVisible(not live)
        self.timeline.setVisible(not live)
        if live:
            layout.insertStretch(4, 1)

    def show_span(self, seconds: float, marks: Sequence[TimelineMark], bars: Sequence[TimelineBar] = ()) -> None:
        """Set the length of the timeline in seconds, and show these marks and bars."""
        with QSignalBlocker(self.timeline):
            self.timeline.setRange(0, round(seconds * 1000.0))
        self.timeline.set_marks(marks, bars)

    def show_time(self, now: float) -> None:
        """Show the time, seconds since the beginning."""
        if not self.time.hasFocus() or self.time.isReadOnly():
            self.time.setText(clock(now))
        self.end.setText(f"/ {clock(self.timeline.maximum() / 1000.0)}")
        if not self.timeline.isSliderDown():
            with QSignalBlocker(self.timeline):
                self.timeline.setValue(round(now * 1000.0))

    def ask_time(self) -> None:
        """Let a person type a time."""
        self.time.setFocus(Qt.FocusReason.ShortcutFocusReason)
        self.time.selectAll()

    def _go_to_typed(self) -> None:
        time = parse_clock(self.time.text())
        if time is None:
            self.refused.emit("This is not a time. Type seconds, or minutes and seconds: 83.4 or 1:23.4.")
            return
        self.time.clearFocus()
        self.seek.emit(time)

    def show_playing(self, playing: bool) -> None:
        """Show whether the session or recording plays or is paused."""
        if playing != self._playing:
            self._playing = playing
            self.play.setText("❚❚  Pause" if playing else "▶  Play")

    def show_speed(self, speed: float) -> None:
        """Show the speed in `SPEEDS` that is nearest to this speed."""
        nearest = min(range(len(SPEEDS)), key=lambda number: abs(SPEEDS[number] - speed))
        self.speed.setCurrentIndex(nearest)

    def show_recording(self, path: str) -> None:
        """Offer to open this recording. If the path is empty, hide the offer."""
        self.recording.setVisible(bool(path))
        self.recording.setToolTip(path)

    def show_state(self, text: str) -> None:
        """Show the state of the session or recording in words."""
        self.state.setText(text)


def _button(text: str, name: str, hint: str, do: Callable[[], None]) -> QToolButton:
    button = QToolButton()
    button.setText(text)
    button.setAccessibleName(name)
    button.setToolTip(hint)
    button.clicked.connect(lambda _: do())
    return button
