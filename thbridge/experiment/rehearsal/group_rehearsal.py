"""Rehearsals of studies with games of several people: simulated people come one after another and wait for each other.

The rehearsal is a discrete simulation of events. Each person and each game is a generator that yields the seconds until
its next event. The events of all generators happen in the order of their times.
"""

import heapq
import itertools
from collections.abc import Callable, Generator, Mapping, Sequence
from typing import TypeAlias

from sim.common.observations import TICK
from thbridge.app.compose.game import build_participants
from thbridge.app.compose.setting import StudySetting
from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.lobby import LeavingRule
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.groups import GroupGame
from thbridge.experiment.lobby import SeatHolder
from thbridge.experiment.progress import Run
from thbridge.experiment.rehearsal.clock import RehearsalClock
from thbridge.experiment.store.events import EventKind, JsonValue, RunState
from thbridge.experiment.waiting_room import WaitingRoom
from thbridge.roles.shared.role import Role
from thbridge.text_protocol.wire.lines import TextMessage

Course: TypeAlias = Generator[float | None, None, None]
"""Course of a person or game. It yields the seconds until its next event, or None to wait for other people."""

GamePlayer: TypeAlias = Callable[[Run, PlannedStep, GroupGame, Mapping[str, float]], tuple[dict[str, JsonValue], float]]
"""Function that plays a game. The last argument has the time at which each leaving person's seat becomes silent, s.
Return the log's data and the simulated duration, s."""


class GroupRehearsal:
    """Simulation of all people of a study with games of several people.

    Args:
        design: the experiment.
        clock: clock of the rehearsal.
        arrivals: time between the arrivals of two people, s.
        course_of: function that returns the course of a person.
        play: function that plays a game of several people.
        leaves: function that returns the time at which a person leaves a game of a step, s, or None.
    """

    def __init__(
        self,
        design: ExperimentDesign,
        clock: RehearsalClock,
        arrivals: float,
        course_of: Callable[[Conductor, "GroupRehearsal", Run], Course],
        play: GamePlayer,
        leaves: Callable[[PlannedStep], float | None],
    ) -> None:
        self._design = design
        self._clock = clock
        self._arrivals = arrivals
        self._course_of = course_of
        self._play = play
        self._leaves = leaves
        self._numbers = itertools.count()
        self._due: list[tuple[float, int, str, Course]] = []
        self._waiting: dict[str, Course] = {}
        self._started: set[tuple[str, int]] = set()

    def run(self, conductor: Conductor, report: Callable[[], None]) -> NoPlace:
        """Let people take part until no place is free. `report` is called at each arrival."""
        self._room = WaitingRoom(self._design, conductor)
        self._due, self._waiting, self._started = [], {}, set()
        for run in conductor.progress.runs.values():
            self._schedule(0.0, run.participant, self._course_of(conductor, self, run))
        arrival: float = self._clock.seconds
        while True:
            next_end = self._room.next_end
            times = [arrival, *(each[0] for each in self._due[:1]), *(() if next_end is None else (next_end,))]
            self._clock.advance_to(min(times))
            if self._due and self._due[0][0] == min(times):
                _, _, name, course = heapq.heappop(self._due)
                self._continue(name, course)
            elif min(times) == arrival:
                report()
                admitted = conductor.admit()
                if isinstance(admitted, Run):
                    self._schedule(0.0, admitted.participant, self._course_of(conductor, self, admitted))
                elif not self._due and not self._waiting:
                    return admitted
                arrival += self._arrivals
            for person in self._room.update(self._clock.seconds).ended:
                self._wake(person)
            self._start_games(conductor)

    def enter(self, participant: str, step: PlannedStep) -> None:
        """Let a person wait for other people. The person's course must yield None next."""
        self._room.enter(participant, step, self._clock.seconds)

    def _schedule(self, seconds: float, name: str, course: Course) -> None:
        heapq.heappush(self._due, (self._clock.seconds + seconds, next(self._numbers), name, course))

    def _continue(self, name: str, course: Course) -> None:
        try:
            seconds = next(course)
        except StopIteration:
            return
        if seconds is None:
            self._waiting[name] = course
        else:
            self._schedule(seconds, name, course)

    def _wake(self, participant: str) -> None:
        self._schedule(0.0, participant, self._waiting.pop(participant))

    def _start_games(self, conductor: Conductor) -> None:
        """Start each game whose people are all here. After a simulated crash, games start again."""
        progress = conductor.progress
        for key, game in progress.groups.items():
            people = [each for each in game.people.values() if progress.runs[each].state is RunState.UNDER_WAY]
            here = all(each in self._waiting and progress.runs[each].step == game.step for each in people)
            if people and here and game.played is None and key not in self._started:
                self._started.add(key)
                self._schedule(0.0, game.group, self._game(conductor, game))

    def _game(self, conductor: Conductor, game: GroupGame) -> Course:
        """Play a game of a group, with the people who leave it."""
        runs = [conductor.progress.runs[person] for person in game.people.values()]
        step, rule = runs[0].plan[game.step - 1], self._design.file.lobby.leaving
        drawn = {
            seat: self._leaves(step)
            for seat, person in game.people.items()
            if conductor.progress.runs[person].state is RunState.UNDER_WAY
        }
        leaving = {seat: time for seat, time in drawn.items() if time is not None}
        data, duration = self._play(runs[0], step, game, leaving)
        passed = 0.0
        for seat, time in sorted(leaving.items(), key=lambda item: item[1]):
            if time > duration:
                break
            yield time - passed
            passed = time
            conductor.change_seat(EventKind.SEAT_LEFT, game, seat, time)
            if rule is LeavingRule.PROGRAM:
                conductor.change_seat(EventKind.SEAT_FILLED, game, seat, time)
            conductor.leave(game.people[seat], "left a game in a rehearsal")
            self._wake(game.people[seat])
        yield duration - passed
        present = conductor.progress.groups[game.group, game.step].present
        if data:
            conductor.end_group_game(game, data)
        for person in present:
            if person in self._waiting:
                self._wake(person)


def participants_of(
    setting: StudySetting, game: GroupGame, leaving: Mapping[str, float], rule: LeavingRule
) -> tuple[Role, ...]:
    """Return the simulated participants of a game: of all seats that are not empty.

    Args:
        setting: setting of the game.
        game: the game.
        leaving: time at which each leaving person leaves, s, by the person's seat.
        rule: rule for their seats.
    """
    found: list[Role] = []
    for entry, participant in zip(setting.study.seats, build_participants(setting), strict=True):
        if game.began[entry.name] is SeatHolder.EMPTY:
            continue
        leaves = leaving.get(entry.name) if rule is LeavingRule.EMPTY else None
        found.append(participant if leaves is None else _LeavingParticipant(participant, round(leaves / TICK)))
    return tuple(found)


def last_moment(game: GroupGame, leaving: Mapping[str, float], rule: LeavingRule, longest: float) -> float:
    """Return the time at which a game ends at the latest, s: at its time limit, or because of people who leave."""
    if not leaving:
        return longest
    everyone = {*game.people} == {*leaving}
    return min(leaving.values()) if rule is LeavingRule.END else max(leaving.values()) if everyone else longest


class _LeavingParticipant:
    """A participant who sends nothing from a tick on."""

    def __init__(self, participant: Role, last: int) -> None:
        self._participant = participant
        self._last = last

    @property
    def name(self) -> str:
        return self._participant.name

    def connected(self) -> None:
        self._participant.connected()

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        return self._participant.step(tick, messages) if tick < self._last else []
