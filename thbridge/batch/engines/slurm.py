"""Engine for Slurm jobs, with submitit (extra `cluster`)."""

import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Generic, TypeAlias

import submitit

from thbridge.batch.engines.batch_task import BatchTask, TaskOutcome, worker_name
from thbridge.batch.engines.engine import FinishedTask, TaskT

POLL_SECONDS = 1.0
"""Seconds between two checks of the jobs."""
_Job: TypeAlias = "submitit.Job[tuple[str, list[TaskOutcome]]]"
STANDARD_OPTIONS = {"cpus_per_task": "1"}


class SlurmEngine(Generic[TaskT]):
    """Engine that uses Slurm jobs. It divides waiting tasks among the jobs of an array.

    Args:
        jobs: maximum number of jobs.
        log: folder for submitit's files.
        options: options of `sbatch`, by long name.
        cluster: "slurm", or for tests without Slurm "local" or "debug".
    """

    def __init__(self, jobs: int, log: Path, options: Mapping[str, str], cluster: str = "slurm") -> None:
        self._jobs = jobs
        self._executor = submitit.AutoExecutor(folder=log, cluster=cluster)
        given = {**STANDARD_OPTIONS, **options}
        self._executor.update_parameters(**{f"slurm_{name.replace('-', '_')}": value for name, value in given.items()})
        self._waiting: list[TaskT] = []
        self._running: list[tuple[_Job, Sequence[TaskT]]] = []

    def submit(self, task: TaskT, avoid: str | None = None) -> None:
        """See `Engine`. Every job counts as a different worker."""
        self._waiting.append(task)

    def finished(self) -> Iterator[FinishedTask[TaskT]]:
        """See `Engine`."""
        while self._waiting or self._running:
            # New tasks, such as repetitions of games, wait until all running jobs have ended.
            if not self._running:
                self._start()
            for job, tasks in [each for each in self._running if each[0].done()]:
                self._running.remove((job, tasks))
                yield from _ended(job, tasks)
            if self._running:
                time.sleep(POLL_SECONDS)

    def __enter__(self) -> "SlurmEngine[TaskT]":
        return self

    def __exit__(self, *ended: object) -> None:
        for job, _ in self._running:
            job.cancel(check=False)

    def _start(self) -> None:
        waiting, self._waiting = self._waiting, []
        bundles = [waiting[first :: self._jobs] for first in range(min(self._jobs, len(waiting)))]
        jobs = self._executor.map_array(_carried_out, bundles)
        self._running = list(zip(jobs, bundles, strict=True))


def _carried_out(tasks: Sequence[BatchTask]) -> tuple[str, list[TaskOutcome]]:
    """Carry out the tasks of a job. Return the name of its worker and the outcomes."""
    return worker_name(), [task.carry_out() for task in tasks]


def _ended(job: _Job, tasks: Sequence[TaskT]) -> Iterator[FinishedTask[TaskT]]:
    """Yield the tasks of an ended job, or raise the exception of a task."""
    fault = job.exception()
    if fault is None:
        worker, outcomes = job.result()
        yield from (FinishedTask(task, outcome, worker) for task, outcome in zip(tasks, outcomes, strict=True))
        return
    if not isinstance(fault, submitit.core.utils.UncompletedJobError):
        raise fault
    # The job was killed or reached its time limit, so another job runs its tasks.
    for task in tasks:
        yield FinishedTask(task, None, job.job_id)
