"""The crowd of the lobby's measurement: 90 people within a minute, a tenth of whom leave."""

import pytest

from scripts.measure_lobby import WAIT, simulate
from thbridge.experiment.design.lobby import WaitRule


@pytest.mark.parametrize("then", WaitRule)
@pytest.mark.parametrize("by_answers", [False, True])
def test_everybody_plays_or_gets_an_ending_and_games_are_whole_unless_the_rule_allows_it(
    then: WaitRule, by_answers: bool
) -> None:
    for seed in range(20):
        for crowd in simulate(90, then, seed, by_answers=by_answers).values():
            done = [*crowd.played, *(each.participant for each in crowd.ended), *crowd.left]
            assert sorted(done) == sorted(crowd.arrived)
            assert crowd.waits[-1] <= WAIT
            if then is WaitRule.PAY:
                assert crowd.incomplete == 0
