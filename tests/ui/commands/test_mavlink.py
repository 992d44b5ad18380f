"""`thbridge mavlink` from the user's seat, with robots at the other end of real sockets, on a thread of their own."""

import asyncio
import json
import math
import socket
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import Result

from tests.support.mavlink.recorded_stations import Station, record
from tests.support.mavlink.vehicle_with_stations import OPTIONS, Game
from tests.support.programs.commands import invoke
from tests.support.programs.ports import free_port
from tests.support.programs.processes import Program, until
from thbridge.app.session.session import Session
from thbridge.mavlink.files.signing_timestamps import TimestampFile
from thbridge.mavlink.hub import Hub
from thbridge.mavlink.sockets.server import MavlinkPorts, MavlinkServer
from thbridge.mavlink.station import ground_station, trip
from thbridge.mavlink.values.vehicle_interface import Denied
from thbridge.mavlink.vehicle.vehicle import Vehicle
from thbridge.mavlink.wire.dialect import crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.signing import SigningKey, parse_key
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.mavlink.wire.traffic import FrameOutcome
from thbridge.sockets.addresses import Address, UdpTarget


class Fleet:
    """Two robots that speak to an address, and listen by TCP; they arrive as soon as they are sent."""

    def __init__(self, address: Address, key: SigningKey | None) -> None:
        self.games = [Game(), Game()]
        self.tcp = 0
        self._hub = Hub([Vehicle(number, game, OPTIONS) for number, game in enumerate(self.games, 1)], 5.0)
        self._links = 0
        self._server = MavlinkServer(MavlinkPorts((UdpTarget(address),), Address("127.0.0.1", 0), key))
        self._over = False
        self._stands = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._run()))

    def __enter__(self) -> "Fleet":
        self._thread.start()
        assert self._stands.wait(60)
        return self

    def __exit__(self, *_: object) -> None:
        self._over = True
        self._thread.join()

    def open_link(self, name: str, robot: int | None = None) -> LinkId:
        link = LinkId(self._links)
        self._links += 1
        self._hub.open(link, name, robot)
        return link

    def link(self, link):
        return self._hub.link(link)

    def close_link(self, link: LinkId) -> None:
        self._hub.close(link)

    def receive_frame(self, link, frame) -> FrameOutcome:
        return self._hub.receive(link, frame)

    async def _run(self) -> None:
        names = await self._server.open()
        assert isinstance(names, list)
        self.tcp = int(names[1].rpartition(":")[2])
        await self._server.serve(self)
        self._stands.set()
        tick = 0
        while not self._over:
            self._server.transmit(self._hub.step(tick, [game.readings for game in self.games]))
            for game in self.games:
                if game.readings.under_way and tick % 10 == 0:
                    game.arrive()
            tick += 1
            await asyncio.sleep(0.01)
        await self._server.close()


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """For tests in which nobody answers: in all others a busy machine may take its time."""
    monkeypatch.setattr(trip, "DISCOVERY_TIMEOUT", 1.0)
    monkeypatch.setattr(ground_station, "TRIES", 2)


@pytest.fixture
def at() -> Address:
    return Address("127.0.0.1", free_port(socket.SOCK_DGRAM))


@pytest.fixture
def fleet(at: Address) -> Iterator[Fleet]:
    with Fleet(at, None) as fleet:
        yield fleet


def mavlink(*arguments: object) -> Result:
    return invoke("mavlink", *arguments)


def failure(*arguments: object) -> str:
    """Return the message of a command that fails."""
    done = mavlink(*arguments)
    assert done.exit_code == 1, (done.output, done.exception)
    assert done.stdout == ""
    return done.stderr


def refusal(*arguments: object) -> str:
    done = mavlink(*arguments)
    assert done.exit_code == 2, (done.output, done.exception)
    return done.stderr


@pytest.mark.parametrize("by", ["udp", pytest.param("tcp", marks=pytest.mark.slow)])
def test_status_tells_who_is_there(by: str, at: Address, fleet: Fleet) -> None:
    where = at if by == "udp" else f"tcp:127.0.0.1:{fleet.tcp}"
    done = mavlink("status", where, "--seconds", 2.5, "--json")
    assert done.exit_code == 0, done.output
    robots = json.loads(done.stdout)["robots"]
    assert [robot["robot"] for robot in robots] == [1, 2]
    for robot in robots:
        assert (robot["mode"], robot["armed"], robot["commander"]) == ("HOLD", False, "participant")
        assert (robot["x"], robot["y"], robot["energy"], robot["lost"]) == (1.0, 2.0, 1.0, 0)
        assert robot["latitude"] == pytest.approx(52.4, abs=0.001)
        assert robot["frames_per_second"] > 5


