"""A participant at the real window, and a script at a robot of theirs: taken, asked for, sent on, given back."""

import json
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.peers.mavutil_script import Script, mav
from tests.peers.rover_session import STUDY, degrees
from tests.peers.window_player import Keys, on
from tests.support.programs.ports import free_udp_port
from tests.support.programs.processes import THBRIDGE, Program
from tests.support.windows.desktop import Desktop, needs_desktop

pytestmark = [needs_desktop, pytest.mark.slow]

ROOM_2, ROOM_4 = (-2.7, 1.4), (3.1, 4.9)
"""Points in these rooms of arena8."""


@pytest.fixture
def station() -> Script:
    return Script(f"udpin:127.0.0.1:{free_udp_port()}", 255)


@pytest.fixture
def played(screen: Desktop, station: Script, tmp_path: Path) -> Iterator[Program]:
    """`thbridge play --mavlink` on the desktop."""
    (tmp_path / "study.yaml").write_text(STUDY.replace("lost_after: 60", "lost_after: 600"))
    target = f"127.0.0.1:{station.master.port.getsockname()[1]}"
    vehicles = ("--mavlink", "--udp", target, "--identity", "ardupilot")
    play = on(screen, tmp_path, "play", "study.yaml", *vehicles, "--port", "0", "--bag", "a.bag", "--rate", "4")
    try:
        yield play
    finally:
        if play.process.poll() is None:
            play.stop()
        play.close()


def sends(station: Script, point: tuple[float, float]) -> None:
    latitude, longitude = degrees(*point)
    goal = (-1, 1, 0, 0, round(latitude * 1e7), round(longitude * 1e7), 0)
    station.master.mav.command_int_send(1, 1, mav.MAV_FRAME_GLOBAL_INT, mav.MAV_CMD_DO_REPOSITION, 0, 0, *goal)
    assert station.result(mav.MAV_CMD_DO_REPOSITION) == mav.MAV_RESULT_ACCEPTED


def test_a_participant_asks_for_a_robot_names_what_it_left_and_has_it_back(
    played: Program, screen: Desktop, station: Script, tmp_path: Path
) -> None:
    player = Keys(screen)
    player.rest()
    screen.focus_window("Treasure hunt")
    screen.found("Start with 3 robots")
    screen.press("Return")
    player.until("the game", lambda seen: len(seen.robots) == 3)
    assert station.master.wait_heartbeat(timeout=240) is not None
    station.follows(1)
    station.arms()
    player.until("the robot to be theirs", lambda seen: "commanded by ground station 255" in seen.robot(1))
    screen.picture(tmp_path / "taken.png")

    screen.press("b")
    told = station.hears("STATUSTEXT", lambda told: "asks" in told.text)
    assert (told.severity, told.text) == (mav.MAV_SEVERITY_NOTICE, "The participant asks for robot 1 back.")
    player.until("the button to say so", lambda seen: seen.named("Ask for robot 1 back, asked for"))
    screen.picture(tmp_path / "asked.png")

    station.master.set_mode("GUIDED")
    station.is_in("GUIDED")
    sends(station, ROOM_2)
    station.hears("STATUSTEXT", lambda told: told.text.startswith("Room 2: something"))
    player.until("what it found", lambda seen: seen.named("Robot 1 found something in room 2"))
    screen.picture(tmp_path / "found.png")
    sends(station, ROOM_4)
    player.until("it to be sent on", lambda seen: seen.named("Robot 1 found something in room 2 and was sent on"))
    screen.picture(tmp_path / "sent-on.png")
    player.insist("a name", lambda: screen.press("Down"), lambda seen: seen.picked)
    screen.press("Return")
    named = player.insist("the verdict", lambda: screen.press("Return"), lambda seen: seen.button("Close"))
    assert named.score != 0 and "commanded by ground station 255" in named.robot(1)
    screen.picture(tmp_path / "named.png")

    station.master.arducopter_disarm()
    player.until("the robot to be back", lambda seen: seen.robot(1) and "commanded" not in seen.robot(1))
    screen.picture(tmp_path / "back.png")
    screen.press("Escape")
    player.until("no pop-up", lambda seen: seen.pop is None)
    player.insist("a talk", lambda: screen.press("3"), lambda seen: seen.answers)
    player.insist("its way to room 3", lambda: screen.press("Return"), lambda seen: "to room 3" in seen.robot(1))
    screen.picture(tmp_path / "sent.png")
    screen.leave_game()
    assert played.process.wait(60) == 0, played.text
    done = subprocess.run(
        [*THBRIDGE, "replay", "a.bag", "--json"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert json.loads(done.stdout)["equal"]
