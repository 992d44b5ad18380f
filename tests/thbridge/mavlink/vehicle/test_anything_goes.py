"""Two stations, a participant and a researcher at one robot, in any order: what holds all the same."""

from dataclasses import replace

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from sim.common.observations import STANDSTILL
from tests.support.mavlink.model_station import waypoint
from tests.support.mavlink.vehicle_with_stations import (
    ACCEPTED,
    HEARTBEAT,
    SECOND,
    THEM,
    US,
    VehicleWithStations,
    messages,
)
from thbridge.mavlink.values.options import Failsafe
from thbridge.mavlink.values.vehicle_interface import LegState
from thbridge.mavlink.wire.dialect import mav

STATIONS = st.sampled_from([US, THEM])
MODES = st.sampled_from([(4, 3), (6, 0), (4, 4), (4, 5), (1, 0)])
COORDINATES = st.integers(-20, 20)
COMMANDED = "ground station"


class Anything(RuleBasedStateMachine):
    """One vehicle and all who may have a hand in it."""

    def __init__(self):
        super().__init__()
        self.rig = VehicleWithStations(failsafe=Failsafe.HOME)
        self.seen = 0
        self.commander = None
        self.home = (1.0, 2.0)
        self.quiet = False
        self.heard = 0

    # -- what may happen

    @rule(station=STATIONS, force=st.sampled_from([0, 21196]))
    def arm(self, station, force):
        if self.rig.arm(station, force) == [ACCEPTED]:
            if station != self.commander:
                self.heard = self.rig.tick
            self.commander, self.quiet = station, False

    @rule(station=STATIONS)
    def disarm(self, station):
        assert self.rig.disarm(station) == [ACCEPTED]
        self.commander, self.quiet = None, True

    @rule(station=STATIONS, mode=MODES)
    def mode(self, station, mode):
        accepted = self.rig.mode(*mode, station=station) == [ACCEPTED]
        if accepted:
            self.quiet = mode == (4, 3)

    @rule(station=STATIONS, pause=st.booleans())
    def pause(self, station, pause):
        accepted = self.rig.long(mav.MAV_CMD_DO_PAUSE_CONTINUE, 0 if pause else 1, station=station) == [ACCEPTED]
        if accepted:
            self.quiet = pause

    @rule(station=STATIONS, x=COORDINATES, y=COORDINATES, command=st.sampled_from([192, 16]))
    def go(self, station, x, y, command):
        (result,) = self.rig.go(x, y, station, command=command)
        if result in (0, 5):
            assert station == self.commander
            self.quiet = False

    @rule(station=STATIONS, x=COORDINATES, y=COORDINATES)
    def set_home(self, station, x, y):
        (result,) = self.rig.go(x, y, station, command=mav.MAV_CMD_DO_SET_HOME)
        if result == ACCEPTED:
            assert self.commander in (None, station)
            self.home = (x, y)

    @rule(station=STATIONS, count=st.integers(0, 3))
    def upload(self, station, count):
        self.rig.hear(mav.MAVLink_mission_count_message(3, 1, count), station)
        for number in range(count):
            item = waypoint(524_000_000 + number, 97_000_000)
            self.rig.hear(mav.MAVLink_mission_item_int_message(3, 1, number, *item), station)

    @rule(station=STATIONS)
    def start(self, station):
        if self.rig.long(mav.MAV_CMD_MISSION_START, 0, 0, station=station) == [ACCEPTED]:
            assert station == self.commander
            self.quiet = False

    @rule(station=STATIONS, x=st.integers(-1000, 1000))
    def stick(self, station, x):
        self.rig.hear(mav.MAVLink_manual_control_message(3, x, 0, 0, 0, 0), station)

    @rule(station=STATIONS, velocity=st.floats(-2, 2))
    def setpoint(self, station, velocity):
        mask = 0b1101_1100_0111
        message = mav.MAVLink_set_position_target_local_ned_message(
            0, 3, 1, 1, mask, 0, 0, 0, velocity, 0, 0, 0, 0, 0, 0, 0
        )
        self.rig.hear(message, station)

    @precondition(lambda self: self._leg_state() is LegState.UNDER_WAY)
    @rule(well=st.booleans())
    def leg_ends(self, well):
        if well:
            self.rig.robot.arrive()
        else:
            self.rig.robot.fail("a wall")

    @rule(takes=st.booleans())
    def researcher(self, takes):
        readings = self.rig.robot.readings
        who = "researcher" if takes else readings.commander or "participant"
        self.rig.robot.readings = replace(readings, commanded_by=who)

    @rule(ticks=st.integers(1, 300), beating=st.booleans())
    def time_passes(self, ticks, beating):
        if beating:
            for station in (US, THEM):
                self.rig.hear(HEARTBEAT, station)
            self.heard = self.rig.tick
        self._pass(ticks)

    # -- what holds all the same

    @invariant()
    def only_the_station_in_command_moves_the_robot(self):
        asked = self.rig.robot.asked[self.seen :]
        self.seen = len(self.rig.robot.asked)
        moved = [call for call in asked if call[0] == "go_to" or (call[0] == "drive" and call[1] != STANDSTILL)]
        if self.quiet:
            assert moved == [], "who was stopped stays where it is"
        if self.commander is None and moved:
            assert moved[-1][0:3] == ("go_to", *self.home), "all but home"

    @invariant()
    def a_mission_runs_in_mode_auto_and_in_no_other(self):
        self._pass(1)
        ask = mav.MAVLink_command_long_message(3, 1, 512, 0, 42, 0, 0, 0, 0, 0, 0)
        current = messages(self.rig.hear(ask), "MISSION_CURRENT")[0]
        if current.mission_state == mav.MISSION_STATE_ACTIVE:
            assert self.rig.status.mode == "AUTO"

    @invariant()
    def who_is_in_command_agrees_with_the_game(self):
        commander = self.rig.robot.readings.commander
        assert (commander is not None) == (self.commander is not None)
        if commander is not None:
            assert self.rig.status.armed
            assert commander == str(self.commander)

    def teardown(self):
        beats = messages(self.rig.run(4 * SECOND), "HEARTBEAT")
        assert len(beats) >= 4

    def _pass(self, ticks):
        for _ in range(ticks):
            if self.commander is not None and self.rig.tick + 1 - self.heard > 5 * SECOND:
                # Lost: it goes home by itself, and is the participant's. What it did until now was the station's.
                self.only_the_station_in_command_moves_the_robot()
                self.commander, self.quiet = None, False
            self.rig.run(1)

    def _leg_state(self):
        leg = self.rig.robot.readings.leg
        return None if leg is None else leg.state


TestAnythingGoes = Anything.TestCase
TestAnythingGoes.settings = settings(max_examples=60, stateful_step_count=40, deadline=None)
