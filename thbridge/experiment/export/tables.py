"""The tables of an experiment: tables from its log, and tables from the recordings of its trials."""

from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.families.attempts import Attempt, AttemptSubject, attempts_of
from thbridge.experiment.export.families.attention import figures_of, fluency, robots
from thbridge.experiment.export.families.decisions import decisions, decisions_of
from thbridge.experiment.export.families.described import ExperimentTable
from thbridge.experiment.export.families.dyads import dyads
from thbridge.experiment.export.families.forms import GivenScore, answers, given_scores, scores
from thbridge.experiment.export.families.game_recording import RecordedTrial, read_game
from thbridge.experiment.export.families.group_games import RecordedGroup, recorded_groups
from thbridge.experiment.export.families.group_tables import groups, joint_decisions, objections, seats, texts, votes
from thbridge.experiment.export.families.log_events import log_events
from thbridge.experiment.export.families.moves import dialogue_games, moves
from thbridge.experiment.export.families.people import participants, steps
from thbridge.experiment.export.families.reliance import reliance, reliance_of
from thbridge.experiment.export.families.trials import RecordingState, Trial, trials, trials_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.store.events import WITHDRAWN, EventKind, LogEntry, LoggedEvent
from thbridge.files.errors import BadFile


@dataclass(frozen=True, slots=True)
class ExperimentRecords:
    """Records of an experiment, the source of its tables.

    Attributes:
        design: the experiment.
        root: folder of the experiment. Paths of recordings are relative to this folder.
        progress: progress of all people.
        events: events of its log, without deleted events.
        subjects: all attempts at steps.
        scores: all scores.
        trials: all games.
        groups: games of groups, without their recordings.
        withdrawn: number of participants who withdrew. Their events are deleted.
    """

    design: ExperimentDesign
    root: Path
    progress: Progress
    events: tuple[LoggedEvent, ...]
    subjects: tuple[AttemptSubject, ...]
    scores: tuple[GivenScore, ...]
    trials: tuple[Trial, ...]
    withdrawn: int = 0
    groups: tuple[RecordedGroup, ...] = ()

    @property
    def runs(self) -> Collection[Run]:
        """The runs of all people who started and did not withdraw."""
        return self.progress.runs.values()

    @property
    def is_rehearsal(self) -> bool:
        """True if programs took part instead of people."""
        return any(entry.event.kind == EventKind.REHEARSED for entry in self.events)


def records_of(
    design: ExperimentDesign, entries: Sequence[LogEntry], root: Path | None = None, last: int | None = None
) -> ExperimentRecords:
    """Return the records of an experiment.

    Args:
        design: the experiment.
        entries: entries of its log.
        root: folder of the experiment. If None, it is the folder that contains the experiment's file.
        last: number of the last event to use. If None, use all events. Later withdrawals apply in any case.

    Raises:
        BadHistory: the log does not belong to this experiment.
    """
    root = design.path.parent if root is None else root
    last = len(entries) if last is None else last
    withdrawn = sum(_withdraws_before(entry, last) for entry in entries)
    entries = [entry for entry in entries if entry.sequence <= last]
    progress = Progress(design).after(entries)
    events = tuple(entry for entry in entries if isinstance(entry, LoggedEvent))
    attempts = attempts_of(progress, events)
    subjects = tuple(AttemptSubject(progress.runs[person], each) for person, its in attempts.items() for each in its)
    given = tuple(given_scores(design, subjects))
    games = tuple(trials_of(subjects, root))
    groups = tuple(recorded_groups(progress.groups, progress.runs, events, games))
    return ExperimentRecords(design, root, progress, events, subjects, given, games, withdrawn, groups)


