"""Advice in a game: said to the participant, recorded for the researcher with what the participant is not told."""

import msgspec
import pytest

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator
from tests.support.hunts.scripted_hunt import WIZARD_ON, ScriptedPlayer, WizardHunt, arguing_engine
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.hunt.events import RoomAdvised
from thbridge.roles.keeper.advice.adviser import Adviser
from thbridge.roles.participant.tabui import RETRY_PERIOD, TabUI
from thbridge.roles.shared.robot_requests import WizardAdvice
from thbridge.roles.shared.view import AnswerDialogue, ParticipantRequest, RequestSuggestion, View

UNSURE = RequestSuggestion(0)
ERRING = Adviser(error_rate=1.0, says_confidence=True, confidence_bias=0.8)


def advised(hunt: HuntWithoutSimulator) -> list[RoomAdvised]:
    return [event for event in hunt.log.events if isinstance(event, RoomAdvised)]


def test_advice_that_errs_is_recorded_as_such_and_shown_as_any_other() -> None:
    oz = WizardHunt(adviser=ERRING)
    view = oz.wish(UNSURE)
    (event,) = advised(oz.hunt)
    (dialogue,) = view.dialogues
    assert (event.robot, event.room.people, event.advice) == (0, dialogue.room, 1)
    assert event.erred and event.planned != event.room and event.confidence == 0.8
    assert dialogue.said[0].startswith("I am 80% sure of my suggestion. ")
    assert "erred" not in msgspec.json.encode(view).decode()
    assert not any("planned" in line or "erred" in line for line in oz.hunt.lines)


def test_without_a_word_from_the_study_advice_is_as_planned_and_says_no_confidence() -> None:
    oz = WizardHunt()
    (dialogue,) = oz.wish(UNSURE).dialogues
    (event,) = advised(oz.hunt)
    assert (event.room, event.erred, event.confidence) == (event.planned, False, None)
    assert "sure" not in dialogue.said[0]


def test_advice_asked_for_again_before_it_is_answered_is_the_same_advice() -> None:
    oz = WizardHunt(adviser=Adviser(error_rate=0.5))
    rooms = set()
    for _ in range(8):
        (dialogue,) = oz.wish(UNSURE).dialogues
        rooms.add(dialogue.room)
    assert len(rooms) == 1
    assert {event.advice for event in advised(oz.hunt)} == {1}
    oz.wish(AnswerDialogue(dialogue.dialogue, 1, 1))
    oz.wish(UNSURE)
    assert advised(oz.hunt)[-1].advice == 2


@pytest.mark.parametrize("condition", [None, *(each for each in DialogueCondition if each.argues)])
def test_one_request_for_advice_gives_one_advice_however_often_it_is_repeated(
    condition: DialogueCondition | None,
) -> None:
    player = ScriptedPlayer()
    talk = None if condition is None else arguing_engine(condition)
    hunt = HuntWithoutSimulator(participant=TabUI(player), adviser=Adviser(error_rate=0.5), talk=talk)
    hunt.run(10)
    player.wish = (UNSURE,)
    hunt.run(3 * RETRY_PERIOD)  # as in a window that does not see the answer
    for _ in range(2):  # double clicks: the view shows the answer, and the participant asks again
        player.wish = ()
        hunt.tabui.poll_player()
        hunt.run(2)
        player.wish = (UNSURE,)
        hunt.tabui.poll_player()
        hunt.run(2)
    view = hunt.view()
    assert view is not None
    (dialogue,) = view.dialogues
    (event,) = advised(hunt)
    assert (event.advice, dialogue.dialogue, dialogue.suggested) == (1, 1, True)
    assert sum("Unsure" in line for line in hunt.lines) >= 4


def test_advice_is_asked_for_anew_once_the_dialogue_has_ended() -> None:
    player = ScriptedPlayer()
    hunt = HuntWithoutSimulator(participant=TabUI(player), talk=arguing_engine(DialogueCondition.COLLABORATOR))
    hunt.run(10)

    def wish(*wishes: ParticipantRequest) -> View:
        player.wish = wishes
        hunt.tabui.poll_player()
        hunt.run(5)
        player.wish = ()
        view = hunt.view()
        assert view is not None
        return view

    talk = wish(UNSURE).dialogues[0]
    after = wish(AnswerDialogue(talk.dialogue, talk.turn, talk.acts.index("leave")))
    assert after.dialogues == ()
    (talk,) = wish(UNSURE).dialogues
    assert talk.dialogue == 2 and [event.advice for event in advised(hunt)] == [1, 2]


def test_a_keeper_that_is_started_again_counts_on() -> None:
    before = WizardHunt(adviser=ERRING)
    before.wish(UNSURE)
    after = WizardHunt(adviser=ERRING, history=before.hunt.log.entries)
    # The suggestion stands until it is answered.
    (talk,) = after.wish(UNSURE).dialogues
    after.wish(AnswerDialogue(talk.dialogue, talk.turn, talk.acts.index("stop")))
    after.wish(UNSURE)
    assert [event.advice for event in advised(after.hunt)] == [1, 2]


def test_a_wizards_own_advice_is_no_error_and_the_robots_is_recorded_beside_it() -> None:
    oz = WizardHunt(adviser=ERRING)
    oz.ask(WIZARD_ON)
    oz.wish(UNSURE)
    (held,) = oz.held.advice
    robots = held.suggestion
    chosen = next(room for room, _ in held.costs if room != robots)
    oz.ask(WizardAdvice(0, chosen))
    (event,) = advised(oz.hunt)
    assert (event.room.people, event.erred) == (chosen, False)
    other = WizardHunt(adviser=ERRING)
    other.ask(WIZARD_ON)
    other.wish(UNSURE)
    assert robots is not None
    other.ask(WizardAdvice(0, robots))
    (event,) = advised(other.hunt)
    assert (event.room.people, event.erred) == (robots, True)
