"""Texts between participants: the texts of the game, texts on their way, and the text that a person is writing."""

from dataclasses import dataclass, field

from thbridge.roles.shared.team_notices import LONGEST_TEXT, MarkRead, SayToPeople, TalkLine, TeamTalk

LONGEST_DRAFT = 4 * LONGEST_TEXT
"""Greatest length of a text that is being written, characters. A text that is too long can be shortened."""


@dataclass(slots=True)
class TalkMemory:
    """Texts of one game, as one seat sees them.

    Attributes:
        game: number of the game; 0 before the first.
        lines: texts that the keeper has, by number.
        pending: texts that the keeper does not have yet, oldest first.
        draft: text that the person is writing.
        restored: number of times that a text was put back into the draft. Front ends then show the draft again.
        to: seat of the addressee; empty for all.
        began: time at which the person typed the first letter of the draft; None while the draft is empty.
        shown: number of the last text that a front end has shown.
    """

    game: int = 0
    lines: dict[int, TalkLine] = field(default_factory=dict)
    pending: tuple[SayToPeople, ...] = ()
    draft: str = ""
    restored: int = 0
    to: str = ""
    began: float | None = None
    shown: int = 0

    def begin(self, game: int) -> None:
        """Prepare for the game with this number. Texts that another game did not get return to the draft."""
        if game == self.game:
            return
        self.game = game
        self._clear()

    def receive(self, talk: TeamTalk, own: str) -> tuple[TalkLine, ...]:
        """Add texts, and return those that are new.

        Args:
            talk: the texts.
            own: the person's own seat; empty before the first view, when no text is on its way.
        """
        self.begin(talk.game)
        if any(self.lines.get(line.line, line) != line for line in talk.lines):
            self._clear()  # The server has started again, with a game of the same number.
        new = tuple(line for line in talk.lines if line.line not in self.lines)
        self.lines |= {line.line: line for line in new}
        arrived = {(line.number, line.to, line.text) for line in new if line.seat == own}
        self.pending = tuple(each for each in self.pending if (each.number, each.to, each.text) not in arrived)
        return new

    def write(self, text: str, now: float) -> None:
        """Note the text that the person is writing."""
        self.draft = text[:LONGEST_DRAFT]
        if not self.draft:
            self.began = None
        elif self.began is None:
            self.began = now

    def send(self, to: str, own: str, now: float) -> None:
        """Send the draft to a seat, or to all, and begin an empty draft. `own` is the person's own seat."""
        typing = 0.0 if self.began is None else now - self.began
        arrived = [line.number for line in self.lines.values() if line.seat == own]
        number = 1 + max([*arrived, *(each.number for each in self.pending)], default=0)
        self.pending += (SayToPeople(self.draft.strip(), to, round(typing, 3), number),)
        self.draft, self.began = "", None

    def restore(self) -> None:
        """Put the oldest text on its way back into the draft, because the game does not accept it."""
        if self.pending:
            refused, *others = self.pending
            self.pending = tuple(others)
            self.draft = " ".join(filter(None, (refused.text, self.draft)))[:LONGEST_DRAFT]
            self.restored += 1

    def requests(self, read: int) -> tuple[SayToPeople | MarkRead, ...]:
        """Return the open requests. `read` is the number of the last text that the keeper knows as read."""
        return (*self.pending, *((MarkRead(self.shown),) if self.shown > read else ()))

    def _clear(self) -> None:
        while self.pending:
            self.restore()
        self.lines.clear()
        self.shown = 0
