"""Trials: the setting that a person's game is played in, and what the log keeps of a game that was played."""

from dataclasses import replace
from pathlib import Path

from thbridge.app.compose.setting import StudySetting
from thbridge.batch.measures import GameMeasures
from thbridge.batch.settings import SettingCache
from thbridge.experiment.design.experiment_file import ExperimentDesign, drawn_seed
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.progress import Run
from thbridge.experiment.store.events import JsonValue
from thbridge.recording.recordings import digest_of
from thbridge.timing.pace_meter import GamePace


def setting_of_trial(
    design: ExperimentDesign, settings: SettingCache, run: Run, step: PlannedStep
) -> StudySetting | None:
    """Return the setting of a game; None of practice, which is not recorded and counts for nothing."""
    if step.condition is None or step.trial is None:
        return None
    study = design.cells[run.place.cell].studies[step.condition]
    return settings.of(replace(study, seed=drawn_seed(design, step.trial)))


def played(measures: GameMeasures, bag: Path, root: Path, pace: GamePace | None = None) -> dict[str, JsonValue]:
    """Return the data of a `GAME_PLAYED`: the recording with its hash, and measures of the game.

    Args:
        measures: of the game.
        bag: its recording, closed.
        root: the folder that paths of recordings are relative to.
        pace: of the game; None in a rehearsal, which has no real time.
    """
    measured: dict[str, JsonValue] = {} if pace is None else _measured(pace)
    return {
        "bag": bag.relative_to(root).as_posix(),
        "sha256": digest_of(bag),
        "score": measures.score,
        "over": measures.over,
        "rooms_visited": measures.rooms_visited,
        "identified": measures.identified,
        "sim_seconds": measures.sim_seconds,
        "energy_left": measures.energy_left,
        **measured,
    }


def _measured(pace: GamePace) -> dict[str, JsonValue]:
    return {
        "wall_seconds": pace.wall,
        "most_lag_seconds": pace.most_lag,
        "late_seconds": pace.late,
        "course": [[simulated, wall] for simulated, wall in pace.course],
    }
