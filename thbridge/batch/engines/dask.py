"""Workers of a Dask cluster (extra `cluster`), which may come, go and die while a sweep runs."""

import os
from collections.abc import Iterator
from typing import Generic

from distributed import Client, as_completed
from distributed.scheduler import KilledWorker
from distributed.worker import get_worker

from thbridge.batch.batch_task import BatchTask, TaskOutcome
from thbridge.batch.engines.engine import EngineFailed, FinishedTask, TaskT

CONNECT_SECONDS = 10.0


class DaskEngine(Generic[TaskT]):
    """Carries out tasks on a Dask cluster, whose workers must see the batch's folder under the same path.

    Args:
        scheduler: its address.

    Raises:
        EngineFailed: nobody answers there.
    """

    def __init__(self, scheduler: str) -> None:
        try:
            self._client = Client(scheduler, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError, TimeoutError, TypeError, RuntimeError) as error:
            reason = f"No Dask scheduler answers at {scheduler} ({error})."
            raise EngineFailed(
                f"{reason} Start one by `dask scheduler`, and workers by `dask worker ADDRESS`."
            ) from None
        self._ended = as_completed([], loop=self._client.loop)
        self._tasks: dict[str, TaskT] = {}
        self._submitted = 0

    def submit(self, task: TaskT, avoid: str | None = None) -> None:
        """See `Engine`."""
        others = None
        if avoid is not None:
            others = [name for name in self._client.scheduler_info(n_workers=-1)["workers"] if name != avoid] or None
        self._submitted += 1
        key = f"thbridge-{os.getpid()}-{self._submitted}"
        future = self._client.submit(
            _carried_out,
            task,
            key=key,
            pure=False,
            workers=others,
            allow_other_workers=others is not None,  # once those named are gone
            priority=int(task.urgent),  # so that a difference shows early
        )
        self._tasks[key] = task
        self._ended.add(future)

    def finished(self) -> Iterator[FinishedTask[TaskT]]:
        """See `Engine`."""
        while self._tasks:
            future = next(self._ended)
            task = self._tasks.pop(future.key)
            if future.status == "cancelled":
                raise EngineFailed("The Dask cluster has closed. A further run goes on where this one ended.")
            fault = future.exception() if future.status == "error" else None
            if isinstance(fault, KilledWorker):
                yield FinishedTask(task, None, "")
            elif fault is not None:
                raise fault
            else:
                worker, outcome = future.result()
                future.release()
                yield FinishedTask(task, outcome, worker)

    def __enter__(self) -> "DaskEngine[TaskT]":
        return self

    def __exit__(self, *ended: object) -> None:
        self._client.close()


def _carried_out(task: BatchTask) -> tuple[str, TaskOutcome]:
    """Carry out a task, and return the worker that did it."""
    return get_worker().address, task.carry_out()
