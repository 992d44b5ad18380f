"""Robots that argue, in a game: what participants and robots agree upon is done, and nothing else."""

import random
import re

import pytest

from tests.support.hunts.scripted_hunt import COLLABORATOR, LANGUAGE, RULEBOOK, ArguingHunt
from thbridge.dialogue.arguing import ArguingEngine
from thbridge.dialogue.conditions import DialogueCondition, Manner
from thbridge.dialogue.moves import Author, Conclude, DecideAlone
from thbridge.dialogue.worded import WordedPhrasing
from thbridge.dialogue.wording.authors import WordingRequest
from thbridge.hunt.events import RobotDeparted, TreasureLeft
from thbridge.roles.shared.robot_requests import WizardMode, WizardMove
from thbridge.roles.shared.view import Consent, OpenDialogue, RequestSuggestion, SelectRoom, SendRobot, SenseTreasure


def test_a_supervised_robot_does_what_it_is_told_without_a_word() -> None:
    table = ArguingHunt(DialogueCondition.SUPERVISOR)
    view = table.wish(SelectRoom(0, 3))
    assert view.dialogues == () and view.consents == (Consent(0, "select-room", 3),)


def test_a_collaborator_goes_nowhere_before_both_agree() -> None:
    table = ArguingHunt()
    room = table.another_room()
    view = table.wish(SelectRoom(0, room))
    assert view.consents == ()
    assert table.wish(SendRobot(0, room)).robots[0].moving_to is None
    table.say(f"All right, not room {room}")
    table.say("Where would you go, then?")
    view = table.say("All right")
    assert view.dialogues == ()
    (agreed,) = view.consents
    assert agreed.room != room
    assert table.wish(SendRobot(0, agreed.room)).robots[0].moving_to == agreed.room


def test_a_robot_that_was_persuaded_goes_there() -> None:
    table = ArguingHunt()
    room = table.another_room()
    table.wish(SelectRoom(0, room))
    table.say("Why not")
    table.say("No, I still want you to go")
    table.say(f"Go to room {room} next")
    view = table.say("I want")
    if view.dialogues:
        view = table.say(f"Go to room {room} next")
    assert view.consents == (Consent(0, "select-room", room),)
    assert table.wish(SendRobot(0, room)).robots[0].moving_to == room


def test_two_robots_ask_at_once_and_are_answered_in_any_order() -> None:
    table = ArguingHunt()
    table.wish(RequestSuggestion(0), RequestSuggestion(1))
    assert {each.robot for each in table.view.dialogues} == {0, 1}
    first, second = table.dialogue(0).room, table.dialogue(1).room
    assert first != second
    table.say("All right", robot=1)
    view = table.say("All right", robot=0)
    assert {(agreed.robot, agreed.room) for agreed in view.consents} == {(0, first), (1, second)}


def test_a_robot_that_finds_no_way_says_where_it_would_go_instead() -> None:
    table = ArguingHunt()
    room = table.suggested()
    table.hunt.puppets.stuck.add(0)
    table.wish(SelectRoom(0, room))
    view = table.wish(SendRobot(0, room), ticks=80)
    assert view.robots[0].moving_to is None
    talk = table.dialogue()
    assert talk.room != room
    assert "room" in talk.said[0]
    # Asked about the room that it did not reach, it has a reason against it.
    table.say("Let us leave it")
    table.wish(SelectRoom(0, room))
    table.say("Why not")
    assert "no way" in table.dialogue().said[-1]


def test_neglected_robots_decide_by_themselves_and_say_so() -> None:
    table = ArguingHunt(patience=100)
    table.hunt.run(90)
    assert all(robot.moving_to is None for robot in table.view.robots)
    seen = set()
    for _ in range(60):
        table.hunt.run(1)
        seen.update(table.view.last_words)
    said = [each for record in table.hunt.tick_records for each in record.utterances]
    assert {each.topic.robot for each in said if isinstance(each.move, DecideAlone)} == {0, 1}
    assert all(each.text.startswith("Nobody has told me what to do for 2 s") for each in said)
    assert {(words.robot, words.agreed) for words in seen} == {(0, True), (1, True)}
    assert all(words.said[-1].startswith("Nobody has told me") for words in seen)
    table.hunt.run(3000)
    assert sum(room.state == "visited" for room in table.view.rooms) == 8
    # It names what it is sure of, and gives nothing up in her place.
    assert any(room.verdict is not None and room.verdict.points > 0 for room in table.view.rooms)
    assert not any(isinstance(event, TreasureLeft) for event in table.hunt.log.events)
    assert all(room.verdict is None or room.verdict.points > 0 for room in table.view.rooms)


