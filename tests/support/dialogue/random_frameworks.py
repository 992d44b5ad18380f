"""Random argumentation frameworks, and their extensions, found by testing all sets of arguments."""

import random
from itertools import pairwise

from hypothesis import strategies as st

from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.dialogue.argumentation.semantics import Extension, Semantics


def random_framework(rng: random.Random, least: int, most: int) -> ArgumentationFramework:
    """Return a framework with `least` to `most` arguments, and with few or many attacks."""
    names = [f"a{number}" for number in range(rng.randint(least, most))]
    share = rng.choice([0.05, 0.1, 0.2, 0.3, 0.5])
    return ArgumentationFramework.of(names, [(a, b) for a in names for b in names if rng.random() < share])


@st.composite
def frameworks(draw: st.DrawFn, most: int = 7) -> ArgumentationFramework:
    """Return frameworks that hypothesis can shrink."""
    names = [f"a{number}" for number in range(draw(st.integers(1, most)))]
    name = st.sampled_from(names)
    return ArgumentationFramework.of(names, draw(st.lists(st.tuples(name, name), max_size=3 * len(names))))


def by_trying_all_sets(framework: ArgumentationFramework) -> dict[Semantics, set[Extension]]:
    """Return all extensions, computed from their definitions alone.

    Each set of arguments is an integer with one bit per argument.
    """
    names = framework.arguments
    count = len(names)
    attackers = [sum(1 << each for each in framework.attackers[place]) for place in range(count)]
    attacked = [sum(1 << each for each in framework.attacked[place]) for place in range(count)]
    complete: list[int] = []
    stable: list[int] = []
    for chosen in range(1 << count):
        beaten = 0
        for place in range(count):
            if chosen >> place & 1:
                beaten |= attacked[place]
        if beaten & chosen:
            continue
        defended = sum(1 << place for place in range(count) if not attackers[place] & ~beaten)
        if defended == chosen:
            complete.append(chosen)
            if beaten | chosen == (1 << count) - 1:
                stable.append(chosen)
    least = min(complete, key=int.bit_count)
    preferred = [one for one in complete if not any(one & other == one and one != other for other in complete)]
    found = {
        Semantics.GROUNDED: [least],
        Semantics.COMPLETE: complete,
        Semantics.PREFERRED: preferred,
        Semantics.STABLE: stable,
    }
    return {
        semantics: {frozenset(name for place, name in enumerate(names) if chosen >> place & 1) for chosen in sets}
        for semantics, sets in found.items()
    }


def chain(length: int) -> ArgumentationFramework:
    """Return a chain of arguments in which each argument attacks the next one."""
    names = [f"a{number}" for number in range(length)]
    return ArgumentationFramework.of(names, pairwise(names))


def pairs(count: int) -> ArgumentationFramework:
    """Return pairs of arguments that attack each other, and nothing else; at most one of each pair can be accepted."""
    names = [(f"a{number}", f"b{number}") for number in range(count)]
    return ArgumentationFramework.of([name for pair in names for name in pair], [*names, *((b, a) for a, b in names)])
