"""The run of `thbridge sweep`, with a bar of progress."""

import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn, TimeRemainingColumn
from rich.text import Text

from thbridge.batch.chunks import Shard
from thbridge.batch.design import SweepDesign
from thbridge.batch.engines.engine import Engine, EngineFailed
from thbridge.batch.engines.processes import ProcessEngine
from thbridge.batch.folder import SweepFolder
from thbridge.batch.sweep import SweepProgress, run_sweep
from ui.terminal import BAD_INPUT, FAILED, err, fail, note


def chosen_engine(
    kind: str, *, processes: int, scheduler: str | None, jobs: int, job_options: Sequence[str], log: Path
) -> Engine:
    """Return the engine that options choose; ends the program where that cannot be."""
    if kind != "dask" and scheduler is not None:
        fail(BAD_INPUT, "--scheduler: only a Dask cluster has one. Add --engine dask, or leave the option out.")
    if kind != "slurm" and job_options:
        fail(BAD_INPUT, "--slurm: only jobs of Slurm have such options. Add --engine slurm, or leave the option out.")
    if kind == "processes":
        return ProcessEngine(processes)
    if kind == "dask" and scheduler is None:
        fail(BAD_INPUT, "--engine dask: where is the cluster? Add --scheduler, such as tcp://10.0.0.1:8786.")
    wrong = next((option for option in job_options if not all(option.partition("="))), None)
    if wrong is not None:
        fail(BAD_INPUT, f"--slurm: {wrong!r} is not KEY=VALUE. Write for example --slurm partition=short.")
    try:
        if kind == "dask":
            from thbridge.batch.engines.dask import DaskEngine  # noqa: PLC0415 - an extra

            return DaskEngine(scheduler or "")
        from thbridge.batch.engines.slurm import SlurmEngine  # noqa: PLC0415 - an extra

        options = dict(option.split("=", 1) for option in job_options)
        return SlurmEngine(jobs, log, options)
    except ImportError as missing:
        fail(FAILED, f"--engine {kind}: {missing.name} is not installed. Run: pip install 'thbridge[cluster]'")
    except EngineFailed as reason:
        fail(FAILED, str(reason))


def run_shown(design: SweepDesign, folder: SweepFolder, engine: Engine, shard: Shard, *, retry: bool) -> SweepProgress:
    """Run a sweep with a bar of progress; what goes wrong is told at once.

    Raises:
        BadFile, EngineFailed: as `run_sweep`.
        KeyboardInterrupt: it was stopped, by Ctrl-C or SIGTERM.
    """
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        _RateColumn(),
        TimeRemainingColumn(elapsed_when_finished=True),
    )
    bar = Progress(*columns, console=err, transient=True, disable=not err.is_terminal, speed_estimate_period=600.0)
    with _stopped_by_sigterm(), bar, engine:
        games = bar.add_task("games", total=design.games)
        before = True

        def progress(now: SweepProgress, faults: Sequence[str]) -> None:
            nonlocal before
            if before:
                # Games of earlier runs tell nothing about the rate of this one.
                before = False
                bar.update(games, total=now.games - now.before)
            bar.update(games, completed=now.played)
            for fault in faults:
                note(fault)

        return run_sweep(design, folder, engine, shard, retry=retry, progress=progress)


@contextmanager
def _stopped_by_sigterm() -> Iterator[None]:
    """Have SIGTERM, which batch systems send before they kill, do the same as Ctrl-C."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


class _RateColumn(ProgressColumn):
    """Games a second."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:.2f}/s")
