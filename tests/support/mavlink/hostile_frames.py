"""Attacker of vehicles: random bytes, spoiled traffic, and complete frames with the worst possible values."""

import copy
import math
import re
import struct

from pymavlink.dialects.v20 import all as mav

from thbridge.mavlink.wire.dialect import SECRETS, crc_extra, decoded, payload_of
from thbridge.mavlink.wire.frames.frame import LARGEST, V1, V2, Frame

FLOATS = (math.nan, math.inf, -math.inf, 3.4e38, -3.4e38, 1e-45, -0.0, 0.0, 1.0, -1.0, 0.5, 255.0, 1e9, 4294967296.0)
INTEGERS = {"b": 8, "B": 8, "h": 16, "H": 16, "i": 32, "I": 32, "q": 64, "Q": 64}
TEXTS = (b"", b"\xff" * 32, b"PARAM_03", b"PARAM_19\0X", b"%s%n{0}", bytes(range(1, 33)), "ÄÖ\u2028".encode())
KNOWN = tuple(sorted(set(mav.mavlink_map) - SECRETS - {mav.MAVLINK_MSG_ID_TEST_TYPES}))
COMMANDS = tuple(sorted(mav.enums["MAV_CMD"]))
_SERVICES = (
    *("COMMAND_", "MISSION_", "PARAM_", "SET_", "MANUAL_", "RC_", "HEARTBEAT", "PING", "TIMESYNC", "SYSTEM_TIME"),
    *("REQUEST_", "CHANGE_", "FILE_", "LOG_REQUEST_", "FENCE_", "RALLY_"),
)

ACTED_ON = tuple(number for number in KNOWN if mav.mavlink_map[number].msgname.startswith(_SERVICES))
"""Messages that vehicles may act on; the attacker sends them more often than others."""


MODEL_NAMES = tuple(f"PARAM_{number:02}" for number in range(20))
"""Parameters of robots that exist only in tests."""


