"""Conversion of the participant's requests to text lines, and of lines of 2016 to requests."""

from thbridge.hunt.rooms import Room
from thbridge.roles.shared.notices import KEEPER
from thbridge.roles.shared.view import IdentifyTreasure, ParticipantRequest, SendRobot, SenseTreasure, TakePicture
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import encode_notice
from thbridge.text_protocol.wire.router import Forwarded

LineRequest = SendRobot | SenseTreasure | TakePicture | IdentifyTreasure
"""A request that has a line of 2016."""


def encode_request_line(
    request: ParticipantRequest, number: int | None = None, sender: str = legacy.TABUI
) -> TextMessage:
    """Return the message for a request: a line of 2016 if there is such a line, otherwise a notice to the keeper.

    Args:
        request: the request.
        number: number of the request, which is the same in each repetition. Lines of 2016 have no number.
        sender: name of the program. In games with several seats, all requests are notices, because lines of 2016 do
            not name the sender reliably.
    """
    if sender != legacy.TABUI:
        return encode_notice(sender, KEEPER, request, number)
    match request:
        case SendRobot(robot, room):
            return legacy.GotoRoom(robot, Room(room).wire).message()
        case SenseTreasure(room):
            return legacy.AskTreasure(Room(room).wire).message()
        case TakePicture(room):
            return legacy.SnapTreasure(Room(room).wire).message()
        case IdentifyTreasure(room, name):
            return legacy.NameTreasure(Room(room).wire, name).message()
        case _:
            return encode_notice(legacy.TABUI, KEEPER, request, number)


def decode_request_line(line: Forwarded) -> LineRequest | None:
    """Return the request in a line of 2016 to any receiver, or None if the line contains no request."""
    match line.legacy_value:
        case legacy.GotoRoom(robot, room):
            return SendRobot(robot, Room.of_wire(room).people)
        case legacy.AskTreasure(room):
            return SenseTreasure(Room.of_wire(room).people)
        case legacy.SnapTreasure(room):
            return TakePicture(Room.of_wire(room).people)
        case legacy.NameTreasure(room, name):
            return IdentifyTreasure(Room.of_wire(room).people, name)
    return None
