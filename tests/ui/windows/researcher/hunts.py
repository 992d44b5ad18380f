"""Hunts to look at: recorded, and under way behind a door."""

import asyncio
import dataclasses
from pathlib import Path

from thbridge.app.compose import build_bot, read_setting
from thbridge.app.config import Study
from thbridge.app.play import PlayOptions, Unfinished, play
from thbridge.roles.tabui import TabUI


def record(bag: Path, robots: int = 3, seconds: float = 15.0) -> Path:
    """The beginning of a hunt with a simulated participant."""
    study = dataclasses.replace(Study(), seed=4, robots=robots, server=dataclasses.replace(Study().server, port=0))
    setting = read_setting(study, Path())
    bot = TabUI(build_bot(setting.templates, study.participant.strategy, study.seed))
    options = PlayOptions(0.0, bag, frozenset(), "suggestion", seconds)
    try:
        asyncio.run(play(setting, bot, options, lambda where: None, lambda moment: None))
    except Unfinished:
        return bag
    return bag
