"""Scripted questions of a DialogueText file, and the sentences made of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from sim.numerics import noise
from thbridge.dialogue.moves import Ask, Continue, DecideAlone, Dialogue, Move, OfferedSentence, Scenario, Speaker, Stop
from thbridge.dialogue.words import fill, is_filled, words_of
from thbridge.hunt.costs import energy_text

ANSWERS_OF_2016 = ("Continue", "Stop")
"""Texts of the buttons by which a person answered any question in 2016."""

_CONFIDENCE = "£confidence£"


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
        answers: of each scenario, the texts of the buttons that agree and refuse; those of 2016 for all others.
    """

    name: str
    questions: Mapping[Scenario, tuple[ScriptedQuestion, ...]]
    answers: Mapping[Scenario, tuple[str, str]] = field(default_factory=dict)

    def of(self, scenario: Scenario) -> tuple[ScriptedQuestion, ...]:
        """Return the questions of a scenario, possibly none."""
        return self.questions.get(scenario, ())

    def answers_in(self, scenario: Scenario) -> tuple[str, str]:
        """Return the texts of the two buttons below a question of a scenario: the one that agrees comes first."""
        return self.answers.get(scenario, ANSWERS_OF_2016)


@dataclass(frozen=True, slots=True)
class TemplatePhrasing:
    """Sentences for moves, from a template.

    The wording of a question depends on the seed, the dialogue's number and the question alone: other dialogues do not
    change it, and a restored dialogue has the same sentences. A wording that names what is not known is left out, as
    long as there is another. A confidence that is to be stated, and that the wording does not name, is said before it.

    Attributes:
        template: the questions.
        seed: of the game.
    """

    template: Template
    seed: int

    def say(self, dialogue: Dialogue, move: Move, speaker: Speaker = Speaker.ROBOT) -> str:
        """Return the sentence for a move in this dialogue; for the person's moves, the text of the button."""
        match move:
            case Ask(question):
                words = words_of(dialogue.topic)
                wordings = self.template.of(dialogue.topic.scenario)[question].wordings
                wordings = tuple(each for each in wordings if is_filled(each, words)) or wordings
                chance = noise.uniform(noise.key(self.seed, "wording"), dialogue.number, question)
                wording = wordings[int(chance * len(wordings))]
                if question == 0 and "confidence" in words and _CONFIDENCE not in wording:
                    wording = f"I am {_CONFIDENCE} sure of my suggestion. {wording}"
                return fill(wording, words)
            case Continue():
                return self.template.answers_in(dialogue.topic.scenario)[0]
            case Stop():
                return self.template.answers_in(dialogue.topic.scenario)[1]
            case DecideAlone(waited):
                room = dialogue.topic.room_name
                return f"Nobody has told me what to do for {energy_text(waited)} s: I go to {room}."
            case _:
                raise ValueError(f"there is no scripted sentence for {move}")

    def authored(self, dialogue: Dialogue, move: Move) -> OfferedSentence | None:
        """Return None: scripts have no other authors."""
        return None
