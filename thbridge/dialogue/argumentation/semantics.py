"""Extensions: sets of arguments that can be accepted together.

Grounded, complete, preferred and stable extensions are computed exactly. Grounded extensions take time linear in the
number of attacks. The other extensions are found as labelings (Caminada 2006, On the Issue of Reinstatement in
Argumentation): an argument is in if all its attackers are out, out if one of them is in, and otherwise undecided. The
search keeps the possible labels of each argument, and draws all conclusions before it guesses.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from enum import StrEnum

from thbridge.dialogue.argumentation.framework import ArgumentationFramework

Extension = frozenset[str]
"""Set of arguments that can be accepted together."""

IN, OUT, UNDECIDED = 1, 2, 4
"""Labels of an argument. Each label is a bit, so a number can represent the set of an argument's possible labels."""
_ANY = IN | OUT | UNDECIDED


class Semantics(StrEnum):
    """Definition of extensions, with the names that solver competitions (ICCMA) use."""

    GROUNDED = "GR"
    COMPLETE = "CO"
    PREFERRED = "PR"
    STABLE = "ST"


def extensions(framework: ArgumentationFramework, semantics: Semantics) -> tuple[Extension, ...]:
    """Return all extensions, in the order of their arguments' indices.

    All semantics except stable semantics have at least one extension.
    """
    return in_order(framework, _FINDERS[semantics](framework))


def in_order(framework: ArgumentationFramework, found: Iterable[Extension]) -> tuple[Extension, ...]:
    """Return extensions in the order of the indices of their arguments."""
    return tuple(sorted(found, key=lambda extension: sorted(framework.index[name] for name in extension)))


def grounded(framework: ArgumentationFramework) -> Extension:
    """Return the grounded extension: the arguments that even the most cautious agent must accept."""
    return _names(framework, (place for place, label in enumerate(grounded_labels(framework)) if label == IN))


def grounded_labels(framework: ArgumentationFramework) -> list[int]:
    """Return the label of each argument by its index; an argument that is neither in nor out is undecided."""
    return _grounded(framework)[0]


def grounded_steps(framework: ArgumentationFramework) -> list[int | None]:
    """Return, for the argument at each index, the step in which it was labeled "in" or "out".

    In step k, after k other arguments, one argument is labeled "in"; the arguments that it attacks are labeled "out".
    For undecided arguments, the step is None.
    """
    return _grounded(framework)[1]


def _grounded(framework: ArgumentationFramework) -> tuple[list[int], list[int | None]]:
    """Return labels and steps; each attack is examined once."""
    labels = [UNDECIDED] * len(framework.arguments)
    steps: list[int | None] = [None] * len(labels)
    standing = [0] * len(labels)
    for targets in framework.attacked:
        for target in targets:
            standing[target] += 1
    ready = deque(place for place, count in enumerate(standing) if count == 0)
    step = 0
    while ready:
        place = ready.popleft()
        labels[place], steps[place] = IN, step
        for defeated in framework.attacked[place]:
            if labels[defeated] == OUT:
                continue
            labels[defeated], steps[defeated] = OUT, step
            for freed in framework.attacked[defeated]:
                standing[freed] -= 1
                if standing[freed] == 0:
                    ready.append(freed)
        step += 1
    return labels, steps


def complete(framework: ArgumentationFramework) -> Iterator[Extension]:
    """Yield the complete extensions."""
    for labels in _Search(framework).labellings():
        yield _names(framework, (place for place, label in enumerate(labels) if label == IN))


def stable(framework: ArgumentationFramework) -> Iterator[Extension]:
    """Yield the stable extensions: those that attack all arguments outside them."""
    for labels in _Search(framework, IN | OUT).labellings():
        yield _names(framework, (place for place, label in enumerate(labels) if label == IN))


def preferred(framework: ArgumentationFramework) -> Iterator[Extension]:
    """Yield the preferred extensions: the complete extensions that are not part of a larger complete extension.

    The search finds larger extensions first. So an extension is preferred if it is not part of an earlier result. The
    search skips branches that contain only parts of earlier results.
    """
    others: list[int] = []
    for labels in _Search(framework).labellings(others):
        others.append(_bits(place for place, label in enumerate(labels) if label != IN))
        yield _names(framework, (place for place, label in enumerate(labels) if label == IN))


def _names(framework: ArgumentationFramework, places: Iterable[int]) -> Extension:
    return frozenset(framework.arguments[place] for place in places)


def _bits(places: Iterable[int]) -> int:
    """Return a set of indices as the bits of a number."""
    return sum(1 << place for place in places)


