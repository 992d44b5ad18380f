"""A hunt that a ground station plays alone, while the participant's window follows it; and its recording, run again."""

import json
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import accumulate, groupby, pairwise
from pathlib import Path
from typing import Any

import pytest

from tests.peers.mavlink_hunter import OWN, Hunter
from tests.peers.ros_programs import NEEDS_ROS, Ros, clean
from tests.peers.window_player import Player, Sight, on
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.ports import free_port, free_udp_port
from tests.support.programs.processes import THBRIDGE, Program, until
from tests.support.windows.desktop import Seen, desktop, needs_desktop
from thbridge.analysis.report.builder import read_report
from thbridge.app.compose.game import build_briefing
from thbridge.app.compose.setting import read_setting
from thbridge.app.replay.mavlink_replay import hunt_result_of
from thbridge.recording.bag.reading.reader import messages
from thbridge.study.study_file import load_study

pytestmark = pytest.mark.slow

STUDY = """\
map: arena8
templates: original-2016
robots: 2
seed: 3
server:
  port: 0
game:
  energy: 55
mavlink:
  lost_after: 60
"""
"""With so much energy a robot gets to two rooms."""

RATE = "4"
"""Simulated seconds per second. The hunter goes by the clock, which is why it may be silent for so long."""

WAYS = {1: (5, 2, 6), 2: (4, 8, 1)}
"""Where robot 1 is led, and where robot 2's mission leads: neither gets to the last.

All of it is far from one another, so that nobody travels too shortly to be seen.
"""

GUESS = 1
"""The number of what robot 2 calls everything."""


@contextmanager
def hunter(folder: Path, study: str = STUDY) -> Iterator[tuple[Hunter, tuple[str, ...]]]:
    """Somebody who knows the house of a study, and what else robots have to be started with."""
    (folder / "study.yaml").write_text(study)
    setting = read_setting(load_study(folder / "study.yaml").value, folder)
    goals = {number: (room.goal.x, room.goal.y) for number, room in enumerate(setting.map.rooms, 1)}
    port = free_udp_port()
    with Hunter(port, goals, build_briefing(setting).names) as hunter:
        yield hunter, ("study.yaml", "--mavlink", "--udp", f"127.0.0.1:{port}", "--bag", "hunt.bag", "--rate", RATE)


def thbridge(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*THBRIDGE, *arguments], cwd=folder, capture_output=True, text=True, check=False)


def frames_again(folder: Path, bag: str, *arguments: str) -> dict[str, Any]:
    """What `thbridge mavlink replay` tells."""
    done = thbridge(folder, "mavlink", "replay", bag, "--json", *arguments)
    assert done.returncode == 0, done.stdout + done.stderr
    told = json.loads(done.stdout)
    assert isinstance(told, dict)
    return told


def departures(bag: Path) -> dict[int, list[int | None]]:
    """The rooms that each robot set out for."""
    moments = [moment for moment in read_report(messages(bag)).timeline if moment.kind == "departed"]
    return {robot: [moment.room for moment in moments if moment.who == f"robot {robot}"] for robot in (1, 2)}


@dataclass(frozen=True)
class Followed:
    """A hunt that a ground station played, as it was seen in the window and by the station.

    Attributes:
        sights: of the window, from the beginning of the game to its end.
        refused: the same when the participant had tried to send a robot that was not theirs.
    """

    folder: Path
    sights: tuple[Sight, ...]
    refused: Sight
    arrivals: list[tuple[int, int]]
    score: int


@pytest.fixture(scope="module")
def followed(tmp_path_factory: pytest.TempPathFactory) -> Followed:
    """One is led from room to room, the other has a mission."""
    folder = tmp_path_factory.mktemp("followed")
    with desktop() as screen, hunter(folder) as (station, options):
        play = on(screen, folder, "play", *options)
        try:
            player = Player(screen)
            screen.focus_window("Treasure hunt")
            screen.click(screen.rested("Start with"))
            player.until("the game", lambda seen: seen.rooms)
            station.lead(1, WAYS[1])
            station.upload(2, WAYS[2], GUESS)
            commanded = player.until("robots to be commanded", lambda seen: all(map(_commanded, seen.robots)))
            screen.click(commanded.rooms[3])
            screen.press("6")
            refused = player.look()
            sights = [commanded]

            def is_over() -> bool:
                sights.append(player.look())
                assert play.process.poll() is None, play.text
                return sights[-1].over

            screen.wait("the end of the game", is_over, 200.0)
            # The look that found the end may have begun before it, and the station may not have heard of it yet.
            sights.append(player.until("what the station knows", lambda seen: station.over and agree(seen, station)))
            screen.picture(folder / "over.png")
            screen.ask_to_close(screen.focus_window("Treasure hunt"))
            assert play.process.wait(60) == 0, play.text
        finally:
            play.close()
    return Followed(folder, tuple(sights), refused, station.arrivals, station.score)


def agree(seen: Sight, station: Hunter) -> bool:
    """Whether the window shows the score and the rooms that the station was told of."""
    return seen.score == station.score and seen.visited == sorted(room for _, room in station.arrivals)


def _commanded(card: Seen) -> bool:
    return f"commanded by ground station {OWN}" in card.name


