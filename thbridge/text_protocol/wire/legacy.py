"""Dialect ``legacy-2016``: the form of the protocol that the programs of the 2016 treasure hunt used for their game.

On the wire, robot 0 is the first robot and room 0 is the first room. The corridor has no number here. The method
`message` of each value encodes it. `decode` uses only the command and the form of the content, not the sender.

The programs of 2016 recognize a line by one of the words ``ping``, ``error``, ``found``, ``score``, ``image`` and
``snap``. They look for these words in about this order, anywhere in the line. So the names of treasures and pictures
should not contain these words.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TypeAlias

from thbridge.text_protocol.wire.lines import TextCommand, TextMessage, UnreadableText, tokens

SIMR = "SimR"
"""The program that drives the robots."""

TABUI = "TabUI"
"""The participant's program."""

HIDER = "Hider"
"""Name of the program that knows the treasures."""

_HEADING = "45"  # All programs of 2016 sent this heading, and none of them used it.
_MAX_DIGITS = 9  # More digits may not fit into an int of Java.


@dataclass(frozen=True, slots=True)
class GotoRoom:
    """Order from TabUI to send a robot to a room."""

    robot: int
    room: int

    def message(self) -> TextMessage:
        """Return ``%%goto TabUI SimR ROBOT ROOM ROOM 45``: the room's number replaces x and y."""
        return TextMessage.of(TextCommand.GOTO, TABUI, SIMR, f"{self.robot} {self.room} {self.room} {_HEADING}")


@dataclass(frozen=True, slots=True)
class RoomReached:
    """Report of SimR that a robot has reached its room."""

    robot: int
    room: int

    def message(self) -> TextMessage:
        """Return ``%%error SimR TabUI "ROBOT;ROOM"``."""
        return TextMessage.of(TextCommand.ERROR, SIMR, TABUI, f'"{self.robot};{self.room}"')


@dataclass(frozen=True, slots=True)
class AskTreasure:
    """Question of TabUI for the treasure in a room."""

    room: int

    def message(self) -> TextMessage:
        """Return ``%%error TabUI Hider "ROOM"``."""
        return TextMessage.of(TextCommand.ERROR, TABUI, HIDER, f'"{self.room}"')


@dataclass(frozen=True, slots=True)
class FoundTreasure:
    """Answer of Hider: properties that the robot senses in a room. The wire keeps only one of several blanks in a row.

    Attributes:
        room: the room's number.
        senses: label and value of each property. In 2016, the labels were `Colour` and `Footprint`.
    """

    room: int
    senses: tuple[tuple[str, str], ...]

    def message(self) -> TextMessage:
        """Return ``%%found Hider TabUI ROOM ROOM "(Color: C) (Footprint: F)"``."""
        senses = " ".join(f"({label}: {value})" for label, value in self.senses)
        return TextMessage.of(TextCommand.FOUND, HIDER, TABUI, f'{self.room} {self.room} "{senses}"')


@dataclass(frozen=True, slots=True)
class SnapTreasure:
    """Request of TabUI for a picture of the treasure in a room."""

    room: int

    def message(self) -> TextMessage:
        """Return ``%%snap TabUI Hider ROOM``."""
        return TextMessage.of(TextCommand.SNAP, TABUI, HIDER, f"{self.room}")


@dataclass(frozen=True, slots=True)
class TreasureImage:
    """Answer of Hider: the file name of the picture of the treasure in a room.

    Attributes:
        room: the room's number.
        filename: the picture's file name, without a directory.

    Raises:
        ValueError: the file name contains white space (TabUI reads only the last token) or names a directory.
    """

    room: int
    filename: str

    def __post_init__(self) -> None:
        if tokens(self.filename) != [self.filename]:
            raise ValueError(f"a picture's file name must be one word on the wire: {self.filename!r}")
        if re.search(r"[/\\]|^\.\.?$", self.filename):
            raise ValueError(f"a picture's file name must not name a directory: {self.filename!r}")

    def message(self) -> TextMessage:
        """Return ``%%image Hider TabUI ROOM FILENAME``."""
        return TextMessage.of(TextCommand.IMAGE, HIDER, TABUI, f"{self.room} {self.filename}")


