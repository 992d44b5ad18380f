"""Refusals of MAVLink options of `thbridge play` that cannot be."""

import dataclasses
import socket
from pathlib import Path

import pytest
import typer

from tests.support.programs.commands import invoke
from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.sockets.addresses import Address, UdpTarget
from thbridge.study.mavlink import MavlinkSection
from thbridge.study.study_file import Study
from ui.command_line.listening import ports_of
from ui.command_line.options import MavlinkOptions
from ui.command_line.settings import with_mavlink


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def refusal(*arguments: str) -> str:
    done = invoke("play", "--headless", *arguments)
    assert done.exit_code == 2, (done.output, done.exception)
    assert done.stdout == ""
    assert not list(Path().rglob("*.bag"))
    return done.stderr


@pytest.mark.parametrize("option", ["--udp", "--udp-listen", "--tcp"])
@pytest.mark.parametrize("address", ["14550", "localhost:", ":14550", "localhost:0", "localhost:65536", "::1:14550"])
def test_an_address_that_is_none(option: str, address: str) -> None:
    assert f"{option}: '{address}' is not an address. Write HOST:PORT" in refusal("--mavlink", option, address)


def test_a_target_of_a_robot_that_there_is_not() -> None:
    message = refusal("--mavlink", "--robots", "3", "--udp", "h:1/4")
    assert "--udp: 'h:1/4': there is no robot 4. The last robot is 3." in message


@pytest.mark.parametrize("other", ["h:1", "h:1/2"])
def test_an_address_for_one_robot_and_for_others(other: str) -> None:
    message = refusal("--mavlink", "--robots", "3", "--udp", "h:1/1", "--udp", other)
    assert f"--udp: h:1 is already used for other robots. Use another port for '{other}'." in message


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--udp", "h:1"),
        ("--udp-listen", "h:1"),
        ("--tcp", "h:1"),
        ("--identity", "generic"),
        ("--signing-key", "key"),
    ],
)
def test_an_option_without_mavlink(option: str, value: str) -> None:
    assert f"{option}: MAVLink is off in this session. Add --mavlink" in refusal(option, value)


def test_a_key_file_that_is_not_there() -> None:
    assert "key: the signing key cannot be read" in refusal("--mavlink", "--signing-key", "key")


def test_a_port_that_is_taken() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        message = refusal("--mavlink", "--udp", "127.0.0.1:14550", "--tcp", f"127.0.0.1:{port}")
    assert f"MAVLink: cannot listen on 127.0.0.1:{port}: Address already in use" in message


def test_options_win_over_the_study() -> None:
    written = MavlinkSection(on=True, udp=("10.0.0.1:14550",), tcp="0.0.0.0:5760")
    study = with_mavlink(
        dataclasses.replace(Study(), mavlink=written),
        MavlinkOptions(
            identity=AutopilotIdentity.ARDUPILOT,
            udp=["[::1]:14550", "[::1]:14550"],
            udp_listen="[::1]:14555",
            tlog=True,
        ),
    )
    assert study.mavlink == dataclasses.replace(
        written, identity=AutopilotIdentity.ARDUPILOT, udp=("[::1]:14550",), udp_listen="[::1]:14555", tlog=True
    )
    ports = ports_of(study, None, None)
    assert ports is not None
    assert (ports.udp, ports.udp_listen) == ((UdpTarget(Address("::1", 14550)),), Address("::1", 14555))
    assert (ports.tcp, ports.key) == (Address("0.0.0.0", 5760), None)


def test_the_study_can_be_overruled_altogether() -> None:
    study = dataclasses.replace(Study(), mavlink=MavlinkSection(on=True))
    assert ports_of(with_mavlink(study, MavlinkOptions(on=False)), None, None) is None


def test_the_studys_key_lies_beside_it(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "key").write_text("a passphrase\n")
    (tmp_path / "there" / "key").chmod(0o600)
    study = dataclasses.replace(Study(), mavlink=MavlinkSection(on=True, signing_key=Path("key")))
    ports = ports_of(study, tmp_path / "there" / "study.yaml", None)
    assert ports is not None
    assert ports.key is not None
    with pytest.raises(typer.Exit):
        ports_of(study, None, None)
