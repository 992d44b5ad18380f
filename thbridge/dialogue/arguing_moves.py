"""Possible moves in a dialogue in which a robot argues, and the state of such dialogues."""

from collections.abc import Mapping
from dataclasses import dataclass

from thbridge.dialogue.argumentation.arguments import Argument
from thbridge.dialogue.argumentation.beliefs import Beliefs, Source
from thbridge.dialogue.argumentation.cases import Side, Stance
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.conditions import DialogueCondition, Manner
from thbridge.dialogue.explanations import explain, questions
from thbridge.dialogue.games.contents import ContentKind, DialogueMove, kind_of_content
from thbridge.dialogue.games.control import Conversation, Opening
from thbridge.dialogue.games.dialogue_game import GamePlay
from thbridge.dialogue.games.tables import DialogueEnd
from thbridge.dialogue.moves import (
    CloseQuestions,
    Dialogue,
    DialogueTopic,
    Echo,
    Enquire,
    Explain,
    Leave,
    Move,
    OpenQuestions,
    Override,
    Question,
    Scenario,
    Speaker,
)
from thbridge.dialogue.propositions import NamesTreasure, NamesTreasureAs, NextRoom, TakesPicture
from thbridge.dialogue.robot_arguments import Evidence, WhatFacts, WhereFacts, is_decision, is_hearsay, what, where
from thbridge.dialogue.wording.wording import reasons

PERSUASION, INFORMATION_SEEKING = "persuasion", "information-seeking"
IN_BRIEF = "-in-brief"
"""Suffix of the names of games in which arguments are given as a whole."""
SIDES: Mapping[Speaker, Side] = {Speaker.ROBOT: Side.ROBOT, Speaker.PERSON: Side.HUMAN}
ASKED = frozenset({Scenario.DONT_KNOW, Scenario.UNSURE_NAME})
"""Decisions for which the person has no opinion. The person asks the robot for advice."""
MOST_CHOICES = 5
"""Maximum number of choices that a person has at once."""


@dataclass(frozen=True, slots=True)
class PossibleMoves:
    """Legal moves of participant and robots, according to the manners of robots.

    Attributes:
        manners: manner of each robot, by its index. Robots that are not listed have the manner with the key `None`.
    """

    manners: Mapping[int | None, Manner]

    def manner(self, robot: int) -> Manner:
        """Return the manner of a robot."""
        return self.manners.get(robot) or self.manners[None]

    def legal(self, dialogue: Dialogue, speaker: Speaker) -> tuple[Move, ...]:
        """Return the legal moves of a speaker."""
        conversation, play = dialogue.conversation, current_play(dialogue)
        last = last_move(dialogue)
        if conversation is None:
            return ()
        if isinstance(last, Enquire):
            return (self._answer(dialogue, last),) if speaker is Speaker.ROBOT else ()
        if play is not None and play.speaker is not SIDES[speaker]:
            return ()
        if play is None and (opening := self.asks(dialogue)) is not None:
            return (opening.move,) if speaker is Speaker.ROBOT else ()
        if speaker is Speaker.ROBOT:
            return () if play is None else conversation.legal(play.number)
        manner = self.manner(dialogue.topic.robot)
        asked = self._questions(dialogue)
        if isinstance(last, OpenQuestions):
            return (*asked[: MOST_CHOICES - 1], CloseQuestions())
        moves: list[Move] = []
        if play is None:
            moves += self._openings(dialogue, conversation)
        else:
            moves += [
                move
                for move in _most_agreeable_first(play, conversation.legal(play.number))
                if kind_of_content(move.content) is not ContentKind.ARGUMENT
            ]
        if manner.condition is DialogueCondition.ADVISER and _may_override(dialogue):
            moves.append(Override())
        if asked and len(moves) < MOST_CHOICES - 1:
            moves.append(OpenQuestions())
        return (*moves[: MOST_CHOICES - 1], Leave())

    def _openings(self, dialogue: Dialogue, conversation: Conversation) -> list[Move]:
        """Return the moves with which the person may continue after a game that ended without an agreed action."""
        claim, evidence = claim_of(dialogue.topic), evidence_of(dialogue.topic, conversation)
        # The person has not proposed a name to argue for.
        hers = None if dialogue.topic.scenario is Scenario.UNSURE_NAME else claim
        found = [
            self.opening(dialogue, Side.HUMAN, PERSUASION, hers),
            # For a room that comes later in the robot's tour, the robot's reason is the order of the tour.
            self.opening(dialogue, Side.HUMAN, INFORMATION_SEEKING, evidence.order or evidence.decision),
            self.question_of_refusal(dialogue, Side.HUMAN),
        ]
        asked = [opening.move for opening in found if opening is not None]
        last = last_play(dialogue)
        if last is not None and last.end is DialogueEnd.AGREEMENT:
            # The person has accepted that the proposal is not carried out.
            asked = [move for move in asked if move.content != claim]
        return list(dict.fromkeys(asked))

    def _questions(self, dialogue: Dialogue) -> tuple[Enquire, ...]:
        conversation, topic = dialogue.conversation, dialogue.topic
        if conversation is None or topic.facts is None or not self.manner(topic.robot).gives_reasons:
            return ()
        put = {turn.move for turn in dialogue.turns if isinstance(turn.move, Enquire)}
        # A challenge counts as the question "why this?".
        put |= {
            Enquire(Question.WHY_THIS, turn.move.content)
            for turn in dialogue.turns
            if isinstance(turn.move, DialogueMove)
            and (turn.speaker, turn.move.locution) == (Speaker.PERSON, "challenge")
            and isinstance(turn.move.content, Literal)
        }
        possible = questions(topic.facts, evidence_of(topic, conversation), claim_of(topic))
        simpler = (Enquire(Question.SIMPLER),) if _last_said(dialogue).because else ()
        # As soon as there are reasons, the request for simpler words must be among the first choices.
        asked = (*possible[:2], *simpler, *possible[2:])
        return tuple(each for each in asked if each not in put or each.question is Question.SIMPLER)

    def _answer(self, dialogue: Dialogue, asked: Enquire) -> Explain:
        conversation, topic = dialogue.conversation, dialogue.topic
        if asked.question is Question.SIMPLER:
            return _last_said(dialogue)
        if conversation is None or topic.facts is None:
            return Explain(asked.question, asked.about, ())
        return explain(asked, topic.facts, evidence_of(topic, conversation))

    def question_of_refusal(self, dialogue: Dialogue, side: Side) -> Opening | None:
        """Return the question that a side may ask after its reason was refused; None if there is no question.

        No side asks about a wish of the other side. A persistent robot asks about things that it does not know yet.
        """
        conversation = dialogue.conversation
        refused = None if conversation is None else conversation.refused
        if conversation is None or refused is None or refused.in_question is None:
            return None
        asked = refused.in_question
        is_known = conversation.agents[side].picture.stance(asked.proposition) is not Stance.UNKNOWN
        takes_it = side is Side.ROBOT and (is_known or self.manner(dialogue.topic.robot).persistence == 0)
        if takes_it or asked.proposition.is_wish:
            return None
        return self.opening(dialogue, side, INFORMATION_SEEKING, asked, refused.number)

    def asks(self, dialogue: Dialogue) -> Opening | None:
        """Return the next question of a robot whose reason was just refused; None if it has no question."""
        refused = isinstance(last_move(dialogue), DialogueMove)
        return self.question_of_refusal(dialogue, Side.ROBOT) if refused else None

    def opening(
        self, dialogue: Dialogue, side: Side, game: str, topic: Literal | None, parent: int | None = None
    ) -> Opening | None:
        """Return the move by which a side opens a game about a topic; None if the side cannot open the game."""
        conversation = dialogue.conversation
        if topic is None or conversation is None:
            return None
        name = game if self.manner(dialogue.topic.robot).talkative else game + IN_BRIEF
        return next(iter(conversation.opening(side, name, topic, parent)), None)