def test_a_robot_that_is_attended_to_waits() -> None:
    table = ArguingHunt(patience=100)
    table.wish(RequestSuggestion(0), RequestSuggestion(1))
    for at in range(20):
        for robot in (0, 1):
            table.say("Back" if at % 2 else "I have a question", robot)
        table.hunt.run(30)
    assert not any(isinstance(event, RobotDeparted) for event in table.hunt.log.events)


def test_a_robot_gives_time_to_read_what_it_has_said() -> None:
    table = ArguingHunt(patience=100)
    table.wish(RequestSuggestion(0))
    table.hunt.run(600)
    assert table.view.robots[0].moving_to is None
    departed = [event.robot for event in table.hunt.log.events if isinstance(event, RobotDeparted)]
    assert departed and 0 not in departed
    table.hunt.run(1200)
    departed = [event.robot for event in table.hunt.log.events if isinstance(event, RobotDeparted)]
    assert 0 in departed


@pytest.mark.parametrize("condition", [DialogueCondition.ADVISER, DialogueCondition.AUTONOMOUS])
def test_who_has_the_last_word(condition: DialogueCondition) -> None:
    table = ArguingHunt(condition)
    room = table.another_room()
    view = table.wish(SelectRoom(0, room))
    if condition is DialogueCondition.ADVISER:
        view = table.say("all the same")
        assert view.consents == (Consent(0, "select-room", room),)
    else:
        table.say("Why not")
        view = table.say("No, I still want")
        (agreed,) = view.consents
        assert agreed.room != room


def test_a_wizard_is_offered_the_legal_moves_of_the_robot() -> None:
    table = ArguingHunt()
    room = table.another_room()
    table.hunt.session.ask("wizard", WizardMode(0, on=True))
    table.wish(SelectRoom(0, room))
    assert table.dialogue().choices == ()
    (turn,) = table.hunt.tick_records[-1].wizard.turns
    assert len(turn.sentences) >= 2
    challenge = next(at for at, sentence in enumerate(turn.sentences) if sentence.startswith("Why"))
    table.hunt.session.ask("wizard", WizardMove(turn.dialogue, turn.turn, challenge, ""))
    table.hunt.run(5)
    assert table.dialogue().said[-1].startswith("Why")
    authors = [each.author for record in table.hunt.tick_records for each in record.utterances]
    assert Author.WIZARD in authors


def test_what_is_agreed_instead_of_a_picture_is_what_is_done() -> None:
    table = ArguingHunt()
    table.wish(RequestSuggestion(0))
    room = table.dialogue().room
    table.say("All right")
    table.wish(SendRobot(0, room), ticks=30)
    table.wish(SenseTreasure(room))
    table.wish(OpenDialogue(0, "take-picture", room))
    table.say("All right, no picture")
    table.say("What would you do, then?")
    assert table.say("All right, name").consents == (Consent(0, "take-treasure", room),)


def test_what_was_agreed_is_in_sight_until_the_robot_is_there() -> None:
    table = ArguingHunt()
    table.wish(RequestSuggestion(0))
    room = table.dialogue().room
    (words,) = table.say("All right").last_words
    assert (words.robot, words.room, words.agreed) == (0, room, True)
    assert words.said[-2].startswith("All right") and f"to room {room}" in words.said[-1]
    assert words.speakers[-2:] == ("person", "robot") and words.is_told
    assert table.wish(SendRobot(0, room)).last_words == (words,)
    table.hunt.run(30)
    assert table.view.robots[0].place == room
    assert table.view.last_words == ()


