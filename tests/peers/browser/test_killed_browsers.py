"""Browsers that are killed in a game: the next one with the same cookie is at the same point of the same game."""

import asyncio
import json
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.selenium_scripts import NEEDS_SELENIUM, seen_in_chromium
from tests.support.project import ROOT
from tests.support.studies.served_program import ServedProgram, begun, write_study
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.events import EventKind

KILLS = 20

pytestmark = pytest.mark.slow


@pytest.fixture
def server(tmp_path: Path) -> Iterator[ServedProgram]:
    study = write_study(tmp_path / "study")
    with ServedProgram(study) as served:
        yield served


async def cookie_of_a_player(port: int) -> str:
    """Return the cookie of a browser in a game."""
    browser = await BrowserClient.arrived(port)
    await begun(browser)
    await browser.close()
    return browser.cookie


def acts(study: Path) -> int:
    """Return how often the rules were opened or closed."""
    events = (entry.event for entry in ExperimentFolder(study).entries())
    return sum(event.kind == EventKind.ACTED and event.data["act"] == "ShowHelp" for event in events)


def test_a_program_that_is_killed_is_back_where_it_was(server: ServedProgram) -> None:
    cookie = asyncio.run(cookie_of_a_player(server.port))
    program = [sys.executable, "-m", "tests.support.programs.browser_process", str(server.port), cookie]
    workers, seconds, history = server.workers, [], []
    for number in range(KILLS + 1):
        began = time.monotonic()
        process = subprocess.Popen(program, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert process.stdin is not None
        assert process.stdout is not None
        shown = json.loads(process.stdout.readline())
        seconds.append(time.monotonic() - began)
        assert shown["rules"] == (acts(server.study) % 2 == 1), "the rules are as the last act in the log has left them"
        assert shown["history"][: len(history)] == history
        history = shown["history"]
        print(file=process.stdin, flush=True)
        for _ in range(1 + number % 3):
            process.stdout.readline()
        process.kill()
        process.wait()
        process.stdin.close()
        process.stdout.close()
    assert acts(server.study) >= KILLS
    assert server.workers == workers
    print(f"back after at most {max(seconds[1:]):.1f} s")


@NEEDS_SELENIUM
def test_chromium_that_is_killed_is_back_where_it_was(server: ServedProgram, tmp_path: Path) -> None:
    program = Path(__file__).with_name("killed_chromium.py")
    result = seen_in_chromium(program, server.port, KILLS, tmp_path / "profile", timeout=580)
    assert not result["lost"]
    assert len(result["seconds"]) == KILLS
    assert len(server.workers) == 1
