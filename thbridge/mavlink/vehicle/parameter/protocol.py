"""Parameter protocol, by which stations read and set a robot's numeric parameters. It has no sockets and clocks.

Source: the MAVLink developer guide, "Parameter Protocol" and "Extended Parameter Protocol".
Differences from the source: the answer to a request for an unknown parameter is PARAM_ERROR, which is newer than most
of the guide.
"""

import math
from collections.abc import Iterator, Sequence

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.values.vehicle_interface import (
    DenialKind,
    Denied,
    ParameterSetting,
    ParameterSettings,
    RobotReadings,
    Station,
)
from thbridge.mavlink.vehicle.parts import Announce, Microservice, TextSeverity
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage

VALUES_PER_TICK = 3
"""Number of values of a list that are sent per tick on each link. This is 150 values per second."""

_BY_NAME = -1
"""Index of a request by name."""

_TYPE_UNSUPPORTED = 6
"""Code of MAV_PARAM_ERROR that pymavlink's dialect does not have."""

_ERRORS = {
    DenialKind.DENIED: mav.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE,
    DenialKind.NOT_NOW: mav.MAV_PARAM_ERROR_PERMISSION_DENIED,
    DenialKind.UNSUPPORTED: mav.MAV_PARAM_ERROR_READ_ONLY,
}


class ParameterProtocol(Microservice):
    """Parameter protocol of one robot, whose parameters are all 32-bit floats.

    Args:
        settings: the parameters.
        announce: sends texts to people.
        ardupilot: True if a value is the number itself, whatever type the station declares. If False, only float values
            are accepted, because values of other types would be encoded as their bytes.
    """

    def __init__(self, settings: ParameterSettings, announce: Announce, ardupilot: bool) -> None:
        self._settings = settings
        self._announce = announce
        self._ardupilot = ardupilot
        # Last value of each parameter that was sent to stations.
        self._sent: dict[str, float] = {}
        self._lists: dict[LinkId, int] = {}

    def handle_message(self, link: LinkId, sender: Station, message: Message) -> Iterator[OutgoingMessage]:
        """Answer a message of this protocol."""
        match message:
            case mav.MAVLink_param_request_list_message():
                self._lists[link] = 0
            case mav.MAVLink_param_request_read_message():
                yield from self._read(link, sender, message.param_index, message.param_id)
            case mav.MAVLink_param_set_message():
                value, kind = message.param_value, message.param_type
                yield from self._set(link, sender, message.param_id, value, kind)
            case mav.MAVLink_param_ext_request_list_message():
                # The count of 0 means that there are no extended parameters.
                yield OutgoingMessage(
                    mav.MAVLink_param_ext_value_message(b"", b"", mav.MAV_PARAM_EXT_TYPE_REAL32, 0, 0), link
                )
            case mav.MAVLink_param_ext_request_read_message():
                # The protocol has no answer for an unknown parameter. A failed acknowledgement is the nearest.
                yield _unextended(link, message.param_id, "", mav.MAV_PARAM_EXT_TYPE_REAL32)
            case mav.MAVLink_param_ext_set_message():
                yield _unextended(link, message.param_id, message.param_value, message.param_type)

    def step(self, tick: int, readings: RobotReadings) -> Iterator[OutgoingMessage]:
        """Continue the lists. Once per second, send all links the values that other clients have changed."""
        is_whole_second = tick % TICKS_PER_SECOND == 0
        if not self._lists and not is_whole_second:
            return
        settings = self._settings.settings()
        for link, start in list(self._lists.items()):
            stop = start + VALUES_PER_TICK
            for number in range(start, min(stop, len(settings))):
                yield OutgoingMessage(_value(settings, number), link)
            self._lists[link] = stop
            if stop >= len(settings):
                del self._lists[link]
        if is_whole_second:
            for number, setting in enumerate(settings):
                if self._sent.setdefault(setting.name, setting.value) != setting.value:
                    yield self._news(settings, number)

    def forget(self, link: LinkId) -> None:
        """Forget a closed link and its list."""
        self._lists.pop(link, None)

    def _read(self, link: LinkId, sender: Station, index: int, name: str) -> Iterator[OutgoingMessage]:
        settings = self._settings.settings()
        # A request contains an index, or -1 and a name.
        number = _number(settings, name) if index == _BY_NAME else index
        if number is None or not 0 <= number < len(settings):
            yield _error(link, sender, name, index, mav.MAV_PARAM_ERROR_DOES_NOT_EXIST)
        else:
            yield OutgoingMessage(_value(settings, number), link)

    def _set(self, link: LinkId, sender: Station, name: str, value: float, kind: int) -> Iterator[OutgoingMessage]:
        number = _number(self._settings.settings(), name)
        if number is None:
            yield _error(link, sender, name, _BY_NAME, mav.MAV_PARAM_ERROR_DOES_NOT_EXIST)
            return
        error = self._changed(name, value, kind)
        settings = self._settings.settings()
        if error is None:
            yield self._news(settings, number)
        else:
            # The error is sent before the old value. So a station that supports the error does not retry.
            yield _error(link, sender, name, _BY_NAME, error)
            yield OutgoingMessage(_value(settings, number), link)

    def _changed(self, name: str, value: float, kind: int) -> int | None:
        """Change a parameter. Return a code of MAV_PARAM_ERROR if its value does not change."""
        if kind != mav.MAV_PARAM_TYPE_REAL32 and not self._ardupilot:
            return _TYPE_UNSUPPORTED
        if not math.isfinite(value):
            return mav.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE
        changed = self._settings.change(name, value)
        if isinstance(changed, Denied):
            self._announce(TextSeverity.WARNING, changed.sentence)
            return _ERRORS[changed.kind]
        return None

    def _news(self, settings: Sequence[ParameterSetting], number: int) -> OutgoingMessage:
        """Return the new value of a parameter, for all links."""
        self._sent[settings[number].name] = settings[number].value
        return OutgoingMessage(_value(settings, number))


def _number(settings: Sequence[ParameterSetting], name: str) -> int | None:
    return next((number for number, setting in enumerate(settings) if setting.name == name), None)


def _value(settings: Sequence[ParameterSetting], number: int) -> Message:
    name, value = _on_wire(settings[number].name), settings[number].value
    return mav.MAVLink_param_value_message(name, value, mav.MAV_PARAM_TYPE_REAL32, len(settings), number)


def _error(link: LinkId, station: Station, name: str, index: int, error: int) -> OutgoingMessage:
    target = station.system, station.component
    return OutgoingMessage(mav.MAVLink_param_error_message(*target, _on_wire(name), index, error), link)


def _unextended(link: LinkId, name: str, value: str, kind: int) -> OutgoingMessage:
    """Return the answer to a request for an extended parameter. Robots have no extended parameters."""
    ack = mav.MAVLink_param_ext_ack_message(_on_wire(name), _on_wire(value), kind, mav.PARAM_ACK_FAILED)
    return OutgoingMessage(ack, link)


def _on_wire(text: str) -> bytes:
    """Encode a name. Characters that are not ASCII become question marks."""
    return text.encode("ascii", errors="replace")
