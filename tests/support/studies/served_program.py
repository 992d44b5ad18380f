"""`thbridge serve` as a program of its own, for a study with one game, and people at it."""

import os
import re
import shutil
import signal
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.processes import Program, until
from ui.web.pool.running_games import RunningGames

STUDY = """\
title: Games that survive
seed: 3
base: {{map: practice, templates: practice, robots: 1, rate: 1, server.port: 0}}
quota: {quota}
consent_elsewhere: People agreed before.
steps:
  - {{step: instructions, text: welcome.txt}}
  - {{step: trial, name: game, max_seconds: {seconds}}}
"""


def write_study(folder: Path, *, quota: int = 100, seconds: int = 1200) -> Path:
    """Write a study with one game for each person; return its folder."""
    folder.mkdir(exist_ok=True)
    (folder / "welcome.txt").write_text("You play one game.\n")
    (folder / "experiment.yaml").write_text(STUDY.format(quota=quota, seconds=seconds))
    return folder


class ServedProgram:
    """`thbridge serve` of a study folder.

    Args:
        study: folder of the study, or a study file.
        options: further options.
        recorded: folder of recordings, for a study file.
        environment: environment variables of the program.
    """

    def __init__(
        self,
        study: Path,
        *options: str,
        recorded: Path | None = None,
        environment: Mapping[str, str] = os.environ,
    ) -> None:
        self.study = study
        self.running = RunningGames.of(recorded or study)
        self.program = Program(study.parent, "serve", str(study), "--port", "0", *options, environment=environment)

    @property
    def port(self) -> int:
        """Port of the server, once it is ready."""
        return port_for_browsers(self.program)

    @property
    def child(self) -> int:
        """Number of the process that serves; its parent starts it again if it dies."""
        parent = self.program.process.pid
        (child, *_) = Path(f"/proc/{parent}/task/{parent}/children").read_text().split()
        return int(child)

    @property
    def workers(self) -> dict[str, int]:
        """Numbers of the processes of all running games."""
        return workers_of(self.running)

    def again(self) -> None:
        """Start the server again."""
        self.program = self.program.again()

    def __enter__(self) -> "ServedProgram":
        return self

    def __exit__(self, *_: object) -> None:
        self.program.close()
        kill_workers(self.running)
        shutil.rmtree(self.running.folder)


def workers_of(running: RunningGames) -> dict[str, int]:
    """Return the numbers of the processes of all running games."""
    found = {key: running.address(key) for key in running}
    return {key: address.process for key, address in found.items() if address is not None}


def kill_workers(running: RunningGames) -> None:
    """Kill the processes of all running games."""
    for process in workers_of(running).values():
        with suppress(ProcessLookupError):
            os.kill(process, signal.SIGKILL)


def port_for_browsers(program: Program) -> int:
    """Return the port of `thbridge serve`, once it is ready."""

    def address() -> re.Match[str] | None:
        return re.search(r"Open http://127\.0\.0\.1:(\d+)/", program.text)

    until("the server", lambda: address() is not None or program.process.poll() is not None, [program])
    found = address()
    assert found is not None, program.text
    return int(found[1])


async def begun(browser: BrowserClient) -> None:
    """Go from the first page into the game."""
    await browser.press_button()
    await browser.press_button()
    await playing(browser)


async def playing(browser: BrowserClient) -> None:
    """Wait until the page of the game is complete."""
    await browser.until(lambda: browser.tree.get("phase") == "playing" and browser.tree["tiles"], 120)
