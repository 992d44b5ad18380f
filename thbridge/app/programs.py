"""The programs: a session or one role, kept to the clock, until it is over or somebody stops it."""

import logging
from collections.abc import Callable, Sequence
from contextlib import AsyncExitStack, closing
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Protocol

from sim.observations import TICK, TICKS_PER_SECOND
from thbridge.adapters.ledger import Ledger
from thbridge.adapters.loop import run_ticks
from thbridge.adapters.recordings import journal_of
from thbridge.adapters.rosgraph.joining import Graph, Master
from thbridge.adapters.text_client import LossReason, Lost, TextClient
from thbridge.adapters.text_server import CannotListen, Listening, TextServer
from thbridge.app.broadcast import Broadcast, Listener
from thbridge.app.compose import Setting
from thbridge.app.live import LiveGraph, on_graph
from thbridge.app.recording import BagWitness
from thbridge.app.session import EventLog, Moment, Outpost, Session
from thbridge.hunt.game import GameState
from thbridge.roles.hider import Hider
from thbridge.roles.keeper import Keeper
from thbridge.roles.requests import Request
from thbridge.roles.role import Role
from thbridge.roles.simr import SimR
from thbridge.roles.tabui import TabUI
from thbridge.roles.view import View
from thbridge.wire import legacy
from thbridge.wire.client import Registered
from thbridge.wire.router import Router
from thbridge.wire.text import Message

_log = logging.getLogger(__name__)

PLAY, SIMR = "play", "simr"
"""What recordings call the programs that make them."""

LAST_WORDS = TICKS_PER_SECOND // 2
"""Ticks that a session goes on after the end of the game, so that everybody hears of it and the bag has it."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a hunt ended; what `thbridge play --json` prints.

    Attributes:
        seed: of the study.
        score: points.
        over: why the game ended (`hunt.events.EndReason`); None if it did not.
        rooms_visited: how many.
        identified: treasures named, rightly or wrongly.
        energy: what each robot has left.
        sim_seconds: simulated time from the start to the end of the game.
        wall_seconds: real time that took.
        collisions: times that a robot touched a wall or another robot.
        bag: the recording.
    """

    seed: int
    score: int
    over: str | None
    rooms_visited: int
    identified: int
    energy: tuple[float, ...]
    sim_seconds: float
    wall_seconds: float
    collisions: int
    bag: Path | None


class Unfinished(Exception):  # noqa: N818 - nothing went wrong with the program
    """The hunt ended before the game was over. Everything is closed in good order.

    Attributes:
        outcome: how things stood then.
        stopped: somebody stopped the program (Ctrl-C, SIGTERM); or else the time was up.
    """

    def __init__(self, outcome: Outcome, stopped: bool) -> None:
        super().__init__("stopped" if stopped else "the time was up")
        self.outcome = outcome
        self.stopped = stopped


@dataclass(frozen=True, slots=True)
class PlayOptions:
    """How a hunt is run, beside what the study says.

    Attributes:
        rate: simulated seconds per second; 0 as fast as it can.
        bag: where to record; None for no recording.
        outside: the roles that other programs will take, by name.
        participant: who plays, for the record; for example "person" or "suggestion".
        max_seconds: simulated time after which an unfinished game is given up.
        graph: the ROS graph to take part in; None for none.
    """

    rate: float
    bag: Path | None
    outside: frozenset[str]
    participant: str
    max_seconds: float
    graph: Graph | None = None


def _untold(master: Master | CannotListen) -> None:
    """For those who are on no graph."""


