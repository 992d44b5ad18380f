"""Buttons of the rooms."""

from PySide6.QtCore import QPointF, QRectF, QSize, Signal
from PySide6.QtGui import QFocusEvent, QFontMetricsF, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import RoomTile
from ui.model.playing.spoken import spoken_tile, tile_words
from ui.model.shared.scene import RoomState
from ui.windows.look import GAP, RADIUS, colours, font, px, smooth_painter
from ui.windows.participant.widgets.buttons import ActionWidget, ParticipantButton
from ui.windows.participant.widgets.painting import Sign, box, chip, chip_size, fitting, ring, sign, write

SIGNS: dict[RoomState, Sign] = {
    "unvisited": "open",
    "reserved": "arrow",
    "visited": "dot",
    "won": "tick",
    "lost": "cross",
}

SPACE = GAP - 2
"""Distance between tiles, logical pixels."""

_FOLDED, _NARROW, _WIDE = 40, 76, 140
"""Smallest width of a folded tile, smallest width of a normal tile, and smallest width of a tile that shows the room's
name, `px`."""

_TALLEST = 1.5
"""Maximum height of a tile, as a multiple of its usual height."""


class Tile(ParticipantButton):
    """Button of a room, with the room's number, a sign of the state, and the cost or the found treasure.

    The number is also the key.

    Attributes:
        looked_at: signal: the pointer has entered or left the tile, or the tile has got or lost the focus.
    """

    looked_at = Signal()

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(texts, parent)
        self._tile: RoomTile | None = None
        self._folded = False
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)

    def show_tile(self, tile: RoomTile) -> None:
        """Show this room; do nothing if the tile has not changed."""
        if tile == self._tile:
            return
        self._tile = tile
        self.bind(tile.choose, spoken_tile(self._texts, tile))
        self.update()

    def fold(self, folded: bool) -> None:
        """If `folded` is True, show only the number and the sign; otherwise show everything."""
        if folded != self._folded:
            self._folded = folded
            self.update()

    def sizeHint(self) -> QSize:
        """Return the size of two lines, or of a number if the tile is folded."""
        return tile_size(self._folded)

    def minimumSizeHint(self) -> QSize:
        """Return the size hint, because a tile cannot be smaller."""
        return self.sizeHint()

    @property
    def pointed_room(self) -> int | None:
        """Number of the tile's room while the pointer is on the tile; otherwise None."""
        return self._tile.room if self._pointed and self._tile is not None else None

    @property
    def focused_room(self) -> int | None:
        """Number of the tile's room while the tile has the focus; otherwise None."""
        return self._tile.room if self.hasFocus() and self._tile is not None else None

    def set_pointed(self, pointed: bool) -> None:
        """Store whether the pointer was moved onto the tile, and report a change."""
        before = self._pointed
        super().set_pointed(pointed)
        if pointed != before:
            self.looked_at.emit()

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Report that the tile has got the focus."""
        super().focusInEvent(event)
        self.looked_at.emit()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Report that the tile has lost the focus."""
        super().focusOutEvent(event)
        self.looked_at.emit()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Draw the background in the color of the state, the number, the sign, and the line below them."""
        tile = self._tile
        if tile is None:
            return
        palette = colours()
        painter = smooth_painter(self)
        rect = QRectF(self.rect())
        can = tile.choose.enabled
        ground = palette.room(tile.state)
        strong = tile.considered or self.pointed_at()
        box(
            painter,
            rect,
            ground,
            palette.accent if can else palette.line,
            width=2.5 if strong else 1.0,
            dashed=not can,
            radius=RADIUS - 2,
        )
        if self.hasFocus():
            ring(painter, rect, palette.text)
        if self._folded:
            self._number(painter, tile, rect.adjusted(0.7 * GAP, 0.0, -0.7 * GAP, 0.0))
            return
        spare = max(0.0, rect.height() - tile_size(False).height()) / 2.0
        inner = rect.adjusted(1.1 * GAP, GAP / 2 + spare, -GAP, -GAP / 2 - spare)
        top = QRectF(inner.left(), inner.top(), inner.width(), QFontMetricsF(font("title", bold=True)).height())
        self._number(painter, tile, top)
        self._below(painter, tile, QRectF(inner.left(), top.bottom(), inner.width(), inner.bottom() - top.bottom()))

    def _number(self, painter: QPainter, tile: RoomTile, line: QRectF) -> None:
        palette = colours()
        face = font("body" if self._folded else "title", bold=True)
        metrics = QFontMetricsF(face)
        # The number is also the key. It has a leading zero if there are ten or more rooms.
        number = tile.choose.key or str(tile.room)
        write(painter, line, number, face, palette.text if tile.choose.enabled else palette.muted)
        side = metrics.height() * 0.7
        mark = QRectF(line.right() - side, line.center().y() - side / 2, side, side)
        kind: Sign = "busy" if tile.choose.pending else SIGNS[tile.state]
        sign(painter, mark, kind, palette.text if tile.choose.enabled or kind != "open" else palette.muted)
        if tile.robot is not None and not self._folded:
            chip(painter, QPointF(mark.left() - chip_size() / 2 - 3, line.center().y()), tile.robot)
        if self.width() >= px(_WIDE):
            at = line.left() + metrics.horizontalAdvance(number) + GAP
            room = mark.left() - at - (chip_size() + GAP if tile.robot is not None else GAP / 2)
            name = fitting((tile.name, ""), room, QFontMetricsF(font("small")))
            write(painter, QRectF(at, line.top(), room, line.height()), name, font("small"), palette.muted)

    def _below(self, painter: QPainter, tile: RoomTile, line: QRectF) -> None:
        palette = colours()
        small = font("small")
        if tile.warning:
            side = QFontMetricsF(small).height() * 0.8
            sign(painter, QRectF(line.left(), line.center().y() - side / 2, side, side), "trouble", palette.text)
            line = line.adjusted(side + 4.0, 0.0, 0.0, 0.0)
        metrics = QFontMetricsF(small)
        text = fitting(tile_words(self._texts, tile), line.width(), metrics)
        strong = tile.choose.enabled or tile.found or tile.warning
        write(painter, line, text, small, palette.text if strong else palette.muted)


def tile_size(folded: bool) -> QSize:
    """Return the smallest size of a tile: two lines, or a number with a sign."""
    if folded:
        return QSize(px(_FOLDED), int(QFontMetricsF(font("body", bold=True)).height() + 1.5 * GAP))
    high = QFontMetricsF(font("title", bold=True)).height() + QFontMetricsF(font("small")).height()
    return QSize(px(_NARROW), int(high + 1.5 * GAP))


class Tiles(ActionWidget):
    """Grid with the tiles of all rooms. If there is enough height, there are few columns, with space for names.

    If there is not enough height for a grid, the tiles fold into a row of numbers.

    Attributes:
        reveal: signal with a tile that should be scrolled into view.
        looked_at: signal: `considered` may have changed.
    """

    reveal = Signal(QWidget)
    looked_at = Signal()

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        self._shown: tuple[RoomTile, ...] = ()
        self.tiles: list[Tile] = []
        self._columns = 1
        self._tall = 0
        self._folded = False

    @property
    def considered(self) -> int | None:
        """Number of the room under the pointer or, if there is none, of the room with the focus."""
        pointed = (tile.pointed_room for tile in self.tiles)
        focused = (tile.focused_room for tile in self.tiles)
        return next((room for room in (*pointed, *focused) if room is not None), None)

    def show_tiles(self, tiles: tuple[RoomTile, ...]) -> None:
        """Show these tiles; do nothing if they are already shown."""
        if tiles == self._shown:
            return
        self._shown = tiles
        if len(tiles) != len(self.tiles):
            self._match(len(tiles))
        for shown, tile in zip(self.tiles, tiles, strict=True):
            shown.show_tile(tile)

    def fit(self, width: int, height: int, most: int) -> int:
        """Use the fewest columns that fit, or fold the tiles. Return the height of the grid.

        Args:
            width: width of the space.
            height: height of the space; tiles fill this height up to their greatest height.
            most: height to use if the tiles do not fit into `height`.
        """
        for folded, high in ((False, height), (False, most), (True, most)):
            tile = tile_size(folded)
            number = min(len(self.tiles), max(1, (width + SPACE) // (tile.width() + SPACE)))
            self._folded, self._tall = folded, tile.height()
            self._columns = next((few for few in range(1, number) if self._high(few) <= high), max(number, 1))
            if self._high(self._columns) <= high:
                break
        rows = -(-len(self.tiles) // self._columns) or 1
        # With this number of rows, fewer and wider columns may be enough.
        self._columns = -(-len(self.tiles) // rows) or 1
        tallest = int((1.0 if self._folded else _TALLEST) * self._tall)
        self._tall = max(self._tall, min((height + SPACE) // rows - SPACE, tallest))
        for shown in self.tiles:
            shown.fold(self._folded)
        self._place()
        return self._high(self._columns)

    def sizeHint(self) -> QSize:
        """Return the height of all rows."""
        return QSize(4 * px(_NARROW), self._high(self._columns))

    def minimumSizeHint(self) -> QSize:
        """Return the height of all rows and the width of one column, because the height of rows is fixed."""
        return QSize(px(_NARROW), self._high(self._columns))

    def resizeEvent(self, _event: QResizeEvent) -> None:
        """Place the tiles in the grid."""
        self._place()

    def _high(self, columns: int) -> int:
        rows = -(-len(self.tiles) // columns)
        return rows * (self._tall + SPACE) - SPACE if self.tiles else 0

    def _match(self, number: int) -> None:
        while len(self.tiles) < number:
            tile = Tile(self._texts, self)
            tile.requested.connect(self.requested)
            tile.focused.connect(self.reveal)
            tile.looked_at.connect(self.looked_at)
            tile.show()
            self.tiles.append(tile)
        while len(self.tiles) > number:
            self.tiles.pop().deleteLater()
        self.updateGeometry()
        self._place()

    def _place(self) -> None:
        if not self.tiles:
            return
        columns, space, high = self._columns, SPACE, self._tall
        edges = [round(at * (self.width() + space) / columns) for at in range(columns + 1)]
        for number, tile in enumerate(self.tiles):
            row, column = divmod(number, columns)
            tile.setGeometry(edges[column], row * (high + space), edges[column + 1] - edges[column] - space, high)
