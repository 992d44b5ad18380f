"""Two sides that talk as they please, and the judge who listens."""

import random
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from tests.thbridge.dialogue.games.judge import IN_BRIEF, OPENING_WORDS, Judge, case, rival
from tests.thbridge.dialogue.games.random_talk import CLAIMS, GAMES, PROPOSITIONS, Start, random_start, random_topic
from thbridge.dialogue.argumentation.beliefs import Origin, Source
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal, Rule
from thbridge.dialogue.games.contents import Content, DialogueMove, Unknown
from thbridge.dialogue.games.control import Conversation, IllegalMoveError, Opening
from thbridge.dialogue.games.tables import DialogueEnd
from thbridge.files.game_files import read_rulebook

RULEBOOK = read_rulebook()
RANDOM = st.randoms(use_true_random=False)
Step = Callable[[Conversation], Conversation]


def as_text(now: Conversation) -> str:
    """All that a conversation holds, whatever the order of its sets."""
    lines = [str(said) for said in now.record]
    lines += [f"{play.number} {play.stage} {play.claim} {play.end} {now.legal(play.number)}" for play in now.plays]
    for agent in now.agents.values():
        picture = agent.picture
        lines += [str(dict(agent.beliefs.origins)), str(agent.beliefs.rules), str(agent.store)]
        lines += [str(sorted(map(str, each))) for each in (picture.held, picture.rules, picture.unknown)]
        lines += [str(sorted(map(str, each))) for each in (picture.arguments, picture.argued)]
    return "\n".join(lines)


def judged(now: Conversation, judge: Judge) -> None:
    """Books, turns, legal moves and ends are those of the judge."""
    for side, party in judge.parties.items():
        agent, picture = now.agents[side], now.agents[side].picture
        assert set(agent.beliefs.origins) == party.sigma
        assert {each for each, origin in agent.beliefs.origins.items() if not origin.is_evidence} == party.decided
        assert set(agent.beliefs.rules) == party.rules
        assert agent.store == party.said
        assert picture.held == party.gamma
        assert picture.unknown == party.gamma_unknown
        assert picture.rules == party.gamma_rules
        assert picture.arguments == party.gamma_arguments
        assert picture.argued == party.gamma_argued
    assert len(now.plays) == len(judge.talks)
    for play, talk in zip(now.plays, judge.talks, strict=True):
        assert play.moves == talk.lines
        assert play.end == talk.end
        assert (play is now.refused) <= (talk.refused is not None)
        legal = now.legal(play.number)
        assert set(legal) == judge.legal(talk)
        assert len(set(legal)) == len(legal)
        assert now.waits(play.number) is judge.waits(talk)
        assert play.end is not None or play.speaker is judge.turn(talk)
    booked = sum(talk.booked for talk in judge.talks)
    assert sum(said.is_booked for said in now.record) == booked


