"""A hunt with a window that is stopped from outside, at whatever point, does not go on to the next game."""

import asyncio
import os
import signal
from pathlib import Path

import pytest

from thbridge.app.compose.game import build_bot
from thbridge.app.compose.setting import read_setting
from thbridge.app.play import HuntUnfinished, PlayOptions, play
from thbridge.app.session.session import TickRecord
from thbridge.roles.participant.tabui import TabUI
from thbridge.study.study_file import BotStrategy, ServerSection, Study


@pytest.mark.parametrize("over", [False, True])
def test_it_ends_by_a_signal_during_a_game_and_after_one(over: bool) -> None:
    setting = read_setting(Study(map="practice", templates="practice", robots=1, server=ServerSection(port=0)), Path())
    participant = TabUI(build_bot(setting.templates, BotStrategy.SUGGESTION, 1))

    def stop(moment: TickRecord) -> None:
        if moment.game is not None and (moment.game.ended is not None) is over:
            os.kill(os.getpid(), signal.SIGTERM)

    options = PlayOptions(0.0, None, frozenset(), "suggestion", 600.0, left=lambda: False)
    with pytest.raises(HuntUnfinished) as early:
        asyncio.run(play(setting, () if participant is None else (participant,), options, lambda _where: None, stop))
    assert early.value.stopped
    assert (early.value.outcome.over is not None) is over
