"""Listeners to a session's robots: a ROS graph, a bag, researchers' windows, Foxglove.

The ROS graph and the windows can also send requests.
"""

from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol, TypeAlias

from sim.team import Team
from thbridge.app.compose.recording import begin_recording, build_team_description
from thbridge.app.compose.setting import StudySetting
from thbridge.app.live_graph.client_messages import ClientRequests
from thbridge.app.session.broadcast import Listener
from thbridge.files.ros.definitions import ROS_SHARES, Definitions
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.roles.shared.robot_requests import Request
from thbridge.ros.publisher import TeamPublisher
from thbridge.ros2graph.values.address import Ros2Address
from thbridge.rosgraph.sockets.joining import GraphAddress, MasterPresence
from thbridge.sockets.addresses import LOCALHOST, ListeningAddress
from thbridge.sockets.admission import Admission
from thbridge.sockets.errors import CannotListen, CannotReach
from thbridge.sockets.keys import KeyVerifier
from thbridge.timing.pacer import Pacer

StartServer: TypeAlias = Callable[[], Awaitable[ListeningAddress | CannotListen]]
"""Function that starts a server, and returns its address or the reason why it cannot listen."""


@dataclass(frozen=True, slots=True)
class WatchAddress:
    """Address of the watch server, to which researchers' windows connect.

    Attributes:
        host: address on which the server listens.
        port: TCP port; 0 selects any free port.
        keys: keys that windows must send. If None, all programs on this machine are admitted.
        later: callback with the function that starts the server. If None, the server starts with the session.
    """

    host: str
    port: int
    keys: KeyVerifier | None
    later: Callable[[StartServer], None] | None = None


class ListenerOptions(Protocol):
    """Options of the listeners to a session."""

    @property
    def bag(self) -> Path | None:
        """Path of the recording. If None, nothing is recorded."""

    @property
    def graph(self) -> GraphAddress | None:
        """The ROS graph to join; None if there is none."""

    @property
    def ros2(self) -> Ros2Address | None:
        """The ROS 2 graph to join; None if there is none."""

    @property
    def watch(self) -> WatchAddress | None:
        """Address of the watch server; None if there is none."""

    @property
    def foxglove(self) -> int | None:
        """TCP port of this machine for Foxglove, 0 for any free port; None if there is none."""


def _ignore(outcome: object) -> None:
    """Do nothing; this is the callback of programs without graph, watch server and MAVLink links."""


@dataclass(frozen=True, slots=True)
class StartupCallbacks:
    """Callbacks with the results of starting the graph and the servers. Callbacks may raise exceptions.

    Attributes:
        joined: callback with the master of the graph, or the reason why there is no master.
        watched: callback with the address of the watch server, or the reason why it cannot listen.
        linked: callback with the addresses of MAVLink links, such as "udp 127.0.0.1:14550", or the reason why there are
            no links.
        shown: callback with the address for Foxglove, or the reason why there is no address.
        joined_ros2: callback with the full names of nodes of other programs that already speak for these robots on the
            ROS 2 graph, or the reason why the graph cannot be joined.
    """

    joined: Callable[[MasterPresence | CannotListen], None]
    watched: Callable[[ListeningAddress | CannotListen], None]
    linked: Callable[[Sequence[str] | CannotListen], None] = _ignore
    shown: Callable[[ListeningAddress | CannotListen], None] = _ignore
    joined_ros2: Callable[[Sequence[str] | CannotListen | CannotReach], None] = _ignore


NO_CALLBACKS = StartupCallbacks(_ignore, _ignore)


@asynccontextmanager
async def listeners(
    options: ListenerOptions,
    setting: StudySetting,
    team: Team,
    publisher: TeamPublisher,
    pacer: Pacer,
    ask: Callable[[str, Request], None],
    callbacks: StartupCallbacks,
    receive_frame: Callable[[int, Frame], None] | None = None,
    granted: Callable[[str, str], None] | None = None,
    *,
    has_game: bool,
    game_address: Callable[[], str] = str,
) -> AsyncIterator[list[Listener]]:
    """Start the listeners to a session, and stop all listeners at the end of the context.

    Args:
        options: options of the listeners.
        setting: the study.
        team: robots of the study.
        publisher: publisher of the robots' messages.
        pacer: pacer of the session.
        ask: callback with the name of the sender and a request. It is not called before the next turn of the event
            loop, because the session does not exist earlier.
        callbacks: callbacks with the results of starting.
        receive_frame: callback with the index of a robot and a MAVLink frame, also not called before that turn; None if
            the robots are not MAVLink vehicles.
        granted: callback with the name of a watcher's key and a granted request. If None, there is no callback.
        has_game: True if the game is in this session.
        game_address: function that returns the address (HOST:PORT) of the game's text server; empty if it is not open.
    """
    listening: list[Listener] = []
    async with AsyncExitStack() as opened:
        requests = ClientRequests(ask)
        if options.graph is not None:
            # The import is here because sessions without ROS do not need its protocols.
            from thbridge.app.live_graph.live import LiveGraph, on_graph  # noqa: PLC0415

            live = LiveGraph(options.graph, build_team_description(setting, publisher), team, requests, receive_frame)
            await opened.enter_async_context(on_graph(live, options.graph, callbacks.joined))
            listening.append(live)
        if options.ros2 is not None:
            # The import is here because sessions without ROS 2 do not need its message types.
            from thbridge.app.live_graph.live_ros2 import on_ros2_graph  # noqa: PLC0415

            described = build_team_description(setting, publisher)
            admission = Admission.to(setting.study.open_to)
            nodes = on_ros2_graph(options.ros2, admission, described, team, requests, receive_frame)
            live2, rivals = await opened.enter_async_context(nodes)
            callbacks.joined_ros2(rivals)
            listening.append(live2)
        if options.watch is not None:
            from thbridge.app.session.watch_requests import WatchRequestHandler  # noqa: PLC0415
            from thbridge.watching.sockets.server import WatchServer  # noqa: PLC0415

            desk = WatchRequestHandler(ask, team, pacer, granted, has_game=has_game)
            server = WatchServer(desk, options.watch.keys, bag=options.bag, game=game_address)
            opened.push_async_callback(server.stop)
            start = partial(server.start, options.watch.host, options.watch.port)
            if options.watch.later is None:
                callbacks.watched(await start())
            else:
                options.watch.later(start)
            listening += [desk, server]
        if options.foxglove is not None:
            # The import is here because sessions without Foxglove do not need this optional package.
            from thbridge.sockets.foxglove import FoxgloveServer  # noqa: PLC0415

            foxglove = FoxgloveServer(publisher.topics, Definitions(ROS_SHARES))
            opened.callback(foxglove.stop)
            callbacks.shown(foxglove.start(LOCALHOST, options.foxglove))
            listening.append(foxglove)
        if options.bag is not None:
            # The recording starts last, so that there is no recording if a port is already in use.
            listening.append(opened.enter_context(begin_recording(setting, options.bag)))
        yield listening
