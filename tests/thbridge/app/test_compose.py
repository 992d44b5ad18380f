import dataclasses
from pathlib import Path

import pytest

from sim.team import Team
from thbridge.app.compose.game import build_briefing
from thbridge.app.compose.robots import REHEARSERS, build_simr, rehearse
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.protocols.text.notice import encode_notice
from thbridge.roles.notices import Subscribe
from thbridge.study.study_file import ParticipantSection, ShowsSection, Study


@pytest.mark.parametrize("name", ["arena8", "office", "warehouse12"])
def test_a_rehearsal_is_long_enough_for_robots_to_drive(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # Whatever it does not come to is compiled in the midst of a session, and holds it up for seconds.
    setting = read_setting(dataclasses.replace(Study(), map=name, robots=2), Path())
    team = rehearsed(setting, monkeypatch)
    # Turning on the spot does not need all of the local planner.
    assert (team.step([]).world.twists[:, 0] > 0.2).all()


def test_of_a_large_team_only_some_rehearse_and_whoever_has_software_of_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    own = dataclasses.replace(Study().robot, localization="truth")
    setting = read_setting(dataclasses.replace(Study(), map="warehouse12", robots=14, each={2: own, 13: own}), Path())
    monkeypatch.setattr("thbridge.app.compose.robots.REHEARSAL", 1)
    software = [parameters.localization for parameters in rehearsed(setting, monkeypatch).parameters]
    assert software == ["amcl", "truth", *["amcl"] * (REHEARSERS - 2), "truth"]


def rehearsed(setting: StudySetting, monkeypatch: pytest.MonkeyPatch) -> Team:
    """The team of a rehearsal, after it."""
    teams: list[Team] = []

    def made(*arguments: object) -> Team:
        teams.append(Team(*arguments))  # type: ignore[arg-type]
        return teams[0]

    monkeypatch.setattr("thbridge.app.compose.robots.Team", made)
    rehearse(setting)
    return teams[0]


def test_participants_are_briefed_with_the_study_s_map_pictures_and_consent(tmp_path: Path) -> None:
    (tmp_path / "terms.txt").write_text("\ufeffWe record you.\n", encoding="utf-8")
    participant = ParticipantSection(consent=Path("terms.txt"))
    briefing = build_briefing(read_setting(dataclasses.replace(Study(), participant=participant), tmp_path))
    assert briefing.consent == "We record you."
    assert briefing.names == ("Blue Bottle", "Orange Bottle", "Pink can", "Yellow can")
    assert {name: data[:3] for name, data in briefing.pictures.items()} == {
        f"rsz_t{number}.jpg": b"\xff\xd8\xff" for number in range(1, 5)
    }
    assert briefing.floor_plan is not None
    assert [room.room for room in briefing.floor_plan.rooms] == list(range(1, 9))
    assert build_briefing(read_setting(Study(), Path())).consent is None


@pytest.mark.parametrize("truth", [False, True])
def test_the_truth_about_robots_is_told_only_where_the_study_says_so(truth: bool) -> None:
    participant = ParticipantSection(shows=ShowsSection(truth=truth, uncertainty=truth, way=truth))
    simr = build_simr(read_setting(dataclasses.replace(Study(), participant=participant), Path()))
    subscribed = encode_notice("Window", simr.name, Subscribe())
    said = [message.line() for tick in range(10) for message in simr.step(tick, [subscribed] if tick == 0 else [])]
    told = [line for line in said if "SimR Window" in line]
    assert told
    for word in ('truth":[', 'ellipses":[', "Ways"):
        assert any(word in line for line in told) == truth
