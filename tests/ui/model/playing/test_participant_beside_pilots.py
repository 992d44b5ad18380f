"""A whole hunt steered by a ground station, while the participant's window follows it."""

import pytest

from tests.support.mavlink.piloted_hunt import STATION, PilotedHunt
from thbridge.app.compose.game import build_briefing
from thbridge.hunt.events import RobotArrived, TreasureIdentified
from thbridge.mavlink.values.vehicle_interface import LegState, Target
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.notices import PoseTelemetry
from ui.model.playing.participant import Participant
from ui.model.playing.screen import Phase

TICK = 0.02


class Follower:
    """The window's model behind a TabUI."""

    def __init__(self) -> None:
        self.model = Participant()
        self.model.connected(0.0)
        self.now = 0.0

    def observe(self, level) -> None:
        if isinstance(level, PoseTelemetry):
            self.now = level.tick * TICK
        self.model.receive(level, self.now)

    def requests(self, view):
        return self.model.requests()


@pytest.mark.slow
def test_the_window_follows_a_hunt_that_a_ground_station_steers():
    follower = Follower()
    flight = PilotedHunt(participant=TabUI(follower, follower))
    names = build_briefing(flight.setting).names
    for pilot in flight.pilots:
        pilot.take(STATION)
    flight.run(3)
    rooms = iter(range(1, 9))
    while flight.session.game.ended is None:
        for robot, pilot in enumerate(flight.pilots):
            leg = flight.readings[robot].leg
            if leg is not None and leg.state is LegState.UNDER_WAY:
                continue
            here = flight.session.game.robots[robot].at
            if not here.is_corridor and not flight.session.game.room(here).is_decided:
                pilot.identify(names.index(flight.session.game.treasure(here).name) + 1)
            elif (room := next(rooms, None)) is not None:
                assert isinstance(pilot.go_to(Target(*flight.goal_of(room))), int)
        flight.run(3)
        if len(flight.tick_records) > 20_000:
            raise TimeoutError("the hunt does not end")
    flight.run(50)
    screen = follower.model.screen(follower.now)
    game = flight.session.game
    assert len(flight.events(RobotArrived)) == len(flight.events(TreasureIdentified)) == 8
    assert (screen.phase, screen.score) == (Phase.OVER, game.score)
    assert all(card.commanded == "commanded by ground station 255" for card in screen.cards)
    texts = [line.text for line in screen.history]
    assert sum("is right" in text for text in texts) == 8
    assert "Robot 1 is in room 1." in texts
