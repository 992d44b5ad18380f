"""Dialogues in which robots argue, as a researcher sees them at any time."""

from dataclasses import replace

from tests.support.dialogue import recorded_dialogues
from tests.support.ros.watched_messages import SECOND, TICKS, event, messages, watched
from thbridge.dialogue.conditions import Manner
from thbridge.dialogue.portrait import DialoguePortrait, read_portrait
from thbridge.ros.messages.session_records import DialogueMoveRecord, DialogueStateRecord
from ui.model.watching.dialogue_log import MAX_KEPT, DialogueCourse, DialogueLog
from ui.model.watching.dialogue_rows import DialogueList, describe_attacks, heading, move_row, rows
from ui.model.watching.session_log import SessionLog


def test_the_course_at_a_time_is_what_was_said_until_then_and_what_the_robot_made_of_it() -> None:
    session_log = watched()
    assert session_log.dialogue(0, SECOND - 1) == DialogueCourse()
    assert session_log.dialogue(1, 9 * SECOND) == DialogueCourse()
    for second in range(1, len(TICKS) + 1):
        course = session_log.dialogue(0, second * SECOND)
        so_far = [record for tick in TICKS[:second] for record in tick]
        assert [move for _, move in course.moves] == [
            record for record in so_far if isinstance(record, DialogueMoveRecord)
        ]
        *_, state = (record for record in so_far if isinstance(record, DialogueStateRecord))
        assert course.portrait == read_portrait(state.json)


def test_another_dialogue_and_another_game_begin_anew() -> None:
    session_log = watched()
    (move, *_) = (record for record in TICKS[0] if isinstance(record, DialogueMoveRecord))
    for message in messages(20, replace(move, talk=2)):
        session_log.take(message)
    assert [each.talk for _, each in session_log.dialogue(0, 20 * SECOND).moves] == [2]
    session_log.take(event(30 * SECOND, "started"))
    assert session_log.dialogue(0, 30 * SECOND) == DialogueCourse()
    for message in messages(31, replace(move, talk=2)):
        session_log.take(message)
    assert len(session_log.dialogue(0, 31 * SECOND).moves) == 1


def test_a_state_that_cannot_be_read_is_an_empty_one() -> None:
    session_log = SessionLog()
    for message in messages(1, DialogueStateRecord(1, 0, "{")):
        session_log.take(message)
    assert session_log.dialogue(0, SECOND).portrait == DialoguePortrait()


def test_the_log_is_bounded() -> None:
    dialogues = DialogueLog()
    (move, *_) = (record for record in TICKS[0] if isinstance(record, DialogueMoveRecord))
    for stamp in range(MAX_KEPT + 1):
        dialogues.take_move(stamp, move)
    assert len(dialogues.course(0, 0, MAX_KEPT).moves) <= MAX_KEPT


def test_all_is_told_in_words() -> None:
    assert heading(1, DialogueCourse()) == "Robot 2 has not argued yet."
    course = watched().dialogue(0, 4 * SECOND)
    assert heading(0, course) == (
        "Robot 1, dialogue 1 (claimed): persuasion-in-brief about next(Robot1, Room1), opened by the participant"
    ).replace("claimed", course.moves[-1][1].after)
    assert move_row(course.moves[0][1])[:2] == ("participant", "assert(next(Robot1, Room1))")
    arguments = list(rows(DialogueList.ARGUMENTS, course.portrait))
    assert len(arguments) == len(course.portrait.arguments)
    assert {"accepted" in how.split("; ") for _, _, how in arguments} >= {True}
    assert all(what in describe_attacks(course.portrait) for what, _, _ in arguments)
    beliefs = [what for what, _, _ in rows(DialogueList.BELIEFS, course.portrait)]
    assert beliefs == [belief.literal for belief in course.portrait.sigma]
    assert [what for what, _, _ in rows(DialogueList.PICTURE, course.portrait)][:1] == ["next(Robot1, Room1)"]
    said = [what for what, _, _ in rows(DialogueList.HUMAN_STORE, course.portrait)]
    assert said == list(course.portrait.human_store) != [*rows(DialogueList.ROBOT_STORE, course.portrait)]


def test_what_is_misheard_stands_beside_the_sentence() -> None:
    ticks = recorded_dialogues.recorded(
        *recorded_dialogues.utterances(recorded_dialogues.STUBBORN[:1], Manner(misheard=1.0))
    )
    (move,) = (record for tick in ticks for record in tick if getattr(record, "heard", ""))
    assert isinstance(move, DialogueMoveRecord)
    assert move_row(move)[2] == f"{move.text} The robot understood: {move.heard}"
    assert "within 3: " in move_row(replace(move, parent=3))[1]
