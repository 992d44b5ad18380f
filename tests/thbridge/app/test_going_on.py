"""A game whose program has died goes on, by the log of its inputs, as if nothing had happened."""

import asyncio
import dataclasses
from pathlib import Path

import pytest

from thbridge.app.compose.game import build_bot
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.play import HuntOutcome, PlayOptions, play
from thbridge.app.programs import tabui
from thbridge.app.replay.replay import ReplayOptions, replay
from thbridge.app.session.input_log import GameDiffers
from thbridge.app.session.session import TickRecord
from thbridge.recording.bag.reading import reader
from thbridge.recording.recordings import make_room
from thbridge.roles.participant.tabui import TabUI
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.study.study_file import BotStrategy, ServerSection, Study
from thbridge.text_protocol.wire import legacy

STUDY = Study(map="practice", templates="practice", robots=1, server=ServerSection(port=0))


class CrashError(Exception):
    """The program dies."""


async def played(setting: StudySetting, options: PlayOptions, dies: int | None = None) -> HuntOutcome:
    """Play with a participant of another program, over TCP, until a tick in which the program dies."""
    program: asyncio.Task[object] | None = None
    bot = build_bot(setting.templates, BotStrategy.SUGGESTION, 1)

    def ready(where: ListeningAddress | CannotListen) -> None:
        nonlocal program
        assert isinstance(where, ListeningAddress)
        # As for a window that is opened again, the mark of the program is the same.
        role = TabUI(bot, first_number=1000 * (dies or 1))
        joining = tabui(role, where.host, where.port, "token", lambda _lost: None, lambda _view: None)
        program = asyncio.create_task(joining)

    def progress(moment: TickRecord) -> None:
        if moment.tick == dies:
            raise CrashError

    try:
        return await play(setting, (), options, ready, progress)
    finally:
        if program is not None:
            program.cancel()
            await asyncio.gather(program, return_exceptions=True)


def messages(bag: Path) -> list[tuple[str, int, bytes]]:
    return [(each.topic, each.stamp_ns, each.data) for each in reader.messages(bag)]


def test_what_was_done_before_is_done_again_and_then_it_goes_on(tmp_path: Path) -> None:
    setting = read_setting(STUDY, tmp_path)
    bag = tmp_path / "trial.bag"
    options = PlayOptions(20.0, bag, frozenset({legacy.TABUI}), "", 600.0, inputs=tmp_path / "trial.inputs", left=None)
    cut_off = []
    for tick in (150, 151, 700):
        with pytest.raises(CrashError):
            asyncio.run(played(setting, options, tick))
        moved = make_room(bag)
        assert moved is not None
        cut_off.append(messages(moved))
    outcome = asyncio.run(played(setting, options))

    assert outcome.over is not None
    whole = messages(bag)
    for before in cut_off:
        # The last ticks are in no log: nothing came in, and a second has not passed.
        agreed = [each for each in before if each[1] <= before[-1][1] - 1_000_000_000]
        assert len(agreed) > 100
        assert whole[: len(agreed)] == agreed
    again = asyncio.run(replay(bag, setting, ReplayOptions(0.0, 0.0, None, False), lambda _moment: None))
    assert again.finished
    assert again.difference is None


def test_a_game_of_another_study_does_not_go_on(tmp_path: Path) -> None:
    options = PlayOptions(0.0, None, frozenset(), "suggestion", 600.0, inputs=tmp_path / "trial.inputs")

    def die(moment: TickRecord) -> None:
        if moment.tick == 60:
            raise CrashError

    def begin(study: Study) -> None:
        setting = read_setting(study, tmp_path)
        participant = TabUI(build_bot(setting.templates, BotStrategy.SUGGESTION, 1))
        asyncio.run(play(setting, () if participant is None else (participant,), options, lambda _where: None, die))

    with pytest.raises(CrashError):
        begin(STUDY)
    with pytest.raises(GameDiffers, match="another study"):
        begin(dataclasses.replace(STUDY, seed=2))
    with pytest.raises(CrashError):
        begin(STUDY)


def test_a_game_that_goes_another_way_is_noticed(tmp_path: Path) -> None:
    log = tmp_path / "trial.inputs"
    options = PlayOptions(0.0, None, frozenset(), "suggestion", 5.0, inputs=log)
    setting = read_setting(STUDY, tmp_path)

    def die(moment: TickRecord) -> None:
        if moment.tick == 160:
            raise CrashError

    def begin() -> None:
        participant = TabUI(build_bot(setting.templates, BotStrategy.SUGGESTION, 1))
        asyncio.run(play(setting, () if participant is None else (participant,), options, lambda _where: None, die))

    with pytest.raises(CrashError):
        begin()
    lines = log.read_bytes().splitlines(keepends=True)
    assert b'"tick":150' in lines[-1]
    changed = lines[-1].replace(b'"digest":"', b'"digest":"f')
    log.write_bytes(b"".join([*lines[:-1], changed, b'{"tick":160,"inp']))  # and the next is torn
    with pytest.raises(GameDiffers, match="robots have other poses"):
        begin()
    log.write_bytes(b"".join([*lines, b'{"tick":160,"inp']))
    with pytest.raises(CrashError):
        begin()
    log.write_bytes(b"".join([*lines[:2], b"nonsense\n", *lines[2:]]))
    with pytest.raises(Exception, match="line 3: this line is damaged"):
        begin()
