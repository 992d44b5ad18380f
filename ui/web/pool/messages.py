"""Messages between the gateway and a worker: one JSON object per line, over a socket on this machine or another one.

The docstring of each message begins with its sender.
"""

from typing import TypeAlias

import msgspec

LONGEST_LINE = 4 * 1024 * 1024
"""Bytes of the longest line; a picture is the largest part of a message."""


class GatewayHello(msgspec.Struct, frozen=True, tag="hello"):
    """Gateway: first message of a connection.

    Attributes:
        token: the worker's secret.
        seat: name of the seat whose messages the connection has; empty in a game with one participant. If None, no
            person is there: the connection keeps the game alive, and gets its result.
    """

    token: str
    seat: str | None = ""


class BrowserJoined(msgspec.Struct, frozen=True, tag="joined"):
    """Gateway: a browser shows the game from now on; it has received nothing yet.

    `stream` numbers the browsers, because messages for an earlier browser may still be on their way. `again` is True if
    the page of the last browser has connected again.
    """

    stream: int
    again: bool = False


class BrowserLeft(msgspec.Struct, frozen=True, tag="left"):
    """Gateway: no browser shows the game at the moment."""


class FromBrowser(msgspec.Struct, frozen=True, tag="browser"):
    """Gateway: a message of the browser, unchanged."""

    text: str


class WindowSeenOver(msgspec.Struct, frozen=True, tag="window seen over"):
    """Gateway: the window of the person, who has no browser, shows the end of the game."""


class WatchWanted(msgspec.Struct, frozen=True, tag="watch"):
    """Gateway: a researcher wants to watch the game with `thbridge watch`."""


class PersonLeft(msgspec.Struct, frozen=True, tag="leave"):
    """Gateway: the person has left the game, or their run has ended. The game ends when all people have left.

    If `everybody` is True, all people have left.
    """

    everybody: bool = False


class SeatFilled(msgspec.Struct, frozen=True, tag="filled"):
    """Gateway: a program takes this seat, because its person has left the game or is away for too long."""

    seat: str


class SeatResumed(msgspec.Struct, frozen=True, tag="resumed"):
    """Gateway: the person of this seat has come back, so the program leaves the seat to them."""

    seat: str


class ResultKept(msgspec.Struct, frozen=True, tag="kept"):
    """Gateway: the result is kept; a worker on another machine waits for this message."""


class ToBrowser(msgspec.Struct, frozen=True, tag="show"):
    """Worker: a message for the browser with this number, to be passed on unchanged."""

    text: str
    stream: int


class GameReady(msgspec.Struct, frozen=True, tag="ready"):
    """Worker: the game can be joined. A window joins it at this address of the worker's machine."""

    host: str
    port: int


class GameWatched(msgspec.Struct, frozen=True, tag="watched"):
    """Worker: researchers' windows can connect to this TCP port of the worker's machine."""

    port: int


class SeatSeenOver(msgspec.Struct, frozen=True, tag="seen over"):
    """Worker: the browser shows the end of the game."""


class SeatWentOn(msgspec.Struct, frozen=True, tag="went on"):
    """Worker: the person continues after the game."""


class SeatDeclined(msgspec.Struct, frozen=True, tag="declined"):
    """Worker: the person does not take part in the study."""


class PersonActed(msgspec.Struct, frozen=True, tag="acted"):
    """Worker: the person did an act of this kind; `view_age` is the age of the page on which they acted, milliseconds.

    It is the time from the moment at which the worker sent the page to the moment at which it received the act.
    """

    act: str
    view_age: float


class GamePassed(msgspec.Struct, frozen=True, tag="passed"):
    """Worker: times of the game, seconds; see `ui.hosting.kiosk.games.GameWatcher`."""

    seconds: float
    lag: float
    left: float


class StillToDo(msgspec.Struct, frozen=True, tag="to do"):
    """Worker: what must still be done in a practice game, by the names of its terms."""

    missing: dict[str, float]


class TimeIsUp(msgspec.Struct, frozen=True, tag="time is up"):
    """Worker: the time of the game is over."""


class RecordingBrokenOff(msgspec.Struct, frozen=True, tag="broken off"):
    """Worker: an earlier game was abandoned; `bag` is the path of its recording, or None."""

    bag: str | None


class RecordingCutOff(msgspec.Struct, frozen=True, tag="cut off"):
    """Worker: the recording at this path ended with its program, and its game is resumed."""

    bag: str


class WorkerResult(msgspec.Struct, frozen=True, tag="ended"):
    """Worker: the game has ended, and its files are complete.

    Attributes:
        result: result of the request in JSON.
        declined: True if the person did not agree to take part.
        problem: sentence about the reason if the game could not be played; empty otherwise.
    """

    result: msgspec.Raw = msgspec.Raw(b"null")
    problem: str = ""
    declined: bool = False


ToWorker: TypeAlias = (
    GatewayHello
    | BrowserJoined
    | BrowserLeft
    | FromBrowser
    | PersonLeft
    | WindowSeenOver
    | WatchWanted
    | SeatFilled
    | SeatResumed
    | ResultKept
)
FromWorker: TypeAlias = (
    ToBrowser
    | GameReady
    | GameWatched
    | SeatSeenOver
    | SeatWentOn
    | SeatDeclined
    | PersonActed
    | GamePassed
    | StillToDo
    | TimeIsUp
    | RecordingBrokenOff
    | RecordingCutOff
    | WorkerResult
)

TO_WORKER = msgspec.json.Decoder(ToWorker)
FROM_WORKER = msgspec.json.Decoder(FromWorker)


def encode_line(message: ToWorker | FromWorker) -> bytes:
    """Return the line of a message."""
    return msgspec.json.encode(message) + b"\n"
