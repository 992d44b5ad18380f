"""Contents of a template set in words for people: properties, treasures, and the sentences as robots say them."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from thbridge.dialogue.moves import DialogueTopic, Scenario
from thbridge.dialogue.scripted.reserved_words import fill_known, words_of
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.language_texts import ENGLISH, shipped_texts
from thbridge.files.map_files import Map
from thbridge.files.map_times import read_map_times
from thbridge.files.template_files import TemplateSet, missing_words
from thbridge.files.word_files import SHIPPED_LANGUAGES, languages_in
from thbridge.hunt.costs import energy_text
from thbridge.hunt.properties import Teller, TreasureProperty
from thbridge.hunt.rooms import CORRIDOR, Room
from thbridge.hunt.treasures import TreasureKind, name_in_words
from thbridge.study.study_file import Study

_HEADINGS = {
    Scenario.DONT_KNOW: "The robot suggests a room",
    Scenario.SPECIFIC_ROOM: "The participant has chosen a room",
    Scenario.TAKE_PICTURE: "The participant wants a picture",
    Scenario.TAKE_TREASURE: "The participant wants to name a treasure",
}
_GAME = Study().game
"""Settings of a game with default numbers, for sentences that contain energy and costs."""
_COSTS = {Scenario.TAKE_PICTURE: _GAME.picture_cost, Scenario.TAKE_TREASURE: _GAME.identify_cost}


@dataclass(frozen=True, slots=True)
class PreviewPlace:
    """Room that the sentences of a preview name.

    Attributes:
        room: the room.
        name: name of the room; empty if the room has only a number.
        cost: energy of the move from the corridor to the room.
    """

    room: Room
    name: str
    cost: float


NOWHERE = PreviewPlace(Room(4), "Kitchen", 13.0)
"""Room, name and cost that a preview without a map shows."""


def place_on(arena: Map) -> PreviewPlace:
    """Return the last room of a map, with the cost of a move there according to the map's own times."""
    entry = arena.rooms[-1]
    cost = NOWHERE.cost if arena.costs is None else read_map_times(arena.costs).cost(CORRIDOR, entry.room)
    return PreviewPlace(entry.room, arena.room_names.name(entry.room.people), cost)


def contents(templates: TemplateSet) -> Iterator[str]:
    """Yield a line for each property and each treasure."""
    for each in templates.properties:
        values = f": {', '.join(each.values)}" if each.values else ""
        yield f"property {each.name} ({each.label}){values}. {_teller(each)}"
    for kind in templates.kinds:
        yield f"treasure {name_in_words(kind.name)}, {kind.points} points: {', '.join(kind.properties.values())}"


def sentences(
    templates: TemplateSet, place: PreviewPlace, kind: TreasureKind | None = None, texts: Texts | None = None
) -> Iterator[str]:
    """Yield each wording of each question, and the answers.

    Args:
        templates: the set.
        place: room that the sentences name.
        kind: kind of the treasure in this room. If None, it is the first kind of the set.
        texts: texts of the language. If None, the texts are in the set's language, or in English.
    """
    kind = kind or templates.kinds[0]
    texts = texts or texts_of(templates)
    words = templates.in_language(texts.language)
    for scenario, heading in _HEADINGS.items():
        questions = words.dialogue.of(scenario)
        yield f"{heading}: {'no question' if not questions else ''}".rstrip()
        topic = DialogueTopic(
            scenario,
            0,
            place.room,
            _COSTS.get(scenario, place.cost),
            _GAME.energy,
            room_name=place.name,
            other_robot=1,
            properties=kind.properties,
            reason=texts.text("scripted.reason_nearest"),
        )
        for number, question in enumerate(questions, start=1):
            for wording in question.wordings:
                yield f"  {number}. {fill_known(wording, words_of(topic, texts, words.properties), texts)}"
        if questions:
            yield f"  Answers: {', '.join(words.dialogue.answers_in(scenario, texts))}"


def texts_of(templates: TemplateSet) -> Texts:
    """Return the texts in a set's own language; if the set has no known language, return the English texts."""
    known = languages_in(SHIPPED_LANGUAGES)
    return shipped_texts(templates.language if templates.language in known else ENGLISH)


def translations(
    templates: TemplateSet, folder: Path, place: PreviewPlace, kind: TreasureKind | None = None
) -> Iterator[str]:
    """Yield the sentences of a set in each of its further languages, and the missing words.

    Args:
        templates: the set.
        folder: folder of the set.
        place: room that the sentences name. The name of the room is omitted, because it is in another language.
        kind: kind of the treasure in this room. If None, it is the first kind of the set.
    """
    for language in templates.words:
        yield f"In {language}:"
        if language in languages_in(SHIPPED_LANGUAGES):
            yield from sentences(templates, replace(place, name=""), kind, shipped_texts(language))
        yield from map(str, missing_words(templates, folder, language))


def _teller(told_of: TreasureProperty) -> str:
    if told_of.told_by is Teller.PERSON:
        return "The participant sees this property in the picture and reports it."
    by = f" with its {told_of.sensor}" if told_of.sensor else ""
    price = f"This costs {energy_text(told_of.cost)} energy." if told_of.cost else "This costs no energy."
    return f"The robot senses this property{by}. {price}"
