"""Rules as topics: what argues for one, whole exchanges about some, and dialogues inside others that come to an end."""

import random
from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.dialogue.derivations import derives
from tests.thbridge.dialogue.games.dialogue_machine import judged, keeps_promises
from tests.thbridge.dialogue.games.judge import Fact, Judge, Party
from tests.thbridge.dialogue.games.random_talk import GAMES, random_start, random_topic
from tests.thbridge.dialogue.games.small_conversations import (
    HUMAN,
    IMPLIES,
    ROBOT,
    RULEBOOK,
    A,
    B,
    C,
    conversation,
    legal,
    opened,
    said,
    side,
)
from thbridge.dialogue.argumentation.arguments import Argument, Belief
from thbridge.dialogue.argumentation.cases import DialogueKind, Side
from thbridge.dialogue.argumentation.propositions import Literal, Rule
from thbridge.dialogue.examples import Exchange, jhri2015
from thbridge.dialogue.exchange_play import CourseFollower, acts, turn_in
from thbridge.dialogue.games.control import Conversation, Opening
from thbridge.dialogue.games.strategies import ArguingStrategy, Attitude
from thbridge.dialogue.games.tables import DialogueEnd, GameRole, GameStage, GameTable, Reply, Rulebook, Slot
from thbridge.dialogue.propositions import InImage
from thbridge.dialogue.rule_examples import rules_as_topics

D = Literal(Fact("d"))
FIRST, SECOND = Rule((A,), C), Rule((C,), B)
BOTH = Rule((A, D), B)


# Whole exchanges: both sides of the paper's example, and of three with rules as topics

TRANSCRIPTS = (
    """
    1 robot: propose(color_found(image3, brown) -> treasure_in(brown bottle, Room2))
    1 human: challenge(color_found(image3, brown) -> treasure_in(brown bottle, Room2))
    1 robot: propose(color_found(image3, brown) -> in_image(bottle, image3))
    1 human: accept(color_found(image3, brown) -> in_image(bottle, image3))
    1 robot: propose(in_image(bottle, image3) -> treasure_in(brown bottle, Room2))
    1 human: accept(in_image(bottle, image3) -> treasure_in(brown bottle, Room2))
    1 human: accept(color_found(image3, brown) -> treasure_in(brown bottle, Room2)), which follows
    1 agreement
    """,
    """
    1 human: propose(in_image(bottle, image2) -> treasure_in(blue bottle, Room1))
    1 robot: challenge(in_image(bottle, image2) -> treasure_in(blue bottle, Room1))
    1 human: propose(color_found(image2, blue))
    1 robot: reject(in_image(bottle, image2) -> treasure_in(blue bottle, Room1))
    2 human: question(not color_found(image2, blue))
    2 robot: assert(not color_found(image2, blue))
    2 human: accept(not color_found(image2, blue))
    1 disagreement
    2 agreement
    """,
    """
    1 robot: question(in_image(bottle, image2))
    1 human: assert(in_image(bottle, image2))
    1 robot: accept(in_image(bottle, image2))
    2 robot: propose(in_image(bottle, image2) -> treasure_in(blue bottle, Room1))
    2 human: challenge(in_image(bottle, image2) -> treasure_in(blue bottle, Room1))
    3 human: propose(in_image(bottle, image2) and color_found(image2, blue) -> treasure_in(blue bottle, Room1))
    3 robot: accept(in_image(bottle, image2) and color_found(image2, blue) -> treasure_in(blue bottle, Room1))
    1 agreement
    2 stalemate
    3 agreement
    """,
)


