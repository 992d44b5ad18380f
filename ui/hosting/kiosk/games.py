"""Games of a study with people, which are played in the person's window, recorded, and resumed after a crash."""

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Protocol

from sim.common.observations import TICK, TICKS_PER_SECOND
from thbridge.app import play as hunt
from thbridge.app.compose.setting import StudySetting
from thbridge.app.listeners import WatchAddress
from thbridge.app.play import FINAL_TICKS, Checkpoints, HuntOutcome, HuntUnfinished, PlayOptions
from thbridge.app.session.input_log import GameDiffers
from thbridge.app.session.session import TickRecord
from thbridge.batch.measures import GameObserver
from thbridge.batch.settings import SettingCache
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import PracticeTerm
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Run
from thbridge.experiment.recordings import moved_aside
from thbridge.experiment.store.events import JsonValue
from thbridge.experiment.trials import PracticeCount, played, setting_of_practice, setting_of_trial
from thbridge.files.disk.synced import make_folder
from thbridge.files.errors import BadFile, reason_of
from thbridge.recording.recordings import make_room
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.timing.pace_meter import GamePace, PaceMeter
from ui.first_start.compiling import compile_ahead

SEEN_WITHIN = 10 * TICKS_PER_SECOND
"""Maximum number of ticks for which the program waits until the window shows the end of a game."""


class KioskStopped(Exception):  # noqa: N818 - nothing went wrong with the program
    """The program was stopped (Ctrl-C, SIGTERM), or the window was closed on purpose."""


class GameWatcher(Protocol):
    """Interface of the host that leads a person through a game."""

    def ready(self, where: ListeningAddress) -> None:
        """Make the window join the game at this address."""

    def passed(self, seconds: float, lag: float, left: float) -> None:
        """Receive the times after each tick, all in seconds.

        Args:
            seconds: simulated time.
            lag: time by which the game is behind real time.
            left: real time until the game must end.
        """

    def still_to_do(self, missing: Mapping[PracticeTerm, float]) -> None:
        """Receive the remaining tasks of a practice game, before `passed` in each tick."""

    def time_is_up(self) -> None:
        """Show the person that the time of the game is over."""

    def has_left(self) -> bool:
        """Return True if the person has left the game, or if the run or the program ends."""

    def has_seen_end(self) -> bool:
        """Return True if the window shows the end of the game."""

    def broken_off(self, bag: Path | None) -> None:
        """Record that a game is abandoned; `bag` is the new path of its recording, or None."""

    def cut_off(self, bag: Path) -> None:
        """Record once that a recording is incomplete, because its program ended, and that the game is resumed."""


