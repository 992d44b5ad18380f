"""Beginnings of games in a recording, found in its events."""

from dataclasses import dataclass
from pathlib import Path

from thbridge.hunt.codec import kind_of
from thbridge.hunt.events import GameStarted
from thbridge.json_text import json_of
from thbridge.recording.bag.reading.reader import RawMessage, info, messages
from thbridge.ros.messages import types, unpack

_STARTED = kind_of(GameStarted)


@dataclass(frozen=True, slots=True)
class GameStart:
    """Beginning of a game: its number, and the stamp, nanoseconds.

    Robots are reset in the tick after the beginning. So poses with this stamp are from before the game; only events,
    score and utterances belong to the game.
    """

    number: int
    stamp_ns: int


def game_start(message: RawMessage) -> GameStart | None:
    """Return the beginning of a game that a message reports; None for any other message."""
    if message.msgtype != types.GAME_EVENT or message.md5 != types.plain_definition(types.GAME_EVENT).md5:
        return None
    try:
        event = unpack.game_event(message.data)
        number = json_of(event.json)["game"] if event.kind == _STARTED else None
    except (ValueError, TypeError, KeyError):
        return None
    return GameStart(number, message.stamp_ns) if isinstance(number, int) and 0 <= number < 2**31 else None


def game_starts(bag: Path) -> tuple[GameStart, ...]:
    """Return the beginnings of all games in a bag, oldest first. Raise BadFile as `messages` does."""
    topics = {topic.name for topic in info(bag).topics if topic.msgtype == types.GAME_EVENT}
    if not topics:
        return ()
    return tuple(start for message in messages(bag, topics) if (start := game_start(message)) is not None)


OF_A_GAME = frozenset({types.GAME_EVENT, types.SCORE, types.UTTERANCE, types.DIALOGUE_MOVE, types.DIALOGUE_STATE})
"""Types of messages that belong to a game from the stamp of its beginning on; see `GameStart`."""
