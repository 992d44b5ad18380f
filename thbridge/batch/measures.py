"""Measures of a game in the results of a sweep."""

import dataclasses
import math
from array import array
from dataclasses import dataclass

import numpy as np

from sim.numerics import elementary
from sim.robot.navigator.goals import GoalReached, NoPath
from sim.snapshot import TeamSnapshot
from thbridge.app.play import HuntOutcome
from thbridge.app.run_statistics import RobotStatistics
from thbridge.app.session.session import TickRecord
from thbridge.batch.seat_measures import SeatObserver, SeatStatistics
from thbridge.dialogue.moves import Speaker


@dataclass(frozen=True, slots=True)
class GameMeasures:
    """Measures of one game. Except for `each_robot`, measures of robots are totals over all robots.

    Attributes:
        score: points of the team.
        over: reason for the end (`hunt.events.EndReason`), or None if the game was stopped.
        rooms_visited: number of visited rooms.
        identified: number of treasures named, rightly or wrongly.
        sim_seconds: simulated time from the start to the end of the game.
        energy_left: remaining energy at the end.
        collisions: number of collisions with walls and other robots.
        goals_reached: number of goals that the robots' navigators reached.
        goals_failed: number of goals that the navigators gave up.
        failures: reason code of each failed goal, in order.
        distance: driven distance, meters.
        error_mean: mean distance between the true and the estimated position at all scans, meters.
        error_95: 95 % quantile of this distance, meters.
        times_lost: number of times that a localizer reported to be lost.
        seconds_lost: simulated seconds in which localizers were lost.
        seconds_waiting: simulated seconds in which robots stood still to let another robot pass.
        refusals: number of requests that the keeper refused.
        dialogues: number of dialogues.
        robot_utterances: number of sentences that robots said.
        person_utterances: number of replies of the participant.
        each_robot: figures of each robot.
        votes: number of decisions on which participants of several seats voted.
        agreement: share of these decisions that the participants accepted; None if there were none.
        seconds_to_decide: mean simulated time from the proposal of a decision to the end of its vote, s; None if there
            were none.
        texts: number of texts between participants.
        each_seat: figures of the participant of each seat; empty in a game with one participant.
    """

    score: int
    over: str | None
    rooms_visited: int
    identified: int
    sim_seconds: float
    energy_left: float
    collisions: int
    goals_reached: int
    goals_failed: int
    failures: tuple[str, ...]
    distance: float
    error_mean: float | None
    error_95: float | None
    times_lost: int
    seconds_lost: float
    seconds_waiting: float
    refusals: int
    dialogues: int
    robot_utterances: int
    person_utterances: int
    each_robot: tuple[RobotStatistics, ...]
    votes: int = 0
    agreement: float | None = None
    seconds_to_decide: float | None = None
    texts: int = 0
    each_seat: tuple[SeatStatistics, ...] = ()


SEAT_MEASURES = ("votes", "agreement", "seconds_to_decide", "texts", "each_seat")
"""Measures of games with several seats. Designs must name them, so that sweeps of earlier releases can be resumed."""
MEASURES = tuple(field.name for field in dataclasses.fields(GameMeasures))
"""Names of all measures."""


class GameObserver:
    """Counter of events that the outcome of a game does not include."""

    def __init__(self) -> None:
        self._errors = array("d")
        self._dialogues: set[int] = set()
        self._said = dict.fromkeys(Speaker, 0)
        self._reached = self._refusals = 0
        self._failures: list[str] = []
        self._seats = SeatObserver()

    def record(self, record: TickRecord) -> None:
        """Count the events of one tick."""
        self._refusals += len(record.refusals)
        if record.events or record.utterances or record.team:
            self._seats.record(record)
        for utterance in record.utterances:
            self._dialogues.add(utterance.dialogue)
            self._said[utterance.speaker] += 1
        if record.snapshot is not None:
            self._see(record.snapshot)

    def _see(self, snapshot: TeamSnapshot) -> None:
        # All other outputs have neither a result nor a scan.
        for robot, output in snapshot.renewed.items():
            if robot in snapshot.dead:
                continue
            result = output.navigation.result
            if isinstance(result, GoalReached):
                self._reached += 1
            elif isinstance(result, NoPath):
                self._failures.append(result.reason)
            if output.observations.scan is not None:
                x, y, _ = snapshot.truth.poses[robot].tolist()
                believed = output.estimate.base_in_map
                self._errors.append(elementary.hypot(believed.x - x, believed.y - y))

    def measures(self, outcome: HuntOutcome) -> GameMeasures:
        """Return the measures of the game.

        Args:
            outcome: outcome of the game.
        """
        errors, robots = np.array(self._errors), outcome.robots
        return GameMeasures(
            score=outcome.score,
            over=outcome.over,
            rooms_visited=outcome.rooms_visited,
            identified=outcome.identified,
            sim_seconds=outcome.sim_seconds,
            energy_left=math.fsum(outcome.energy),
            collisions=outcome.collisions,
            goals_reached=self._reached,
            goals_failed=len(self._failures),
            failures=tuple(self._failures),
            distance=math.fsum(robot.distance for robot in robots),
            error_mean=round(float(errors.mean()), 6) if errors.size else None,
            error_95=round(float(np.quantile(errors, 0.95)), 6) if errors.size else None,
            times_lost=sum(robot.times_lost for robot in robots),
            seconds_lost=math.fsum(robot.seconds_lost for robot in robots),
            seconds_waiting=math.fsum(robot.seconds_waiting for robot in robots),
            refusals=self._refusals,
            dialogues=len(self._dialogues),
            robot_utterances=self._said[Speaker.ROBOT],
            person_utterances=self._said[Speaker.PERSON],
            each_robot=robots,
            votes=self._seats.votes,
            agreement=self._seats.agreement,
            seconds_to_decide=self._seats.seconds_to_decide,
            texts=sum(seat.texts for seat in self._seats.each_seat),
            each_seat=self._seats.each_seat,
        )
