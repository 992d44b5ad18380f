"""Ground station that behaves like common clients, without sockets and clocks; it repeats unanswered requests.

It follows the rules of MAVLink's guide for a station, with the timeouts and retries of QGroundControl and MAVSDK:
250 ms for an item that it requested, 1500 ms for all other requests, and five retries. It restarts a failed transfer,
as a person would.
"""

import random
from collections import deque

from thbridge.mavlink.values.vehicle_interface import Station
from thbridge.mavlink.wire.dialect import decoded, mav, payload_of

ITEM, OTHER = 13, 75
"""Ticks until a request is repeated: for an item, and for all other requests."""

RETRIES = 5

# If an item arrives after the vehicle gave up the transfer, because its message about that was lost, the vehicle sends
# MAV_MISSION_ERROR.
GIVEN_UP = ("timeout", mav.MAV_MISSION_OPERATION_CANCELLED, mav.MAV_MISSION_ERROR)


def waypoint(
    latitude, longitude, command=mav.MAV_CMD_NAV_WAYPOINT, params=(0.0, 0.0, 0.0, float("nan")), frame=6, z=0.0
):
    """Return an item as a station stores it, without number and target."""
    return (frame, command, 0, 1, *params, latitude, longitude, z)


class ModelStation:
    """Station that talks to the vehicle of system 1.

    Attributes:
        result: result of its last transfer: a code of MAV_MISSION_RESULT, or "timeout"; None during the transfer.
        downloaded: items that it has read, as MISSION_ITEM_INT fields from `frame` on.
        heard: all messages that it has received.
    """

    def __init__(self, system=255, component=190, patience=RETRIES, attempts=1):
        self.station = Station(system, component)
        self.heard = []
        self.result = None
        self.downloaded = []
        self._attempts = attempts
        self._patience = patience
        self._begin = None
        self._last = None
        self._wait = 0
        self._due = 0
        self._tries = 0
        self._out = deque()
        self._tick = 0
        self._items = []
        self._count = 0

    def upload(self, items, mission_type=0):
        """Send these items."""
        self._items = items
        self._start(lambda: mav.MAVLink_mission_count_message(1, 1, len(items), mission_type))

    def download(self, mission_type=0):
        """Read all items."""
        self._start(lambda: mav.MAVLink_mission_request_list_message(1, 1, mission_type))

    def clear(self, mission_type=0):
        """Delete all items."""
        self._start(lambda: mav.MAVLink_mission_clear_all_message(1, 1, mission_type))

    def say(self, message):
        """Send a message without waiting for an answer."""
        self._out.append(message)

    def _start(self, begin):
        self._count, self.downloaded = None, []
        self._begin, self.result, self._left = begin, None, self._attempts
        self._expect(begin(), OTHER)

    def _expect(self, message, wait, fresh=True):
        self._last, self._wait, self._due = message, wait, self._tick + wait
        self._tries = 0 if fresh else self._tries
        self._out.append(message)

    def _end(self, result):
        self._last = None
        if result in GIVEN_UP and self._left > 1:
            self._left -= 1
            self._count, self.downloaded = None, []
            self._expect(self._begin(), OTHER)
        else:
            self.result = result

    def step(self, tick):
        """Return the messages that the station sends in this tick."""
        self._tick = tick
        if self._last is not None and tick >= self._due:
            if self._tries == self._patience:
                self._end("timeout")
            else:
                self._tries += 1
                self._expect(self._last, self._wait, fresh=False)
        out, self._out = list(self._out), deque()
        return out

    def hear(self, message):
        """Receive a message from the vehicle."""
        self.heard.append(message)
        if self._last is None:
            return
        match message.get_type():
            case "MISSION_REQUEST_INT" | "MISSION_REQUEST" if self._is("MISSION_COUNT", "MISSION_ITEM_INT"):
                if message.seq < len(self._items):
                    item = self._items[message.seq]
                    self._expect(mav.MAVLink_mission_item_int_message(1, 1, message.seq, *item), ITEM)
            case "MISSION_COUNT" if self._is("MISSION_REQUEST_LIST"):
                self._count = message.count
                self._next()
            case "MISSION_ITEM_INT" if self._is("MISSION_REQUEST_INT") and message.seq == len(self.downloaded):
                self.downloaded.append(tuple(message.to_dict()[name] for name in message.fieldnames[3:-1]))
                self._next()
            case "MISSION_ACK" if not self._is("MISSION_REQUEST_LIST", "MISSION_REQUEST_INT"):
                if message.type != mav.MAV_MISSION_ACCEPTED or self._may_be_over():
                    self._end(message.type)

    def _may_be_over(self):
        """Return False if an acknowledgement cannot end the current upload, because the last item was not sent yet."""
        return not self._is("MISSION_ITEM_INT") or self._last.seq == len(self._items) - 1

    def _is(self, *names):
        return self._last.get_type() in names

    def _next(self):
        if len(self.downloaded) < self._count:
            self._expect(mav.MAVLink_mission_request_int_message(1, 1, len(self.downloaded)), ITEM)
        else:
            self.say(mav.MAVLink_mission_ack_message(1, 1, mav.MAV_MISSION_ACCEPTED))
            self._end(mav.MAV_MISSION_ACCEPTED)

    def of(self, name):
        """Return all received messages of one type."""
        return [message for message in self.heard if message.get_type() == name]


class Air:
    """Link between stations and the parts of one vehicle; it can lose, repeat and delay messages.

    Args:
        parts: parts of a vehicle.
        stations: ground stations, each on a separate link.
        robot: robot with `readings`.
        seed: random seed.
        loss, repeats, late: probabilities that a message is lost, repeated or delayed, in both directions.
    """

    def __init__(self, parts, stations, robot, seed=0, loss=0.0, repeats=0.0, late=0.0):
        self.tick = 0
        self._parts, self._stations, self._robot = parts, stations, robot
        self._chance = random.Random(seed)
        self._loss, self._repeats, self._late = loss, repeats, late
        self._up, self._down = [], []

    def run(self, ticks=1, until=lambda: False):
        """Let ticks pass; stop earlier if a condition is true."""
        for _ in range(ticks):
            self.tick += 1
            for number, station in enumerate(self._stations):
                for message in station.step(self.tick):
                    self._send(self._up, number, message)
            for number, message in self._arrived("_up"):
                for part in self._parts:
                    self._said(part.handle_message(number, self._stations[number].station, message))
            for part in self._parts:
                self._said(part.step(self.tick, self._robot.readings))
            for number, message in self._arrived("_down"):
                self._stations[number].hear(message)
            if until():
                return

    def _said(self, said):
        for word in said:
            for number in range(len(self._stations)) if word.link is None else (word.link,):
                self._send(self._down, number, word.message)

    def _send(self, way, number, message):
        again = decoded(message.get_msgId(), payload_of(message))
        for _ in range(2 if self._chance.random() < self._repeats else 1):
            if self._chance.random() >= self._loss:
                delay = self._chance.randint(1, 5) if self._chance.random() < self._late else 0
                way.append((self.tick + delay, number, again))

    def _arrived(self, way):
        there = getattr(self, way)
        setattr(self, way, [one for one in there if one[0] > self.tick])
        return [(number, message) for tick, number, message in there if tick <= self.tick]
