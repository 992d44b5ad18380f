"""Recorded, replayed and watched hunts."""

import asyncio
import dataclasses
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from thbridge.app.compose.game import build_bot
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.play import HuntUnfinished, PlayOptions, play
from thbridge.app.replay.replay import Replayed, ReplayOptions, replay, session_of
from thbridge.recording.bag.reading.reader import messages
from thbridge.roles.participant.tabui import TabUI
from thbridge.study.overrides import StudyChange, with_changes
from thbridge.study.study_file import Study, read_study_text

STUDY = dataclasses.replace(Study(), seed=7, server=dataclasses.replace(Study().server, port=0))


def setting_of(study: Study) -> StudySetting:
    return read_setting(study, Path())


def bot_of(setting: StudySetting) -> TabUI:
    who = setting.study.participant
    return TabUI(build_bot(setting.templates, who.strategy, setting.study.seed, who.attitude))


def record(bag: Path, study: Study, seconds: float) -> None:
    """Record a hunt with a simulated participant; if it has not ended after this many simulated seconds, stop it."""
    setting = setting_of(study)
    options = PlayOptions(0.0, bag, frozenset(), "suggestion", seconds)
    with suppress(HuntUnfinished):
        asyncio.run(play(setting, (bot_of(setting),), options, lambda where: None, lambda tick_record: None))


def record_beginning(bag: Path, robots: int = 3, seconds: float = 15.0) -> Path:
    """Record the beginning of a hunt with `robots` robots; return the bag."""
    record(bag, dataclasses.replace(STUDY, seed=4, robots=robots), seconds)
    return bag


def replay_again(bag: Path, *changes: StudyChange, to: Path | None = None, to_the_end: bool = False) -> Replayed:
    study = with_changes(read_study_text(bag, session_of(bag).study), [], changes)
    return asyncio.run(
        replay(bag, setting_of(study), ReplayOptions(0.0, 0.0, to, to_the_end), lambda tick_record: None)
    )


def assert_equal_replay(bag: Path, ticks: int) -> None:
    done = replay_again(bag)
    assert done.difference is None
    assert (done.cut_off, done.finished, done.ticks) == (False, True, ticks)
    assert done.messages == len(list(messages(bag))) - 1


@contextmanager
def watched_hunt(bag: Path, *options: str) -> Iterator[int]:
    """Run a hunt in another process until the end of the block; yield the port of its watch server."""
    command = [sys.executable, "-c", "from ui.cli import main; main()", "play", "--headless", "--participant"]
    command += ["suggestion", "--robots", "2", "--seed", "4", "--rate", "1", "--port", "0", "--watch", "0"]
    command += ["--no-report", "--bag", str(bag), *options]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as program:
        told = []
        try:
            for line in program.stderr or ():
                told.append(line)
                found = re.search(r"Researchers can connect to [0-9.]+:([0-9]+)", line)
                if found:
                    yield int(found[1])
                    break
            else:
                raise RuntimeError("".join(told))
        finally:
            program.terminate()
            program.communicate()
