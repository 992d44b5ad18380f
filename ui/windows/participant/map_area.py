"""Map with votes, the banner and the history over its edges, and with a pop-up over one of its corners."""

from collections.abc import Callable, Sequence

from PySide6.QtCore import QEvent, QPoint, QRect, QSize, Qt
from PySide6.QtGui import QResizeEvent, QShowEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import OpenVote
from ui.windows import look
from ui.windows.look import GAP, px
from ui.windows.map import MapView
from ui.windows.participant.history import HistoryView
from ui.windows.participant.top import BannerLine
from ui.windows.participant.votes import VotesPanel
from ui.windows.participant.widgets.panels import TitledPanel

MAX_PANEL_WIDTH = 620
"""Maximum width of a panel in the middle of the map, `px`."""

Corner = tuple[bool, bool]
"""Corner of the map, as two flags: the first is True on the right side, the second is True at the bottom."""

_CORNERS: tuple[Corner, ...] = ((True, True), (True, False), (False, True), (False, False))


class MapArea(QWidget):
    """Map that fills the whole area. A banner, the history and at most one panel cover parts of the map.

    A pop-up about a robot covers the corner of the map that is farthest from the robot and its room. While the pop-up
    is about the same robot, it stays in this corner, unless it would hide the robot or the room. A pop-up covers at
    most half of the map and two thirds of the map's height, unless its words need more space. If no corner is free,
    the pop-up is made as low as its words allow. All other panels are in the middle. Pop-ups and panels never move
    the map.
    """

    def __init__(self, texts: Texts, map_view: MapView) -> None:
        super().__init__()
        self._map = map_view
        map_view.setParent(self)
        self.history = HistoryView(texts, self)
        self.history.hide()
        self.banner = BannerLine(self)
        self.votes = VotesPanel(texts, self)
        self._unseen = look.label(muted=True)
        self._unseen.setParent(self)
        self._unseen.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._unseen.hide()
        self._panel: TitledPanel | None = None
        self._robot: int | None = None
        self._subject: object = None
        self._about: Callable[[], Sequence[QRect]] = tuple
        self._high = 0
        self._corner: Corner | None = None
        self.setMinimumSize(240, 160)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def show_panel(
        self,
        panel: TitledPanel | None,
        robot: int | None = None,
        subject: object = None,
        about: Callable[[], Sequence[QRect]] = tuple,
    ) -> None:
        """Show this panel. If None, show no panel.

        Args:
            panel: the panel.
            robot: index of the robot of a pop-up. Pop-ups about the same robot stay in the same corner. If None, the
                panel is in the middle.
            subject: subject of a pop-up. While the subject is the same, the height of the pop-up never decreases.
            about: function that returns the parts of the map that a pop-up should leave visible, pixels; the most
                important part is the first.
        """
        self._about = about
        if (robot, subject) != (self._robot, self._subject):
            self._high = 0
        if robot != self._robot:
            self._corner = None
        self._robot, self._subject = robot, subject
        if panel is not self._panel:
            if self._panel is not None:
                self._panel.hide()
            self._panel = panel
            if panel is not None:
                panel.setParent(self)
                panel.show()
        self._place()

    def show_history(self, shown: bool) -> None:
        """Show the history over the lower edge of the map, or hide it."""
        self.history.setVisible(shown)
        self._place()

    def show_votes(self, votes: tuple[OpenVote, ...]) -> None:
        """Show these open votes over the upper edge of the map; pop-ups and the banner are below them."""
        high = self._votes_high()
        self.votes.show_votes(votes)
        if self._votes_high() != high:
            self.place_anew()

    def show_no_map(self, sentence: str) -> None:
        """Show a sentence instead of the map; if it is empty, show the map."""
        self._map.setVisible(not sentence)
        self._unseen.setText(sentence)
        self._unseen.setVisible(bool(sentence))

    def keep_in_sight(self) -> None:
        """Move the pop-up to another corner if it would hide less of its subject there.

        If the map follows the robot, the map moves instead. It keeps the robot in the middle of the free part.
        """
        self._map.sight = None
        if self._panel is None or self._robot is None or self._corner is None:
            return
        if self._map.followed == self._robot:
            self._map.sight = self._free(self._panel.geometry())
            return
        size, space = self._panel.size(), self._space()
        hidden = self._hides(self._at(self._corner, size, space))
        if hidden and self._hides_at_best(size, space) < hidden:
            self._corner = self._best_corner(size, space)
            self._place()

    def place_anew(self) -> None:
        """Lay out everything again after a change of the map. A pop-up may move to another corner."""
        self._corner, self._high = None, 0
        self._place()

    def resizeEvent(self, _event: QResizeEvent) -> None:
        """Lay out everything again in the new size."""
        self.place_anew()

    def showEvent(self, _event: QShowEvent) -> None:
        """Lay out everything again, because Qt did not report new sizes to the map while the area was hidden."""
        self.place_anew()

    def event(self, event: QEvent) -> bool:
        """Lay out everything again after a change of a panel's words, which may need another size."""
        if event.type() == QEvent.Type.LayoutRequest:
            self._place()
        return super().event(event)

    def _place(self) -> None:
        self._map.setGeometry(self.rect())
        self._unseen.setGeometry(self.rect().adjusted(2 * GAP, 2 * GAP, -2 * GAP, -2 * GAP))
        if self._votes_high():
            size = self.votes.size_in(self._whole().size())
            self.votes.setGeometry(QRect(QPoint((self.width() - size.width()) // 2, GAP), size))
            self.votes.raise_()
        high = self.history.height_over(self.height())
        self.history.setGeometry(0, self.height() - high, self.width(), high)
        self.history.raise_()
        self._place_panel()
        self._place_banner()

    def _place_panel(self) -> None:
        panel = self._panel
        if panel is None:
            return
        space = self._space()
        if self._robot is None:
            # Put the panel below the banner. In a low window, the banner would hide the title of the panel.
            space.setTop(space.top() + self.banner.height_for(space.width()))
            size = panel.wanted(min(px(MAX_PANEL_WIDTH), space.width()), space.height())
            place = QRect(QPoint(0, 0), size)
            place.moveCenter(space.center())
        else:
            usual = panel.usual_size()
            width = min(usual.width(), space.width())
            most = int(min(self.width() / 2 / width, 2 / 3) * self.height())
            panel.arrange(QSize(space.width(), most))
            least = panel.least(width)
            if not self._high:
                high = max(min(usual.height(), most), least)
                heights = (*range(high, least, -GAP), least)
                self._high = min(heights, key=lambda high: self._hides_at_best(QSize(width, high), space))
            self._high = max(self._high, least)
            size = QSize(width, min(self._high, space.height()))
            if self._corner is None:
                self._corner = self._best_corner(size, space)
            place = self._at(self._corner, size, space)
        panel.setGeometry(place)
        panel.raise_()

    def _place_banner(self) -> None:
        """Put the banner along the upper edge of the map, or along the lower edge if a pop-up is at the top."""
        width = self.width() - 2 * GAP
        high = self.banner.height_for(width)
        above = self._panel is None or self._robot is None or self._corner is None or self._corner[1]
        space = self._space()
        self.banner.setGeometry(GAP, space.top() if above else space.bottom() + 1 - high, width, high)
        self.banner.raise_()

    def _space(self) -> QRect:
        """Return the part of the map that panels may cover."""
        high = self._votes_high()
        return self._whole().adjusted(0, high + GAP if high else 0, 0, 0)

    def _whole(self) -> QRect:
        """Return the part of the map that votes and panels may cover."""
        below = self.history.height() if self.history.isVisibleTo(self) else 0
        return self.rect().adjusted(GAP, GAP, -GAP, -GAP - below)

    def _votes_high(self) -> int:
        """Return the height of the open votes; 0 if there are none."""
        return self.votes.size_in(self._whole().size()).height() if self.votes.isVisibleTo(self) else 0

    def _best_corner(self, size: QSize, space: QRect) -> Corner:
        """Return the corner in which a pop-up hides the smallest part of its subject.

        If several corners are equal, return the corner that is farthest from the subject.

        If the map follows the robot, return the corner of the map that is farthest from the robot, because the view can
        move to the free side.
        """
        if self._robot is not None and self._map.followed == self._robot:
            opposite = self._map.opposite_corner(self._robot)
            if opposite is not None:
                return opposite

        def merit(corner: Corner) -> tuple[int, int]:
            place, about = self._at(corner, size, space), self._about()
            apart = ((place.center() - part.center()).manhattanLength() for part in about)
            return -self._hides(place), min(apart, default=0)

        return max(_CORNERS, key=merit)

    def _hides(self, place: QRect) -> int:
        """Return the total weight of the subject's parts that a pop-up would hide. The first part weighs most."""
        about = self._about()
        return sum(2 ** (len(about) - at) for at, part in enumerate(about) if place.intersects(part))

    def _hides_at_best(self, size: QSize, space: QRect) -> int:
        """Return the weight of the parts that a pop-up of this size would hide in its best corner."""
        return self._hides(self._at(self._best_corner(size, space), size, space))

    def _free(self, panel: QRect) -> QRect:
        """Return the larger of two parts of the map: the part next to a pop-up, or the part above or below it."""
        next_to, over = self._space(), self._space()
        if panel.center().x() > next_to.center().x():
            next_to.setRight(panel.left())
        else:
            next_to.setLeft(panel.right())
        if panel.center().y() > over.center().y():
            over.setBottom(panel.top())
        else:
            over.setTop(panel.bottom())
        return max(next_to, over, key=lambda part: min(part.width(), part.height()))

    @staticmethod
    def _at(corner: Corner, size: QSize, space: QRect) -> QRect:
        """Return the place of a pop-up of this size in a corner."""
        at_right, at_bottom = corner
        x = space.right() + 1 - size.width() if at_right else space.left()
        y = space.bottom() + 1 - size.height() if at_bottom else space.top()
        return QRect(QPoint(x, y), size)