async def play(
    setting: Setting,
    participant: TabUI,
    options: PlayOptions,
    ready: Callable[[Listening | CannotListen], None],
    progress: Callable[[Moment], None],
    joined: Callable[[Master | CannotListen], None] = _untold,
) -> Outcome:
    """Play one hunt with all roles in this process, but those left to others.

    Args:
        setting: the study.
        participant: whoever plays, unless that is left to an outside program.
        options: how.
        ready: told where others can join, or why they cannot.
        progress: told of every tick.
        joined: told who is the master of the graph, or why there is none.

    Raises:
        BadFile: the journal or the bag cannot be written (as `BagNotWritten`).
        Unfinished: it was stopped, or the game was not over in time; what was recorded is complete.
    """
    if options.rate > 0.0:
        setting.rehearse()
    team = setting.team()
    simr = setting.simr(team)
    roles: list[Role] = [simr]
    if legacy.HIDER not in options.outside:
        roles.append(setting.hider())
    inside = None if legacy.TABUI in options.outside else participant
    who = "" if inside is None else options.participant
    names = [role.name for role in (*roles, inside) if role is not None]
    record = setting.record(PLAY, names, who)
    publisher = setting.publisher()
    listeners: list[Listener] = []
    async with AsyncExitStack() as opened:
        if options.graph is not None:
            # Nobody is heard before the session stands: a node registers in the loop's next turn.
            def ask(sender: str, request: Request) -> None:
                session.ask(sender, request)

            live = LiveGraph(options.graph, setting.facts(publisher), team.make_plan, ask)
            await opened.enter_async_context(on_graph(live, options.graph, joined))
            listeners.append(live)
        log: EventLog = NoLog()
        if options.bag is not None:
            log = opened.enter_context(closing(Ledger(journal_of(options.bag))))
            listeners.append(opened.enter_context(setting.writer(options.bag)))
        witnesses = [BagWitness(Broadcast(publisher, record, setting.place.grid, listeners))] if listeners else []
        session = Session(Router(), setting.keeper(), roles, log, witnesses, inside)
        server = TextServer(session, session.hear)
        session.perform = server.perform
        ending = Ending(options.max_seconds)

        def tick() -> bool:
            progress(session.step())
            return not ending.reached(session)

        ready(await server.start(setting.study.server.host, setting.study.server.port))
        opened.push_async_callback(server.stop)
        run = await run_ticks(tick, period_of(options.rate))
    outcome = _outcome(setting, session, ending, roles, run.seconds, options.bag)
    if ending.tick is None:
        raise Unfinished(outcome, stopped=not run.finished)
    return outcome


def period_of(rate: float) -> float:
    """Seconds of wall time for a tick; 0 for a rate of 0, as fast as it can."""
    return TICK / rate if rate > 0.0 else 0.0


class NoLog:
    """For a session that is not recorded at all."""

    def append(self, events: Sequence[object]) -> None:
        """Forget them."""


class Ending:
    """Sees when a session is over.

    Args:
        max_seconds: simulated time after which an unfinished game is given up.
    """

    def __init__(self, max_seconds: float) -> None:
        self._last_tick = max_seconds * TICKS_PER_SECOND
        self.tick: int | None = None
        """The tick in which the game ended, None before."""

    def reached(self, session: Session) -> bool:
        """Whether there is nothing more to do."""
        if self.tick is None and session.game is not None and session.game.ended is not None:
            self.tick = session.tick
        if self.tick is not None:
            return session.tick >= self.tick + LAST_WORDS
        return session.tick >= self._last_tick


def _outcome(
    setting: Setting, session: Session, ending: Ending, roles: Sequence[Role], wall: float, bag: Path | None
) -> Outcome:
    game = session.game
    snapshot = next(role.snapshot for role in roles if isinstance(role, SimR))
    ticks = session.tick if ending.tick is None else ending.tick
    return Outcome(
        seed=setting.study.seed,
        score=0 if game is None else game.score,
        over=None if game is None or game.ended is None else game.ended.reason.value,
        rooms_visited=_visited(game),
        identified=0 if game is None else sum(room.points is not None for room in game.rooms),
        energy=() if game is None else tuple(robot.energy for robot in game.robots),
        sim_seconds=round(ticks * TICK, 2),
        wall_seconds=round(wall, 2),
        collisions=0 if snapshot is None else int(snapshot.truth.collisions.sum()),
        bag=bag,
    )


def _visited(game: GameState | None) -> int:
    return 0 if game is None else sum(room.visited for room in game.rooms)


async def serve(
    setting: Setting, ledger: Ledger, new_game: bool, ready: Callable[[Listening | CannotListen], None]
) -> None:
    """Run the text server and the keeper until stopped; a game that was cut off goes on.

    Args:
        setting: the study.
        ledger: the journals; closed at the end.
        new_game: leave an unfinished game as it is and begin the next.
        ready: told where the server is to be reached, or why not; in that case nothing else happens.

    Raises:
        BadFile: the journal cannot be read or written.
    """
    try:
        unfinished = None if new_game else ledger.resume()
        if unfinished is not None:
            _log.warning("going on with game %d (--new-game begins another)", ledger.last_game)
            if unfinished.torn:
                _log.warning("its last event was half written and is lost")
        last_game = ledger.last_game if unfinished is None else ledger.last_game - 1
        keeper: Keeper = setting.keeper(() if unfinished is None else unfinished.history, last_game)
        router = Router()
        session = Session(router, keeper, [], ledger)
        server = TextServer(session, session.hear)
        session.perform = server.perform
        listening = await server.start(setting.study.server.host, setting.study.server.port)
        ready(listening)
        if isinstance(listening, CannotListen):
            return

        def tick() -> bool:
            session.step()
            return True

        try:
            await run_ticks(tick, TICK)
        finally:
            await server.stop()
    finally:
        ledger.close()


