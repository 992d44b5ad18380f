"""Wizard-of-Oz: a person speaks in a robot's place, and the participant does not see it."""

import pytest

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator
from tests.support.hunts.scripted_hunt import WIZARD_OFF, WIZARD_ON, WizardHunt
from thbridge.dialogue.moves import Author
from thbridge.hunt.events import Condition
from thbridge.hunt.rooms import Room
from thbridge.roles.keeper.requests.wizard import WizardState
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.shared.robot_requests import WizardAdvice, WizardMode, WizardMove
from thbridge.roles.shared.view import AnswerDialogue, EndGame, PlayAgain, RequestSuggestion, SelectRoom


@pytest.fixture
def oz() -> WizardHunt:
    return WizardHunt()


def test_a_puppets_turn_waits_and_is_made_in_the_wizards_words(oz: WizardHunt) -> None:
    oz.ask(WIZARD_ON)
    view = oz.wish(SelectRoom(0, 3))
    (dialogue,) = view.dialogues
    assert (dialogue.robot, dialogue.said, dialogue.choices) == (0, (), ())
    (turn,) = oz.held.turns
    assert (turn.dialogue, turn.turn, turn.robot, turn.scenario, turn.room) == (1, 0, 0, "select-room", 3)
    assert len(turn.sentences) == 1
    (dialogue,) = oz.ask(WizardMove(1, 0, 0, "Room 3? Are you serious?")).dialogues
    assert dialogue.said == ("Room 3? Are you serious?",)
    assert dialogue.choices == ("Continue", "Stop")
    assert oz.held == WizardState(puppets=(0,))
    (dialogue,) = oz.wish(AnswerDialogue(1, 1, 0)).dialogues
    assert dialogue.choices == ()
    (turn,) = oz.held.turns
    (dialogue,) = oz.ask(WizardMove(1, 2, 0)).dialogues
    assert dialogue.said == ("Room 3? Are you serious?", "Continue", turn.sentences[0])
    assert [author for author, _ in oz.said] == [Author.WIZARD, Author.PERSON, Author.WIZARD]


def test_other_robots_speak_for_themselves(oz: WizardHunt) -> None:
    oz.ask(WIZARD_ON)
    (dialogue,) = oz.wish(SelectRoom(1, 3)).dialogues
    assert dialogue.choices == ("Continue", "Stop")
    assert oz.held.turns == ()


def test_a_move_that_is_not_waited_for_changes_nothing(oz: WizardHunt) -> None:
    oz.ask(WIZARD_ON)
    before = oz.wish(SelectRoom(0, 3))
    wrong = [WizardMove(1, 1, 0), WizardMove(2, 0, 0), WizardMove(1, 0, 7), WizardMove(1, 0, -1), WizardAdvice(0, 4)]
    assert oz.ask(*wrong) == before
    after = oz.ask(WizardMove(1, 0, 0), WizardMove(1, 0, 0, "again"))
    assert len(after.dialogues[0].said) == 1


def test_a_robot_that_is_released_goes_on_at_once_as_it_would_have(oz: WizardHunt) -> None:
    oz.ask(WIZARD_ON)
    oz.wish(SelectRoom(0, 3))
    released = oz.ask(WIZARD_OFF)
    other = WizardHunt()
    assert released.dialogues == other.wish(SelectRoom(0, 3)).dialogues
    assert [author for author, _ in oz.said] == [Author.ROBOT]
    assert oz.held == WizardState()


