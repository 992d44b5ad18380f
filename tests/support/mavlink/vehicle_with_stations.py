"""Vehicle with a model robot at its helm, and ground stations that send it one message at a time."""

import math
from dataclasses import replace

from tests.support.mavlink.model_robot import ModelRobot
from thbridge.mavlink.values.options import AutopilotIdentity, Failsafe, GeoOrigin, VehicleOptions
from thbridge.mavlink.values.vehicle_interface import LegState, Station
from thbridge.mavlink.vehicle.mode.home import HomePosition
from thbridge.mavlink.vehicle.vehicle import Vehicle
from thbridge.mavlink.wire.dialect import decoded, mav, payload_of
from thbridge.mavlink.wire.outgoing import LinkId

OPTIONS = VehicleOptions(AutopilotIdentity.GENERIC, GeoOrigin(52.4, 9.7, 55.0), 5.0, Failsafe.STOP, 5.0)
HERE, THERE = LinkId(0), LinkId(1)
US, THEM = Station(255, 190), Station(245, 190)
NAN = math.nan
SECOND = 50

ACCEPTED, BUSY, DENIED, UNSUPPORTED, FAILED, IN_PROGRESS, CANCELLED, LONG_ONLY, INT_ONLY, NO_FRAME = range(10)


class Game(ModelRobot):
    """Robot whose game grants command at once. It is under way while its leg is."""

    def take(self, station):
        denied = super().take(station)
        if denied is None:
            self.readings = replace(self.readings, commander=str(station), commanded_by=str(station))
        return denied

    def release(self):
        super().release()
        self.readings = replace(self.readings, commander=None, commanded_by="participant")

    def go_to(self, target):
        number = super().go_to(target)
        self.readings = replace(self.readings, under_way=self.refusal is None or self.readings.under_way)
        return number

    def stop_robot(self):
        super().stop_robot()
        leg = self.readings.leg
        if leg is not None and leg.state is LegState.UNDER_WAY:
            leg = replace(leg, state=LegState.FAILED, reason="stopped")
        self.readings = replace(self.readings, leg=leg, under_way=False)

    def arrive(self):
        super().arrive()
        self.readings = replace(self.readings, under_way=False)

    def fail(self, reason):
        super().fail(reason)
        self.readings = replace(self.readings, under_way=False)

    def come(self, remaining):
        """Set the remaining distance of the current leg, meters."""
        self.readings = replace(self.readings, leg=replace(self.readings.leg, remaining=remaining))

    def calls(self, name):
        """Return the calls with this name."""
        return [call for call in self.asked if call[0] == name]


class VehicleWithStations:
    """Vehicle of system 3. A test steps it tick by tick, and messages are encoded and decoded, as on a link.

    Attributes:
        robot: robot at its helm.
        vehicle: vehicle under test.
        tick: latest tick.
        heard: messages that it has sent without a request.
    """

    def __init__(self, **options):
        self.robot = Game()
        self.vehicle = Vehicle(3, self.robot, replace(OPTIONS, **options))
        self.tick = -1
        self.heard = []
        self.run(1)

    def run(self, ticks=1, beating=()):
        """Let ticks pass, in which the stations in `beating` send heartbeats; return the messages of the vehicle."""
        said = []
        for _ in range(ticks):
            self.tick += 1
            if self.tick % SECOND == 0:
                for station in beating:
                    self.hear(HEARTBEAT, station)
            said += _sent(self.vehicle.step(self.tick, self.robot.readings))
        self.heard += said
        return said

    def hear(self, message, station=US, link=HERE):
        """Send a message to the vehicle; return its immediate answers."""
        again = decoded(message.get_msgId(), payload_of(message))
        return list(_sent(self.vehicle.handle_message(link, station, again)))

    def long(self, command, *params, station=US, link=HERE, confirmation=0):
        """Send a command as COMMAND_LONG; return the results in its acknowledgements."""
        params = (*params, *[NAN] * (7 - len(params)))
        message = mav.MAVLink_command_long_message(3, 1, command, confirmation, *params)
        return acks(self.hear(message, station, link), command)

    def int(self, command, *params, frame=0, x=0x7FFFFFFF, y=0x7FFFFFFF, station=US, link=HERE):
        """Send a command as COMMAND_INT; return the results in its acknowledgements."""
        params = (*params, *[NAN] * (4 - len(params)))
        message = mav.MAVLink_command_int_message(3, 1, frame, command, 0, 0, *params, x, y, NAN)
        return acks(self.hear(message, station, link), command)

    def go(self, x, y, station=US, link=HERE, command=mav.MAV_CMD_DO_REPOSITION):
        """Send the robot to a point of the map, in the local frame."""
        return self.int(command, x=round(y * 1e4), y=round(x * 1e4), frame=1, station=station, link=link)

    def arm(self, station=US, force=0, link=HERE):
        """Arm the vehicle, which is one method to take command."""
        return self.long(mav.MAV_CMD_COMPONENT_ARM_DISARM, 1, force, station=station, link=link)

    def disarm(self, station=US):
        """Disarm the vehicle."""
        return self.long(mav.MAV_CMD_COMPONENT_ARM_DISARM, 0, station=station)

    def mode(self, main, sub=0, station=US):
        """Set a mode by its PX4 number."""
        return self.long(mav.MAV_CMD_DO_SET_MODE, 1, main, sub, station=station)

    @property
    def status(self):
        return self.vehicle.status

    def texts(self):
        """Return the sentences that the vehicle has sent; chunks are joined."""
        self.run(3 * SECOND)
        texts, parts = [], b""
        for message in messages(self.heard, "STATUSTEXT"):
            parts += message._text_raw
            if message.id == 0 or len(message._text_raw) < 50:
                texts.append(parts.decode())
                parts = b""
        return texts


def home_of(robot, earth):
    """Return the home position of a single robot."""
    home = HomePosition(robot, earth)
    list(home.step(0, robot.readings))
    return home


HEARTBEAT = mav.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)


def _sent(said):
    """Yield the messages, after checking that each one can be encoded."""
    for word in said:
        payload_of(word.message)
        yield word


def acks(said, command):
    """Return the results in the acknowledgements of a command."""
    return [ack.result for ack in messages(said, "COMMAND_ACK") if ack.command == command]


def messages(said, kind=None):
    """Return the messages, or only those of one type."""
    return [word.message for word in said if kind in (None, word.message.get_type())]