def played(exchange: Exchange, seed: int = 0) -> Conversation:
    """Both sides play an exchange by its course; the judge follows every step."""
    now = exchange.start
    able = {HUMAN: frozenset(each for each in exchange.topics if isinstance(each, InImage))}
    parties = {
        each: Party.of(agent.beliefs, agent.picture, is_person=agent.is_person) for each, agent in now.agents.items()
    }
    judge = Judge(parties, able)
    judged(now, judge)
    followers = {each: CourseFollower(exchange, each, seed) for each in Side}
    while True:
        turn = turn_in(now)
        chosen = (
            (each, followers[each].choose(now, acts(exchange, now, each)))
            for each in Side
            if turn is None or each is turn[1]
        )
        who, act = next(((each, act) for each, act in chosen if act is not None), (ROBOT, None))
        if act is None:
            return now
        if act.opening is not None:
            fresh = judge.fresh(who, act.opening.game, act.opening.topic, act.number)
            assert fresh is not None
            judge = judge.opened(fresh)
        else:
            assert act.number is not None
            judge = judge.after(act.number, act.move)
        now = act.done(now, who)
        judged(now, judge)


def transcript(now: Conversation) -> list[str]:
    moves = [f"{each.dialogue} {each.side}: {each.move}{', which follows' * each.is_booked}" for each in now.record]
    return [*moves, *(f"{play.number} {play.end}" for play in now.plays)]


@pytest.mark.parametrize("number", range(3))
def test_an_exchange_about_rules_goes_as_it_is_written(number: int) -> None:
    now = played(rules_as_topics(RULEBOOK)[number])
    assert transcript(now) == [line.strip() for line in TRANSCRIPTS[number].strip().splitlines()]


@pytest.mark.parametrize("number", range(5))
def test_the_judge_follows_both_sides_of_the_worked_example(number: int) -> None:
    exchange = jhri2015(RULEBOOK)[number]
    for seed in range(8 if number == 2 else 1):
        said_there = [(each.side, str(each.move)) for each in played(exchange, seed).record if not each.is_booked]
        course = iter(exchange.course)
        assert all(any(who is each and text in texts for each, texts in course) for who, text in said_there)
        assert number == 2 or len(said_there) == len(exchange.course)


# What argues for a rule


def test_who_grants_the_premises_of_a_rule_has_not_accepted_it() -> None:
    now = conversation(side(ROBOT, [A], [IMPLIES]), side(HUMAN, is_person=True))
    now = said(opened(now, ROBOT, "persuasion", A), "accept(a)")
    now = said(opened(now, ROBOT, "inquiry", IMPLIES), "challenge(a -> b)", number=2)
    # The rule is all that the robot has for it, and has been said.
    assert now.play(2).end is DialogueEnd.STALEMATE
    assert IMPLIES not in now.agents[HUMAN].beliefs and B not in now.agents[ROBOT].beliefs


def test_a_rule_is_proposed_with_what_derives_it_part_by_part_and_the_last_part_implies_it() -> None:
    robot = side(ROBOT, [A], [FIRST, SECOND])
    now = opened(conversation(robot, side(HUMAN, is_person=True)), ROBOT, "inquiry", IMPLIES)
    assert A in now.agents[HUMAN].picture
    now = said(now, "challenge(a -> b)")
    assert legal(now) == {"propose(a -> c)", "propose(c -> b)"}
    # That the robot holds c is known to nobody, though it has said what would follow from it.
    second = said(now, "propose(c -> b)", "accept(c -> b)")
    assert B not in second.agents[HUMAN].picture and second.play(1).end is None
    now = said(now, "propose(a -> c)")
    assert legal(now) == {"accept(a -> c)", "reject(a -> b)"}
    now = said(now, "accept(a -> c)", "propose(c -> b)")
    refused = said(now, "reject(a -> b)")
    assert refused.play(1).end is DialogueEnd.DISAGREEMENT and IMPLIES not in refused.agents[HUMAN].beliefs
    # A rule has no opposite to ask about.
    assert refused.refused is None
    now = said(now, "accept(c -> b)")
    assert now.play(1).end is DialogueEnd.AGREEMENT
    assert [str(each.move) for each in now.record if each.is_booked] == ["accept(a -> b)"]
    assert IMPLIES in now.agents[HUMAN].beliefs and B in now.agents[ROBOT].beliefs
    # She was never shown to hold a.
    assert B in now.agents[HUMAN].picture and B not in now.agents[ROBOT].picture