def test_what_was_not_agreed_is_in_sight_until_the_robot_is_talked_with_again() -> None:
    table = ArguingHunt()
    room = table.another_room()
    table.wish(SelectRoom(0, room))
    (words,) = table.say("Let us leave it").last_words
    assert not words.agreed and words.is_told
    table.wish(RequestSuggestion(1))
    assert table.view.last_words == (words,), "the other robot"
    table.wish(RequestSuggestion(0))
    assert table.view.last_words == ()


def test_a_look_at_the_questions_says_nothing() -> None:
    table = ArguingHunt()
    table.wish(RequestSuggestion(0))
    said = table.dialogue().said
    table.say("I have a question")
    assert table.dialogue().said == said
    table.say("Back")
    assert table.dialogue().said == said
    assert "open-questions" in table.dialogue().acts


def test_a_robot_that_is_supervised_has_no_last_words() -> None:
    table = ArguingHunt(DialogueCondition.SUPERVISOR)
    assert table.wish(SelectRoom(0, 3)).last_words == ()


def test_another_author_s_sentence_is_said_where_it_tells_the_same_and_recorded_where_not() -> None:
    def author(request: WordingRequest) -> str:
        return "All right, I go to room 99." if request.move.locution == "accept" else request.sentence

    phrasing = WordedPhrasing(LANGUAGE, COLLABORATOR, 7, author=author)
    talk = ArguingEngine(RULEBOOK, {None: Manner(persistence=0)}, phrasing, 7)
    table = ArguingHunt(talk=talk)
    room = table.another_room()
    table.wish(SelectRoom(0, room))
    said = [each for record in table.hunt.tick_records for each in record.utterances if each.authored]
    taken, refused = said[0], said[-1]
    assert taken.authored is not None and taken.text == taken.authored.offered == taken.authored.sentence
    assert refused.authored is not None and refused.authored.offered == "All right, I go to room 99."
    assert refused.authored.refused and refused.text == refused.authored.sentence


def test_what_is_not_done_after_all_is_not_told() -> None:
    table = ArguingHunt(DialogueCondition.ADVISER)
    table.wish(SelectRoom(1, table.another_room(1)))
    table.say("All right, not", robot=1)
    table.say("Where would you go, then?", robot=1)
    room = int(re.findall(r"room (\d+)", table.dialogue(1).choices[0])[0])
    view = table.wish(SelectRoom(0, room))
    if view.dialogues[-1].robot == 0:
        table.say("all the same")
    table.wish(SendRobot(0, room))
    view = table.say("All right", robot=1)
    assert view.consents == ()
    (words,) = (each for each in view.last_words if each.robot == 1)
    assert (words.agreed, words.is_told, words.speakers[-1]) == (False, False, "person")
    said = [each for record in table.hunt.tick_records for each in record.utterances if each.topic.robot == 1]
    assert not any(isinstance(each.move, Conclude) and each.move.about is not None for each in said)


def test_a_robot_repeats_a_suggestion_that_it_has_given_as_a_reason() -> None:
    table = ArguingHunt()
    suggested, room = table.suggested(), table.another_room()
    table.wish(SelectRoom(0, room))
    table.say("Why not")
    assert f"room {suggested}" in table.dialogue().said[-1]
    table.say("Let us leave it")
    table.wish(RequestSuggestion(0))
    assert table.dialogue().room == suggested
    assert "All right" in table.dialogue().choices[0]


@pytest.mark.parametrize("seed", range(8))
def test_a_request_for_a_suggestion_is_always_answered(seed: int) -> None:
    table, draw = ArguingHunt(), random.Random(seed)
    for _ in range(12):
        refused = 0 if table.view.refusal is None else table.view.refusal.number
        table.wish(draw.choice([RequestSuggestion(0), RequestSuggestion(0), SelectRoom(0, draw.randint(1, 8))]))
        refusal = table.view.refusal
        assert table.view.dialogues or table.view.consents or (refusal is not None and refusal.number > refused)
        while table.view.dialogues:
            open_to = [each for each in table.dialogue().choices if not each.startswith("All right, room")]
            table.say(draw.choice(open_to[-3:]))
