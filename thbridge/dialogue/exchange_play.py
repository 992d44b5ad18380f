"""Play of one exchange of an example: the possible acts of a side, and programs that follow the exchange's course."""

from collections.abc import Iterator
from dataclasses import dataclass

from sim.numerics import noise
from thbridge.dialogue.argumentation.arguments import Belief
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal, Proposition
from thbridge.dialogue.examples import Exchange
from thbridge.dialogue.games.contents import DialogueMove, matter_of
from thbridge.dialogue.games.control import Conversation, Opening
from thbridge.dialogue.games.strategies import GameStrategy


@dataclass(frozen=True, slots=True)
class ExchangeAct:
    """Act of a side: a move in a dialogue, or the opening of another dialogue.

    Attributes:
        move: the move.
        number: number of the dialogue of the move, or of the dialogue that waits for a new dialogue; None if there is
            none.
        opening: opening of a new dialogue; None for a move.
    """

    move: DialogueMove
    number: int | None
    opening: Opening | None = None

    def done(self, conversation: Conversation, side: Side) -> Conversation:
        """Return the conversation after this act of a side."""
        if self.opening is not None:
            return conversation.open(side, self.opening, parent=self.number)
        return conversation if self.number is None else conversation.say(self.number, self.move)


def turn_in(conversation: Conversation) -> tuple[int, Side] | None:
    """Return the innermost dialogue under way and the side whose turn it is; None between dialogues."""
    going = [play for play in conversation.open_plays if not conversation.waits(play.number)]
    return (going[-1].number, going[-1].speaker) if going else None


def acts(
    exchange: Exchange, conversation: Conversation, side: Side, game: str | None = None
) -> tuple[ExchangeAct, ...]:
    """Return all possible acts of a side: moves in the present dialogue, openings of dialogues, and questions.

    Args:
        exchange: the exchange. Dialogues are about its topics, and about parts of these topics.
        conversation: the present conversation.
        side: the side whose turn it is. Between dialogues, it may be either side.
        game: the only game that may be opened. If None, the nine cases determine the games.
    """
    number = turn[0] if (turn := turn_in(conversation)) is not None else None
    moves = () if number is None else conversation.legal(number)
    said = tuple(ExchangeAct(move, number) for move in moves)
    asked = tuple(_questions(conversation, side, game))
    found = (
        ExchangeAct(opening.move, number, opening)
        for matter in _matters(exchange, conversation)
        for opening in _openings(conversation, side, matter, number, game)
    )
    return (*said, *dict.fromkeys(found), *asked)


def _questions(conversation: Conversation, side: Side, game: str | None) -> Iterator[ExchangeAct]:
    """Yield the questions about a refusal that has just ended a dialogue."""
    refused = conversation.refused
    if refused is None or refused.in_question is None:
        return
    for opening in conversation.opening(side, game or "information-seeking", refused.in_question, refused.number):
        yield ExchangeAct(opening.move, refused.number, opening)


def _openings(
    conversation: Conversation, side: Side, matter: Proposition, parent: int | None, game: str | None
) -> Iterator[Opening]:
    if game is None:
        yield from conversation.openings(side, matter, parent)
        return
    topics: tuple[Belief, ...] = (Literal(matter), Literal(matter, holds=False))
    if conversation.rulebook.games[game].about == "rule":
        topics = conversation.agents[side].proposals(matter)
    for topic in topics:
        yield from conversation.opening(side, game, topic, parent)


def _matters(exchange: Exchange, conversation: Conversation) -> list[Proposition]:
    """Return the possible subjects of a new dialogue: topics and their parts, except those already under discussion."""
    parts = [part.proposition for topic in exchange.topics for part in topic.parts]
    open_ones = {matter_of(play.topic) for play in conversation.open_plays}
    return [each for each in dict.fromkeys([*exchange.topics, *parts]) if each not in open_ones]


@dataclass(slots=True)
class CourseFollower:
    """Program that plays a side according to the course of an exchange.

    Attributes:
        exchange: the exchange.
        side: the side that it plays.
        seed: random seed for the choice among moves that the example allows.
        strategy: chooses moves that the course does not determine. Without a course, a dialogue is opened with the
            first possible move. If None, the program does nothing in these cases.
    """

    exchange: Exchange
    side: Side
    seed: int
    strategy: GameStrategy | None = None
    _next: int = 0

    def choose(self, conversation: Conversation, possible: tuple[ExchangeAct, ...]) -> ExchangeAct | None:
        """Return one of the possible acts, or None if none of them fits the course."""
        # If a move and an opening have the same text, the text means the move.
        by_text = {str(act.move): act for act in reversed(possible)}
        course = self.exchange.course
        for at in range(self._next, len(course)):
            side, texts = course[at]
            found = [by_text[text] for text in texts if text in by_text]
            if side is self.side and found:
                self._next = at + 1
                stream = noise.key(self.seed, "course", str(self.side))
                return found[int(noise.uniform(stream, at, 0) * len(found))]
        if self.strategy is None:
            return None
        if (turn := turn_in(conversation)) is not None:
            return ExchangeAct(self.strategy.choose(conversation, turn[0]), turn[0])
        return possible[0] if possible and not course and not conversation.plays else None
