"""The two sides of a conversation: what each believes, takes the other to believe, and has said.

Sklar and Azhar (2015) write Sigma for an agent's beliefs, Gamma(j) for its picture of the agent j, CS for its
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
    """Picture that an agent has of another one, from what that one said or did: Gamma(j).

    Attributes:
        held: literals it is taken to hold.
        rules: it is taken to hold.
        unknown: propositions of which it was learnt that it knows nothing.
        arguments: it was told, or told itself.
        argued: conclusions for which it is taken to have some argument.
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
        """Return the opinion that the other is taken to have, what its other opinions exclude among them."""
        wanted = Literal(proposition)
        if wanted in self:
            return Stance.BELIEVES
        against = any(opposed(part, held) for part in wanted.parts for held in self.held)
        return Stance.DISBELIEVES if against else Stance.UNKNOWN

    def gaining(self, content: Content) -> "Picture":
        """Return the picture after the other has shown that it holds this, or that it knows nothing of it."""
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
        """Return the picture after the other has shown that it has some argument for this."""
        return replace(self, argued=self.argued | {conclusion})

    def has_argument(self, conclusion: Belief, rules: Iterable[Rule] = ()) -> bool:
        """Return True when the other is taken to have an argument for this.

        Args:
            conclusion: what is argued for.
            rules: of the language, which everybody knows.
        """
        known = (*rules, *sorted(self.rules, key=str))
        return conclusion in self.argued or bool(arguments_for(conclusion, self.held, known))


@dataclass(frozen=True, slots=True)
class Agent:
    """One side of a conversation.

    Attributes:
        side: the side.
        beliefs: Sigma; of a person, whose beliefs nobody reads, what she could put forward.
        is_person: True for a person: what she believes bars none of her moves.
        picture: of the other side.
        store: her commitment store: all that she has said, in order.
    """

    side: Side
    beliefs: Beliefs
    is_person: bool = False
    picture: Picture = field(default_factory=Picture)
    store: tuple[DialogueMove, ...] = ()

    def proposals(self, proposition: Proposition) -> tuple[Rule, ...]:
        """Return the rules about a proposition that it holds, and those that its arguments about it amount to.

        Such a rule leads from the literals of an argument to its conclusion; what else the argument rests on is its
        support.
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
    """Return True when whoever holds the one has an opinion on the other."""
    yes = Literal(proposition)
    return opposed(held, yes) or opposed(held, ~yes)