def orders(system):
    """Yield the messages of a ground station that wants to drive a vehicle."""
    east, north = -1_000_000, 515_000_000
    commands = {
        mav.MAV_CMD_COMPONENT_ARM_DISARM: [(1,), (1,), (1,), (0,), (1, 21196)],
        mav.MAV_CMD_DO_SET_MODE: [(1, mode) for mode in (0, 4, 10, 10, 11, 15, 15)] + [(129, 4, 3), (1, 3)],
        mav.MAV_CMD_DO_CHANGE_SPEED: [(1, 0.5, -1), (1, -2)],
        mav.MAV_CMD_SET_MESSAGE_INTERVAL: [(30, 100_000), (32, 0), (0, -1), (0, 60e6), (33, -1), (1, 20_000)],
        mav.MAV_CMD_REQUEST_MESSAGE: [(148,), (242,), (435, 0), (435, 2), (395,), (397,), (0,), (411,)],
        mav.MAV_CMD_MISSION_START: [(0, 0), (1, 2)],
        mav.MAV_CMD_DO_PAUSE_CONTINUE: [(0,), (1,)],
        mav.MAV_CMD_NAV_RETURN_TO_LAUNCH: [()],
        mav.MAV_CMD_GET_HOME_POSITION: [()],
        mav.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: [(1,)],
        mav.MAV_CMD_DO_SET_HOME: [(1,), (0, 0, 0, 0, 51.5, -0.1, 0)],
        mav.MAV_CMD_IMAGE_START_CAPTURE: [(0, 0, 1)],
    }
    for command, choices in commands.items():
        for values in choices:
            yield mav.MAVLink_command_long_message(system, 1, command, 0, *(values + (0,) * 7)[:7])
    for frame in (mav.MAV_FRAME_GLOBAL_INT, mav.MAV_FRAME_GLOBAL_RELATIVE_ALT, mav.MAV_FRAME_LOCAL_NED):
        place = (north, east) if frame != mav.MAV_FRAME_LOCAL_NED else (20_000, 30_000)
        go = mav.MAV_CMD_DO_REPOSITION
        yield mav.MAVLink_command_int_message(system, 1, frame, go, 0, 0, -1, 1, 0, math.nan, *place, 0)
        yield mav.MAVLink_command_int_message(system, 1, frame, mav.MAV_CMD_DO_SET_HOME, 0, 0, 0, 0, 0, 0, *place, 0)
        for seq in range(3):
            item = (system, 1, seq, frame, mav.MAV_CMD_NAV_WAYPOINT, 0, 1, 0, 0, 0, math.nan, *place, 0, 0)
            yield mav.MAVLink_mission_item_int_message(*item)
    yield mav.MAVLink_set_position_target_local_ned_message(0, system, 1, 1, 0xDF8, 2, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0)
    yield mav.MAVLink_set_position_target_local_ned_message(0, system, 1, 8, 0xDC7, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0.2)
    yield mav.MAVLink_manual_control_message(system, 500, 0, 500, 100, 0)
    yield mav.MAVLink_mission_count_message(system, 1, 3, 0)
    yield mav.MAVLink_mission_request_list_message(system, 1, 0)
    yield mav.MAVLink_mission_request_int_message(system, 1, 1, 0)
    yield mav.MAVLink_mission_ack_message(system, 1, 0, 0)
    yield mav.MAVLink_mission_set_current_message(system, 1, 1)
    yield mav.MAVLink_param_set_message(system, 1, b"PARAM_03", 2.0, 9)
    yield mav.MAVLink_param_request_list_message(system, 1)
    yield mav.MAVLink_param_request_read_message(system, 1, b"PARAM_04", -1)
    for opcode, name in ((1, b""), (3, b""), (4, b"parameters.json"), (5, b""), (14, b"general.json"), (15, b"")):
        asked = bytes((0, 0, 0, opcode, len(name) or 80, *[0] * 7)) + name
        yield mav.MAVLink_file_transfer_protocol_message(0, system, 1, list(asked.ljust(251, b"\0")))
    yield mav.MAVLink_change_operator_control_message(system, 0, 0, b"")
    yield mav.MAVLink_set_mode_message(system, 1, 15)
    yield mav.MAVLink_set_home_position_message(system, north, east, 0, 0, 0, 0, [1, 0, 0, 0], 0, 0, 0)
    yield mav.MAVLink_heartbeat_message(mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3)


