"""History of a session, which gives watchers that connect late the same messages as earlier watchers."""

from collections import defaultdict, deque
from collections.abc import Sequence
from typing import NamedTuple

from thbridge.ros.messages import unpack
from thbridge.ros.topics import (
    DIALOGUE_MOVES,
    DIALOGUE_STATES,
    GAME_EVENTS,
    INPUTS,
    ROSOUT,
    SEND_ROBOTS,
    SHOWN,
    SUCCESS,
    TEAM,
    UTTERANCES,
    RosMessage,
    Topic,
)

LISTED = frozenset(
    {GAME_EVENTS, UTTERANCES, DIALOGUE_MOVES, DIALOGUE_STATES, SEND_ROBOTS, SUCCESS, TEAM, INPUTS, ROSOUT}
)
"""Topics for which all recent messages are kept. For other topics, only the newest message is kept."""

MAX_MESSAGES = 1000
"""Maximum number of messages kept for each topic in `LISTED`, and for each kind of game event."""
MAX_BYTES = 2**20
"""Largest total size of the messages kept for a topic or a kind of event, in bytes."""


class _Numbered(NamedTuple):
    number: int
    message: RosMessage


class MessageHistory:
    """Newest message of each topic, and recent messages of the topics in `LISTED`, in bounded memory.

    Of the notices to participants, the newest message of each seat and kind is kept.

    Only events of the present game are kept. Each kind of event has its own limit, so that frequent events, such as
    collisions, do not displace the events that contain the state of the rooms.
    """

    def __init__(self) -> None:
        self._levels: dict[tuple[Topic, str], RosMessage] = {}
        self._recent: defaultdict[tuple[Topic, str], _Recent] = defaultdict(_Recent)
        self._count = 0

    def take(self, message: RosMessage) -> None:
        """Add a message; messages must be added in order of time."""
        topic = message.topic
        if topic not in LISTED:
            self._levels[_level_of(message)] = message
            return
        kind = unpack.game_event(message.data).kind if topic == GAME_EVENTS else ""
        if kind == "started":
            for game_topic, earlier in tuple(self._recent):
                if game_topic == GAME_EVENTS:
                    del self._recent[game_topic, earlier]
        self._count += 1
        self._recent[topic, kind].add(_Numbered(self._count, message))

    def before(self, latest: Sequence[RosMessage]) -> list[RosMessage]:
        """Return the kept messages, oldest first, without messages that the `latest` messages replace."""
        replaced = {_level_of(message) for message in latest}
        levels = [level for key, level in self._levels.items() if key not in replaced]
        listed = sorted(each for recent in self._recent.values() for each in recent.messages)
        return sorted([*levels, *(each.message for each in listed)], key=lambda message: message.stamp_ns)


def _level_of(message: RosMessage) -> tuple[Topic, str]:
    if message.topic != SHOWN:
        return message.topic, ""
    notice = unpack.seat_notice(message.data)
    return SHOWN, f"{notice.seat} {notice.kind}"


class _Recent:
    """Recent messages of one topic, or of one kind of event."""

    def __init__(self) -> None:
        self.messages: deque[_Numbered] = deque()
        self._size = 0

    def add(self, added: _Numbered) -> None:
        self.messages.append(added)
        self._size += len(added.message.data)
        while len(self.messages) > MAX_MESSAGES or self._size > MAX_BYTES:
            self._size -= len(self.messages.popleft().message.data)
