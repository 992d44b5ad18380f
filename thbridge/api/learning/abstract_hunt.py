"""Hunts without simulated robots: the usual rules apply, and the map gives the durations of moves."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from msgspec import structs

from sim.common.observations import TICKS_PER_SECOND
from thbridge.api.learning.treasure_rule import TreasureRule
from thbridge.api.session import SENDER
from thbridge.app.compose.game import build_hider, game_rules
from thbridge.app.compose.robots import build_travel_times
from thbridge.app.compose.setting import StudySetting
from thbridge.files.map_times import read_map_times
from thbridge.hunt import rules
from thbridge.hunt.events import Event, RobotDeparted, TreasuresHidden
from thbridge.hunt.game import GameState, apply, begin
from thbridge.hunt.rooms import Room
from thbridge.roles.keeper.disclosed.disclosure import plain_costs
from thbridge.roles.keeper.requests.station_requests import JudgedRequest, ruling_on
from thbridge.roles.shared.robot_requests import TakeCommand


@dataclass(frozen=True, slots=True)
class MoveTimes:
    """Durations of moves on a study's map, and energy costs of moves from the start poses.

    Attributes:
        between: ticks from room to room, indexed by room number; None if the time is unknown.
        from_starts: ticks to each room from the start pose of each robot.
        prices: energy of the moves from each start pose; empty if the cost matrix contains the energy.
    """

    between: Sequence[Sequence[int | None]]
    from_starts: Sequence[Sequence[int | None]]
    prices: Sequence[Sequence[float | None]]

    @classmethod
    def of(cls, setting: StudySetting) -> "MoveTimes":
        """Return the times from the map's `mapTimes`, or from the study's costs if the map has none.

        Raises:
            BadFile: the file with the times cannot be read.
        """
        timed = setting
        if setting.map.costs is not None:
            timed = replace(setting, costs=read_map_times(setting.map.costs))
        starts = setting.map.starts[: setting.study.robots]
        travel = build_travel_times(timed)
        seconds = [travel.costs_from(start) for start in starts]
        prices: Sequence[Sequence[float | None]] = ()
        if setting.by_position and setting.costs == timed.costs:
            prices = seconds
        elif setting.by_position:
            priced = build_travel_times(setting)
            prices = [priced.costs_from(start) for start in starts]
        return cls(_ticks(plain_costs(timed.costs)), _ticks(seconds), prices)

    def ticks(self, robot: int, start: Room, room: Room, cost: float) -> int:
        """Return the duration of a move in ticks. A move of unknown duration takes 1 s per unit of `cost`."""
        row = self.from_starts[robot] if start.is_corridor else self.between[start.people]
        ticks = row[room.people]
        return max(round(cost * TICKS_PER_SECOND), 1) if ticks is None else ticks


def _ticks(rows: Sequence[Sequence[float | None]]) -> list[list[int | None]]:
    return [[None if each is None else max(round(each * TICKS_PER_SECOND), 1) for each in row] for row in rows]


class AbstractMove(NamedTuple):
    """Move in progress: tick of the departure and tick of the arrival."""

    departed: int
    arrives: int


@dataclass(frozen=True, slots=True)
class HuntOpening:
    """Beginning of a study's hunts. Hunts with different seeds differ only in the seed and the treasures.

    Attributes:
        game: state of the game as soon as the caller commands all robots.
        priced: events before the event that hides the treasures.
        commanded: events after the event that hides the treasures.
    """

    game: GameState
    priced: tuple[Event, ...]
    commanded: tuple[Event, ...]

    @classmethod
    def of(cls, setting: StudySetting, times: MoveTimes) -> "HuntOpening":
        """Return the beginning of the hunts of a study."""
        study = setting.study
        started = game_rules(study).start(1, study.robots, setting.costs, setting.templates.properties)
        game = begin(started)
        priced, commanded = list[Event](), list[Event]()
        for robot, row in enumerate(times.prices):
            game = _followed(game, rules.price(game, robot, row), priced)
        for robot in range(study.robots):
            game = _followed(game, ruling_on(game, TakeCommand(robot, SENDER)), commanded)
        return cls(game, tuple(priced), tuple(commanded))


class AbstractHunt:
    """Game without simulated robots: a robot has only a position. Requests of ground stations command the robots.

    The map gives the duration of a move. All decisions about a treasure are carried out in the tick of the arrival.
    Moves never fail, robots never get lost, and robots never wait for each other.

    Args:
        setting: the study with its files.
        opening: beginning of the study's hunts.
        times: durations of moves.
        rule: rule that decides about treasures.
        seed: random seed of the game, which replaces the study's seed.

    Attributes:
        tick: the current tick.
        game: state of the game.
        moves: the move in progress of each robot.
        events: all events so far, each with its tick, oldest first.
    """

    def __init__(
        self, setting: StudySetting, opening: HuntOpening, times: MoveTimes, rule: TreasureRule, seed: int
    ) -> None:
        self.tick = 0
        self.moves: list[AbstractMove | None] = [None] * len(opening.game.robots)
        self._times, self._rule = times, rule
        started = structs.replace(opening.game.started, seed=seed)
        hidden = TreasuresHidden(build_hider(setting.templates, seed).hidden(started.game, len(opening.game.rooms)))
        self.game: GameState = apply(structs.replace(opening.game, started=started), hidden)
        self.events: list[tuple[int, Event]] = [
            (0, event) for event in (started, *opening.priced, hidden, *opening.commanded)
        ]
        self._record(rules.ending(self.game))

    def ask(self, request: JudgedRequest) -> None:
        """Carry out a request at once; a request that the rules refuse has no effect."""
        self._follow(ruling_on(self.game, request))

    def run_to(self, tick: int) -> None:
        """Advance to the next arrival, but at most to `tick`."""
        arrivals = [move.arrives for move in self.moves if move is not None]
        self.tick = min([tick, *arrivals])
        for robot, move in enumerate(self.moves):
            if move is not None and move.arrives <= self.tick:
                self._arrive(robot)

    def _arrive(self, robot: int) -> None:
        room = self.game.robots[robot].bound_for
        assert room is not None  # noqa: S101  # The robot has a move.
        self.moves[robot] = None
        self._follow(rules.arrive(self.game, robot, room))
        self._follow(rules.sense(self.game, room))
        while (request := self._rule.request(self.game, robot)) is not None:
            self.ask(request)
        self._record(rules.ending(self.game))

    def _follow(self, ruling: rules.Ruling) -> None:
        if isinstance(ruling, tuple):
            self._record(ruling)

    def _record(self, events: Sequence[Event]) -> None:
        for event in events:
            if isinstance(event, RobotDeparted):
                at = self.game.robots[event.robot].at
                arrives = self.tick + self._times.ticks(event.robot, at, event.room, event.cost)
                self.moves[event.robot] = AbstractMove(self.tick, arrives)
            self.events.append((self.tick, event))
            self.game = apply(self.game, event)


def _followed(game: GameState, ruling: rules.Ruling, events: list[Event]) -> GameState:
    """Return the state after a ruling, and add the ruling's events to a list; a refusal has no events."""
    for event in ruling if isinstance(ruling, tuple) else ():
        game = apply(game, event)
        events.append(event)
    return game
