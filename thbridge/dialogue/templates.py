"""Scripted questions of a DialogueText file, and the sentences made of them."""

import difflib
import re
from collections.abc import Mapping
from dataclasses import dataclass

from sim.common import noise
from sim.common.robot_numbers import number_of
from thbridge.dialogue.moves import Ask, Continue, Dialogue, DialogueTopic, Move, Scenario, Stop
from thbridge.hunt.costs import energy_text

EVERYWHERE = ("room", "cost", "energy", "robot")
"""Reserved words that any question may use."""
BESIDE_TREASURE = ("colour", "footprint")
"""Reserved words for questions about a treasure beside the robot."""
OF_A_SUGGESTION = ("reason",)
"""Reserved words for questions about a room that the robot suggests."""

_RESERVED = re.compile(r"£(\w+)£")
_SENTENCE_START = re.compile(r"(^|[.?!…])\s*$")
_STRAY = re.compile(r"£[^\W\d]|[^\W\d]£")


@dataclass(frozen=True, slots=True)
class ScriptedQuestion:
    """One scripted question in one or more wordings, with reserved words such as `£room£` still in place."""

    wordings: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Template:
    """All scripted questions of a study.

    Attributes:
        name: first line of the file, a description.
        questions: of each scenario, in order; a scenario without questions is agreed at once.
    """

    name: str
    questions: Mapping[Scenario, tuple[ScriptedQuestion, ...]]

    def of(self, scenario: Scenario) -> tuple[ScriptedQuestion, ...]:
        """Return the questions of a scenario, possibly none."""
        return self.questions.get(scenario, ())


@dataclass(frozen=True, slots=True)
class WordFault:
    """Fault of a reserved word in a wording, and its remedy."""

    problem: str
    remedy: str


def reserved_words(scenario: Scenario) -> tuple[str, ...]:
    """Return the reserved words that questions of this scenario may have between pound signs."""
    match scenario:
        case Scenario.TAKE_PICTURE | Scenario.TAKE_TREASURE:
            return EVERYWHERE + BESIDE_TREASURE
        case Scenario.DONT_KNOW:
            return EVERYWHERE + OF_A_SUGGESTION
        case Scenario.SPECIFIC_ROOM:
            return EVERYWHERE


def word_fault(wording: str, scenario: Scenario) -> WordFault | None:
    """Return the first fault in the reserved words of a wording, or None. A pound sign beside a number is only text."""
    allowed = reserved_words(scenario)
    for found in _RESERVED.finditer(wording):
        word = found.group(1)
        if word in allowed:
            continue
        if word in BESIDE_TREASURE:
            return WordFault(
                f"£{word}£ is known only beside a treasure",
                "use it in the sections TakePicture: and TakeTreasure: only",
            )
        if word in OF_A_SUGGESTION:
            return WordFault(
                f"£{word}£ is known only where the robot suggests a room",
                "use it in the first questions, those for a person who does not know, only",
            )
        near = difflib.get_close_matches(word.casefold(), allowed, n=1)
        choice = f"write £{near[0]}£" if near else "use one of " + ", ".join(f"£{name}£" for name in allowed)
        return WordFault(f"unknown reserved word £{word}£", choice)
    stray = _STRAY.search(_RESERVED.sub("", wording))
    if stray:
        return WordFault(
            "a pound sign without its partner", "write reserved words between two pound signs, as in £room£"
        )
    return None


def fill(wording: str, words: Mapping[str, str]) -> str:
    """Return the wording with its reserved words replaced, and a capital where one begins a sentence.

    Raises:
        KeyError: a word has no value.
    """

    def value(found: re.Match[str]) -> str:
        word = words[found.group(1)]
        return word[:1].upper() + word[1:] if _SENTENCE_START.search(wording[: found.start()]) else word

    return _RESERVED.sub(value, wording)


def words_of(topic: DialogueTopic) -> dict[str, str]:
    """Return the values of the reserved words, as people read them within a sentence."""
    return {
        "room": str(topic.room.people),
        "cost": energy_text(topic.cost),
        "energy": energy_text(topic.energy),
        "robot": str(number_of(topic.robot)),
        "colour": topic.colour.lower(),
        "footprint": topic.footprint.lower(),
        "reason": topic.reason,
    }


@dataclass(frozen=True, slots=True)
class TemplatePhrasing:
    """Sentences for moves, from a template.

    The wording of a question depends on the seed, the dialogue's number and the question alone: other dialogues do not
    change it, and a restored dialogue has the same sentences.

    Attributes:
        template: the questions.
        seed: of the game.
    """

    template: Template
    seed: int

    def say(self, dialogue: Dialogue, move: Move) -> str:
        """Return the sentence for a move in this dialogue; for the person's moves, the text of the button."""
        match move:
            case Ask(question):
                wordings = self.template.of(dialogue.topic.scenario)[question].wordings
                chance = noise.uniform(noise.key(self.seed, "wording"), dialogue.number, question)
                return fill(wordings[int(chance * len(wordings))], words_of(dialogue.topic))
            case Continue():
                return "Continue"
            case Stop():
                return "Stop"
