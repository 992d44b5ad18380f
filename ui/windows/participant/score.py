"""Score that counts up to a new value."""

from PySide6.QtCore import QEasingCurve, QRectF, QSize, QVariantAnimation
from PySide6.QtGui import QColor, QFontMetricsF, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.spoken import signed
from ui.windows.look import GAP, colours, font, smooth_painter
from ui.windows.participant.widgets.painting import write

COUNT_DURATION = 900
"""Milliseconds during which the score counts up and the gain moves away."""


class ScoreLabel(QWidget):
    """Label of the score. When the score changes, the label counts to the new value and shows the gain for a moment."""

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts, self._word = texts, texts.text("window.score")
        self._score: int | None = None
        self._from = 0
        self._counting = QVariantAnimation(self, startValue=0.0, endValue=1.0, duration=COUNT_DURATION)
        self._counting.setEasingCurve(QEasingCurve.Type.OutCubic)
        self._counting.valueChanged.connect(lambda _value: self.update())
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)

    def show_score(self, score: int, *, moving: bool) -> None:
        """Show this score; `moving` is True for an animation."""
        if score == self._score:
            return
        self._from = self._score if self._score is not None else score
        self._score = score
        self.setAccessibleName(self._texts.text("window.score_is", score=score))
        self._counting.stop()
        if moving and self._from != score:
            self._counting.start()
        self.update()

    def sizeHint(self) -> QSize:
        """Return the size of the word, four digits and the gain."""
        hero = QFontMetricsF(font("hero", bold=True))
        small = QFontMetricsF(font("small"))
        return QSize(
            int(small.horizontalAdvance(self._word) + hero.horizontalAdvance("−0000  +00")) + 3 * GAP,
            int(hero.height()),
        )

    def minimumSizeHint(self) -> QSize:
        """Return the size of the word and the score, without space for the gain."""
        gain = QFontMetricsF(font("hero", bold=True)).horizontalAdvance("  +00")
        return self.sizeHint() - QSize(int(gain) + 2 * GAP, 0)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the word, the score and the gain."""
        palette = colours()
        painter = smooth_painter(self)
        rect = QRectF(self.rect())
        write(painter, rect, self._word, font("small"), palette.muted)
        left = rect.left() + QFontMetricsF(font("small")).horizontalAdvance(self._word) + GAP
        share = self._share()
        now, target = round(self._from + share * ((self._score or 0) - self._from)), self._score or 0
        hero = font("hero", bold=True)
        words = signed(now)
        write(painter, rect.adjusted(left, 0, 0, 0), words, hero, palette.text)
        gain = target - self._from
        if share < 1.0 and gain:
            left += QFontMetricsF(hero).horizontalAdvance(words) + GAP
            ink = QColor(palette.good if gain > 0 else palette.bad)
            ink.setAlphaF(min(1.0, 2.0 * (1.0 - share)))
            above = rect.adjusted(left, -6.0 * share, 0, -6.0 * share)
            write(painter, above, f"{'+' if gain > 0 else ''}{signed(gain)}", font("title", bold=True), ink)

    @property
    def is_counting(self) -> bool:
        """True during the animation."""
        return self._counting.state() == QVariantAnimation.State.Running

    def _share(self) -> float:
        """Return the completed share of the animation, 0 to 1."""
        if not self.is_counting:
            return 1.0
        value = self._counting.currentValue()
        return value if isinstance(value, float) else 1.0
