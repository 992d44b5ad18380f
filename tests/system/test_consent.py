"""Consent comes first in every way to play: whole programs, a real terminal, real windows."""

import json
import os
import pty
import subprocess
import time
from pathlib import Path

import pytest

from tests.system import programs

CONSENT = "We record what you do.\nYou may stop at any time."


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
            [*programs.THBRIDGE, *arguments],
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
            assert time.monotonic() < end, self.shown
            self.shown += self._read()

    def type(self, line: str) -> None:
        os.write(self._keyboard, line.encode() + b"\n")

    def finish(self) -> int:
        """Read to the end; return the exit code."""
        while said := self._read():
            self.shown += said
        return self.process.wait(60)

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
    return {str(path.relative_to(folder)) for path in folder.rglob("*")} - {"consent.txt", "study.yaml"}


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
    person.until("Type ? to see")
    person.type("end")
    assert person.finish() == 0, person.shown
    started, agreed, *_ = recorded(folder / "hunt.journal")
    assert (started["event"], agreed["event"]) == ("started", "agreed")
    assert agreed["at"].endswith("Z")
