"""The state that a whole game has come to."""

from collections.abc import Iterable
from functools import reduce

from thbridge.hunt.events import Event, GameStarted
from thbridge.hunt.game import GameState, apply, begin


def fold(started: GameStarted, events: Iterable[Event]) -> GameState:
    return reduce(apply, events, begin(started))
