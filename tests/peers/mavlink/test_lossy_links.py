"""Missions and files of real clients over links that lose thirty per cent of all datagrams, both ways: whole."""

import json
import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from pymavlink.mavftp import MAVFTP

from tests.peers.mavlink.lossy_link import LossyLink, lossy_link
from tests.peers.mavutil_script import Script, mav
from tests.peers.rover_session import PEERS, needs, rovers
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.ports import free_udp_port
from tests.support.programs.processes import Program, until
from thbridge.mavlink.vehicle.component_files.metadata_files import checksum

LOSS = 0.3
STATION = Path(__file__).with_name("mavsdk_uploader.py")
PLACES = [(515_000_000 + 10 * seq, -1_000_000 - 7 * seq) for seq in range(6)]
"""Latitude and longitude, degrees times ten million."""

PATIENCE = 240.0
RATE = 2
"""Simulated seconds per second: robots are twice as quick to say again what was lost, and so is the script."""

SILENCE = 1.5 / RATE
"""Seconds after which the protocol has a station say again what it said last."""

REQUESTS = "MISSION_REQUEST_INT|MISSION_REQUEST|MISSION_ACK"


@pytest.fixture(scope="module")
def lossy(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Program, int, int, tuple[LossyLink, LossyLink]]]:
    """Robots, the ports where a script and MAVSDK are to listen, and their links."""
    script, mavsdk = free_udp_port(), free_udp_port()
    folder = tmp_path_factory.mktemp("lossy")
    with (
        lossy_link(script, LOSS, seed=1) as one,
        lossy_link(mavsdk, LOSS, seed=2) as other,
        rovers(folder, (one.port, other.port), "--rate", str(RATE)) as play,
    ):
        until("the robots to be reached", lambda: "MAVLink links of the robots" in play.text, [play])
        yield play, script, mavsdk, (one, other)


def uploaded(script: Script) -> None:
    """Send the mission as the protocol has it: what is asked for is sent, and said again after a silence.

    A robot that has asked in vain too often gives the transfer up, and says so: then it begins anew.
    """
    count = script.master.mav.mission_count_send, (1, 1, len(PLACES))
    said, words = count
    while True:
        said(*words)
        try:
            told = script.hears(REQUESTS, seconds=SILENCE)
        except TimeoutError:
            continue
        if told.get_type() == "MISSION_ACK" and told.type == mav.MAV_MISSION_OPERATION_CANCELLED:
            said, words = count
            continue
        if told.get_type() == "MISSION_ACK":
            assert told.type == mav.MAV_MISSION_ACCEPTED
            return
        said = script.master.mav.mission_item_int_send
        head = (1, 1, told.seq, mav.MAV_FRAME_GLOBAL_INT, mav.MAV_CMD_NAV_WAYPOINT, int(told.seq == 0), 1, 0, 0, 0, 0)
        words = (*head, *PLACES[told.seq], 0)


def item(script: Script, seq: int) -> tuple[int, int]:
    while True:
        script.master.mav.mission_request_int_send(1, 1, seq)
        try:
            told = script.hears("MISSION_ITEM_INT", lambda told: told.seq == seq, SILENCE)
        except TimeoutError:
            continue
        return told.x, told.y


@pytest.mark.slow
def test_a_script_s_mission_arrives(lossy: tuple[Program, int, int, tuple[LossyLink, LossyLink]]) -> None:
    _, port, _, (link, _) = lossy
    script = Script(f"udpin:127.0.0.1:{port}", 255)
    assert script.master.wait_heartbeat(timeout=PATIENCE) is not None
    script.follows(1)
    uploaded(script)
    assert [item(script, seq) for seq in range(len(PLACES))] == PLACES
    script.master.close()
    assert all(link.lost.values()), "or the link was not bad"


@pytest.mark.slow
def test_a_script_s_files_arrive(lossy: tuple[Program, int, int, tuple[LossyLink, LossyLink]], tmp_path: Path) -> None:
    _, port, _, _ = lossy
    script = Script(f"udpin:127.0.0.1:{port}", 255)
    assert script.master.wait_heartbeat(timeout=PATIENCE) is not None
    client = MAVFTP(script.master, target_system=1, target_component=1)
    client.cmd_set(["burst_read_size", "239"])
    for name in ("general.json", "parameters.json"):
        while not (tmp_path / name).exists():
            client.cmd_get([name, str(tmp_path / name)])
            client.process_ftp_reply("OpenFileRO", timeout=PATIENCE)
    script.master.close()
    (about,) = json.loads((tmp_path / "general.json").read_bytes())["metadataTypes"]
    assert about["fileCrc"] == checksum((tmp_path / "parameters.json").read_bytes())


@pytest.mark.slow
@needs("mavsdk")
def test_mavsdk_s_mission_arrives(lossy: tuple[Program, int, int, tuple[LossyLink, LossyLink]]) -> None:
    play, _, port, (_, link) = lossy
    orders = {"url": f"udpin://127.0.0.1:{port}", "robot": 2, "places": PLACES}
    done = run_peer(
        [PEERS / "mavsdk" / "bin" / "python", STATION],
        input=json.dumps(orders), timeout=PATIENCE,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr + play.text
    told = json.loads(done.stdout.splitlines()[-1])
    assert [tuple(place) for place in told["read"]] == PLACES
    assert all(link.lost.values()), "or the link was not bad"


@pytest.mark.slow
@needs("mavsdk")
def test_mavsdk_s_files_and_metadata_arrive(
    lossy: tuple[Program, int, int, tuple[LossyLink, LossyLink]], tmp_path: Path
) -> None:
    play, _, port, _ = lossy
    orders = {"url": f"udpin://127.0.0.1:{port}", "robot": 2, "folder": str(tmp_path), "bursts": [True]}
    done = run_peer(
        [PEERS / "mavsdk" / "bin" / "python", STATION.with_name("mavsdk_reader.py")],
        input=json.dumps(orders), timeout=PATIENCE,
        env={**os.environ, "HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")},
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr + play.text
    told = json.loads(done.stdout.splitlines()[-1])
    assert {name: len(content) for name, content in told["downloaded"]} == told["listed"]
    assert told["identical"] == [True] * 2
    assert told["metadata"] == json.loads(dict(told["downloaded"])["parameters.json"])
