"""The player's page contains the recording, needs nothing else, and treats every recorded text as text."""

import base64
import hashlib
import json
import re
import zlib
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import msgspec
import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from tests.support.bags.foreign_bags import Robot, write
from tests.support.programs.commands import invoke
from tests.support.project import ROOT
from thbridge.analysis.report.builder import read_report
from thbridge.analysis.report.report import Report
from thbridge.app.session.broadcast import Broadcast
from thbridge.files.language_texts import shipped_texts
from thbridge.files.ros.definitions import Definitions
from thbridge.hunt.events import ObjectionRaised, ObjectionReason
from thbridge.hunt.rooms import Room, RoomNames
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.messages.session_records import GameEvent, UtteranceRecord
from thbridge.ros.publisher import RosMessage, TeamPublisher, Topic
from thbridge.study.study_file import Study
from ui.web.player.content import PlayedRecording
from ui.web.player.gathering import GameContext, floor_of, played_game
from ui.web.player.page import build_player, page_of, words_of

HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
MOST_BYTES = 5 * 1024 * 1024
"""Largest page of an hour of recording."""


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("player") / "a <b>.bag"
    with BagWriter(path, Definitions(())) as writer:
        recorder = Broadcast(TeamPublisher(2, MOUNT, SCAN_PERIOD), SESSION, arena(), [writer])
        for snapshot in snapshots(2, 300):
            recorder.record(snapshot, records(snapshot.tick))
    return path


@pytest.fixture(scope="module")
def page(bag: Path) -> str:
    return build_player(bag)


@pytest.fixture(scope="module")
def report(bag: Path) -> Report:
    return read_report(messages(bag))


def content_of(page: str) -> PlayedRecording:
    packed = re.search(r'id="recording">([^<]*)</script>', page)
    assert packed is not None
    return msgspec.json.decode(zlib.decompress(base64.b64decode(packed[1])), type=PlayedRecording)


