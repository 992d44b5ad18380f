"""People who wait for a place in a study."""

import asyncio
from pathlib import Path

import pytest

from tests.support.programs.browser_client import BrowserClient
from tests.support.studies.served_study import served

STUDY = """\
title: One place
base: {map: practice, templates: practice, robots: 1, rate: 10, server.port: 0}
quota: 1
steps:
  - {step: instructions, text: welcome.txt}
  - {step: trial, name: game, max_seconds: 40}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "welcome.txt").write_text("This study has one place.\n")
    (tmp_path / "experiment.yaml").write_text(STUDY)
    return tmp_path


def test_a_person_waits_with_a_clock_until_a_place_is_free_and_may_stop_waiting(folder: Path) -> None:
    async def run() -> None:
        async with served(folder) as (port, conductor):
            first = await BrowserClient.arrived(port)
            await first.press_button()
            await first.until(lambda: conductor.progress.runs)

            second = await BrowserClient.arrived(port)
            await second.until(lambda: second.shown["t"] == "turn" and second.shown["waited"].endswith("0:02."))
            await second.press_button()
            await second.until(lambda: second.shown["heading"] == "You have stopped waiting")
            await second.press_button()
            await second.until(lambda: second.shown["t"] == "turn")

            await first.send({"type": "StoppedTakingPart"})
            await second.until(lambda: second.shown["heading"] == "Welcome")
            assert len(conductor.progress.runs) == 1, "nothing is recorded about a person who waits"
            await second.press_button()
            await second.until(lambda: len(conductor.progress.runs) == 2)
            await asyncio.gather(first.close(), second.close())

    asyncio.run(asyncio.wait_for(run(), 120))
