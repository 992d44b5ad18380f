"""The end of a session in which people play many games."""

import gc
from types import SimpleNamespace

from tests.support.hunts.game_states import ARENA
from thbridge.app.play import EndCondition
from thbridge.hunt.events import GameStarted
from thbridge.hunt.game import GameState, begin


def test_of_games_that_are_over_the_outcome_alone_is_kept() -> None:
    ending = EndCondition(3600.0, left=lambda: False)
    all_started = []
    for number in range(1, 21):
        all_started.append(GameStarted(7, number, 2, 100.0, 5.0, 2.0, 1.0, ARENA))
        session = SimpleNamespace(tick=number, game=begin(all_started[-1]))
        assert not ending.reached(session)
    del session
    states = [each for each in gc.get_objects() if type(each) is GameState]
    kept = [each.started.game for each in states if any(each.started is other for other in all_started)]
    assert kept == [20]
    assert [each.game for each in ending.games] == list(range(1, 21))
