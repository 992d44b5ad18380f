"""The crowd of the measurement through the web: each person plays or gets their ending."""

import pytest

from scripts import measure_served_lobby as lobby
from thbridge.experiment.design.lobby import WaitRule


@pytest.mark.slow
@pytest.mark.parametrize("then", WaitRule)
def test_a_small_crowd_plays_or_gets_its_ending(then: WaitRule, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lobby, "ARRIVALS", 10.0)
    options = lobby.option_parser().parse_args(
        ["--people", "7", "--then", then, "--wait", "15", "--seconds", "10", "--games", "4"]
    )
    assert lobby.measure(options) == []
