"""Tasks of a sweep. A task plays a chunk, or repeats randomly chosen games of a chunk."""

import time
import traceback
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from threading import Lock

from thbridge.app.compose.recording import build_writer
from thbridge.batch.chunks import GameChunk, is_drawn
from thbridge.batch.ended_games import keep_ended, read_ended
from thbridge.batch.engines.batch_task import TaskOutcome, worker_name
from thbridge.batch.folder import SweepFolder
from thbridge.batch.hunt import RecordedDigest, play_hunt
from thbridge.batch.results import (
    FactorColumns,
    GameResult,
    GameStatus,
    Verification,
    differing_games,
    game_faults,
    read_digests,
    write_games,
    write_verified,
)
from thbridge.batch.settings import SettingCache
from thbridge.files.disk.own_links import own_target
from thbridge.files.disk.regular_files import content_of
from thbridge.files.errors import BadFile, reason_of
from thbridge.recording.append import append_whole
from thbridge.recording.recordings import finished_of, unfinished_of
from thbridge.study.study_file import Study

MOST_DEATHS = 2
"""Number of workers that may die during the same game. Then the game is skipped and marked as crashed."""

_playing = Lock()
"""Lock for all threads of a process, so that only one game runs at a time."""


@dataclass(frozen=True, slots=True)
class SweepTask:
    """Task for one chunk.

    Attributes:
        folder: folder of the sweep. The worker needs write access.
        `beside`: the folder for relative paths in the study.
        chunk: the games of the task.
        study: study of the games' condition.
        factors: columns of the results for the factors.
        measures: names of the measures in the results.
        max_seconds: simulated time after which an unfinished game stops.
        one_bag_in: N if one game in N is recorded; 0 if no game is recorded.
        one_verified_in: N if one game in N is repeated; 0 if no game is repeated.
        again: True to repeat randomly chosen games and compare the results.
        plugins: keys of the plug-ins that the sweep's studies name. Their versions are recorded.
    """

    folder: Path
    beside: Path
    chunk: GameChunk
    study: Study
    factors: FactorColumns
    measures: tuple[str, ...]
    max_seconds: float
    one_bag_in: int
    one_verified_in: int
    again: bool = False
    plugins: tuple[str, ...] = ()

    @property
    def verified_seeds(self) -> tuple[int, ...]:
        """Random seeds of the games that are repeated."""
        return tuple(seed for seed in self.chunk.seeds if self._is_drawn("verified", self.one_verified_in, seed))

    @property
    def recorded_seeds(self) -> tuple[int, ...]:
        """Random seeds of the games that are recorded."""
        return tuple(seed for seed in self.chunk.seeds if self._is_drawn("recorded", self.one_bag_in, seed))

    @property
    def result(self) -> Path:
        """The file that exists after the task is done."""
        folder = SweepFolder(self.folder)
        return folder.verified(self.chunk) if self.again else folder.games(self.chunk)

    @property
    def urgent(self) -> bool:
        """See `BatchTask`. Repetitions have priority, so that differences are found early."""
        return self.again

    def carry_out(self, most: int | None = None) -> TaskOutcome:
        """See `BatchTask`."""
        with _playing:
            began, left = time.process_time(), 0
            # The file already exists if an earlier worker wrote it and died before its answer.
            if not self.result.exists():
                if self.again:
                    _verify(self)
                else:
                    left = _play(self, most)
            if left:
                return TaskOutcome(0, 0, (), time.process_time() - began, left)
            faults = (differing_games if self.again else game_faults)(self.result, self.chunk.condition)
            games = len(self.verified_seeds if self.again else self.chunk.seeds)
            return TaskOutcome(games, len(faults), tuple(faults), time.process_time() - began)

    def _is_drawn(self, purpose: str, one_in: int, seed: int) -> bool:
        return is_drawn(purpose, one_in, self.chunk.condition, seed)


def _play(task: SweepTask, most: int | None) -> int:
    """Play at most `most` games of a chunk. Return the number of remaining games."""
    folder, games = SweepFolder(task.folder), dict[int, GameResult]()
    journal, kept = folder.attempts(task.chunk), folder.ended(task.chunk)
    deaths, ended = _deaths(journal), read_ended(folder, kept, task.plugins)
    left = [seed for seed in task.chunk.seeds if seed not in ended]
    _note(journal, f"{ATTEMPT} {worker_name()}")
    for seed in left[:most]:
        if deaths[seed] >= MOST_DEATHS:
            fault = f"{deaths[seed]} workers died during this game"
            games[seed] = GameResult(seed, GameStatus.CRASHED, fault, worker=worker_name())
            continue
        _note(journal, str(seed))
        games[seed] = _game(task, seed, recorded=seed in task.recorded_seeds, hashed=seed in task.verified_seeds)
        if games[seed].fault is None:
            keep_ended(kept, games[seed], task.plugins)
    games |= ended
    if len(games) < len(task.chunk.seeds):
        _note(journal, ENDED)
        return len(task.chunk.seeds) - len(games)
    result = [games[seed] for seed in task.chunk.seeds]
    write_games(folder.games(task.chunk), result, task.chunk.condition, task.factors, task.measures, task.plugins)
    for path in (journal, kept):
        path.unlink(missing_ok=True)
    return 0


