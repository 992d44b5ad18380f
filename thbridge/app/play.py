"""A whole hunt in one program: all roles except those of other programs, until the game is over or it is stopped."""

import logging
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import AsyncExitStack, closing
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from sim.common.observations import TICK, TICKS_PER_SECOND
from thbridge.app.compose.game import build_hider, build_keeper
from thbridge.app.compose.recording import build_publisher, build_record
from thbridge.app.compose.robots import build_simr, build_team, rehearse, vehicle_factory
from thbridge.app.compose.setting import StudySetting
from thbridge.app.consent import ConsentDesk, ParticipantDeclined, introduction
from thbridge.app.listeners import NO_CALLBACKS, StartupCallbacks, WatchAddress, listeners
from thbridge.app.run_statistics import RobotStatistics, RunStatistics
from thbridge.app.session.broadcast import Broadcast
from thbridge.app.session.giving import give
from thbridge.app.session.input_log import InputLog
from thbridge.app.session.inputs import ConnectionOpened, LinkOpened
from thbridge.app.session.recording import BagRecorder, TlogRecorder
from thbridge.app.session.session import EventLog, Session, TickRecord, TickRecorder
from thbridge.app.trouble_log import TroubleLog
from thbridge.hunt.game import GameState
from thbridge.mavlink.files.tlog import TlogFile
from thbridge.mavlink.sockets.server import MavlinkPorts, MavlinkServer
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.recording.journal_folder import JournalStore
from thbridge.recording.recordings import journal_of, tlog_of
from thbridge.roles.keeper.disclosed.consent import CONSENT_SENTENCES, ConsentStatus
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.robot_requests import Request
from thbridge.roles.shared.role import Role
from thbridge.roles.simr.simr import SimR
from thbridge.ros.names import GRAPH_LINK
from thbridge.rosgraph.sockets.joining import GraphAddress
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.admission import Admission
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.keys import RingKeys
from thbridge.text_protocol.sockets.server import TextServer
from thbridge.text_protocol.wire import legacy
from thbridge.timing.keepalive import kept_alive
from thbridge.timing.loop import LoopResult, run_ticks
from thbridge.timing.pace_meter import PaceMeter
from thbridge.timing.pacer import Pacer

_log = logging.getLogger(__name__)

PLAY = "play"
"""Name of this program in recordings."""

FINAL_TICKS = TICKS_PER_SECOND // 2
"""Ticks that a session goes on after the end of the game, so that all programs and the bag get its last messages."""


