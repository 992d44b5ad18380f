"""Rehearsals: simulated people take part in a complete experiment, with random answers, errors and drop-outs."""

import math
import random
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from sim.numerics import elementary, noise
from thbridge.app.compose.recording import build_writer
from thbridge.app.compose.setting import StudySetting
from thbridge.batch.hunt import play_hunt
from thbridge.batch.measures import GameMeasures
from thbridge.batch.settings import SettingCache
from thbridge.dialogue.games.strategies import Attitude
from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.plan import PlannedStep, seats_of_game
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.groups import GroupGame
from thbridge.experiment.progress import Run, options_shown
from thbridge.experiment.rehearsal.clock import RehearsalClock
from thbridge.experiment.rehearsal.group_rehearsal import Course, GroupRehearsal, last_moment, participants_of
from thbridge.experiment.rehearsal.people import SimulatedPeople, normal
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.experiment.store.events import EventKind, JsonValue, RunState
from thbridge.experiment.trials import played, setting_of_trial
from thbridge.files.disk.text_files import read_text
from thbridge.files.progress import Tell, untold
from thbridge.recording.recordings import parts_of
from thbridge.roles.shared.role import Role

BETWEEN_PEOPLE, PRACTICE, PAUSE = 300.0, 120.0, 60.0
"""Durations in seconds: time between two people, practice game, pause."""


class ProgramCrashed(Exception):  # noqa: N818 - the name says what happens
    """Simulated crash of the program in a rehearsal. The caller restarts the rehearsal."""


def rehearse(
    folder: ExperimentFolder, design: ExperimentDesign, people: SimulatedPeople, seed: int, tell: Tell = untold
) -> NoPlace:
    """Rehearse an experiment in its folder, restarting the program after each simulated crash.

    Args:
        folder: the folder for log and recordings. It contains no log yet.
        design: the experiment.
        people: properties of the simulated people.
        seed: random seed of all actions of people, and of the log's ids, codes and salts.
        `tell`: receives the present number of valid runs, and the required number.

    Returns:
        The reason why no more people are admitted.

    Raises:
        BadFile: the folder cannot be written.
    """
    clock, chance = RehearsalClock(), random.Random(seed)
    folder.log.parent.mkdir(parents=True, exist_ok=True)
    rehearsal = Rehearsal(design, people, seed, clock, folder.bag, folder.root)
    while True:
        with ExperimentLog(folder.log, chance.randbytes, synced=False) as log, suppress(ProgramCrashed):
            return rehearsal.run(Conductor(design, log, clock, chance.randrange), tell)