class Foe:
    """Attacker that sends many kinds of data, always the same for the same random seed.

    Args:
        chance: source of random numbers.
        systems: ids of the vehicles.
        names: names of their parameters.
    """

    def __init__(self, chance, systems, names=MODEL_NAMES):
        self._chance = chance
        self._systems = tuple(systems)
        self._names = tuple(name.encode() for name in names)
        self._orders = [order for system in systems for order in orders(system)]
        self._last = b""
        self._sequence = 0

    def says(self):
        """Return some bytes: a few hundred at most."""
        what = self._chance.random()
        if what < 0.1:
            return self._chance.randbytes(self._chance.randint(1, LARGEST))
        if what < 0.35:
            return self._spoiled(self._last or self.frame().to_bytes())
        self._last = self.frame().to_bytes()
        return self._last

    def frame(self):
        """Return a complete frame with a correct checksum: a valid order, a valid order with one bad field, or one with
        all fields bad."""
        chance = self._chance
        what = chance.random()
        if what < 0.6:
            message = copy.copy(chance.choice(self._orders))
            self._name(message)
            if what < 0.3:
                self._spoil(message)
        else:
            known = mav.mavlink_map[chance.choice(ACTED_ON if what < 0.9 else KNOWN)]
            message = decoded(known.id, self._payload(known))
            self._aim(message)
            if chance.random() < 0.7:
                self._name(message)
        return self._framed(message)

    def _name(self, message):
        """Let a message about a parameter name an existing one."""
        if hasattr(message, "_param_id_raw"):
            message._param_id_raw = self._chance.choice(self._names)

    def _spoil(self, message):
        """Set one field to the worst possible value."""
        kind = type(message)
        worst = decoded(kind.id, self._payload(kind))
        name = self._chance.choice(kind.fieldnames)
        for attribute in (name, f"_{name}_raw"):
            if hasattr(message, attribute):
                setattr(message, attribute, getattr(worst, attribute))

    def _framed(self, message):
        chance, message_id = self._chance, message.get_msgId()
        self._sequence = (self._sequence + chance.choice((1, 1, 1, 1, 7, 0))) % 256
        system, component = 255, 190
        if chance.random() < 0.1:
            system = chance.choice((254, 0, *self._systems, chance.randrange(256)))
            component = chance.choice((190, 0, 1, chance.randrange(256)))
        version = V1 if message_id < 256 and chance.random() < 0.1 else V2
        payload = payload_of(message)
        if version == V1:
            payload = payload.ljust(mav.mavlink_map[message_id].unpacker.size, b"\0")
        elif chance.random() < 0.1:
            payload = payload[: chance.randint(1, len(payload))]
        elif chance.random() < 0.05:
            payload = (payload + chance.randbytes(64))[:255]
        return Frame(system, component, self._sequence, message_id, payload, crc_extra(message_id), version)

    def _aim(self, message):
        """Address most messages to the vehicles, with values that vehicles know."""
        chance = self._chance
        if chance.random() < 0.9:
            for name, ids in (("target_system", (0, *self._systems)), ("target_component", (0, 1))):
                if hasattr(message, name):
                    setattr(message, name, chance.choice(ids))
        if isinstance(message, mav.MAVLink_manual_control_message):
            message.target = chance.choice(self._systems)
        for name, values in (
            ("command", COMMANDS),
            ("frame", (0, 1, 3, 5, 6, 7, 8, 11, 21)),
            ("coordinate_frame", (1, 7, 8, 9, 6, 11)),
            ("seq", range(5)),
            ("count", range(5)),
            ("mission_type", (0, 0, 0, 1, 2, 255)),
            ("confirmation", (0, 0, 0, 1, 2)),
        ):
            if isinstance(getattr(message, name, None), int) and chance.random() < 0.8:
                setattr(message, name, chance.choice(values))

    def _payload(self, kind):
        """Return the payload of a message, with many of its values as bad as possible."""
        values = []
        layout = kind.unpacker.format
        for count, code in re.findall(r"(\d*)([a-zA-Z])", layout):
            if code == "s":
                values.append(self._chance.choice(TEXTS))
            else:
                values += [self._value(code) for _ in range(int(count or 1))]
        return struct.pack(layout, *values)

    def _value(self, code):
        chance = self._chance
        if code == "c":
            return b"c"
        if code in "fd":
            return chance.choice(FLOATS) if chance.random() < 0.6 else chance.uniform(-20, 20)
        bits = INTEGERS[code]
        low, high = (0, 2**bits - 1) if code.isupper() else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
        return chance.choice((low, high, low + 1, high - 1, 0, 1, 2, chance.randint(low, high)))

    def _spoiled(self, data):
        chance = self._chance
        match chance.randrange(6):
            case 0:  # Bits are flipped.
                bytes_since_good = bytearray(data)
                for _ in range(chance.randint(1, 8)):
                    bytes_since_good[chance.randrange(len(bytes_since_good))] ^= 1 << chance.randrange(8)
                return bytes(bytes_since_good)
            case 1:  # The data end early.
                return data[: chance.randint(1, len(data))]
            case 2:  # The data begin late.
                return data[chance.randrange(len(data)) :]
            case 3:  # The data are repeated.
                return data * chance.randint(2, 5)
            case 4:  # The length field is changed.
                return data[:1] + chance.randbytes(1) + data[2:]
            case _:  # Another frame is inserted.
                place = chance.randrange(len(data))
                return data[:place] + self.frame().to_bytes() + data[place:]
