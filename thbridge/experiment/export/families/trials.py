"""The table `trials`: games of people, and the states of their recordings."""

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
    """The recording's hash differs from the hash in the log."""
    MISSING = "missing"
    NONE = "none"
    """No game was finished, so there is no recording."""


@dataclass(frozen=True, slots=True)
class Trial:
    """A game of a person, in a trial or practice step.

    Attributes:
        run: run of the person.
        attempt: attempt at the game's step.
        recording: state of the game's recording.
    """

    run: Run
    attempt: Attempt
    recording: RecordingState

    @property
    def bag(self) -> str | None:
        """Path of the recording relative to the study's folder, or None."""
        logged = self.logged("bag")
        return None if logged is None else str(logged)

    def wall(self, simulated: float) -> float | None:
        """Return the real time since the first tick, s, at a simulated time. None if it is not in the log."""
        # Because of rounding, sums of times may differ slightly from a tick's time.
        return real_time(self.course, round(simulated, 3))

    @property
    def course(self) -> list[tuple[float, float]]:
        """Pairs of simulated and real time, s, in order. Empty if the log has no such times."""
        logged, course = self.logged("course"), []
        for pair in logged if isinstance(logged, list) else ():
            match pair:
                case [int() | float() as simulated, int() | float() as wall]:
                    course.append((float(simulated), float(wall)))
        return course

    def logged(self, name: str) -> JsonValue:
        """Return a value of the log's data about the game, or None."""
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

    def logged_number(row: Trial, name: str) -> float | None:
        value = row.logged(name)
        return float(value) if isinstance(value, int | float) else None

    def logged_count(row: Trial, name: str) -> int | None:
        value = row.logged(name)
        return value if isinstance(value, int) else None

    def logged_text(row: Trial, name: str) -> str | None:
        value = row.logged(name)
        return None if value is None else str(value)

    def late_share(row: Trial) -> float | None:
        late, wall = logged_number(row, "late_seconds"), logged_number(row, "wall_seconds")
        return None if late is None or not wall else min(late / wall, 1.0)

    table: TableOf[Trial] = TableOf(
        "trials",
        "a game of a person; practice games have the kind practice and do not count",
        (
            *attempt_columns(design),
            text("condition", "levels of all factors within people", condition),
            text(
                "cell",
                "combination of levels of all factors between people; empty if there are no factors between people",
                lambda row: design.cells[row.run.place.cell].name or None,
            ),
            whole("seed", "random seed of the game", lambda row: seed_of(design, row.attempt)),
            whole("score", "points at the end", lambda row: logged_count(row, "score")),
            text(
                "over",
                "reason for the end of the game: all-visited, no-move-left or given-up; empty for the time limit",
                lambda row: logged_text(row, "over"),
            ),
            count(
                "rooms_visited", "number of rooms that robots reached", lambda row: logged_count(row, "rooms_visited")
            ),
            count(
                "identified",
                "number of treasures named, rightly or wrongly",
                lambda row: logged_count(row, "identified"),
            ),
            seconds(
                "sim_seconds",
                "simulated time from the start to the end of the game",
                lambda row: logged_number(row, "sim_seconds"),
            ),
            seconds(
                "wall_seconds",
                "real time from the start to the end of the game, without the time between a crash and the resume; "
                "empty for rehearsals and for games of earlier releases",
                lambda row: logged_number(row, "wall_seconds"),
            ),
            seconds(
                "most_lag_s",
                "largest lag of simulated time behind real time, on a slow machine; empty values as for wall_seconds",
                lambda row: logged_number(row, "most_lag_seconds"),
            ),
            share(
                "late_share",
                f"share of the real time in which ticks were more than {LATE:g} s late; empty values as for "
                "wall_seconds",
                late_share,
            ),
            number(
                "energy_left",
                "",
                "total remaining energy of all robots, game units",
                lambda row: logged_number(row, "energy_left"),
            ),
            time("began", "date and time of the start, UTC", lambda row: row.attempt.began),
            seconds(
                "duration_s",
                "time in the step, from the program's clock; empty if the step was resumed",
                lambda row: row.attempt.duration,
            ),
            count(
                "resumed", "number of times that the step was resumed after a crash", lambda row: row.attempt.resumed
            ),
            count(
                "crashed",
                "number of games of this step that were started and abandoned after a crash",
                lambda row: row.attempt.broken_off + (row.attempt.outcome is StepOutcome.LOST),
            ),
            flag(
                "finished",
                "true if the person finished the step",
                lambda row: row.attempt.outcome is StepOutcome.DONE,
            ),
            text(
                "bag",
                "recording of the game, relative to the study's folder (files of a split recording: NAME_0, NAME_1, "
                "...); empty if there is none",
                lambda row: row.bag,
            ),
            text(
                "sha256",
                "SHA-256 of the recording, from the log; for a split recording, of all its files in order",
                lambda row: logged_text(row, "sha256"),
            ),
            text(
                "recording",
                "state of the recording at this export: as recorded (unchanged), changed, missing or none; tables of "
                "games use only unchanged recordings",
                lambda row: str(row.recording),
            ),
        ),
    )
    return table.of(subjects)