def test_support_of_a_rule_may_be_a_literal_which_is_questioned_if_it_is_refused() -> None:
    now = conversation(side(ROBOT, [~D]), side(HUMAN, [A, D], [BOTH, IMPLIES], is_person=True))
    now = said(opened(now, HUMAN, "inquiry", IMPLIES), "challenge(a -> b)")
    assert legal(now) == {"propose(d)", "propose(a and d -> b)"}
    now = opened(said(now, "propose(d)", "reject(a -> b)"), HUMAN, "information-seeking", ~D, 1)
    now = said(now, "assert(not d)", "accept(not d)", number=2)
    assert [play.end for play in now.plays] == [DialogueEnd.DISAGREEMENT, DialogueEnd.AGREEMENT]


def test_what_may_be_proposed_follows_from_what_is_held() -> None:
    now = conversation(side(ROBOT, [A, D], [FIRST, SECOND, BOTH]), side(HUMAN, is_person=True))
    assert now.case(B.proposition).kind is DialogueKind.INQUIRY
    # Nobody proposes what follows from c, which the robot only could derive; a -> b it need not hold as a rule.
    assert [str(each.move) for each in now.openings(ROBOT, B.proposition)] == [
        "propose(a and d -> b)",
        "propose(a -> b)",
    ]
    assert now.opening(ROBOT, "inquiry", Rule((D,), B)) != ()
    assert now.opening(ROBOT, "inquiry", Rule((D,), ~C)) == ()


@pytest.mark.parametrize("rules", [[IMPLIES], [FIRST, SECOND]])
def test_who_can_argue_for_a_rule_does_not_reject_it(rules: list[Rule]) -> None:
    human = side(HUMAN, [A, D], [BOTH, IMPLIES], is_person=True)
    for own, answers in ((rules, {"accept(d)"}), ([], {"accept(d)", "reject(a -> b)"})):
        now = opened(conversation(side(ROBOT, [], own), human), HUMAN, "inquiry", IMPLIES)
        if IMPLIES in own:
            assert legal(now) == {"accept(a -> b)"}
        else:
            assert legal(said(now, "challenge(a -> b)", "propose(d)")) == answers


def test_attitudes_weigh_a_rule_as_they_weigh_anything() -> None:
    def answers(holds: list[Literal], rules: list[Rule]) -> list[str]:
        human = side(HUMAN, [A, D], [BOTH, IMPLIES], is_person=True)
        now = opened(conversation(side(ROBOT, holds, rules), human), HUMAN, "inquiry", IMPLIES)
        return [ArguingStrategy(attitude).choose(now, 1).locution for attitude in Attitude]

    assert list(Attitude) == [Attitude.CREDULOUS, Attitude.CAUTIOUS, Attitude.SCEPTICAL]
    assert answers([], []) == ["accept", "challenge", "challenge"]
    assert answers([], [FIRST, SECOND]) == ["accept", "accept", "accept"]
    # An example to the contrary stands against a rule.
    assert answers([A, ~B], []) == ["challenge", "challenge", "challenge"]
    assert answers([~B], []) == ["accept", "challenge", "challenge"]


def about_rules() -> Rulebook:
    """The shipped games, and a persuasion about rules in which the argument is announced."""
    opening = GameStage(GameRole.INITIATOR, (Reply("assert", Slot.TOPIC, "claimed"),))
    answers = (Reply("accept", Slot.CLAIM, "agreement"), Reply("challenge", Slot.CLAIM, "challenged"))
    claimed = GameStage(GameRole.RESPONDENT, answers)
    challenged = GameStage(GameRole.DEFENDER, (Reply("assert", Slot.ARGUMENT, "announced", last="weighed"),))
    announced = GameStage(GameRole.DEFENDER, (Reply("assert", Slot.SUPPORT, "offered"),))
    accepts = Reply("accept", Slot.SUPPORT, "announced", last="agreement")
    offered = GameStage(GameRole.CHALLENGER, (accepts, Reply("reject", Slot.CLAIM, "disagreement")))
    weighs = (Reply("accept", Slot.CLAIM, "agreement"), Reply("reject", Slot.CLAIM, "disagreement"))
    stages = {
        "opening": opening,
        "claimed": claimed,
        "challenged": challenged,
        "announced": announced,
        "offered": offered,
        "weighed": GameStage(GameRole.CHALLENGER, weighs),
    }
    table = GameTable("persuasion-about-rules", "rule", "opening", stages)
    return Rulebook(RULEBOOK.locutions, {**RULEBOOK.games, table.name: table})


