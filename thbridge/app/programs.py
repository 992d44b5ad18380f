"""Programs that run one role at a text server in real time, until the role is finished or stopped."""

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Protocol

from thbridge.app.compose.recording import build_publisher, build_record, build_recorder
from thbridge.app.compose.robots import build_simr, build_team, rehearse
from thbridge.app.compose.setting import StudySetting
from thbridge.app.listeners import NO_CALLBACKS, StartupCallbacks, WatchAddress, listeners
from thbridge.app.session.session import DeferredRecording
from thbridge.app.session.simr_session import SimrSession
from thbridge.files.keys.key_file import ClientKey
from thbridge.roles.hider import Hider
from thbridge.roles.keeper.disclosed.consent import CONSENT_SENTENCES, ConsentStatus
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.notices import KEEPER, SIMR_NOTICES, ConsentQuery, HideRequest, Orders, RecordingPermission
from thbridge.roles.shared.role import Role
from thbridge.roles.shared.view import View
from thbridge.roles.simr.simr import SimR
from thbridge.ros2graph.values.address import Ros2Address
from thbridge.rosgraph.sockets.joining import GraphAddress
from thbridge.sockets.reconnecting import ConnectionLost, LossReason
from thbridge.text_protocol.sockets.client import TextClient
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.client import NameRegistered
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import Notice, encode_notice, is_notice, kind_of, parse_notice
from thbridge.timing.loop import run_ticks
from thbridge.timing.pacer import Pacer

_log = logging.getLogger(__name__)

SIMR = "simr"
"""Name, in recordings, of the program that runs only the robots."""


class RoleRunner(Protocol):
    """Runner of a role at the server of another process. Messages are processed in the next tick."""

    def connected(self) -> None:
        """Record that the server has accepted the role's name, for the first time or again."""

    def receive(self, message: TextMessage) -> None:
        """Accept a message to this role."""

    def step(self) -> Sequence[TextMessage]:
        """Run one tick, and return the role's messages."""


class SingleRole:
    """Runner of a role that needs only messages and the number of the tick."""

    def __init__(self, role: Role) -> None:
        self._role = role
        self._ticks = count()
        self._messages: list[TextMessage] = []

    def connected(self) -> None:
        """Record that the server has accepted the name; see `RoleRunner`."""
        self._role.connected()

    def receive(self, message: TextMessage) -> None:
        """Pass a message to the role in the next tick."""
        self._messages.append(message)

    def step(self) -> Sequence[TextMessage]:
        """Run one tick of the role."""
        messages, self._messages = self._messages, []
        return self._role.step(next(self._ticks), messages)


class UnrecordedSimr:
    """Runner of SimR until the participant may be recorded; it asks the keeper for this permission.

    Attributes:
        granted: True after the keeper has reported that the participant may be recorded.
    """

    def __init__(self, role: SimR) -> None:
        self._role = role
        self._session = SimrSession(role)
        self._ask = False
        self.granted = False

    @property
    def rejection(self) -> str | None:
        """Reason why the keeper has rejected these robots; None if they are not rejected."""
        return self._role.rejection

    def connected(self) -> None:
        """Record that the server has accepted the name; see `RoleRunner`."""
        self._session.connected()
        self._ask = True

    def receive(self, message: TextMessage) -> None:
        """Accept a message to SimR, or the keeper's answer about recording."""
        notice = SIMR_NOTICES.read(message)
        if isinstance(notice, RecordingPermission):
            self.granted = notice.granted
        else:
            self._session.receive(message)

    def step(self) -> Sequence[TextMessage]:
        """Run one tick of SimR. After each connection, also ask the keeper for permission."""
        asked, self._ask = self._ask, False
        said = self._session.step()
        return [*said, encode_notice(legacy.SIMR, KEEPER, ConsentQuery())] if asked else said


