"""Whatever comes in: vehicles live on, keep their heartbeat and their memory, and steer by no nonsense."""

import gc
import math
import random
import tracemalloc
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND, Twist
from tests.support.mavlink.hostile_frames import Foe
from tests.support.mavlink.random_frames import frames
from thbridge.mavlink.hub import Hub
from thbridge.mavlink.values.options import AutopilotIdentity, Failsafe, GeoOrigin, VehicleOptions
from thbridge.mavlink.values.vehicle_interface import (
    Denied,
    HelmLeg,
    LegState,
    ParameterDescription,
    ParameterSetting,
    RobotReadings,
)
from thbridge.mavlink.vehicle.vehicle import Vehicle
from thbridge.mavlink.wire.dialect import crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import LARGEST, Frame
from thbridge.mavlink.wire.frames.framer import FrameParser, frame_of
from thbridge.mavlink.wire.outgoing import LinkId

ROBOTS = 3
SYSTEMS = range(1, ROBOTS + 1)
FOE, FRIEND = LinkId(0), LinkId(1)
FOES_BYTES_A_TICK = 1000
STILL = RobotReadings(Pose2(1, 2, 0), Twist(0, 0), None, 50, 100, True, False, False, None, "participant", None)
HEARTBEAT = mav.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)


class Sailor:
    """Holds a robot's helm: does what it is told, and takes no order that is none."""

    def __init__(self, chance):
        self._chance = chance
        self._commander = None
        self._leg = None
        self._values = {f"PARAM_{number:02}": number / 2 for number in range(20)}

    def step(self):
        """A tick has passed; legs end somehow."""
        leg = self._leg
        if leg is not None and leg.state is LegState.UNDER_WAY and self._chance.random() < 0.05:
            end = self._chance.choice((LegState.ARRIVED, LegState.FAILED))
            self._leg = replace(leg, state=end, remaining=0.0, reason="no way" if end is LegState.FAILED else "")
        who = "participant" if self._commander is None else self._commander
        under_way = self._leg is not None and self._leg.state is LegState.UNDER_WAY
        return replace(STILL, commander=self._commander, commanded_by=who, leg=self._leg, under_way=under_way)

    def take(self, station):
        self._commander = str(station)

    def release(self):
        self._commander = None

    def go_to(self, target):
        assert math.isfinite(target.x) and math.isfinite(target.y)
        assert target.heading is None or math.isfinite(target.heading)
        if self._chance.random() < 0.2:
            return Denied("there is a wall")
        number = 1 if self._leg is None else self._leg.number + 1
        self._leg = HelmLeg(number, LegState.UNDER_WAY, 1.0)
        return number

    def stop_robot(self):
        if self._leg is not None and self._leg.state is LegState.UNDER_WAY:
            self._leg = replace(self._leg, state=LegState.FAILED, reason="halted")

    def drive(self, twist):
        fastest = self.fastest()
        assert abs(twist.linear) <= fastest.linear
        assert abs(twist.angular) <= fastest.angular

    def fastest(self):
        return Twist(1.0, 2.0)

    def limit_speed(self, speed):
        assert math.isfinite(speed)

    def start(self):
        return Pose2(1.0, 2.0, 0.0)

    @property
    def parameters(self):
        return self

    def descriptions(self):
        return [ParameterDescription(name, "a number", "", "robot", "tests") for name in self._values]

    def misplaced(self, x, y):
        assert max(abs(x), abs(y)) < 1e8  # meters: cells can be counted, and there are none farther away on earth
        if self._chance.random() < 0.2:
            return Denied("there is a wall")
        return None

    unreachable = misplaced

    def settings(self):
        return [ParameterSetting(name, value) for name, value in self._values.items()]

    def setting(self, name):
        return ParameterSetting(name, self._values[name]) if name in self._values else None

    def change(self, name, value):
        assert name in self._values
        if not math.isfinite(value):
            return Denied("that is no number")
        self._values[name] = value
        return ParameterSetting(name, value)

    def photograph(self):
        return None

    def identify(self, number):
        assert isinstance(number, int)

    def leave(self):
        return None