def _withdraws_before(entry: LogEntry, last: int) -> bool:
    """Return True if an entry is the withdrawal of a person whose run started before the event `last`."""
    if not isinstance(entry, LoggedEvent) or entry.event.kind != WITHDRAWN:
        return False
    sequences = (entry.event.data or {}).get("sequences")
    if not isinstance(sequences, list) or len(sequences) < 2:
        # A run has at least two events: the start of the run and of a step. A single event is a note with the person's
        # id that was found later.
        return False
    return any(isinstance(each, int) and each <= last for each in sequences)


def log_tables(records: ExperimentRecords) -> tuple[ExperimentTable, ...]:
    """Return the tables whose source is the log."""
    design = records.design
    attempts: dict[str, list[Attempt]] = {}
    for subject in records.subjects:
        attempts.setdefault(subject.run.participant, []).append(subject.attempt)
    return (
        participants(design, records.progress, attempts),
        steps(design, records.subjects),
        trials(design, records.trials),
        answers(design, records.subjects),
        scores(design, records.scores),
        log_events(records.progress, records.events),
    )


def tables_of(design: ExperimentDesign, entries: Sequence[LogEntry]) -> tuple[ExperimentTable, ...]:
    """Return the tables whose source is a log.

    Raises:
        BadHistory: the log does not belong to this experiment.
    """
    return log_tables(records_of(design, entries))


def game_tables(records: ExperimentRecords) -> Iterator[ExperimentTable | str]:
    """Yield the tables of games in pieces, trial by trial. For a missing recording, yield a sentence.

    Only one recording is open at a time, with its utterances and events in memory.
    """
    scores_by: dict[str, list[GivenScore]] = {}
    for score in records.scores:
        scores_by.setdefault(score.run.participant, []).append(score)
    for trial in records.trials:
        if trial.recording is RecordingState.NONE:
            continue
        where = f"The recording of {trial.run.participant}, step {trial.attempt.step.number} ({trial.bag})"
        if trial.recording is not RecordingState.AS_RECORDED:
            is_so = "is missing" if trial.recording is RecordingState.MISSING else "was changed after recording"
            yield f"{where} {is_so}, so tables of games have no rows of this game."
            continue
        try:
            recorded = RecordedTrial(trial, read_game(ExperimentFolder(records.root).bag_named(trial.bag)))
        except BadFile as error:
            yield f"{where} cannot be read ({error.problem}), so tables of games have no rows of this game."
            continue
        yield from _of_game(records.design, recorded, scores_by.get(trial.run.participant, []))


def group_tables(records: ExperimentRecords) -> Iterator[ExperimentTable]:
    """Yield the tables of games of several people in pieces, game by game.

    Notes about missing recordings are those of `game_tables`.
    """
    design = records.design
    for group in records.groups:
        game = group
        if group.trial is not None and group.state is RecordingState.AS_RECORDED:
            with suppress(BadFile):
                game = group.recorded(read_game(ExperimentFolder(records.root).bag_named(group.trial.bag)))
        yield groups(design, game)
        yield seats(design, game)
        yield texts(design, game)
        yield joint_decisions(design, game)
        yield votes(design, game)
        yield objections(design, game)
        yield dyads(design, game)


def _of_game(design: ExperimentDesign, trial: RecordedTrial, own: Sequence[GivenScore]) -> Iterator[ExperimentTable]:
    step = trial.attempt.step
    study = design.cells[trial.run.place.cell].studies[step.condition or 0]
    made = tuple(decisions_of(trial.recording, study.dialogue.planner))
    taken = trial.run.seats.get(step.number)
    seat = "" if taken is None else taken.seat
    if seat:
        # In a game of several people, the rows of a person are about their own decisions and dialogues.
        trial = replace(trial, recording=trial.recording.of_seat(seat))
        made = tuple(each for each in made if each.seat == seat)
    figures = figures_of(trial.recording, made, seat)
    yield decisions(design, trial, made)
    yield reliance(design, [reliance_of(design, trial.trial, made, own)])
    yield robots(design, trial, figures)
    yield fluency(design, trial, figures)
    yield moves(design, trial)
    yield dialogue_games(design, trial)