class ProgramStatus:
    """Log of a program's state at a server: connected, waiting, in a game, reconnected.

    Args:
        client: the program's connection.
    """

    def __init__(self, client: TextClient) -> None:
        self._client = client
        self._was_connected = False
        # Number of the last game in the keeper's notices.
        self._game = 0

    def connected(self) -> None:
        """Log that the server has accepted the program's name."""
        again = " again" if self._was_connected else ""
        waits = "" if self._was_connected else "; waiting for the game"
        self._was_connected = True
        _log.warning("%s is connected%s to %s%s", self._client.name, again, self._client.address, waits)

    def heard(self, message: TextMessage) -> None:
        """Log each game once, at the keeper's first notice about this game."""
        if message.sender != KEEPER or not is_notice(message):
            return
        notice = parse_notice(message)
        game = notice.fields.get("game") if isinstance(notice, Notice) and notice.kind in _OF_GAMES else None
        if isinstance(game, int) and game > self._game:
            self._game = game
            _log.warning("%s is in game %d", self._client.name, game)


_OF_GAMES = {kind_of(Orders), kind_of(HideRequest), kind_of(View)}
"""Kinds of notices that contain the number of the game."""


def exchange(
    runner: RoleRunner, client: TextClient, lost: Callable[[ConnectionLost], None], status: ProgramStatus | None = None
) -> None:
    """Run one tick of a role at a server: pass received messages to the role, and send messages of the role.

    Args:
        runner: runner of the role.
        client: running connection of the role.
        lost: callback with the reason, called when the connection is lost.
        status: log of the program's state. If None, nothing is logged.
    """
    for event in client.take():
        match event:
            case TextMessage():
                runner.receive(event)
                if status is not None:
                    status.heard(event)
            case NameRegistered():
                runner.connected()
                if status is not None:
                    status.connected()
            case ConnectionLost():
                lost(event)
    for message in runner.step():
        client.send(message)


async def run_at_server(
    runner: RoleRunner,
    client: TextClient,
    pacer: Pacer,
    done: Callable[[], bool],
    lost: Callable[[ConnectionLost], None],
) -> bool:
    """Run one role at a server until the role is finished or stopped. The program reconnects automatically.

    Args:
        runner: runner of the role.
        client: connection of the role, not running yet.
        pacer: pacer of the ticks.
        done: function that returns True if the role is finished; called after every tick.
        lost: callback with the reason, called when the connection is lost.

    Returns:
        True if the role is finished, False if it was stopped.
    """

    status = ProgramStatus(client)

    def tick() -> bool:
        exchange(runner, client, lost, status)
        return not done()

    async with client.running():
        run = await run_ticks(tick, pacer)
    return run.finished


@dataclass(frozen=True, slots=True)
class SimrOptions:
    """Options of the robots' program.

    Attributes:
        host: host of the text server.
        port: port of the text server.
        token: unique text that identifies this run of the program.
        rate: simulated seconds per second.
        bag: path of the recording. If None, nothing is recorded.
        graph: the ROS graph to join; None if there is none.
        watch: address of the watch server; None if there is none.
        foxglove: TCP port of this machine for Foxglove; None if there is none.
        key: key for the text server; None if no key is needed.
        ros2: the ROS 2 graph to join; None if there is none.
    """

    host: str
    port: int
    token: str
    rate: float
    bag: Path | None
    graph: GraphAddress | None = None
    watch: WatchAddress | None = None
    foxglove: int | None = None
    key: ClientKey | None = None
    ros2: Ros2Address | None = None


