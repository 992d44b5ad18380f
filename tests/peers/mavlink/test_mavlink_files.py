"""Robots' files as other people's programs read them: MAVSDK, MAVProxy, and pymavlink's `mavftp`."""

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pymavlink.mavftp import MAVFTP, FtpError

from tests.peers.mavlink.mavproxy import MavProxy
from tests.peers.mavutil_script import Script
from tests.peers.rover_session import PEERS, needs, rovers
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.ports import free_udp_port
from tests.support.programs.processes import Program
from thbridge.mavlink.role.parameters import PARAMETERS
from thbridge.mavlink.vehicle.component_files.metadata_files import checksum

READER = Path(__file__).with_name("mavsdk_reader.py")
PATIENCE = 120.0
NAMES = ["general.json", "parameters.json"]


@pytest.fixture(scope="module")
def ports() -> tuple[int, int, int]:
    return free_udp_port(), free_udp_port(), free_udp_port()


@pytest.fixture(scope="module")
def play(ports: tuple[int, int, int], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Program]:
    with rovers(tmp_path_factory.mktemp("files"), ports, "--identity", "ardupilot") as play:
        yield play


@pytest.fixture(scope="module")
def files(play: Program, ports: tuple[int, int, int], tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Robot 1's, as pymavlink reads them."""
    folder = tmp_path_factory.mktemp("mavftp")
    script = Script(f"udpin:127.0.0.1:{ports[0]}", 255)
    assert script.master.wait_heartbeat(timeout=PATIENCE) is not None
    client = MAVFTP(script.master, target_system=1, target_component=1)
    told = client.cmd_list(["/"])
    assert told.error_code == FtpError.Success
    assert [entry.name for entry in told.directory_listing] == NAMES
    for name in NAMES:
        client.cmd_get([name, str(folder / name)])
        assert client.process_ftp_reply("OpenFileRO", timeout=PATIENCE).error_code == FtpError.Success
    assert client.cmd_rm(["general.json"]).error_code == FtpError.FileProtected
    assert client.cmd_list(["/none"]).error_code == FtpError.FileNotFound
    script.master.close()
    content = {name: (folder / name).read_bytes() for name in NAMES}
    assert [entry.size_b for entry in told.directory_listing] == [len(content[name]) for name in NAMES]
    return content


def described(content: bytes) -> dict[str, dict[str, Any]]:
    return {each["name"]: each for each in json.loads(content)["parameters"]}


@pytest.mark.slow
def test_pymavlink_gets_them_whole(files: dict[str, bytes]) -> None:
    (about,) = json.loads(files["general.json"])["metadataTypes"]
    assert about["fileCrc"] == checksum(files["parameters.json"])
    assert set(described(files["parameters.json"])) >= {parameter.name for parameter in PARAMETERS}


@pytest.mark.slow
@needs("mavsdk")
def test_mavsdk_gets_them_and_the_metadata_by_itself(
    files: dict[str, bytes], play: Program, ports: tuple[int, int, int], tmp_path: Path
) -> None:
    orders = {"url": f"udpin://127.0.0.1:{ports[1]}", "robot": 2, "folder": str(tmp_path), "bursts": [False, True]}
    done = run_peer(
        [PEERS / "mavsdk" / "bin" / "python", READER],
        input=json.dumps(orders), timeout=PATIENCE,
        env={**os.environ, "HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")},
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr + play.text
    told = json.loads(done.stdout.splitlines()[-1])
    assert told["listed"] == {name: len(files[name]) for name in NAMES}
    assert told["downloaded"] == [[name, files[name].decode()] for name in NAMES for _ in range(2)]
    assert told["identical"] == [True] * 4
    assert "PROTECTED" in told["written"].upper()
    assert told["metadata"] == json.loads(files["parameters.json"])


@pytest.mark.slow
@needs("mavproxy")
def test_mavproxy_lists_gets_and_compares_them(
    files: dict[str, bytes], play: Program, ports: tuple[int, int, int], tmp_path: Path
) -> None:
    with MavProxy(tmp_path / "mavproxy", ports[2]) as proxy:
        proxy.says(r"Received \d+ parameters")
        proxy.does("module load ftp", "Loaded module ftp")
        for name in NAMES:
            proxy.does("ftp list", rf"{name}\s+{len(files[name])}\s")
            proxy.does(f"ftp get {name}", rf"Wrote {len(files[name])} bytes to {name}")
            proxy.does(f"ftp crc {name}", rf"crc: \S*{name} 0x{checksum(files[name]):08x}")
            # MAVProxy says that it wrote a file before it closes it, and closes it before its next command.
            assert (proxy.folder / name).read_bytes() == files[name]
