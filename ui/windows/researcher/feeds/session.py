"""Running session as a feed. A thread receives the session's messages and sends requests."""

import asyncio
import threading
from collections import deque
from collections.abc import Callable
from pathlib import Path

from sim.common.grid import OccupancyGrid
from thbridge.app.session.watch_requests import request_line
from thbridge.files.map_files import MapRoom
from thbridge.roles.shared.robot_requests import Pause, Resume, SetRate, Step
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.ros.names import MAP_FRAME
from thbridge.sockets.addresses import Address
from thbridge.sockets.admission import is_own
from thbridge.sockets.reconnecting import ConnectionLost, LossReason
from thbridge.watching.sockets.client import WatchClient, WatchConnected
from thbridge.watching.wire import SessionMessage, WatchStatus, parse_status
from ui.model.watching.frames import Frames
from ui.model.watching.live import LiveSource
from ui.model.watching.scene import Scene, ShownLayers
from ui.sources.rooms import rooms_of
from ui.windows.researcher.feeds.feed import FeedData, FeedRequest

SENDER = "watch"
"""Sender of this window's requests."""
DELAY_WINDOW = 2.0
"""Length of the time window in which delays of messages are compared, seconds."""
LAG_THRESHOLD, LAG_WINDOW = 0.5, 10.0
"""A session is reported as too slow if its lag increases by more than the first number within the second number,
seconds."""
_WILDCARDS = frozenset({"0.0.0.0", "::"})
"""Addresses of servers that listen on all addresses of their machine."""
STALE_AFTER = 1.5
"""After this number of seconds without a message, "no messages" is reported for a session that is not paused."""


