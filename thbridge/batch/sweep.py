"""The run of a sweep: it plays missing games and repeats randomly chosen games. If workers die, the run continues."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from thbridge.batch.chunks import GameChunk, Shard, chunks_of
from thbridge.batch.design import SweepDesign
from thbridge.batch.engines.engine import Engine, EngineFailed, FinishedTask
from thbridge.batch.folder import SweepFolder
from thbridge.batch.results import game_faults
from thbridge.batch.tasks import MOST_DEATHS, SweepTask
from thbridge.study.plugins import plugins_of

EVERYTHING = Shard()
WARM = ("thbridge.batch.tasks",)
"""Modules that workers import before their first task."""


@dataclass(slots=True)
class SweepProgress:
    """Progress of a run.

    Attributes:
        games: number of games in this run's part of the sweep.
        before: number of games that had results before the run.
        played: number of games that this run played.
        failed: number of failed and crashed games among them.
        verified: number of repeated games.
        differing: number of games with another result in the repetition.
        deaths: number of workers that died.
        cpu_seconds: processor time of all tasks, s.
    """

    games: int = 0
    before: int = 0
    played: int = 0
    failed: int = 0
    verified: int = 0
    differing: int = 0
    deaths: int = 0
    cpu_seconds: float = 0.0


def run_sweep(
    design: SweepDesign,
    folder: SweepFolder,
    engine: Engine[SweepTask],
    shard: Shard = EVERYTHING,
    *,
    retry: bool = False,
    progress: Callable[[SweepProgress, Sequence[str]], None] = lambda _progress, _faults: None,
) -> SweepProgress:
    """Play the missing games of a sweep.

    Args:
        design: the design of the sweep.
        folder: the folder of the sweep, opened with this design.
        engine: the engine, inside its context manager.
        shard: part of the sweep to play.
        retry: True to repeat chunks with failed or crashed games.
        progress: function that receives each change of the progress, with sentences about errors.

    Raises:
        BadFile: the folder cannot be written.
        EngineFailed: the engine cannot continue, or too many workers died.
    """
    done, deaths = SweepProgress(), Counter[Path]()
    for task in tasks_of(design, folder, shard.has):
        done.games += len(task.chunk.seeds)
        if retry and task.result.exists() and game_faults(task.result, task.chunk.condition):
            folder.verified(task.chunk).unlink(missing_ok=True)
            task.result.unlink()
        if task.result.exists():
            done.before += len(task.chunk.seeds)
            _verify(engine, task, None)
        else:
            folder.clear(task.chunk)
            engine.submit(task)
    progress(done, ())
    for ended in engine.finished():
        if ended.outcome is None:
            done.deaths += 1
            deaths[ended.task.result] += 1
            _try_again(engine, ended, deaths[ended.task.result])
            progress(done, () if ended.cause is None else (ended.cause,))
            continue
        outcome = ended.outcome
        done.cpu_seconds += outcome.cpu_seconds
        if ended.task.again:
            done.verified += outcome.games
            done.differing += outcome.failed
        else:
            done.played += len(ended.task.chunk.seeds)
            done.failed += outcome.failed
            _verify(engine, ended.task, ended.worker)
        progress(done, outcome.faults if ended.cause is None else (ended.cause, *outcome.faults))
    return done


def tasks_of(design: SweepDesign, folder: SweepFolder, wanted: Callable[[GameChunk], bool]) -> list[SweepTask]:
    """Return the tasks for the wanted chunks."""
    plugins = plugins_of(*(condition.study for condition in design.conditions))
    return [
        SweepTask(
            folder=folder.root.resolve(),
            beside=design.beside.resolve(),
            chunk=chunk,
            study=design.conditions[chunk.condition - 1].study,
            factors=design.columns,
            measures=design.measures,
            max_seconds=design.max_seconds,
            one_bag_in=design.one_bag_in,
            one_verified_in=design.one_verified_in,
            plugins=plugins,
        )
        for chunk in chunks_of(len(design.conditions), design.seeds, design.chunk)
        if wanted(chunk)
    ]


def _verify(engine: Engine[SweepTask], played: SweepTask, worker: str | None) -> None:
    """Submit a chunk's games for repetition to another worker, unless they have already been repeated."""
    task = replace(played, again=True)
    if task.verified_seeds and not task.result.exists():
        engine.submit(task, avoid=worker)


def _try_again(engine: Engine[SweepTask], ended: FinishedTask[SweepTask], deaths: int) -> None:
    """Submit a task again after its worker died. Raise EngineFailed after too many deaths."""
    # Each game of a chunk may kill MOST_DEATHS workers before it is skipped.
    most = MOST_DEATHS if ended.task.again else MOST_DEATHS * len(ended.task.chunk.seeds)
    if deaths > most:
        chunk = ended.task.chunk
        cause = ended.cause or (
            "The cause is unknown. Check the workers' programs, and the machine's log for memory and time limits."
        )
        raise EngineFailed(
            f"{deaths} workers died at chunk {chunk.number} (condition {chunk.condition}). {cause} Finished games are "
            "kept. To play the other games, run the command again."
        )
    engine.submit(ended.task)
