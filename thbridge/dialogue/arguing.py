"""Dialogues in which a robot argues: persuasion and information-seeking about the decisions of the hunt.

One dialogue of the participant with a robot is a course of dialogue games about one decision: what the participant
wants opens a persuasion, "I don't know" an information-seeking; when a game has ended without an agreement, she may
open the next one. Beside the games she may ask for explanations, which change nothing.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from sim.numerics import noise
from thbridge.dialogue.argumentation.arguments import Argument
from thbridge.dialogue.argumentation.beliefs import Beliefs, Source
from thbridge.dialogue.argumentation.cases import Side, Stance
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.conditions import DialogueCondition, Manner
from thbridge.dialogue.engine import Choice, DialogueStep, Phrasing, announcement
from thbridge.dialogue.evidence import (
    Evidence,
    WhatFacts,
    WhereFacts,
    is_decision,
    is_hearsay,
    reasons_of_a_person,
    what,
    where,
)
from thbridge.dialogue.explanations import explain, questions
from thbridge.dialogue.games.agents import Agent
from thbridge.dialogue.games.contents import ContentKind, DialogueMove, kind_of_content
from thbridge.dialogue.games.control import Conversation, Opening
from thbridge.dialogue.games.dialogue_game import GamePlay
from thbridge.dialogue.games.tables import DialogueEnd, Rulebook
from thbridge.dialogue.moves import (
    Author,
    CloseQuestions,
    Conclude,
    Dialogue,
    DialogueOutcome,
    DialogueTopic,
    DialogueUtterance,
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
    Turn,
    Upshot,
)
from thbridge.dialogue.propositions import NamesTreasure, NamesTreasureAs, NextRoom, TakesPicture, VisitOrder
from thbridge.dialogue.robot_strategies import StrategyFactory, choose_by, own_strategy
from thbridge.dialogue.wording.wording import reasons

PERSUASION, INFORMATION_SEEKING = "persuasion", "information-seeking"
IN_BRIEF = "-in-brief"
"""Ending of the names of games in which arguments are given as wholes."""
_SIDES: Mapping[Speaker, Side] = {Speaker.ROBOT: Side.ROBOT, Speaker.PERSON: Side.HUMAN}
_ASKED = frozenset({Scenario.DONT_KNOW, Scenario.UNSURE_NAME})
"""Decisions on which the person has no opinion, and asks the robot."""
MOST_CHOICES = 5
"""Greatest number of choices that a person has at once."""


@dataclass(frozen=True, slots=True)
class ArguingEngine:
    """Engine for dialogues in which robots argue; see `DialogueEngine`.

    Attributes:
        rulebook: locutions and games.
        manner: of each robot, by its index; those that are not there have the one of `None`.
        phrasing: words moves.
        seed: of the game, for what is misheard.
        strategies: programs of others that choose moves, by robot as `manners`; None for a robot's own.
    """

    rulebook: Rulebook
    manners: Mapping[int | None, Manner]
    phrasing: Phrasing
    seed: int = 0
    strategies: Mapping[int | None, StrategyFactory | None] = field(default_factory=dict)

    @property
    def argues(self) -> bool:
        """True."""
        return True

    def manner(self, robot: int) -> Manner:
        """Return the manner of a robot."""
        return self.manners.get(robot) or self.manners[None]

    def open(
        self, number: int, topic: DialogueTopic, *, held: bool = False, former: Conversation | None = None
    ) -> DialogueStep:
        """Open a dialogue; see `DialogueEngine`."""
        sides = (Agent(Side.ROBOT, Beliefs()), Agent(Side.HUMAN, Beliefs(), is_person=True))
        fresh = Conversation(self.rulebook, {agent.side: agent for agent in sides})
        for play in () if former is None else former.open_plays:
            former = former and former.withdraw(play.number)
        evidence, claim = _evidence(topic, former), _claim(topic)
        dialogue = Dialogue(number, topic, conversation=_sensed(topic, former or fresh))
        if topic.opener is Speaker.ROBOT:
            opening = self._opening(dialogue, Side.ROBOT, PERSUASION, evidence.decision)
            return self._opened(dialogue, Speaker.ROBOT, opening, held)
        if topic.scenario in _ASKED:
            opening = self._opening(dialogue, Side.HUMAN, INFORMATION_SEEKING, evidence.decision or evidence.doubt)
            return self._opened(dialogue, Speaker.PERSON, opening, held)
        if self.manner(topic.robot).condition is DialogueCondition.SUPERVISOR or evidence.decision == claim:
            return DialogueStep(dialogue, (), DialogueOutcome.CONSENSUS)
        opening = self._opening(dialogue, Side.HUMAN, PERSUASION, claim)
        return self._opened(dialogue, Speaker.PERSON, opening, held)

    def announce(self, number: int, topic: DialogueTopic, move: Move) -> DialogueStep:
        """Let the robot say something that takes no answer."""
        return announcement(self.phrasing, number, topic, move)

    def move(self, dialogue: Dialogue, move: Move, *, held: bool = False) -> DialogueStep:
        """Make the person's move, or another one that the robot has heard; see `DialogueEngine`."""
        _check(move in self._legal(dialogue, Speaker.PERSON), move, Speaker.PERSON)
        heard = self._heard(dialogue, move)
        said = None if heard == move else move
        dialogue, utterance = self._with_turn(dialogue, Turn(Speaker.PERSON, heard, Author.PERSON, said=said))
        if said is None:
            return self._run(dialogue, (utterance,), held)
        echo = Turn(Speaker.ROBOT, Echo(utterance.heard), Author.ROBOT)
        dialogue, repeated = self._with_turn(dialogue, echo)
        return self._run(dialogue, (utterance, repeated), held)

    def speak(self, dialogue: Dialogue, move: Move, text: str = "") -> DialogueStep:
        """Make the move of a robot whose dialogue is held; see `DialogueEngine`."""
        _check(move in self._legal(dialogue, Speaker.ROBOT), move, Speaker.ROBOT)
        dialogue, utterance = self._with_turn(dialogue, Turn(Speaker.ROBOT, move, Author.WIZARD, text))
        return self._run(dialogue, (utterance,), held=True)

    def release(self, dialogue: Dialogue) -> DialogueStep:
        """Let the robot speak in a dialogue that was held."""
        return self._run(dialogue, (), held=False)

    def retake(self, dialogue: Dialogue, turn: Turn) -> DialogueStep:
        """Take a turn that was taken before; see `DialogueEngine`."""
        is_legal = isinstance(turn.move, Echo) or turn.move in self._legal(dialogue, turn.speaker)
        _check(is_legal, turn.move, turn.speaker)
        if isinstance(turn.move, Echo):
            # The robot tells what it has heard before it tells what comes of it.
            before = tuple(each for each in dialogue.conclusions if each[0] < len(dialogue.turns))
            dialogue = replace(dialogue, conclusions=before)
        dialogue, utterance = self._with_turn(dialogue, turn)
        return self._run(dialogue, (utterance,), held=True)

    def choices(self, dialogue: Dialogue, speaker: Speaker = Speaker.PERSON) -> tuple[Choice, ...]:
        """Return the speaker's legal moves; see `DialogueEngine`."""
        return tuple(
            Choice(move, self.phrasing.say(dialogue, move, speaker)) for move in self._legal(dialogue, speaker)
        )

    def utterances(self, dialogue: Dialogue) -> tuple[DialogueUtterance, ...]:
        """Return all utterances of a dialogue so far, with what the robot says beside its turns."""
        said: list[DialogueUtterance] = []
        for at, turn in enumerate(dialogue.turns):
            said.append(self._utterance(replace(dialogue, turns=dialogue.turns[:at]), turn))
            until = replace(dialogue, turns=dialogue.turns[: at + 1])
            said += [self._concluded(until, move) for turns, move in dialogue.conclusions if turns == at + 1]
        return tuple(said)

    # Course of a dialogue

    def _opened(self, dialogue: Dialogue, speaker: Speaker, opening: Opening | None, held: bool) -> DialogueStep:
        if opening is None:
            # She wants what the robot holds already; or nothing is left to be said. A suggestion is hers to answer.
            wanted = dialogue.topic.scenario not in _ASKED
            agreed = wanted and _is_settled(dialogue)
            return DialogueStep(dialogue, (), DialogueOutcome.CONSENSUS if agreed else DialogueOutcome.NO_CONSENSUS)
        author = Author.ROBOT if speaker is Speaker.ROBOT else Author.PERSON
        dialogue, utterance = self._with_turn(dialogue, Turn(speaker, opening.move, author))
        return self._run(dialogue, (utterance,), held)

    def _run(self, dialogue: Dialogue, utterances: tuple[DialogueUtterance, ...], held: bool) -> DialogueStep:
        while True:
            dialogue, outcome = self._outcome(dialogue)
            legal = () if outcome is not None or held else self._legal(dialogue, Speaker.ROBOT)
            if not legal:
                # Where nothing was said, it was told before.
                told = self._conclusion(dialogue) if utterances else None
                if told is not None:
                    conclusions = (*dialogue.conclusions, (len(dialogue.turns), told))
                    dialogue = replace(dialogue, conclusions=conclusions)
                    utterances = (*utterances, self._concluded(dialogue, told))
                return DialogueStep(dialogue, utterances, outcome)
            move, fault = self._chosen(dialogue, legal)
            authored = self.phrasing.authored(dialogue, move)
            text = "" if authored is None else authored.text
            dialogue, utterance = self._with_turn(dialogue, Turn(Speaker.ROBOT, move, Author.ROBOT, text, fault=fault))
            utterances = (*utterances, replace(utterance, authored=authored))

    def _chosen(self, dialogue: Dialogue, legal: tuple[Move, ...]) -> tuple[Move, str]:
        """Return the robot's move, and the fault of the program that was to choose it, if it failed."""
        conversation, play = dialogue.conversation, _current(dialogue)
        if conversation is None or play is None or not isinstance(legal[0], DialogueMove):
            return legal[0], ""
        robot = dialogue.topic.robot
        manner, factory = self.manner(robot), self.strategies.get(robot, self.strategies.get(None))
        if factory is None:
            return own_strategy(manner).choose(conversation, play.number), ""
        seed = int(noise.key(self.seed, "strategy", str(robot)))
        chosen = choose_by(factory, manner, seed, conversation, play.number)
        return chosen.move, chosen.fault

    def _outcome(self, dialogue: Dialogue) -> tuple[Dialogue, DialogueOutcome | None]:
        """Return the outcome, with the dialogue about what was agreed upon; None while it goes on."""
        last = _last_move(dialogue)
        conversation = dialogue.conversation
        if isinstance(last, Leave) or conversation is None:
            return dialogue, DialogueOutcome.NO_CONSENSUS
        if isinstance(last, Override):
            return dialogue, DialogueOutcome.CONSENSUS
        play = _last_play(dialogue)
        if (
            _current(dialogue) is not None
            or play is None
            or isinstance(last, OpenQuestions | CloseQuestions | Enquire | Explain)
        ):
            return dialogue, None
        if play.end is DialogueEnd.AGREEMENT and isinstance(play.claim, Literal) and play.claim.holds:
            return _about(dialogue, play.claim), DialogueOutcome.CONSENSUS
        manner = self.manner(dialogue.topic.robot)
        if manner.condition is DialogueCondition.AUTONOMOUS and play.end is not DialogueEnd.AGREEMENT:
            decision = _evidence(dialogue.topic, conversation).decision
            if decision is not None and type(decision.proposition) is type(_claim(dialogue.topic).proposition):
                return _about(dialogue, decision), DialogueOutcome.CONSENSUS
        return dialogue, None

    def _conclusion(self, dialogue: Dialogue) -> Conclude | None:
        """The upshot of a game, or of all of the dialogue, that has ended with the person's turn; else None."""
        dialogue, outcome = self._outcome(dialogue)
        turn = next((turn for turn in reversed(dialogue.turns) if not isinstance(turn.move, Echo)), None)
        ends = DialogueMove | Leave | Override
        if turn is None or turn.speaker is Speaker.ROBOT or not isinstance(turn.move, ends):
            return None
        if outcome is None and (_current(dialogue) is not None or self._asks(dialogue) is not None):
            return None
        claim = _claim(dialogue.topic)
        if outcome is not DialogueOutcome.CONSENSUS:
            return Conclude(Upshot.STAYS if isinstance(claim.proposition, NextRoom) else Upshot.UNDONE)
        if isinstance(turn.move, Override):
            return Conclude(Upshot.OVERRIDDEN, claim)
        accepted = isinstance(turn.move, DialogueMove) and turn.move.locution == "accept"
        return Conclude(Upshot.AGREED if accepted else Upshot.DECIDED, claim)

    def _concluded(self, dialogue: Dialogue, move: Conclude) -> DialogueUtterance:
        """The sentence about what comes of a dialogue."""
        told = self._utterance(dialogue, Turn(Speaker.ROBOT, move, Author.ROBOT))
        return replace(told, conversation=dialogue.conversation)

    def _legal(self, dialogue: Dialogue, speaker: Speaker) -> tuple[Move, ...]:
        conversation, play = dialogue.conversation, _current(dialogue)
        last = _last_move(dialogue)
        if conversation is None:
            return ()
        if isinstance(last, Enquire):
            return (self._answer(dialogue, last),) if speaker is Speaker.ROBOT else ()
        if play is not None and play.speaker is not _SIDES[speaker]:
            return ()
        if play is None and (opening := self._asks(dialogue)) is not None:
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
        """Ways in which the person may go on after a game that has ended without an agreement to do something."""
        claim, evidence = _claim(dialogue.topic), _evidence(dialogue.topic, conversation)
        # She has no name of her own to argue for.
        hers = None if dialogue.topic.scenario is Scenario.UNSURE_NAME else claim
        found = [
            self._opening(dialogue, Side.HUMAN, PERSUASION, hers),
            # Of a room that it would go to later, the robot tells in which order.
            self._opening(dialogue, Side.HUMAN, INFORMATION_SEEKING, evidence.order or evidence.decision),
            self._question_of_refusal(dialogue, Side.HUMAN),
        ]
        asked = [opening.move for opening in found if opening is not None]
        last = _last_play(dialogue)
        if last is not None and last.end is DialogueEnd.AGREEMENT:
            # She has accepted that it is not done.
            asked = [move for move in asked if move.content != claim]
        return list(dict.fromkeys(asked))

    def _questions(self, dialogue: Dialogue) -> tuple[Enquire, ...]:
        conversation, topic = dialogue.conversation, dialogue.topic
        if conversation is None or topic.facts is None or not self.manner(topic.robot).gives_reasons:
            return ()
        put = {turn.move for turn in dialogue.turns if isinstance(turn.move, Enquire)}
        # Who challenges something has asked why.
        put |= {
            Enquire(Question.WHY_THIS, turn.move.content)
            for turn in dialogue.turns
            if isinstance(turn.move, DialogueMove)
            and (turn.speaker, turn.move.locution) == (Speaker.PERSON, "challenge")
            and isinstance(turn.move.content, Literal)
        }
        possible = questions(topic.facts, _evidence(topic, conversation), _claim(topic))
        simpler = (Enquire(Question.SIMPLER),) if _last_said(dialogue).because else ()
        # To hear it in simpler words has to be in reach at once, with the first reasons.
        asked = (*possible[:2], *simpler, *possible[2:])
        return tuple(each for each in asked if each not in put or each.question is Question.SIMPLER)

    def _answer(self, dialogue: Dialogue, asked: Enquire) -> Explain:
        conversation, topic = dialogue.conversation, dialogue.topic
        if asked.question is Question.SIMPLER:
            return _last_said(dialogue)
        if conversation is None or topic.facts is None:
            return Explain(asked.question, asked.about, ())
        return explain(asked, topic.facts, _evidence(topic, conversation))

    # Sides

    def _question_of_refusal(self, dialogue: Dialogue, side: Side) -> Opening | None:
        """The question that a side may put when its reason was refused; None where it has none.

        Nobody doubts what she wishes. A robot that holds out asks what it does not know yet.
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
        return self._opening(dialogue, side, INFORMATION_SEEKING, asked, refused.number)

    def _asks(self, dialogue: Dialogue) -> Opening | None:
        """The question with which the robot, whose reason was refused just now, goes on; None where it has none."""
        refused = isinstance(_last_move(dialogue), DialogueMove)
        return self._question_of_refusal(dialogue, Side.ROBOT) if refused else None

    def _opening(
        self, dialogue: Dialogue, side: Side, game: str, topic: Literal | None, parent: int | None = None
    ) -> Opening | None:
        conversation = dialogue.conversation
        if topic is None or conversation is None:
            return None
        name = game if self.manner(dialogue.topic.robot).talkative else game + IN_BRIEF
        return next(iter(conversation.opening(side, name, topic, parent)), None)

    def _heard(self, dialogue: Dialogue, move: Move) -> Move:
        """Return the move that the robot hears: another one at the rate at which it mishears."""
        rate = self.manner(dialogue.topic.robot).misheard
        others = [
            each for each in self._legal(dialogue, Speaker.PERSON) if isinstance(each, DialogueMove) and each != move
        ]
        if rate <= 0.0 or not others or not isinstance(move, DialogueMove):
            return move
        key = noise.key(self.seed, "misheard")
        turn = len(dialogue.turns)
        if noise.uniform(key, dialogue.number, 2 * turn) >= rate:
            return move
        return others[int(noise.uniform(key, dialogue.number, 2 * turn + 1) * len(others))]

    def _with_turn(self, dialogue: Dialogue, turn: Turn) -> tuple[Dialogue, DialogueUtterance]:
        utterance = self._utterance(dialogue, turn)
        conversation, play = dialogue.conversation, _current(dialogue)
        said_before = 0 if conversation is None else len(conversation.record)
        move, at = turn.move, _time(dialogue.topic)
        if conversation is not None and isinstance(move, DialogueMove):
            if play is not None:
                conversation = conversation.say(play.number, move, at=at)
            else:
                side, topic = _SIDES[turn.speaker], move.content if isinstance(move.content, Literal) else None
                asked = self._question_of_refusal(dialogue, side)
                ways = [self._opening(dialogue, side, game, topic) for game in (PERSUASION, INFORMATION_SEEKING)]
                opening = next(each for each in (asked, *ways) if each is not None and each.move == move)
                # What was said last is the refusal that is asked about.
                parent = conversation.record[-1].dialogue if opening is asked else None
                conversation = conversation.open(side, opening, parent=parent, at=at)
        if conversation is not None and isinstance(move, Leave | Override) and play is not None:
            # With the outermost game those inside it are left, too.
            conversation = conversation.withdraw(conversation.open_plays[0].number)
        if conversation is not None and not conversation.open_plays:
            conversation = _sensed(dialogue.topic, conversation)
        formal = () if conversation is None else conversation.record[said_before:]
        utterance = replace(utterance, formal=formal, conversation=conversation)
        return replace(dialogue, turns=(*dialogue.turns, turn), conversation=conversation), utterance

    def _utterance(self, dialogue: Dialogue, turn: Turn) -> DialogueUtterance:
        text = turn.text or self.phrasing.say(dialogue, turn.said or turn.move, turn.speaker)
        heard = "" if turn.said is None else self.phrasing.say(dialogue, turn.move, turn.speaker)
        return DialogueUtterance(
            dialogue.number,
            len(dialogue.turns),
            turn.speaker,
            turn.author,
            turn.move,
            text,
            dialogue.topic,
            heard=heard,
            fault=turn.fault,
        )


def decision_of(facts: WhereFacts | WhatFacts, former: Conversation | None) -> Literal | None:
    """Return what a robot would do by itself, with what it was told before and has accepted; None: nothing."""
    if isinstance(facts, WhereFacts):
        return where(facts, _told(former)).decision
    return what(facts, _told(former)).decision


def _check(is_legal: bool, move: Move, speaker: Speaker) -> None:
    if not is_legal:
        raise ValueError(f"{move} of the {speaker} is not among the legal moves")


def _claim(topic: DialogueTopic) -> Literal:
    """The literal that a dialogue is about."""
    match topic.scenario:
        case Scenario.TAKE_PICTURE:
            return Literal(TakesPicture(topic.room))
        case Scenario.TAKE_TREASURE | Scenario.UNSURE_NAME:
            return Literal(NamesTreasureAs(topic.room, topic.name) if topic.name else NamesTreasure(topic.room))
        case _:
            return Literal(NextRoom(topic.robot, topic.room))


def _evidence(topic: DialogueTopic, conversation: Conversation | None) -> Evidence:
    """Evidence of the robot, with what it was told and has accepted."""
    match topic.facts:
        case WhereFacts():
            return where(topic.facts, _told(conversation), topic.room)
        case WhatFacts():
            return what(topic.facts, _told(conversation))
        case None:
            return Evidence(Beliefs(), None)


def _told(conversation: Conversation | None) -> Beliefs:
    """Beliefs that a robot was told by a person, and has accepted."""
    if conversation is None:
        return Beliefs()
    origins = conversation.agents[Side.ROBOT].beliefs.origins
    people = {Source.TOLD, Source.WISHED}
    return Beliefs(
        {literal: origin for literal, origin in origins.items() if origin.source in people and is_hearsay(literal)}
    )


def _sensed(topic: DialogueTopic, conversation: Conversation) -> Conversation:
    """The conversation after the robot has looked at its evidence anew, in the light of what it was told.

    What a person could say for or against what the robot wants then, and for or against the topic, is hers to say.
    """
    evidence, claim = _evidence(topic, conversation), _claim(topic)
    robot, person = conversation.agents[Side.ROBOT], conversation.agents[Side.HUMAN]
    if topic.facts is not None:
        origins, rules = dict(person.beliefs.origins), list(person.beliefs.rules)
        for literal in dict.fromkeys(
            [claim, *(each for each in (evidence.decision, evidence.order) if each is not None)]
        ):
            for conclusion in (literal, ~literal):
                own = reasons_of_a_person(conclusion, topic.facts)
                origins |= own.origins
                rules += [rule for rule in own.rules if rule not in rules]
        person = replace(person, beliefs=Beliefs(origins, tuple(rules)))
    return conversation.with_agent(replace(robot, beliefs=evidence.beliefs)).with_agent(person)


def _time(topic: DialogueTopic) -> float:
    return 0.0 if topic.facts is None else topic.facts.at


def _current(dialogue: Dialogue) -> GamePlay | None:
    """The game in which somebody has to speak now, or None."""
    conversation = dialogue.conversation
    if conversation is None:
        return None
    return next((play for play in reversed(conversation.open_plays) if not conversation.waits(play.number)), None)


def _last_move(dialogue: Dialogue) -> Move | None:
    """The last move that changes anything."""
    return next((turn.move for turn in reversed(dialogue.turns) if not isinstance(turn.move, Echo)), None)


def _most_agreeable_first(play: GamePlay, moves: tuple[DialogueMove, ...]) -> list[DialogueMove]:
    """Moves of the person; of the answers to whether a reason is not so, that it is not so comes last."""
    return sorted(moves, key=lambda move: play.questions_refusal and move.content == play.topic)


def _last_play(dialogue: Dialogue) -> GamePlay | None:
    """The last game that is not inside another one, or None."""
    plays = () if dialogue.conversation is None else dialogue.conversation.plays
    return next((play for play in reversed(plays) if play.parent is None), None)


def _is_settled(dialogue: Dialogue) -> bool:
    """True when the robot holds the claim already."""
    conversation = dialogue.conversation
    return conversation is not None and _claim(dialogue.topic) in conversation.agents[Side.ROBOT].beliefs


def _may_override(dialogue: Dialogue) -> bool:
    return dialogue.topic.scenario not in _ASKED


def _about(dialogue: Dialogue, agreed: Literal) -> Dialogue:
    """The dialogue, about what was agreed upon in the end."""
    scenario, room, name = dialogue.topic.scenario, dialogue.topic.room, ""
    match agreed.parts[0].proposition:
        case NextRoom(room=room) | VisitOrder(room=room):
            pass
        case TakesPicture(room=room):
            scenario = Scenario.TAKE_PICTURE
        case NamesTreasure(room=room):
            scenario = Scenario.TAKE_TREASURE
        case NamesTreasureAs(room=room, name=name):
            scenario = Scenario.TAKE_TREASURE
    return replace(dialogue, topic=replace(dialogue.topic, scenario=scenario, room=room, name=name))


def _last_said(dialogue: Dialogue) -> Explain:
    """The robot's last reasons, to be said again; none where it was that, or there were no reasons."""
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
