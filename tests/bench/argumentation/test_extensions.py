"""How large frameworks may be whose extensions are found in a second, by our own search and by clingo."""

import random
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import pytest

from tests.bench.budget import Budgets, best, cpu_seconds
from tests.support.dialogue.random_frameworks import chain
from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.dialogue.argumentation.semantics import Extension, Semantics, extensions, grounded

pytestmark = pytest.mark.bench

SEEDS = range(5)
SIZES: Mapping[str, Mapping[int, tuple[int, int, int]]] = {
    "python": {2: (20_000, 20_000, 20_000), 4: (200, 200, 500), 8: (100, 100, 120)},
    "clingo": {2: (20_000, 20_000, 20_000), 4: (1500, 1500, 2000), 8: (300, 300, 350)},
}
"""Arguments, by engine and attacks for each of them, for complete, preferred and stable semantics."""


def drawn(arguments: int, attacks: int, seed: int) -> ArgumentationFramework:
    """A framework with so many attacks for each argument, from anywhere to anywhere."""
    rng = random.Random(f"{arguments} {attacks} {seed}")
    names = [f"a{number}" for number in range(arguments)]
    pairs = [(rng.choice(names), rng.choice(names)) for _ in range(arguments * attacks)]
    return ArgumentationFramework.of(names, pairs)


def engine_named(name: str) -> Callable[[ArgumentationFramework, Semantics], tuple[Extension, ...]]:
    if name == "python":
        return extensions
    pytest.importorskip("clingo", reason="clingo is not installed: make setup")
    from thbridge.dialogue.argumentation.clingo_engine import extensions_by_clingo  # noqa: PLC0415 - it needs clingo

    return extensions_by_clingo


@pytest.mark.parametrize("kind", ["chain", "2 attacks each", "8 attacks each"])
def test_the_grounded_extension_of_a_thousand_arguments(kind: str, budgets: Budgets) -> None:
    given = chain(1000) if kind == "chain" else drawn(1000, int(kind[0]), 0)
    # Who attacks whom is worked out once for a framework; it is part of the figure.
    taken = best(lambda: grounded(ArgumentationFramework.of(given.arguments, given.attacks)), 20)
    print(f"grounded, 1000 arguments, {kind}: {1e3 * taken:.2f} ms")
    budgets.time(f"argumentation: grounded, 1000 arguments, {kind}", taken)


@pytest.mark.parametrize("engine", SIZES)
@pytest.mark.parametrize("attacks", [2, 4, 8])
def test_what_is_found_in_a_second(engine: str, attacks: int, budgets: Budgets) -> None:
    find = engine_named(engine)
    kinds = (Semantics.COMPLETE, Semantics.PREFERRED, Semantics.STABLE)
    total = 0.0
    for semantics, size in zip(kinds, SIZES[engine][attacks], strict=True):
        drawn_ones = [drawn(size, attacks, seed) for seed in SEEDS]
        seconds = [cpu_seconds(partial(find, each, semantics)) for each in drawn_ones]
        total += float(np.median(seconds))
        told = f"{np.median(seconds):.2f} s, at most {max(seconds):.2f} s"
        print(f"{engine}, {attacks} attacks each, {semantics}, {size} arguments: {told}")
    budgets.time(f"argumentation: {engine}, {attacks} attacks each", total)
