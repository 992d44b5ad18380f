"""The two sides of a conversation: their beliefs, their pictures of each other, and their statements.

Sklar and Azhar (2015) write Sigma for an agent's beliefs, Gamma(j) for its picture of the agent j, and CS for its
commitment store.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from thbridge.dialogue.argumentation.arguments import Argument, Belief, arguments_for
from thbridge.dialogue.argumentation.beliefs import Beliefs
from thbridge.dialogue.argumentation.cases import Side, Stance
from thbridge.dialogue.argumentation.propositions import Literal, Proposition, Rule, opposed
from thbridge.dialogue.games.contents import Content, DialogueMove, Unknown, matter_of


@dataclass(frozen=True, slots=True)
class Picture:
    """Picture that an agent has of another agent j, from j's statements and moves: Gamma(j).

    Attributes:
        held: literals that agent j is assumed to hold.
        rules: rules that agent j is assumed to hold.
        unknown: propositions about which agent j has shown that it knows nothing.
        arguments: arguments that one side has put forward to the other side.
        argued: conclusions for which agent j is assumed to have an argument.
    """

    held: frozenset[Literal] = frozenset()
    rules: frozenset[Rule] = frozenset()
    unknown: frozenset[Proposition] = frozenset()
    arguments: frozenset[Argument] = frozenset()
    argued: frozenset[Belief] = frozenset()

    def __contains__(self, content: Content) -> bool:
        match content:
            case Unknown(proposition):
                return proposition in self.unknown
            case Argument():
                return content in self.arguments
            case Rule():
                return content in self.rules
            case _:
                return all(part in self.held for part in content.parts)

    def stance(self, proposition: Proposition) -> Stance:
        """Return the opinion that agent j is assumed to have, also as a consequence of its other opinions."""
        wanted = Literal(proposition)
        if wanted in self:
            return Stance.BELIEVES
        against = any(opposed(part, held) for part in wanted.parts for held in self.held)
        return Stance.DISBELIEVES if against else Stance.UNKNOWN

    def gaining(self, content: Content) -> "Picture":
        """Return the picture after agent j has shown that it holds this content, or knows nothing about it."""
        match content:
            case Unknown(proposition):
                held = frozenset(each for each in self.held if not _tells(each, proposition))
                return replace(self, held=held, unknown=self.unknown | {proposition})
            case Argument(_, conclusion):
                return replace(self, arguments=self.arguments | {content}, argued=self.argued | {conclusion})
            case Rule():
                return replace(self, rules=self.rules | {content})
            case _:
                held = frozenset(each for each in self.held if not opposed(each, content))
                unknown = frozenset(each for each in self.unknown if not _tells(content, each))
                return replace(self, held=held | {content, *content.parts}, unknown=unknown)

    def arguing(self, conclusion: Belief) -> "Picture":
        """Return the picture after agent j has shown that it has some argument for this conclusion."""
        return replace(self, argued=self.argued | {conclusion})

    def has_argument(self, conclusion: Belief, rules: Iterable[Rule] = ()) -> bool:
        """Return True if agent j is assumed to have an argument for this conclusion.

        Args:
            conclusion: conclusion of the argument.
            rules: rules of the language, which all agents know.
        """
        known = (*rules, *sorted(self.rules, key=str))
        return conclusion in self.argued or bool(arguments_for(conclusion, self.held, known))


@dataclass(frozen=True, slots=True)
class Agent:
    """One side of a conversation.

    Attributes:
        side: the side.
        beliefs: Sigma; for a person, whose beliefs are not known, the beliefs that the person could put forward.
        is_person: True for a person: beliefs do not limit a person's moves.
        picture: picture of the other side.
        store: commitment store: all statements of this side, in order.
    """

    side: Side
    beliefs: Beliefs
    is_person: bool = False
    picture: Picture = field(default_factory=Picture)
    store: tuple[DialogueMove, ...] = ()

    def proposals(self, proposition: Proposition) -> tuple[Rule, ...]:
        """Return the agent's rules about a proposition, and a rule for each of its arguments about the proposition.

        The rule for an argument leads from its literals to its conclusion; the rest of the argument is the support of
        the rule.
        """
        rules = [rule for rule in self.beliefs.rules if matter_of(rule) == proposition]
        known = {(frozenset(rule.premises), rule.conclusion) for rule in rules}
        for conclusion in (Literal(proposition), Literal(proposition, holds=False)):
            for argument in self.beliefs.arguments(conclusion):
                premises = argument.premises - {conclusion}
                if premises and (premises, conclusion) not in known:
                    known.add((premises, conclusion))
                    rules.append(Rule(tuple(each for each in self.beliefs.origins if each in premises), conclusion))
        return tuple(rules)


def _tells(held: Literal, proposition: Proposition) -> bool:
    """Return True if an agent that holds the literal has an opinion on the proposition."""
    yes = Literal(proposition)
    return opposed(held, yes) or opposed(held, ~yes)