async def simr(
    setting: StudySetting,
    options: SimrOptions,
    lost: Callable[[ConnectionLost], None],
    callbacks: StartupCallbacks = NO_CALLBACKS,
) -> str | None:
    """Run the robots' program until it is stopped.

    If the study asks for consent, nothing is recorded until the server reports that the participant has agreed. Until
    then, the robots run without a recording. Afterward they start again, with graph and watch server.

    Args:
        setting: the study.
        options: options of the program.
        lost: callback with the reason, called when the connection is lost.
        callbacks: callbacks with the results of starting graph and watch server.

    Returns:
        The reason why the keeper rejected these robots; None if the program was stopped.

    Raises:
        BagNotWritten: the bag cannot be written. It is closed, and the program ends.
    """
    rehearse(setting)
    if options.bag is not None and setting.consent is not None:
        waited = await await_consent(build_simr(setting), options, lost)
        if not waited.granted:
            return waited.rejection
    team = build_team(setting)
    role = build_simr(setting, team)
    publisher = build_publisher(setting)
    pacer = Pacer(options.rate)
    recording = DeferredRecording()
    session = SimrSession(role, [recording])
    async with listeners(
        options,
        setting,
        team,
        publisher,
        pacer,
        session.ask,
        callbacks,
        has_game=False,
        game_address=lambda: f"{options.host}:{options.port}",
    ) as audience:
        if audience:
            opening = build_record(setting, SIMR, [role.name], "")
            recording.begin([build_recorder(setting, opening, audience, publisher)])
        client = TextClient(role.name, options.token, options.host, options.port, key=options.key)
        await run_at_server(session, client, pacer, lambda: role.rejection is not None, lost)
    return role.rejection


async def await_consent(role: SimR, options: SimrOptions, lost: Callable[[ConnectionLost], None]) -> UnrecordedSimr:
    """Run the robots without a recording until the participant may be recorded.

    The run also ends if the keeper rejects the robots, or the program is stopped.

    Args:
        role: the robots' role.
        options: options of the program.
        lost: callback with the reason, called when the connection is lost.

    Returns:
        The runner, whose attributes show why the run has ended.
    """
    _log.warning(CONSENT_SENTENCES[ConsentStatus.AWAITED])
    waiting = UnrecordedSimr(role)
    client = TextClient(role.name, options.token, options.host, options.port, key=options.key)
    await run_at_server(
        waiting, client, Pacer(options.rate), lambda: waiting.granted or waiting.rejection is not None, lost
    )
    return waiting


async def hider(
    role: Hider,
    host: str,
    port: int,
    token: str,
    lost: Callable[[ConnectionLost], None],
    key: ClientKey | None = None,
) -> None:
    """Run the treasures' program until it is stopped."""
    client = TextClient(role.name, token, host, port, key=key)
    await run_at_server(SingleRole(role), client, Pacer(1.0), lambda: False, lost)


async def tabui(
    role: TabUI,
    host: str,
    port: int,
    token: str,
    lost: Callable[[ConnectionLost], None],
    shown: Callable[[View], None],
    key: ClientKey | None = None,
) -> View | None:
    """Run the participant's program until the game is over, or the participant has declined to take part.

    Args:
        role: the participant's role.
        host: host of the server.
        port: port of the server.
        token: unique text that identifies this run of the program.
        lost: callback with the reason, called when the connection is lost.
        shown: callback with each new view.
        key: key for the server; None if no key is needed.

    Returns:
        The last view, in which the game is over or the participant has declined. None if the program was stopped.
    """
    last: View | None = None
    role.run = token

    def after() -> bool:
        nonlocal last
        if role.view is not None and role.view is not last:
            last = role.view
            shown(last)
        return role.declined or (last is not None and last.over is not None)

    client = TextClient(role.name, token, host, port, key=key)
    finished = await run_at_server(SingleRole(role), client, Pacer(1.0), after, lost)
    return last if finished else None


def reason_of(lost: ConnectionLost) -> str:
    """Return the reason why there is no connection, in words for people."""
    if lost.reason is LossReason.REFUSED and lost.detail:
        return f"the server refused the connection: {lost.detail}; trying again"
    if lost.reason is LossReason.REFUSED:
        return "another program uses this name at the server; waiting until the name is free"
    return f"{lost.reason.value}; trying again" + (f" ({lost.detail})" if lost.detail else "")