def _verify(task: SweepTask) -> None:
    """Repeat the randomly chosen games of a chunk."""
    folder = SweepFolder(task.folder)
    first = read_digests(folder.games(task.chunk))
    games = []
    for seed in task.verified_seeds:
        said, by = first[seed]
        if said is None:
            continue  # The first game had no result.
        again = _game(task, seed, recorded=False, hashed=True)
        games.append(Verification(seed, said, again.messages, by, worker_name()))
    write_verified(folder.verified(task.chunk), games, task.plugins)


def _game(task: SweepTask, seed: int, *, recorded: bool, hashed: bool) -> GameResult:
    """Play a game. Most exceptions end only this game. A BadFile or OSError (such as a full disk) ends the task."""
    began = time.process_time()
    setting = _settings(task.beside).of(replace(task.study, seed=seed))
    said = RecordedDigest(setting.study.recording)
    ending = setting.study.recording.ending
    bag = SweepFolder(task.folder).bag(task.chunk.condition, seed, ending) if recorded else None
    try:
        if bag is None:
            measures = play_hunt(setting, task.max_seconds, [said] if hashed else [])
        else:
            bag.parent.mkdir(parents=True, exist_ok=True)
            while (left := unfinished_of(bag)) is not None:
                left.unlink()
            for left in finished_of(bag):
                left.unlink()
            with build_writer(setting, bag) as writer:
                measures = play_hunt(setting, task.max_seconds, [said, writer])
    except (BadFile, OSError):
        raise
    except Exception as fault:
        place = traceback.extract_tb(fault.__traceback__)[-1]
        error = f"{type(fault).__name__}: {fault} ({Path(place.filename).name}, line {place.lineno})"
        return GameResult(seed, GameStatus.FAILED, error, worker=worker_name(), cpu_seconds=_since(began))
    return GameResult(
        seed=seed,
        status=GameStatus.OUT_OF_TIME if measures.over is None else GameStatus.ENDED,
        messages=said.hexdigest() if hashed or recorded else None,
        bag=None if bag is None else bag.relative_to(task.folder).as_posix(),
        worker=worker_name(),
        cpu_seconds=_since(began),
        measures=measures,
    )


def _since(began: float) -> float:
    return round(time.process_time() - began, 4)


@cache
def _settings(beside: Path) -> SettingCache:
    """Return the cache of settings of this process."""
    return SettingCache(beside)


ATTEMPT = "attempt"
"""First word of the first line of an attempt; the worker's name follows. Further lines are seeds of started games."""
ENDED = "ended"
"""Last line of an attempt that ended before all games were played."""


_LARGEST_JOURNAL = 1 << 24
"""Largest size of a journal, in bytes. A journal has one line for each started game."""


def _note(journal: Path, line: str) -> None:
    """Append a line to a journal of attempts. Raises BadFile if it cannot be written."""
    try:
        journal.parent.mkdir(parents=True, exist_ok=True)
        with own_target(journal).open("ab", buffering=0) as file:
            append_whole(file, f"{line}\n".encode(), synced=False)
    except OSError as error:
        remedy = "free some space, then run the command again"
        raise BadFile(journal, f"it cannot be written ({reason_of(error)})", remedy) from None


def begun_game(journal: Path) -> tuple[str, int] | None:
    """Return the worker and seed of the game that was started last.

    Return None if the last attempt has started no game or has ended.

    Raises:
        BadFile: the file is not a journal.
    """
    try:
        lines = content_of(journal, _LARGEST_JOURNAL).decode().rpartition(ATTEMPT)[2].splitlines()
        return (lines[0].strip(), int(lines[-1])) if len(lines) > 1 and lines[-1] != ENDED else None
    except FileNotFoundError:
        return None
    except (OSError, ValueError):
        remedy = "Delete this file, and run the sweep again"
        raise BadFile(journal, "this is not a journal of attempts", remedy) from None


def _deaths(journal: Path) -> Mapping[int, int]:
    """Return the number of attempts that were interrupted during each game, by seed.

    Raises:
        BadFile: the file is not a journal.
        OSError: the file cannot be read.
    """
    remedy = "Delete this file, and run the sweep again: the file only counts dead workers"
    try:
        text = content_of(journal, _LARGEST_JOURNAL).decode()
        attempts = [attempt.splitlines() for attempt in text.split(ATTEMPT)[1:]]
        return Counter(int(lines[-1]) for lines in attempts if len(lines) > 1 and lines[-1] != ENDED)
    except FileNotFoundError:
        return Counter()
    except BadFile as fault:
        raise BadFile(journal, fault.problem, remedy) from None
    except ValueError:
        raise BadFile(journal, "this is not a journal of attempts", remedy) from None
