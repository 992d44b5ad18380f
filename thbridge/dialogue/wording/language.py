"""Languages: the grammar of values, and wordings of phrases, moves and lines, of which the most specific is said."""

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
    """Robot that a proposition is about, as seen from the one that takes part in the dialogue."""

    SELF = "self"
    OTHER = "other"


@dataclass(frozen=True, slots=True)
class Grammar:
    """Forms of values, with the reserved word `£number£` for a number, or a number and a name.

    Attributes:
        rooms: a room, by the preposition that it stands with; the empty one stands for none.
        corridor: the corridor, in the same way; without a reserved word.
        first_stop: the first room of a tour, with reserved words as for `rooms`.
        next_stop: each further one, after a comma.
        robot: a robot.
        picture: a picture.
        one_room: a single room that is counted.
        many_rooms: any other number of rooms.
        between: what stands between two things of a list.
        between_clauses: the same between clauses, which may have commas.
        last_and: what stands before the last one, where all hold.
        last_or: what stands before the last one, where one does.
        rule: that something follows, with the words `£premises£` and `£conclusion£`.
        decimal: sign before the decimals of a number.
        capital_after_colon: True where a sentence after a colon begins with a capital.
        negations: words that deny what a sentence says; `*n't` stands for all words that end so.
        bound: words whose place between values gives these their meaning, such as `less`, and numbers in words; `*teen`
            as above.
        names: values such as colors, as the language says them.
        capital_nouns: True where nouns have a capital within sentences.
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
        """Return a name as people read it, in the words of the language if it has some for it."""
        return self.names.get(name) or name_in_words(name)

    def named(self, names: Iterable[str]) -> str:
        """Return a list of names, of which one is right."""
        return _listed(map(self.name, names), self.between, self.last_or)

    def all_of(self, clauses: Iterable[str]) -> str:
        """Return a list of clauses that all hold."""
        return _listed(clauses, self.between_clauses, self.last_and)

    def one_of(self, clauses: Iterable[str]) -> str:
        """Return a list of clauses of which one holds."""
        return _listed(clauses, self.between_clauses, self.last_or)


def _listed(items: Iterable[str], between: str, last: str) -> str:
    *first, final = items
    return f"{between.join(first)}{last}{final}" if first else final


@dataclass(frozen=True, slots=True)
class PhraseWording:
    """Wordings of a proposition as a clause, which stands within sentences.

    Attributes:
        of: name of the predicate.
        robot: only for propositions about this robot; None: about any, or none.
        speaker: only for this side; None: for both.
        yes: that it holds.
        no: that it does not.
        simply_yes: the same in simpler words, which may leave values out; empty: as the above.
        simply_no: likewise.
    """

    of: str
    robot: AboutRobot | None = None
    speaker: Side | None = None
    yes: tuple[str, ...] = ()
    no: tuple[str, ...] = ()
    simply_yes: tuple[str, ...] = ()
    simply_no: tuple[str, ...] = ()

    def wordings(self, *, holds: bool, simply: bool) -> tuple[str, ...]:
        """Return the wordings for one purpose; possibly none."""
        simple = self.simply_yes if holds else self.simply_no
        return (simply and simple) or (self.yes if holds else self.no)

    @property
    def narrowing(self) -> tuple[object, ...]:
        """Conditions that narrow it down, the most important first; None where there is none."""
        return self.robot, self.speaker


@dataclass(frozen=True, slots=True)
class MoveWording:
    """Wordings of a move.

    Attributes:
        move: name of the locution.
        content: kind of its content.
        speaker: the side that says it.
        condition: only in this condition of a study; None: in each.
        of: only for this predicate; None: for all.
        holds: only for what holds, or for what does not; None: for both.
        robot: only for propositions about this robot; None: about any, or none.
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
        """Conditions that narrow it down, the most important first; None where there is none."""
        return self.condition, self.of, self.holds, self.robot


class _Narrowed(Protocol):
    @property
    def narrowing(self) -> tuple[object, ...]: ...


_Entry = TypeVar("_Entry", bound=_Narrowed)


@dataclass(frozen=True, slots=True)
class Language:
    """Language that robots and people speak.

    Attributes:
        name: of its folder: `en`.
        title: its name in itself: `English`.
        grammar: forms of values.
        phrases: wordings of propositions; of equally specific ones a later one is said.
        moves: wordings of moves; likewise.
        lines: wordings of other lines.
        fallback: the language that speaks where this one has no words; None without one.
    """

    name: str
    title: str
    grammar: Grammar
    phrases: tuple[PhraseWording, ...]
    moves: tuple[MoveWording, ...]
    lines: Mapping[LineKey, tuple[str, ...]]
    fallback: "Language | None" = None

    def phrase(
        self, of: str, speaker: Side, robot: AboutRobot | None, *, holds: bool = True, simply: bool = False
    ) -> tuple[str, ...]:
        """Return the most specific wordings of a proposition; empty when there are none.

        Args:
            of: name of its predicate.
            speaker: who says it.
            robot: that it is about; None where it is about none.
            holds: False for its negation.
            simply: in simpler words, where there are any.
        """
        found = _most_specific(
            (each for each in self.phrases if each.of == of and each.wordings(holds=holds, simply=simply)),
            (robot, speaker),
        )
        if found is not None:
            return found.wordings(holds=holds, simply=simply)
        if self.fallback is not None:
            return self.fallback.phrase(of, speaker, robot, holds=holds, simply=simply)
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
        """Return the most specific wordings of a move; empty when there are none. Arguments as in `MoveWording`."""
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
        """Return the wordings of a line; empty when there are none."""
        if key in self.lines:
            return self.lines[key]
        return () if self.fallback is None else self.fallback.line(key)


def _most_specific(entries: Iterable[_Entry], case: tuple[object, ...]) -> _Entry | None:
    """The entry that fits a case and is narrowed down the most; the first part of a case weighs most."""
    best: _Entry | None = None
    for entry in entries:
        fits = all(wanted is None or wanted == given for wanted, given in zip(entry.narrowing, case, strict=True))
        if fits and (best is None or _specificity(entry) >= _specificity(best)):
            best = entry
    return best


def _specificity(entry: _Narrowed) -> tuple[bool, ...]:
    return tuple(part is not None for part in entry.narrowing)
