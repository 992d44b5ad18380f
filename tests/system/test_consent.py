"""Consent comes first in every way to play: whole programs, a real terminal, real windows."""

import json
import os
import pty
import select
import socket
import subprocess
import time
from pathlib import Path

import pytest

from tests.support.programs import processes
from thbridge.hunt.rooms import Room
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import encode_line

CONSENT = "We record what you do.\nYou may stop at any time."
CLAIM = ".robots.bag.lock"
"""The name of the recording, kept for SimR while it runs; it says nothing of the participant."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "consent.txt").write_text(CONSENT)
    (tmp_path / "study.yaml").write_text("robots: 1\nserver: {port: 0}\nparticipant: {consent: consent.txt}\n")
    return tmp_path


class Terminal:
    """A `thbridge ...` process at a terminal of its own; it types, and reads what is shown."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self._keyboard, screen = pty.openpty()
        self.shown = ""
        self.process = subprocess.Popen(
            [*processes.THBRIDGE, *arguments],
            cwd=folder,
            stdin=screen,
            stdout=screen,
            stderr=screen,
            env={**os.environ, "COLUMNS": "200"},
            start_new_session=True,
        )
        os.close(screen)

    def until(self, words: str, seconds: float = 120.0) -> None:
        """Read until these words are shown."""
        end = time.monotonic() + seconds
        while words not in self.shown:
            readable, _, _ = select.select([self._keyboard], [], [], max(0.0, end - time.monotonic()))
            said = self._read() if readable else ""
            assert said, f"waited for {words!r}; there is\n{self.shown}"
            self.shown += said

    def type(self, line: str) -> None:
        os.write(self._keyboard, line.encode() + b"\n")

    def finish(self) -> int:
        """Wait for the end of the process, and read what it has shown; return the exit code."""
        code = self.process.wait(120)
        while said := self._read():
            self.shown += said
        return code

    def close(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait(10)
        os.close(self._keyboard)

    def _read(self) -> str:
        try:
            return os.read(self._keyboard, 65536).decode(errors="replace")
        except OSError:  # The other side is closed.
            return ""


@pytest.fixture
def terminal(folder: Path):
    opened: list[Terminal] = []

    def run(*arguments: str) -> Terminal:
        opened.append(Terminal(folder, *arguments))
        return opened[-1]

    yield run
    for each in opened:
        each.close()


def left_in(folder: Path) -> set[str]:
    """Files and folders that programs have made, but for what they print."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.suffix not in {".txt", ".yaml"}}


def replay(folder: Path, bag: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*processes.THBRIDGE, "replay", bag], cwd=folder, capture_output=True, text=True, timeout=120, check=False
    )


def recorded(journal: Path) -> list[dict]:
    return [json.loads(line) for line in (journal / "game-0001.jsonl").read_text().splitlines()]


PLAY = ("play", "study.yaml", "--participant", "person", "--bag", "hunt.bag", "--no-report")


def test_a_no_at_the_terminal_is_thanked_and_leaves_no_file(folder, terminal):
    person = terminal(*PLAY)
    person.until("yes or no")
    assert "You may stop at any time." in person.shown
    person.type("perhaps")
    person.type("no")
    assert person.finish() == 3
    assert person.shown.count("yes or no") == 2
    assert "Thank you. You do not take part. Nothing was recorded." in person.shown
    assert left_in(folder) == set()


def test_a_yes_at_the_terminal_is_the_first_thing_recorded(folder, terminal):
    person = terminal(*PLAY)
    person.until("yes or no")
    assert left_in(folder) == set()
    person.type("yes")
    person.until("for the state of the game")
    person.type("end")
    assert person.finish() == 0, person.shown
    started, agreed, *_ = recorded(folder / "hunt.journal")
    assert (started["event"], agreed["event"]) == ("started", "agreed")
    assert agreed["at"].endswith("Z")


@pytest.fixture
def hunt(folder):
    """Server, SimR and Hider of a study with a consent text, and the address."""
    running = [processes.Program(folder, "server", "study.yaml", "--port", "0")]
    try:
        at = f"127.0.0.1:{processes.port_of(running[0], running)}"
        simr = ("simr", "--study", "study.yaml", "--server", at, "--rate", "8", "--bag", "robots.bag")
        running.append(processes.Program(folder, *simr))
        running.append(processes.Program(folder, "hider", "--server", at))
        yield running, at
    finally:
        for program in running:
            program.close()


@pytest.mark.slow
def test_at_a_server_a_no_is_told_and_the_next_participant_is_asked(folder, terminal, hunt):
    running, at = hunt
    first = terminal("tabui", "--server", at, "--participant", "person")
    first.until("yes or no")
    first.type("no")
    assert first.finish() == 3
    assert "Thank you." in first.shown
    processes.until("the no", lambda: "the participant does not take part" in running[0].text, running)
    assert left_in(folder) == {"journal", CLAIM}

    second = terminal("tabui", "--server", at, "--participant", "person")
    second.until("yes or no")
    assert left_in(folder) == {"journal", CLAIM}
    second.type("yes")
    second.until("for the state of the game")
    second.type("end")
    assert second.finish() == 0, second.shown
    assert "agreed" in processes.kinds(folder)
    assert running[1].stop() == 0
    assert (folder / "robots.bag").exists()
    assert not (folder / CLAIM).exists()
    assert running[0].stop() == 0
    assert processes.kinds(folder)[-1] == "ended"
    assert replay(folder, "robots.bag").returncode == 0


@pytest.mark.slow
def test_a_participant_of_2016_is_not_asked_and_the_server_says_so(folder, hunt):
    running, at = hunt
    host, port = at.split(":")
    processes.until("the robots", lambda: "nothing is recorded until" in running[0].text, running)
    with socket.create_connection((host, int(port))) as old:
        old.sendall(b"%%setid TabUI\n")

        def recorded_at_last() -> bool:
            old.sendall(encode_line(legacy.GotoRoom(0, Room(3).wire).message().line()))
            return "departed" in processes.kinds(folder)

        processes.until("the robot to set out", recorded_at_last, running)
    assert "cannot ask for consent" in running[0].text
    assert processes.kinds(folder)[0] == "started" and "agreed" not in processes.kinds(folder)


@pytest.mark.slow
def test_a_hunt_for_another_program_is_recorded_from_its_yes_on_and_can_be_replayed(folder, terminal):
    game = processes.Program(
        folder, "play", "study.yaml", "--headless", "--outside", "TabUI", "--bag", "hunt.bag", "--no-report"
    )
    try:
        processes.until("the question", lambda: "nothing is recorded until" in game.text, [game])
        at = game.text.split("join at ")[1].split()[0].rstrip(".")
        person = terminal("tabui", "--server", at, "--participant", "person")
        person.until("yes or no")
        assert [name for name in left_in(folder) if name.startswith("hunt")] == []
        person.type("yes")
        person.until("for the state of the game")
        person.type("end")
        assert person.finish() == 0, person.shown
        assert game.process.wait(60) == 0, game.text
    finally:
        game.close()
    assert [event["event"] for event in recorded(folder / "hunt.journal")][:2] == ["started", "agreed"]
    replayed = replay(folder, "hunt.bag")
    assert replayed.returncode == 0, replayed.stdout + replayed.stderr


@pytest.mark.slow
def test_a_hunt_for_another_program_ends_with_its_no(folder, terminal):
    game = processes.Program(
        folder, "play", "study.yaml", "--headless", "--outside", "TabUI", "--bag", "hunt.bag", "--no-report"
    )
    try:
        processes.until("the question", lambda: "nothing is recorded until" in game.text, [game])
        at = game.text.split("join at ")[1].split()[0].rstrip(".")
        person = terminal("tabui", "--server", at, "--participant", "person")
        person.until("yes or no")
        person.type("no")
        assert person.finish() == 3
        assert game.process.wait(60) == 3, game.text
    finally:
        game.close()
    assert [name for name in left_in(folder) if name.startswith("hunt")] == []
