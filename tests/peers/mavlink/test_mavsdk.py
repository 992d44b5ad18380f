"""MAVSDK, the SDK of the drone world, finds three robots on one UDP port and drives them; see mavsdk_station.py."""

import json
import math
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.peers.rover_session import ORIGIN, PEERS, ROBOTS, metres, needs, rovers, truth
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.ports import free_udp_port
from tests.support.programs.processes import THBRIDGE

pytestmark = needs("mavsdk")

STATION = Path(__file__).with_name("mavsdk_station.py")
PATIENCE = 240.0
DRIVE = ((0.0, 1.2), (0.0, -2.5))
"""Along the corridor in which the first robot starts, outside all rooms."""

MISSION = ((2.4, 1.4), (1.6, 0.6))
"""Before the second robot's start, outside all rooms."""

A_CENTIMETRE = 0.012
"""What 1e-7 of a degree is."""


@dataclass(frozen=True)
class Judged:
    """What MAVSDK saw, and what was recorded."""

    told: dict[str, Any]
    bag: Path


@pytest.fixture(scope="module", params=["generic", pytest.param("ardupilot", marks=pytest.mark.slow)])
def judged(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Judged:
    folder, port = tmp_path_factory.mktemp("mavsdk"), free_udp_port()
    orders = {
        "url": f"udpin://127.0.0.1:{port}",
        "origin": ORIGIN[:2],
        "robots": ROBOTS,
        "ardupilot": request.param == "ardupilot",
        "parameter": "SIM_ODOM_ALPHA1",
        "drive": DRIVE,
        "mission": MISSION,
    }
    with rovers(folder, (port,), "--identity", request.param) as play:
        done = run_peer(
            [PEERS / "mavsdk" / "bin" / "python", STATION],
            input=json.dumps(orders), timeout=PATIENCE,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr + play.text
    return Judged(json.loads(done.stdout.splitlines()[-1]), folder / "a.bag")


def test_every_robot_is_found_and_well(judged: Judged) -> None:
    assert judged.told["systems"] == [1, 2, 3]
    assert judged.told["types"] == ["ROVER"] * 3
    for around in judged.told["around"].values():
        assert around["battery"] == pytest.approx(100.0)
        assert math.dist(around["home"], around["at"]) < 0.05  # nobody has moved yet


def test_parameters_are_listed_read_set_and_refused(judged: Judged) -> None:
    told = judged.told["parameters"]
    assert told["integers"] == 0
    assert told["all"]["SIM_ODOM_ALPHA1"] == told["before"]
    assert told["after"] == pytest.approx(1.5 * told["before"])
    assert "DOES_NOT_EXIST" in told["unknown"]


def test_a_go_to_is_driven_and_a_hold_stops_it(judged: Judged) -> None:
    told = judged.told["drive"]
    assert not told["armed before"]
    assert told["held at"][1] < DRIVE[0][1]  # it was on its way
    assert math.dist(told["held at"], DRIVE[1]) > 1.0  # and far from there


def test_a_mission_comes_back_as_it_was_sent_is_driven_and_can_be_cleared(judged: Judged) -> None:
    told = judged.told["mission"]
    for sent, back in zip(told["sent"], told["downloaded"], strict=True):
        assert back == pytest.approx(sent, abs=1e-7)
    current, total = told["progress"][-1]
    assert current == total
    assert math.dist(told["ended at"], MISSION[-1]) < 0.3
    assert told["left"] == 0


def test_local_and_global_positions_are_the_truth(judged: Judged) -> None:
    poses = truth(judged.bag, 1)
    local, globe = judged.told["drive"]["local"], judged.told["drive"]["global"]
    assert len(local) > 20
    assert len(globe) > 20
    for told in local:
        pose = poses[told["time_boot_ms"]]
        assert (told["y"], told["x"]) == pytest.approx((pose.x, pose.y), abs=1e-4)
    for told in globe:
        pose = poses[told["time_boot_ms"]]
        assert metres(told["lat"] / 1e7, told["lon"] / 1e7) == pytest.approx((pose.x, pose.y), abs=A_CENTIMETRE)


@pytest.mark.slow
def test_what_mavsdk_did_is_done_again_by_a_replay_to_the_last_bit(judged: Judged) -> None:
    done = subprocess.run(
        [*THBRIDGE, "replay", "a.bag", "--json"], cwd=judged.bag.parent, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert json.loads(done.stdout)["equal"]
