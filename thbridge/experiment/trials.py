"""Games of people: settings of trials and practice games, and the data about these games in the log."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from sim.common.observations import TICK
from thbridge.app.compose.game import build_hider
from thbridge.app.compose.robots import build_travel_times
from thbridge.app.compose.setting import StudySetting
from thbridge.app.session.session import TickRecord
from thbridge.batch.measures import GameMeasures
from thbridge.batch.settings import SettingCache
from thbridge.dialogue.moves import Speaker
from thbridge.experiment.design.experiment_file import ExperimentDesign, drawn_seed, practice_seed
from thbridge.experiment.design.plan import PlannedStep, study_of_game
from thbridge.experiment.design.practice import demands_of
from thbridge.experiment.design.steps import PracticeTerm
from thbridge.experiment.progress import Run
from thbridge.experiment.store.events import JsonValue
from thbridge.hunt.events import RobotDeparted, TreasureIdentified, TreasurePictured
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_tour import TourStart, best_score, most_rooms_shared_out
from thbridge.recording.recordings import digest_of
from thbridge.timing.pace_meter import GamePace


def setting_of_trial(
    design: ExperimentDesign, settings: SettingCache, run: Run, step: PlannedStep
) -> StudySetting | None:
    """Return the setting of a trial. Return None for a practice game, which is not recorded."""
    study = study_of_game(design, run.place, step)
    if study is None or step.trial is None:
        return None
    return settings.of(replace(study, seed=drawn_seed(design, step.trial)))


def setting_of_practice(design: ExperimentDesign, settings: SettingCache, run: Run, step: PlannedStep) -> StudySetting:
    """Return the setting of a practice game: the setting of the person's first condition, with the keys of the step.

    No trial has the seed of a practice game, so that people learn nothing about a trial. Consent and farewell texts are
    shown only in trials.
    """
    study = study_of_game(design, run.place, step)
    if study is None:
        raise ValueError(f"{step.name} is not a practice game")
    who = replace(study.participant, consent=None, farewell=None)
    seed = practice_seed(design, run.begun.get(step.number, 1))
    return settings.of(replace(study, seed=seed, participant=who))


class PracticeCount:
    """Counter of a person's actions in a practice game.

    Args:
        step: the practice step.
        setting: the setting of the game.
    """

    def __init__(self, step: PlannedStep, setting: StudySetting) -> None:
        self._demands = demands_of(step.entry, setting.study)
        self._done = dict.fromkeys(PracticeTerm, 0.0)
        self._pictured: set[Room] = set()
        self._dialogues: set[int] = set()

    def record(self, record: TickRecord) -> None:
        """Count the events of one tick."""
        done = self._done
        if record.game is not None and record.game.ended is None:
            done[PracticeTerm.SECONDS] = record.tick * TICK
        for event in record.events:
            match event:
                case RobotDeparted():
                    done[PracticeTerm.MOVES] += 1
                case TreasurePictured(room=room):
                    self._pictured.add(room)
                case TreasureIdentified():
                    done[PracticeTerm.IDENTIFIED] += 1
        self._dialogues.update(said.dialogue for said in record.utterances if said.speaker is Speaker.PERSON)
        done[PracticeTerm.PICTURES] = len(self._pictured)
        done[PracticeTerm.DIALOGUES] = len(self._dialogues)

    @property
    def missing(self) -> Mapping[PracticeTerm, float]:
        """Amount of each requirement that is still missing; empty if all requirements are met."""
        done = self._done
        return {term: number - done[term] for term, number in self._demands.items() if done[term] < number}

    @property
    def data(self) -> dict[str, JsonValue]:
        """Data of a `PRACTICE_PLAYED` event: numbers of actions, simulated seconds, and unmet requirements."""
        return {**{str(term): round(number, 2) for term, number in self._done.items()}, "missing": [*self.missing]}


def results_of(design: ExperimentDesign, settings: SettingCache, run: Run) -> list[tuple[int, int | None]]:
    """Return the score and the best possible score of each game that a person played; see `best_possible`."""
    found = []
    for step in run.plan:
        setting = setting_of_trial(design, settings, run, step)
        if setting is not None and step.number in run.scores:
            found.append((run.scores[step.number], best_possible(setting)))
    return found


def best_possible(setting: StudySetting) -> int | None:
    """Return the best possible score of the first game, or None if there are too many rooms for the computation."""
    study, rooms = setting.study, setting.costs.rooms
    if len(rooms) > most_rooms_shared_out(study.robots):
        return None
    hidden = build_hider(setting.templates, study.seed).hidden(1, len(rooms))
    rows = [setting.costs.rows[0]] * study.robots
    if setting.by_position:
        travel = build_travel_times(setting)
        rows = [
            tuple(math.inf if cost is None else cost for cost in travel.costs_from(start))
            for start in setting.map.starts[: study.robots]
        ]
    starts = [TourStart(tuple(row), study.game.energy) for row in rows]
    points = {room: kind.points for room, kind in zip(rooms, hidden, strict=True)}
    return best_score(setting.costs, starts, points, study.game.identify_cost)


def played(measures: GameMeasures, bag: Path, root: Path, pace: GamePace | None = None) -> dict[str, JsonValue]:
    """Return the data of a `GAME_PLAYED` event: the recording with its hash, and measures of the game.

    Args:
        measures: measures of the game.
        bag: closed recording of the game.
        root: folder for relative paths of recordings.
        pace: pace of the game. None for a rehearsal, which does not run in real time.
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
