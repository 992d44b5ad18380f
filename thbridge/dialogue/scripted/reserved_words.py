"""Reserved words of scripted questions. Each word is replaced by a fact from the topic of a dialogue."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from sim.common.robot_numbers import number_of
from thbridge.dialogue.moves import DialogueTopic, Scenario
from thbridge.dialogue.sentences import WordFault, fill, reserved_in, spelling_fault
from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.properties import TreasureProperty, value_in_words

_BESIDE_TREASURE = (Scenario.TAKE_PICTURE, Scenario.TAKE_TREASURE)


@dataclass(frozen=True, slots=True)
class ReservedWord:
    """A word that sentences may contain between pound signs.

    Attributes:
        name: the word.
        meaning: meaning for people who write sentences.
        value: function of a topic that returns the value for use within a sentence of the language; empty without a
            value.
        scenarios: scenarios with questions in which the word may occur.
    """

    name: str
    meaning: str
    value: Callable[[DialogueTopic, Texts], str]
    scenarios: tuple[Scenario, ...] = tuple(Scenario)


WORDS = (
    ReservedWord("room", "the number of the room", lambda topic, _: str(topic.room.people)),
    ReservedWord(
        "name",
        "the name of the room, or its number if it has no name",
        lambda topic, texts: topic.room_name or texts.room(topic.room),
    ),
    ReservedWord(
        "place",
        "the room with its number, and with its name if it has a name: room 3 (Kitchen)",
        lambda topic, texts: texts.room(topic.room, name=topic.room_name),
    ),
    ReservedWord("cost", "the energy of the proposed action", lambda topic, texts: texts.number(topic.cost)),
    ReservedWord("energy", "the remaining energy of the robot", lambda topic, texts: texts.number(topic.energy)),
    ReservedWord("robot", "the number of the robot", lambda topic, _: str(number_of(topic.robot))),
    ReservedWord(
        "other_robot",
        "the number of the other robot that has the lowest cost to the room",
        lambda topic, _: "" if topic.other_robot is None else str(number_of(topic.other_robot)),
    ),
    ReservedWord(
        "reason", "the reason for a suggested room", lambda topic, _: topic.reason, scenarios=(Scenario.DONT_KNOW,)
    ),
    ReservedWord(
        "confidence",
        "the robot's confidence in its suggestion, in percent, if the study has this setting",
        lambda topic, texts: (
            "" if topic.confidence is None else texts.text("words.percent", number=f"{100.0 * topic.confidence:.0f}")
        ),
        scenarios=(Scenario.DONT_KNOW,),
    ),
)
"""All words except the properties of treasures. Only questions about a treasure may contain a property."""

ENERGY_WORDS = ("cost", "energy")
"""Words that stand for amounts of energy."""


def allowed_words(scenario: Scenario, properties: Sequence[TreasureProperty]) -> dict[str, str]:
    """Return the words that the questions of a scenario may contain, with their meanings.

    Args:
        scenario: scenario of the questions.
        properties: properties of the treasures.
    """
    words = {word.name: word.meaning for word in WORDS if scenario in word.scenarios}
    if scenario in _BESIDE_TREASURE:
        words |= {each.name: f"{each.label} of the treasure" for each in properties}
    return words


def word_fault(wording: str, scenario: Scenario, properties: Sequence[TreasureProperty]) -> WordFault | None:
    """Return the first fault in the reserved words of a wording, or None. A pound sign next to a number is normal text.

    Args:
        wording: a sentence.
        scenario: scenario of the question.
        properties: properties of the treasures.
    """
    beside = [each.name for each in properties]
    allowed = allowed_words(scenario, properties)
    for name in reserved_in(wording):
        if name in allowed:
            continue
        if name in beside:
            return WordFault(
                f"£{name}£ is known only in questions about a treasure",
                "use it only in the sections TakePicture: and TakeTreasure:",
            )
        if any(word.name == name for word in WORDS):
            return WordFault(
                f"£{name}£ is known only if the robot suggests a room",
                "use it only in the first questions, which are for a person who does not know",
            )
    return spelling_fault(wording, allowed)


def fill_known(wording: str, words: Mapping[str, str], texts: Texts) -> str:
    """Return the wording with its reserved words replaced; words without a value are replaced by "unknown"."""
    unknown = dict.fromkeys(reserved_in(wording), texts.text("scripted.unknown"))
    return fill(wording, {**unknown, **words})


def words_of(topic: DialogueTopic, texts: Texts, properties: Sequence[TreasureProperty] = ()) -> dict[str, str]:
    """Return the values of reserved words, for use within a sentence; words without a value are missing.

    Args:
        topic: topic of the dialogue.
        texts: texts of the game's language.
        properties: properties of the treasures, with the words for their values in this language.
    """
    values = {word.name: word.value(topic, texts) for word in WORDS}
    values |= {name: value_in_words(value) for name, value in topic.properties.items()}
    values |= {
        each.name: each.word(topic.properties[each.name]) for each in properties if each.name in topic.properties
    }
    return {name: value for name, value in values.items() if value}
