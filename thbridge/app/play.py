"""A whole hunt in one program: all roles but those left to others, until the game is over or somebody stops it."""

from collections.abc import Callable, Sequence
from contextlib import AsyncExitStack, closing
from dataclasses import dataclass
from pathlib import Path

from sim.common.observations import TICK, TICKS_PER_SECOND
from thbridge.app.compose import StudySetting
from thbridge.app.listeners import NO_CALLBACKS, StartupCallbacks, WatchAddress, listeners
from thbridge.app.session.broadcast import Broadcast
from thbridge.app.session.recording import BagRecorder, TlogRecorder
from thbridge.app.session.session import EventLog, Session, TickRecord, TickRecorder
from thbridge.hunt.game import GameState
from thbridge.recording.journals import JournalStore
from thbridge.recording.recordings import journal_of, tlog_of
from thbridge.recording.tlog import TlogFile
from thbridge.roles.robot_requests import Request
from thbridge.roles.role import Role
from thbridge.roles.simr.simr import SimR
from thbridge.roles.tabui import TabUI
from thbridge.ros.names import GRAPH_LINK
from thbridge.sockets.mavlink.server import MavlinkPorts, MavlinkServer
from thbridge.sockets.rosgraph.joining import GraphAddress
from thbridge.sockets.text_server import CannotListen, ListeningAddress, TextServer
from thbridge.timing.keepalive import kept_alive
from thbridge.timing.loop import run_ticks
from thbridge.timing.pacer import Pacer
from thbridge.wire import legacy
from thbridge.wire.mavlink.frames.frame import Frame
from thbridge.wire.router import MessageRouter

PLAY = "play"
"""What recordings call this program."""

FINAL_TICKS = TICKS_PER_SECOND // 2
"""Ticks that a session goes on after the end of the game, so that everybody hears of it and the bag has it."""


@dataclass(frozen=True, slots=True)
class HuntOutcome:
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


