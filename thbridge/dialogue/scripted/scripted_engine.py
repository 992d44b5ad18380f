"""Scripted dialogues without I/O: they receive moves of people, and return utterances and outcomes as values.

A protocol determines the turn and the legal moves, a strategy chooses the robot's move, and a phrasing gives its words.
The person gets the legal moves as sentences and can make no other move.
"""

from dataclasses import dataclass, replace

from thbridge.dialogue.engine import Choice, DialogueStep, Phrasing, announcement, text_of
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.moves import Author, Dialogue, DialogueTopic, DialogueUtterance, Move, Speaker, Turn
from thbridge.dialogue.scripted.protocols import DialogueProtocol
from thbridge.dialogue.scripted.strategies import Strategy


@dataclass(frozen=True, slots=True)
class ScriptedEngine:
    """Engine for one kind of dialogue. It has no state: every method receives a dialogue and returns its new state.

    All methods raise ValueError if a person, a wizard or the strategy makes an illegal move.

    Attributes:
        protocol: determines legal moves.
        strategy: chooses the robot's moves.
        phrasing: words for moves.
    """

    protocol: DialogueProtocol
    strategy: Strategy
    phrasing: Phrasing

    @property
    def argues(self) -> bool:
        """Always False, because scripts need no facts."""
        return False

    def without_energy(self) -> "ScriptedEngine":
        """Return the engine for people who do not see energy; see `DialogueEngine`."""
        return replace(self, phrasing=self.phrasing.without_energy())

    def open(
        self, number: int, topic: DialogueTopic, *, held: bool = False, former: Conversation | None = None
    ) -> DialogueStep:
        """Open a dialogue; see `DialogueEngine`."""
        return self._run(Dialogue(number, topic), (), held)

    def announce(self, number: int, topic: DialogueTopic, move: Move) -> DialogueStep:
        """Let the robot say something that needs no answer."""
        return announcement(self.phrasing, number, topic, move)

    def move(self, dialogue: Dialogue, move: Move, *, held: bool = False) -> DialogueStep:
        """Make the person's move; unless the dialogue is held, let the robot answer."""
        dialogue, utterance = self._with_turn(dialogue, Turn(Speaker.PERSON, move, Author.PERSON))
        return self._run(dialogue, (utterance,), held)

    def speak(self, dialogue: Dialogue, move: Move, text: str = "") -> DialogueStep:
        """Make the move of a robot in a held dialogue, and keep it held; `text` is as in `Turn`."""
        dialogue, utterance = self._with_turn(dialogue, Turn(Speaker.ROBOT, move, Author.WIZARD, text))
        return self._run(dialogue, (utterance,), held=True)

    def release(self, dialogue: Dialogue) -> DialogueStep:
        """Let the robot speak in a held dialogue."""
        return self._run(dialogue, (), held=False)

    def retake(self, dialogue: Dialogue, turn: Turn) -> DialogueStep:
        """Repeat a turn of a dialogue that is restored; see `DialogueEngine`."""
        dialogue, utterance = self._with_turn(dialogue, turn)
        return self._run(dialogue, (utterance,), held=True)

    def choices(self, dialogue: Dialogue, speaker: Speaker = Speaker.PERSON) -> tuple[Choice, ...]:
        """Return the speaker's legal moves in an open dialogue, most agreeable first.

        There are no moves if it is not the speaker's turn.
        """
        if self.protocol.speaker(dialogue) is not speaker:
            return ()
        return tuple(Choice(move, self.phrasing.say(dialogue, move, speaker)) for move in self.protocol.legal(dialogue))

    def utterances(self, dialogue: Dialogue) -> tuple[DialogueUtterance, ...]:
        """Return all utterances of a dialogue so far."""
        so_far = Dialogue(dialogue.number, dialogue.topic)
        utterances: list[DialogueUtterance] = []
        for turn in dialogue.turns:
            so_far, utterance = self._with_turn(so_far, turn)
            utterances.append(utterance)
        return tuple(utterances)

    def _run(self, dialogue: Dialogue, utterances: tuple[DialogueUtterance, ...], held: bool) -> DialogueStep:
        while (outcome := self.protocol.outcome(dialogue)) is None:
            if held or self.protocol.speaker(dialogue) is Speaker.PERSON:
                break
            choice = self.strategy.choose(dialogue, self.protocol.legal(dialogue))
            dialogue, utterance = self._with_turn(dialogue, Turn(Speaker.ROBOT, choice, Author.ROBOT))
            utterances = (*utterances, utterance)
        return DialogueStep(dialogue, utterances, outcome)

    def _with_turn(self, dialogue: Dialogue, turn: Turn) -> tuple[Dialogue, DialogueUtterance]:
        legal = self.protocol.legal(dialogue) if self.protocol.speaker(dialogue) is turn.speaker else ()
        if turn.move not in legal:
            raise ValueError(f"{turn.move} of the {turn.speaker} is not among the legal moves {legal}")
        text = text_of(self.phrasing, dialogue, turn)
        index, topic = len(dialogue.turns), dialogue.topic
        utterance = DialogueUtterance(dialogue.number, index, turn.speaker, turn.author, turn.move, text, topic)
        return replace(dialogue, turns=(*dialogue.turns, turn)), utterance
