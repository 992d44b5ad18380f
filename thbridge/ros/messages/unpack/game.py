"""thbridge's own message types: game events, score, utterances, moves and states of dialogues, inputs."""

import numpy as np

from sim.common.robot_numbers import index_of
from thbridge.ros.messages.cursor import INT32, INT64, UINT8, UINT32, Cursor
from thbridge.ros.messages.session_records import (
    DialogueMoveRecord,
    DialogueStateRecord,
    GameEvent,
    InputRecord,
    ScoreRecord,
    SeatNotice,
    UtteranceRecord,
)


def game_event(data: bytes) -> GameEvent:
    """Decode thbridge_msgs/GameEvent."""
    cursor = Cursor.behind_header(data)
    kind = cursor.string()
    robot, room = _robot(cursor.integer(INT32)), _room(cursor.integer(INT32))
    return GameEvent(kind, robot, room, cursor.string())


def score(data: bytes) -> ScoreRecord:
    """Decode thbridge_msgs/Score."""
    cursor = Cursor.behind_header(data)
    points, visited, rooms = cursor.integer(INT32), cursor.integer(UINT32), cursor.integer(UINT32)
    energy = np.frombuffer(cursor.take(8 * cursor.integer(UINT32)), dtype="<f8")
    return ScoreRecord(points, visited, rooms, tuple(energy.tolist()))


def utterance(data: bytes) -> UtteranceRecord:
    """Decode thbridge_msgs/Utterance. Recordings of releases without wizards have no author."""
    cursor = Cursor.behind_header(data)
    dialogue, speaker = cursor.integer(INT64), cursor.string()
    robot, room = index_of(cursor.integer(INT32)), _room(cursor.integer(INT32))
    scenario, text, move = cursor.string(), cursor.string(), cursor.string()
    author = cursor.string() if cursor.has_more else "robot" if speaker == "robot" else "person"
    return UtteranceRecord(dialogue, speaker, robot, room, scenario, text, move, author)


def dialogue_move(data: bytes) -> DialogueMoveRecord:
    """Decode thbridge_msgs/DialogueMove. Older recordings have no fault."""
    cursor = Cursor.behind_header(data)
    talk = cursor.integer(INT64)
    dialogue, parent, index, robot = (cursor.integer(INT32) for _ in range(4))
    speaker, author, game, locution, content, before, after = (cursor.string() for _ in range(7))
    return DialogueMoveRecord(
        talk=talk,
        dialogue=dialogue,
        parent=parent or None,
        index=index,
        robot=index_of(robot),
        speaker=speaker,
        author=author,
        game=game,
        locution=locution,
        content=content,
        before=before,
        after=after,
        is_booked=cursor.integer(UINT8) != 0,
        text=cursor.string(),
        heard=cursor.string(),
        fault=cursor.string() if cursor.has_more else "",
    )


def dialogue_state(data: bytes) -> DialogueStateRecord:
    """Decode thbridge_msgs/DialogueState."""
    cursor = Cursor.behind_header(data)
    talk, robot = cursor.integer(INT64), index_of(cursor.integer(INT32))
    return DialogueStateRecord(talk, robot, cursor.string())


def outside_input(data: bytes) -> InputRecord:
    """Decode thbridge_msgs/Input."""
    cursor = Cursor.behind_header(data)
    return InputRecord(cursor.string(), cursor.string(), cursor.string(), cursor.string())


def seat_notice(data: bytes) -> SeatNotice:
    """Decode thbridge_msgs/SeatNotice."""
    cursor = Cursor.behind_header(data)
    return SeatNotice(cursor.string(), cursor.string(), cursor.string())


def _robot(number: int) -> int | None:
    return None if number == 0 else index_of(number)


def _room(number: int) -> int | None:
    return None if number < 0 else number
