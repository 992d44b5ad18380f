"""Scripted questions of a DialogueText file, and their sentences."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from sim.numerics import noise
from thbridge.dialogue.moves import (
    Ask,
    Continue,
    DecideAlone,
    Dialogue,
    DialogueTopic,
    Move,
    OfferedSentence,
    Scenario,
    Speaker,
    Stop,
)
from thbridge.dialogue.scripted.reserved_words import ENERGY_WORDS, fill_known, words_of
from thbridge.dialogue.sentences import is_filled, numbers_in, without_sentences_about
from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.properties import TreasureProperty

_CONFIDENCE = "£confidence£"


@dataclass(frozen=True, slots=True)
class ScriptedQuestion:
    """One scripted question in one or more wordings, which still contain reserved words such as `£room£`."""

    wordings: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Template:
    """All scripted questions of a study.

    Attributes:
        name: first line of the file, a description.
        questions: questions of each scenario, in order; without questions, a scenario is agreed at once.
        answers: by scenario, texts of the buttons that agree and refuse; other scenarios have the language's texts, as
            in 2016.
    """

    name: str
    questions: Mapping[Scenario, tuple[ScriptedQuestion, ...]]
    answers: Mapping[Scenario, tuple[str, str]] = field(default_factory=dict)

    def of(self, scenario: Scenario) -> tuple[ScriptedQuestion, ...]:
        """Return the questions of a scenario, possibly none."""
        return self.questions.get(scenario, ())

    def answers_in(self, scenario: Scenario, texts: Texts) -> tuple[str, str]:
        """Return the texts of the two buttons for a question of a scenario: first the text that agrees."""
        return self.answers.get(scenario) or (texts.text("scripted.continue"), texts.text("scripted.stop"))


@dataclass(frozen=True, slots=True)
class TemplatePhrasing:
    """Sentences for moves, from a template.

    The wording of a question depends only on the seed, the dialogue's number and the question. So other dialogues do
    not change the wording, and a restored dialogue has the same sentences. A wording that contains an unknown value is
    left out if there is another wording. If a confidence must be stated and the wording does not contain it, an extra
    sentence before the wording states the confidence.

    Attributes:
        template: the questions.
        seed: random seed of the game.
        texts: texts of the game's language.
        properties: properties of the treasures, with the words for their values in this language.
        names_energy: False to leave out each sentence with the cost of an action or the energy of the robot.
    """

    template: Template
    seed: int
    texts: Texts
    properties: Sequence[TreasureProperty] = ()
    names_energy: bool = True

    def without_energy(self) -> "TemplatePhrasing":
        """Return this phrasing without amounts of energy; see `Phrasing`."""
        return replace(self, names_energy=False)

    def say(self, dialogue: Dialogue, move: Move, speaker: Speaker = Speaker.ROBOT) -> str:
        """Return the sentence for a move in this dialogue; for the person's moves, the text of the button."""
        match move:
            case Ask(question):
                words = words_of(dialogue.topic, self.texts, self.properties)
                wordings = self.template.of(dialogue.topic.scenario)[question].wordings
                wordings = tuple(each for each in wordings if is_filled(each, words)) or wordings
                chance = noise.uniform(noise.key(self.seed, "wording"), dialogue.number, question)
                wording = wordings[int(chance * len(wordings))]
                if not self.names_energy:
                    wording = without_sentences_about(wording, ENERGY_WORDS)
                    words |= self._reason_without_energy(dialogue.topic)
                said = fill_known(wording, words, self.texts)
                if question == 0 and "confidence" in words and _CONFIDENCE not in wording:
                    return f"{self.texts.text('scripted.sure', confidence=words['confidence'])} {said}"
                return said
            case Continue():
                return self.template.answers_in(dialogue.topic.scenario, self.texts)[0]
            case Stop():
                return self.template.answers_in(dialogue.topic.scenario, self.texts)[1]
            case DecideAlone(waited):
                name = dialogue.topic.room_name or self.texts.room(dialogue.topic.room)
                return self.texts.text("scripted.neglected", seconds=waited, name=name)
            case _:
                raise ValueError(f"there is no scripted sentence for {move}")

    def _reason_without_energy(self, topic: DialogueTopic) -> dict[str, str]:
        """Return the reserved word for a reason that names the cost of the way: another true reason."""
        if self.texts.number(topic.cost) not in numbers_in(topic.reason):
            return {}
        return {"reason": self.texts.text("scripted.reason_reachable")}

    def authored(self, dialogue: Dialogue, move: Move) -> OfferedSentence | None:
        """Return None, because scripts have no other authors."""
        return None
