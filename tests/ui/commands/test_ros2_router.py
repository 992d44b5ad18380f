"""`thbridge ros2 router`: a router in its own process, and what it refuses."""

import importlib.util
import socket
from pathlib import Path

import pytest

from tests.support.programs.commands import refusal
from tests.support.programs.ports import free_port
from tests.support.programs.processes import Program, until
from tests.support.ros import zenoh_graphs
from tests.support.ros.zenoh_graphs import NODE, OTHER, STRING, carriers
from thbridge.ros2.qos import LATCHED
from thbridge.sockets.addresses import Address


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_two_programs_meet_at_the_router(folder: Path) -> None:
    program = Program(folder, "ros2", "router", "--listen", f"127.0.0.1:{free_port()}")

    async def scenario() -> None:
        port = int(program.text.rpartition(":")[2])
        async with carriers(2, Address("localhost", port)) as (here, there):
            got = []
            here.publish(NODE, "/map", STRING, LATCHED).write(b"map")
            there.subscribe(OTHER, "/map", STRING, LATCHED, lambda message, gid: got.append(message))
            await zenoh_graphs.until(lambda: got == [b"map"])

    try:
        until("the router", lambda: "listening on" in program.text and program.text.endswith("\n"), [program])
        zenoh_graphs.run(scenario)
        assert program.stop() == 0
    finally:
        program.close()


def test_a_router_that_cannot_listen_says_so() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        message = refusal("ros2", "router", "--listen", f"127.0.0.1:{port}")
    assert f"cannot listen on 127.0.0.1:{port}: Address already in use" in message


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--listen", "7447"], "--listen: '7447' is not an address"),
        (["--listen", "0.0.0.0:7447"], "the zenoh router: other machines could reach 0.0.0.0"),
        (["--listen", "0.0.0.0:7447", "--open-to", "lab"], "--open-to: 'lab' is not a network"),
    ],
)
def test_what_the_router_refuses(options: list[str], told: str) -> None:
    assert told in refusal("ros2", "router", *options)


@pytest.mark.parametrize(
    ("missing", "told"), [("zenoh", "eclipse-zenoh is"), ("xxhash", "xxhash is"), ("", "eclipse-zenoh and xxhash are")]
)
def test_missing_packages_are_named(missing: str, told: str, monkeypatch: pytest.MonkeyPatch) -> None:
    found = importlib.util.find_spec
    monkeypatch.setattr("ui.command_line.ros2.find_spec", lambda name: None if missing in ("", name) else found(name))
    message = refusal("ros2", "router", "--listen", "127.0.0.1:7447")
    assert f"ros2 router: {told} not installed. Run: pip install 'thbridge[ros2]'" in message
