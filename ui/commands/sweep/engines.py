"""Engine of a batch, as chosen by options."""

import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from ipaddress import ip_address
from pathlib import Path
from urllib.parse import urlsplit

from thbridge.batch.engines.engine import Engine, EngineFailed, TaskT
from thbridge.batch.engines.processes import ProcessEngine
from ui.command_line.options import EngineKind, EngineOptions
from ui.command_line.terminal import BAD_INPUT, FAILED, fail, note
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

            if is_open_to_others(scheduler or ""):
                note(
                    f"Warning: {scheduler} is another machine, reached without TLS. Any machine that reaches the "
                    "scheduler can run programs on its workers and on this computer. Use a tls:// address; see "
                    "`thbridge docs sweeps`."
                )
            return DaskEngine(scheduler or "")
        from thbridge.batch.engines.slurm import SlurmEngine

        return SlurmEngine(options.jobs, log, dict(option.split("=", 1) for option in job_options))
    except ImportError as missing:
        fail(FAILED, f"--engine {kind}: {missing.name} is not installed. Run: pip install 'thbridge[cluster]'")
    except EngineFailed as reason:
        fail(FAILED, str(reason))


def is_open_to_others(scheduler: str) -> bool:
    """Return True if the scheduler at this address is reached over a network without TLS."""
    scheme, separator, rest = scheduler.rpartition("://")
    if separator and scheme in {"tls", "wss", "inproc"}:
        return False
    try:
        return not ip_address(urlsplit(f"//{rest}").hostname or "").is_loopback
    except ValueError:
        return rest.partition(":")[0].lower() != "localhost"


@contextmanager
def stopped_by_sigterm() -> Iterator[None]:
    """Handle SIGTERM like Ctrl-C, because batch systems send SIGTERM before they kill a process."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
