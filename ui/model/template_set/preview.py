"""Contents of a template set for people: properties, treasures, and each sentence as a robot would say it."""

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
    Scenario.DONT_KNOW: "When the robot suggests a room",
    Scenario.SPECIFIC_ROOM: "When the participant has chosen the room",
    Scenario.TAKE_PICTURE: "Before a picture",
    Scenario.TAKE_TREASURE: "Before a treasure is named",
}
_GAME = Study().game
"""Game with the default numbers, for sentences that name energy and costs."""
_COSTS = {Scenario.TAKE_PICTURE: _GAME.picture_cost, Scenario.TAKE_TREASURE: _GAME.identify_cost}


@dataclass(frozen=True, slots=True)
class PreviewPlace:
    """Room that the sentences of a preview name.

    Attributes:
        room: the room.
        name: its own name; empty if it has none.
        cost: energy of the move from the corridor.
    """

    room: Room
    name: str
    cost: float


NOWHERE = PreviewPlace(Room(4), "Kitchen", 13.0)
"""Place of a preview without a map."""


def place_on(arena: Map) -> PreviewPlace:
    """Return the last room of a map, with its name and the cost of a move there by the map's own times."""
    entry = arena.rooms[-1]
    cost = NOWHERE.cost if arena.costs is None else read_map_times(arena.costs).cost(CORRIDOR, entry.room)
    return PreviewPlace(entry.room, arena.room_names.name(entry.room.people), cost)


def contents(templates: TemplateSet) -> Iterator[str]:
    """Yield the lines on properties and treasures."""
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
        place: room of the sentences.
        kind: kind of the treasure there. If None, it is the first kind of the set.
        texts: texts of the language. If None, they are those of the set's language, or English.
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
    """Return the texts of a set's own language, or the English ones if the set names no language or an unknown one."""
    known = languages_in(SHIPPED_LANGUAGES)
    return shipped_texts(templates.language if templates.language in known else ENGLISH)


def translations(
    templates: TemplateSet, folder: Path, place: PreviewPlace, kind: TreasureKind | None = None
) -> Iterator[str]:
    """Yield the sentences of a set in its further languages that are known, and the missing words.

    Args:
        templates: the set.
        folder: folder of the set.
        place: room of the sentences, without its name, which is in another language.
        kind: kind of the treasure there. If None, it is the first kind of the set.
    """
    for language in templates.words:
        yield f"In {language}:"
        if language in languages_in(SHIPPED_LANGUAGES):
            yield from sentences(templates, replace(place, name=""), kind, shipped_texts(language))
        yield from map(str, missing_words(templates, folder, language))


def _teller(told_of: TreasureProperty) -> str:
    if told_of.told_by is Teller.PERSON:
        return "The participant reports it from the picture."
    by = f" by its {told_of.sensor}" if told_of.sensor else ""
    price = f"{energy_text(told_of.cost)} energy" if told_of.cost else "nothing"
    return f"The robot senses it{by}, for {price}."
