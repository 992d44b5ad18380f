"""Signals at any moment of a command: it ends cleanly with its usual exit code, and its recording is complete."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.programs.ports import free_domain
from tests.support.slow import slow
from thbridge.recording.bag.reading.reader import info

SIGNALED = """
import io, os, sys

number, kind, text = int(sys.argv.pop(1)), sys.argv.pop(1), sys.argv.pop(1)
sent = False

def at(happened, what):
    global sent
    if happened == kind and text in what and not sent:
        sent = True
        os.kill(os.getpid(), number)

class Stream(io.TextIOWrapper):
    def write(self, said):
        written = super().write(said)
        self.flush()
        at("line", said)
        return written

sys.stdout, sys.stderr = (Stream(each.detach(), errors="replace") for each in (sys.stdout, sys.stderr))
sys.addaudithook(lambda event, arguments: at(event, str(arguments)))
from ui.cli import main
main()
"""
"""`thbridge`, which sends itself a signal when it prints a line with a text, or at an audit event with a text."""

PLAY = ("play", "--headless", "--port", "0", "--bag", "a.bag", "--max-seconds", "1", "--no-report")
SIMR = ("simr", "--robots", "1", "--server", "127.0.0.1:9", "--bag", "a.bag", "--ros2", "--watch", "0")
TERM, INT, HUP = signal.SIGTERM, signal.SIGINT, signal.SIGHUP


def signaled(folder: Path, number: int, kind: str, text: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", SIGNALED, str(int(number)), kind, text, *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)


@pytest.mark.parametrize(
    ("number", "kind", "text", "arguments", "code"),
    [
        (TERM, "line", "Other programs can join", PLAY, 1),
        *slow(
            (HUP, "socket.bind", "0", PLAY, 1),
            (INT, "os.rename", "a.bag.active.new", PLAY, 1),
            (TERM, "os.rename", "a.bag'", PLAY, 1),
        ),
        (TERM, "line", "ROS 2: ", SIMR, 0),
        *slow((HUP, "line", "Researchers can connect", SIMR, 0), (INT, "os.rename", "a.bag.active.new", SIMR, 0)),
    ],
)
def test_a_recording_is_complete_after_a_signal_at_any_moment(
    tmp_path: Path, number: int, kind: str, text: str, arguments: tuple[str, ...], code: int
) -> None:
    if "--ros2" in arguments:
        arguments = (*arguments, "--ros2-domain", str(free_domain()))
    done = signaled(tmp_path, number, kind, text, *arguments)
    assert "Traceback" not in done.stderr
    assert done.returncode == code, done.stderr
    assert info(tmp_path / "a.bag").messages > 0
    assert not list(tmp_path.glob("*.active*"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "text", "arguments", "code"),
    [
        (INT, "listening on", ("server", "--port", "0"), 0),
        (HUP, "listening on", ("ros", "master", "--port", "0"), 0),
        (TERM, "http://", ("serve", "--port", "0"), -TERM),
    ],
)
def test_a_server_ends_cleanly_at_its_first_line(
    tmp_path: Path, number: int, text: str, arguments: tuple[str, ...], code: int
) -> None:
    done = signaled(tmp_path, number, "line", text, *arguments)
    assert "Traceback" not in done.stderr
    assert done.returncode == code, done.stderr


@pytest.mark.parametrize(("number", "code"), [*slow((TERM, -TERM)), (INT, 130)])
def test_a_command_that_has_opened_nothing_ends_at_once(tmp_path: Path, number: int, code: int) -> None:
    done = signaled(tmp_path, number, "import", "thbridge.app.play", *PLAY)
    assert "Traceback" not in done.stderr
    assert done.returncode == code, done.stderr
    assert not list(tmp_path.iterdir())
