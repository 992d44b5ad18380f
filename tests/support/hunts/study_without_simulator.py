"""Game of a study without a simulator: the keeper, the treasures and all files of the study are the real ones."""

from collections.abc import Sequence
from pathlib import Path

from tests.support.hunts.hunt_without_simulator import Log
from thbridge.app.compose.game import build_hider, build_keeper
from thbridge.app.compose.setting import read_setting
from thbridge.app.session.session import Session
from thbridge.app.trials.puppets import Puppets
from thbridge.roles.keeper.disclosed.disclosure import plain_costs
from thbridge.roles.shared.notices import PlannedPaths, PoseTelemetry, RobotMotion
from thbridge.roles.shared.role import Role
from thbridge.study.study_file import Study
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import encode_notice

TELEMETRY_PERIOD = 10
"""Ticks between two messages about the robots' poses."""


class SeenPuppets(Puppets):
    """Puppets whose poses, activities and paths the participant sees, as those of simulated robots."""

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        """Run one tick; see `Role`."""
        said = super().step(tick, messages)
        if tick % TELEMETRY_PERIOD == 0:
            notices = self._telemetry(tick), PlannedPaths(tick, tuple(() for _ in range(self.robots)))
            said += [encode_notice(self.name, legacy.TABUI, notice) for notice in notices]
        return said

    def _telemetry(self, tick: int) -> PoseTelemetry:
        motions = [RobotMotion() for _ in range(self.robots)]
        for robot, (_, due) in self._moves.items():
            share = 1.0 - (due - tick) / self.ticks
            motions[robot] = RobotMotion("driving", None, share, 1.0 - share)
        return PoseTelemetry(tick, tuple((float(robot), 0.0, 0.0) for robot in range(self.robots)), tuple(motions))


class StudyWithoutSimulator:
    """Game of a study, with robots that need the same time for each move.

    Args:
        study: the study.
        participant: role of the participant; the router sends them what the game reveals.
        ticks: duration of a move in ticks.
        beside: folder to which paths in the study are relative.

    Attributes:
        log: events of the game.
    """

    def __init__(self, study: Study, participant: Role, ticks: int = 30, beside: Path = Path()) -> None:
        self.setting = read_setting(study, beside)
        self.log = Log()
        self.puppets = SeenPuppets(study.robots, plain_costs(self.setting.costs), ticks, self.setting.map.name)
        hider = build_hider(self.setting.templates, study.seed)
        self.session = Session(build_keeper(self.setting), [self.puppets, participant, hider], log=self.log)
