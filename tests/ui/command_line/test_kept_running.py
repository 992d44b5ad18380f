"""A program that is started again when it is killed."""

import os
import signal
import subprocess
import sys
from pathlib import Path

from ui.command_line.kept_running import MOST_DEATHS

PROGRAM = """
import os, signal, sys, typer
from pathlib import Path
from ui.command_line.kept_running import keep_running

kills, path = int(sys.argv[1]), Path(sys.argv[2])
try:
    keep_running()
    with path.open("a") as file:
        file.write(f"{os.getpid()}\\n")
    if len(path.read_text().split()) <= kills:
        os.kill(os.getpid(), signal.SIGKILL)
    if len(sys.argv) > 3:
        print("ready", flush=True)
        signal.pause()
    sys.exit(3)
except typer.Exit as left:
    sys.exit(left.exit_code)
"""


def started(*words: object) -> "subprocess.Popen[str]":
    command = [sys.executable, "-c", PROGRAM, *map(str, words)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_a_killed_child_is_replaced_and_an_exit_code_passes_through(tmp_path: Path) -> None:
    program = started(2, tmp_path / "children")
    _, told = program.communicate(timeout=60)
    assert program.returncode == 3
    assert len((tmp_path / "children").read_text().split()) == 3
    assert told.count("ended by SIGKILL") == 2


def test_a_child_that_always_dies_is_given_up(tmp_path: Path) -> None:
    program = started(100, tmp_path / "children")
    _, told = program.communicate(timeout=60)
    assert program.returncode == 1
    assert f"The server has died {MOST_DEATHS} times" in told


def test_the_child_stops_with_its_parent_and_is_not_replaced(tmp_path: Path) -> None:
    for number in (signal.SIGTERM, signal.SIGKILL):
        path = tmp_path / f"children-{number}"
        program = started(0, path, "wait")
        assert program.stdout is not None
        assert program.stdout.readline() == "ready\n"
        (child,) = map(int, path.read_text().split())
        program.send_signal(number)
        # The child has the other end of this pipe, too.
        assert program.stdout.read() == ""
        assert program.wait(60) == -number
        assert not os.path.exists(f"/proc/{child}/exe")  # noqa: PTH110 - a link of a process that has ended is broken
