"""Exchanges of an example, played in the terminal by people or programs."""

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from thbridge.dialogue.argumentation.cases import DialogueKind, Side
from thbridge.dialogue.examples import Exchange
from thbridge.dialogue.exchange_play import CourseFollower, ExchangeAct, acts, turn_in
from thbridge.dialogue.games.agents import Agent
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.dialogue_game import GamePlay, GameUtterance
from thbridge.dialogue.games.strategies import ArguingStrategy
from thbridge.dialogue.wording.wording import Wording
from ui.command_line.terminal import print_json

HELP = """\
    1, 2, ...  say the sentence with this number
    s          show the commitment stores: all that each side has said
    b          show the beliefs of each side, also those about the other side
    n          between dialogues: open no further dialogue
    ?          show this list, and the possible sentences
    q          quit"""


class Quit(Exception):  # noqa: N818 - nothing went wrong
    """The person quits, or the input has ended."""


Chooser = Callable[[Conversation, tuple[ExchangeAct, ...]], ExchangeAct | None]


@dataclass(slots=True)
class TerminalTalk:
    """Play of one exchange, shown move by move.

    Attributes:
        exchange: exchange to play.
        people: sides that a person plays.
        game: name of the only game that players may open. If None, the nine cases determine the games.
        seed: random seed of the programs' choices, if the example permits several moves.
        wording: wording that turns moves into sentences.
        show: function that prints a line.
        heard: function that receives each utterance.
    """

    exchange: Exchange
    people: frozenset[Side]
    game: str | None
    seed: int
    wording: Wording
    show: Callable[[str], None]
    heard: Callable[[GameUtterance], None] = lambda _utterance: None
    _now: Conversation = field(init=False)

    def play(self) -> None:
        """Play the exchange to its end. Raise Quit when the person quits."""
        exchange = self.exchange if self.game is None else replace(self.exchange, course=())
        self._now = exchange.start
        # If both sides are programs, they make only the moves of the example.
        alone = not self.people and self.game is None
        strategy = None if alone else ArguingStrategy()
        choosers: Mapping[Side, Chooser] = {
            side: self._ask(side) if side in self.people else CourseFollower(exchange, side, self.seed, strategy).choose
            for side in Side
        }
        if self.game is None:
            for line in _case_lines(exchange):
                self.show(line)
        while True:
            turn = turn_in(self._now)
            for side in Side if turn is None else (turn[1],):
                possible = acts(exchange, self._now, side, self.game)
                act = choosers[side](self._now, possible) if possible else None
                if act is not None:
                    self._do(act, side)
                    break
                if turn is not None:
                    self.show(f"{side} may say: {'; '.join(str(each.move) for each in possible)}")
            else:
                break
        if self._now.open_plays:
            self.show("The example ends here.")

    def _do(self, act: ExchangeAct, side: Side) -> None:
        before, self._now = self._now, act.done(self._now, side)
        for play in self._now.plays[len(before.plays) :]:
            inside = "" if play.parent is None else f", inside dialogue {play.parent}, which is paused"
            self.show(f"{self._indent(play)}Dialogue {play.number} opens: {play.game.name} about {play.topic}{inside}")
        for utterance in self._now.record[len(before.record) :]:
            self.heard(utterance)
            follows = " (follows automatically)" if utterance.is_booked else ""
            indent = self._indent(self._now.play(utterance.dialogue))
            self.show(f"{indent}  {utterance.side}: {utterance.move}{follows}")
            if sentence := self._sentence(utterance.move, utterance.side):
                self.show(f"{indent}    {sentence}")
        for play in self._now.plays:
            if play.end is not None and (play.number > len(before.plays) or before.play(play.number).end is None):
                self.show(f"{self._indent(play)}Dialogue {play.number} ends: {play.end}, {play.end.meaning}")

    def _sentence(self, move: DialogueMove, side: Side) -> str:
        try:
            return f'"{self.wording.sentence(move, side)}"'
        except ValueError:
            # A locution that a lab has added may have no words yet.
            return ""

    def _choice_lines(self, side: Side, possible: tuple[ExchangeAct, ...], *, between: bool) -> Iterator[str]:
        yield f"{side}, choose:"
        for number, act in enumerate(possible, start=1):
            opens = "" if act.opening is None else f"   (opens {act.opening.game})"
            yield f"  {number}  {act.move}   {self._sentence(act.move, side)}{opens}".rstrip()
        yield "  n  no further dialogue   ?  help" if between else "  ?  help"

    def _indent(self, play: GamePlay) -> str:
        return "" if play.parent is None else f"{self._indent(self._now.play(play.parent))}    "

    def _ask(self, side: Side) -> Chooser:
        def choose(conversation: Conversation, possible: tuple[ExchangeAct, ...]) -> ExchangeAct | None:
            between = turn_in(conversation) is None
            choices = list(self._choice_lines(side, possible, between=between))
            for line in choices:
                self.show(line)
            while True:
                match _typed():
                    case "s":
                        lines = list(_store_lines(conversation))
                    case "b":
                        lines = list(_belief_lines(conversation))
                    case "q":
                        raise Quit
                    case "n" if between:
                        return None
                    case number if number.isdecimal() and len(number) < 6 and 0 < int(number) <= len(possible):
                        return possible[int(number) - 1]
                    case "":
                        lines = []
                    case _:
                        lines = [HELP, *choices]
                for line in lines:
                    self.show(line)

        return choose


def print_utterance(exchange: int, said: GameUtterance) -> None:
    """Print an utterance as JSON, with the number of its exchange."""
    print_json(
        {
            "exchange": exchange,
            "dialogue": said.dialogue,
            "parent": said.parent,
            "index": said.index,
            "side": said.side,
            "locution": said.move.locution,
            "content": str(said.move.content),
            "before": said.before,
            "after": said.after,
            "booked": said.is_booked,
        }
    )


def _typed() -> str:
    """Return the next typed line, without blanks around it. Raise Quit at the end of the input."""
    line = sys.stdin.buffer.readline() if sys.stdin is not None else b""
    if not line:
        raise Quit
    return line.decode("utf-8", "replace").strip()


def _case_lines(exchange: Exchange) -> Iterator[str]:
    for topic in exchange.topics:
        case = exchange.start.case(topic)
        ways = [
            f"the {side} may open {name}"
            for side in Side
            for name in dict.fromkeys(opening.game for opening in exchange.start.openings(side, topic))
        ]
        agreement = "agreement, no dialogue" if case.kind is DialogueKind.AGREEMENT else "no dialogue"
        yield f"{topic}: case {case.number}; {', '.join(ways) or agreement}"


def _store_lines(conversation: Conversation) -> Iterator[str]:
    for side, agent in conversation.agents.items():
        yield f"said by the {side}: {_listed(agent.store)}"


def _belief_lines(conversation: Conversation) -> Iterator[str]:
    for side, agent in conversation.agents.items():
        yield from _beliefs_of(side, agent)


def _beliefs_of(side: Side, agent: Agent) -> Iterator[str]:
    beliefs, picture = agent.beliefs, agent.picture
    # The beliefs of a person are unknown, except the beliefs that the person may put forward.
    yield f"the {side} {'may put forward' if agent.is_person else 'believes'}: {_listed(beliefs.origins)}"
    yield f"  rules: {_listed(beliefs.rules)}"
    yield f"  believes that the other believes: {_listed(sorted(map(str, {*picture.held, *picture.rules})))}"
    if picture.unknown:
        yield f"  believes that the other does not know: {_listed(sorted(map(str, picture.unknown)))}"


def _listed(things: Iterable[object]) -> str:
    return "; ".join(map(str, things)) or "nothing"
