from dataclasses import replace

import pytest
from msgspec import structs

from tests.support.hunts.participant_views import asking, refusal, view, with_robot, with_room
from thbridge.files.language_texts import shipped_texts
from thbridge.roles.shared.view import (
    AnswerDialogue,
    Consent,
    EndGame,
    GiveConsent,
    LeaveTreasure,
    OpenDialogue,
    PlayAgain,
    RequestSuggestion,
    SelectRoom,
    StopRobot,
    TakeUpTreasure,
)
from ui.model.playing.memory.pending import PendingRequests

STANDING = with_room(
    with_robot(view(), 0, place=3), 3, state="visited", robot=0, sensed={"colour": "Pink", "footprint": "Square"}
)
UNDER_WAY = with_room(with_robot(view(), 0, moving_to=3), 3, state="reserved", robot=0)


@pytest.mark.parametrize(
    ("wanted", "before", "granted"),
    [
        (GiveConsent(), view(consent="Do you?"), view()),
        (SelectRoom(0, 3), view(), view(dialogues=(asking(0, 3),))),
        (SelectRoom(0, 3), view(), view(consents=(Consent(0, "select-room", 3),))),
        (SelectRoom(0, 3), view(dialogues=(asking(0, 2),)), view(dialogues=(asking(0, 3, 2),))),
        (SelectRoom(0, 3), view(), UNDER_WAY),
        (RequestSuggestion(0), view(), view(dialogues=(asking(0, 3),))),
        (RequestSuggestion(0), view(dialogues=(asking(0, 2, 1),)), view(dialogues=(asking(0, 2, 2),))),
        (
            RequestSuggestion(0),
            view(dialogues=(asking(0, 2, 1),)),
            view(dialogues=(replace(asking(0, 2, 1), suggested=True),)),
        ),
        (AnswerDialogue(1, 1, 0), view(dialogues=(asking(0, 3),)), view(dialogues=(asking(0, 3, 1, 3),))),
        (AnswerDialogue(1, 1, 0), view(dialogues=(asking(0, 3),)), view()),
        (StopRobot(0), UNDER_WAY, view()),
        (LeaveTreasure(3), STANDING, with_room(STANDING, 3, left=True)),
        (TakeUpTreasure(3), with_room(STANDING, 3, left=True), STANDING),
        (OpenDialogue(0, "take-picture", 3), STANDING, with_room(STANDING, 3, picture="a.jpg")),
        (
            OpenDialogue(0, "take-picture", 3),
            STANDING,
            structs.replace(STANDING, consents=(Consent(0, "take-picture", 3),)),
        ),
        (EndGame(1), view(), view(over="given-up")),
        (PlayAgain(1), view(over="given-up"), view(game=2)),
    ],
)
def test_a_request_is_kept_until_the_view_shows_it_granted(wanted, before, granted):
    pending = PendingRequests()
    pending.ask(wanted, before)
    assert pending.receive(shipped_texts(), before) == ()
    assert pending.requests == (wanted,)
    assert pending.receive(shipped_texts(), granted) == ()
    assert pending.requests == ()


@pytest.mark.parametrize(
    ("wanted", "before", "kind"),
    [
        (SelectRoom(0, 3), view(), "select-room"),
        (RequestSuggestion(0), view(), "Unsure"),
        (RequestSuggestion(0), view(), "select-room"),
        (OpenDialogue(0, "take-treasure", 3), STANDING, "take-treasure"),
        (LeaveTreasure(3), STANDING, "Leave"),
        (StopRobot(0), UNDER_WAY, "CallBack"),
    ],
)
def test_a_refusal_ends_the_request_it_is_about_and_no_other(wanted, before, kind):
    pending = PendingRequests()
    pending.ask(wanted, before)
    pending.drop_refused(refusal(1, "SendRobot"))
    assert pending.requests == (wanted,)
    pending.drop_refused(refusal(2, kind))
    assert pending.requests == ()


def test_what_can_not_come_true_any_more_is_dropped_with_its_reason():
    pending = PendingRequests()
    pending.ask(SelectRoom(0, 3), view())
    taken = with_room(with_robot(view(), 1, moving_to=3), 3, state="reserved", robot=1)
    assert pending.receive(shipped_texts(), taken) == ("Robot 2 is on its way there.",)
    pending.ask(TakeUpTreasure(3), with_room(STANDING, 3, left=True))
    gone = with_robot(with_room(STANDING, 3, left=True), 0, moving_to=2)
    assert pending.receive(shipped_texts(), gone) == ("No robot is in this room.",)
    assert pending.requests == ()


def test_advice_is_given_by_a_new_dialogue_even_if_it_has_the_number_of_one_before_a_restart():
    pending = PendingRequests()
    pending.ask(RequestSuggestion(0), view(dialogues=(asking(0, 2),)))
    pending.receive(shipped_texts(), view(dialogues=(asking(0, 2),)))
    assert pending.requests == (RequestSuggestion(0),)
    pending.receive(shipped_texts(), view())
    pending.receive(shipped_texts(), view(dialogues=(asking(0, 2),)))
    assert pending.requests == ()


def test_a_robot_is_asked_to_go_to_one_place_at_a_time():
    pending = PendingRequests()
    for wanted in (SelectRoom(0, 3), SelectRoom(1, 2), RequestSuggestion(0), SelectRoom(0, 1)):
        pending.ask(wanted, view())
    assert pending.requests == (SelectRoom(1, 2), SelectRoom(0, 1))


def test_nothing_is_wanted_of_a_game_that_is_over_but_another_one():
    pending = PendingRequests()
    for wanted in (SelectRoom(0, 3), LeaveTreasure(3), PlayAgain(1)):
        pending.ask(wanted, STANDING)
    assert set(pending.receive(shipped_texts(), structs.replace(STANDING, over="given-up"))) <= {""}
    assert pending.requests == (PlayAgain(1),)
