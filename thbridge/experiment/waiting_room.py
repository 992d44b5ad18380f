"""The waiting room of an experiment: people who have reached a game of several people wait here for their group.

The waiting room itself is not in the log, because a seat is taken only when a game starts. After a restart of the
program, people enter it again. Groups that have a game are in the log.
"""

from dataclasses import dataclass

from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.lobby import LeavingRule, SeatOrder
from thbridge.experiment.design.plan import PlannedStep, seats_of_game
from thbridge.experiment.groups import GroupGame
from thbridge.experiment.lobby import FormedGroup, Lobby, PoolRule, SeatHolder, WaitEnded, WaitingPerson
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.store.events import RunState


class WaitingRoom:
    """Waiting room of an experiment.

    Args:
        design: the experiment.
        conductor: its conductor, which logs groups and ends of waits.
    """

    def __init__(self, design: ExperimentDesign, conductor: Conductor) -> None:
        self._design = design
        self._conductor = conductor
        self._steps: dict[str, PlannedStep] = {}
        self._lobby = Lobby(formed=len(conductor.progress.groups))

    @property
    def next_end(self) -> float | None:
        """Time at which the next wait ends, s, or None if no person waits."""
        return self._lobby.next_end

    def enter(self, participant: str, step: PlannedStep, now: float) -> None:
        """Let a person wait for the game of a step that has begun. A person who already waits keeps their turn.

        Args:
            participant: id of the person.
            step: step of the game.
            now: time, s.
        """
        progress = self._conductor.progress
        run = progress.runs[participant]
        pool, rule = pool_of(progress, run, step)
        self._steps[participant] = step
        person = WaitingPerson(participant, pool, now, value_of(self._design, run))
        self._lobby = self._lobby.enter(person, rule)

    def leave(self, participant: str) -> None:
        """Remove a person who left, or whose page is no longer connected."""
        self._lobby = self._lobby.leave(participant)
        self._steps.pop(participant, None)

    def update(self, now: float, most: int | None = None) -> "LobbyChanges":
        """Form groups and end waits, log both, and return them.

        Args:
            now: time, s.
            most: greatest number of games that can start now. If None, there is no limit.
        """
        progress, games, ended = self._conductor.progress, list[GroupGame](), list[str]()
        # All people of a pool have the same rule. A person of a known group may have left meanwhile.
        for person in {each.pool: each for each in self._lobby.waiting}.values():
            _, rule = pool_of(progress, progress.runs[person.participant], self._steps[person.participant])
            self._lobby = self._lobby.changed(person.pool, rule)
        self._lobby, outcomes = self._lobby.matched(now, most)
        for outcome in outcomes:
            match outcome:
                case FormedGroup(people=people):
                    games.append(self._conductor.form_group(outcome, self._steps[next(iter(people.values()))]))
                    for person_in_seat in people.values():
                        del self._steps[person_in_seat]
                case WaitEnded(participant):
                    self._conductor.end_wait(participant, self._steps.pop(participant), outcome)
                    ended.append(participant)
        return LobbyChanges(tuple(games), tuple(ended))


@dataclass(frozen=True, slots=True)
class LobbyChanges:
    """Changes of a waiting room.

    Attributes:
        games: games that can start.
        ended: people whose wait has ended without a game. Their runs have ended, or they go on to their next step.
    """

    games: tuple[GroupGame, ...]
    ended: tuple[str, ...]


def value_of(design: ExperimentDesign, run: Run) -> str:
    """Return the level or answer of a person by which groups are formed; empty if it does not matter."""
    by = design.file.lobby.by
    if design.pairing_factor:
        return design.cells[run.place.cell].levels[by]
    return "" if not by else str(run.answers.get(by, ""))


def pool_of(progress: Progress, run: Run, step: PlannedStep) -> tuple[str, PoolRule]:
    """Return the name of the pool in which a person waits for a game, and the rule of this pool.

    All people of a pool would play the same game: the same step and attempt in the same condition, and with
    `same_group` also the same further games.
    """
    design, lobby = progress.design, progress.design.file.lobby
    seats = seats_of_game(design, run.place, step)
    rule = PoolRule(
        seats=seats,
        wait=lobby.wait,
        then=lobby.then,
        least=lobby.least,
        quota={} if lobby.seat_of else {value: int(number) for value, number in lobby.quota.items()},
        seat_of=lobby.seat_of,
        random_seed=design.file.seed if lobby.seats is SeatOrder.RANDOM else None,
    )
    parts = [step.number, step.index, step.condition, run.begun.get(step.number, 1), design.family(run.place.cell)]
    if lobby.same_group:
        former = _former_game(progress, run, step)
        parts += [run.place.order] if former is None else [former.group]
        if former is not None:
            rule = _rule_of_group(progress, former, rule)
    return "/".join(map(str, parts)), rule


def _former_game(progress: Progress, run: Run, step: PlannedStep) -> GroupGame | None:
    """Return the last game of a person's group before a step, or None."""
    former = [number for number in run.seats if number < step.number]
    return progress.groups[run.seats[max(former)].group, max(former)] if former else None


def _rule_of_group(progress: Progress, former: GroupGame, rule: PoolRule) -> PoolRule:
    """Return the rule for a further game of a group: its people have the same seats as in its last game."""
    runs = {seat: progress.runs[person] for seat, person in former.people.items()}
    fixed = {run.participant: seat for seat, run in runs.items() if run.state is RunState.UNDER_WAY}
    leaving, others = progress.design.file.lobby.leaving, dict[str, SeatHolder]()
    for seat, holder in former.began.items():
        if seat not in fixed.values():
            left = SeatHolder.PROGRAM if leaving is LeavingRule.PROGRAM else SeatHolder.EMPTY
            others[seat] = left if holder is SeatHolder.PERSON else holder
    is_skipped = leaving is LeavingRule.END and SeatHolder.PERSON in {former.began[seat] for seat in others}
    return PoolRule(rule.seats, rule.wait, rule.then, rule.least, fixed=fixed, others=others, is_skipped=is_skipped)
