"""Arguments from beliefs, and how they attack and support each other (Sklar and Azhar 2015, JHRI 4(3), section 3).

An argument is a support and a conclusion: the support is part of the beliefs, consistent, derives the conclusion, and
nothing can be left out of it.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from thbridge.argumentation.framework import ArgumentationFramework
from thbridge.argumentation.propositions import Literal, Rule, consistent, opposed

Belief = Literal | Rule
Preference = Callable[["Argument", "Argument"], bool]
"""True when the first argument is strictly better than the second, so that the second's attack on it fails."""


@dataclass(frozen=True, slots=True)
class Argument:
    """A conclusion and what it rests on.

    Attributes:
        support: beliefs, all of which are needed.
        conclusion: what follows from them.
    """

    support: frozenset[Belief]
    conclusion: Literal

    @property
    def premises(self) -> frozenset[Literal]:
        """The literals of its support."""
        return frozenset(each for each in self.support if isinstance(each, Literal))

    def __str__(self) -> str:
        return f"({{{', '.join(sorted(map(str, self.support)))}}}, {self.conclusion})"


def arguments_for(
    conclusion: Literal,
    literals: Collection[Literal],
    rules: Sequence[Rule],
    is_evidence: Callable[[Literal], bool] = lambda _: True,
) -> tuple[Argument, ...]:
    """Return all arguments for a conclusion, in an order that depends on the beliefs alone.

    Args:
        conclusion: what is argued for.
        literals: what is believed.
        rules: that are believed, or belong to the language; those of the language are in no support.
        is_evidence: True for literals that support themselves, being sensed, computed or told; a decision does not.
    """
    held, by_conclusion = frozenset(literals), dict[Literal, list[Rule]]()
    for rule in rules:
        by_conclusion.setdefault(rule.conclusion, []).append(rule)

    def supports(wanted: Literal, above: frozenset[Literal]) -> Iterator[frozenset[Belief]]:
        if wanted in held and (above or is_evidence(wanted)):
            yield frozenset([wanted])
        # A rule whose premises need what is wanted would argue in a circle.
        below = above | {wanted}
        for rule in by_conclusion.get(wanted, ()):
            if not below & set(rule.premises):
                own = frozenset[Belief]([rule])
                for parts in product(*(tuple(supports(premise, below)) for premise in rule.premises)):
                    yield own.union(*parts)

    found = {_said(whole) for whole in supports(conclusion, frozenset()) if _is_consistent(whole)}
    minimal = [support for support in found if not any(other < support for other in found)]
    return tuple(sorted((Argument(support, conclusion) for support in minimal), key=str))


def rebuts(one: Argument, other: Argument) -> bool:
    """Return True when the conclusions are opposed."""
    return opposed(one.conclusion, other.conclusion)


def undermines(one: Argument, other: Argument) -> bool:
    """Return True when the conclusion of one is opposed to something that the other rests on."""
    return any(opposed(one.conclusion, premise) for premise in other.premises)


def p_supports(one: Argument, other: Argument) -> bool:
    """Return True when the other rests on the conclusion of one."""
    return one.conclusion in other.support


def c_supports(one: Argument, other: Argument) -> bool:
    """Return True when both have the same conclusion and nothing in common that they rest on."""
    return one.conclusion == other.conclusion and not one.support & other.support


def framework_of(
    arguments: Sequence[Argument], prefers: Preference = lambda _one, _other: False
) -> ArgumentationFramework:
    """Return the framework of these arguments, each under its text, with the attacks that succeed.

    An attack fails where what is attacked is preferred to the attacker.
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


def _said(whole: frozenset[Belief]) -> frozenset[Belief]:
    return frozenset(each for each in whole if isinstance(each, Literal) or each.is_said)


def _is_consistent(whole: frozenset[Belief]) -> bool:
    return consistent(frozenset(each.conclusion if isinstance(each, Rule) else each for each in whole))
