"""Hunts that are recorded, and replayed."""

import asyncio
import dataclasses
from pathlib import Path

import pytest

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
    """A hunt with a simulated participant, given up after some time."""
    setting = setting_of(study)
    options = PlayOptions(0.0, bag, frozenset(), "suggestion", seconds)
    with pytest.raises(HuntUnfinished):
        asyncio.run(play(setting, bot_of(setting), options, lambda where: None, lambda tick_record: None))


def again(bag: Path, *changes: StudyChange, to: Path | None = None, to_the_end: bool = False) -> Replayed:
    study = with_changes(read_study_text(bag, session_of(bag).study), [], changes)
    return asyncio.run(
        replay(bag, setting_of(study), ReplayOptions(0.0, 0.0, to, to_the_end), lambda tick_record: None)
    )


def equal(bag: Path, ticks: int) -> None:
    done = again(bag)
    assert done.difference is None
    assert (done.cut_off, done.finished, done.ticks) == (False, True, ticks)
    assert done.messages == len(list(messages(bag))) - 1
