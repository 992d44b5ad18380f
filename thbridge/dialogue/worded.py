"""Sentences of dialogues in which robots argue, in a language."""

from dataclasses import dataclass, field, replace

from sim.numerics import noise
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.moves import (
    CloseQuestions,
    Conclude,
    DecideAlone,
    Dialogue,
    Echo,
    Enquire,
    Explain,
    Leave,
    Move,
    OfferedSentence,
    OpenQuestions,
    Override,
    Question,
    Scenario,
    Speaker,
    Upshot,
)
from thbridge.dialogue.propositions import NextRoom, VisitOrder
from thbridge.dialogue.wording.authors import WordingAuthor, ask_author, request_of
from thbridge.dialogue.wording.language import Language
from thbridge.dialogue.wording.lines import LineKey
from thbridge.dialogue.wording.wording import Wording
from thbridge.hunt.rooms import RoomNames

_ASKED = {
    Question.WHY_ROBOT: LineKey.WHY_ROBOT,
    Question.WHY_NOW: LineKey.WHY_NOW,
    Question.KNOWN: LineKey.KNOWN,
    Question.CHANGE: LineKey.CHANGE,
    Question.SIMPLER: LineKey.SIMPLER,
}
_UPSHOTS = {
    Upshot.AGREED: LineKey.AGREED,
    Upshot.OVERRIDDEN: LineKey.OVERRIDDEN,
    Upshot.DECIDED: LineKey.DECIDED,
    Upshot.STAYS: LineKey.STAYS,
    Upshot.UNDONE: LineKey.UNDONE,
}


@dataclass(frozen=True, slots=True)
class WordedPhrasing:
    """Sentences for moves, from a language; see `Phrasing`.

    The wording depends only on the seed, the dialogue, and the position of the move in the dialogue.

    Attributes:
        language: the language.
        condition: condition of the study.
        seed: random seed of the game.
        names: names of the rooms.
        author: other author of sentences. If None, all sentences come from the language's files.
        known: names of treasures. An author may use a name only if the sentence from the files contains it.
        names_energy: False if no sentence may contain an amount of energy.
    """

    language: Language
    condition: DialogueCondition
    seed: int
    names: RoomNames = field(default_factory=RoomNames)
    author: WordingAuthor | None = None
    known: tuple[str, ...] = ()
    names_energy: bool = True

    def without_energy(self) -> "WordedPhrasing":
        """Return this phrasing without amounts of energy; see `Phrasing`."""
        return replace(self, names_energy=False)

    def authored(self, dialogue: Dialogue, move: Move) -> OfferedSentence | None:
        """Return the author's offer for the robot's next move in a dialogue game; None without an author."""
        if self.author is None or not isinstance(move, DialogueMove):
            return None
        words, chance = self._words(dialogue)
        request = request_of(words, move, condition=self.condition, chance=chance, known=self.known)
        answer = ask_author(self.author, request)
        if answer.refusal is None:
            return OfferedSentence(request.sentence, answer.offered)
        return OfferedSentence(request.sentence, answer.offered, answer.refusal.reason.value, answer.refusal.why)

    def _words(self, dialogue: Dialogue) -> tuple[Wording, float]:
        """Return the words of a dialogue's robot, and the random number for its next move."""
        chance = noise.uniform(noise.key(self.seed, "wording"), dialogue.number, len(dialogue.turns))
        return Wording(self.language, dialogue.topic.robot, self.names, self.names_energy), chance

    def say(self, dialogue: Dialogue, move: Move, speaker: Speaker) -> str:
        """Return the sentence for the next move, or a possible next move, of this dialogue."""
        words, chance = self._words(dialogue)
        side = Side.ROBOT if speaker is Speaker.ROBOT else Side.HUMAN
        match move:
            # The person asks for an opposite only after a refusal of their reason.
            case DialogueMove("question", Literal(holds=True)) if side is Side.HUMAN:
                where = LineKey.WHERE_THEN if dialogue.turns else LineKey.WHERE
                key = where if _is_about_a_room(move) else LineKey.WHAT_THEN
                return words.line(key, chance=chance)
            case DialogueMove():
                return words.sentence(move, side, condition=self.condition, chance=chance)
            case Enquire(Question.WHY_THIS, Literal() as about):
                return words.sentence(DialogueMove("challenge", about), side, condition=self.condition, chance=chance)
            case Enquire(Question.WHY_NOT, Literal() as about):
                return words.sentence(DialogueMove("challenge", ~about), side, condition=self.condition, chance=chance)
            case Enquire(question):
                return words.line(_ASKED[question], chance=chance)
            case Explain():
                return _explanation(words, move, chance)
            case Echo(heard):
                if not self.names_energy and dialogue.turns:
                    *before, misheard = dialogue.turns
                    heard = self.say(replace(dialogue, turns=tuple(before)), misheard.move, Speaker.PERSON)
                return words.line(LineKey.MISHEARD, chance=chance, heard=heard)
            case Conclude(Upshot.AGREED, Literal(NextRoom(_, room))):
                return words.line(LineKey.GOES, chance=chance, room=room)
            case Conclude(upshot, Literal() as about):
                return words.line(_UPSHOTS[upshot], chance=chance, content=about)
            case Conclude(upshot):
                return words.line(_UPSHOTS[upshot], chance=chance)
            case DecideAlone(waited):
                return words.line(LineKey.NEGLECTED, chance=chance, seconds=waited, room=dialogue.topic.room)
            case OpenQuestions():
                return words.line(LineKey.HAVE_QUESTION, chance=chance)
            case CloseQuestions():
                return words.line(LineKey.BACK, chance=chance)
            case Leave():
                return words.line(LineKey.LEAVE_IT, chance=chance)
            case Override():
                return _override(words, dialogue, chance)
            case _:
                raise ValueError(f"robots that argue do not say {move}")


def _is_about_a_room(move: DialogueMove) -> bool:
    return isinstance(move.content, Literal) and isinstance(move.content.parts[0].proposition, NextRoom | VisitOrder)


def _explanation(words: Wording, move: Explain, chance: float) -> str:
    changes = Question.CHANGE in (move.question, move.restates)
    if not move.because:
        return words.line(LineKey.CHANGED_BY_NOTHING if changes else LineKey.BECAUSE_NOT_KNOWN, chance=chance)
    key = LineKey.CHANGED_BY if changes else LineKey.BECAUSE
    return words.line(key, chance=chance, simply=move.question is Question.SIMPLER, because=move.because)


def _override(words: Wording, dialogue: Dialogue, chance: float) -> str:
    match dialogue.topic.scenario:
        case Scenario.TAKE_PICTURE:
            return words.line(LineKey.OVERRIDE_PICTURE, chance=chance)
        case Scenario.TAKE_TREASURE | Scenario.UNSURE_NAME:
            return words.line(LineKey.OVERRIDE_NAME, chance=chance)
        case _:
            return words.line(LineKey.OVERRIDE, chance=chance, room=dialogue.topic.room)
