"""Sentences of one robot and one person: for moves of dialogue games, for beliefs, and for other lines."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from sim.common.robot_numbers import number_of
from thbridge.dialogue.argumentation.arguments import Argument, Belief
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal, Proposition, Rule
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.contents import Content, DialogueMove, Unknown, kind_of_content
from thbridge.dialogue.sentences import UNNAMED, fill
from thbridge.dialogue.wording.language import AboutRobot, Language
from thbridge.dialogue.wording.lines import LINES, LineKey
from thbridge.dialogue.wording.predicates import PREDICATES, PREPOSITIONS, Predicate, ValueKind, predicate_of
from thbridge.hunt.costs import energy_text
from thbridge.hunt.rooms import Room, RoomNames

Value = Room | float | str | Literal | tuple[float, ...] | tuple[str, ...] | tuple[Literal, ...] | tuple[Room, ...]
"""Value of a reserved word; its kind determines its form."""

_PICTURE = re.compile(r"image(\d+)")


@dataclass(frozen=True, slots=True)
class Wording:
    """Words of a robot and a person in their dialogue.

    There is a sentence for every move about propositions of the hunt, and for every line in `LINES`. If there are
    several wordings, `chance`, a random number in [0, 1), chooses one.

    Attributes:
        language: the language.
        robot: robot of the dialogue, as index in the team.
        names: names of the rooms.
        names_energy: False if no sentence may contain an amount of energy.
    """

    language: Language
    robot: int
    names: RoomNames = field(default_factory=RoomNames)
    names_energy: bool = True

    def sentence(
        self,
        move: DialogueMove,
        speaker: Side = Side.ROBOT,
        *,
        condition: DialogueCondition | None = None,
        chance: float = 0.0,
        simply: bool = False,
    ) -> str:
        """Return the sentence for a move; for the person's moves, the text of the button.

        Args:
            move: the move.
            speaker: the side that speaks.
            condition: condition of the study; None if the condition does not matter.
            `chance`: random number that chooses one of several wordings.
            simply: True for simpler words, which may leave values out.

        Raises:
            ValueError: the language has no words for this move; a checked language has words for each shipped move.
        """
        content = move.content
        say = _Clauses(self, speaker, chance, simply)
        words = say.words_of(content)
        subject = _subject(content)
        predicate = None if subject is None else predicate_of(subject.proposition)
        if subject is not None and predicate is not None:
            words |= say.values(subject.proposition, predicate)
        wordings = self.language.move(
            move.locution,
            kind_of_content(content),
            speaker,
            condition=condition,
            of=None if predicate is None else predicate.name,
            holds=subject is None or subject.holds,
            robot=None if subject is None else self.about(subject.proposition),
        )
        if not wordings:
            raise ValueError(f"{self.language.title} has no words for {move}")
        return say.filled(_drawn(wordings, chance), words)

    def phrase(self, literal: Literal, speaker: Side = Side.ROBOT, *, chance: float = 0.0, simply: bool = False) -> str:
        """Return a clause for a literal, without capital letter and full stop. Arguments as in `sentence`."""
        return _Clauses(self, speaker, chance, simply).of(literal)

    def line(self, key: LineKey, *, chance: float = 0.0, simply: bool = False, **values: Value) -> str:
        """Return a line with its values; `LINES` gives their kinds.

        Raises:
            KeyError: a wording contains a value that is not given.
        """
        say = _Clauses(self, LINES[key].speaker, chance, simply)
        words: dict[str, str] = {}
        for name, value in values.items():
            words |= say.value(name, LINES[key].values[name], value)
        return say.filled(_drawn(self.language.line(key), chance), words)

    def values(self, proposition: Proposition, speaker: Side = Side.ROBOT) -> dict[str, str]:
        """Return the values of a proposition in words, by name; a conjunction has none."""
        predicate = predicate_of(proposition)
        if predicate is None:
            return {}
        said = _Clauses(self, speaker, 0.0, simply=False).values(proposition, predicate)
        return {name: said[name] for name in predicate.values}

    def about(self, proposition: Proposition) -> AboutRobot | None:
        """Return the robot that a proposition is about: the robot of the dialogue, or another robot.

        If None, the proposition is about no robot.
        """
        predicate = predicate_of(proposition)
        if predicate is None or predicate.robot is None:
            return None
        return AboutRobot.SELF if getattr(proposition, predicate.robot) == self.robot else AboutRobot.OTHER


@dataclass(frozen=True, slots=True)
class _Clauses:
    """Clauses of one sentence."""

    wording: Wording
    speaker: Side
    chance: float
    simply: bool

    def of(self, literal: Literal) -> str:
        """Return the clause for a literal.

        For a literal that has several parts and no words of its own, return the clauses of all parts.
        """
        predicate = predicate_of(literal.proposition)
        if predicate is None:
            parts = literal.parts
            if len(parts) > 1:
                return self.all_of(parts)
            raise ValueError(f"there are no words for {literal}")
        wording, language = self.wording, self.wording.language
        robot = wording.about(literal.proposition)
        wordings = language.phrase(
            predicate.name,
            self.speaker,
            robot,
            holds=literal.holds,
            simply=self.simply,
            names_energy=wording.names_energy,
        )
        if not wordings:
            raise ValueError(f"{language.title} has no words for {literal}")
        return self.filled(
            _drawn(wordings, self.chance), self.values(literal.proposition, predicate), begins_sentence=False
        )

    def all_of(self, literals: Iterable[Literal]) -> str:
        """Return the clauses for literals that all hold."""
        return self.wording.language.grammar.all_of(map(self.of, literals))

    def words_of(self, content: Content) -> dict[str, str]:
        """Return the words for a content as a whole, and for its parts."""
        match content:
            case Literal() | Rule():
                return {"content": self.belief(content)}
            case Unknown(proposition):
                return {"content": self.of(Literal(proposition))}
            case Argument(support, conclusion):
                said = map(self.belief, reasons(support, conclusion))
                return {"support": self.wording.language.grammar.all_of(said), "conclusion": self.belief(conclusion)}

    def belief(self, belief: Belief) -> str:
        """Return the clause for a literal or a rule."""
        return self.rule(belief) if isinstance(belief, Rule) else self.of(belief)

    def rule(self, rule: Rule) -> str:
        """Return the clause for a rule."""
        words = {"premises": self.all_of(rule.premises), "conclusion": self.of(rule.conclusion)}
        return self.filled(self.wording.language.grammar.rule, words, begins_sentence=False)

    def values(self, proposition: Proposition, predicate: Predicate) -> dict[str, str]:
        """Return the words for the values of a proposition."""
        words: dict[str, str] = {}
        for name, kind in predicate.values.items():
            words |= self.value(name, kind, getattr(proposition, name))
        return words

    def value(self, name: str, kind: ValueKind, value: Value) -> dict[str, str]:
        """Return the words for a value."""
        grammar = self.wording.language.grammar
        match kind, value:
            case ((ValueKind.ENERGY | ValueKind.SUM), _) if not self.wording.names_energy:
                return {name: UNNAMED}
            case ValueKind.ROOM, Room():
                return self.room_words(name, value)
            case ValueKind.STOPS, tuple():
                stops = [stop for stop in value if isinstance(stop, Room)]
                forms = [grammar.first_stop] + [grammar.next_stop] * (len(stops) - 1)
                said = [
                    self.filled(form, self.room_words("room", stop), begins_sentence=False)
                    for form, stop in zip(forms, stops, strict=True)
                ]
                return {name: grammar.between.join(said)}
            case ValueKind.ROBOT, int():
                return {name: fill(grammar.robot, {"number": str(number_of(value))})}
            case ValueKind.ROOMS, int():
                form = grammar.one_room if value == 1 else grammar.many_rooms
                return {name: fill(form, {"number": str(value)})}
            case ((ValueKind.ENERGY | ValueKind.NUMBER), (int() | float())):
                return {name: self.number(value)}
            case ValueKind.SUM, tuple():
                return {name: " + ".join(self.number(term) for term in value if isinstance(term, int | float))}
            case ValueKind.PICTURE, str():
                found = _PICTURE.fullmatch(value)
                return {name: fill(grammar.picture, {"number": found.group(1)}) if found else grammar.name(value)}
            case ValueKind.NAME, str():
                return {name: grammar.name(value)}
            case ValueKind.NAMES, tuple():
                return {name: grammar.named(map(str, value))}
            case ValueKind.CLAUSE, Literal():
                return {name: self.of(value)}
            case ValueKind.CLAUSES, tuple():
                return {name: self.all_of(part for part in value if isinstance(part, Literal))}
            case ValueKind.ALTERNATIVES, tuple():
                return {name: grammar.one_of(self.of(part) for part in value if isinstance(part, Literal))}
            case _:
                raise TypeError(f"{name}: {value!r} is no {kind}")

    def room_words(self, name: str, room: Room) -> dict[str, str]:
        """Return the words for a room, without a preposition and after each preposition."""
        return {name: self.room("", room)} | {f"{each}_{name}": self.room(each, room) for each in PREPOSITIONS}

    def room(self, preposition: str, room: Room) -> str:
        """Return a room after a preposition, with the room's name if there is one."""
        grammar = self.wording.language.grammar
        if room.is_corridor:
            return grammar.corridor[preposition]
        return fill(grammar.rooms[preposition], {"number": self.wording.names.numbered(room.people)})

    def number(self, number: float) -> str:
        """Return a number, with the decimal sign of the language."""
        return energy_text(number).replace(".", self.wording.language.grammar.decimal)

    def filled(self, wording: str, words: Mapping[str, str], *, begins_sentence: bool = True) -> str:
        """Return a wording with its words, and capital letters where sentences begin."""
        after_colon = self.wording.language.grammar.capital_after_colon
        return fill(wording, words, _BEGINNINGS[begins_sentence, after_colon])


