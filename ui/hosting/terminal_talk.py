"""Texts between people, and the people of a game, at the terminal."""

from collections.abc import Callable, Iterator

from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.team_notices import MarkRead, SayToPeople, TalkLine, TeamTalk
from thbridge.roles.shared.view import TeamView, View
from thbridge.text_protocol.wire.notice_format import kind_of
from ui.model.playing.memory.talk import TalkMemory
from ui.model.playing.people import (
    commands_words,
    may_words,
    people_at_start,
    people_changes,
    robots_of,
    shown_text,
    spoken_text,
    why_not_send,
)

TO_ALL, TO_ONE = ">", "@"
"""First character of a typed text to all, and of a text to one seat, which follows the character."""


class TerminalTeamTalk:
    """Texts of a person at the terminal.

    Args:
        show: function that prints a line.
        texts: function that returns the texts of the game's language.
    """

    def __init__(self, show: Callable[[str], None], texts: Callable[[], Texts]) -> None:
        self._show = show
        self._texts = texts
        self._talk = TalkMemory()
        self._team: TeamView | None = None
        self._unshown: list[TalkLine] = []

    def hear(self, talk: TeamTalk) -> None:
        """Process texts from the keeper, and print those of other people."""
        own = "" if self._team is None else self._team.own.name
        self._unshown += self._talk.receive(talk, own)
        self._show_texts()

    def see(self, before: View | None, view: View) -> None:
        """Process a new view, and print what is new about people."""
        self._team = view.team
        if view.team is None:
            return
        self._talk.begin(view.game)
        is_new = before is None or before.game != view.game
        changes = (
            people_at_start(self._texts(), view)
            if is_new
            else people_changes(self._texts(), None if before is None else before.team, view.team)
        )
        for sentence in changes:
            self._show(sentence)
        refused = view.refusal
        if not is_new and refused is not None and before is not None and refused != before.refusal:
            self._note_refusal(refused.wish)
        self._show_texts(with_own=is_new)

    def requests(self) -> tuple[SayToPeople | MarkRead, ...]:
        """Return the open requests."""
        return () if self._team is None else self._talk.requests(self._team.read)

    def type(self, line: str) -> bool:
        """Send a typed text. Return False if the line is not a text."""
        team, typed = self._team, line.strip()
        if team is None or not typed.startswith((TO_ALL, TO_ONE)):
            return False
        name, _, text = typed[1:].partition(" ") if typed.startswith(TO_ONE) else ("", "", typed[1:])
        names = [mate.seat.name for mate in team.teammates]
        if typed.startswith(TO_ONE) and name.casefold() not in names:
            self._show(self._texts().text("terminal.no_such_person", names=", ".join(names)))
        elif not text.strip():
            self._show(self._texts().text("terminal.empty_text"))
        elif reason := why_not_send(self._texts(), team, text):
            self._show(reason)
        else:
            self._talk.write(text, 0.0)
            self._talk.send(name.casefold(), team.own.name, 0.0)
        return True

    def people(self, view: View) -> Iterator[str]:
        """Yield a line about each person in the game."""
        texts, team = self._texts(), view.team
        if team is None:
            return
        own = commands_words(texts, robots_of(view, team.own, own=True))
        yield f"  {texts.text('people.you', who=team.own.label)}: {own}. {may_words(texts, team.own)}".rstrip()
        for mate in team.teammates:
            here = texts.text("people.here" if mate.present else "people.away")
            commands = commands_words(texts, robots_of(view, mate.seat, own=False))
            yield f"  {TO_ONE}{mate.seat.name}  {mate.seat.label}: {here}, {commands}"

    def _show_texts(self, *, with_own: bool = False) -> None:
        """Print new texts. The person sees their own texts when typing them, except those of an earlier program."""
        team = self._team
        if team is None:
            return
        for line in self._unshown:
            if with_own or line.seat != team.own.name:
                self._show(spoken_text(self._texts(), team, line))
            self._talk.shown = max(self._talk.shown, line.line)
        self._unshown.clear()

    def _note_refusal(self, wish: str) -> None:
        if wish == kind_of(SayToPeople) and self._talk.pending:
            text = self._talk.pending[0].text
            self._talk.restore()
            self._talk.draft = ""
            self._show(self._texts().text("terminal.not_sent", text=shown_text(text)))
