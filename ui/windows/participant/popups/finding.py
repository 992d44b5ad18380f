"""Views of a found treasure: its picture, what the robot sensed, and the result of naming it."""

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPaintEvent, QPixmap
from PySide6.QtWidgets import (
    QSizePolicy,
    QWidget,
)

from ui.windows.look import GAP, RADIUS, colours, follow_text, font, px, smooth_painter
from ui.windows.participant.widgets.painting import WRAPPED, sign, write

_PICTURE = QSize(224, 168)
"""Usual size of a picture, `px`."""


class TreasurePicture(QWidget):
    """A treasure's picture, or an empty frame with a note that says why.

    Args:
        share: of the usual size.
        parent: as for any widget.
    """

    def __init__(self, share: float = 1.0, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._share = share
        self._data: bytes | None = None
        self._note = ""
        self.setAccessibleName("Picture of what was found")
        self._pixmap = QPixmap()
        follow_text(self, TreasurePicture._fit)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)

    def sizeHint(self) -> QSize:
        """Return the size of a small photograph."""
        return QSize(px(self._share * _PICTURE.width()), px(self._share * _PICTURE.height()))

    def _fit(self) -> None:
        usual = self.sizeHint()
        self.setMinimumSize(usual.width() // 2, usual.height() // 3)
        self.setMaximumSize(usual * 2)

    def show_picture(self, data: bytes | None, note: str) -> None:
        """Show the picture in these bytes of an image file, or a note that says why there is none."""
        if (data, note) == (self._data, self._note):
            return
        if data != self._data:
            self._pixmap = QPixmap()
            if data is not None and not self._pixmap.loadFromData(data):
                note = "This picture cannot be shown."
        self._data, self._note = data, note
        self.setAccessibleName("Picture of what was found" if not self._pixmap.isNull() else note)
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the picture as large as fits."""
        palette = colours()
        painter = smooth_painter(self)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        rect = QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        painter.setPen(QColor(palette.line))
        painter.setBrush(QColor(palette.track))
        painter.drawRoundedRect(rect, RADIUS - 2, RADIUS - 2)
        if self._pixmap.isNull():
            wrap = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            write(painter, rect.adjusted(GAP, GAP, -GAP, -GAP), self._note, font("small"), palette.muted, wrap)
            return
        size = (
            self._pixmap.size().toSizeF().scaled(rect.adjusted(2, 2, -2, -2).size(), Qt.AspectRatioMode.KeepAspectRatio)
        )
        target = QRectF(0.0, 0.0, size.width(), size.height())
        target.moveCenter(rect.center())
        painter.drawPixmap(target, self._pixmap, QRectF(self._pixmap.rect()))


class SensedFacts(QWidget):
    """Sensor readings of a treasure: a patch of its colour and a drawing of its footprint, each beside its name."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._colour = self._footprint = ""
        follow_text(self, lambda it: it.setMinimumWidth(px(_PICTURE.width() // 2)))
        policy = QSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        policy.setHeightForWidth(True)
        self.setSizePolicy(policy)

    def sizeHint(self) -> QSize:
        """Return the size of two lines."""
        return QSize(px(_PICTURE.width()), int(2 * self._line()) + GAP)

    def heightForWidth(self, width: int) -> int:
        """Return the height of the broken lines."""
        return int(sum(self._height(words, width) for words in (self._colour, self._footprint))) + GAP

    def show_facts(self, colour: str, footprint: str) -> None:
        """Show these words; empty ones are not known yet."""
        if (colour, footprint) == (self._colour, self._footprint):
            return
        self._colour, self._footprint = colour, footprint
        known = f"Colour: {colour}. Footprint: {footprint}." if colour else "The robot is still looking."
        self.setAccessibleName(known)
        self.updateGeometry()
        self.update()

    def _line(self) -> float:
        return QFontMetricsF(font()).height() + GAP

    def _height(self, words: str, width: float) -> float:
        """Return the height of words beside their patch."""
        frame = QRectF(0.0, 0.0, max(width - self._beside(), 1.0), 10000.0)
        return QFontMetricsF(font()).boundingRect(frame, int(Qt.TextFlag.TextWordWrap), words or " ").height() + GAP

    def _beside(self) -> float:
        """Return the width of a patch and of the gap beside it."""
        return self._line() - 4.0 + 1.5 * GAP

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the two lines."""
        palette = colours()
        painter = smooth_painter(self)
        if not self._colour:
            write(painter, QRectF(self.rect()), "Looking at it …", font(), palette.muted)
            return
        top = 0.0
        for row, words in enumerate((self._colour, self._footprint)):
            line = QRectF(0.0, top, self.width(), self._height(words, self.width()))
            top = line.bottom() + GAP / 2
            side = self._line() - 4.0
            patch = QRectF(line.left() + 1, line.top() + 2, side, side)
            painter.setPen(QColor(palette.line))
            if row == 0:
                swatch = QColor(words.casefold().replace(" ", ""))
                painter.setBrush(swatch if swatch.isValid() else QColor(palette.track))
                painter.drawRoundedRect(patch, 4, 4)
            else:
                self._shape(painter, patch, words.casefold())
            write(painter, line.adjusted(self._beside(), 0, 0, 0), words, font(), palette.text, WRAPPED)

    @staticmethod
    def _shape(painter: QPainter, patch: QRectF, words: str) -> None:
        """Draw a shape, round or square, large or small, as far as the words say so."""
        inset = 0.28 * patch.width() if "small" in words else 0.04 * patch.width()
        shape = patch.adjusted(inset, inset, -inset, -inset)
        painter.setPen(QColor(colours().text))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if "round" in words:
            painter.drawEllipse(shape)
        elif "square" in words:
            painter.drawRect(shape)


class NamingResult(QWidget):
    """Result of naming a treasure: a sentence and the points."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._text = ""
        self._points: int | None = None
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)

    def sizeHint(self) -> QSize:
        """Return the size of a sign, the points and some lines."""
        return QSize(px(220), px(150))

    def show_verdict(self, text: str, points: int | None) -> None:
        """Show this."""
        self._text, self._points = text, points
        self.setAccessibleName(text)
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw a tick and the points won, or a warning sign and the points lost."""
        palette = colours()
        painter = smooth_painter(self)
        rect = QRectF(self.rect())
        won = (self._points or 0) > 0
        ink = palette.good if won else palette.bad if (self._points or 0) < 0 else palette.text
        hero = font("hero", bold=True)
        high = QFontMetricsF(hero).height()
        words = f"{self._points:+d}".replace("-", "−") if self._points is not None else ""
        wide = QFontMetricsF(hero).horizontalAdvance(words)
        top = rect.top() + max(0.0, (rect.height() - high - 60) / 2)
        left = rect.center().x() - (wide + high) / 2
        sign(painter, QRectF(left, top, high * 0.8, high), "tick" if won else "trouble", ink)
        write(painter, QRectF(left + high, top, wide + 4, high), words, hero, ink)
        wrap = Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop | Qt.TextFlag.TextWordWrap
        write(painter, rect.adjusted(0, top - rect.top() + high + GAP, 0, 0), self._text, font(), palette.text, wrap)
