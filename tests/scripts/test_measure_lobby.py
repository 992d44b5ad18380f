"""The crowd of the lobby's measurement: 90 people within a minute, a tenth of whom leave."""

import pytest

from scripts.measure_lobby import WAIT, simulate
from thbridge.experiment.design.lobby import WaitRule


@pytest.mark.parametrize("then", WaitRule)
def test_everybody_plays_or_gets_an_ending_and_games_are_whole_unless_the_rule_allows_it(then: WaitRule) -> None:
    for seed in range(20):
        for size, crowd in simulate(90, then, seed).items():
            done = [*crowd.played, *(each.participant for each in crowd.ended), *crowd.left]
            assert sorted(done) == sorted(crowd.arrived)
            assert crowd.waits[-1] <= WAIT
            if then is WaitRule.PAY:
                assert crowd.incomplete == 0
                assert len(crowd.ended) < size
