"""Contents of a template set for people: its properties, treasures, and each sentence as a robot would say it."""

from collections.abc import Iterator
from dataclasses import dataclass

from thbridge.dialogue.moves import DialogueTopic, Scenario
from thbridge.dialogue.words import fill, words_of
from thbridge.files.map_files import Map
from thbridge.files.map_times import read_map_times
from thbridge.files.template_files import TemplateSet
from thbridge.hunt.costs import energy_text
from thbridge.hunt.properties import Teller, TreasureProperty
from thbridge.hunt.rooms import CORRIDOR, Room
from thbridge.hunt.treasures import TreasureKind, name_in_words
from thbridge.study.study_file import Study

_HEADINGS = {
    Scenario.DONT_KNOW: "Where the robot suggests a room",
    Scenario.SPECIFIC_ROOM: "Where the participant chose the room",
    Scenario.TAKE_PICTURE: "Before a picture",
    Scenario.TAKE_TREASURE: "Before a treasure is named",
}
_GAME = Study().game
"""Usual numbers of a game, for sentences that name energy and costs."""
_COSTS = {Scenario.TAKE_PICTURE: _GAME.picture_cost, Scenario.TAKE_TREASURE: _GAME.identify_cost}


@dataclass(frozen=True, slots=True)
class PreviewPlace:
    """The room that sentences speak of in a preview.

    Attributes:
        room: the room.
        name: its name within a sentence.
        cost: energy of going there from the corridor.
    """

    room: Room
    name: str
    cost: float


NOWHERE = PreviewPlace(Room(4), "Kitchen", 13.0)
"""Place of a preview without a map."""


def place_on(arena: Map) -> PreviewPlace:
    """Return the last room of a map, with its name and what going there costs by the map's own times."""
    entry = arena.rooms[-1]
    cost = NOWHERE.cost if arena.costs is None else read_map_times(arena.costs).cost(CORRIDOR, entry.room)
    return PreviewPlace(entry.room, arena.room_names.name(entry.room.people) or str(entry.room), cost)


def contents(templates: TemplateSet) -> Iterator[str]:
    """Yield the lines on properties and treasures."""
    for each in templates.properties:
        values = f": {', '.join(each.values)}" if each.values else ""
        yield f"property {each.name} ({each.label}){values}. {_teller(each)}"
    for kind in templates.kinds:
        yield f"treasure {name_in_words(kind.name)}, {kind.points} points: {', '.join(kind.properties.values())}"


def sentences(templates: TemplateSet, place: PreviewPlace, kind: TreasureKind | None = None) -> Iterator[str]:
    """Yield each wording of each question, and the answers, beside this kind of treasure; by default the first."""
    kind = kind or templates.kinds[0]
    for scenario, heading in _HEADINGS.items():
        questions = templates.dialogue.of(scenario)
        yield f"{heading}: {'nothing is asked' if not questions else ''}".rstrip()
        topic = DialogueTopic(
            scenario,
            0,
            place.room,
            _COSTS.get(scenario, place.cost),
            _GAME.energy,
            room_name=place.name,
            other_robot=1,
            properties=kind.properties,
            reason="no other room costs me less",
        )
        for number, question in enumerate(questions, start=1):
            for wording in question.wordings:
                yield f"  {number}. {fill(wording, words_of(topic))}"
        if questions:
            yield f"  Answers: {', '.join(templates.dialogue.answers_in(scenario))}"


def _teller(told_of: TreasureProperty) -> str:
    if told_of.told_by is Teller.PERSON:
        return "The participant tells it by the picture."
    by = f" by its {told_of.sensor}" if told_of.sensor else ""
    price = f"{energy_text(told_of.cost)} energy" if told_of.cost else "nothing"
    return f"The robot senses it{by}, for {price}."