class WatchConnection:
    """Thread that runs a client until the connection is closed.

    Args:
        client: client to run.
    """

    def __init__(self, client: WatchClient) -> None:
        self.client = client
        self._loop = asyncio.new_event_loop()
        self._listening = self._loop.create_task(client.run())
        self._thread = threading.Thread(target=self._run, name="watch", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Close the connection, and wait for the thread."""
        # Only the thread that runs the event loop may cancel the loop's task.
        self._loop.call_soon_threadsafe(self._listening.cancel)
        self._thread.join()

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        # Make the first call here. It takes half a second, and would block the window later.
        Frames(()).planar(MAP_FRAME)
        try:
            self._loop.run_until_complete(self._listening)
        except asyncio.CancelledError:
            pass
        finally:
            self._loop.close()


class SessionTransport:
    """Time of a running session; see `FeedTransport`.

    Args:
        source: messages of the session.
        ask: function that sends a request to the session.

    Attributes:
        status: latest status of the watch server; None until a connection receives its first status.
    """

    def __init__(self, source: LiveSource, ask: Callable[[FeedRequest], object]) -> None:
        self.status: WatchStatus | None = None
        self._source = source
        self._ask = ask

    @property
    def time(self) -> float:
        """Time of the latest message."""
        return (self._source.end_ns - self._source.start_ns) / 1e9

    span = time

    @property
    def playing(self) -> bool:
        """True while the session advances, by the latest status of the watch server."""
        return self.status is None or not (self.status.paused or self.status.ended)

    @property
    def speed(self) -> float:
        """Requested speed."""
        return 1.0 if self.status is None else self.status.rate

    def play(self, on: bool) -> None:
        """Ask the session to continue, or to pause."""
        self._ask(Resume() if on else Pause())

    def step(self, steps: int) -> None:
        """Ask for this number of ticks. The time of a session cannot go back."""
        if steps > 0:
            self._ask(Step(steps))

    def set_speed(self, speed: float) -> None:
        """Ask for this speed."""
        self._ask(SetRate(speed))

    def seek(self, time: float) -> None:
        """Do nothing, because a running session cannot go to another time. Its recording can."""

    def loop(self, span: tuple[float, float] | None) -> None:
        """Do nothing, because the time of a session only goes forward."""


class SessionFeed:
    """Feed of a running session; see `Feed`.

    Args:
        connection: connection to the watch server.
        address: address of the watch server, for people.
        key: file with the researcher's key; None for none.
    """

    live = True
    refusal = ""

    def __init__(self, connection: WatchConnection, address: str, key: Path | None = None) -> None:
        self._connection = connection
        self._address = address
        self._key = key
        self._source = LiveSource()
        self.transport = SessionTransport(self._source, self.ask)
        self._lost: ConnectionLost | None = None
        self._connected = False
        self._refusals = 0
        self._notices: list[str] = []
        self._delays: deque[tuple[float, float]] = deque()
        self._lags: deque[tuple[float, float]] = deque()
        self._rooms: tuple[int, tuple[MapRoom, ...]] | None = None
        self._asked_for_rooms = -1

    @property
    def data(self) -> FeedData:
        """All data since the window connected, and the earlier log entries that the session sends."""
        source = self._source
        known_since = 0.0 if source.joined_ns is None else (source.joined_ns - source.start_ns) / 1e9
        return FeedData(source.sessions, source.start_ns, source.log, source.series, known_since)

    @property
    def ended_bag(self) -> str | None:
        """Path of the session's bag on the session's machine, after the session has ended."""
        status = self.transport.status
        return status.bag if status is not None and status.ended else None

    @property
    def no_seat(self) -> str:
        """Sentence with the reason why the researcher cannot take any seat; see `Feed`."""
        found = self._seat_server()
        return found if isinstance(found, str) else ""

    def seat_command(self, seat: str) -> tuple[str, ...] | str:
        """Return the arguments of the command that opens a window for a seat; see `Feed`."""
        server = self._seat_server()
        if isinstance(server, str):
            return server
        # Programs on the machine of the game need no key.
        key = () if self._key is None or is_own(server.host) else ("--key", str(self._key))
        return ("tabui", "--as-researcher", "--seat", seat, "--server", f"{server.host}:{server.port}", *key)

    def _seat_server(self) -> Address | str:
        """Return the text server of the game, as this machine reaches it, or the reason why it does not."""
        status = self.transport.status
        if self.ended_bag is not None or status is None:
            return "There is no running game."
        host, _, port = status.game.rpartition(":")
        if not port.isdecimal():
            return "Your key only allows watching, or the game's server is not open yet."
        watched = self._address.rpartition(":")[0].strip("[]")
        if host in _WILDCARDS:
            host = watched
        elif is_own(host) and not is_own(watched):
            return (
                f"The game's server only accepts programs on its own machine ({watched}). Run `thbridge watch` there, "
                "or start the game with another address of its server."
            )
        return Address(host, int(port))

    def advance(self, now: float) -> None:
        """Handle the received messages."""
        messages: list[SessionMessage] = []
        for event in self._connection.client.take():
            match event:
                case WatchConnected():
                    self._connected, self._lost = True, None
                    # The old status may belong to a previous session, which may have ended.
                    self.transport.status = None
                case ConnectionLost():
                    self._connected, self._lost = False, event
                case SessionMessage():
                    status = parse_status(event)
                    if status is None:
                        messages.append(event)
                    else:
                        self._take_status(status, now)
        self._source.take(messages, now)
        if messages:
            self._measure(now)
        self._find_rooms()

    def _take_status(self, status: WatchStatus, now: float) -> None:
        before, self.transport.status = self.transport.status, status
        self._lags.append((now, status.lag))
        while self._lags[0][0] < now - LAG_WINDOW:
            self._lags.popleft()
        if before is None or (before.paused, before.rate) != (status.paused, status.rate):
            self._delays.clear()
        if status.refusals < self._refusals:
            self._refusals = 0  # The count restarts with each connection.
        if status.refused is not None and status.refusals > self._refusals:
            self._notices.append(f"Refused: {status.refused.reason}.")
        self._refusals = status.refusals

    def _measure(self, now: float) -> None:
        """Record the delay of the latest message, to compare it with the smallest delay of the last seconds."""
        if not self.transport.playing or self.transport.speed == 0.0:
            self._delays.clear()
        self._delays.append((now, now - self._source.end_ns / 1e9 / (self.transport.speed or 1.0)))
        while self._delays[0][0] < now - DELAY_WINDOW:
            self._delays.popleft()

    def _find_rooms(self) -> None:
        """Read the session's rooms in a thread, because reading a map takes more time than a frame."""
        record = self._source.session
        if record is not None and self._asked_for_rooms != self._source.sessions:
            self._asked_for_rooms = self._source.sessions
            threading.Thread(target=self._read_rooms, args=(record, self._source.sessions), daemon=True).start()
        if self._rooms is not None and self._rooms[0] == self._source.sessions:
            self._source.rooms, self._rooms = self._rooms[1], None

    def _read_rooms(self, record: SessionRecord, generation: int) -> None:
        # A single assignment needs no lock: the window's thread sees either both new values or both old values.
        self._rooms = generation, rooms_of(record, Path("session.bag"))

    def work(self) -> bool:
        """Do nothing, because there is no background work."""
        return False

    def scene(self, shown: ShownLayers) -> Scene | None:
        """Return the latest scene."""
        return self._source.scene(shown) if self._source.messages else None

    def state(self, now: float) -> str:
        """Return the state of the session in words, with the delay of the window."""
        if self.ended_bag is not None:
            return "session ended"
        if not self._connected:
            return "not connected"
        status = self.transport.status
        if status is not None and status.paused:
            return "live, paused"
        stale = self._source.stale_for(now)
        if stale > STALE_AFTER:
            return "live, no messages"
        behind = self._delays[-1][1] - min(came for _, came in self._delays) if self._delays else 0.0
        state = f"live, {1000.0 * behind:.0f} ms behind"
        lost = self._lags[-1][1] - min(lag for _, lag in self._lags) if self._lags else 0.0
        if lost > LAG_THRESHOLD:
            state += f"; the session is too slow: it lost {lost:.1f} s in the last {LAG_WINDOW:.0f} s"
        if status is not None and status.dropped:
            state += f"; {status.dropped} messages lost"
        return state

    def trouble(self) -> str:
        """Return the reason why there is no connection; empty if there is a connection or the session has ended."""
        if self.ended_bag is not None:
            return ""
        if self._lost is None:
            return "" if self._connected else f"Connecting to {self._address}..."
        detail = f" ({self._lost.detail})" if self._lost.detail else ""
        match self._lost.reason:
            case LossReason.UNREACHABLE:
                return f"No answer from {self._address}. Is a session running there with --watch? Retrying..."
            case LossReason.REFUSED:
                return f"{self._address} refused the connection{detail}. Give a key with --key. Retrying..."
            case _:
                return f"The connection to {self._address} is lost{detail}. Retrying..."

    def take_notices(self) -> list[str]:
        """Return sentences about the requests refused since the last call."""
        notices, self._notices = self._notices, []
        return notices

    def use_map(self, grid: OccupancyGrid) -> None:
        """Do nothing, because a session has its own map."""

    def save_section(self, path: Path, start: float, end: float) -> str:
        """Refuse, because only sections of recordings can be saved."""
        return "Only sections of recordings can be saved. Open the session's bag after the session has ended."

    def ask(self, request: FeedRequest) -> str:
        """Send a request. If the session refuses it, the refusal arrives later, with the status."""
        if self.ended_bag is not None:
            return "The session has ended. Its robots do not accept requests."
        sent = self._connection.client.send(request_line(SENDER, request))
        return "" if sent else f"There is no connection to {self._address}, so requests cannot be sent."

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()
