"""Consent in the real window, with the real programs: asked first, and a no thanks, ends and leaves no file."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.programs import processes
from tests.support.windows.desktop import Desktop, needs_desktop

pytestmark = needs_desktop


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "consent.txt").write_text("We record what you do.")
    (tmp_path / "study.yaml").write_text("robots: 1\nserver: {port: 0}\nparticipant: {consent: consent.txt}\n")
    return tmp_path


@pytest.fixture
def played(screen: Desktop, folder: Path) -> Iterator[processes.Program]:
    """`thbridge play` on the desktop."""
    program = processes.Program(
        folder, "play", "study.yaml", "--bag", "hunt.bag", "--no-report", environment=screen.environment
    )
    yield program
    screen.picture(folder / "screen.png")
    program.close()


def files_of(folder: Path) -> list[str]:
    return [path.name for path in folder.rglob("hunt*")]


@pytest.mark.slow
def test_a_no_in_the_window_is_thanked_and_leaves_no_file(
    played: processes.Program, screen: Desktop, folder: Path
) -> None:
    screen.focus_window("Treasure hunt")
    screen.click(screen.rested("I do not take part"))
    screen.found("You do not take part. Nothing was recorded.")
    screen.click(screen.rested("Close"))
    assert played.process.wait(60) == 3, played.text
    assert files_of(folder) == []


@pytest.mark.slow
def test_a_yes_in_the_window_is_the_first_thing_recorded(
    played: processes.Program, screen: Desktop, folder: Path
) -> None:
    screen.focus_window("Treasure hunt")
    screen.click(screen.rested("I agree"))
    start = screen.rested("Start with 1 robot")
    assert files_of(folder) == []
    screen.click(start)
    screen.found("Score 0")
    screen.leave_game()
    assert played.process.wait(60) == 0, played.text
    lines = (folder / "hunt.journal" / "game-0001.jsonl").read_text().splitlines()
    started, agreed, *_ = map(json.loads, lines)
    assert (started["event"], agreed["event"]) == ("started", "agreed")
    assert agreed["at"].endswith("Z")


@pytest.mark.slow
def test_a_no_in_a_window_at_a_server_is_told_to_it(screen: Desktop, folder: Path) -> None:
    running = [processes.Program(folder, "server", "study.yaml", "--port", "0")]
    try:
        at = f"127.0.0.1:{processes.port_of(running[0], running)}"
        running.append(processes.Program(folder, "simr", "--study", "study.yaml", "--server", at))
        running.append(processes.Program(folder, "tabui", "--server", at, environment=screen.environment))
        screen.focus_window("Treasure hunt")
        screen.click(screen.rested("I do not take part"))
        processes.until("the no", lambda: "the participant does not take part" in running[0].text, running)
        screen.click(screen.rested("Close"))
        assert running[-1].process.wait(60) == 3, running[-1].text
        assert list((folder / "journal").iterdir()) == []
    except TimeoutError:
        screen.picture(folder / "screen.png")
        raise
    finally:
        for program in running:
            program.close()
