"""clingo finds what our own search finds."""

import random

import pytest
from hypothesis import given

from tests.support.dialogue.random_frameworks import chain, frameworks, pairs, random_framework
from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.dialogue.argumentation.semantics import Semantics, extensions

pytest.importorskip("clingo", reason="clingo is not installed: make setup")

from thbridge.dialogue.argumentation.clingo_engine import extensions_by_clingo


@given(framework=frameworks())
def test_extensions_are_the_same_in_the_same_order(framework: ArgumentationFramework) -> None:
    for semantics in Semantics:
        assert extensions_by_clingo(framework, semantics) == extensions(framework, semantics)


@pytest.mark.parametrize("count", [150, pytest.param(1000, marks=pytest.mark.slow)])
def test_extensions_of_larger_frameworks_are_the_same(count: int) -> None:
    rng = random.Random(17)
    for _ in range(count):
        framework = random_framework(rng, 8, 30)
        for semantics in Semantics:
            assert extensions_by_clingo(framework, semantics) == extensions(framework, semantics), framework


def test_nothing_is_said_where_there_is_nothing_to_decide(capfd: pytest.CaptureFixture[str]) -> None:
    circle = ArgumentationFramework.of("abc", [("a", "b"), ("b", "c"), ("c", "a")])
    for framework in (circle, chain(3), ArgumentationFramework.of((), ())):
        for semantics in Semantics:
            assert extensions_by_clingo(framework, semantics) == extensions(framework, semantics)
    assert capfd.readouterr() == ("", "")


def test_thousands_of_preferred_extensions() -> None:
    assert len(set(extensions_by_clingo(pairs(11), Semantics.PREFERRED))) == 2**11
