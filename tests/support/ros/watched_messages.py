"""Messages as watch clients receive them."""

import json
from dataclasses import dataclass

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from tests.support.dialogue import recorded_dialogues
from thbridge.ros import names
from thbridge.ros.messages import pack, types
from thbridge.ros.messages.pack import Transform
from thbridge.ros.messages.records import Record
from thbridge.ros.messages.session_records import GameEvent
from thbridge.ros.publisher import messages_of
from ui.model.watching.session_log import SessionLog

SECOND = 1_000_000_000


@dataclass(frozen=True)
class StampedMessage:
    topic: str
    msgtype: str
    stamp_ns: int
    data: bytes


def tf(second: float, *entries: tuple[str, str, Pose2], topic: str = "/tf") -> StampedMessage:
    data = pack.transforms(0, [Transform(*entry) for entry in entries])
    return StampedMessage(topic, types.TFMESSAGE, round(second * SECOND), data)


def odometry(
    second: float, pose: Pose2, topic: str = "/odom", frame: str = "odom", child: str = "base_link", speed: float = 0.0
) -> StampedMessage:
    data = pack.odometry(0, frame, child, pose, Twist(speed, 0.0))
    return StampedMessage(topic, types.ODOMETRY, round(second * SECOND), data)


def event(
    second: int, kind: str, robot: int | None = None, room: int | None = None, **fields: object
) -> StampedMessage:
    record = GameEvent(kind, robot, room, json.dumps({"v": 1, "event": kind, **fields}))
    return StampedMessage(names.GAME_EVENTS, types.GAME_EVENT, second, pack.game_event(0, record))


TICKS = recorded_dialogues.recorded(*recorded_dialogues.utterances())


def messages(second: int, *records: Record) -> list[StampedMessage]:
    return [
        StampedMessage(made.topic.name, made.topic.msgtype, second * SECOND, made.data)
        for record in records
        for made in messages_of(0, 0, record)
    ]


def watched() -> SessionLog:
    """Return the log of a dialogue of robot 1, one tick per second, starting at 1 s."""
    session_log = SessionLog()
    for second, records in enumerate(TICKS, start=1):
        for message in messages(second, *records):
            session_log.take(message)
    return session_log
