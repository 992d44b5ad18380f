"""Beliefs of an agent (Sigma of Sklar and Azhar 2015): their origins, and their revision."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

from thbridge.dialogue.argumentation.arguments import Argument, Belief, Preference, arguments_for
from thbridge.dialogue.argumentation.cases import Stance
from thbridge.dialogue.argumentation.propositions import Literal, Proposition, Rule, opposed


class Source(StrEnum):
    """Kind of source of a belief, the most trusted first."""

    SENSED = "sensed"
    TOLD = "told"
    """Stated by another agent, which may have seen more."""
    COMPUTED = "computed"
    """Computed from maps and plans, which contain no new observations."""
    WISHED = "wished"
    """Stated as a wish, without another reason."""
    DECIDED = "decided"


_TRUST = {source: len(Source) - place for place, source in enumerate(Source)}


@dataclass(frozen=True, slots=True)
class Origin:
    """Origin of a belief.

    Attributes:
        source: kind of source of the belief.
        at: simulated time of the observation or computation, s.
        confidence: confidence of the agent that sensed or computed the belief, 0 to 1.
    """

    source: Source
    at: float = 0.0
    confidence: float = 1.0

    @property
    def is_evidence(self) -> bool:
        """True if the belief supports itself; a decision needs other beliefs as support."""
        return self.source is not Source.DECIDED

    @property
    def weight(self) -> tuple[int, float, float]:
        """Sort key of origins: by trust in the source, then by confidence, then by time of the observation."""
        return _TRUST[self.source], self.confidence, self.at


@dataclass(frozen=True, slots=True)
class Beliefs:
    """Beliefs of an agent, possibly inconsistent. A belief is "held" if it is in the set; its consequences are not
    held.

    Attributes:
        origins: origin of each literal that is held.
        rules: rules that are held, including rules of the language, which need no statement.
    """

    origins: Mapping[Literal, Origin] = field(default_factory=dict)
    rules: tuple[Rule, ...] = ()

    @classmethod
    def of(cls, literals: Iterable[Literal], rules: Iterable[Rule] = (), source: Source = Source.SENSED) -> "Beliefs":
        """Return beliefs that all have the same source."""
        return cls(dict.fromkeys(literals, Origin(source)), tuple(rules))

    def __contains__(self, belief: Belief) -> bool:
        if isinstance(belief, Rule):
            return belief in self.rules
        return all(part in self.origins for part in belief.parts)

    def stance(self, proposition: Proposition) -> Stance:
        """Return the opinion on a proposition. A proposition that other beliefs exclude counts as disbelieved.

        The opinion is unknown if there is no belief about the proposition, or if beliefs contradict each other.
        """
        wanted = Literal(proposition)
        yes, no = wanted in self, any(opposed(wanted, held) for held in self.origins)
        if yes == no:
            return Stance.UNKNOWN
        return Stance.BELIEVES if yes else Stance.DISBELIEVES

    def is_undecided(self, proposition: Proposition) -> bool:
        """Return True if the agent holds neither this proposition nor a literal that is opposed to it."""
        return self.stance(proposition) is Stance.UNKNOWN and Literal(proposition) not in self

    def arguments(self, conclusion: Belief) -> tuple[Argument, ...]:
        """Return all arguments for a conclusion."""
        return arguments_for(conclusion, self.origins, self.rules, lambda literal: self.origins[literal].is_evidence)

    def gaining(self, belief: Belief, origin: Origin) -> "Beliefs":
        """Return the beliefs with one more belief, and without the beliefs that are opposed to it."""
        if isinstance(belief, Rule):
            return self if belief in self.rules else replace(self, rules=(*self.rules, belief))
        gained = self.losing(other for other in self.origins if opposed(other, belief)).origins
        return replace(self, origins={**gained, **dict.fromkeys((belief, *belief.parts), origin)})

    def losing(self, literals: Iterable[Literal]) -> "Beliefs":
        """Return the beliefs without these literals."""
        lost = set(literals)
        return replace(self, origins={each: origin for each, origin in self.origins.items() if each not in lost})

    @property
    def prefers(self) -> Preference:
        """Preference for the argument whose weakest premise has the better origin.

        A premise of unknown origin is the weakest.
        """

        def weakest(argument: Argument) -> tuple[int, float, float]:
            origins = [self.origins[premise] for premise in argument.premises if premise in self.origins]
            if len(origins) < len(argument.premises) or not origins:
                return (0, 0.0, 0.0)
            return min(origin.weight for origin in origins)

        return lambda one, other: weakest(one) > weakest(other)