def test_status_for_people(at: Address, fleet: Fleet) -> None:
    done = mavlink("status", at, "--seconds", 2.0)
    assert done.exit_code == 0
    assert "participant" in done.stdout


def test_goto_takes_command_waits_and_gives_it_back(at: Address, fleet: Fleet) -> None:
    done = mavlink("goto", 2, -1.5, 3, "--at", at, "--heading", 90)
    assert done.exit_code == 0, done.output
    assert done.stdout == "Robot 2 is at x 1.00 m, y 2.00 m.\n"
    names = [call[0] for call in fleet.games[1].asked]
    assert names.index("take") < names.index("go_to") < names.index("release")
    (went,) = fleet.games[1].calls("go_to")
    assert went[:3] == ("go_to", -1.5, 3.0)
    assert went[3] == pytest.approx(1.5707963, abs=1e-4)
    assert fleet.games[0].asked == []


def test_goto_may_keep_the_command(at: Address, fleet: Fleet) -> None:
    assert mavlink("goto", 1, 3, 3, "--at", f"tcp:127.0.0.1:{fleet.tcp}", "--keep").exit_code == 0
    assert fleet.games[0].calls("release") == []


def test_a_robot_that_does_not_want_to(at: Address, fleet: Fleet) -> None:
    fleet.games[0].refusal = Denied("Robot 1 has not enough energy.")
    assert failure("goto", 1, 0, 0, "--at", at) == "Robot 1 has not enough energy.\n"


@pytest.mark.usefixtures("impatient")
def test_a_robot_that_is_not_there(at: Address, fleet: Fleet) -> None:
    assert "Robot 7 sends nothing; robots that send: 1, 2." in failure("goto", 7, 0, 0, "--at", at)


def test_nobody_there(at: Address) -> None:
    assert f"{at}: no program sends MAVLink there. Start `thbridge play --mavlink`" in failure(
        "status", at, "--seconds", 0.2
    )


def test_an_address_that_another_program_has(at: Address) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind((at.host, at.port))
        message = failure("status", at, "--seconds", 0.2)
    assert f"{at}: this address belongs to another program or machine, and no robot answers." in message


def test_a_robot_that_waits_to_be_spoken_to(at: Address) -> None:
    """Another program has the address, as behind a router."""
    beat = mav.MAVLink_heartbeat_message(mav.MAV_TYPE_GROUND_ROVER, 0, 1, 0, 4, 3)
    frame = Frame(5, 1, 0, beat.get_msgId(), payload_of(beat), crc_extra(beat.get_msgId()) or 0)

    def answer() -> None:
        _, asker = robot.recvfrom(1024)
        robot.sendto(frame.to_bytes(), asker)

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as robot:
        robot.bind((at.host, at.port))
        thread = threading.Thread(target=answer)
        thread.start()
        done = mavlink("status", at, "--seconds", 1.0, "--json")
        thread.join()
    (robot,) = json.loads(done.stdout)["robots"]
    assert (robot["robot"], robot["commander"], robot["x"]) == (5, None, None)


def test_a_connection_that_nobody_takes(at: Address) -> None:
    assert "Connection refused. Start robots there" in failure("status", f"tcp:{at}")


def test_a_host_that_there_is_not() -> None:
    assert "no.such.host.invalid:14550" in failure("status", "no.such.host.invalid:14550")


@pytest.mark.parametrize("text", ["here", "127.0.0.1", "tcp:5760", "127.0.0.1:0", "::1:14550"])
def test_an_address_that_is_none(text: str) -> None:
    assert f"HOST:PORT: '{text}' is not an address. Write HOST:PORT" in refusal("status", text)
    assert f"--at: '{text}' is not an address" in refusal("goto", 1, 0, 0, "--at", text)


@pytest.mark.parametrize("point", [("nan", "0"), ("0", "inf"), ("1e9", "0")])
def test_a_point_that_is_none(point: tuple[str, str]) -> None:
    assert "is not within -100,000 to 100,000" in refusal("goto", 1, *point)


# Keys


@pytest.fixture
def key(tmp_path: Path) -> Path:
    path = tmp_path / "key"
    path.write_text("a passphrase\n")
    path.chmod(0o600)
    return path


@pytest.fixture
def signed(at: Address) -> Iterator[Fleet]:
    secret = parse_key(b"a passphrase\n")
    assert isinstance(secret, SigningKey)
    with Fleet(at, secret) as fleet:
        yield fleet


