"""Dialogues in which a robot argues: persuasion and information-seeking about the decisions of the hunt.

One dialogue of the participant with a robot is a sequence of dialogue games about one decision. A wish of the
participant opens a persuasion dialogue; "I don't know" opens an information-seeking dialogue. If a game ends without an
agreement, the participant may open the next game. Between the games the participant may ask for explanations, which
have no effect on the dialogue.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from sim.numerics import noise
from thbridge.dialogue.arguing_moves import (
    ASKED,
    INFORMATION_SEEKING,
    PERSUASION,
    SIDES,
    PossibleMoves,
    claim_of,
    current_play,
    evidence_of,
    last_move,
    last_play,
    told_beliefs,
)
from thbridge.dialogue.argumentation.beliefs import Beliefs
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.conditions import DialogueCondition, Manner
from thbridge.dialogue.engine import Choice, DialogueStep, Phrasing, announcement, text_of
from thbridge.dialogue.games.agents import Agent
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.games.control import Conversation, Opening
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
    Scenario,
    Speaker,
    Turn,
    Upshot,
)
from thbridge.dialogue.propositions import NamesTreasure, NamesTreasureAs, NextRoom, TakesPicture, VisitOrder
from thbridge.dialogue.robot_arguments import (
    WhatFacts,
    WhereFacts,
    reasons_of_a_person,
    what,
    where,
)
from thbridge.dialogue.robot_strategies import StrategyFactory, choose_by, own_strategy


@dataclass(frozen=True, slots=True)
class ArguingEngine:
    """Engine for dialogues in which robots argue; see `DialogueEngine`.

    Attributes:
        rulebook: locutions and games.
        manners: manner of each robot, by its index. Robots that are not listed have the manner with the key `None`.
        phrasing: words for moves.
        seed: random seed of the game, used for moves that a robot mishears.
        strategies: installed strategies that choose moves, with keys as in `manners`. None means the built-in
            strategy.
    """

    rulebook: Rulebook
    manners: Mapping[int | None, Manner]
    phrasing: Phrasing
    seed: int = 0
    strategies: Mapping[int | None, StrategyFactory | None] = field(default_factory=dict)

    @property
    def argues(self) -> bool:
        """Always True."""
        return True

    def without_energy(self) -> "ArguingEngine":
        """Return the engine for people who do not see energy; see `DialogueEngine`."""
        return replace(self, phrasing=self.phrasing.without_energy())

    @property
    def _possible(self) -> PossibleMoves:
        return PossibleMoves(self.manners)

    def open(
        self, number: int, topic: DialogueTopic, *, held: bool = False, former: Conversation | None = None
    ) -> DialogueStep:
        """Open a dialogue; see `DialogueEngine`."""
        sides = (Agent(Side.ROBOT, Beliefs()), Agent(Side.HUMAN, Beliefs(), is_person=True))
        fresh = Conversation(self.rulebook, {agent.side: agent for agent in sides})
        for play in () if former is None else former.open_plays:
            former = former and former.withdraw(play.number)
        evidence, claim = evidence_of(topic, former), claim_of(topic)
        dialogue = Dialogue(number, topic, conversation=_sensed(topic, former or fresh))
        if topic.opener is Speaker.ROBOT:
            opening = self._possible.opening(dialogue, Side.ROBOT, PERSUASION, evidence.decision)
            return self._opened(dialogue, Speaker.ROBOT, opening, held)
        if topic.scenario in ASKED:
            opening = self._possible.opening(
                dialogue, Side.HUMAN, INFORMATION_SEEKING, evidence.decision or evidence.doubt
            )
            if opening is None and evidence.decision is not None:
                # The robot has said its decision before, for example as a reason. A person who asks hears it again.
                opening = self._possible.opening(dialogue, Side.ROBOT, PERSUASION, evidence.decision)
                return self._opened(dialogue, Speaker.ROBOT, opening, held)
            return self._opened(dialogue, Speaker.PERSON, opening, held)
        if self._possible.manner(topic.robot).condition is DialogueCondition.SUPERVISOR or evidence.decision == claim:
            return DialogueStep(dialogue, (), DialogueOutcome.CONSENSUS)
        opening = self._possible.opening(dialogue, Side.HUMAN, PERSUASION, claim)
        return self._opened(dialogue, Speaker.PERSON, opening, held)

    def announce(self, number: int, topic: DialogueTopic, move: Move) -> DialogueStep:
        """Let the robot say something that needs no answer."""
        return announcement(self.phrasing, number, topic, move)

    def move(self, dialogue: Dialogue, move: Move, *, held: bool = False) -> DialogueStep:
        """Make the person's move, or the other move that the robot understood instead; see `DialogueEngine`."""
        _check(move in self._possible.legal(dialogue, Speaker.PERSON), move, Speaker.PERSON)
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
        _check(move in self._possible.legal(dialogue, Speaker.ROBOT), move, Speaker.ROBOT)
        dialogue, utterance = self._with_turn(dialogue, Turn(Speaker.ROBOT, move, Author.WIZARD, text))
        return self._run(dialogue, (utterance,), held=True)

    def release(self, dialogue: Dialogue) -> DialogueStep:
        """Let the robot speak in a dialogue that was held."""
        return self._run(dialogue, (), held=False)

    def retake(self, dialogue: Dialogue, turn: Turn) -> DialogueStep:
        """Repeat a turn of a dialogue that is restored; see `DialogueEngine`."""
        is_legal = isinstance(turn.move, Echo) or turn.move in self._possible.legal(dialogue, turn.speaker)
        _check(is_legal, turn.move, turn.speaker)
        if isinstance(turn.move, Echo):
            # The robot repeats the misheard move before it states the result.
            before = tuple(each for each in dialogue.conclusions if each[0] < len(dialogue.turns))
            dialogue = replace(dialogue, conclusions=before)
        dialogue, utterance = self._with_turn(dialogue, turn)
        return self._run(dialogue, (utterance,), held=True)

    def choices(self, dialogue: Dialogue, speaker: Speaker = Speaker.PERSON) -> tuple[Choice, ...]:
        """Return the speaker's legal moves; see `DialogueEngine`."""
        return tuple(
            Choice(move, self.phrasing.say(dialogue, move, speaker)) for move in self._possible.legal(dialogue, speaker)
        )

    def utterances(self, dialogue: Dialogue) -> tuple[DialogueUtterance, ...]:
        """Return all utterances of a dialogue so far, with the robot's conclusions, which do not count as turns."""
        said: list[DialogueUtterance] = []
        for at, turn in enumerate(dialogue.turns):
            said.append(self._utterance(replace(dialogue, turns=dialogue.turns[:at]), turn))
            until = replace(dialogue, turns=dialogue.turns[: at + 1])
            said += [self._concluded(until, move) for turns, move in dialogue.conclusions if turns == at + 1]
        return tuple(said)

    # Course of a dialogue

    def _opened(self, dialogue: Dialogue, speaker: Speaker, opening: Opening | None, held: bool) -> DialogueStep:
        if opening is None:
            # The robot already agrees with the person's wish, or nothing is left to say. If the robot made a
            # suggestion, the person must answer.
            wanted = dialogue.topic.scenario not in ASKED
            agreed = wanted and _is_settled(dialogue)
            return DialogueStep(dialogue, (), DialogueOutcome.CONSENSUS if agreed else DialogueOutcome.NO_CONSENSUS)
        author = Author.ROBOT if speaker is Speaker.ROBOT else Author.PERSON
        dialogue, utterance = self._with_turn(dialogue, Turn(speaker, opening.move, author))
        return self._run(dialogue, (utterance,), held)

    def _run(self, dialogue: Dialogue, utterances: tuple[DialogueUtterance, ...], held: bool) -> DialogueStep:
        while True:
            dialogue, outcome = self._outcome(dialogue)
            legal = () if outcome is not None or held else self._possible.legal(dialogue, Speaker.ROBOT)
            if not legal:
                # If there is no new utterance, the robot has already stated the conclusion.
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
        """Return the robot's move, and the fault of the installed strategy if it failed to choose a move."""
        conversation, play = dialogue.conversation, current_play(dialogue)
        if conversation is None or play is None or not isinstance(legal[0], DialogueMove):
            return legal[0], ""
        robot = dialogue.topic.robot
        manner, factory = self._possible.manner(robot), self.strategies.get(robot, self.strategies.get(None))
        if factory is None:
            return own_strategy(manner).choose(conversation, play.number), ""
        seed = int(noise.key(self.seed, "strategy", str(robot)))
        chosen = choose_by(factory, manner, seed, conversation, play.number)
        return chosen.move, chosen.fault

    def _outcome(self, dialogue: Dialogue) -> tuple[Dialogue, DialogueOutcome | None]:
        """Return the dialogue with the decision that both sides agreed on, and the outcome.

        The outcome is None while the dialogue continues.
        """
        last = last_move(dialogue)
        conversation = dialogue.conversation
        if isinstance(last, Leave) or conversation is None:
            return dialogue, DialogueOutcome.NO_CONSENSUS
        if isinstance(last, Override):
            return dialogue, DialogueOutcome.CONSENSUS
        play = last_play(dialogue)
        if (
            current_play(dialogue) is not None
            or play is None
            or isinstance(last, OpenQuestions | CloseQuestions | Enquire | Explain)
        ):
            return dialogue, None
        if play.end is DialogueEnd.AGREEMENT and isinstance(play.claim, Literal) and play.claim.holds:
            return _about(dialogue, play.claim), DialogueOutcome.CONSENSUS
        manner = self._possible.manner(dialogue.topic.robot)
        if manner.condition is DialogueCondition.AUTONOMOUS and play.end is not DialogueEnd.AGREEMENT:
            decision = evidence_of(dialogue.topic, conversation).decision
            if decision is not None and type(decision.proposition) is type(claim_of(dialogue.topic).proposition):
                return _about(dialogue, decision), DialogueOutcome.CONSENSUS
        return dialogue, None

    def _conclusion(self, dialogue: Dialogue) -> Conclude | None:
        """Return the conclusion of a game or dialogue that has ended with the person's turn, otherwise None."""
        dialogue, outcome = self._outcome(dialogue)
        turn = next((turn for turn in reversed(dialogue.turns) if not isinstance(turn.move, Echo)), None)
        ends = DialogueMove | Leave | Override
        if turn is None or turn.speaker is Speaker.ROBOT or not isinstance(turn.move, ends):
            return None
        if outcome is None and (current_play(dialogue) is not None or self._possible.asks(dialogue) is not None):
            return None
        claim = claim_of(dialogue.topic)
        if outcome is not DialogueOutcome.CONSENSUS:
            return Conclude(Upshot.STAYS if isinstance(claim.proposition, NextRoom) else Upshot.UNDONE)
        if isinstance(turn.move, Override):
            return Conclude(Upshot.OVERRIDDEN, claim)
        accepted = isinstance(turn.move, DialogueMove) and turn.move.locution == "accept"
        return Conclude(Upshot.AGREED if accepted else Upshot.DECIDED, claim)

    def _concluded(self, dialogue: Dialogue, move: Conclude) -> DialogueUtterance:
        """Return the closing sentence of a dialogue."""
        told = self._utterance(dialogue, Turn(Speaker.ROBOT, move, Author.ROBOT))
        return replace(told, conversation=dialogue.conversation)

    def _heard(self, dialogue: Dialogue, move: Move) -> Move:
        """Return the move that the robot understands. If the robot mishears (at random), this is another move."""
        rate = self._possible.manner(dialogue.topic.robot).misheard
        others = [
            each
            for each in self._possible.legal(dialogue, Speaker.PERSON)
            if isinstance(each, DialogueMove) and each != move
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
        conversation, play = dialogue.conversation, current_play(dialogue)
        said_before = 0 if conversation is None else len(conversation.record)
        move, at = turn.move, _time(dialogue.topic)
        if conversation is not None and isinstance(move, DialogueMove):
            if play is not None:
                conversation = conversation.say(play.number, move, at=at)
            else:
                side, topic = SIDES[turn.speaker], move.content if isinstance(move.content, Literal) else None
                asked = self._possible.question_of_refusal(dialogue, side)
                ways = [
                    self._possible.opening(dialogue, side, game, topic) for game in (PERSUASION, INFORMATION_SEEKING)
                ]
                opening = next(each for each in (asked, *ways) if each is not None and each.move == move)
                # The last move is the refusal that the question is about.
                parent = conversation.record[-1].dialogue if opening is asked else None
                conversation = conversation.open(side, opening, parent=parent, at=at)
        if conversation is not None and isinstance(move, Leave | Override) and play is not None:
            # By leaving the outermost game, the person also leaves the games inside it.
            conversation = conversation.withdraw(conversation.open_plays[0].number)
        if conversation is not None and not conversation.open_plays:
            conversation = _sensed(dialogue.topic, conversation)
        formal = () if conversation is None else conversation.record[said_before:]
        utterance = replace(utterance, formal=formal, conversation=conversation)
        return replace(dialogue, turns=(*dialogue.turns, turn), conversation=conversation), utterance

    def _utterance(self, dialogue: Dialogue, turn: Turn) -> DialogueUtterance:
        text = text_of(self.phrasing, dialogue, turn)
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
    """Return the decision that a robot makes alone, with beliefs that it accepted earlier, or None."""
    if isinstance(facts, WhereFacts):
        return where(facts, told_beliefs(former)).decision
    return what(facts, told_beliefs(former)).decision


def _check(is_legal: bool, move: Move, speaker: Speaker) -> None:
    if not is_legal:
        raise ValueError(f"{move} of the {speaker} is not among the legal moves")


def _sensed(topic: DialogueTopic, conversation: Conversation) -> Conversation:
    """Return the conversation after the robot has looked at its evidence again, with the beliefs that it accepted.

    The person can then put forward reasons for and against the robot's new decision, and for and against the topic.
    """
    evidence, claim = evidence_of(topic, conversation), claim_of(topic)
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


def _is_settled(dialogue: Dialogue) -> bool:
    """Return True if the robot already holds the claim."""
    conversation = dialogue.conversation
    return conversation is not None and claim_of(dialogue.topic) in conversation.agents[Side.ROBOT].beliefs


def _about(dialogue: Dialogue, agreed: Literal) -> Dialogue:
    """Return the dialogue with a new topic: the decision that both sides agreed on in the end."""
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