class _Search:
    """Search for complete labelings.

    Args:
        framework: the framework to label.
        labels: labels that arguments may have.
    """

    def __init__(self, framework: ArgumentationFramework, labels: int = _ANY) -> None:
        self._attackers, self._attacked = framework.attackers, framework.attacked
        grounded_ones = grounded_labels(framework)
        # A grounded argument has its label in every complete labeling.
        self._start = [labels if label == UNDECIDED else label & labels for label in grounded_ones]

    def labellings(self, some_of: Sequence[int] = ()) -> Iterator[list[int]]:
        """Yield each labeling once. A labeling comes after all labelings in which more arguments are "in".

        Args:
            some_of: sets of the arguments' indices, as bits of numbers. At least one argument of each set must be in.
                Sets may be added between two labelings.
        """
        start = list(self._start)
        open_ones = self._conclude(start, range(len(start)), some_of)
        stack = [] if open_ones is None else [(start, open_ones, len(some_of))]
        while stack:
            may_be, open_ones, known = stack.pop()
            if known < len(some_of):
                still_open = self._conclude(may_be, (), [*open_ones, *some_of[known:]])
                if still_open is None:
                    continue
                open_ones = still_open
            place = self._undetermined(may_be)
            if place is None:
                yield may_be
                continue
            # The label that was pushed last is tried first. This order makes larger extensions come first.
            for label in (UNDECIDED, OUT, IN):
                if may_be[place] & label:
                    guess = list(may_be)
                    guess[place] = label
                    still_open = self._conclude(guess, (place, *self._attacked[place]), open_ones)
                    if still_open is not None:
                        stack.append((guess, still_open, len(some_of)))

    def _undetermined(self, may_be: Sequence[int]) -> int | None:
        """Return the index of the argument that attacks the most arguments, among arguments with an unknown label."""
        places = (place for place, labels in enumerate(may_be) if labels & (labels - 1))
        return max(places, key=lambda place: len(self._attacked[place]), default=None)

    def _conclude(self, may_be: list[int], changed: Iterable[int], some_of: Sequence[int]) -> Sequence[int] | None:
        """Draw all conclusions. Return the sets without an argument that is IN, or None if no labeling is left."""
        queue = deque(changed)
        waiting = set(queue)

        def restrict(place: int, labels: int) -> None:
            if may_be[place] & ~labels:
                may_be[place] &= labels
                for touched in (place, *self._attacked[place]):
                    if touched not in waiting:
                        waiting.add(touched)
                        queue.append(touched)

        while True:
            while queue:
                place = queue.popleft()
                waiting.discard(place)
                self._restrict_around(place, may_be, restrict)
                if not may_be[place]:
                    return None
            if some_of:
                are_in = _bits(place for place, labels in enumerate(may_be) if labels == IN)
                may_be_in = _bits(place for place, labels in enumerate(may_be) if labels & IN)
                some_of = [places for places in some_of if not places & are_in]
                for places in some_of:
                    able = places & may_be_in
                    if not able:
                        return None
                    if not able & (able - 1):
                        restrict(able.bit_length() - 1, IN)
            if not queue:
                return some_of

    def _restrict_around(self, place: int, may_be: list[int], restrict: Callable[[int, int], None]) -> None:
        """Restrict the labels of an argument by the labels of its attackers, and the other way round."""
        attackers = self._attackers[place]
        labels = [may_be[each] for each in attackers]
        if any(each == IN for each in labels):
            restrict(place, OUT)
        if all(each == OUT for each in labels):
            restrict(place, IN)
        if any(not each & OUT for each in labels):
            restrict(place, OUT | UNDECIDED)
        if not any(each & IN for each in labels):
            restrict(place, IN | UNDECIDED)
        if not any(each & UNDECIDED for each in labels):
            restrict(place, IN | OUT)
        own = may_be[place]
        if own == IN:
            for each in attackers:
                restrict(each, OUT)
        if not own & OUT:
            for each in attackers:
                restrict(each, OUT | UNDECIDED)
        for mine, theirs in _NEEDS_ONE:
            able = [each for each in attackers if may_be[each] & theirs]
            if not own & ~mine and len(able) == 1:
                restrict(able[0], theirs)


_NEEDS_ONE = ((OUT, IN), (UNDECIDED, UNDECIDED), (OUT | UNDECIDED, IN | UNDECIDED))
"""Pairs of sets of labels. If an argument has a label of the first set, an attacker has a label of the second set."""

_FINDERS: Mapping[Semantics, Callable[[ArgumentationFramework], Iterable[Extension]]] = {
    Semantics.GROUNDED: lambda framework: (grounded(framework),),
    Semantics.COMPLETE: complete,
    Semantics.PREFERRED: preferred,
    Semantics.STABLE: stable,
}
