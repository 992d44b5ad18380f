"""`thbridge sweep run` with a display of its progress."""

from collections.abc import Sequence

from thbridge.batch.chunks import Shard
from thbridge.batch.design import SweepDesign
from thbridge.batch.engines.engine import Engine
from thbridge.batch.folder import SweepFolder
from thbridge.batch.sweep import SweepProgress, run_sweep
from thbridge.batch.tasks import SweepTask
from thbridge.files.progress import Tell
from ui.command_line.terminal import note


def run_shown(
    design: SweepDesign, folder: SweepFolder, engine: Engine[SweepTask], shard: Shard, *, retry: bool, tell: Tell
) -> SweepProgress:
    """Run a sweep, and report problems at once. `tell` receives the progress.

    Raises:
        BadFile, EngineFailed: see `run_sweep`.
        KeyboardInterrupt: Ctrl-C or SIGTERM stopped the run.
    """

    def progress(now: SweepProgress, faults: Sequence[str]) -> None:
        # Games of earlier runs would distort the rate of this run.
        tell("games", now.played, now.games - now.before)
        for fault in faults:
            note(fault)

    with engine:
        return run_sweep(design, folder, engine, shard, retry=retry, progress=progress)
