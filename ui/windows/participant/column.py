"""Column next to the map, with the robots above the rooms."""

import math

from PySide6.QtCore import QEvent, QObject, QSize, Qt
from PySide6.QtGui import QFontMetricsF, QResizeEvent
from PySide6.QtWidgets import QFrame, QScrollArea, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.windows import look
from ui.windows.look import GAP, px
from ui.windows.participant.cards import Cards
from ui.windows.participant.tiles import Tiles
from ui.windows.participant.widgets.buttons import ActionButton, ActionWidget
from ui.windows.participant.widgets.focus import make_region

_SECTION = int(1.5 * GAP)
"""Distance between robots and rooms, logical pixels."""


class SideColumn(ActionWidget):
    """Column with the robots above the rooms.

    If there is little height, first the robots' cards move closer together, then the rooms fold, and finally both parts
    scroll.
    """

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self.cards, self.tiles = Cards(texts), Tiles(texts)
        self.card_area, self.rooms = ColumnScrollArea(self.cards, self), QWidget(self)
        self.tile_area = ColumnScrollArea(self.tiles, self.rooms)
        self.dont_know = ActionButton(texts, parent=self.rooms)
        self.hint = look.label(size="small", muted=True)
        self.hint.setParent(self.rooms)
        self.hint.setAlignment(Qt.AlignmentFlag.AlignTop)
        make_region(self.cards, texts.text("window.robots"))
        make_region(self.rooms, texts.text("window.rooms"))
        for part in (self.cards, self.tiles, self.dont_know):
            part.requested.connect(self.requested)
        self.cards.reveal.connect(lambda card: self.card_area.ensureWidgetVisible(card, 0, GAP))
        self.tiles.reveal.connect(lambda tile: self.tile_area.ensureWidgetVisible(tile, 0, GAP))

    def sizeHint(self) -> QSize:
        """Return a usual size; the window sets the width."""
        return QSize(px(336), 480)

    def resizeEvent(self, _event: QResizeEvent) -> None:
        """Divide the new height between robots and rooms."""
        self._place()

    def event(self, event: QEvent) -> bool:
        """Divide the height again after a change of the number of robots or rooms."""
        if event.type() == QEvent.Type.LayoutRequest:
            self._place()
        return super().event(event)

    def _place(self) -> None:
        wide, high = self.width(), self.height()
        button = self.dont_know.heightForWidth(wide)
        lines = 2 if wide >= px(300) else 3
        hint = lines * math.ceil(QFontMetricsF(self.hint.font()).lineSpacing())
        below = button + hint + 2 * (GAP - 2)
        room = high - below - _SECTION
        least, most = self.cards.minimumSizeHint().height(), self.cards.sizeHint().height()
        to_come = self.cards.height_to_come()
        tiles = self.tiles.fit(wide, room - most - to_come, room - least - to_come)
        if least + tiles > room:
            # If the two parts do not fit together, each part gets two fifths of the height or the height that it
            # needs. The other part gets the rest.
            tiles = min(tiles, max(room - least, int(0.4 * room)))
        cards = min(most, room - tiles)
        to_come = min(to_come, room - tiles - cards)
        self.card_area.setGeometry(0, 0, wide, cards)
        self.rooms.setGeometry(0, cards + to_come + _SECTION, wide, tiles + below)
        self.tile_area.setGeometry(0, 0, wide, tiles)
        self.dont_know.setGeometry(0, tiles + GAP - 2, wide, button)
        self.hint.setGeometry(0, tiles + button + 2 * (GAP - 2), wide, hint)


class ColumnScrollArea(QScrollArea):
    """Scroll area without a frame. Its scroll bar is visible only if the widget inside does not fit."""

    def __init__(self, inside: QWidget, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setWidget(inside)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Ask the layout for a new size when the widget inside changes its size."""
        if event.type() == QEvent.Type.LayoutRequest:
            self.updateGeometry()
        return super().eventFilter(watched, event)