class HuntUnfinished(Exception):  # noqa: N818 - nothing went wrong with the program
    """The hunt ended before the game was over. Everything is closed in good order.

    Attributes:
        outcome: how things stood then.
        stopped: somebody stopped the program (Ctrl-C, SIGTERM); or else the time was up.
    """

    def __init__(self, outcome: HuntOutcome, stopped: bool) -> None:
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
        left: asked after every tick whether the participant, in a window of their own, has left: then the hunt ends,
            and not before, since they may look at what came of the game, and play again. None: it ends with the game.
        watch: where researchers' windows may connect; None for nowhere.
        mavlink: where ground stations reach the robots; None for nowhere.
    """

    rate: float
    bag: Path | None
    outside: frozenset[str]
    participant: str
    max_seconds: float
    graph: GraphAddress | None = None
    left: Callable[[], bool] | None = None
    watch: WatchAddress | None = None
    mavlink: MavlinkPorts | None = None


async def play(
    setting: StudySetting,
    participant: TabUI | None,
    options: PlayOptions,
    ready: Callable[[ListeningAddress | CannotListen], None],
    progress: Callable[[TickRecord], None],
    callbacks: StartupCallbacks = NO_CALLBACKS,
) -> HuntOutcome:
    """Play one hunt with all roles in this process, but those left to others.

    Args:
        setting: the study.
        participant: whoever plays; None when that is an outside program, as it also is when `options` say so.
        options: how.
        ready: told where others can join, or why they cannot.
        progress: told of every tick.
        told: whom to tell what became of graph, watch and links.

    Raises:
        BadFile: the journal, the telemetry log or the bag cannot be written (the latter as `BagNotWritten`).
        Unfinished: it was stopped, or the game was not over in time; what was recorded is complete.
    """
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
    pacer = Pacer(options.rate, pause_abandoned=options.left)

    def ask(sender: str, request: Request) -> None:
        session.ask(sender, request)

    def hear(robot: int, frame: Frame) -> None:
        session.transmit(session.receive_frame(graph_link, frame, robot))

    async with AsyncExitStack() as opened:
        # First of all: nothing is begun where ground stations cannot be reached.
        links = await _links(options.mavlink, opened, callbacks)
        if options.rate > 0.0:
            setting.rehearse()
        log: EventLog = NoLog()
        if options.bag is not None:
            log = opened.enter_context(closing(JournalStore(journal_of(options.bag))))
        has_vehicles = setting.study.mavlink.on
        stations = hear if has_vehicles else None
        listening = listeners(options, setting, team, publisher, pacer, ask, callbacks, stations, has_game=True)
        audience = await opened.enter_async_context(listening)
        witnesses: list[TickRecorder] = []
        if audience:
            witnesses.append(BagRecorder(Broadcast(publisher, record, setting.map.grid, audience)))
        if options.bag is not None and has_vehicles and setting.study.mavlink.tlog:
            witnesses.append(TlogRecorder(opened.enter_context(TlogFile(tlog_of(options.bag)))))
        session = Session(MessageRouter(), setting.keeper(), roles, log, witnesses, inside, setting.vehicles(simr))
        server = TextServer(session, session.note_forwarded)
        session.perform = server.perform
        if has_vehicles and options.graph is not None:
            graph_link = session.open_link(GRAPH_LINK)
        if links is not None:
            stations_server, reached_by = links
            await stations_server.serve(session)
            callbacks.linked(reached_by)
            await opened.enter_async_context(kept_alive(session, pacer))
        ending = EndCondition(options.max_seconds, options.left)

        def tick() -> bool:
            progress(session.step())
            return not ending.reached(session)

        where = await server.start(setting.study.server.host, setting.study.server.port)
        if isinstance(where, CannotListen) and options.left is not None:
            where = await server.start(setting.study.server.host, 0)  # The window is told where.
        ready(where)
        opened.push_async_callback(server.stop)
        run = await run_ticks(tick, pacer)
    outcome = _outcome(setting, session, ending, roles, run.seconds, options.bag)
    if ending.tick is None:
        raise HuntUnfinished(outcome, stopped=not run.finished)
    return outcome


async def _links(
    ports: MavlinkPorts | None, opened: AsyncExitStack, told: StartupCallbacks
) -> tuple[MavlinkServer, list[str]] | None:
    """Whoever will speak to ground stations, with all ports taken, and what these find it by; None: nobody will.

    Where not all ports can be had it is told which.
    """
    if ports is None:
        return None
    links = MavlinkServer(ports)
    opened.push_async_callback(links.close)
    names = await links.open()
    if isinstance(names, CannotListen):
        told.linked(names)
        return None
    return links, names


class NoLog:
    """For a session that is not recorded at all."""

    def append(self, events: Sequence[object]) -> None:
        """Forget them."""


class EndCondition:
    """Sees when a session is over.

    Args:
        max_seconds: simulated time after which an unfinished game is given up.
        left: see `PlayOptions`.
    """

    def __init__(self, max_seconds: float, left: Callable[[], bool] | None = None) -> None:
        self._last_tick = max_seconds * TICKS_PER_SECOND
        self._left = left
        self.tick: int | None = None
        """The tick in which the game ended, None before, and again once another one has begun."""

    def reached(self, session: Session) -> bool:
        """Whether there is nothing more to do."""
        over = session.game is not None and session.game.ended is not None
        if not over:
            self.tick = None
        elif self.tick is None:
            self.tick = session.tick
        if self._left is not None:
            return self._left() or session.tick >= self._last_tick
        if self.tick is not None:
            return session.tick >= self.tick + FINAL_TICKS
        return session.tick >= self._last_tick


def _outcome(
    setting: StudySetting, session: Session, ending: EndCondition, roles: Sequence[Role], wall: float, bag: Path | None
) -> HuntOutcome:
    game = session.game
    snapshot = next(role.snapshot for role in roles if isinstance(role, SimR))
    ticks = session.tick if ending.tick is None else ending.tick
    return HuntOutcome(
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
