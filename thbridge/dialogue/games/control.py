"""Control layer: the dialogues of one robot and one person, in sequence, inside each other, or at the same time."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace

from thbridge.dialogue.argumentation.arguments import Belief
from thbridge.dialogue.argumentation.cases import DialogueCase, DialogueKind, Side, Stance, case_of
from thbridge.dialogue.argumentation.propositions import Literal, Proposition
from thbridge.dialogue.games.agents import Agent
from thbridge.dialogue.games.contents import DialogueMove, kind_of_content, matter_of
from thbridge.dialogue.games.dialogue_game import (
    Agents,
    GamePlay,
    GameUtterance,
    LegalMove,
    legal_replies,
    other_side,
    say,
)
from thbridge.dialogue.games.tables import DialogueEnd, Rulebook

_NOBODY_TELLS: Callable[[Side, Proposition], bool] = lambda _side, _proposition: False  # noqa: E731 - a default


class IllegalMoveError(ValueError):
    """A move, or the opening of a dialogue, that the rules do not allow."""


@dataclass(frozen=True, slots=True)
class Opening:
    """Legal opening of a dialogue.

    Attributes:
        game: name of the game.
        topic: topic of the dialogue.
        move: the first move.
    """

    game: str
    topic: Belief
    move: DialogueMove


@dataclass(frozen=True, slots=True)
class Conversation:
    """All dialogues of one robot and one person. It is a value: methods return a changed copy.

    Attributes:
        rulebook: locutions and games.
        agents: both sides.
        plays: all dialogues, including ended dialogues, in order of opening.
        record: all utterances, in order.
        able: returns True if a side is assumed to be able to answer questions about a proposition.
        since: number of dialogues that belong to a past situation; replies that were used up in these dialogues may be
            used again.
    """

    rulebook: Rulebook
    agents: Agents
    plays: tuple[GamePlay, ...] = ()
    record: tuple[GameUtterance, ...] = ()
    able: Callable[[Side, Proposition], bool] = field(default=_NOBODY_TELLS, compare=False)
    since: int = 0

    def play(self, number: int) -> GamePlay:
        """Return the dialogue with this number, from 1. Raises IllegalMoveError if it does not exist."""
        if not 0 < number <= len(self.plays):
            raise IllegalMoveError(f"there is no dialogue {number}")
        return self.plays[number - 1]

    @property
    def open_plays(self) -> tuple[GamePlay, ...]:
        """Dialogues that have not ended, including dialogues that wait for a dialogue inside them."""
        return tuple(play for play in self.plays if play.end is None)

    def waits(self, number: int) -> bool:
        """Return True while a dialogue waits for a dialogue inside it."""
        return any(play.parent == number for play in self.open_plays)

    @property
    def refused(self) -> GamePlay | None:
        """The dialogue that has just ended with a refusal, if its defender may question the refusal; otherwise None."""
        if not self.record or (number := self.record[-1].dialogue) <= self.since:
            return None
        play = self.play(number)
        outer = None if play.parent is None else self.play(play.parent)
        goes_on = outer is None or outer.end is None
        return play if play.end is not None and play.in_question is not None and goes_on else None

    def case(self, proposition: Proposition) -> DialogueCase:
        """Return the case for a proposition, from the robot's opinion and the opinion it attributes to the person."""
        robot = self.agents[Side.ROBOT]
        return case_of(robot.beliefs.stance(proposition), robot.picture.stance(proposition))

    def legal(self, number: int) -> tuple[DialogueMove, ...]:
        """Return the legal moves in a dialogue for the side whose turn it is; none while the dialogue waits."""
        return tuple(legal.move for legal in self._legal(self.play(number)))

    def openings(self, side: Side, proposition: Proposition, parent: int | None = None) -> tuple[Opening, ...]:
        """Return the openings with which a side may begin a dialogue about a proposition.

        Args:
            side: the side that opens the dialogue.
            proposition: the proposition that the dialogue is about.
            parent: number of the dialogue that will wait for the new dialogue. Either it is this side's turn in the
                parent, or the parent is `refused` and this side is its defender.
        """
        case = self.case(proposition)
        yes = Literal(proposition)
        topics: list[tuple[str, Belief]]
        match case.kind:
            case DialogueKind.PERSUASION if side in case.openers:
                robot_believes = self.agents[Side.ROBOT].beliefs.stance(proposition) is Stance.BELIEVES
                topics = [("persuasion", yes if robot_believes == (side is Side.ROBOT) else ~yes)]
            case DialogueKind.INFORMATION_SEEKING if side in case.openers:
                topics = [("information-seeking", yes)]
            case DialogueKind.INQUIRY if self.able(other_side(side), proposition):
                topics = [("information-seeking", yes)]
            case DialogueKind.INQUIRY:
                topics = [("inquiry", rule) for rule in self.agents[side].proposals(proposition)]
            case _:
                topics = []
        return tuple(opening for game, topic in topics for opening in self.opening(side, game, topic, parent))

    def opening(self, side: Side, game: str, topic: Belief, parent: int | None = None) -> tuple[Opening, ...]:
        """Return the openings with which a side may begin this game about this topic, regardless of the nine cases."""
        fresh = self._new(game, topic, side, parent)
        if parent is not None and not fresh.questions_refusal:
            outer = self.play(parent)
            if outer.end is not None or outer.speaker is not side or self.waits(parent):
                return ()
        if self.rulebook.games[game].about != kind_of_content(topic):
            return ()
        if _is_talked_over(self.open_plays, topic):
            return ()
        said = _said_inside(self.plays, parent, side)
        return tuple(
            Opening(game, topic, legal.move)
            for legal in self._legal(fresh)
            if legal.move not in said and self._has_answer(fresh, legal)
        )

    def open(self, side: Side, opening: Opening, *, parent: int | None = None, at: float = 0.0) -> "Conversation":
        """Return the conversation with a new dialogue. Raises IllegalMoveError if the opening is not legal.

        Args:
            side: the side that opens it.
            opening: one of the openings of this side.
            parent: number of the dialogue that waits for it.
            at: simulated time, s.
        """
        if opening not in self.opening(side, opening.game, opening.topic, parent):
            raise IllegalMoveError(f"the {side} may not open {opening.game} with {opening.move}")
        fresh = self._new(opening.game, opening.topic, side, parent)
        now = self._with(self.play(parent).questioned()) if parent and fresh.questions_refusal else self
        return replace(now, plays=(*now.plays, fresh))._after(fresh, opening.move, at)

    def say(self, number: int, move: DialogueMove, *, at: float = 0.0) -> "Conversation":
        """Return the conversation after a move of the side whose turn it is. Raises IllegalMoveError.

        Args:
            number: number of the dialogue.
            move: the move.
            at: simulated time, s.
        """
        return self._after(self.play(number), move, at)

    def withdraw(self, number: int) -> "Conversation":
        """Return the conversation after ending a dialogue about a past matter, and all dialogues inside it."""
        now = self._with(self.play(number).ended(DialogueEnd.WITHDRAWN))
        for inner in self.open_plays:
            if inner.parent == number:
                now = now.withdraw(inner.number)
        return now._settled()

    def begun_anew(self, is_past: Callable[[Literal], bool]) -> "Conversation":
        """Return the conversation in a new situation, in which used-up replies may be used again.

        Args:
            is_past: returns True for literals that belong only to the former situation, for example a decision.
        """
        agents = {}
        for side, agent in self.agents.items():
            past = [literal for literal in agent.beliefs.origins if is_past(literal)]
            held = frozenset(literal for literal in agent.picture.held if not is_past(literal))
            picture = replace(agent.picture, held=held)
            agents[side] = replace(agent, beliefs=agent.beliefs.losing(past), picture=picture)
        now = replace(self, agents=agents, since=len(self.plays))
        for play in self.open_plays:
            now = now.withdraw(play.number)
        return now

    def with_agent(self, agent: Agent) -> "Conversation":
        """Return the conversation with a side that has sensed something new."""
        return replace(self, agents={**self.agents, agent.side: agent})._settled()

    def _legal(self, play: GamePlay) -> tuple[LegalMove, ...]:
        if self.waits(play.number):
            return ()
        listener = other_side(play.speaker)
        return legal_replies(play, self.agents, self.rulebook, lambda what: self.able(listener, what))

    def _new(self, game: str, topic: Belief, side: Side, parent: int | None) -> GamePlay:
        number, refused = len(self.plays) + 1, self.refused
        asks = refused is not None and (refused.number, refused.defender, refused.in_question) == (parent, side, topic)
        used = self._used_up(topic, side)
        return GamePlay(number, self.rulebook.games[game], topic, side, parent, asks, barred=used)

    def _used_up(self, topic: Belief, initiator: Side) -> frozenset[tuple[DialogueMove, DialogueMove]]:
        """Return the openings of failed dialogues about a topic, each with the reply that must not be used again.

        The failed dialogues may be of any game.

        A question may be asked and answered again. If a claim got no reply, no answer was used up.
        """
        return frozenset(
            (play.moves[0][1], play.moves[1][1])
            for play in self.plays[self.since :]
            if (play.topic, play.initiator) == (topic, initiator)
            and play.end not in {None, DialogueEnd.AGREEMENT, DialogueEnd.WITHDRAWN}
            and self.rulebook.makes_claim(play.moves[0][1])
            and len(play.moves) > 1
        )

    def _has_answer(self, fresh: GamePlay, legal: LegalMove) -> bool:
        """Return True if the other side has a reply left that it has not used up in dialogues with the same beginning.

        A locution that questions a refusal must not make a claim, and the other side must have an answer.
        """
        if fresh.questions_refusal and self.rulebook.makes_claim(legal.move):
            return False
        has_barred = any(opening == legal.move for opening, _ in fresh.barred)
        if not has_barred and not fresh.questions_refusal:
            return True
        play, agents, _ = say(fresh, self.agents, self.rulebook, legal, 0.0)
        able = lambda what: self.able(fresh.initiator, what)  # noqa: E731 - the listener changes with the speaker
        return bool(legal_replies(play, agents, self.rulebook, able))

    def _after(self, play: GamePlay, move: DialogueMove, at: float) -> "Conversation":
        legal = next((legal for legal in self._legal(play) if legal.move == move), None)
        if legal is None:
            raise IllegalMoveError(f"{move} is not legal in dialogue {play.number} ({play.game.name}, {play.stage})")
        play, agents, said = say(play, self.agents, self.rulebook, legal, at)
        now = replace(self, agents=agents, record=(*self.record, *said))._with(play)
        if play.parent is not None and play.has_refuted:
            # The claim of the waiting dialogue has lost its support.
            now = now._with(now.play(play.parent).ended(DialogueEnd.DISAGREEMENT))
        return now._settled()

    def _settled(self) -> "Conversation":
        """End each dialogue in which no move is left.

        Utterances and observations outside a dialogue can use up its last move.
        """
        for play in self.open_plays:
            if not self.waits(play.number) and not self._legal(play):
                # Another dialogue that waited for the ended dialogue may also have no move left.
                return self._with(play.ended(DialogueEnd.STALEMATE))._settled()
        return self

    def _with(self, play: GamePlay) -> "Conversation":
        return replace(self, plays=(*self.plays[: play.number - 1], play, *self.plays[play.number :]))


def _is_talked_over(open_plays: Iterable[GamePlay], topic: Belief) -> bool:
    """Return True while another dialogue is about the same matter, so that its replies and their limits apply."""
    return any(matter_of(play.topic) == matter_of(topic) for play in open_plays)


def _said_inside(plays: Iterable[GamePlay], parent: int | None, side: Side) -> frozenset[DialogueMove]:
    """Return a side's openings inside a dialogue; no opening may be repeated, so that the waiting dialogue ends."""
    inside = [play for play in plays if parent is not None and (play.parent, play.initiator) == (parent, side)]
    return frozenset(play.moves[0][1] for play in inside)
