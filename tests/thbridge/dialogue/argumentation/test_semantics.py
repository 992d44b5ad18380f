"""Which arguments stand together."""

import random

import pytest
from hypothesis import given

from tests.support.dialogue.random_frameworks import by_trying_all_sets, chain, frameworks, pairs, random_framework
from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.dialogue.argumentation.semantics import Semantics, extensions, grounded


def of(framework: ArgumentationFramework) -> dict[Semantics, set[frozenset[str]]]:
    """All extensions of all kinds, each found once."""
    found = {semantics: extensions(framework, semantics) for semantics in Semantics}
    assert all(len(set(each)) == len(each) for each in found.values())
    return {semantics: set(each) for semantics, each in found.items()}


@given(framework=frameworks())
def test_extensions_are_those_of_the_definitions(framework: ArgumentationFramework) -> None:
    assert of(framework) == by_trying_all_sets(framework)


@pytest.mark.parametrize("count", [300, pytest.param(10_000, marks=pytest.mark.slow)])
def test_extensions_of_larger_frameworks_are_those_of_the_definitions(count: int) -> None:
    rng = random.Random(16)
    for _ in range(count):
        framework = random_framework(rng, 2, 12)
        assert of(framework) == by_trying_all_sets(framework), framework


def test_known_frameworks() -> None:
    # Those of textbooks: two that attack each other, a cycle of three, one that attacks itself.
    nixon = ArgumentationFramework.of("ab", [("a", "b"), ("b", "a")])
    assert extensions(nixon, Semantics.GROUNDED) == (frozenset(),)
    assert extensions(nixon, Semantics.PREFERRED) == (frozenset("a"), frozenset("b"))
    assert extensions(nixon, Semantics.COMPLETE) == (frozenset(), frozenset("a"), frozenset("b"))
    circle = ArgumentationFramework.of("abc", [("a", "b"), ("b", "c"), ("c", "a")])
    assert extensions(circle, Semantics.PREFERRED) == (frozenset(),)
    assert extensions(circle, Semantics.STABLE) == ()
    assert extensions(ArgumentationFramework.of("a", [("a", "a")]), Semantics.STABLE) == ()
    assert extensions(ArgumentationFramework.of((), ()), Semantics.STABLE) == (frozenset(),)


def test_many_preferred_extensions_are_found_without_asking_for_each_of_them() -> None:
    # Growing one after the other from nothing would take minutes.
    found = extensions(pairs(9), Semantics.PREFERRED)
    assert len(found) == len(set(found)) == 2**9
    assert all(len(each) == 9 for each in found)


def test_a_long_chain_needs_no_deep_recursion() -> None:
    every_other = frozenset(f"a{number}" for number in range(0, 5001, 2))
    assert grounded(chain(5001)) == every_other
    assert extensions(chain(5001), Semantics.PREFERRED) == (every_other,)


@pytest.mark.parametrize(("arguments", "attacks"), [("aa", []), ("ab", [("a", "c")])])
def test_what_is_no_framework_is_refused(arguments: str, attacks: list[tuple[str, str]]) -> None:
    with pytest.raises(ValueError, match=r"twice|no arguments: c"):
        ArgumentationFramework.of(arguments, attacks)