class Talking(RuleBasedStateMachine):
    """Two sides that open dialogues, speak, sense something and give up, as they please."""

    @initialize(rng=RANDOM)
    def meet(self, rng: random.Random) -> None:
        self.start: Start = random_start(rng, RULEBOOK)
        self.now, self.judge = self.start.conversation, self.start.judge
        self.steps: list[Step] = []
        self.seen = [(self.now, as_text(self.now))]
        judged(self.now, self.judge)

    def step(self, step: Step, judge: Judge) -> None:
        before = self.now
        self.now, self.judge = step(before), judge
        self.steps.append(step)
        self.seen.append((self.now, as_text(self.now)))
        for side, agent in self.now.agents.items():
            assert agent.store[: len(before.agents[side].store)] == before.agents[side].store
        judged(self.now, self.judge)

    def say(self, number: int, move: DialogueMove) -> None:
        self.step(lambda now: now.say(number, move), self.judge.after(number, move))

    @rule(rng=RANDOM)
    def open_what_a_side_likes(self, rng: random.Random) -> None:
        side, game, topic = rng.choice(list(Side)), rng.choice(GAMES), random_topic(rng, self.now)
        if self.now.plays and rng.random() < 0.4:
            former = rng.choice(self.now.plays)
            side, game, topic = former.initiator, former.game.name, former.topic
            if isinstance(topic, Literal) and rng.random() < 0.4:
                # The opposite, or by the other side, or in another game: the same matter.
                side, game, topic = rng.choice(list(Side)), rng.choice(GAMES), rng.choice([topic, ~topic])
        parent = self.some_parent(rng, side)
        openings = self.now.opening(side, game, topic, parent)
        fresh = self.judge.fresh(side, game, topic, parent)
        assert len(openings) == (fresh is not None)
        if fresh is not None:
            (opening,) = openings
            self.step(lambda now: now.open(side, opening, parent=parent), self.judge.opened(fresh))
        else:
            word = OPENING_WORDS[game.removesuffix(IN_BRIEF)]
            with pytest.raises(IllegalMoveError):
                self.now.open(side, Opening(game, topic, DialogueMove(word, topic)), parent=parent)

    @rule(rng=RANDOM)
    def open_what_the_nine_cases_call_for(self, rng: random.Random) -> None:
        side, proposition = rng.choice(list(Side)), rng.choice(PROPOSITIONS)
        parent = self.some_parent(rng, side)
        openings = self.now.openings(side, proposition, parent)
        wanted = {(game, topic) for game, topic in self.called_for(side, proposition)}
        fresh = {each: self.judge.fresh(side, *each, parent) for each in wanted}
        assert {(each.game, each.topic) for each in openings} == {each for each, talk in fresh.items() if talk}
        if openings:
            opening = rng.choice(openings)
            talk = fresh[opening.game, opening.topic]
            assert talk is not None
            self.step(lambda now: now.open(side, opening, parent=parent), self.judge.opened(talk))

    def some_parent(self, rng: random.Random, side: Side) -> int | None:
        """None, or a dialogue that may or may not be one in which this side can open another."""
        fit = [play.number for play in self.now.open_plays if play.speaker is side]
        return rng.choice([None, *fit, *fit, *fit, *(play.number for play in self.now.plays[-2:])])

    def called_for(self, side: Side, proposition):
        robot = self.judge.parties[Side.ROBOT]
        kind, openers = case(robot, proposition)
        yes = Literal(proposition)
        if side not in openers:
            return []
        if kind == "inquiry" and proposition in self.judge.able[rival(side)]:
            return [("information-seeking", yes)]
        if kind == "inquiry":
            return [("inquiry", each) for each in self.proposals(side, yes)]
        robot_for = robot.holds(yes)
        return [(kind, yes if kind != "persuasion" or robot_for == (side is Side.ROBOT) else ~yes)]

    def proposals(self, side: Side, yes: Literal) -> list[Rule]:
        """Rules that a side holds, and those from what it holds to what it can argue for."""
        beliefs = self.now.agents[side].beliefs
        rules = [each for each in beliefs.rules if each.conclusion in {yes, ~yes}]
        for conclusion in (yes, ~yes):
            for argument in self.judge.parties[side].arguments(conclusion):
                held = tuple(each for each in beliefs.origins if each in argument.support - {conclusion})
                if held and not any((set(each.premises), each.conclusion) == (set(held), conclusion) for each in rules):
                    rules.append(Rule(held, conclusion))
        return rules

    @precondition(lambda self: self.now.refused is not None)
    @rule(rng=RANDOM)
    def question_a_no(self, rng: random.Random) -> None:
        outer = self.now.refused
        assert outer is not None and outer.defender is not None and outer.in_question is not None
        number, topic = outer.number, outer.in_question
        # Most others would not be legal.
        side = rng.choice([*Side, outer.defender, outer.defender])
        game = rng.choice([*GAMES, "information-seeking", "information-seeking-in-brief"])
        openings, fresh = self.now.opening(side, game, topic, number), self.judge.fresh(side, game, topic, number)
        assert len(openings) == (fresh is not None)
        if fresh is not None:
            (opening,) = openings
            self.step(lambda now: now.open(side, opening, parent=number), self.judge.opened(fresh))

    @precondition(lambda self: self.now.open_plays)
    @rule(rng=RANDOM, count=st.integers(1, 8), argues=st.booleans())
    def speak(self, rng: random.Random, count: int, argues: bool) -> None:
        for _ in range(count):
            ready = [play.number for play in self.now.open_plays if not self.now.waits(play.number)]
            # A no can be questioned only at once.
            if not ready or (self.now.refused is not None and rng.random() < 0.7):
                return
            number = rng.choice(ready)
            legal = self.now.legal(number)
            assert legal, "a dialogue that goes on has a legal move"
            for move in legal:
                self.now.say(number, move)
            # Support is heard only if somebody wants to hear it.
            patient = [move for move in legal if move.locution == "challenge"]
            patient = patient or [move for move in legal if move.locution != "reject"]
            chosen = rng.choice(patient if argues and patient and rng.random() < 0.8 else legal)
            self.say(number, chosen)

    @precondition(lambda self: self.now.plays)
    @rule(rng=RANDOM)
    def say_what_is_illegal(self, rng: random.Random) -> None:
        number = rng.randint(0, len(self.now.plays) + 1)
        word = rng.choice(["assert", "challenge", "question", "propose", "accept", "reject"])
        topics: list[Content] = [random_topic(rng, self.now), Unknown(rng.choice(PROPOSITIONS))]
        topics += [move.content for agent in self.now.agents.values() for move in agent.store]
        move = DialogueMove(word, rng.choice(topics))
        exists = 0 < number <= len(self.now.plays)
        if not exists or move not in self.judge.legal(self.judge.talks[number - 1]):
            with pytest.raises(IllegalMoveError):
                self.now.say(number, move)

    @rule(rng=RANDOM)
    def sense(self, rng: random.Random) -> None:
        side, literal = rng.choice(list(Side)), rng.choice(CLAIMS)

        def step(now: Conversation) -> Conversation:
            agent = now.agents[side]
            return now.with_agent(replace(agent, beliefs=agent.beliefs.gaining(literal, Origin(Source.SENSED))))

        parties = {**self.judge.parties, side: self.judge.parties[side].believing(literal)}
        self.step(step, replace(self.judge, parties=parties).settled())

    @precondition(lambda self: self.now.open_plays)
    @rule(rng=RANDOM)
    def withdraw(self, rng: random.Random) -> None:
        number = rng.choice([play.number for play in self.now.open_plays])
        self.step(lambda now: now.withdraw(number), self.judge.withdrawn(number).settled())

    @invariant()
    def what_the_paper_promises_of_every_dialogue(self) -> None:
        for play in getattr(self, "now", Conversation(RULEBOOK, {})).plays:
            keeps_promises(self.now, play.number)

    def teardown(self) -> None:
        if not hasattr(self, "now"):
            return
        while self.now.open_plays:
            number = next(play.number for play in self.now.open_plays if not self.now.waits(play.number))
            move = self.now.legal(number)[-1]
            self.say(number, move)
        # A table's greatest length is for games of other people; these end by themselves.
        assert all(len(play.moves) < play.game.most_turns for play in self.now.plays)
        assert all(as_text(then) == text for then, text in self.seen)
        again = self.start.conversation
        for step in self.steps:
            again = step(again)
        assert again == self.now


