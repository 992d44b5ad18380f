"""Hunts to watch: recorded ones, and running ones with a watch server."""

import asyncio
import dataclasses
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from thbridge.app.compose.game import build_bot
from thbridge.app.compose.setting import read_setting
from thbridge.app.play import HuntUnfinished, PlayOptions, play
from thbridge.roles.participant.tabui import TabUI
from thbridge.study.study_file import Study


def record(bag: Path, robots: int = 3, seconds: float = 15.0) -> Path:
    """Record the beginning of a hunt with a simulated participant."""
    study = dataclasses.replace(Study(), seed=4, robots=robots, server=dataclasses.replace(Study().server, port=0))
    setting = read_setting(study, Path())
    bot = TabUI(build_bot(setting.templates, study.participant.strategy, study.seed))
    options = PlayOptions(0.0, bag, frozenset(), "suggestion", seconds)
    try:
        asyncio.run(play(setting, bot, options, lambda where: None, lambda moment: None))
    except HuntUnfinished:
        return bag
    return bag


@contextmanager
def watched_hunt(bag: Path, *options: str) -> Iterator[int]:
    """Run a hunt in another process until the end of the block; the watch server's port."""
    command = [sys.executable, "-c", "from ui.cli import main; main()", "play", "--headless", "--participant"]
    command += ["suggestion", "--robots", "2", "--seed", "4", "--rate", "1", "--port", "0", "--watch", "0"]
    command += ["--no-report", "--bag", str(bag), *options]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as program:
        told = []
        try:
            for line in program.stderr or ():
                told.append(line)
                found = re.search(r"watch at [0-9.]+:([0-9]+)", line)
                if found:
                    yield int(found[1])
                    break
            else:
                raise RuntimeError("".join(told))
        finally:
            program.terminate()
            program.communicate()
