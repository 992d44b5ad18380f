"""Who listens to a session's robots: a ROS graph, a bag, researchers' windows. Two of them also ask."""

from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from sim.team import Team
from thbridge.app.compose import Setting
from thbridge.app.rosgraph.live import LiveGraph, on_graph
from thbridge.app.session.broadcast import Listener
from thbridge.app.session.watching import Desk
from thbridge.roles.robot_requests import Request
from thbridge.ros.publisher import Publisher
from thbridge.sockets.rosgraph.joining import Graph, Master
from thbridge.sockets.text_server import CannotListen, Listening
from thbridge.sockets.watch_server import WatchServer
from thbridge.timing.pacer import Pacer
from thbridge.wire.mavlink.frames.frame import Frame


@dataclass(frozen=True, slots=True)
class Watch:
    """Where researchers' windows may connect.

    Attributes:
        host: address to listen on.
        port: of TCP; 0 takes any that is free.
        key: that they have to know; None lets in whoever can connect.
    """

    host: str
    port: int
    key: str | None


class Audience(Protocol):
    """Who is to listen."""

    @property
    def bag(self) -> Path | None:
        """Where to record; None for no recording."""

    @property
    def graph(self) -> Graph | None:
        """The ROS graph to take part in; None for none."""

    @property
    def watch(self) -> Watch | None:
        """Where to be watched; None for nowhere."""


def _untold(outcome: object) -> None:
    """For those who are on no graph, not watched, and heard by no ground station."""


@dataclass(frozen=True, slots=True)
class Hosts:
    """Whom to tell what became of it.

    Attributes:
        joined: who is the master of the graph, or why there is none; it may raise.
        watched: where researchers' windows connect, or why they cannot; it may raise.
        linked: where ground stations reach the robots, such as "udp 127.0.0.1:14550", or why they cannot; it may raise.
    """

    joined: Callable[[Master | CannotListen], None]
    watched: Callable[[Listening | CannotListen], None]
    linked: Callable[[Sequence[str] | CannotListen], None] = _untold


NOBODY_TOLD = Hosts(_untold, _untold)


@asynccontextmanager
async def listeners(
    audience: Audience,
    setting: Setting,
    team: Team,
    publisher: Publisher,
    pacer: Pacer,
    ask: Callable[[str, Request], None],
    told: Hosts,
    hear: Callable[[int, Frame], None] | None = None,
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
        if audience.graph is not None:
            live = LiveGraph(audience.graph, setting.facts(publisher), team, ask, hear)
            await opened.enter_async_context(on_graph(live, audience.graph, told.joined))
            listening.append(live)
        if audience.bag is not None:
            listening.append(opened.enter_context(setting.writer(audience.bag)))
        if audience.watch is not None:
            desk = Desk(ask, team, pacer, has_game=has_game)
            door = WatchServer(desk, audience.watch.key)
            opened.push_async_callback(door.stop)
            told.watched(await door.start(audience.watch.host, audience.watch.port))
            listening += [desk, door]
        yield listening