class Lodger(Protocol):
    """A role that runs by itself, at a server of another process; what it hears, it answers with the next tick."""

    def connected(self) -> None:
        """The server has (again) accepted the name."""

    def hear(self, message: Message) -> None:
        """Somebody said something to this role."""

    def step(self) -> Sequence[Message]:
        """One tick; what the role says."""


class _Lone:
    """The plainest lodger: it only counts the ticks of a role."""

    def __init__(self, role: Role) -> None:
        self._role = role
        self._ticks = count()
        self._heard: list[Message] = []

    def connected(self) -> None:
        self._role.connected()

    def hear(self, message: Message) -> None:
        self._heard.append(message)

    def step(self) -> Sequence[Message]:
        heard, self._heard = self._heard, []
        return self._role.step(next(self._ticks), heard)


async def take_part(
    lodger: Lodger,
    client: TextClient,
    rate: float,
    done: Callable[[], bool],
    lost: Callable[[Lost], None],
) -> bool:
    """Run one role against a server until it is done or stopped; it reconnects by itself.

    Args:
        lodger: the role.
        client: its connection, not running yet.
        rate: ticks run at this many times real time.
        done: asked after every tick.
        lost: told when the connection is lost, and why.

    Returns:
        Whether it is done; or else somebody stopped it.
    """

    def tick() -> bool:
        for event in client.take():
            match event:
                case Message():
                    lodger.hear(event)
                case Registered():
                    lodger.connected()
                case Lost():
                    lost(event)
        for message in lodger.step():
            client.send(message)
        return not done()

    async with client.running():
        run = await run_ticks(tick, period_of(rate))
    return run.finished


@dataclass(frozen=True, slots=True)
class SimrOptions:
    """How the robots' program is run.

    Attributes:
        host: of the text server.
        port: of the text server.
        token: marks this run of the program.
        rate: simulated seconds per second.
        bag: where to record; None for no recording.
        graph: the ROS graph to take part in; None for none.
    """

    host: str
    port: int
    token: str
    rate: float
    bag: Path | None
    graph: Graph | None = None


async def simr(
    setting: Setting,
    options: SimrOptions,
    lost: Callable[[Lost], None],
    joined: Callable[[Master | CannotListen], None] = _untold,
) -> str | None:
    """Run the robots' program until stopped.

    Args:
        setting: the study.
        options: how.
        lost: told when the connection is lost, and why.
        joined: told who is the master of the graph, or why there is none.

    Returns:
        Why the keeper does not want these robots, or None when stopped.

    Raises:
        BagNotWritten: the bag cannot be written; it is closed, and the program over.
    """
    setting.rehearse()
    team = setting.team()
    role = setting.simr(team)
    publisher = setting.publisher()
    listeners: list[Listener] = []
    async with AsyncExitStack() as opened:
        if options.graph is not None:

            def ask(sender: str, request: Request) -> None:
                outpost.ask(sender, request)

            live = LiveGraph(options.graph, setting.facts(publisher), team.make_plan, ask)
            await opened.enter_async_context(on_graph(live, options.graph, joined))
            listeners.append(live)
        if options.bag is not None:
            listeners.append(opened.enter_context(setting.writer(options.bag)))
        record = setting.record(SIMR, [role.name], "")
        witnesses = [BagWitness(Broadcast(publisher, record, setting.place.grid, listeners))] if listeners else []
        outpost = Outpost(role, witnesses)
        client = TextClient(role.name, options.token, options.host, options.port)
        await take_part(outpost, client, options.rate, lambda: role.unfit is not None, lost)
    return role.unfit


async def hider(role: Hider, host: str, port: int, token: str, lost: Callable[[Lost], None]) -> None:
    """Run the treasures' program until stopped."""
    await take_part(_Lone(role), TextClient(role.name, token, host, port), 1.0, lambda: False, lost)


async def tabui(
    role: TabUI, host: str, port: int, token: str, lost: Callable[[Lost], None], shown: Callable[[View], None]
) -> View | None:
    """Run the participant's program until the game is over.

    Args:
        role: the participant.
        host: of the server.
        port: of the server.
        token: marks this run of the program.
        lost: told when the connection is lost, and why.
        shown: told of every new view.

    Returns:
        The last view, of a game that is over; None when stopped.
    """
    last: View | None = None

    def after() -> bool:
        nonlocal last
        if role.view is not None and role.view is not last:
            last = role.view
            shown(last)
        return last is not None and last.over is not None

    finished = await take_part(_Lone(role), TextClient(role.name, token, host, port), 1.0, after, lost)
    return last if finished else None


def reason_of(lost: Lost) -> str:
    """Why there is no connection, for people."""
    if lost.reason is LossReason.REFUSED:
        return "another program holds this name at the server; waiting until it is free"
    return f"{lost.reason.value}; trying again" + (f" ({lost.detail})" if lost.detail else "")
