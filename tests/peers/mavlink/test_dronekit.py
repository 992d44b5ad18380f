"""DroneKit, the library that most scripts for ArduPilot's rovers are written with; see dronekit_script.py."""

import json
import math
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.peers.rover_session import ORIGIN, PEERS, degrees, metres, needs, rovers, truth
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.ports import free_udp_port
from tests.support.programs.processes import THBRIDGE, until

pytestmark = [needs("dronekit"), pytest.mark.slow]

SCRIPT = Path(__file__).with_name("dronekit_script.py")
PATIENCE = 240.0
DRIVE = ((0.0, 0.9), (0.0, 0.0))
"""Along the corridor in which the first robot starts, outside all rooms."""

MISSION = ((0.2, -0.4), (0.0, -0.8))
ROOM, ITS_PLACE = (-2.3, 1.8), (-2.735, 1.442)

A_CENTIMETRE = 0.012
"""What 1e-7 of a degree is."""

OF_A_FLOAT = 2e-6
"""Degrees by which a 32-bit float is wrong at this latitude: 0.21 m."""


@dataclass(frozen=True)
class Judged:
    """What DroneKit saw, and what was recorded."""

    told: dict[str, Any]
    bag: Path


def judged(folder: Path, identity: str, room: tuple[float, float] | None = None) -> Judged:
    port = free_udp_port()
    orders = {
        "url": f"udpin:127.0.0.1:{port}",
        "ardupilot": identity == "ardupilot",
        "parameter": "SIM_ODOM_ALPHA1",
        "drive": [degrees(*point) for point in DRIVE],
        "mission": [degrees(*point) for point in MISSION],
        "room": None if room is None else degrees(*room),
    }
    with rovers(folder, (), "--udp", f"127.0.0.1:{port}/1", "--identity", identity) as play:
        # It has no patience with robots whose code is being compiled.
        until("the game to begin", lambda: "Game 1 begins" in play.text, [play])
        done = run_peer(
            [PEERS / "dronekit" / "bin" / "python", SCRIPT],
            input=json.dumps(orders), timeout=PATIENCE,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr + play.text
    return Judged(json.loads(done.stdout.splitlines()[-1]), folder / "a.bag")


@pytest.fixture(scope="module")
def ardupilot(tmp_path_factory: pytest.TempPathFactory) -> Judged:
    return judged(tmp_path_factory.mktemp("dronekit"), "ardupilot")


@pytest.fixture(scope="module")
def at_length(tmp_path_factory: pytest.TempPathFactory) -> Judged:
    return judged(tmp_path_factory.mktemp("dronekit"), "ardupilot", room=ROOM)


def test_it_is_ready_and_armable(ardupilot: Judged) -> None:
    told = ardupilot.told["well"]
    assert told["version"].startswith("APM:Rover-")
    assert told["capabilities"]["set_altitude_target_global_int"]
    assert (told["mode"], told["status"], told["armed"], told["ekf"]) == ("HOLD", "STANDBY", False, True)
    assert (told["fix"], told["battery"], told["heading"]) == (3, 100, 90)
    assert told["yaw"] == pytest.approx(math.pi / 2)
    assert metres(*told["home"][:2]) == pytest.approx((0.0, 0.0), abs=0.25)
    assert told["home"][2] == told["at"][2] == ORIGIN[2]


def test_it_is_armed_and_its_modes_are_changed_by_name(ardupilot: Judged) -> None:
    assert (ardupilot.told["mode"], ardupilot.told["status"]) == ("GUIDED", "ACTIVE")


def test_simple_goto_drives_no_faster_than_it_is_told(ardupilot: Judged) -> None:
    poses, drive = truth(ardupilot.bag, 1), ardupilot.told["drive"]
    began, ended = drive["local"][0][0], drive["local"][drive["slow"] - 1][0]
    ways = [pose.distance(poses[stamp + 20]) for stamp, pose in poses.items() if began <= stamp < ended]
    assert 0.3 < max(ways) / 0.02 < 0.61


def test_locations_are_the_truth(ardupilot: Judged) -> None:
    poses, drive = truth(ardupilot.bag, 1), ardupilot.told["drive"]
    assert len(drive["local"]) > 20
    assert len(drive["global"]) > 20
    for stamp, east, north in drive["local"]:
        assert (east, north) == pytest.approx((poses[stamp].x, poses[stamp].y), abs=1e-4)
    for stamp, latitude, longitude in drive["global"]:
        assert metres(latitude, longitude) == pytest.approx((poses[stamp].x, poses[stamp].y), abs=A_CENTIMETRE)


def test_a_mission_goes_up_comes_down_is_carried_out_and_cleared(ardupilot: Judged) -> None:
    told = ardupilot.told["mission"]
    for sent, back in zip(MISSION, told["downloaded"], strict=True):
        assert back == pytest.approx(degrees(*sent), abs=OF_A_FLOAT)
    assert told["at item"] == len(MISSION), "home is its first"
    assert math.dist(metres(*told["ended"]), MISSION[-1]) < 0.3
    assert told["left"] == 0


def test_a_velocity_that_is_said_once_holds_for_seconds(at_length: Judged) -> None:
    assert at_length.told["hand"]["moved for"] > 0.25, "more than a simulated second"


def test_what_is_refused_is_told_with_its_reason(ardupilot: Judged) -> None:
    assert ardupilot.told["no"] == ["A robot of a running game is not restarted.", "There is no mission."]


def test_parameters_are_listed_set_and_refused(ardupilot: Judged) -> None:
    told = ardupilot.told["parameters"]
    assert told["count"] > 100
    assert (told["taken"], told["refused"], told["unknown"]) == (True, False, False)
    assert told["heard"] == [["SIM_ODOM_ALPHA1", 2 * told["before"]]]
    assert told["after"] == 2 * told["before"]


def test_home_is_set_and_returned_to(at_length: Judged) -> None:
    told = at_length.told["home"]
    assert told["home"] == pytest.approx(degrees(*MISSION[0]), abs=2 * OF_A_FLOAT)
    assert math.dist(metres(*told["at"]), metres(*told["home"])) < 0.35


def test_a_room_is_gone_into_and_paid_for(at_length: Judged) -> None:
    assert math.dist(at_length.told["room"]["at"], ITS_PLACE) < 0.3


def test_it_is_given_back_and_can_be_connected_to_again(at_length: Judged) -> None:
    assert at_length.told["again"] is False


def test_what_dronekit_did_is_done_again_by_a_replay_to_the_last_bit(at_length: Judged) -> None:
    done = subprocess.run(
        [*THBRIDGE, "replay", "a.bag", "--json"], cwd=at_length.bag.parent, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert json.loads(done.stdout)["equal"]


def test_of_other_autopilots_it_knows_neither_modes_nor_home(tmp_path: Path) -> None:
    told = judged(tmp_path, "generic").told
    assert told["well"]["version"].startswith("UnknownAutoPilotRover-")
    assert told["well"]["fix"] == 3
    assert len(told["drive"]["local"]) > 20
    assert told["parameters"]["taken"]
