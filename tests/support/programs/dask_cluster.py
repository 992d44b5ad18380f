"""Dask cluster of programs: a scheduler, and workers that join it."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from tests.support.programs.processes import until
from tests.support.project import ROOT


class DaskCluster:
    """Dask cluster.

    Args:
        folder: folder for its files.
        stack: ends its programs.
        security: options of the scheduler and the workers about TLS.
        environment: further environment variables.
    """

    def __init__(self, folder: Path, stack: ExitStack, security: Sequence[str], environment: dict[str, str]) -> None:
        self._stack = stack
        self._folder = folder
        self._security = security
        self._environment = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
        self._place = folder / "scheduler.json"

    @property
    def address(self) -> str:
        """Address of the scheduler, once it is there."""
        until("the scheduler", lambda: self._place.exists() and self._place.read_text() != "", [])
        return str(json.loads(self._place.read_text())["address"])

    def schedule(self, *options: str, by: Sequence[str] = ()) -> None:
        """Start the scheduler."""
        self._start("dask_scheduler", "--port", "0", *options, by=by)

    def join(self, *options: str, by: Sequence[str] = ()) -> "subprocess.Popen[bytes]":
        """Start a worker."""
        return self._start("dask_worker", "--no-nanny", *options, by=by)

    def _start(self, role: str, *options: str, by: Sequence[str]) -> "subprocess.Popen[bytes]":
        words = ("--no-dashboard", "--scheduler-file", str(self._place), *self._security)
        command = [*by, sys.executable, "-m", f"distributed.cli.{role}", *options, *words]
        with (self._folder / f"{role}.txt").open("ab") as output:
            program = subprocess.Popen(command, env=self._environment, cwd=self._folder, stdout=output, stderr=output)
        self._stack.callback(program.wait)
        self._stack.callback(program.kill)
        return program


@contextmanager
def dask_cluster(folder: Path, *security: str, **environment: str) -> Iterator[DaskCluster]:
    """Yield a cluster without programs; those that it starts end with this context."""
    with ExitStack() as stack:
        yield DaskCluster(folder, stack, security, environment)