_BEGINNINGS = {
    (True, False): re.compile(r"(^|[.?!…])\s*$"),
    (True, True): re.compile(r"(^|[.?!…:])\s*$"),
    (False, False): re.compile(r"[.?!…]\s*$"),
    (False, True): re.compile(r"[.?!…:]\s*$"),
}
"""Patterns for text before a capital letter.

A key has two flags: True if the wording begins a sentence, and True if a capital letter follows a colon.
"""


def reasons(support: Iterable[Belief], conclusion: Belief) -> list[Belief]:
    """Return the beliefs on which an argument rests, in the order of the sentence.

    Predicates have the order of the list of predicates, and rules come last. Among beliefs of one predicate, beliefs
    about the conclusion's room come first.
    """
    follows = conclusion.conclusion if isinstance(conclusion, Rule) else conclusion
    room: Room | None = getattr(follows.parts[0].proposition, "room", None)

    def order(reason: Belief) -> tuple[int, bool, str]:
        proposition = reason.proposition if isinstance(reason, Literal) else None
        predicate = None if proposition is None else predicate_of(proposition)
        place = len(_ORDER) if predicate is None else _ORDER[predicate.name]
        return place, getattr(proposition, "room", None) != room, str(reason)

    return sorted(support, key=order)


_ORDER = {name: place for place, name in enumerate(PREDICATES)}


def _subject(content: Content) -> Literal | None:
    """Return the literal that a content is about (for an argument, its conclusion), or None for a rule."""
    match content:
        case Literal():
            return content
        case Unknown(proposition):
            return Literal(proposition)
        case Argument(_, Literal() as conclusion):
            return conclusion
        case _:
            return None


def _drawn(wordings: tuple[str, ...], chance: float) -> str:
    return wordings[int(chance * len(wordings))]