def keeps_promises(now: Conversation, number: int) -> None:
    """What can be seen of a dialogue from outside, without keeping books."""
    play = now.play(number)
    said = [each for each in now.record if each.dialogue == number]
    assert [(each.side, each.move) for each in said] == list(play.moves)
    assert [each.index for each in said] == list(range(len(said)))
    assert len(set(play.moves)) == len(said), "nothing is said twice"
    spoken = [each for each in said if not each.is_booked]
    asked = [each for each in now.plays if each.parent == number and each.questions_refusal]
    refusals = [each for each in spoken if each.move.locution == "reject"]
    assert len(asked) <= 1 and len(refusals) <= 1 + len(asked)
    for one, other in pairwise(spoken):
        keeps_turn = not isinstance(one.move.content, Literal | Rule | Unknown) or one in refusals
        assert one.side is not other.side or keeps_turn
    words = [each.move.locution for each in said]
    match play.end:
        case DialogueEnd.AGREEMENT:
            claims = [each for each in said[:2] if each.move.locution in {"assert", "propose"}]
            assert words[-1] == "accept"
            assert said[-1].move.content == claims[-1].move.content
            assert said[-1].side is not claims[-1].side
        case DialogueEnd.DISAGREEMENT:
            assert words[-1] == "reject"
        case DialogueEnd.UNKNOWN:
            assert isinstance(said[-1].move.content, Unknown)
        case DialogueEnd.STALEMATE | DialogueEnd.WITHDRAWN | None:
            assert words[-1] != "reject" or (play.end is None and asked)
    if play.end is not None:
        assert now.legal(number) == ()


def talk(seed: int) -> None:
    """A conversation that a seed decides: more varied than those that are made to be made simpler."""
    rng, sides = random.Random(seed), Talking()
    sides.meet(rng=rng)
    for _ in range(25):
        step = rng.choices(["like", "call for", "speak", "illegal", "sense", "withdraw"], [20, 20, 35, 10, 7, 3])[0]
        if sides.now.refused is not None and rng.random() < 0.8:
            sides.question_a_no(rng=rng)
        elif step == "like":
            sides.open_what_a_side_likes(rng=rng)
        elif step == "call for":
            sides.open_what_the_nine_cases_call_for(rng=rng)
        elif step == "sense":
            sides.sense(rng=rng)
        elif step == "illegal" and sides.now.plays:
            sides.say_what_is_illegal(rng=rng)
        elif step == "speak" and sides.now.open_plays:
            sides.speak(rng=rng, count=rng.randint(1, 8), argues=rng.random() < 0.5)
        elif step == "withdraw" and sides.now.open_plays:
            sides.withdraw(rng=rng)
        sides.what_the_paper_promises_of_every_dialogue()
    sides.teardown()