def test_advice_waits_and_is_the_wizards(oz: WizardHunt) -> None:
    oz.ask(WIZARD_ON)
    view = oz.wish(RequestSuggestion(0))
    assert (view.thinking, view.dialogues) == ((0,), ())
    (advice,) = oz.held.advice
    assert advice.robot == 0
    assert [room for room, _ in advice.costs] == list(range(1, 9))
    assert all(cost == view.costs[0][room] for room, cost in advice.costs)
    own = advice.suggestion
    assert own is not None
    chosen = next(room for room, _ in advice.costs if room != own)
    assert oz.ask(WizardAdvice(0, 9), WizardAdvice(0, -1), WizardAdvice(1, chosen)) == view
    view = oz.ask(WizardAdvice(0, chosen))
    assert (view.thinking, [dialogue.room for dialogue in view.dialogues]) == ((), [chosen])
    assert oz.held.advice == ()
    (turn,) = oz.held.turns
    assert turn.room == chosen


def test_advice_stands_though_the_question_comes_once_more(oz: WizardHunt) -> None:
    oz.ask(WIZARD_ON)
    oz.wish(RequestSuggestion(0))
    oz.player.wish = (RequestSuggestion(0),)
    for step in range(60):  # at whatever tick it is asked again
        if step == 30:
            oz.hunt.session.ask("wizard", WizardAdvice(0, 5))
            oz.hunt.session.ask("wizard", WizardMove(1, 0, 0, "Room 5?"))
        oz.hunt.tabui.connected()
        oz.hunt.tabui.poll_player()
        oz.hunt.run(1)
    (dialogue,) = oz.view.dialogues
    assert (dialogue.dialogue, dialogue.room, dialogue.said) == (1, 5, ("Room 5?",))


def test_a_robot_that_is_released_gives_its_own_advice(oz: WizardHunt) -> None:
    oz.ask(WIZARD_ON)
    oz.wish(RequestSuggestion(0))
    view = oz.ask(WIZARD_OFF)
    assert view == WizardHunt().wish(RequestSuggestion(0))


def test_asking_for_a_room_takes_the_question_back(oz: WizardHunt) -> None:
    oz.ask(WIZARD_ON)
    oz.wish(RequestSuggestion(0))
    view = oz.wish(SelectRoom(0, 5))
    assert (view.thinking, [dialogue.room for dialogue in view.dialogues]) == ((), [5])
    assert oz.held.advice == ()


def test_a_room_that_is_talked_about_with_another_is_no_advice(oz: WizardHunt) -> None:
    oz.ask(WIZARD_ON)
    oz.wish(SelectRoom(1, 3))
    oz.wish(RequestSuggestion(0))
    (advice,) = oz.held.advice
    assert 3 not in [room for room, _ in advice.costs]
    assert oz.ask(WizardAdvice(0, 3)).thinking == (0,)


def test_a_puppet_that_does_not_answer_any_more_is_not_waited_for(oz: WizardHunt) -> None:
    oz.ask(WIZARD_ON)
    oz.wish(RequestSuggestion(0))
    oz.hunt.puppets.conditions[0] = Condition.SILENT
    oz.hunt.run(60)
    assert (oz.view.thinking, oz.held.advice) == ((), ())


def test_puppets_stay_puppets_in_the_next_game(oz: WizardHunt) -> None:
    oz.ask(WIZARD_ON)
    oz.wish(EndGame(1))
    oz.wish(PlayAgain(1))
    oz.hunt.run(10)
    assert oz.view.game == 2
    assert oz.held == WizardState(puppets=(0,))
    assert oz.wish(SelectRoom(0, 2)).dialogues[0].choices == ()


@pytest.mark.parametrize("strategy", list(BotStrategy))
def test_a_simulated_participant_waits_for_a_puppet_and_does_not_give_up(strategy: BotStrategy) -> None:
    hunt = HuntWithoutSimulator(strategy=strategy)
    for robot in (0, 1):
        hunt.session.ask("wizard", WizardMode(robot, on=True))
    hunt.run(200)
    assert hunt.session.game is not None
    assert hunt.session.game.ended is None
    assert all(hunt.session.game.robots[robot].at == Room(0) for robot in (0, 1))
    for robot in (0, 1):
        hunt.session.ask("wizard", WizardMode(robot, on=False))
    hunt.finish()
    assert sum(room.visited for room in hunt.session.game.rooms) > 0