class Rehearsal:
    """A rehearsal of one experiment.

    Args:
        design: the experiment.
        people: properties of the simulated people.
        seed: random seed of all actions of people.
        clock: clock of the rehearsal, which advances by the time that people need.
        bag_of: function that returns the path for the recording of a person's step, with this ending.
        root: folder for relative paths of recordings.
    """

    def __init__(
        self,
        design: ExperimentDesign,
        people: SimulatedPeople,
        seed: int,
        clock: RehearsalClock,
        bag_of: Callable[[str, int, str], Path],
        root: Path,
    ) -> None:
        self._design = design
        self._people = people
        self._seed = seed
        self._clock = clock
        self._stream = noise.key(seed, "experiment", "rehearsal")
        self._drawn = 0
        self._bag_of = bag_of
        self._root = root
        self._settings = SettingCache(design.beside)

    def run(self, conductor: Conductor, tell: Tell = untold) -> NoPlace:
        """Let people take part until no place is free. Return the reason. For `tell`, see `rehearse`.

        Raises:
            ProgramCrashed: a simulated crash. The caller continues with a new conductor of the same log.
        """
        conductor.rehearse(self._seed)
        conductor.listeners.append(self._may_crash)
        if self._design.has_groups:
            return self._run_together(conductor, tell)
        while True:
            # First finish the runs that a crash interrupted.
            for run in list(conductor.progress.runs.values()):
                for seconds in self._course(conductor, None, run):
                    self._clock.advance(seconds or 0.0)
            self._report(conductor, tell)
            self._clock.advance(BETWEEN_PEOPLE)
            admitted = conductor.admit()
            if isinstance(admitted, NoPlace):
                return admitted

    def _run_together(self, conductor: Conductor, tell: Tell) -> NoPlace:
        """Let people take part in games of several people; see `run`."""
        together = GroupRehearsal(
            self._design, self._clock, self._people.arrivals, self._course, self._play_together, self._leaves
        )
        return together.run(conductor, lambda: self._report(conductor, tell))

    def _report(self, conductor: Conductor, tell: Tell) -> None:
        tell("people", len(conductor.progress.valid), self._design.allocation.size)

    def _course(self, conductor: Conductor, together: GroupRehearsal | None, run: Run) -> Course:
        """Simulate all remaining steps of a person. Yield the time until the next event of the person, s.

        Args:
            conductor: conductor of the experiment.
            together: the rehearsal of games of several people; None if all games have one participant.
            run: run of the person.
        """
        person = run.participant
        while (step := conductor.begin(person)) is not None:
            if self._draw() < self._people.drop_out:
                conductor.leave(person, "left in a rehearsal")
                break
            if together is not None and seats_of_game(self._design, run.place, step):
                yield from self._join(conductor, together, person, step)
                now = conductor.progress.runs[person]
                if now.state is RunState.UNDER_WAY and step.number not in now.missed:
                    conductor.end(person, step)
                continue
            match step.entry.step:
                case StepKind.FORM | StepKind.CHECK:
                    yield from self._fill_in(conductor, person, step)
                case StepKind.TRIAL:
                    yield from self._play(conductor, person, step)
                case StepKind.PRACTICE:
                    yield PRACTICE
                case StepKind.PAUSE:
                    yield PAUSE
                case _:
                    yield self._reading(step)
            conductor.end(person, step)
        while (step := conductor.debrief(person)) is not None:
            yield self._reading(step)
            conductor.end(person, step)

    def _join(self, conductor: Conductor, together: GroupRehearsal, person: str, step: PlannedStep) -> Course:
        """Let a person wait for a game of several people, and play it. After a crash, resume the person's seat."""
        game = conductor.progress.group_game(person, step)
        if game is None:
            together.enter(person, step)
        elif game.played is not None:
            return
        elif person not in game.present:
            seat = conductor.progress.runs[person].seats[step.number].seat
            conductor.change_seat(EventKind.SEAT_RESUMED, game, seat)
        yield None

    def _reading(self, step: PlannedStep) -> float:
        """Return the time for reading a step's text, s."""
        text = step.entry.text
        words = 0 if text is None else len(read_text(self._design.path.parent / text).split())
        return 60.0 * words / self._people.words_per_minute

    def _fill_in(self, conductor: Conductor, person: str, step: PlannedStep) -> Course:
        form = conductor.form(step)
        # A person has the same tendency in all conditions.
        manner = normal(noise.key(self._seed, "experiment", "manner", person, step.name))
        levels = self._design.levels_at(conductor.progress.runs[person].place.cell, step.condition)
        for item in form.order(self._design.file.seed, person):
            if item.id in conductor.progress.runs[person].given:
                continue
            named: dict[str, JsonValue] = {"item": item.id}
            conductor.tell(EventKind.ITEM_SHOWN, person, step, {**named, **options_shown(item)}, "program")
            limit = item.seconds or math.inf
            reading = min(60.0 * len(item.text.split()) / self._people.words_per_minute, limit)
            yield reading
            conductor.tell(EventKind.ITEM_TOUCHED, person, step, named, "participant")
            answering = self._people.answering * elementary.exp(self._people.hesitation * self._normal())
            yield min(answering, limit - reading)
            answer = self._people.answer(item, levels, manner, self._draw, self._normal)
            if reading + answering < limit:
                conductor.tell(EventKind.ITEM_GIVEN, person, step, {**named, "answer": answer}, "participant")
            else:
                conductor.tell(EventKind.ITEM_TIMED_OUT, person, step, {**named, "answer": None}, "program")

    def _play(self, conductor: Conductor, person: str, step: PlannedStep) -> Course:
        run = conductor.progress.runs[person]
        if not self._people.plays or run.game is not None:
            return
        setting = setting_of_trial(self._design, self._settings, run, step)
        if setting is None:
            return
        if self._people.attitudes:
            who = replace(setting.study.participant, attitude=self._attitude(person))
            setting = self._settings.of(replace(setting.study, participant=who))
        measures, bag = self._record(setting, person, step, step.entry.max_seconds, None)
        yield measures.sim_seconds
        conductor.tell(EventKind.GAME_PLAYED, person, step, played(measures, bag, self._root), "program")

    def _play_together(
        self, run: Run, step: PlannedStep, game: GroupGame, leaving: Mapping[str, float]
    ) -> tuple[dict[str, JsonValue], float]:
        """Play a game of several people; see `GamePlayer`."""
        setting = setting_of_trial(self._design, self._settings, run, step)
        if setting is None:
            return {}, PRACTICE
        if not self._people.plays:
            return {}, 0.0
        if self._people.attitudes:
            people = game.people
            seats = tuple(
                replace(seat, attitude=self._attitude(people[seat.name])) if seat.name in people else seat
                for seat in setting.study.seats
            )
            setting = self._settings.of(replace(setting.study, seats=seats))
        participants = participants_of(setting, game, leaving, self._design.file.lobby.leaving)
        seconds = last_moment(game, leaving, self._design.file.lobby.leaving, step.entry.max_seconds)
        measures, bag = self._record(setting, game.group, step, seconds, participants)
        return played(measures, bag, self._root), measures.sim_seconds

    def _record(
        self, setting: StudySetting, folder: str, step: PlannedStep, seconds: float, participants: Sequence[Role] | None
    ) -> tuple[GameMeasures, Path]:
        """Play and record a game; `folder` is the id of a person or group."""
        bag = self._bag_of(folder, step.number, setting.study.recording.ending)
        bag.parent.mkdir(parents=True, exist_ok=True)
        for part in parts_of(bag):
            part.unlink(missing_ok=True)
        with build_writer(setting, bag) as writer:
            return play_hunt(setting, seconds, [writer], participants=participants), bag

    def _attitude(self, person: str) -> Attitude:
        drawn = noise.uniform(noise.key(self._seed, "experiment", "attitude", person), 0, 0)
        return self._people.attitudes[int(drawn * len(self._people.attitudes))]

    def _leaves(self, step: PlannedStep) -> float | None:
        """Return the time at which a person leaves a game, s, or None."""
        return self._draw() * step.entry.max_seconds if self._draw() < self._people.drop_out else None

    def _may_crash(self, _event: object) -> None:
        if self._people.crashes > 0.0 and self._draw() < self._people.crashes:
            raise ProgramCrashed

    def _normal(self) -> float:
        self._drawn += 1
        return normal(self._stream, self._drawn)

    def _draw(self) -> float:
        self._drawn += 1
        return float(noise.uniform(self._stream, self._drawn, 0))