@dataclass(frozen=True, slots=True)
class GameOutcome:
    """Outcome of one game of a hunt; attributes as in `HuntOutcome`, and the number of the game."""

    game: int
    score: int
    over: str | None
    rooms_visited: int
    identified: int
    energy: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class HuntOutcome:
    """Outcome of a hunt, which `thbridge play --json` prints.

    Attributes:
        seed: of the study.
        score: points.
        over: reason for the end (`hunt.events.EndReason`); None if the game did not end.
        rooms_visited: number of rooms.
        identified: number of treasures named, rightly or wrongly.
        energy: energy left, by robot.
        sim_seconds: simulated time from the start to the end of the game.
        wall_seconds: real time of the same.
        collisions: number of times that a robot touched a wall or another robot.
        bag: the recording.
        games: all games in their order, where participants play several; the figures above are those of the last.
        robots: figures of each robot over the whole run.
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
    games: tuple[GameOutcome, ...] = ()
    robots: tuple[RobotStatistics, ...] = ()


class HuntUnfinished(Exception):  # noqa: N818 - nothing went wrong with the program
    """The hunt ended before the game was over, or before the participant had left. Everything is closed in good order.

    Attributes:
        outcome: at that time.
        stopped: True after Ctrl-C or SIGTERM; False when the time was up.
    """

    def __init__(self, outcome: HuntOutcome, stopped: bool) -> None:
        super().__init__("stopped" if stopped else "the time was up")
        self.outcome = outcome
        self.stopped = stopped


@dataclass(frozen=True, slots=True)
class PlayOptions:
    """Options of a hunt, beside the study.

    Attributes:
        rate: simulated seconds per second; 0 as fast as possible.
        bag: path of the recording; None for no recording.
        outside: names of the roles that other programs take.
        participant: description for the record, for example "person" or "suggestion".
        max_seconds: simulated time after which an unfinished game is given up.
        graph: the ROS graph to take part in; None for none.
        left: called after every tick; returns True once the participant's own window is closed. Only then the hunt
            ends, because they may look at the result and play again. None: it ends with the game.
        watch: address of the watch server; None for none.
        foxglove: TCP port of this machine for Foxglove; None for none.
        mavlink: ports of the MAVLink links; None for none.
        inputs: path of the log of inputs; a game whose log is there already goes on where that ends, and a simulated
            participant in this process decides anew as it did. None: no log.
        meter: measures the real time of this game, where there is a log of inputs; None for one that nobody reads.
        keys: by which programs take part from other machines; None: there are none.
        run: name of this run, unlike all others, for what keys were used in.
    """

    rate: float
    bag: Path | None
    outside: frozenset[str]
    participant: str
    max_seconds: float
    graph: GraphAddress | None = None
    left: Callable[[], bool] | None = None
    watch: WatchAddress | None = None
    foxglove: int | None = None
    mavlink: MavlinkPorts | None = None
    inputs: Path | None = None
    meter: PaceMeter | None = None
    keys: RingKeys | None = None
    run: str = ""


async def play(
    setting: StudySetting,
    participant: TabUI | None,
    options: PlayOptions,
    ready: Callable[[ListeningAddress | CannotListen], None],
    progress: Callable[[TickRecord], None],
    callbacks: StartupCallbacks = NO_CALLBACKS,
) -> HuntOutcome:
    """Play one hunt with all roles in this process, except those of other programs.

    Args:
        setting: the study.
        participant: the participant's role; None when that is an outside program, as it also is when `options` say so.
        options: of the hunt.
        ready: takes the address of the text server, or the reason why it cannot listen.
        progress: takes every tick.
        callbacks: for the results of starting graph, watch server and links.

    A participant of an outside program is asked for consent first, where the study does so: no tick is run and no file
    written before the answer.

    Raises:
        ParticipantDeclined: the participant did not agree to take part, or left before an answer.
        BadFile: the journal, the log of inputs, the telemetry log or the bag cannot be written (the latter as
            `BagNotWritten`), or the log of inputs is of another game (`GameDiffers`).
        HuntUnfinished: it was stopped, or the game was not over in time; what was recorded is complete.
    """
    team = build_team(setting)
    simr = build_simr(setting, team)
    roles: list[Role] = [simr]
    if legacy.HIDER not in options.outside:
        roles.append(build_hider(setting.templates, setting.study.seed))
    inside = None if legacy.TABUI in options.outside else participant
    who = "" if inside is None else options.participant
    names = [role.name for role in (*roles, inside) if role is not None]
    record = build_record(setting, PLAY, names, who)
    publisher = build_publisher(setting)
    pacer = Pacer(options.rate, pause_abandoned=options.left)

    def ask(sender: str, request: Request) -> None:
        session.ask(sender, request)

    def receive_frame(robot: int, frame: Frame) -> None:
        session.transmit(session.receive_frame(graph_link, frame, robot).replies)

    async with AsyncExitStack() as opened:
        # First of all: no recording is begun if the MAVLink ports cannot be opened.
        links = await _links(options.mavlink, opened, callbacks)
        if options.rate > 0.0:
            rehearse(setting)
        session = Session(build_keeper(setting), roles, (), inside, vehicle_factory(setting, simr))
        desk = ConsentDesk(session, introduction(setting)) if setting.consent and inside is None else None
        # A game that goes on is the same as before, and its log is its own.
        name = options.run if options.inputs is None else str(options.inputs.resolve())
        session.run = lambda game: f"{name}/{game}"
        server = TextServer(
            desk or session, session.note_forwarded, admission=Admission.to(setting.study.open_to), keys=options.keys
        )
        session.perform = server.perform
        server.note_game(*session.game_name)

        async def listen() -> None:
            where = await server.start(setting.study.server.host, setting.study.server.port)
            if isinstance(where, CannotListen) and options.left is not None:
                where = await server.start(setting.study.server.host, 0)  # The window gets the port that was found.
            ready(where)

        if desk is not None:
            opened.push_async_callback(server.stop)
            await listen()
            # In a window people have been asked already, and it says yes as soon as it joins.
            await _consent(desk, options.left, _ignore if options.left is not None else _log.warning)
        has_vehicles = setting.study.mavlink.on
        stations = receive_frame if has_vehicles else None
        listening = listeners(options, setting, team, publisher, pacer, ask, callbacks, stations, has_game=True)
        audience = await opened.enter_async_context(listening)
        log: EventLog | None = None
        if options.bag is not None:
            log = opened.enter_context(closing(JournalStore(journal_of(options.bag))))
        recorders: list[TickRecorder] = []
        if audience:
            recorders.append(BagRecorder(Broadcast(publisher, record, setting.map.grid, audience)))
        if options.bag is not None and has_vehicles and setting.study.mavlink.tlog:
            recorders.append(TlogRecorder(opened.enter_context(TlogFile(tlog_of(options.bag)))))
        game_inputs: InputLog | None = None
        if options.inputs is not None:
            game_inputs = opened.enter_context(
                closing(InputLog(options.inputs, record, options.meter or PaceMeter(), pacer))
            )
            # Before all others: what they record follows from it.
            recorders.insert(0, game_inputs)
        session.record_with(recorders, log)
        statistics, ending = RunStatistics(), EndCondition(options.max_seconds, options.left)
        went_on = game_inputs is None or await _go_on(session, game_inputs, statistics, ending)
        if has_vehicles and options.graph is not None:
            graph_link = session.open_link(GRAPH_LINK)
        if links is not None:
            stations_server, reached_by = links
            await stations_server.serve(session)
            callbacks.linked(reached_by)
            await opened.enter_async_context(kept_alive(session, pacer))
        troubles = TroubleLog()

        def tick() -> bool:
            now = session.step()
            if now.snapshot is not None:
                statistics.add(now.snapshot)
            # A participant in this process is told by window or terminal.
            refusals = (each for each in now.refusals if inside is None or each.program != inside.name)
            troubles.note(refusals, now.utterances)
            server.note_game(*session.game_name)
            progress(now)
            return not ending.reached(session)

        if desk is None:
            await listen()
        opened.push_async_callback(server.stop)  # It stops before the recording is closed.
        run = await run_ticks(tick, pacer) if went_on else LoopResult(finished=False, seconds=0.0)
    outcome = outcome_of(setting, session, ending, roles, run.seconds, options.bag, statistics)
    # With a window, the end of a game is not the end of the hunt: participants may play again.
    if ending.tick is None or (options.left is not None and not run.finished):
        raise HuntUnfinished(outcome, stopped=not run.finished)
    return outcome


async def _go_on(session: Session, log: InputLog, statistics: RunStatistics, ending: "EndCondition") -> bool:
    """Run a session up to the tick where its log ends, as fast as possible; nobody is connected any more then.

    Returns:
        False when it was stopped (Ctrl-C, SIGTERM).
    """
    waiting = deque(log.ticks)

    def tick() -> bool:
        if waiting and waiting[0].tick == session.tick:
            for item in waiting.popleft().inputs:
                give(session, None, item)
        now = session.step()
        if now.snapshot is not None:
            statistics.add(now.snapshot)
        ending.reached(session)
        return bool(waiting)

    if not waiting:
        return True
    perform, session.perform = session.perform, session.note_all_forwarded
    run = await run_ticks(tick, Pacer(0.0))
    session.perform = perform
    for item in chain.from_iterable(logged.inputs for logged in log.ticks):
        match item:
            case ConnectionOpened(connection):
                session.perform(session.eof(connection))
            case LinkOpened(link):
                session.close_link(link)
    return run.finished


def _ignore(sentence: str) -> None:
    """Do nothing."""


async def _consent(desk: ConsentDesk, left: Callable[[], bool] | None, tell: Callable[[str], None]) -> None:
    """Wait until the participant has agreed to take part, or cannot be asked. Raises ParticipantDeclined."""
    tell(CONSENT_SENTENCES[desk.status])

    def waiting() -> bool:
        return desk.status is ConsentStatus.AWAITED and not (left is not None and left())

    await run_ticks(waiting, Pacer(1.0))
    if desk.status is ConsentStatus.NOT_ASKED:
        tell(CONSENT_SENTENCES[desk.status])
    if not desk.status.recordable:
        raise ParticipantDeclined(desk.status is ConsentStatus.DECLINED)


async def _links(
    ports: MavlinkPorts | None, opened: AsyncExitStack, callbacks: StartupCallbacks
) -> tuple[MavlinkServer, list[str]] | None:
    """Return the MAVLink server with all ports open, and its addresses; None for no links.

    If a port cannot be opened, the callback gets the reason.
    """
    if ports is None:
        return None
    links = MavlinkServer(ports)
    opened.push_async_callback(links.close)
    names = await links.open()
    if isinstance(names, CannotListen):
        callbacks.linked(names)
        return None
    return links, names


class EndCondition:
    """Condition for the end of a session.

    Args:
        max_seconds: simulated time after which an unfinished game is given up.
        left: see `PlayOptions`.
    """

    def __init__(self, max_seconds: float, left: Callable[[], bool] | None = None) -> None:
        self._last_tick = max_seconds * TICKS_PER_SECOND
        self._left = left
        self._outcomes: dict[int, GameOutcome] = {}
        self._game: GameState | None = None
        self.tick: int | None = None
        """Tick in which the game ended; None before, and again once another game has begun."""

    @property
    def games(self) -> tuple[GameOutcome, ...]:
        """The games so far, in their order."""
        return tuple(self._outcomes.values())

    def reached(self, session: Session) -> bool:
        """Return True when the session is over."""
        game = session.game
        if game is not None and game is not self._game:
            # Of games that are over only the outcome is kept: people may play hundreds of them.
            self._outcomes[game.started.game] = _game_outcome(game)
            self._game = game
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


def outcome_of(
    setting: StudySetting,
    session: Session,
    ending: EndCondition,
    roles: Sequence[Role],
    wall: float,
    bag: Path | None,
    statistics: RunStatistics,
) -> HuntOutcome:
    """Return the outcome of a session, over or not."""
    snapshot = next(role.snapshot for role in roles if isinstance(role, SimR))
    ticks = session.tick if ending.tick is None else ending.tick
    games = ending.games
    last = games[-1] if games else None
    return HuntOutcome(
        seed=setting.study.seed,
        score=0 if last is None else last.score,
        over=None if last is None else last.over,
        rooms_visited=0 if last is None else last.rooms_visited,
        identified=0 if last is None else last.identified,
        energy=() if last is None else last.energy,
        sim_seconds=round(ticks * TICK, 2),
        wall_seconds=round(wall, 2),
        collisions=0 if snapshot is None else int(snapshot.truth.collisions.sum()),
        bag=bag,
        games=games,
        robots=statistics.figures(),
    )


def _game_outcome(game: GameState) -> GameOutcome:
    return GameOutcome(
        game=game.started.game,
        score=game.score,
        over=None if game.ended is None else game.ended.reason.value,
        rooms_visited=sum(room.visited for room in game.rooms),  # of integers
        identified=sum(room.points is not None for room in game.rooms),
        energy=tuple(robot.energy for robot in game.robots),
    )