@needs_desktop
def test_the_window_tells_who_commands_and_what_robots_do(followed: Followed) -> None:
    told = [sight.robot(robot) for sight in followed.sights for robot in (1, 2)]
    assert all(map(_commanded, (card for sight in followed.sights for card in sight.robots)))
    for robot, room in followed.arrivals:
        assert any(f"Robot {robot}," in card and f"traveling to room {room}" in card for card in told)


@needs_desktop
def test_the_participant_sends_none_of_them_and_is_told_why(followed: Followed) -> None:
    why = f"Robot 1 is commanded by ground station {OWN}. You get it back when the ground station releases it."
    for number, room in followed.sights[0].rooms.items():
        assert "not possible at the moment" in room.name
        assert room.description.startswith(why), number
    assert "traveling to room 3" not in followed.refused.robot(1)
    assert departures(followed.folder / "hunt.bag") == {robot: list(ways[:-1]) for robot, ways in WAYS.items()}


@needs_desktop
def test_window_station_and_recording_agree(followed: Followed) -> None:
    hunt, end = hunt_result_of(followed.folder / "hunt.bag"), followed.sights[-1]
    assert len(followed.arrivals) >= 4
    assert list(hunt.order) == followed.arrivals
    assert sorted(room for _, room in followed.arrivals) == end.visited
    assert followed.score == hunt.score == end.score != 0
    moments = read_report(messages(followed.folder / "hunt.bag")).timeline
    # What was too quick for the eye is not missed.
    scores = accumulate((moment.points for moment in moments if moment.points is not None), initial=0)
    assert all(score in scores for score, _ in groupby(sight.score for sight in followed.sights))
    # A look takes a moment, in which more than one may be reached; what it misses came after all that was seen before.
    order = [room for _, room in hunt.order]
    for before, now in pairwise(followed.sights):
        came, missed = ([order.index(room) for room in rooms] for rooms in (before.visited, {*order} - {*now.visited}))
        assert max(came, default=-1) < min(missed, default=len(order))


@needs_desktop
def test_the_recording_is_run_again_bit_for_bit(followed: Followed) -> None:
    done = thbridge(followed.folder, "replay", "hunt.bag")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "are the same, bit for bit" in done.stdout


@needs_desktop
def test_its_frames_alone_lead_to_the_same_rooms_in_the_same_order_and_to_the_same_score(followed: Followed) -> None:
    told = frames_again(followed.folder, "hunt.bag")
    assert told["same"]
    assert told["replayed"] == told["recorded"]
    assert told["replayed"]["score"] == followed.score
    assert told["parted"] is None


@pytest.mark.slow
@needs_desktop
def test_with_another_seed_they_come_to_something_else_and_it_is_told(followed: Followed) -> None:
    done = thbridge(followed.folder, "mavlink", "replay", "hunt.bag", "--with", "seed=4")
    assert done.returncode == 0
    assert "the pose of a robot was not as recorded" in done.stdout


@pytest.mark.slow
@needs_desktop
@NEEDS_ROS
def test_a_recording_without_what_came_from_outside_still_has_the_frames(followed: Followed) -> None:
    filtered = ["rosbag", "filter", "hunt.bag", "filtered.bag", "topic != '/inputs'"]
    run_peer(filtered, cwd=followed.folder, env=clean()).check_returncode()
    done = thbridge(followed.folder, "replay", "filtered.bag")
    assert done.returncode == 1
    assert "thbridge mavlink replay" in done.stderr
    told = frames_again(followed.folder, "filtered.bag")
    assert told["replayed"] == told["recorded"]
    assert told["replayed"]["score"] == followed.score


@pytest.mark.slow
@needs_desktop
@NEEDS_ROS
def test_rosbag_play_sends_robots_on_a_live_graph_to_the_same_rooms(followed: Followed, tmp_path: Path) -> None:
    port, pace = free_port(), "2"
    graph = ("--ros", "--ros-master", f"http://127.0.0.1:{port}", "--outside", "TabUI", "--headless", "--no-report")
    (tmp_path / "study.yaml").write_text(STUDY)
    play = Program(
        tmp_path, "play", "study.yaml", "--mavlink", "--udp", f"127.0.0.1:{free_udp_port()}",
        "--bag", "again.bag", "--rate", pace, *graph,
    )  # fmt: skip
    try:
        until("the session to be on the graph", lambda: "this program is the master" in play.text, [play])
        ros = Ros(port, tmp_path)
        ros.says("rostopic", "echo", "-n", "1", "/robot1/odom/header/seq")
        topics = ("/robot1/mavlink/to", "/robot2/mavlink/to")
        recorded = str(followed.folder / "hunt.bag")
        ros.says("rosbag", "play", "-q", "--wait-for-subscribers", "-r", pace, recorded, "--topics", *topics)
        until("the game to be over", lambda: "The game is over" in play.text, [play], 30.0)
        assert play.process.wait(60) == 0
    finally:
        play.close()
    was, now = departures(followed.folder / "hunt.bag"), departures(tmp_path / "again.bag")
    # rosbag keeps to the clock, and simulated time may lag: a robot may be sent on before it has arrived.
    assert now[1][: len(was[1])] == was[1]
    assert now[2] == was[2]
    assert thbridge(tmp_path, "replay", "again.bag").returncode == 0
