"""Arguments from beliefs, which attack or support each other (Sklar and Azhar 2015, JHRI 4(3), section 3).

An argument consists of a support and a conclusion. The support is a consistent subset of the beliefs that derives the
conclusion, and no belief in it can be left out. A support derives a rule if it derives the rule's conclusion when the
rule's premises are granted. So the premises themselves do not belong to the support.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.dialogue.argumentation.propositions import Literal, Rule, consistent, opposed

Belief = Literal | Rule
Preference = Callable[["Argument", "Argument"], bool]
"""True if the first argument is strictly better than the second argument, whose attack on the first then fails."""


@dataclass(frozen=True, slots=True)
class Argument:
    """A conclusion and the beliefs on which it rests.

    Attributes:
        support: beliefs of the support; all of them are needed.
        conclusion: the conclusion from these beliefs.
    """

    support: frozenset[Belief]
    conclusion: Belief

    @property
    def premises(self) -> frozenset[Literal]:
        """The literals of its support."""
        return frozenset(each for each in self.support if isinstance(each, Literal))

    def __str__(self) -> str:
        return f"({{{', '.join(sorted(map(str, self.support)))}}}, {self.conclusion})"


def arguments_for(
    conclusion: Belief,
    literals: Collection[Literal],
    rules: Sequence[Rule],
    is_evidence: Callable[[Literal], bool] = lambda _: True,
) -> tuple[Argument, ...]:
    """Return all arguments for a conclusion, in an order that depends only on the beliefs.

    Args:
        conclusion: conclusion of the arguments.
        literals: the believed literals.
        rules: rules that are believed, or belong to the language; rules of the language are never part of a support.
        is_evidence: True for literals that support themselves, because they were sensed, computed or stated; not for
            decisions.
    """
    held, by_conclusion = frozenset(literals), dict[Literal, list[Rule]]()
    for rule in rules:
        by_conclusion.setdefault(rule.conclusion, []).append(rule)
    granted, goal = _derivation(conclusion)

    def supports(wanted: Literal, above: frozenset[Literal]) -> Iterator[frozenset[Belief]]:
        if wanted in granted:
            yield frozenset()
            return
        if wanted in held and (above or is_evidence(wanted)):
            yield frozenset([wanted])
        # A rule with premises that depend on the wanted literal would give a circular argument.
        below = above | {wanted}
        for rule in by_conclusion.get(wanted, ()):
            if not below & set(rule.premises):
                own = frozenset[Belief]([rule])
                for parts in product(*(tuple(supports(premise, below)) for premise in rule.premises)):
                    yield own.union(*parts)

    found = {_said(whole) for whole in supports(goal, frozenset()) if _is_consistent(whole | granted)}
    minimal = [support for support in found if not any(other < support for other in found)]
    return tuple(sorted((Argument(support, conclusion) for support in minimal), key=str))


def rebuts(one: Argument, other: Argument) -> bool:
    """Return True if the conclusions are opposed. Rules are never opposed, because no literal denies a rule."""
    return isinstance(other.conclusion, Literal) and _denies(one, other.conclusion)


def undermines(one: Argument, other: Argument) -> bool:
    """Return True if the conclusion of `one` is opposed to a belief in the support of `other`."""
    return any(_denies(one, premise) for premise in other.premises)


def p_supports(one: Argument, other: Argument) -> bool:
    """Return True if the conclusion of `one` is in the support of `other`."""
    return one.conclusion in other.support


def c_supports(one: Argument, other: Argument) -> bool:
    """Return True if both have the same conclusion, and their supports have no belief in common."""
    return one.conclusion == other.conclusion and not one.support & other.support


def framework_of(
    arguments: Sequence[Argument], prefers: Preference = lambda _one, _other: False
) -> ArgumentationFramework:
    """Return the framework of these arguments, with the attacks that succeed. Each argument is named by its text.

    An attack fails if the attacked argument is preferred to the attacker.
    """
    return ArgumentationFramework.of(
        map(str, arguments),
        (
            (str(one), str(other))
            for one in arguments
            for other in arguments
            if (rebuts(one, other) or undermines(one, other)) and not prefers(other, one)
        ),
    )


def _derivation(conclusion: Belief) -> tuple[frozenset[Literal], Literal]:
    """Return the granted literals, and the literal that a support derives with them. Literals need none."""
    if isinstance(conclusion, Literal):
        return frozenset(), conclusion
    granted = frozenset(part for premise in conclusion.premises for part in (premise, *premise.parts))
    return granted, conclusion.conclusion


def _denies(argument: Argument, literal: Literal) -> bool:
    return isinstance(argument.conclusion, Literal) and opposed(argument.conclusion, literal)


def _said(whole: frozenset[Belief]) -> frozenset[Belief]:
    return frozenset(each for each in whole if isinstance(each, Literal) or each.is_said)


def _is_consistent(whole: frozenset[Belief]) -> bool:
    return consistent(frozenset(each.conclusion if isinstance(each, Rule) else each for each in whole))
