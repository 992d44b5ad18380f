"""The run of `thbridge sweep`, with a bar of progress."""

from collections.abc import Sequence

from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn, TimeRemainingColumn
from rich.text import Text

from thbridge.batch.chunks import Shard
from thbridge.batch.design import SweepDesign
from thbridge.batch.engines.engine import Engine
from thbridge.batch.folder import SweepFolder
from thbridge.batch.sweep import SweepProgress, run_sweep
from thbridge.batch.tasks import SweepTask
from ui.actions.engines import stopped_by_sigterm
from ui.terminal import err, note


def run_shown(
    design: SweepDesign, folder: SweepFolder, engine: Engine[SweepTask], shard: Shard, *, retry: bool
) -> SweepProgress:
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
    with stopped_by_sigterm(), bar, engine:
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


class _RateColumn(ProgressColumn):
    """Games a second."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:.2f}/s")
