"""Recordings of games with several seats: what each seat said, decided and was shown, and equal replays."""

import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.hunts.recorded_hunts import assert_equal_replay, setting_of
from tests.support.hunts.talking_players import talking_participants
from thbridge.analysis.report.builder import read_report
from thbridge.app.compose.recording import build_record, build_recorder, build_writer
from thbridge.app.compose.session import SessionRecording, build_programs, open_session
from thbridge.app.play import PLAY
from thbridge.hunt.codec import from_json
from thbridge.hunt.events import (
    DecisionOutcome,
    DecisionProposed,
    DecisionSettled,
    PersonRead,
    PersonSaid,
    TeamEntry,
    VoteCast,
)
from thbridge.recording.bag.reading.reader import messages
from thbridge.ros import names
from thbridge.ros.messages import unpack
from thbridge.study.study_file import read_study_text

SECONDS = 15
SEATS = """\
seed: 7
robots: 2
dialogue: {condition: collaborator}
seats:
  - {name: driver, robots: [1, 2], names_treasures: false, sees_score: false}
  - {name: namer, sees_energy: false}
  - {name: judge, sees_map: false, sees_dialogues: own}
team: {agreement: {send: two, name: majority}}
"""


@pytest.fixture(scope="module")
def hunt(tmp_path_factory: pytest.TempPathFactory) -> Path:
    bag = tmp_path_factory.mktemp("seats") / "hunt.bag"
    setting = setting_of(read_study_text(bag, SEATS))
    programs = build_programs(setting, talking_participants(setting))
    opening = build_record(setting, PLAY, programs.names, "suggestion")
    with build_writer(setting, bag) as writer:
        session = open_session(setting, programs, SessionRecording([build_recorder(setting, opening, [writer])]))
        for _ in range(SECONDS * 50):
            session.step()
    return bag


def team_entries(bag: Path) -> Iterator[TeamEntry]:
    for message in messages(bag, [names.TEAM]):
        entry = from_json(unpack.game_event(message.data).json)
        assert isinstance(entry, TeamEntry)
        yield entry


def test_a_game_with_three_seats_texts_and_votes_is_the_same_again_to_the_last_bit(hunt: Path) -> None:
    assert_equal_replay(hunt, SECONDS * 50)


def test_a_recording_has_each_text_with_author_addressee_and_times(hunt: Path) -> None:
    entries = list(team_entries(hunt))
    said = [entry for entry in entries if isinstance(entry, PersonSaid)]
    assert Counter((each.seat, each.to) for each in said)["driver", ""] == 1
    assert {(each.seat, each.to) for each in said} >= {("namer", "driver"), ("judge", "driver"), ("driver", "judge")}
    assert said[0].typing <= said[0].at
    read = [entry for entry in entries if isinstance(entry, PersonRead)]
    assert {each.seat for each in read} == {"driver", "namer", "judge"}
    assert all(each.at >= said[each.line - 1].at for each in read)


def test_a_recording_has_each_vote_with_its_participants_and_outcome(hunt: Path) -> None:
    entries = list(team_entries(hunt))
    proposed = {entry.decision: entry for entry in entries if isinstance(entry, DecisionProposed)}
    cast = [entry for entry in entries if isinstance(entry, VoteCast)]
    settled = {entry.decision: entry for entry in entries if isinstance(entry, DecisionSettled)}
    assert {each.kind.value for each in proposed.values()} == {"send", "name"}
    assert all(vote.seat != proposed[vote.decision].seat for vote in cast)
    assert {each.outcome for each in settled.values()} == {DecisionOutcome.CARRIED}
    assert all(each.at >= proposed[number].at for number, each in settled.items())


def test_a_recording_has_what_each_seat_was_shown(hunt: Path) -> None:
    shown = [unpack.seat_notice(message.data) for message in messages(hunt, [names.SHOWN])]
    views = {
        seat: [json.loads(each.json) for each in shown if (each.seat, each.kind) == (seat, "View")]
        for seat in ("driver", "namer", "judge")
    }
    assert all(view["team"]["own"]["name"] == seat for seat, of_seat in views.items() for view in of_seat)
    assert {view["score"] for view in views["driver"]} == {0}
    assert max(view["score"] for view in views["judge"]) > 0
    assert {robot["energy"] for view in views["namer"] for robot in view["robots"]} == {1.0}
    texts = [
        line for each in shown if (each.seat, each.kind) == ("judge", "Talk") for line in json.loads(each.json)["lines"]
    ]
    assert {line["to"] for line in texts if line["seat"] != "judge"} <= {"", "judge"}


def test_utterances_and_the_report_name_the_seat(hunt: Path) -> None:
    said = [unpack.utterance(message.data) for message in messages(hunt, [names.UTTERANCES])]
    authors = {each.author for each in said if each.speaker == "human"}
    assert authors <= {"person driver", "person namer", "person judge"}
    assert {each.seat for each in said if each.speaker == "robot"} == {""}
    report = read_report(messages(hunt))
    who = {entry.who for entry in report.timeline}
    assert {"driver to robot 1", "namer", "judge"} <= who
