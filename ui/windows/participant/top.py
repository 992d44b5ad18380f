"""Strip along the top with score and tools, and the banner across the map."""

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QFontMetricsF, QPaintEvent
from PySide6.QtWidgets import QHBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import Action, Banner
from ui.windows import look
from ui.windows.look import GAP, RADIUS, colours, font, smooth_painter, spaced
from ui.windows.participant.score import ScoreLabel
from ui.windows.participant.widgets.buttons import ActionRow, ActionWidget
from ui.windows.participant.widgets.painting import WRAPPED, box, sign, write
from ui.windows.participant.widgets.panels import set_text

_SPARE = 50
"""Width kept free for words that get longer during a game, `px`. Otherwise the strip would fold and move the map."""


class TopStrip(ActionWidget):
    """Strip with the score, time and remaining rooms. The tools are at its right or, if it is narrow, at its bottom."""

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        self._game = look.label(size="small", muted=True)
        self._game.setWordWrap(False)
        self.score = ScoreLabel(texts)
        self._progress = look.label()
        self._progress.setWordWrap(False)
        score, tools = spaced(QHBoxLayout(), 2 * GAP), spaced(QHBoxLayout(), GAP // 2)
        row = look.FoldingRow(score, tools, spare=_SPARE)
        spaced(QHBoxLayout(self), 0, 2 * GAP, GAP, 2 * GAP, GAP).addWidget(row)
        score.addWidget(self._game)
        score.addWidget(self.score)
        score.addWidget(self._progress)
        score.addStretch(1)
        tools.addStretch(1)
        self.tools = ActionRow(texts, tools, self.requested, "quiet")

    def show_strip(
        self, game: int, score: int | None, progress: str, *, moving: bool, tools: tuple[Action, ...]
    ) -> None:
        """Show this state of the game in the strip. If the score is None, it is hidden."""
        set_text(self._game, self._texts.text("window.game", number=game) if game else "")
        self._game.setVisible(bool(game))
        self.score.setVisible(score is not None)
        if score is not None:
            self.score.show_score(score, moving=moving)
        set_text(self._progress, progress)
        self.tools.show_actions(tools)


class BannerLine(QWidget):
    """Banner across the top of the map. It covers the edge of the map, so that nothing moves when it appears."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._banner: Banner | None = None
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.hide()

    def show_banner(self, banner: Banner | None) -> bool:
        """Show this banner. If None, show nothing. Return True if the visible content has changed."""
        if banner == self._banner:
            return False
        self._banner = banner
        self.setAccessibleName(banner.text if banner is not None else "")
        self.setVisible(banner is not None)
        self.update()
        return True

    def height_for(self, width: int) -> int:
        """Return the height that the text needs."""
        if self._banner is None:
            return 0
        frame = QRectF(0, 0, max(1.0, width - 6.0 * GAP), 1000.0)
        text = QFontMetricsF(font(bold=True)).boundingRect(frame, int(Qt.TextFlag.TextWordWrap), self._banner.text)
        return int(text.height() + 2 * GAP)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw bad news on red with a warning sign, and a note on the background of a panel."""
        if self._banner is None:
            return
        palette = colours()
        painter = smooth_painter(self)
        rect = QRectF(self.rect())
        bad = self._banner.kind == "bad"
        ink = palette.panel if bad else palette.text
        box(painter, rect, palette.bad if bad else palette.panel, palette.bad if bad else palette.line, radius=RADIUS)
        side = QFontMetricsF(font()).height()
        mark = QRectF(rect.left() + 1.5 * GAP, rect.center().y() - side / 2, side, side)
        sign(painter, mark, "trouble" if bad else "talk", ink)
        area = rect.adjusted(2.5 * GAP + side, 0, -GAP, 0)
        write(painter, area, self._banner.text, font(bold=bad), ink, WRAPPED)
