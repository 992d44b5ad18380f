"""A recording of the same name keeps its name when a session does not start."""

import socket
from pathlib import Path

import pytest

from tests.support.programs.commands import invoke

PORT = "PORT"
STARTS = {
    "port of the game": ("play", "--headless", "--outside", "Hider", "--port", PORT),
    "port of the windows": ("simr", "--watch", PORT),
    "bad option": ("simr", "--foxglove", "8765"),
}


@pytest.mark.parametrize("name", ["run.bag", "run.mcap", "run"])
@pytest.mark.parametrize("start", STARTS)
def test_a_start_that_fails_moves_no_older_recording(
    start: str, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("ui.command_line.listening.find_spec", lambda name: None)
    inside = Path("run/run_0.mcap") if name == "run" else Path(name)
    inside.parent.mkdir(exist_ok=True)
    inside.write_bytes(b"older")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        done = invoke(*(port if each == PORT else each for each in STARTS[start]), "--bag", name)
    assert done.exit_code == 2, (done.output, done.exception)
    left = [path for path in Path().rglob("*") if path.is_file() and not path.name.startswith(".")]
    assert left == [inside]
    assert inside.read_bytes() == b"older"
