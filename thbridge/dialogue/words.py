"""Reserved words of sentences: between pound signs, each stands for what the topic of a dialogue holds."""

import difflib
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

from sim.common.robot_numbers import number_of
from thbridge.dialogue.moves import DialogueTopic, Scenario
from thbridge.hunt.costs import energy_text
from thbridge.hunt.properties import TreasureProperty, value_in_words
from thbridge.hunt.rooms import RoomNames

UNKNOWN = "unknown"
"""Word for what is not known when a sentence names it all the same."""

_BESIDE_TREASURE = (Scenario.TAKE_PICTURE, Scenario.TAKE_TREASURE)

_RESERVED = re.compile(r"£(\w+)£")
_SENTENCE_START = re.compile(r"(^|[.?!…])\s*$")
_STRAY = re.compile(r"£[^\W\d]|[^\W\d]£")


@dataclass(frozen=True, slots=True)
class ReservedWord:
    """A word that sentences may have between pound signs.

    Attributes:
        name: the word.
        meaning: for people who write sentences.
        value: of a topic, as people read it within a sentence; empty when it has none.
        scenarios: in whose questions it may stand.
    """

    name: str
    meaning: str
    value: Callable[[DialogueTopic], str]
    scenarios: tuple[Scenario, ...] = tuple(Scenario)


WORDS = (
    ReservedWord("room", "the number of the room", lambda topic: str(topic.room.people)),
    ReservedWord("name", "the name of the room; its number where it has none", lambda topic: topic.room_name),
    ReservedWord(
        "place",
        "the room with its number and its name, if it has one: room 3 (Kitchen)",
        lambda topic: RoomNames.of([(topic.room.people, topic.room_name)]).titled(topic.room.people),
    ),
    ReservedWord("cost", "the energy of what is proposed", lambda topic: energy_text(topic.cost)),
    ReservedWord("energy", "the energy that the robot has left", lambda topic: energy_text(topic.energy)),
    ReservedWord("robot", "the number of the robot", lambda topic: str(number_of(topic.robot))),
    ReservedWord(
        "other_robot",
        "the number of the other robot that is nearest to the room by its costs",
        lambda topic: "" if topic.other_robot is None else str(number_of(topic.other_robot)),
    ),
    ReservedWord(
        "reason", "the reason for a suggested room", lambda topic: topic.reason, scenarios=(Scenario.DONT_KNOW,)
    ),
    ReservedWord(
        "confidence",
        "how sure the robot says it is of its suggestion, in percent, where the study has it say so",
        lambda topic: "" if topic.confidence is None else f"{topic.confidence:.0%}",
        scenarios=(Scenario.DONT_KNOW,),
    ),
)
"""All but the properties of treasures, which are words of the questions beside one."""


@dataclass(frozen=True, slots=True)
class WordFault:
    """Fault of a reserved word in a wording, and its remedy."""

    problem: str
    remedy: str


def allowed_words(scenario: Scenario, properties: Sequence[TreasureProperty]) -> dict[str, str]:
    """Return the words that the questions of a scenario may have, with what each stands for.

    Args:
        scenario: of the questions.
        properties: that treasures have.
    """
    words = {word.name: word.meaning for word in WORDS if scenario in word.scenarios}
    if scenario in _BESIDE_TREASURE:
        words |= {each.name: f"{each.label}, of the treasure" for each in properties}
    return words


def word_fault(wording: str, scenario: Scenario, properties: Sequence[TreasureProperty]) -> WordFault | None:
    """Return the first fault in the reserved words of a wording, or None. A pound sign beside a number is only text.

    Args:
        wording: a sentence.
        scenario: of the question.
        properties: that treasures have.
    """
    beside = [each.name for each in properties]
    allowed = allowed_words(scenario, properties)
    for name in reserved_in(wording):
        if name in allowed:
            continue
        if name in beside:
            return WordFault(
                f"£{name}£ is known only beside a treasure",
                "use it in the sections TakePicture: and TakeTreasure: only",
            )
        if any(word.name == name for word in WORDS):
            return WordFault(
                f"£{name}£ is known only where the robot suggests a room",
                "use it in the first questions, those for a person who does not know, only",
            )
    return spelling_fault(wording, allowed)


def spelling_fault(wording: str, allowed: Collection[str]) -> WordFault | None:
    """Return the first word of a wording that is not one of those allowed, or a pound sign that stands alone, or None.

    Args:
        wording: a sentence.
        allowed: reserved words, in the order in which a remedy lists them.
    """
    for name in reserved_in(wording):
        if name not in allowed:
            near = difflib.get_close_matches(name.casefold(), allowed, n=1)
            choices = "use one of " + ", ".join(f"£{word}£" for word in allowed) if allowed else "write it without"
            return WordFault(f"unknown reserved word £{name}£", f"write £{near[0]}£" if near else choices)
    stray = _STRAY.search(_RESERVED.sub("", wording))
    if stray:
        return WordFault(
            "a pound sign without its partner", "write reserved words between two pound signs, as in £room£"
        )
    return None


def words_of(topic: DialogueTopic) -> dict[str, str]:
    """Return the values of the reserved words that have one, as people read them within a sentence."""
    values = {word.name: word.value(topic) for word in WORDS}
    values |= {name: value_in_words(value) for name, value in topic.properties.items()}
    return {name: value for name, value in values.items() if value}


def is_filled(wording: str, words: Mapping[str, str]) -> bool:
    """Return True when each reserved word of a wording has a value."""
    return all(name in words for name in reserved_in(wording))


def reserved_in(wording: str) -> tuple[str, ...]:
    """Return the reserved words of a wording, without their pound signs, in order."""
    return tuple(found.group(1) for found in _RESERVED.finditer(wording))


def fill(wording: str, words: Mapping[str, str], beginning: re.Pattern[str] = _SENTENCE_START) -> str:
    """Return the wording with its reserved words replaced, and a capital where one begins a sentence.

    Args:
        wording: a sentence.
        words: the values of the reserved words.
        beginning: finds, at the end of what stands before a word, that a sentence begins.
    """

    def value(found: re.Match[str]) -> str:
        word = words.get(found.group(1), UNKNOWN)
        return word[:1].upper() + word[1:] if beginning.search(wording[: found.start()]) else word

    return _RESERVED.sub(value, wording)
