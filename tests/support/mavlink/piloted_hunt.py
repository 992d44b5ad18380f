"""Hunt with the real robots, and a pilot at each robot's helm."""

from dataclasses import replace
from functools import cache
from pathlib import Path

from sim.snapshot import TeamSnapshot
from tests.support.hunts.hunt_without_simulator import Log
from tests.support.hunts.scripted_hunt import ScriptedPlayer
from thbridge.app.compose.game import build_hider, build_keeper
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.compose.vehicles import build_game_setup
from thbridge.app.session.session import Session, TickRecord
from thbridge.mavlink.role.pilot import Pilot
from thbridge.mavlink.role.speed_limit import SpeedLimit
from thbridge.mavlink.values.vehicle_interface import LegState, RobotReadings, Station
from thbridge.mavlink.values.vehicle_interface import ParameterSetting as Parameter
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.robot_requests import GameRequest, Request
from thbridge.roles.shared.view import AnswerDialogue, ParticipantRequest, SelectRoom, SendRobot
from thbridge.roles.simr.simr import SimR
from thbridge.study.seats import SeatEntry
from thbridge.study.study_file import Study

STATION = Station(255, 190)


class Parameters:
    """Single parameter, as a pilot passes it on."""

    def settings(self):
        return [Parameter("ONE", 1.0)]

    def setting(self, name):
        return Parameter(name, 1.0) if name == "ONE" else None

    def change(self, name, value):
        return Parameter(name, value)


@cache
def setting(energy: float = 100.0, seats: tuple[SeatEntry, ...] = ()) -> StudySetting:
    study = Study(robots=2, seats=seats)
    software = replace(study.robot, localization="truth")
    return read_setting(replace(study, robot=software, game=replace(study.game, energy=energy)), Path())


class PilotedHunt:
    """Session with a silent participant and a pilot at each robot's helm."""

    def __init__(
        self, energy: float = 100.0, participant: TabUI | None = None, seats: tuple[SeatEntry, ...] = ()
    ) -> None:
        made = setting(energy, seats)
        self.setting = made
        self.log = Log()
        self.player = ScriptedPlayer()
        self.simr: SimR = build_simr(made)
        self.keeper = build_keeper(made)
        self.tabui = participant or TabUI(self.player)
        self.session = Session(
            self.keeper,
            [self.simr, build_hider(made.templates, made.study.seed), self.tabui],
            log=self.log,
        )
        self.asked: list[Request] = []
        setup = build_game_setup(made)
        software = made.study.software(1)
        self.pilots = [
            Pilot(robot, setup, made.map.starts[robot], SpeedLimit(robot, software, self.simr), Parameters(), self.ask)
            for robot in range(2)
        ]
        self.pilot = self.pilots[0]
        self.readings: list[RobotReadings] = []
        self.tick_records: list[TickRecord] = []
        self.news: list[str] = []
        self.run(10)

    def ask(self, request: Request) -> None:
        self.asked.append(request)
        if isinstance(request, GameRequest):
            self.keeper.ask(request)
        else:
            self.simr.ask(request)

    def run(self, ticks: int = 1) -> RobotReadings:
        for _ in range(ticks):
            tick_record = self.session.step()
            self.tick_records.append(tick_record)
            self.readings = [pilot.follow(tick_record.snapshot, tick_record.game) for pilot in self.pilots]
            self.news += self.readings[0].announcements
        return self.readings[0]

    def until(self, state: LegState, ticks: int = 4000) -> RobotReadings:
        for _ in range(ticks):
            if self.run().leg.state is state:
                return self.readings[0]
        raise TimeoutError(f"the leg is {self.readings[0].leg}")

    def taken(self) -> "PilotedHunt":
        assert self.pilot.take(STATION) is None
        self.run()
        return self

    def send_as_participant(self, room: int) -> None:
        self._wish(SelectRoom(0, room))
        while not self.tabui.view.consents:
            (dialogue,) = self.tabui.view.dialogues
            self._wish(AnswerDialogue(dialogue.dialogue, dialogue.turn, 0))
        self._wish(SendRobot(0, room))

    def _wish(self, wish: ParticipantRequest) -> None:
        self.player.wish = (wish,)
        self.tabui.poll_player()
        self.run(6)
        self.player.wish = ()

    def goal_of(self, room: int) -> tuple[float, float]:
        goal = self.setting.map.rooms[room - 1].goal
        return goal.x, goal.y

    @property
    def session_snapshot(self) -> TeamSnapshot:
        return self.tick_records[-1].snapshot

    def events(self, *kinds: type) -> list:
        return [event for event in self.log.events if isinstance(event, kinds)]
