"""Abstract argumentation frameworks (Dung 1995, On the Acceptability of Arguments, Artificial Intelligence 77)."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property


@dataclass(frozen=True)
class ArgumentationFramework:
    """Arguments and their attacks.

    Attributes:
        arguments: names of the arguments, each once; results follow this order.
        attacks: pairs of an attacker and the attacked argument.

    Raises:
        ValueError: a name occurs twice, or an attack refers to an unknown argument.
    """

    arguments: tuple[str, ...]
    attacks: frozenset[tuple[str, str]]

    def __post_init__(self) -> None:
        known = set(self.arguments)
        if len(known) < len(self.arguments):
            raise ValueError("an argument occurs twice")
        if strange := {name for attack in self.attacks for name in attack} - known:
            raise ValueError(f"no arguments: {', '.join(sorted(strange))}")

    @classmethod
    def of(cls, arguments: Iterable[str], attacks: Iterable[tuple[str, str]]) -> "ArgumentationFramework":
        """Return the framework of these arguments and attacks."""
        return cls(tuple(arguments), frozenset(attacks))

    @cached_property
    def index(self) -> dict[str, int]:
        """The index of each argument."""
        return {name: place for place, name in enumerate(self.arguments)}

    @cached_property
    def attackers(self) -> tuple[tuple[int, ...], ...]:
        """The indices of the attackers of each argument, ascending."""
        return self._neighbours((target, attacker) for attacker, target in self.attacks)

    @cached_property
    def attacked(self) -> tuple[tuple[int, ...], ...]:
        """The indices of the arguments that each argument attacks, ascending."""
        return self._neighbours(self.attacks)

    def _neighbours(self, pairs: Iterable[tuple[str, str]]) -> tuple[tuple[int, ...], ...]:
        index = self.index
        places: list[list[int]] = [[] for _ in index]
        for one, other in pairs:
            places[index[one]].append(index[other])
        return tuple(tuple(sorted(each)) for each in places)
