"""Engine for the workers of a Dask cluster (extra `cluster`). Workers may join, leave or die while a sweep runs."""

import os
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Generic

from distributed import Client, as_completed
from distributed.scheduler import KilledWorker
from distributed.worker import get_worker

from thbridge.batch.engines.batch_task import BatchTask, TaskOutcome
from thbridge.batch.engines.engine import EngineFailed, FinishedTask, TaskT

CONNECT_SECONDS = 10.0


class DaskEngine(Generic[TaskT]):
    """Engine that uses a Dask cluster. The batch's folder must have the same path on all workers.

    Args:
        scheduler: address of the scheduler.

    Raises:
        EngineFailed: no scheduler answers at this address.
    """

    def __init__(self, scheduler: str) -> None:
        try:
            self._client = Client(scheduler, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError, TimeoutError, TypeError, RuntimeError) as error:
            reason = f"No Dask scheduler answers at {scheduler} ({error})."
            raise EngineFailed(
                f"{reason} Start a scheduler with `dask scheduler`, and workers with `dask worker ADDRESS`."
            ) from None
        self._ended = as_completed([], loop=self._client.loop)
        self._tasks: dict[str, _DaskTask[TaskT]] = {}
        self._submitted = 0
        self._causes: deque[str] = deque(maxlen=1)
        self._client.subscribe_topic("scheduler", self._hear)

    def submit(self, task: TaskT, avoid: str | None = None) -> None:
        """See `Engine`."""
        others = None
        if avoid is not None:
            others = [name for name in self._client.scheduler_info(n_workers=-1)["workers"] if name != avoid] or None
        self._submit(_DaskTask(task), others)

    def finished(self) -> Iterator[FinishedTask[TaskT]]:
        """See `Engine`."""
        while self._tasks:
            future = next(self._ended)
            sent = self._tasks.pop(future.key)
            if future.status == "cancelled":
                raise EngineFailed("The Dask cluster was closed. To continue the sweep, run the command again.")
            fault = future.exception() if future.status == "error" else None
            if isinstance(fault, KilledWorker):
                yield FinishedTask(sent.task, None, "", self._cause())
            elif fault is not None:
                raise fault
            else:
                worker, outcome = future.result()
                future.release()
                cpu_seconds = sent.cpu_seconds + outcome.cpu_seconds
                if outcome.left:
                    # The same worker continues, so that a different worker can verify its games.
                    self._submit(_DaskTask(sent.task, 2 * sent.most, cpu_seconds), [worker])
                else:
                    yield FinishedTask(sent.task, replace(outcome, cpu_seconds=cpu_seconds), worker, self._cause())

    def _submit(self, sent: "_DaskTask[TaskT]", workers: list[str] | None) -> None:
        self._submitted += 1
        key = f"thbridge-{os.getpid()}-{self._submitted}"
        future = self._client.submit(
            _carried_out,
            sent.task,
            sent.most,
            key=key,
            pure=False,
            workers=workers,
            allow_other_workers=workers is not None,  # The named workers may have left.
            priority=int(sent.task.urgent),
        )
        self._tasks[key] = sent
        self._ended.add(future)

    def _hear(self, event: tuple[float, Mapping[str, object]]) -> None:
        """Store the reason why the scheduler ended a worker. Only this event contains the reason."""
        if event[1].get("action") == "worker-ttl-timed-out":
            self._causes.append(
                f"The Dask scheduler ended a worker that did not respond for {event[1]['ttl']:.0f} s: a long compiled "
                "call blocked its interpreter. Start the scheduler with a longer timeout, for example "
                "`DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL=1h dask scheduler`."
            )

    def _cause(self) -> str | None:
        """Return a sentence if the scheduler has ended workers since the last call; otherwise None."""
        return self._causes.pop() if self._causes else None

    def __enter__(self) -> "DaskEngine[TaskT]":
        return self

    def __exit__(self, *ended: object) -> None:
        self._client.close()


@dataclass(frozen=True, slots=True)
class _DaskTask(Generic[TaskT]):
    """A sent task, and the number of games in one call: first 1, then twice the previous number."""

    task: TaskT
    most: int = 1
    cpu_seconds: float = 0.0


def _carried_out(task: BatchTask, most: int) -> tuple[str, TaskOutcome]:
    """Carry out a task or some of its games. Return the name of the worker and the outcome."""
    return get_worker().address, task.carry_out(most)
