"""thbridge's own message types: session, game events, score, utterances, moves and states of dialogues, inputs."""

import json
from struct import Struct

import numpy as np

from sim.common.robot_numbers import number_of
from thbridge.ros.messages.pack.fields import UINT32, boolean, header, string
from thbridge.ros.messages.session_records import (
    DialogueMoveRecord,
    DialogueStateRecord,
    GameEvent,
    InputRecord,
    ScoreRecord,
    SeatNotice,
    SessionRecord,
    UtteranceRecord,
)

_GAME_EVENT = Struct("<ii")
_SCORE = Struct("<iII")
_UINT64 = Struct("<Q")
_INT64 = Struct("<q")
_DIALOGUE_MOVE = Struct("<qiiii")
_DIALOGUE_STATE = Struct("<qi")


def session(tick: int, record: SessionRecord) -> bytes:
    """Encode thbridge_msgs/Session."""
    versions = json.dumps(record.versions, sort_keys=True)
    return b"".join(
        (
            header(tick),
            string(record.study),
            _UINT64.pack(record.seed),
            string(versions),
            string(record.program),
            UINT32.pack(len(record.roles)),
            *(string(role) for role in record.roles),
            string(record.participant),
        )
    )


def game_event(tick: int, record: GameEvent) -> bytes:
    """Encode thbridge_msgs/GameEvent. Robot 0 means no robot, and room -1 means no room."""
    numbers = _GAME_EVENT.pack(_robot(record.robot), _room(record.room))
    return header(tick) + string(record.kind) + numbers + string(record.json)


def score(tick: int, record: ScoreRecord) -> bytes:
    """Encode thbridge_msgs/Score."""
    energy = np.array(record.energy, dtype="<f8")
    numbers = _SCORE.pack(record.score, record.visited, record.rooms)
    return header(tick) + numbers + UINT32.pack(len(energy)) + energy.tobytes()


def utterance(tick: int, record: UtteranceRecord) -> bytes:
    """Encode thbridge_msgs/Utterance. Room -1 means no room."""
    return b"".join(
        (
            header(tick),
            _INT64.pack(record.dialogue),
            string(record.speaker),
            _GAME_EVENT.pack(_robot(record.robot), _room(record.room)),
            string(record.scenario),
            string(record.text),
            string(record.move),
            string(record.author),
        )
    )


def dialogue_move(tick: int, record: DialogueMoveRecord) -> bytes:
    """Encode thbridge_msgs/DialogueMove. Parent 0 means no parent."""
    numbers = (record.talk, record.dialogue, record.parent or 0, record.index, number_of(record.robot))
    before = (record.speaker, record.author, record.game, record.locution, record.content, record.before, record.after)
    return b"".join(
        (
            header(tick),
            _DIALOGUE_MOVE.pack(*numbers),
            *map(string, before),
            boolean(record.is_booked),
            string(record.text),
            string(record.heard),
            string(record.fault),
        )
    )


def dialogue_state(tick: int, record: DialogueStateRecord) -> bytes:
    """Encode thbridge_msgs/DialogueState."""
    return header(tick) + _DIALOGUE_STATE.pack(record.talk, number_of(record.robot)) + string(record.json)


def outside_input(tick: int, record: InputRecord) -> bytes:
    """Encode thbridge_msgs/Input."""
    return header(tick) + b"".join(string(text) for text in (record.kind, record.sender, record.line, record.json))


def seat_notice(tick: int, record: SeatNotice) -> bytes:
    """Encode thbridge_msgs/SeatNotice."""
    return header(tick) + b"".join(string(text) for text in (record.seat, record.kind, record.json))


def _robot(robot: int | None) -> int:
    return 0 if robot is None else number_of(robot)


def _room(room: int | None) -> int:
    return -1 if room is None else room
