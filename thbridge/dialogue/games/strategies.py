"""Strategies of programs in dialogue games: the choice among legal moves, by attitude and persistence.

Attitudes toward the other side's statements follow Parsons, Wooldridge and Amgoud (2003, Properties and Complexity of
Some Formal Inter-agent Dialogues), with grounded semantics. Credulous agents accept all statements with a reason.
Cautious agents accept a statement unless an argument of their own in the grounded extension attacks it. Sceptical
agents accept statements for which the grounded extension contains an argument of their own.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from thbridge.dialogue.argumentation.arguments import Argument, Belief, framework_of
from thbridge.dialogue.argumentation.beliefs import Beliefs
from thbridge.dialogue.argumentation.propositions import Literal, opposed
from thbridge.dialogue.argumentation.semantics import grounded
from thbridge.dialogue.games.agents import Agent
from thbridge.dialogue.games.contents import ContentKind, DialogueMove, kind_of_content
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.dialogue_game import GamePlay
from thbridge.dialogue.games.locutions import origin_of_hearsay
from thbridge.dialogue.games.tables import DialogueEnd


class GameStrategy(Protocol):
    """Choice of a program's moves; it must depend only on its arguments and its constructor's arguments."""

    def choose(self, conversation: Conversation, number: int) -> DialogueMove:
        """Return a legal move in dialogue `number`. The dialogue has at least one legal move."""
        ...


class Attitude(StrEnum):
    """Attitude to statements of the other side."""

    CREDULOUS = "credulous"
    CAUTIOUS = "cautious"
    SCEPTICAL = "sceptical"


@dataclass(frozen=True, slots=True)
class ArguingStrategy:
    """Strategy of a program that argues.

    Attributes:
        attitude: attitude to statements of the other side.
        persistence: number of dialogues about the same claim in which it maintains its position; with 0, the program
            gives in at once.
        announces: True if the program states the whole argument before its single parts.
    """

    attitude: Attitude = Attitude.CAUTIOUS
    persistence: int = 2
    announces: bool = True

    def choose(self, conversation: Conversation, number: int) -> DialogueMove:
        """Return a move; see `GameStrategy`."""
        play, legal = conversation.play(number), conversation.legal(number)
        agent = conversation.agents[play.speaker]
        by_name: dict[str, list[DialogueMove]] = {}
        for move in legal:
            by_name.setdefault(move.locution, []).append(move)
        if play.claim is None or play.defender is play.speaker:
            return self._say(play, agent, by_name, legal)
        content = play.offered[-1] if play.offered else play.claim
        accepting = by_name.get("accept", [])
        if accepting and (self._gives_in(conversation, play) or self._agrees(agent, play.claim, content)):
            return accepting[0]
        holds_out = [*by_name.get("assert", []), *by_name.get("challenge", []), *by_name.get("reject", [])]
        return (holds_out or list(legal))[0]

    def _say(
        self, play: GamePlay, agent: Agent, by_name: dict[str, list[DialogueMove]], legal: tuple[DialogueMove, ...]
    ) -> DialogueMove:
        """Choose among assertions: answers to a question, or support for a claim."""
        wholes = [move for move in legal if kind_of_content(move.content) is ContentKind.ARGUMENT]
        rest = [move for move in legal if move not in wholes]
        if wholes and (self.announces or not rest):
            return wholes[0]
        return (rest or list(legal))[0]

    def _gives_in(self, conversation: Conversation, play: GamePlay) -> bool:
        earlier = [
            other
            for other in conversation.plays[conversation.since :]
            if other.end not in {None, DialogueEnd.WITHDRAWN}
            and other.topic == play.topic
            and other.initiator is play.initiator
        ]
        return len(earlier) >= self.persistence and play.initiator is not play.speaker

    def _agrees(self, agent: Agent, claim: Belief, content: Belief) -> bool:
        """Return True if an agent accepts a content that is the claim or its support."""
        if content in agent.beliefs and content == claim:
            return True
        own = agent.beliefs
        supposed = own if content == claim else own.gaining(content, origin_of_hearsay(content, 0.0))
        for_it, against = _standing(supposed, claim)
        if content != claim:
            denied = _standing(own, content)[1]
            if self.attitude is Attitude.SCEPTICAL:
                return content in own or bool(_standing(own, content)[0])
            return self.attitude is Attitude.CREDULOUS or not (against or denied)
        if self.attitude is Attitude.CAUTIOUS:
            # The program asks for a missing reason, unless it has an argument of its own.
            return bool(for_it) and not against
        return bool(for_it) if self.attitude is Attitude.SCEPTICAL else not against


def _standing(beliefs: Beliefs, claim: Belief) -> tuple[list[Argument], list[Argument]]:
    """Return the arguments for and against a claim that are in the grounded extension.

    The arguments against a rule are the arguments against its conclusion, provided that the grounded extension supports
    each premise of the rule.
    """
    against_it: list[Literal] = []
    if isinstance(claim, Literal):
        against_it = [~claim, *(held for held in beliefs.origins if opposed(held, claim) and held != ~claim)]
    # Arguments against a premise also count.
    arguments = dict.fromkeys(argument for each in (claim, *against_it) for argument in beliefs.arguments(each))
    premises = dict.fromkeys(premise for argument in arguments for premise in sorted(argument.premises, key=str))
    arguments |= dict.fromkeys(argument for premise in premises for argument in beliefs.arguments(~premise))
    standing = grounded(framework_of(tuple(arguments), beliefs.prefers))
    found = [argument for argument in arguments if str(argument) in standing]
    for_it = [argument for argument in found if argument.conclusion == claim]
    if isinstance(claim, Literal):
        return for_it, [
            each for each in found if isinstance(each.conclusion, Literal) and opposed(each.conclusion, claim)
        ]
    has_premises = all(_standing(beliefs, premise)[0] for premise in claim.premises)
    return for_it, _standing(beliefs, claim.conclusion)[1] if has_premises else []
