"""Propositions, moves and their values, randomly chosen for tests of wordings."""

from collections.abc import Iterator

from hypothesis import strategies as st

from thbridge.dialogue.argumentation.arguments import Argument
from thbridge.dialogue.argumentation.propositions import Conjunction, Literal, Proposition, Rule
from thbridge.dialogue.games.contents import Content, ContentKind, DialogueMove, Unknown
from thbridge.dialogue.propositions import RoomSequence
from thbridge.dialogue.wording.predicates import PREDICATES, Predicate, ValueKind, predicate_of
from thbridge.dialogue.wording.wording import Wording
from thbridge.files.game_files import read_rulebook
from thbridge.files.word_files import SHIPPED_LANGUAGES, languages_in, read_language
from thbridge.hunt.costs import energy_text
from thbridge.hunt.rooms import Room, RoomNames

NAMES = RoomNames({2: "Kitchen", 5: "Lab 7"})
WORDINGS = {name: Wording(read_language(name=name), 0, NAMES) for name in languages_in(SHIPPED_LANGUAGES)}
FORMS = [(each.name, each.content) for each in read_rulebook().locutions]
ROOMS = st.integers(1, 12).map(Room)
ROBOTS = st.integers(0, 3)
ENERGIES = st.integers(0, 200_000).map(lambda hundredths: hundredths / 100)
TREASURES = st.sampled_from(["teddy", "toy block", "blue bottle", "Vase", "cup"])
VALUES: dict[ValueKind, st.SearchStrategy[object]] = {
    ValueKind.ROOM: ROOMS,
    ValueKind.ROBOT: ROBOTS,
    ValueKind.ENERGY: ENERGIES,
    ValueKind.SUM: st.lists(ENERGIES, min_size=1, max_size=3).map(tuple),
    ValueKind.ROOMS: st.integers(0, 12),
    ValueKind.STOPS: st.lists(ROOMS, min_size=2, max_size=4, unique=True).map(tuple),
    ValueKind.NUMBER: st.integers(1, 12),
    ValueKind.PICTURE: st.integers(1, 5).map("image{}".format),
    ValueKind.NAME: TREASURES,
    ValueKind.NAMES: st.lists(TREASURES, min_size=2, max_size=4, unique=True).map(tuple),
}


def propositions_of(predicate: Predicate) -> st.SearchStrategy[Proposition]:
    """Return propositions with a predicate."""
    values = {
        name: literals(PLAIN) if kind is ValueKind.CLAUSE else VALUES[kind] for name, kind in predicate.values.items()
    }
    return st.builds(predicate.proposition, **values)


def literals(of: st.SearchStrategy[Proposition]) -> st.SearchStrategy[Literal]:
    """Return literals of propositions."""
    return st.builds(Literal, of, st.booleans())


PLAIN = st.one_of(
    *(propositions_of(each) for each in PREDICATES.values() if ValueKind.CLAUSE not in each.values.values())
)
SINGLE = st.sampled_from(list(PREDICATES.values())).flatmap(propositions_of)
CONJUNCTIONS = st.lists(literals(PLAIN), min_size=2, max_size=3, unique=True).map(
    lambda parts: Conjunction(tuple(parts))
)
PROPOSITIONS = SINGLE | CONJUNCTIONS
RULES = st.builds(Rule, st.lists(literals(PLAIN), min_size=1, max_size=3).map(tuple), literals(PLAIN))
CONTENTS: dict[ContentKind, st.SearchStrategy[Content]] = {
    ContentKind.LITERAL: literals(PROPOSITIONS),
    ContentKind.RULE: RULES,
    ContentKind.UNKNOWN: PROPOSITIONS.map(Unknown),
    ContentKind.ARGUMENT: st.builds(
        Argument, st.frozensets(literals(PLAIN) | RULES, min_size=1, max_size=4), literals(PROPOSITIONS) | RULES
    ),
}
MOVES = st.sampled_from(FORMS).flatmap(lambda form: st.builds(DialogueMove, st.just(form[0]), CONTENTS[form[1]]))


def literals_in(content: Content) -> Iterator[Literal]:
    """Yield the literals in a content, with conjunctions split into their parts."""
    match content:
        case Unknown(proposition):
            yield from literals_in(Literal(proposition))
        case Literal(RoomSequence()):
            yield content
        case Literal():
            yield from content.parts
        case Rule(premises, conclusion):
            yield from premises
            yield conclusion
        case Argument(support, conclusion):
            yield from literals_in(conclusion)
            for part in support:
                yield from literals_in(part)


def values_in(content: Content, robot: int, decimal: str) -> set[str]:
    """Return the values that a sentence must contain, as people read them.

    The number of the robot that speaks need not be in it.
    """
    found: set[str] = set()
    for literal in literals_in(content):
        predicate = predicate_of(literal.proposition)
        assert predicate is not None
        for name, kind in predicate.values.items():
            value = getattr(literal.proposition, name)
            match kind:
                case ValueKind.ROOM:
                    found.add(NAMES.numbered(value.people))
                case ValueKind.STOPS:
                    found |= {NAMES.numbered(stop.people) for stop in value}
                case ValueKind.ROBOT:
                    found |= set() if value == robot else {str(value + 1)}
                case ValueKind.ENERGY:
                    found.add(energy_text(value).replace(".", decimal))
                case ValueKind.SUM:
                    found |= {energy_text(term).replace(".", decimal) for term in value}
                case ValueKind.ROOMS | ValueKind.NUMBER:
                    found.add(str(value))
                case ValueKind.PICTURE:
                    found.add(value.removeprefix("image"))
                case ValueKind.NAME:
                    found.add(value)
                case ValueKind.NAMES:
                    found |= set(value)
                case _:
                    found |= values_in(value, robot, decimal)
    return found
