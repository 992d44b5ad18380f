"""Propositions, which hold or do not hold, and rules that derive a proposition from other propositions."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Proposition:
    """Something that holds or does not; each kind of proposition is a class with its own fields."""

    def excludes(self, other: "Proposition") -> bool:
        """Return True if this and another proposition cannot both hold, such as two values of the same thing."""
        return False

    @property
    def is_wish(self) -> bool:
        """True if the proposition only states a wish."""
        return False

    @property
    def parts(self) -> "tuple[Literal, ...]":
        """Literals that all hold if this proposition holds. The only part of a simple proposition is itself."""
        return (Literal(self),)


@dataclass(frozen=True, slots=True)
class Literal:
    """A proposition or its negation.

    Attributes:
        proposition: the proposition.
        holds: False for its negation.
    """

    proposition: Proposition
    holds: bool = True

    def __invert__(self) -> "Literal":
        return Literal(self.proposition, not self.holds)

    @property
    def parts(self) -> "tuple[Literal, ...]":
        """The literals that it consists of.

        For a conjunction, these are its parts. For the opposite of a conjunction, they are the negations of its parts.
        """
        return tuple(part if self.holds else ~part for part in self.proposition.parts)

    def __str__(self) -> str:
        if len(parts := self.parts) > 1:
            return " and ".join(map(str, parts))
        return f"{'' if self.holds else 'not '}{self.proposition}"


@dataclass(frozen=True, slots=True)
class Conjunction(Proposition):
    """Several literals at once, such as an order of rooms; its opposite denies each of them (Sklar and Azhar 2015).

    Attributes:
        literals: at least two literals; none of them is a conjunction.
    """

    literals: tuple[Literal, ...]

    @property
    def parts(self) -> tuple[Literal, ...]:
        """The literals."""
        return self.literals

    def __str__(self) -> str:
        return " and ".join(map(str, self.literals))


@dataclass(frozen=True, slots=True)
class Rule:
    """If all premises hold, the conclusion holds.

    Attributes:
        premises: at least one.
        conclusion: the conclusion.
        is_said: False for a rule of the language, which both sides know and need not say.
    """

    premises: tuple[Literal, ...]
    conclusion: Literal
    is_said: bool = True

    def __str__(self) -> str:
        return f"{' and '.join(map(str, self.premises))} -> {self.conclusion}"


def opposed(one: Literal, other: Literal) -> bool:
    """Return True if two literals cannot both hold: one denies the other, or both exclude each other."""
    return any(_clash(part, another) for part in one.parts for another in other.parts)


def _clash(one: Literal, other: Literal) -> bool:
    if one.proposition == other.proposition:
        return one.holds != other.holds
    both = one.holds and other.holds
    return both and (one.proposition.excludes(other.proposition) or other.proposition.excludes(one.proposition))


def consistent(literals: "frozenset[Literal]") -> bool:
    """Return True if no two of these are opposed."""
    ordered = tuple(literals)
    return not any(opposed(one, other) for at, one in enumerate(ordered) for other in ordered[at + 1 :])