def test_in_a_game_about_rules_the_argument_for_one_is_announced_and_gives_its_parts() -> None:
    agents = {ROBOT: side(ROBOT, [], [FIRST, SECOND, IMPLIES]), HUMAN: side(HUMAN, is_person=True)}
    now = opened(Conversation(about_rules(), agents), ROBOT, "persuasion-about-rules", IMPLIES)
    now = said(now, "challenge(a -> b)")
    assert legal(now) == {"assert({a -> b}, a -> b)", "assert({a -> c, c -> b}, a -> b)"}
    # A rule that is held is weighed, as an observation is.
    itself = said(now, "assert({a -> b}, a -> b)")
    assert legal(itself) == {"accept(a -> b)", "reject(a -> b)"}
    now = said(now, "assert({a -> c, c -> b}, a -> b)")
    assert Argument(frozenset([FIRST, SECOND]), IMPLIES) in now.agents[HUMAN].picture.arguments
    now = said(now, "assert(a -> c)", "accept(a -> c)", "assert(c -> b)", "accept(c -> b)")
    assert now.play(1).end is DialogueEnd.AGREEMENT and IMPLIES in now.agents[HUMAN].beliefs


# Dialogues inside others

PERSUADING = conversation(side(ROBOT, [B], hers=[~B]), side(HUMAN, [~B], hers=[], is_person=True))


def test_no_dialogue_inside_another_makes_up_for_a_reply_that_was_used_up() -> None:
    now = said(
        opened(PERSUADING, ROBOT, "persuasion", B),
        "assert(not b)",
        "challenge(not b)",
        "assert({not b}, not b)",
        "reject(not b)",
    )
    now = opened(now, ROBOT, "persuasion", B)
    assert legal(now, 2) == {"accept(b)", "challenge(b)"}
    assert now.openings(HUMAN, B.proposition, parent=2) == now.openings(HUMAN, B.proposition) == ()
    for game in GAMES:
        for topic in (B, ~B, IMPLIES, Rule((A,), ~B)):
            assert now.opening(HUMAN, game, topic, 2) == now.opening(HUMAN, game, topic) == ()
    # Nor does the same dialogue in brief.
    now = said(now, "challenge(b)", "assert({b}, b)", "reject(b)", number=2)
    now = opened(now, ROBOT, "persuasion-in-brief", B)
    assert legal(now, 3) == {"accept(b)"}


@pytest.mark.parametrize(("game", "topic"), [("information-seeking", B), ("inquiry", IMPLIES)])
def test_a_question_or_a_proposal_is_answered_in_its_dialogue_and_not_by_another_one(game: str, topic: Belief) -> None:
    people = (side(ROBOT, is_person=True), side(HUMAN, is_person=True))
    now = opened(conversation(*people), ROBOT, game, topic)
    for other in GAMES:
        for each in (B, ~B, IMPLIES, Rule((A,), ~B), Rule((C,), ~B)):
            assert now.opening(HUMAN, other, each, 1) == ()
    # About something else another may be opened, which bars its own matter likewise.
    now = opened(now, HUMAN, "persuasion", ~A, 1)
    assert now.opening(ROBOT, "persuasion", A, 2) == now.opening(ROBOT, game, topic, 2) == ()


