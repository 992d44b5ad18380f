"""Signed frames with MAVProxy and with pymavlink's `mavutil`: who has the key drives, and nobody else."""

import hashlib
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.peers.mavlink.mavproxy import MavProxy
from tests.peers.mavutil_script import Script, mav
from tests.peers.rover_session import needs, rovers
from tests.support.programs.ports import free_udp_port
from tests.support.programs.processes import Program, until

WORD = "open-sesame"
KEY = hashlib.sha256(WORD.encode()).digest()


@pytest.fixture
def key(tmp_path: Path) -> Path:
    path = tmp_path / "team.key"
    path.write_text(f"{WORD}\n")
    path.chmod(0o600)
    return path


@pytest.fixture
def scripts() -> Iterator[tuple[Script, Script]]:
    made = Script(f"udpin:127.0.0.1:{free_udp_port()}", 255), Script(f"udpin:127.0.0.1:{free_udp_port()}", 254)
    yield made
    for script in made:
        script.master.close()


def port_of(script: Script) -> int:
    return int(script.master.port.getsockname()[1])


def is_armed(heartbeat: Any) -> bool:
    return bool(heartbeat.base_mode & mav.MAV_MODE_FLAG_SAFETY_ARMED)


def meets(script: Script, play: Program) -> None:
    script.follows(1)
    script.hears("HEARTBEAT")


def test_mavutil_signs_and_verifies(tmp_path: Path, key: Path, scripts: tuple[Script, Script]) -> None:
    friend, stranger = scripts
    friend.master.setup_signing(KEY, sign_outgoing=True)
    options = ("--identity", "ardupilot", "--signing-key", str(key))
    with rovers(tmp_path, (port_of(friend), port_of(stranger)), *options) as play:
        meets(friend, play)
        meets(stranger, play)  # it has no key, and believes everybody
        assert friend.commands(mav.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mav.MAV_RESULT_ACCEPTED
        with pytest.raises(TimeoutError):
            stranger.master.mav.command_long_send(1, 1, mav.MAV_CMD_COMPONENT_ARM_DISARM, 0, 0, *[0.0] * 6)
            stranger.hears("COMMAND_ACK", seconds=3.0)
        while friend.master.recv_msg() is not None:
            pass  # said before the stranger spoke
        assert is_armed(friend.hears("HEARTBEAT"))
        signing = friend.master.mav.signing
        assert signing.goodsig_count > 0
        assert signing.badsig_count == signing.reject_count == 0


@pytest.mark.slow
def test_datagrams_that_are_said_again_or_late_or_by_another_key_do_nothing(
    tmp_path: Path, key: Path, scripts: tuple[Script, Script]
) -> None:
    friend, _ = scripts
    friend.master.setup_signing(KEY, sign_outgoing=True)

    def arming(arm: int) -> bytes:
        robot = (1, 1, mav.MAV_CMD_COMPONENT_ARM_DISARM, 0, arm, *[0.0] * 6)
        return bytes(friend.master.mav.command_long_encode(*robot).pack(friend.master.mav))

    def command(arm: int) -> bytes:
        """Command it, and wait until it is so; what was said. It is signed at once, or a heartbeat would be newer."""
        said = arming(arm)
        friend.master.write(said)
        friend.hears("COMMAND_ACK")
        friend.hears("HEARTBEAT", lambda told: is_armed(told) == arm)
        return said

    with (
        rovers(tmp_path, (port_of(friend),), "--signing-key", str(key)) as play,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as thief,
    ):
        meets(friend, play)
        stolen = command(1)
        command(0)
        signing = friend.master.mav.signing
        signing.link_id, signing.timestamp = 7, signing.timestamp - 3600 * 100_000
        late = arming(1)
        signing.secret_key = bytes(32)
        signing.timestamp += 2 * 3600 * 100_000
        forged = arming(1)
        signing.secret_key, signing.link_id = KEY, 0
        for said in (stolen, late, forged):
            friend.master.write(said)
            thief.sendto(said, *friend.master.clients)
        with pytest.raises(TimeoutError):
            friend.hears("COMMAND_ACK", seconds=2.0)
        assert not is_armed(friend.hears("HEARTBEAT"))
        until(
            "all to be told",
            lambda: all(reason in play.text for reason in ("not newer", "minute old", "wrong")),
            [play],
        )


@pytest.mark.slow
@needs("mavproxy")
def test_mavproxy_drives_with_the_passphrase_and_not_without(tmp_path: Path, key: Path) -> None:
    port = free_udp_port()
    signed = ("--identity", "ardupilot", "--signing-key", str(key))
    with rovers(tmp_path, (port,), *signed), MavProxy(tmp_path / "mavproxy", port) as proxy:
        proxy.says("Detected vehicle 1:1")
        proxy.types("arm throttle")
        proxy.types(f"signing key {WORD}")
        proxy.says("Setup signing key")
        assert "Got COMMAND_ACK" not in proxy.output.read_text()
        proxy.says("Got COMMAND_ACK: COMPONENT_ARM_DISARM: ACCEPTED", again="arm throttle")
        proxy.says(r"Received \d+ parameters", again="param fetch")
