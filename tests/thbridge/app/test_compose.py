import dataclasses
from pathlib import Path

import pytest

from sim.team import Team
from thbridge.app.compose import Setting, read_setting
from thbridge.app.config import Study


@pytest.mark.parametrize("name", ["arena8", "office", "warehouse12"])
def test_a_rehearsal_is_long_enough_for_robots_to_drive(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # Whatever it does not come to is compiled in the midst of a session, and holds it up for seconds.
    setting = read_setting(dataclasses.replace(Study(), map=name, robots=2), Path())
    team = setting.team()

    def same_team(self: Setting) -> Team:
        return team

    monkeypatch.setattr(Setting, "team", same_team)
    setting.rehearse()
    # Turning on the spot does not need all of the local planner.
    assert (team.step([]).world.twists[:, 0] > 0.2).all()
