from dataclasses import replace

import pytest
from msgspec import structs

from tests.support.hunts.participant_views import view_of
from thbridge.hunt.events import Condition
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.bots import MAX_ATTEMPTS, MOST_TALKS, Bot, TreasureKnowledge
from thbridge.roles.shared.view import (
    AnswerDialogue,
    Consent,
    DialogueView,
    EndGame,
    RefusalView,
    RequestSuggestion,
    SelectRoom,
    SendRobot,
    View,
)


def bot(strategy: BotStrategy) -> Bot:
    return Bot(strategy, TreasureKnowledge((), {}), seed=1)


@pytest.mark.parametrize(
    ("strategy", "first"), [(BotStrategy.SUGGESTION, RequestSuggestion(0)), (BotStrategy.NEAREST, SelectRoom(0, 1))]
)
def test_a_room_that_was_missed_is_left_for_last(strategy, first):
    player = bot(strategy)
    assert list(player.requests(view_of(None))) == [first]
    for missed, then in ((1, 3), (3, 2), (2, 1)):
        assert list(player.requests(view_of(missed))) == []
        assert list(player.requests(view_of(None))) == [SelectRoom(0, then)]
    for missed in (1, 3, 2, 1, 3, 2):
        player.requests(view_of(missed))
    assert list(player.requests(view_of(None))) == [EndGame(1)]


def test_what_one_robot_missed_another_may_reach():
    player = bot(BotStrategy.NEAREST)
    player.requests(view_of(1, 3))
    player.requests(view_of(None, 3))
    visited = replace(view_of(None, None).rooms[2], state="visited", robot=1)
    arrived = view_of(None, None)
    arrived = structs.replace(arrived, rooms=(*arrived.rooms[:2], visited))
    assert list(player.requests(arrived)) == [SelectRoom(0, 2), SelectRoom(1, 1)]


def in_condition(view: View, *conditions: Condition) -> View:
    robots = tuple(replace(robot, condition=c) for robot, c in zip(view.robots, conditions, strict=True))
    return structs.replace(view, robots=robots)


def test_a_robot_that_does_not_answer_is_asked_nothing_until_it_does():
    player = bot(BotStrategy.NEAREST)
    assert list(player.requests(in_condition(view_of(None, None), Condition.SILENT, Condition.WELL))) == [
        SelectRoom(1, 1)
    ]
    assert list(player.requests(in_condition(view_of(None, 1), Condition.SILENT, Condition.WELL))) == []
    assert list(player.requests(view_of(None, 1))) == [SelectRoom(0, 3)]


def test_the_game_is_given_up_when_no_robot_answers():
    assert list(bot(BotStrategy.NEAREST).requests(in_condition(view_of(None), Condition.SILENT))) == [EndGame(1)]


def test_a_robot_that_stays_lost_is_sent_once_and_again_when_it_is_found():
    player = bot(BotStrategy.NEAREST)
    lost = in_condition(view_of(None), Condition.LOST)
    assert list(player.requests(lost)) == [SelectRoom(0, 1)]
    player.requests(in_condition(view_of(1), Condition.LOST))
    assert list(player.requests(lost)) == [EndGame(1)]
    assert list(player.requests(view_of(None))) == [SelectRoom(0, 3)]


def talk_of(view: View, room: int, number: int) -> View:
    talk = DialogueView(number, 1, 0, "select-room", room, ("No.",), ("Leave it.",), ("leave",), ("robot",))
    return structs.replace(view, dialogues=(talk,))


def test_after_talks_in_vain_another_room_is_named_then_advice_is_taken_and_at_last_the_robot_is_left_alone():
    player, still = bot(BotStrategy.NEAREST), view_of(None)
    asked = []
    for number in range(1, MOST_TALKS + 1):
        (request,) = player.requests(still)
        asked.append(request)
        player.requests(talk_of(still, 1, number))
    advice = RequestSuggestion(0)
    assert asked == [SelectRoom(0, 1), SelectRoom(0, 1), SelectRoom(0, 3), SelectRoom(0, 3), advice, advice]
    assert list(player.requests(still)) == [EndGame(1)]


def test_a_robot_that_has_driven_is_talked_to_as_before():
    player, still = bot(BotStrategy.NEAREST), view_of(None)
    for number in range(1, MOST_TALKS + 1):
        player.requests(still)
        player.requests(talk_of(still, 1, number))
    player.requests(view_of(2))
    assert list(player.requests(still)) == [SelectRoom(0, 1)]


def test_a_refused_talk_counts_as_one_in_vain():
    player, still = bot(BotStrategy.NEAREST), view_of(None)
    for number in (1, 2):
        assert list(player.requests(still)) == [SelectRoom(0, 1)]
        still = structs.replace(still, refusal=RefusalView(number, "select-room", "no-consensus", "All is said."))
    assert list(player.requests(still)) == [SelectRoom(0, 3)]


def test_a_room_given_up_is_not_driven_to_on_anybodys_advice():
    player, still = bot(BotStrategy.NEAREST), view_of(None)
    for _ in range(MAX_ATTEMPTS):
        player.requests(view_of(1))
        player.requests(still)
    suggestion = DialogueView(
        1, 1, 0, "select-room", 1, ("Room 1?",), ("Yes.", "Leave it."), ("accept", "leave"), ("robot",)
    )
    assert list(player.requests(structs.replace(still, dialogues=(suggestion,)))) == [AnswerDialogue(1, 1, 1)]
    agreed = structs.replace(still, consents=(Consent(0, "select-room", 1),))
    assert SendRobot(0, 1) not in player.requests(agreed)
