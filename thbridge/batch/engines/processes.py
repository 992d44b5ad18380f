"""Engine for worker processes on this machine. It replaces workers that die."""

import signal
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Generic, cast

from thbridge.batch.engines.batch_task import BatchTask, TaskOutcome
from thbridge.batch.engines.engine import EngineFailed, FinishedTask, TaskT


@dataclass(slots=True)
class _WorkerProcess(Generic[TaskT]):
    """A worker: its process, our end of the pipe to it, and its current task."""

    process: BaseProcess
    pipe: "Connection[TaskT, TaskOutcome | Exception]"
    task: TaskT | None = None

    @property
    def name(self) -> str:
        return str(self.process.pid)


class ProcessEngine(Generic[TaskT]):
    """Engine that uses processes of this machine.

    Args:
        processes: number of processes.
        warm: modules that a separate process imports once. All workers are forks of this process. A fork of this
            program would copy its running threads, such as the thread that draws the progress.
    """

    def __init__(self, processes: int, warm: Sequence[str]) -> None:
        self._processes = processes
        self._context = get_context("forkserver")
        self._context.set_forkserver_preload(list(warm))
        self._waiting: deque[tuple[TaskT, str | None]] = deque()
        self._workers: list[_WorkerProcess[TaskT]] = []

    def submit(self, task: TaskT, avoid: str | None = None) -> None:
        """See `Engine`. Repetitions of games have priority, so that differences are found early."""
        if avoid is not None and self._processes > 1:
            self._waiting.appendleft((task, avoid))
        else:
            self._waiting.append((task, avoid))

    def finished(self) -> Iterator[FinishedTask[TaskT]]:
        """See `Engine`."""
        while self._waiting or any(worker.task for worker in self._workers):
            self._assign()
            for ready in wait([worker.pipe for worker in self._workers if worker.task]):
                worker = next(worker for worker in self._workers if worker.pipe is ready)
                yield self._ended(worker)

    def __enter__(self) -> "ProcessEngine[TaskT]":
        return self

    def __exit__(self, *ended: object) -> None:
        for worker in self._workers:
            worker.pipe.close()
            # A worker that stops during a chunk writes no result, so its games are played again.
            worker.process.terminate()
        for worker in self._workers:
            worker.process.join()
        self._workers = []

    def _assign(self) -> None:
        """Assign waiting tasks to idle workers."""
        held: list[tuple[TaskT, str | None]] = []
        while self._waiting and self._has_room():
            task, avoid = self._waiting.popleft()
            worker = self._idle(avoid)
            if worker is None:
                held.append((task, avoid))
                continue
            try:
                worker.pipe.send(task)
            except OSError:  # The idle worker died.
                self._bury(worker)
                self._waiting.appendleft((task, avoid))
                continue
            worker.task = task
        self._waiting.extendleft(reversed(held))

    def _has_room(self) -> bool:
        """Return True if a worker is idle or a new worker may be started."""
        return len(self._workers) < self._processes or any(worker.task is None for worker in self._workers)

    def _idle(self, avoid: str | None) -> _WorkerProcess[TaskT] | None:
        """Return an idle or new worker for a task, or None if all suitable workers are busy."""
        idle = [worker for worker in self._workers if worker.task is None]
        for worker in idle:
            if worker.name != avoid:
                return worker
        if len(self._workers) < self._processes:
            return self._hire()
        if idle and self._processes == 1:
            # The only worker has already played this chunk. So replace it by a new worker.
            self._bury(idle[0])
            return self._hire()
        return None

    def _hire(self) -> _WorkerProcess[TaskT]:
        ours, theirs = self._context.Pipe()
        process = self._context.Process(target=_serve, args=(theirs,), daemon=True)
        process.start()
        theirs.close()
        worker = _WorkerProcess(process, cast("Connection[TaskT, TaskOutcome | Exception]", ours))
        self._workers.append(worker)
        return worker

    def _bury(self, worker: _WorkerProcess[TaskT]) -> None:
        worker.pipe.close()
        worker.process.terminate()
        worker.process.join()
        self._workers.remove(worker)

    def _ended(self, worker: _WorkerProcess[TaskT]) -> FinishedTask[TaskT]:
        """Return the finished task of a worker, or the unfinished task of a dead worker. Raise a worker's exception."""
        task = worker.task
        if task is None:
            raise EngineFailed("A worker without a task returned a result.")
        try:
            answer = worker.pipe.recv()
        except (EOFError, OSError):
            self._bury(worker)
            return FinishedTask(task, None, worker.name)
        worker.task = None
        if isinstance(answer, Exception):
            raise answer
        return FinishedTask(task, answer, worker.name)


def _serve(pipe: "Connection[TaskOutcome | Exception, BatchTask]") -> None:
    """Carry out tasks until the other end of the pipe is closed."""
    # Ctrl-C at a terminal reaches all processes. But only the process with the engine ends the workers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    while True:
        try:
            task = pipe.recv()
        except EOFError:
            return
        try:
            pipe.send(task.carry_out())
        except Exception as fault:
            pipe.send(fault)
