"""Engines of batches, as options choose them."""

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
    """Return the engine that options choose; ends the program where that cannot be.

    Args:
        options: of the engine.
        warm: modules that processes of this machine import before their first task.
        log: folder of the files of Slurm's jobs.
    """
    kind, scheduler, job_options = options.engine, options.scheduler, options.job_options or ()
    if kind is not EngineKind.DASK and scheduler is not None:
        fail(BAD_INPUT, "--scheduler: only a Dask cluster has one. Add --engine dask, or leave the option out.")
    if kind is not EngineKind.SLURM and job_options:
        fail(BAD_INPUT, "--slurm: only jobs of Slurm have such options. Add --engine slurm, or leave the option out.")
    if kind is EngineKind.PROCESSES:
        return ProcessEngine(options.processes or usable_cores(), warm)
    if kind is EngineKind.DASK and scheduler is None:
        fail(BAD_INPUT, "--engine dask: where is the cluster? Add --scheduler, such as tcp://127.0.0.1:8786.")
    wrong = next((option for option in job_options if not all(option.partition("="))), None)
    if wrong is not None:
        fail(BAD_INPUT, f"--slurm: {wrong!r} is not KEY=VALUE. Write for example --slurm partition=short.")
    try:
        if kind is EngineKind.DASK:
            from thbridge.batch.engines.dask import DaskEngine

            if is_open_to_others(scheduler or ""):
                note(
                    f"Warning: {scheduler} is another machine, and without TLS. Any machine that reaches the scheduler "
                    "can run programs on its workers and here. Use a tls:// address; see `thbridge docs sweeps`."
                )
            return DaskEngine(scheduler or "")
        from thbridge.batch.engines.slurm import SlurmEngine

        return SlurmEngine(options.jobs, log, dict(option.split("=", 1) for option in job_options))
    except ImportError as missing:
        fail(FAILED, f"--engine {kind}: {missing.name} is not installed. Run: pip install 'thbridge[cluster]'")
    except EngineFailed as reason:
        fail(FAILED, str(reason))


def is_open_to_others(scheduler: str) -> bool:
    """Return True for the address of a scheduler that is reached over a network without TLS."""
    scheme, separator, rest = scheduler.rpartition("://")
    if separator and scheme in {"tls", "wss", "inproc"}:
        return False
    try:
        return not ip_address(urlsplit(f"//{rest}").hostname or "").is_loopback
    except ValueError:
        return rest.partition(":")[0].lower() != "localhost"


@contextmanager
def stopped_by_sigterm() -> Iterator[None]:
    """Have SIGTERM, which batch systems send before they kill, do the same as Ctrl-C."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
