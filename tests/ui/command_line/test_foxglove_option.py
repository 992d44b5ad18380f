import importlib.util
import socket
from pathlib import Path

import pytest

from tests.support.programs.commands import invoke


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def refusal(*arguments: str) -> str:
    done = invoke(*arguments)
    assert done.exit_code == 2, (done.output, done.exception)
    assert not [*Path().rglob("*.bag"), *Path().rglob("*.journal")]
    return done.stderr


@pytest.mark.parametrize("door", ["foxglove", "watch"])
def test_nothing_is_recorded_where_a_port_is_taken(door: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        told = refusal("play", "--headless", f"--{door}", str(port))
    assert f"--{door}: cannot listen on 127.0.0.1:{port}: Address already in use" in told


@pytest.mark.parametrize("program", ["play", "simr"])
def test_what_foxglove_needs_is_told_where_it_is_not_installed(program: str, monkeypatch: pytest.MonkeyPatch) -> None:
    found = importlib.util.find_spec
    monkeypatch.setattr("ui.command_line.listening.find_spec", lambda name: None if name == "foxglove" else found(name))
    options = ("--headless",) if program == "play" else ()
    assert "pip install 'thbridge[foxglove]'" in refusal(program, *options, "--foxglove", "8765")


def test_real_robots_are_watched_on_their_graph() -> None:
    assert "foxglove_bridge" in refusal("simr", "--robots-from", "ros", "--foxglove", "8765")
