"""Table of trials, including whether their recordings are unchanged."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.export.families.attempts import Attempt, AttemptSubject, attempt_columns, seed_of
from thbridge.experiment.export.families.described import (
    ExperimentTable,
    TableOf,
    count,
    flag,
    number,
    seconds,
    share,
    text,
    time,
    whole,
)
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Run
from thbridge.experiment.store.events import JsonValue, StepOutcome
from thbridge.files.errors import BadFile
from thbridge.recording.recordings import digest_of
from thbridge.timing.pace_meter import LATE, real_time


class RecordingState(StrEnum):
    """State of the recording of a game."""

    AS_RECORDED = "as recorded"
    CHANGED = "changed"
    """Its hash differs from the one in the log."""
    MISSING = "missing"
    NONE = "none"
    """No game was played, or none to its end."""


@dataclass(frozen=True, slots=True)
class Trial:
    """A game that a person was to play, in a trial or in practice.

    Attributes:
        run: run of the person.
        attempt: attempt at the game's step.
        recording: state of its recording.
    """

    run: Run
    attempt: Attempt
    recording: RecordingState

    @property
    def bag(self) -> str | None:
        """Path of its recording in the study's folder, or None."""
        told = self.told("bag")
        return None if told is None else str(told)

    def wall(self, simulated: float) -> float | None:
        """Return the real time, s since the first tick, at a simulated time; None if the log has none."""
        # Sums of times may differ from a tick's time by rounding, even at the last tick.
        return real_time(self.course, round(simulated, 3))

    @property
    def course(self) -> list[tuple[float, float]]:
        """Pairs of simulated and real time, s, in order; empty if the log has none."""
        told, course = self.told("course"), []
        for pair in told if isinstance(told, list) else ():
            match pair:
                case [int() | float() as simulated, int() | float() as wall]:
                    course.append((float(simulated), float(wall)))
        return course

    def told(self, name: str) -> JsonValue:
        """Return a value that the log has for the game, or None."""
        return None if self.attempt.game is None else self.attempt.game.get(name)


def trials_of(subjects: Sequence[AttemptSubject], root: Path) -> list[Trial]:
    """Return the games of all attempts, after checking their recordings in the study's folder."""
    games = {StepKind.TRIAL, StepKind.PRACTICE}
    return [
        Trial(subject.run, subject.attempt, _state(subject.attempt, root))
        for subject in subjects
        if subject.attempt.step.entry.step in games and subject.attempt.outcome is not StepOutcome.PASSED_OVER
    ]


def _state(attempt: Attempt, root: Path) -> RecordingState:
    if attempt.game is None or "bag" not in attempt.game:
        return RecordingState.NONE
    try:
        digest = digest_of(ExperimentFolder(root).bag_named(attempt.game["bag"]))
    except (OSError, BadFile):
        return RecordingState.MISSING
    return RecordingState.AS_RECORDED if digest == attempt.game.get("sha256") else RecordingState.CHANGED


def trials(design: ExperimentDesign, subjects: Sequence[Trial]) -> ExperimentTable:
    """Return the table of trials."""

    def condition(row: Trial) -> str | None:
        index = row.attempt.step.condition
        return None if index is None else design.conditions[index].name or None

    def told_number(row: Trial, name: str) -> float | None:
        value = row.told(name)
        return float(value) if isinstance(value, int | float) else None

    def told_count(row: Trial, name: str) -> int | None:
        value = row.told(name)
        return value if isinstance(value, int) else None

    def told_text(row: Trial, name: str) -> str | None:
        value = row.told(name)
        return None if value is None else str(value)

    def late_share(row: Trial) -> float | None:
        late, wall = told_number(row, "late_seconds"), told_number(row, "wall_seconds")
        return None if late is None or not wall else min(late / wall, 1.0)

    table: TableOf[Trial] = TableOf(
        "trials",
        "a game of a person; the columns kind and counts show which games are practice",
        (
            *attempt_columns(design),
            text("condition", "levels of all factors within people", condition),
            text(
                "cell",
                "combination of levels of all factors between people; empty if no factor differs between them",
                lambda row: design.cells[row.run.place.cell].name or None,
            ),
            whole("seed", "random seed of the game", lambda row: seed_of(design, row.attempt)),
            whole("score", "points at the end", lambda row: told_count(row, "score")),
            text(
                "over",
                "reason for the end: all-visited, no-move-left or given-up; empty: the time limit ended it",
                lambda row: told_text(row, "over"),
            ),
            count("rooms_visited", "number of rooms that robots reached", lambda row: told_count(row, "rooms_visited")),
            count(
                "identified", "number of treasures named, rightly or wrongly", lambda row: told_count(row, "identified")
            ),
            seconds(
                "sim_seconds",
                "simulated time from start to end of the game",
                lambda row: told_number(row, "sim_seconds"),
            ),
            seconds(
                "wall_seconds",
                "real time from start to end of the game, without the time until another program resumed it; empty for "
                "rehearsals and for games of earlier releases",
                lambda row: told_number(row, "wall_seconds"),
            ),
            seconds(
                "most_lag_s",
                "largest lag of simulated time behind real time, on a machine that is too slow; empty as in "
                "wall_seconds",
                lambda row: told_number(row, "most_lag_seconds"),
            ),
            share(
                "late_share",
                f"share of the real time in which ticks ran more than {LATE:g} s late; empty as in wall_seconds",
                late_share,
            ),
            number(
                "energy_left", "", "energy left to all robots together", lambda row: told_number(row, "energy_left")
            ),
            time("began", "date and time, UTC", lambda row: row.attempt.began),
            seconds(
                "duration_s",
                "time in the step, by the program's clock; empty if it was resumed",
                lambda row: row.attempt.duration,
            ),
            count("resumed", "number of times that another program resumed it", lambda row: row.attempt.resumed),
            count(
                "crashed",
                "number of games that were begun in it and abandoned",
                lambda row: row.attempt.broken_off + (row.attempt.outcome is StepOutcome.LOST),
            ),
            flag(
                "finished",
                "whether the step was finished",
                lambda row: row.attempt.outcome is StepOutcome.DONE,
            ),
            text(
                "bag",
                "recording of the game, in the study's folder (split: NAME_0.bag, ...); empty without one",
                lambda row: row.bag,
            ),
            text(
                "sha256",
                "SHA-256 of the recording, as in the log; for a split one, of its files one after the other",
                lambda row: told_text(row, "sha256"),
            ),
            text(
                "recording",
                "state of the recording at this export: as recorded, changed, missing, or none. Tables of games only "
                "have rows "
                "of recordings that are as recorded",
                lambda row: str(row.recording),
            ),
        ),
    )
    return table.of(subjects)
