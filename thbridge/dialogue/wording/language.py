"""Languages: the grammar of values, and wordings of phrases, moves and lines; the most specific wording applies."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol, TypeVar

from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.contents import ContentKind
from thbridge.dialogue.wording.lines import LineKey
from thbridge.hunt.treasures import name_in_words


class AboutRobot(StrEnum):
    """Robot that a proposition is about, as seen from the robot that takes part in the dialogue."""

    SELF = "self"
    OTHER = "other"


@dataclass(frozen=True, slots=True)
class Grammar:
    """Forms of values, with the reserved word `£number£` for a number, or a number and a name.

    Attributes:
        rooms: a room, by its preposition; the empty string means no preposition.
        corridor: the corridor, by its preposition; without a reserved word.
        first_stop: the first room of a tour, with reserved words as for `rooms`.
        next_stop: each further room of a tour, after a comma.
        robot: a robot.
        picture: a picture.
        one_room: a number of rooms, if it is 1.
        many_rooms: any other number of rooms.
        between: text between two items of a list.
        between_clauses: text between two clauses, which may contain commas.
        last_and: text before the last item, if all items hold.
        last_or: text before the last item, if at least one item holds.
        rule: sentence for a rule, with the words `£premises£` and `£conclusion£`.
        decimal: sign before the decimals of a number.
        capital_after_colon: True if a sentence after a colon begins with a capital letter.
        negations: words that negate a sentence; `*n't` means all words with this end.
        bound: words whose position between values determines the meaning, such as `less`, and numbers in words; `*teen`
            means all words with this end.
        names: words for values such as colors.
        capital_nouns: True if nouns have a capital letter within sentences.
    """

    rooms: Mapping[str, str]
    corridor: Mapping[str, str]
    first_stop: str
    next_stop: str
    robot: str
    picture: str
    one_room: str
    many_rooms: str
    between: str
    between_clauses: str
    last_and: str
    last_or: str
    rule: str
    decimal: str
    capital_after_colon: bool
    negations: frozenset[str]
    bound: frozenset[str]
    names: Mapping[str, str] = field(default_factory=dict)
    capital_nouns: bool = False

    def name(self, name: str) -> str:
        """Return a name for people; in the words of the language, if there are words for this name."""
        return self.names.get(name) or name_in_words(name)

    def named(self, names: Iterable[str]) -> str:
        """Return a list of alternative names."""
        return _listed(map(self.name, names), self.between, self.last_or)

    def all_of(self, clauses: Iterable[str]) -> str:
        """Return a list of clauses that all hold."""
        return _listed(clauses, self.between_clauses, self.last_and)

    def one_of(self, clauses: Iterable[str]) -> str:
        """Return a list of alternative clauses."""
        return _listed(clauses, self.between_clauses, self.last_or)


def _listed(items: Iterable[str], between: str, last: str) -> str:
    *first, final = items
    return f"{between.join(first)}{last}{final}" if first else final


@dataclass(frozen=True, slots=True)
class PhraseWording:
    """Wordings of a proposition as a clause within sentences.

    Attributes:
        of: name of the predicate.
        robot: robot that the proposition must be about. If None, the robot does not matter.
        speaker: side to which the entry applies. If None, the entry applies to both sides.
        yes: wordings for the proposition.
        no: wordings for its negation.
        simply_yes: wordings for the proposition in simpler words, which may leave values out. If empty, `yes` is used.
        simply_no: wordings for its negation in simpler words. If empty, `no` is used.
        yes_without_energy: wordings for the proposition without amounts of energy, for people who do not see energy. If
            empty, `yes` is used, with an ellipsis in place of each amount.
        no_without_energy: the same for its negation.
    """

    of: str
    robot: AboutRobot | None = None
    speaker: Side | None = None
    yes: tuple[str, ...] = ()
    no: tuple[str, ...] = ()
    simply_yes: tuple[str, ...] = ()
    simply_no: tuple[str, ...] = ()
    yes_without_energy: tuple[str, ...] = ()
    no_without_energy: tuple[str, ...] = ()

    def wordings(self, *, holds: bool, simply: bool, names_energy: bool = True) -> tuple[str, ...]:
        """Return the wordings for one purpose. There may be none."""
        simple = self.simply_yes if holds else self.simply_no
        without = self.yes_without_energy if holds else self.no_without_energy
        return (not names_energy and without) or (simply and simple) or (self.yes if holds else self.no)

    @property
    def narrowing(self) -> tuple[object, ...]:
        """Conditions of this entry, the most important first. None means that a condition is missing."""
        return self.robot, self.speaker


@dataclass(frozen=True, slots=True)
class MoveWording:
    """Wordings of a move.

    Attributes:
        move: name of the locution.
        content: kind of the move's content.
        speaker: the side that makes the move.
        condition: condition of a study in which the entry applies. If None, the entry applies in all conditions.
        of: predicate to which the entry applies. If None, the entry applies to all predicates.
        holds: True for affirmed propositions only, False for negated propositions only. If None, the entry applies to
            both.
        robot: robot that the proposition must be about. If None, the robot does not matter.
        say: the wordings, at least one.
    """

    move: str
    speaker: Side
    say: tuple[str, ...]
    content: ContentKind = ContentKind.LITERAL
    condition: DialogueCondition | None = None
    of: str | None = None
    holds: bool | None = None
    robot: AboutRobot | None = None

    @property
    def narrowing(self) -> tuple[object, ...]:
        """Conditions of this entry, the most important first. None means that a condition is missing."""
        return self.condition, self.of, self.holds, self.robot


class _Narrowed(Protocol):
    @property
    def narrowing(self) -> tuple[object, ...]: ...


_Entry = TypeVar("_Entry", bound=_Narrowed)


@dataclass(frozen=True, slots=True)
class Language:
    """Language of robots and people.

    Attributes:
        name: name of its folder: `en`.
        title: name of the language in itself: `English`.
        grammar: forms of values.
        phrases: wordings of propositions; among equally specific ones, the last applies.
        moves: wordings of moves; among equally specific ones, the last applies.
        lines: wordings of other lines.
        fallback: language for missing words; None if there is none.
    """

    name: str
    title: str
    grammar: Grammar
    phrases: tuple[PhraseWording, ...]
    moves: tuple[MoveWording, ...]
    lines: Mapping[LineKey, tuple[str, ...]]
    fallback: "Language | None" = None

    def phrase(
        self,
        of: str,
        speaker: Side,
        robot: AboutRobot | None,
        *,
        holds: bool = True,
        simply: bool = False,
        names_energy: bool = True,
    ) -> tuple[str, ...]:
        """Return the most specific wordings of a proposition; empty if there are none.

        Args:
            of: name of the proposition's predicate.
            speaker: the side that speaks.
            robot: robot that the proposition is about; None if it is about no robot.
            holds: False for the negation.
            simply: True for simpler words, if there are any.
            names_energy: False for words without amounts of energy, if there are any.
        """

        def wordings(entry: PhraseWording) -> tuple[str, ...]:
            return entry.wordings(holds=holds, simply=simply, names_energy=names_energy)

        found = _most_specific((each for each in self.phrases if each.of == of and wordings(each)), (robot, speaker))
        if found is not None:
            return wordings(found)
        if self.fallback is not None:
            return self.fallback.phrase(of, speaker, robot, holds=holds, simply=simply, names_energy=names_energy)
        return ()

    def move(
        self,
        name: str,
        content: ContentKind,
        speaker: Side,
        *,
        condition: DialogueCondition | None = None,
        of: str | None = None,
        holds: bool = True,
        robot: AboutRobot | None = None,
    ) -> tuple[str, ...]:
        """Return the most specific wordings of a move; empty if there are none. Arguments as in `MoveWording`."""
        found = _most_specific(
            (each for each in self.moves if each.move == name and each.content is content and each.speaker is speaker),
            (condition, of, holds, robot),
        )
        if found is not None:
            return found.say
        if self.fallback is not None:
            return self.fallback.move(name, content, speaker, condition=condition, of=of, holds=holds, robot=robot)
        return ()

    def line(self, key: LineKey) -> tuple[str, ...]:
        """Return the wordings of a line; empty if there are none."""
        if key in self.lines:
            return self.lines[key]
        return () if self.fallback is None else self.fallback.line(key)


def _most_specific(entries: Iterable[_Entry], case: tuple[object, ...]) -> _Entry | None:
    """Return the most specific entry for a case. A condition on an earlier part of the case counts more."""
    best: _Entry | None = None
    for entry in entries:
        fits = all(wanted is None or wanted == given for wanted, given in zip(entry.narrowing, case, strict=True))
        if fits and (best is None or _specificity(entry) >= _specificity(best)):
            best = entry
    return best


def _specificity(entry: _Narrowed) -> tuple[bool, ...]:
    return tuple(part is not None for part in entry.narrowing)
