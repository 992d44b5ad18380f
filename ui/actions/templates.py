"""Parts of the commands about template sets."""

from collections.abc import Iterator
from pathlib import Path

from thbridge.dialogue.moves import DialogueTopic, Scenario
from thbridge.dialogue.words import fill, words_of
from thbridge.files.resources import shipped
from thbridge.files.template_files import TemplateSet, read_template_set
from thbridge.hunt.costs import energy_text
from thbridge.hunt.properties import Teller, TreasureProperty
from thbridge.hunt.rooms import Room
from thbridge.hunt.treasures import name_in_words
from ui.terminal import bad_input

_HEADINGS = {
    Scenario.DONT_KNOW: "Where the robot suggests a room",
    Scenario.SPECIFIC_ROOM: "Where the participant chose the room",
    Scenario.TAKE_PICTURE: "Before a picture",
    Scenario.TAKE_TREASURE: "Before a treasure is named",
}


def folder_of(name: str) -> Path:
    """The folder of the set of a name or path."""
    wanted = f"./{name}" if "/" not in name and Path(name).is_dir() else name
    with bad_input():
        return shipped().find("templates", wanted, Path())


def read_set(name: str) -> TemplateSet:
    """The set of a name or path."""
    folder = folder_of(name)
    with bad_input():
        return read_template_set(folder)


def told(templates: TemplateSet) -> Iterator[str]:
    """Lines that tell people what is in a set: properties, treasures, and each sentence with an example's words."""
    for each in templates.properties:
        values = f": {', '.join(each.values)}" if each.values else ""
        yield f"property {each.name} ({each.label}){values}. {_teller(each)}"
    for kind in templates.kinds:
        yield f"treasure {name_in_words(kind.name)}, {kind.points} points: {', '.join(kind.properties.values())}"
    kind = templates.kinds[0]
    for scenario, heading in _HEADINGS.items():
        topic = DialogueTopic(
            scenario,
            0,
            Room(4),
            13.0,
            87.0,
            room_name="Kitchen",
            other_robot=1,
            properties=kind.properties,
            reason="no other room costs me less",
        )
        questions = templates.dialogue.of(scenario)
        yield f"{heading}: {'nothing is asked' if not questions else ''}".rstrip()
        for number, question in enumerate(questions, start=1):
            for wording in question.wordings:
                yield f"  {number}. {fill(wording, words_of(topic))}"
    yield f"{len(templates.kinds)} treasures, {len(templates.properties)} properties: no faults"


def _teller(told_of: TreasureProperty) -> str:
    if told_of.told_by is Teller.PERSON:
        return "The participant tells it by the picture."
    by = f" by its {told_of.sensor}" if told_of.sensor else ""
    return f"The robot senses it{by}, " + (
        f"for {energy_text(told_of.cost)} energy." if told_of.cost else "for nothing."
    )