class Elements(HTMLParser):
    """Collects the elements of a page, with their attributes, and the contents of scripts and style sheets."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.inside: dict[str, str] = {}
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        if self.elements and self.elements[-1][0] in ("script", "style"):
            tag, attributes = self.elements[-1]
            name = "data" if "id" in attributes else tag
            self.inside[name] = self.inside.get(name, "") + data

    def handle_endtag(self, tag: str) -> None:
        self.elements.append(("", {}))


def test_the_page_loads_nothing_and_only_its_own_script_and_styles_apply(page: str) -> None:
    found = Elements(page)
    loaded = {"src", "href", "xlink:href", "action", "srcset", "style"}
    assert [element for element in found.elements if loaded & set(element[1])] == []
    assert not {"link", "iframe", "img", "object", "base"} & {tag for tag, _ in found.elements}
    assert "@import" not in page
    assert "url(" not in page
    policy = next(str(attributes["content"]) for tag, attributes in found.elements if "http-equiv" in attributes)
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    for tag in ("script", "style"):
        digest = base64.b64encode(hashlib.sha256(found.inside[tag].encode()).digest()).decode()
        assert rules[f"{tag}-src"] == f"'sha256-{digest}'"
    assert rules["default-src"] == rules["base-uri"] == rules["form-action"] == "'none'"


def test_a_recorded_text_never_becomes_html(report: Report) -> None:
    said = UtteranceRecord(1, "robot", 0, 1, "select-room", HOSTILE, "claim", "robot")
    event = GameEvent("exploded", 0, None, f'{{"event": "exploded", "text": "{HOSTILE}"}}')
    hostile = replace(
        report,
        tracks=(replace(report.tracks[0], name=HOSTILE), *report.tracks[1:]),
        utterances=((1.0, said),),
        events=((1.0, event), (2.0, replace(event, json="not JSON " + HOSTILE))),
        rooms=RoomNames.of([(1, HOSTILE)]),
        missing=(HOSTILE,),
    )
    game = played_game(hostile, GameContext(None, shipped_texts()), several=False)
    assert {entry.text for entry in game.entries} == {
        HOSTILE,
        f"exploded: text {HOSTILE}",
        f"exploded: not JSON {HOSTILE}",
    }
    assert game.robots[0].name == HOSTILE
    assert report.grid is not None
    floor = floor_of(report.grid, (), hostile.rooms, Study())
    made = page_of(PlayedRecording("en", words_of(shipped_texts()), floor, (), (game,)), f"{HOSTILE}.bag", HOSTILE)
    assert content_of(made).games == (game,)
    tags = [tag for tag, _ in Elements(made).elements]
    assert tags.count("script") == 2
    assert "img" not in tags


def test_words_of_the_bag_are_text(page: str) -> None:
    assert "a &lt;b&gt;.bag" in page
    assert "Müller&#39;s £ study" in page


def test_the_same_bag_gives_the_same_page(bag: Path, page: str) -> None:
    assert build_player(bag) == page


def test_the_page_has_the_robots_poses_and_values_of_the_recording(page: str, report: Report) -> None:
    (game,) = content_of(page).games
    assert game.duration == pytest.approx(report.duration)
    assert [robot.name for robot in game.robots] == ["Robot 1", "Robot 2"]
    for robot, track in zip(game.robots, report.tracks, strict=True):
        assert robot.pose is not None
        times = 0.01 * np.cumsum(robot.pose.times)
        for column, values in enumerate(robot.pose.values[:2], start=1):
            shown = np.interp(track.truth[:, 0], times, 0.001 * np.cumsum(values))
            assert np.abs(shown - track.truth[:, column]).max() < 0.02
        assert robot.error is not None
        shown = np.interp(
            track.errors[:, 0], 0.01 * np.cumsum(robot.error.times), 0.001 * np.cumsum(robot.error.values[0])
        )
        assert np.abs(shown - track.errors[:, 1]).max() < 0.004
        assert robot.energy is not None
        assert 0.1 * sum(robot.energy.values[0]) == pytest.approx(track.energy[-1, 1], abs=0.05)
        assert [drive.arrived for drive in robot.drives] == [each.outcome == "arrived" for each in track.attempts]


def test_the_transcript_has_what_was_said_found_and_decided(page: str) -> None:
    (game,) = content_of(page).games
    marks = [entry.mark for entry in game.entries]
    assert marks.count("said") == len([entry for entry in game.entries if entry.speaker]) == 6
    first = next(entry for entry in game.entries if entry.mark == "said")
    assert (first.who, first.text, first.robot) == ("Robot 1", "It will cost me £1 to go there", 0)
    assert [entry.at for entry in game.entries] == sorted(entry.at for entry in game.entries)
    assert game.score is not None
    assert [sum(game.score.values[0][: count + 1]) for count in range(6)] == [-20, -10, 0, 10, 20, 30]


def test_the_words_are_those_of_the_language(bag: Path) -> None:
    german = build_player(bag, language="de")
    assert '<html lang="de">' in german
    assert "<h1>Aufgezeichnete Schatzsuche</h1>" in german
    assert next(entry for entry in content_of(german).games[0].entries if entry.speaker).who == "Roboter 1"


def test_a_foreign_bag_says_what_is_missing(tmp_path: Path) -> None:
    path = tmp_path / "foreign.bag"
    with BagWriter(path, Definitions(())) as writer:
        writer.write(RosMessage(Topic("/chatter", "std_msgs/String"), 1, b"\x02\x00\x00\x00hi"))
    content = content_of(build_player(path))
    assert content.floor is None
    assert content.games[0].robots == ()
    assert any(sentence.startswith("No map:") for sentence in content.games[0].missing)


def test_robots_of_a_bag_without_a_map_drive_on_an_empty_floor(tmp_path: Path) -> None:
    path = tmp_path / "other.bag"
    write(path, Robot(), 3.0)
    content = content_of(build_player(path))
    (robot,) = content.games[0].robots
    assert robot.pose is not None
    assert content.floor is not None
    left, bottom, right, top = content.floor.box
    for lowest, highest, values in ((left, right, robot.pose.values[0]), (bottom, top, robot.pose.values[1])):
        places = 0.1 * np.cumsum(values)
        assert lowest + 99.0 <= places.min()
        assert places.max() <= highest - 99.0


@pytest.mark.parametrize("language", ["en", "de"])
def test_every_recorded_event_has_its_words(language: str, report: Report) -> None:
    lines = (ROOT / "tests" / "thbridge" / "hunt" / "recorded_events.jsonl").read_text().splitlines()
    recorded = [json.loads(line) for line in lines]
    events = [
        (float(at), GameEvent(fields["event"].replace("-", ""), fields.get("robot"), fields.get("room"), line))
        for at, (line, fields) in enumerate(zip(lines, recorded, strict=True))
    ]
    texts = shipped_texts(language)
    game = played_game(replace(report, events=tuple(events), utterances=()), GameContext(None, texts), several=True)
    shown = {entry.at for entry in game.entries if not entry.speaker}
    silent = {"hidden", "agreed", "advised", "priced", "talk", "said", "key"}
    assert shown == {float(at) for at, fields in enumerate(recorded) if fields["event"] not in silent}
    assert not any("£" in entry.text for entry in game.entries)
    # Names may contain lone surrogates.
    assert page_of(PlayedRecording(language, words_of(texts), None, (), (game,)), "a.bag", "")


def test_a_large_map_is_drawn_at_a_lower_resolution() -> None:
    cells = np.zeros((1200, 1200), dtype=np.int8)
    cells[0], cells[-1], cells[:, 0], cells[:, -1] = 100, 100, 100, 100
    floor = floor_of(OccupancyGrid(cells, 0.05, Pose2(-5.0, -5.0, 0.0)), (), RoomNames(), Study())
    assert floor.resolution == pytest.approx(10.0)
    assert floor.box == (-500, -500, 5500, 5500)
    assert floor.walls == "M1 1V599H599V1H1ZM0 0H600V600H0V0Z" or floor.walls.count("Z") == 2


def test_the_command_writes_the_page_next_to_the_bag(bag: Path) -> None:
    done = invoke("report", str(bag), "--player")
    assert done.exit_code == 0, done.output
    assert content_of((bag.parent / "a <b>-player.html").read_text()).language == "en"


def test_a_language_that_is_not_built_in_is_refused(bag: Path) -> None:
    for options, words in (
        (("--player", "--language", "xx"), "Choose one of de, en"),
        (("--language", "de"), "Add --player"),
    ):
        done = invoke("report", str(bag), *options)
        assert done.exit_code == 2
        assert words in " ".join(done.output.split())


@pytest.mark.slow
def test_an_hour_of_ten_robots_needs_at_most_five_megabytes(report: Report) -> None:
    """The values change as often as those of a recorded hunt: drives, pauses, and noise that a localizer corrects."""
    times = np.arange(0.0, 3600.0, 0.05)
    tracks = []
    for robot in range(10):
        moving = (times + 7.0 * robot) % 22.0 < 18.0
        heading = np.cumsum(0.05 * moving * 0.9 * np.sin(times / (2.0 + robot / 7.0)))
        steps = 0.05 * 0.45 * moving
        truth = np.column_stack(
            (times, np.cumsum(steps * np.cos(heading)), np.cumsum(steps * np.sin(heading)), heading)
        )
        wrong = 0.02 + 0.015 * np.sin(np.cumsum(0.05 * moving * 3.1)) * np.sin(times / 3.0 + robot)
        estimate = truth + np.column_stack((0.0 * times, wrong, -wrong, 0.2 * wrong))
        errors = np.column_stack((times, np.hypot(wrong, wrong), np.abs(0.2 * wrong)))
        spread = np.column_stack((times[::10], 0.02 + 0.01 * np.sin(times[::10]), 0.01 + 0.004 * np.sin(times[::10])))
        energy = np.column_stack((times, 100.0 - times / 60.0))
        tracks.append(
            replace(report.tracks[0], name=f"robot{robot + 1}", truth=truth, estimate=estimate, errors=errors,
                    deviations=spread, energy=energy)
        )  # fmt: skip
    said = UtteranceRecord(
        1, "robot", 0, 1, "select-room", "Room 2 (West) would be best for me. Shall I go?", "claim", "robot"
    )
    hour = replace(
        report, duration=3600.0, tracks=tuple(tracks), utterances=tuple((float(second), said) for second in range(3600))
    )
    game = played_game(hour, GameContext(None, shipped_texts()), several=False)
    floor = floor_of(arena(), (), RoomNames(), Study())
    made = page_of(PlayedRecording("en", words_of(shipped_texts()), floor, (), (game,)), "hour.bag", "")
    assert len(made.encode()) < MOST_BYTES


def test_an_objection_is_in_the_transcript(report: Report) -> None:
    raised = ObjectionRaised(1, "namer", 0, Room(3), ObjectionReason.TOO_FAR, "Look.", 1, 2.0)
    game = played_game(replace(report, team=((2.0, raised),)), GameContext(None, shipped_texts()), several=False)
    (entry,) = [entry for entry in game.entries if "objects" in entry.text]
    assert (entry.at, entry.robot) == (2.0, 0)
    assert entry.text.endswith("objects: That room is too far. “Look.”")
