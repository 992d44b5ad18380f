"""Engine of a batch, as chosen by options."""

from collections.abc import Sequence
from pathlib import Path

from thbridge.batch.engines.engine import Engine, EngineFailed, TaskT
from thbridge.batch.engines.processes import ProcessEngine
from ui.command_line.options import EngineKind, EngineOptions
from ui.command_line.schedulers import warn_if_open
from ui.command_line.terminal import BAD_INPUT, FAILED, fail
from ui.first_start.compiling import usable_cores


def chosen_engine(options: EngineOptions, warm: Sequence[str], log: Path) -> Engine[TaskT]:
    """Return the engine that options choose; end the program if the options are inconsistent.

    Args:
        options: options of the engine.
        warm: modules that worker processes on this machine import before their first task.
        log: folder for the files of Slurm jobs.
    """
    kind, scheduler, job_options = options.engine, options.scheduler, options.job_options or ()
    if kind is not EngineKind.DASK and scheduler is not None:
        fail(BAD_INPUT, "--scheduler: only a Dask cluster has a scheduler. Add --engine dask, or omit the option.")
    if kind is not EngineKind.SLURM and job_options:
        fail(BAD_INPUT, "--slurm: this option is only for Slurm jobs. Add --engine slurm, or omit the option.")
    if kind is EngineKind.PROCESSES:
        return ProcessEngine(options.processes or usable_cores(), warm)
    if kind is EngineKind.DASK and scheduler is None:
        fail(
            BAD_INPUT,
            "--engine dask: the address of the cluster is missing. Add --scheduler, such as tcp://127.0.0.1:8786.",
        )
    wrong = next((option for option in job_options if not all(option.partition("="))), None)
    if wrong is not None:
        fail(BAD_INPUT, f"--slurm: {wrong!r} is not KEY=VALUE. Write, for example, --slurm partition=short.")
    try:
        if kind is EngineKind.DASK:
            from thbridge.batch.engines.dask import DaskEngine

            warn_if_open(scheduler or "")
            return DaskEngine(scheduler or "")
        from thbridge.batch.engines.slurm import SlurmEngine

        return SlurmEngine(options.jobs, log, dict(option.split("=", 1) for option in job_options))
    except ImportError as missing:
        fail(FAILED, f"--engine {kind}: {missing.name} is not installed. Run: pip install 'thbridge[cluster]'")
    except EngineFailed as reason:
        fail(FAILED, str(reason))
