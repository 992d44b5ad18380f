"""Who listens to a session's robots: a ROS graph, a bag, researchers' windows. Two of them also ask."""

from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from sim.team import Team
from thbridge.app.compose import StudySetting
from thbridge.app.rosgraph.live import LiveGraph, on_graph
from thbridge.app.session.broadcast import Listener
from thbridge.app.session.watch_requests import WatchRequestHandler
from thbridge.roles.robot_requests import Request
from thbridge.ros.publisher import TeamPublisher
from thbridge.sockets.rosgraph.joining import GraphAddress, MasterPresence
from thbridge.sockets.text_server import CannotListen, ListeningAddress
from thbridge.sockets.watch_server import WatchServer
from thbridge.timing.pacer import Pacer
from thbridge.wire.mavlink.frames.frame import Frame


@dataclass(frozen=True, slots=True)
class WatchAddress:
    """Where researchers' windows may connect.

    Attributes:
        host: address to listen on.
        port: of TCP; 0 takes any that is free.
        key: that they have to know; None lets in whoever can connect.
    """

    host: str
    port: int
    key: str | None


class ListenerOptions(Protocol):
    """Who is to listen."""

    @property
    def bag(self) -> Path | None:
        """Where to record; None for no recording."""

    @property
    def graph(self) -> GraphAddress | None:
        """The ROS graph to take part in; None for none."""

    @property
    def watch(self) -> WatchAddress | None:
        """Where to be watched; None for nowhere."""


def _untold(outcome: object) -> None:
    """For those who are on no graph, not watched, and heard by no ground station."""


@dataclass(frozen=True, slots=True)
class StartupCallbacks:
    """Whom to tell what became of it.

    Attributes:
        joined: who is the master of the graph, or why there is none; it may raise.
        watched: where researchers' windows connect, or why they cannot; it may raise.
        linked: where ground stations reach the robots, such as "udp 127.0.0.1:14550", or why they cannot; it may raise.
    """

    joined: Callable[[MasterPresence | CannotListen], None]
    watched: Callable[[ListeningAddress | CannotListen], None]
    linked: Callable[[Sequence[str] | CannotListen], None] = _untold


NO_CALLBACKS = StartupCallbacks(_untold, _untold)


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
    *,
    has_game: bool,
) -> AsyncIterator[list[Listener]]:
    """Those who listen; it lasts as long as they do.

    Args:
        audience: who.
        setting: the study.
        team: its robots.
        publisher: that will speak.
        pacer: of the session.
        ask: takes what they want of the robots, with the name of whoever wants it. Nobody asks before the event loop's
            next turn, when the session stands.
        told: whom to tell what became of it.
        hear: takes MAVLink frames that they have for one robot, likewise; None where the robots are no vehicles.
        has_game: whether the game is this session's.
    """
    listening: list[Listener] = []
    async with AsyncExitStack() as opened:
        if options.graph is not None:
            live = LiveGraph(options.graph, setting.team_description(publisher), team, ask, receive_frame)
            await opened.enter_async_context(on_graph(live, options.graph, callbacks.joined))
            listening.append(live)
        if options.bag is not None:
            listening.append(opened.enter_context(setting.writer(options.bag)))
        if options.watch is not None:
            desk = WatchRequestHandler(ask, team, pacer, has_game=has_game)
            door = WatchServer(desk, options.watch.key)
            opened.push_async_callback(door.stop)
            callbacks.watched(await door.start(options.watch.host, options.watch.port))
            listening += [desk, door]
        yield listening