class StudyGames:
    """Runner of the games of one study.

    Args:
        folder: folder of the study.
        design: design of the study.
        checkpoints: copies of this process, which continue a game if the process is killed; None for none.
        watch: address for researchers' windows; None if no window can connect.
        ticks_at_once: see `PlayOptions`.
    """

    def __init__(
        self,
        folder: ExperimentFolder,
        design: ExperimentDesign,
        checkpoints: Checkpoints | None = None,
        watch: WatchAddress | None = None,
        ticks_at_once: int = 1,
    ) -> None:
        self._ticks_at_once = ticks_at_once
        self._checkpoints = checkpoints
        self._watch = watch
        self._folder = folder
        self._design = design
        self._settings = SettingCache(design.beside)

    async def practise(self, run: Run, step: PlannedStep, watcher: GameWatcher) -> PracticeCount:
        """Play the practice game, which is not recorded; return the counts of the person's actions."""
        setting = setting_of_practice(self._design, self._settings, run, step)
        count = PracticeCount(step, setting)

        def record(moment: TickRecord) -> None:
            count.record(moment)
            watcher.still_to_do(count.missing)

        watcher.still_to_do(count.missing)
        await self._play(setting, self._options(step, setting.study.rate, None), watcher, record)
        return count

    async def play(
        self,
        run: Run,
        step: PlannedStep,
        watcher: GameWatcher,
        *,
        goes_on: bool,
        group: str = "",
        seats: frozenset[str] | None = None,
    ) -> dict[str, JsonValue] | None:
        """Play the game of a person or a group, or resume a game that was interrupted.

        Args:
            run: run of the person, or of a person of the group.
            step: step of the trial.
            watcher: host of the people.
            goes_on: True to resume the game that an earlier process began; False to start the game again.
            group: id of the group; empty for a game with one participant.
            seats: see `PlayOptions`.

        Returns:
            The game's entry in the log; None if a game with one participant did not reach its end. A group has an
            entry also then, because only a part of its people may have left.

        Raises:
            BadFile: the game cannot be recorded.
            KioskStopped: Ctrl-C or SIGTERM stopped the program.
            ParticipantDeclined: the person did not agree to the study's own consent text.
        """
        setting = setting_of_trial(self._design, self._settings, run, step)
        if setting is None:
            return None
        bag = self._folder.bag(group or run.participant, step.number, setting.study.recording.ending)
        attempt = run.begun.get(step.number, 1)
        if attempt > 1 and not group:
            # The log contains the path of the earlier attempt's recording.
            bag = bag.with_stem(f"{bag.stem}-attempt-{attempt}")
        log = _inputs_of(bag)
        try:
            make_folder(bag.parent)
            earlier = make_room(bag)
            if not goes_on or (earlier is not None and not log.exists()):
                _break_off(log, bag, earlier, watcher)
            # These include recordings of programs that died before the end of the game.
            for left in moved_aside(bag):
                watcher.cut_off(left)
            options = replace(self._options(step, setting.study.rate, bag), seats=seats)
            keeps_part = bool(group)
            try:
                observer = GameObserver()
                ended = await self._play(setting, options, watcher, observer.record, keeps_part=keeps_part)
            except GameDiffers:
                # The log of inputs is from another release or another version of the study, so the game cannot resume.
                make_room(bag)
                _break_off(log, bag, earlier, watcher)
                observer = GameObserver()
                ended = await self._play(setting, options, watcher, observer.record, keeps_part=keeps_part)
        except OSError as error:
            raise BadFile(bag, f"cannot be recorded ({reason_of(error)})", "Free disk space") from None
        if ended is None:
            return None
        outcome, pace = ended
        return await asyncio.to_thread(played, observer.measures(outcome), bag, self._folder.root, pace)

    def _options(self, step: PlannedStep, rate: float | None, bag: Path | None) -> PlayOptions:
        log = None if bag is None else _inputs_of(bag)
        return PlayOptions(
            rate or 1.0,
            bag,
            frozenset(),
            "",
            step.entry.max_seconds,
            watch=self._watch,
            inputs=log,
            checkpoints=self._checkpoints,
            ticks_at_once=self._ticks_at_once,
        )

    async def _play(
        self,
        setting: StudySetting,
        options: PlayOptions,
        watcher: GameWatcher,
        record: Callable[[TickRecord], None],
        *,
        keeps_part: bool = False,
    ) -> tuple[HuntOutcome, GamePace] | None:
        """Play a game and record each tick.

        If the game does not reach its end, return its outcome so far if `keeps_part` is True, and None otherwise.
        """
        over_at, last = 0, int(options.max_seconds * TICKS_PER_SECOND)
        meter = PaceMeter()
        warned = ended = False

        def ready(where: ListeningAddress | CannotListen) -> None:
            if isinstance(where, CannotListen):
                raise BadFile(self._folder.file, str(where), "Close the other program, or write server.port: 0")
            watcher.ready(where)

        def progress(moment: TickRecord) -> None:
            nonlocal over_at, warned, ended
            record(moment)
            watcher.passed(moment.tick * TICK, meter.state.lag, (last - moment.tick) * TICK / options.rate)
            if over_at == 0 and moment.game is not None and moment.game.ended is not None:
                over_at = moment.tick
            if over_at:
                since = moment.tick - over_at
                ended = since >= FINAL_TICKS and (watcher.has_seen_end() or since >= SEEN_WITHIN)
            elif not warned and moment.tick >= last - FINAL_TICKS:
                warned = True
                watcher.time_is_up()

        def left() -> bool:
            return watcher.has_left() or ended

        await asyncio.to_thread(compile_ahead, whole_hunt=True)
        try:
            outcome = await hunt.play(setting, (), replace(options, left=left, meter=meter), ready, progress)
        except HuntUnfinished as early:
            if early.stopped:
                raise KioskStopped from None
            return (early.outcome, meter.pace()) if warned or keeps_part else None
        return outcome, meter.pace()


def _inputs_of(bag: Path) -> Path:
    """Return the path of the log of inputs, with which a game is resumed."""
    return bag.with_suffix(".inputs")


def _break_off(log: Path, bag: Path, earlier: Path | None, watcher: GameWatcher) -> None:
    """Keep the files of an abandoned game; do nothing if there are no files.

    Args:
        log: log of the abandoned game's inputs.
        bag: path of the recording of the new game.
        earlier: new path of the abandoned game's recording. If None, there is no recording.
        watcher: host that is notified.
    """
    if log.exists():
        log.rename(_inputs_of(earlier or log.with_stem(f"{log.stem}-0")))
    elif earlier is None:
        return
    of_it = () if earlier is None else (path for path in moved_aside(bag) if path.name.startswith(earlier.name))
    watcher.broken_off(next(iter(of_it), earlier))
