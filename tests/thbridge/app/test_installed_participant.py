"""Simulated participants of labs play wherever built-in ones do; their faults are reported, and do no harm."""

from pathlib import Path

import pytest

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator, templates
from tests.support.hunts.participant_views import view_of
from tests.support.programs.installed_plugins import install_plugins
from thbridge.api import HuntError, HuntSession, HuntStudy
from thbridge.app.compose.game import build_bot
from thbridge.app.compose.recording import build_record
from thbridge.app.compose.setting import read_setting
from thbridge.app.trials.plugin_trial import NOT_DETERMINED, PluginTrial
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.freeze import fingerprint_of
from thbridge.files.errors import BadFile
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.view import RequestSuggestion, SelectRoom
from thbridge.study.study_file import ParticipantSection, Study, load_study

SOURCE = """
from itertools import repeat

from thbridge.roles.shared.view import SelectRoom


class Returning:
    def __init__(self, knowledge, attitude, seed):
        pass

    def requests(self, view):
        view.called["cup"] = "mug"
        return self.returned(view)


class Second(Returning):
    def returned(self, view):
        return (SelectRoom(robot.robot, 2) for robot in view.robots)


class Raising(Returning):
    def returned(self, view):
        raise KeyError("no such room")


class Text(Returning):
    def returned(self, view):
        return "select"


class Mute(Returning):
    def returned(self, view):
        return None


class Tuples(Returning):
    def returned(self, view):
        return [(0, 2)]


class Untyped(Returning):
    def returned(self, view):
        return [SelectRoom(float("nan"), 2)]


class Endless(Returning):
    def returned(self, view):
        return repeat(SelectRoom(0, 2))


def wrong_arguments(seed):
    return None


def makes_none(knowledge, attitude, seed):
    return None
"""
NAMES = {
    "second": "Second",
    "raising": "Raising",
    "text": "Text",
    "mute": "Mute",
    "tuples": "Tuples",
    "untyped": "Untyped",
    "endless": "Endless",
    "wrong-arguments": "wrong_arguments",
    "makes-none": "makes_none",
}


@pytest.fixture(autouse=True)
def a_lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install_plugins(tmp_path, monkeypatch, "lab_of_people", {"thbridge.participants": NAMES}, SOURCE)


def test_an_installed_participant_decides_by_a_copy_of_the_view() -> None:
    view, player = view_of(None), build_bot(templates(), "second", 7)
    assert list(player.requests(view)) == [SelectRoom(0, 2)]
    assert view.called == {}


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("raising", "KeyError: 'no such room' (lab_of_people.py, line 23)"),
        ("text", "it returned a str, not a list of requests"),
        ("mute", "it returned a NoneType, not a list of requests"),
        ("tuples", "a tuple is no request"),
        ("untyped", "SelectRoom(robot=nan, room=2) cannot be sent: "),
        ("endless", "it returned more than 1000 requests"),
    ],
)
def test_a_built_in_participant_decides_where_it_fails(name: str, fault: str, caplog: pytest.LogCaptureFixture) -> None:
    player = build_bot(templates(), name, 7)
    for _ in range(2):
        assert list(player.requests(view_of(None))) == [RequestSuggestion(0)]
    (logged,) = caplog.messages
    assert logged.startswith(f"a built-in participant decided, because {name} failed: {fault}")


def test_a_fault_is_among_what_the_participant_says() -> None:
    hunt = HuntWithoutSimulator(participant=TabUI(build_bot(templates(), "mute", 7)))
    hunt.run(30)
    assert any('"kind":"Failed"' in line and "NoneType" in line for line in hunt.lines)


@pytest.mark.parametrize(
    ("strategy", "told"),
    [
        ("secnod", "line 2, participant.strategy: .secnod. is not a valid choice. Write suggestion, .*, second,"),
        (
            "wrong-arguments",
            r"line 2, participant.strategy: .* package lab-of-people 1.0: making the object failed: Type",
        ),
        ("makes-none", "line 2, participant.strategy: .* the result is a NoneType, which has no method requests"),
    ],
)
def test_a_study_with_a_participant_that_cannot_play_is_refused(tmp_path: Path, strategy: str, told: str) -> None:
    path = tmp_path / "study.yaml"
    path.write_text(f"participant:\n  strategy: {strategy}\n")
    with pytest.raises(BadFile, match=told):
        read_setting((loaded := load_study(path)).value, tmp_path, written=loaded)


def test_a_recording_has_its_package_and_version() -> None:
    setting = read_setting(Study(participant=ParticipantSection("second")), Path())
    assert build_record(setting, "play", [], "").versions["thbridge.participants:second"] == "lab-of-people 1.0"


def test_programs_name_it_as_they_name_built_in_ones() -> None:
    study = HuntStudy("original-2016")
    with HuntSession(study, participant="second") as session:
        session.run_until("said", at_most=5.0)
        assert {event.room for event in session.events if event.kind == "said"} == {2}
    with pytest.raises(HuntError, match=r"no strategy is called 'scond'. Write suggestion, .*, second, "):
        HuntSession(study, participant="scond")


def test_nothing_is_looked_up_for_a_study_without_plugins(monkeypatch: pytest.MonkeyPatch) -> None:
    def looked_up(**group: str) -> None:
        raise AssertionError(group)

    monkeypatch.setattr("thbridge.files.plugins.entry_points", looked_up)
    setting = read_setting(Study(), Path())
    build_bot(setting.templates, setting.study.participant.strategy, 1)
    build_record(setting, "play", [], "")


def test_a_trial_tells_what_is_not_determined() -> None:
    trial, played = PluginTrial("participant"), iter(["a", "b", "a", "c"])
    trial.twice("a game", lambda: [next(played), next(played)])
    assert trial.faults[NOT_DETERMINED].position == ("a game", "First: b", "First: c")


def test_the_fingerprint_of_a_study_with_people_has_its_package(tmp_path: Path) -> None:
    steps = "steps:\n  - {step: trial, name: game, each_condition: true}\n"
    within = "within: {participant.strategy: [nearest, second]}\n"
    (tmp_path / "experiment.yaml").write_text(f"title: x\n{within}quota: 4\n{steps}")
    found = fingerprint_of(ExperimentFolder(tmp_path), {"python": "3"}).versions
    assert found == {"python": "3", "thbridge.participants:second": "lab-of-people 1.0"}