def claim_of(topic: DialogueTopic) -> Literal:
    """Return the literal that a dialogue is about."""
    match topic.scenario:
        case Scenario.TAKE_PICTURE:
            return Literal(TakesPicture(topic.room))
        case Scenario.TAKE_TREASURE | Scenario.UNSURE_NAME:
            return Literal(NamesTreasureAs(topic.room, topic.name) if topic.name else NamesTreasure(topic.room))
        case _:
            return Literal(NextRoom(topic.robot, topic.room))


def evidence_of(topic: DialogueTopic, conversation: Conversation | None) -> Evidence:
    """Return the robot's evidence, including the person's statements that the robot has accepted."""
    match topic.facts:
        case WhereFacts():
            return where(topic.facts, told_beliefs(conversation), topic.room)
        case WhatFacts():
            return what(topic.facts, told_beliefs(conversation))
        case None:
            return Evidence(Beliefs(), None)


def told_beliefs(conversation: Conversation | None) -> Beliefs:
    """Return the statements of the person that the robot has accepted, as beliefs."""
    if conversation is None:
        return Beliefs()
    origins = conversation.agents[Side.ROBOT].beliefs.origins
    people = {Source.TOLD, Source.WISHED}
    return Beliefs(
        {literal: origin for literal, origin in origins.items() if origin.source in people and is_hearsay(literal)}
    )


def current_play(dialogue: Dialogue) -> GamePlay | None:
    """Return the game in which a side has to speak now, or None."""
    conversation = dialogue.conversation
    if conversation is None:
        return None
    return next((play for play in reversed(conversation.open_plays) if not conversation.waits(play.number)), None)


def last_move(dialogue: Dialogue) -> Move | None:
    """Return the last move that has an effect."""
    return next((turn.move for turn in reversed(dialogue.turns) if not isinstance(turn.move, Echo)), None)


def _most_agreeable_first(play: GamePlay, moves: tuple[DialogueMove, ...]) -> list[DialogueMove]:
    """Return the person's moves. When a robot asks whether the opposite of a reason holds, agreement comes last."""
    return sorted(moves, key=lambda move: play.questions_refusal and move.content == play.topic)


def last_play(dialogue: Dialogue) -> GamePlay | None:
    """Return the last game that is not inside another game, or None."""
    plays = () if dialogue.conversation is None else dialogue.conversation.plays
    return next((play for play in reversed(plays) if play.parent is None), None)


def _may_override(dialogue: Dialogue) -> bool:
    return dialogue.topic.scenario not in ASKED


def _last_said(dialogue: Dialogue) -> Explain:
    """Return the robot's last reasons for a repetition in simpler words.

    The result is empty if there are none, or after a repetition.
    """
    robot = (turn.move for turn in reversed(dialogue.turns) if turn.speaker is Speaker.ROBOT)
    last = next((move for move in robot if not isinstance(move, Echo)), None)
    match last:
        case Explain(question, about, because) if question is not Question.SIMPLER:
            return Explain(Question.SIMPLER, about, because, question)
        case DialogueMove("assert", Argument(support, Literal() as conclusion)):
            literals = tuple(each for each in reasons(support, conclusion) if isinstance(each, Literal))
            return Explain(Question.SIMPLER, conclusion, literals)
        case DialogueMove("assert", Literal() as said) if not is_decision(said):
            return Explain(Question.SIMPLER, said, (said,))
        case _:
            return Explain(Question.SIMPLER, None, ())