class Rig:
    """Three vehicles, a foe on one link and a friend on another."""

    def __init__(self, seed, identity=AutopilotIdentity.ARDUPILOT, failsafe=Failsafe.STOP):
        self.chance = random.Random(seed)
        options = VehicleOptions(identity, GeoOrigin(51.5, -0.1, 20.0), 5.0, failsafe, 5.0)
        self.sailors = [Sailor(self.chance) for _ in SYSTEMS]
        pairs = zip(SYSTEMS, self.sailors, strict=True)
        self.hub = Hub([Vehicle(system, sailor, options) for system, sailor in pairs], 5.0)
        self.framer = FrameParser()
        self.tick = 0
        self.beaten = {}
        for link in (FOE, FRIEND):
            self.hub.open(link, str(link))
        for _ in range(TICKS_PER_SECOND):
            self.step()

    def feed(self, data):
        """The foe says something."""
        for found in self.framer.receive_data(data):
            if isinstance(found, Frame):
                self._look_at(self.hub.receive(FOE, found).replies)

    def step(self):
        """A tick passes; all hearts must have beaten within the second before it."""
        self._look_at(self.hub.step(self.tick, [sailor.step() for sailor in self.sailors]))
        self.hub.take_traffic()
        self.tick += 1
        for link in (FOE, FRIEND):
            for system in SYSTEMS:
                last = self.beaten.get((link, system), 0)
                assert self.tick - 1 - last <= TICKS_PER_SECOND, f"vehicle {system} is silent on link {link}"

    def asks(self, message):
        """What the friend is told when it asks something."""
        message_id = message.get_msgId()
        frame = Frame(253, 190, 0, message_id, payload_of(message), crc_extra(message_id))
        sent = self.hub.receive(FRIEND, frame).replies
        self._look_at(sent)
        return [one.frame for one in sent if one.link == FRIEND]

    def suffer(self, size):
        """So many bytes of the foe's, tick for tick."""
        foe = Foe(self.chance, SYSTEMS)
        left = size
        while left > 0:
            some = 0
            while some < FOES_BYTES_A_TICK:
                data = foe.says()
                self.feed(data)
                some += len(data)
            self.step()
            left -= some

    def _look_at(self, sent):
        for one in sent:
            if one.frame.message_id == mav.MAVLINK_MSG_ID_HEARTBEAT and one.frame.system in SYSTEMS:
                self.beaten[one.link, one.frame.system] = self.tick
            if self.chance.random() < 0.02:
                assert frame_of(one.frame.to_bytes()) == one.frame


pieces = st.one_of(
    st.binary(max_size=2 * LARGEST),
    frames().map(Frame.to_bytes),
    st.randoms(use_true_random=False).map(lambda chance: Foe(chance, SYSTEMS).says()),
)


@settings(max_examples=60)
@given(st.lists(pieces, max_size=30), st.sampled_from(AutopilotIdentity), st.sampled_from(Failsafe))
def test_nothing_that_comes_in_stops_a_heart(said, identity, failsafe):
    rig = Rig(1, identity, failsafe)
    for data in said:
        rig.feed(data)
        rig.step()
    for _ in range(TICKS_PER_SECOND):
        rig.step()


@pytest.mark.parametrize("identity", AutopilotIdentity)
def test_a_flood_stops_no_heart_and_others_are_still_served(identity):
    rig = Rig(2, identity)
    rig.suffer(200_000)
    assert_served(rig)


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_ten_million_bytes_stop_no_heart_and_take_no_memory():
    rig = Rig(3)
    rig.suffer(1_000_000)
    tracemalloc.start()
    try:
        rig.suffer(1_000_000)
        gc.collect()
        before, _ = tracemalloc.get_traced_memory()
        rig.suffer(8_000_000)
        gc.collect()
        after, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    print(f"after 2 MB: {before / 1024:.0f} KiB; after 10 MB: {after / 1024:.0f} KiB, at most {peak / 1024:.0f} KiB")
    assert after - before < 256 * 1024
    assert peak < 8 * 1024 * 1024
    assert_served(rig)


def assert_served(rig):
    """Somebody else still gets an answer from every vehicle, to a question and to a wish."""
    for system in SYSTEMS:
        for message in (
            mav.MAVLink_command_long_message(system, 1, mav.MAV_CMD_REQUEST_MESSAGE, 0, 148, 0, 0, 0, 0, 0, 0),
            mav.MAVLink_param_request_read_message(system, 1, b"PARAM_03", -1),
        ):
            answers = rig.asks(message)
            assert answers, f"vehicle {system} does not answer {message}"
            assert {answer.system for answer in answers} == {system}