@pytest.mark.parametrize("game", ["persuasion", "information-seeking"])
def test_inside_one_dialogue_a_side_opens_the_same_one_once(game: str) -> None:
    people = (side(ROBOT, is_person=True), side(HUMAN, is_person=True))
    now = opened(conversation(*people), ROBOT, "persuasion", B)
    now = said(opened(now, HUMAN, game, A, 1), f"{'accept' if game == 'persuasion' else 'assert'}(a)", number=2)
    if game == "information-seeking":
        now = said(now, "accept(a)", number=2)
    assert now.play(2).end is DialogueEnd.AGREEMENT and not now.waits(1)
    assert now.opening(HUMAN, game, A, 1) == ()
    # After the one that waited she may.
    assert said(now, "accept(b)").opening(HUMAN, "persuasion", A) != ()


def everything_inside(now: Conversation, topics: list[Belief]) -> Iterator[tuple[Side, Opening, int]]:
    """All that may be opened inside dialogues that go on."""
    for play in now.open_plays:
        for topic in topics:
            for game in GAMES:
                for opening in now.opening(play.speaker, game, topic, play.number):
                    yield play.speaker, opening, play.number


def ends_with_all_inside(rng: random.Random) -> None:
    """A random dialogue ends though others are opened inside it whenever that is legal."""
    people = rng.random() < 0.5
    now = conversation(
        side(ROBOT, rng.choices([A, ~A, B], k=2), [IMPLIES], is_person=people), side(HUMAN, [B], is_person=True)
    )
    topics: list[Belief] = [A, ~A, B, ~B, C, IMPLIES, Rule((C,), B)]
    openings = [
        (who, opening)
        for who in Side
        for game in GAMES
        for topic in topics
        for opening in now.opening(who, game, topic)
    ]
    if not openings:
        return
    now = now.open(*rng.choice(openings))
    for _ in range(2000):
        if not now.open_plays:
            break
        if inside := list(everything_inside(now, topics)):
            who, opening, parent = rng.choice(inside)
            now = now.open(who, opening, parent=parent)
        else:
            number = next(play.number for play in now.open_plays if not now.waits(play.number))
            now = now.say(number, rng.choice(now.legal(number)))
    assert not now.open_plays
    for play in now.plays:
        keeps_promises(now, play.number)
        inside_it = [each.moves[0] for each in now.plays if each.parent == play.number]
        assert len(set(inside_it)) == len(inside_it)


@pytest.mark.parametrize("seed", range(6))
def test_a_dialogue_ends_though_others_are_opened_inside_it_whenever_that_is_legal(seed: int) -> None:
    ends_with_all_inside(random.Random(seed))


@pytest.mark.slow
@settings(max_examples=300)
@given(st.randoms(use_true_random=False))
def test_any_dialogue_ends_though_others_are_opened_inside_it_whenever_that_is_legal(rng: random.Random) -> None:
    ends_with_all_inside(rng)


@given(st.randoms(use_true_random=False))
def test_an_accepted_rule_was_not_challenged_or_was_argued_for_as_a_rule(rng: random.Random) -> None:
    now = random_start(rng, RULEBOOK).conversation
    for _ in range(30):
        who, topic = rng.choice(list(Side)), random_topic(rng, now)
        for opening in now.opening(who, "inquiry", topic):
            now = now.open(who, opening)
            break
    for play in now.open_plays:
        topic = play.topic
        assert isinstance(topic, Rule) and play.defender is not None
        while (play := now.play(play.number)).end is None:
            before, moves = now, now.legal(play.number)
            patient = [move for move in moves if move.locution != "reject"]
            now = now.say(
                play.number, rng.choice([move for move in patient if move.locution == "challenge"] or patient or moves)
            )
        if play.end is DialogueEnd.AGREEMENT and play.offered:
            known = before.agents[play.defender]
            assert not set(play.offered) & set(topic.premises)
            language = {rule for rule in known.beliefs.rules if not rule.is_said}
            given_or_known = frozenset({*play.offered, *known.picture.held, *known.picture.rules, *language})
            granted = frozenset(part for premise in topic.premises for part in (premise, *premise.parts))
            assert derives(given_or_known, topic.conclusion, granted)
            accepted = {move.content for who, move in play.moves if move.locution == "accept"}
            assert {*play.offered, topic} <= accepted