def test_a_key_opens(at: Address, signed: Fleet, key: Path) -> None:
    assert mavlink("goto", 1, 0, 0, "--at", at, "--signing-key", key).exit_code == 0


def test_what_robots_said_to_one_command_is_known_to_the_next(at: Address, signed: Fleet, key: Path) -> None:
    assert mavlink("goto", 1, 0, 0, "--at", at, "--signing-key", key).exit_code == 0
    known = TimestampFile(key, ".station").read()
    assert known is not None and known.streams
    assert mavlink("status", at, "--signing-key", key, "--seconds", 0.9).exit_code == 0
    later = TimestampFile(key, ".station").read()
    assert later is not None
    assert later.streams.keys() >= known.streams.keys() and later.latest > known.latest


def test_a_wrong_key(at: Address, signed: Fleet, key: Path) -> None:
    key.write_text("another\n")
    message = failure("status", at, "--signing-key", key, "--seconds", 0.9)
    assert f"frames were refused, because they are not signed with the key in {key}." in " ".join(message.split())


@pytest.mark.usefixtures("impatient")
def test_a_key_that_is_missing(at: Address, signed: Fleet) -> None:
    message = failure("goto", 1, 0, 0, "--at", at)
    assert "Robot 1 does not answer. If the robot requires signed frames, add --signing-key." in message


@pytest.mark.usefixtures("impatient")
def test_a_key_that_robots_do_not_have(at: Address, fleet: Fleet, key: Path) -> None:
    assert "frames were refused" in failure("goto", 1, 0, 0, "--at", at, "--signing-key", key)


def test_a_key_file_that_is_not_there(at: Address) -> None:
    assert "the signing key cannot be read" in refusal("status", at, "--signing-key", "nowhere")


# Recordings


def test_a_recording_that_is_none(tmp_path: Path) -> None:
    assert "no such file" in refusal("replay", tmp_path / "none.bag")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A moment of a hunt in which a ground station takes command."""
    bag = tmp_path_factory.mktemp("recorded") / "hunt.bag"

    def take(tick: int, session: Session) -> None:
        if tick == 20:
            station = Station(session)
            station.beat()
            arm = mav.MAV_CMD_COMPONENT_ARM_DISARM
            station.say(mav.MAVLink_command_long_message(1, 1, arm, 0, 1, 0, 0, 0, 0, 0, 0))

    record(bag, 60, take)
    return bag


def test_a_recordings_frames_drive_a_fresh_hunt(recorded: Path, tmp_path: Path) -> None:
    kept = tmp_path / "again.bag"
    done = mavlink("replay", recorded, "--to", kept, "--json")
    assert done.exit_code == 0, done.output
    result = json.loads(done.stdout)
    assert (result["frames"], result["ticks"], result["same"], result["parted"], result["bag"]) == (
        3,
        60,
        True,
        None,
        str(kept),
    )
    assert kept.exists()


def test_a_replay_for_people(recorded: Path) -> None:
    done = mavlink("replay", recorded, "--with", "seed=2")
    assert done.exit_code == 0, done.output
    assert "Robot 1 is now commanded by ground station 255." in done.stdout


def test_a_replay_in_two_studies(recorded: Path, tmp_path: Path) -> None:
    message = refusal("replay", recorded, tmp_path / "s.yaml", "--with", "seed=2")
    assert "--with: this option changes the study in the recording, but a study file is given." in message


def test_a_replay_onto_itself(recorded: Path) -> None:
    assert "is the recording itself" in refusal("replay", recorded, "--to", recorded)


@pytest.mark.slow
def test_a_hunt_in_a_process_of_its_own(at: Address, tmp_path: Path) -> None:
    """From `play` to `status`, `goto` and `replay`, as an admin types them."""
    options = ["--mavlink", "--headless", "--outside", "TabUI", "--no-report", "--port", "0", "--bag", "a.bag"]
    play = Program(tmp_path, "play", *options, "--udp", str(at))
    try:
        until("treasures are hidden", lambda: "treasures are hidden" in play.text, [play])
        assert mavlink("goto", 1, -2.7, 1.4, "--at", at).exit_code == 0
        robots = json.loads(mavlink("status", at, "--json").stdout)["robots"]
        assert math.dist((robots[0]["x"], robots[0]["y"]), (-2.735, 1.442)) < 0.5
        assert all(robot["lost"] == 0 for robot in robots)
        play.stop()
    finally:
        play.close()
    result = json.loads(mavlink("replay", tmp_path / "a.bag", "--json").stdout)
    assert result["same"]
    assert result["recorded"]["arrivals"][0]["room"] == 2
