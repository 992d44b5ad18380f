"""Conversion of inputs into records of a bag, and of requests into JSON for other programs, with all fields."""

import json
from dataclasses import replace
from typing import TypeVar

import msgspec
import numpy as np

from sim.inputs import SendGoal
from thbridge.app.session import inputs
from thbridge.credentials import LOCAL, Credentials
from thbridge.json_text import json_of
from thbridge.roles.shared.robot_requests import PACE_REQUESTS, REQUESTS, PaceRequest, Request
from thbridge.ros.messages.goal_owners import GoalOwner, owned_number, recorded_number
from thbridge.ros.messages.records import GoalRequest, SimpleGoal
from thbridge.ros.messages.session_records import InputRecord

T = TypeVar("T")
_CLASSES: dict[str, type[inputs.Input]] = {
    "opened": inputs.ConnectionOpened,
    "received": inputs.BytesReceived,
    "closed": inputs.ConnectionClosed,
    "backlogged": inputs.ConnectionBacklogged,
    "advanced": inputs.ClockAdvanced,
    "said": inputs.ParticipantSent,
    "registered": inputs.NameAccepted,
    "heard": inputs.MessageForwarded,
    "asked": inputs.ClientRequest,
    "linkopened": inputs.LinkOpened,
    "linkclosed": inputs.LinkClosed,
    "framed": inputs.FrameReceived,
    "keptalive": inputs.HeartbeatsSent,
}
"""Classes of inputs, by the kind of the input in recordings."""
_KINDS = {input_class: kind for kind, input_class in _CLASSES.items()}
_REQUEST_NAMES = {request_class: name for name, request_class in {**REQUESTS, **PACE_REQUESTS}.items()}


def to_record(item: inputs.Input) -> InputRecord:
    """Return the record of an input, from which the input can be restored."""
    kind = _KINDS[type(item)]
    if isinstance(item, inputs.ClientRequest):
        line = _readable(f"{_REQUEST_NAMES[type(item.request)]} {_json(item.request)}")
        return InputRecord(kind, item.sender, line, encode_request(item.sender, item.request))
    return InputRecord(kind, *_for_people(item), _json(item))


def from_record(record: InputRecord) -> inputs.Input:
    """Return the input of a record.

    Raises:
        ValueError: the record is not an input, or is an input of another release.
    """
    input_class = _CLASSES.get(record.kind)
    if input_class is None:
        raise ValueError(f"there is no kind of input {record.kind!r}")
    value: object = json_of(record.json)
    return decode_request(value) if input_class is inputs.ClientRequest else decode_value(value, input_class)


def encode_request(sender: str, request: Request | PaceRequest) -> str:
    """Return a request as JSON in one line, with sender, name and fields."""
    name = _REQUEST_NAMES[type(request)]
    return f'{{"sender":{json.dumps(sender)},"request":{json.dumps(name)},"fields":{_json(request)}}}'


def decode_request(value: object) -> inputs.ClientRequest:
    """Return the request in a JSON value.

    Raises:
        ValueError: the value is not a request.
    """
    match value:
        case {"sender": str(sender), "request": str(name), "fields": fields} if name in REQUESTS:
            return inputs.ClientRequest(sender, _with_owner(decode_value(fields, REQUESTS[name])))
    raise ValueError("the request is unknown or invalid")


def _for_people(item: inputs.Input) -> tuple[str, str]:
    """Return the sender of an input, and a description for people.

    Both texts are recorded. If a description is reworded, it needs a row in `thbridge.app.replay.rewordings`.
    """
    match item:
        case inputs.ConnectionOpened(connection, _, credentials):
            key = f" with the key {credentials}" if credentials.key else ""
            return f"connection {connection}", f"a connection is opened{key}"
        case inputs.BytesReceived(_, sender, data):
            return _readable(sender), data.decode(errors="replace").rstrip("\r\n")
        case inputs.ConnectionClosed(_, sender):
            return _readable(sender), "the connection has ended"
        case inputs.ConnectionBacklogged(_, sender, size):
            return _readable(sender), f"the connection is closed: its client has not read {size} bytes"
        case inputs.ClockAdvanced():
            return "", "a silent client is pinged or dropped"
        case inputs.ParticipantSent(message) | inputs.MessageForwarded(message):
            return _readable(message.sender), _readable(message.line())
        case inputs.NameAccepted():
            return "", "the server has accepted the name"
        case inputs.ClientRequest(sender):
            return _readable(sender), ""
        case inputs.LinkOpened(_, name):
            return _readable(name), "a link is opened"
        case inputs.LinkClosed(_, sender):
            return _readable(sender), "the link has ended"
        case inputs.HeartbeatsSent():
            return "", "the vehicles send heartbeats"
        case inputs.FrameReceived(_, sender, frame):
            # Imported here, because sessions without vehicles do not need the definitions of all messages.
            from thbridge.mavlink.wire.dialect import name_of  # noqa: PLC0415

            return _readable(sender), f"{name_of(frame.message_id)} of {frame.system}/{frame.component}"


def _readable(text: str) -> str:
    """Return a text for a bag: characters that UTF-8 cannot encode (lone surrogates) become question marks."""
    return text.encode(errors="replace").decode()


def _json(value: object) -> str:
    """Return a dataclass as JSON: floats with all digits, infinity and NaN as Python names them, bytes in base 64."""
    return json.dumps(_fields(value), separators=(",", ":"))


def _fields(value: object) -> object:
    """Return a dataclass as a dict of plain values. A goal is represented by the recorded number, with its owner."""
    fields: dict[str, object] = msgspec.to_builtins(value, enc_hook=_plain)
    match value:
        case SendGoal(_, goal):
            number = recorded_number(goal.owner, goal.id)
            fields["goal"] = {"id": number, "base_in_map": msgspec.to_builtins(goal.base_in_map)}
        case SimpleGoal(number=number):
            fields["number"] = recorded_number(value.owner, number)
            del fields["owner"]
        case GoalRequest(number=number):
            fields["number"] = recorded_number(GoalOwner.ROS_CLIENT, number)
        case inputs.ConnectionOpened(credentials=credentials) if credentials == LOCAL:
            del fields["credentials"]  # This is the default, because nearly all connections are from this machine.
        case inputs.ConnectionOpened(credentials=Credentials(seats=()) as credentials):
            plain: dict[str, object] = msgspec.to_builtins(credentials)
            del plain["seats"]  # Earlier releases do not have this field.
            fields["credentials"] = plain
    return fields


def _with_owner(request: Request) -> Request:
    """Return a request in which the goal's recorded number is replaced by its owner and the owner's own number."""
    match request:
        case SendGoal(_, goal):
            owner, number = owned_number(goal.id)
            return replace(request, goal=replace(goal, id=number, owner=owner))
        case SimpleGoal(number=recorded):
            owner, number = owned_number(recorded)
            return replace(request, number=number, owner=owner)
        case GoalRequest(number=recorded):
            return replace(request, number=owned_number(recorded)[1])
    return request


def _plain(value: object) -> object:
    if isinstance(value, np.ndarray):
        rows: object = value.tolist()
        return rows
    raise NotImplementedError(f"cannot record a {type(value).__name__}")


def decode_value(value: object, kind: type[T]) -> T:
    """Convert a JSON value into a dataclass. Raises ValueError: the value does not fit."""
    try:
        return msgspec.convert(value, kind, dec_hook=_array)
    except msgspec.ValidationError as error:
        raise ValueError(str(error)) from None


def _array(kind: type, value: object) -> object:
    return np.array(value, dtype=np.float64)