@dataclass(frozen=True, slots=True)
class NameTreasure:
    """Message of TabUI: the participant's name for a treasure. The wire keeps only one of several blanks in a row."""

    room: int
    name: str

    def message(self) -> TextMessage:
        """Return ``%%found TabUI Hider "ROOM,NAME``. TabUI never closed the quotation mark."""
        return TextMessage.of(TextCommand.FOUND, TABUI, HIDER, f'"{self.room},{self.name}')


@dataclass(frozen=True, slots=True)
class PointsAwarded:
    """Message of Hider: the points for an identification. They are negative for a wrong identification."""

    points: int

    def message(self) -> TextMessage:
        """Return ``%%score Hider TabUI ,POINTS``."""
        return TextMessage.of(TextCommand.SCORE, HIDER, TABUI, f",{self.points}")


LegacyValue: TypeAlias = (
    GotoRoom | RoomReached | AskTreasure | FoundTreasure | SnapTreasure | TreasureImage | NameTreasure | PointsAwarded
)

_NUMBER = rf"([0-9]{{1,{_MAX_DIGITS}}})"
# The room's number also replaces y, so both numbers must be equal.
_GOTO = re.compile(rf"{_NUMBER} {_NUMBER} \2 {_HEADING}")
_ARRIVED = re.compile(rf'"{_NUMBER};{_NUMBER}"')
_ASK = re.compile(rf'"{_NUMBER}"')
_FOUND = re.compile(rf'{_NUMBER} \1 "((?:\([^():]+: ?.*\))?)"')
# A value may contain brackets, so it ends only before the next label or at the end.
_SENSE = re.compile(r"\(([^():]+): ?(.*?)\)(?= \([^():]+:|$)")
_SNAP = re.compile(_NUMBER)
_IMAGE = re.compile(rf"{_NUMBER} (\S+)")
# The closing quotation mark is optional, because TabUI never sent it.
_IDENTIFY = re.compile(rf'"{_NUMBER}, ?(.*?)"?')
_SCORE = re.compile(rf",(-?[0-9]{{1,{_MAX_DIGITS}}})")


def decode(message: TextMessage) -> LegacyValue | UnreadableText:
    """Return the value in a message of this dialect, or the reason why it cannot be read."""
    text = message.text
    match message.command:
        case TextCommand.GOTO:
            if found := _GOTO.fullmatch(text):
                return GotoRoom(int(found[1]), int(found[2]))
        # The programs of 2016 used some commands for two kinds of messages. Only the content distinguishes them.
        case TextCommand.ERROR:
            if found := _ARRIVED.fullmatch(text):
                return RoomReached(int(found[1]), int(found[2]))
            if found := _ASK.fullmatch(text):
                return AskTreasure(int(found[1]))
        case TextCommand.FOUND:
            if found := _FOUND.fullmatch(text):
                return FoundTreasure(int(found[1]), tuple(_SENSE.findall(found[2])))
            if found := _IDENTIFY.fullmatch(text):
                return NameTreasure(int(found[1]), found[2])
        case TextCommand.SNAP:
            if found := _SNAP.fullmatch(text):
                return SnapTreasure(int(found[1]))
        case TextCommand.IMAGE:
            if found := _IMAGE.fullmatch(text):
                try:
                    return TreasureImage(int(found[1]), found[2])
                except ValueError as error:
                    return UnreadableText(message.line(), str(error))
        case TextCommand.SCORE:
            if found := _SCORE.fullmatch(text):
                return PointsAwarded(int(found[1]))
    return UnreadableText(message.line(), "it is not a line of the legacy-2016 dialect")
