"""Recorded hunts, and the sources that are read from them."""

import dataclasses
from collections.abc import Generator, Mapping
from pathlib import Path

import pytest

from sim.common.geometry import Pose2
from sim.inputs import KidnapRobot, KillRobot, PutThing, ReviveRobot
from thbridge.app.compose.game import build_bot, build_hider, build_keeper
from thbridge.app.compose.recording import build_publisher, build_record, build_writer
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import read_setting
from thbridge.app.play import PLAY
from thbridge.app.session.broadcast import Broadcast
from thbridge.app.session.recording import BagRecorder
from thbridge.app.session.session import Session
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.robot_requests import Request
from thbridge.study.study_file import Study
from thbridge.text_protocol.wire import legacy
from ui.model.watching.tools import obstacle
from ui.sources.bag import BagSource, open_bag


def opened(path: Path) -> BagSource:
    work: Generator[float, None, BagSource] = open_bag(path)
    while True:
        try:
            next(work)
        except StopIteration as done:
            source = done.value
            assert isinstance(source, BagSource)
            return source


def scanned(path: Path) -> BagSource:
    source = opened(path)
    shares = list(source.scan())
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    return source


STUDY = dataclasses.replace(Study(), seed=7, robots=3)
TICKS = 650
DONE: dict[int, Request] = {
    100: PutThing(obstacle("crate", "box", Pose2(0.0, 0.0, 0.0), 0.5)),
    250: KillRobot(1),
    350: KidnapRobot(2, Pose2(-2.869, -2.97, 0.0)),
    450: ReviveRobot(1),
}
"""Requests to the robots during the hunt, by tick."""


def record(bag: Path, study: Study, ticks: int, done: Mapping[int, Request] = DONE) -> None:
    """A hunt with a simulated participant, and these requests."""
    setting = read_setting(study, Path())
    participant = TabUI(build_bot(setting.templates, study.participant.strategy, study.seed))
    session_record = build_record(setting, PLAY, [legacy.SIMR, legacy.HIDER, legacy.TABUI], "suggestion")
    with build_writer(setting, bag) as writer:
        recorder = BagRecorder(Broadcast(build_publisher(setting), session_record, setting.map.grid, [writer]))
        roles = [build_simr(setting), build_hider(setting.templates, setting.study.seed)]
        session = Session(build_keeper(setting), roles, [recorder], (participant,))
        for tick in range(ticks):
            if tick in done:
                session.ask("watch", done[tick])
            session.step()
