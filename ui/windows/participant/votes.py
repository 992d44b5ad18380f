"""Open votes of the participants, over the upper edge of the map."""

from dataclasses import replace

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QVBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import OpenVote, VoteAct
from ui.windows import look
from ui.windows.look import GAP, px, spaced
from ui.windows.participant.widgets.buttons import ActionRow
from ui.windows.participant.widgets.focus import make_region
from ui.windows.participant.widgets.panels import OpaqueBackground, PanelScrollArea, RobotChip, least_height, set_text
from ui.windows.participant.widgets.reason_line import ReasonLine

WIDTH = 520
"""Greatest width of the panel, `px`."""


class VoteRow(QWidget):
    """One open vote: who proposes what, the time left, the votes so far, and the buttons of the person's own vote.

    Attributes:
        requested: signal with a `VoteAct`.
    """

    requested = Signal(object)
    _pressed = Signal(object)

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._vote: OpenVote | None = None
        self._chip = RobotChip(texts)
        self.title, self.left = look.label(bold=True), look.label(size="small", muted=True)
        self.left.setWordWrap(False)
        self.cast, self.needed = look.label(size="small"), look.label(size="small", muted=True)
        self.reason = ReasonLine(texts.text("votes.reason"))
        rows = spaced(QVBoxLayout(self), GAP // 2, 0)
        top = spaced(QHBoxLayout(), GAP)
        top.addWidget(self._chip, 0, Qt.AlignmentFlag.AlignVCenter)
        top.addWidget(self.title, 1)
        top.addWidget(self.left, 0, Qt.AlignmentFlag.AlignTop)
        rows.addLayout(top)
        rows.addWidget(self.cast)
        rows.addWidget(self.needed)
        foot = spaced(QHBoxLayout(), GAP)
        foot.addWidget(self.reason, 1)
        self._pressed.connect(self._cast)
        self.buttons = ActionRow(texts, foot, self._pressed)
        rows.addLayout(foot)

    @property
    def decision(self) -> int:
        """Number of the decision; 0 before a vote is shown."""
        return 0 if self._vote is None else self._vote.decision

    def show_vote(self, vote: OpenVote) -> None:
        """Show this vote; do nothing if it is already shown."""
        if vote == self._vote:
            return
        if self._vote is None or vote.decision != self._vote.decision:
            self.reason.clear()
        self._vote = vote
        self._chip.show_robot(vote.robot)
        set_text(self.title, vote.title)
        set_text(self.left, vote.left)
        set_text(self.cast, "\n".join(f"{'✓' if each.agrees else '✗'}  {each.words}" for each in vote.votes))
        self.cast.setVisible(bool(vote.votes))
        set_text(self.needed, vote.needed)
        self.reason.setVisible(bool(vote.buttons))
        self.buttons.show_actions(vote.buttons)

    def _cast(self, act: VoteAct) -> None:
        self.requested.emit(replace(act, reason=self.reason.text().strip()))
        self.reason.clear()
        if self.reason.hasFocus():
            self.window().setFocus()


class VotesPanel(QFrame):
    """Panel with all open votes; it is hidden while there are none.

    Attributes:
        requested: signal with a `VoteAct`.
    """

    requested = Signal(object)

    def __init__(self, texts: Texts, parent: QWidget) -> None:
        super().__init__(parent)
        self._texts = texts
        look.style_as_panel(self)
        make_region(self, texts.text("votes.title"))
        inside = OpaqueBackground()
        self._rows = spaced(QVBoxLayout(inside), int(1.5 * GAP), GAP // 2)
        spaced(QVBoxLayout(self), 0, GAP // 2).addWidget(PanelScrollArea(inside, self._rows))
        self.votes: list[VoteRow] = []
        self.hide()

    def show_votes(self, votes: tuple[OpenVote, ...]) -> None:
        """Show these votes. Each vote keeps its row, so that a person who types a reason loses nothing."""
        open_ = {vote.decision for vote in votes}
        for row in [row for row in self.votes if row.decision not in open_]:
            self.votes.remove(row)
            self._rows.removeWidget(row)
            row.hide()
            row.deleteLater()
        known = {row.decision: row for row in self.votes}
        for vote in votes:
            row = known.get(vote.decision) or self._made()
            row.show_vote(vote)
        self.setVisible(bool(votes))

    def size_in(self, space: QSize) -> QSize:
        """Return the size of the panel in a space on the map: as high as its words, but less than half of the space."""
        wide = min(px(WIDTH), space.width())
        around = self.width() - self.contentsRect().width() + GAP
        return QSize(wide, min(least_height(self._rows, wide - around) + around, int(0.48 * space.height())))

    def _made(self) -> VoteRow:
        row = VoteRow(self._texts)
        row.requested.connect(self.requested)
        self._rows.addWidget(row)
        self.votes.append(row)
        row.show()
        return row
