"""Engines of clusters: Dask with real workers, one killed; submitit with its own executor, for want of a Slurm."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from threading import Thread

import pytest

from tests.thbridge.batch.rig import InlineEngine, games, run

pytest.importorskip("distributed")
pytest.importorskip("submitit")

from thbridge.batch.engines.dask import DaskEngine
from thbridge.batch.engines.engine import EngineFailed
from thbridge.batch.engines.slurm import SlurmEngine

ROOT = Path(__file__).parents[3]
SURROUNDINGS = {**os.environ, "PYTHONPATH": str(ROOT)}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep that was played in this process."""
    root = tmp_path_factory.mktemp("whole") / "sweep"
    run(root, InlineEngine())
    return root


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[int]]]:
    """A scheduler and two workers, each a program: its address, and the process ids of the workers."""
    place = tmp_path / "scheduler.json"
    with ExitStack() as programs:

        def start(role: str, *words: str) -> int:
            command = [sys.executable, "-m", f"distributed.cli.{role}", *words]
            program = subprocess.Popen(command, env=SURROUNDINGS, stderr=subprocess.DEVNULL, cwd=tmp_path)
            programs.callback(program.wait)
            programs.callback(program.kill)
            return program.pid

        start("dask_scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", str(place))
        worker = ("dask_worker", "--nthreads", "1", "--no-nanny", "--no-dashboard", "--scheduler-file", str(place))
        workers = [start(*worker), start(*worker)]
        yield _address(place), workers


def _address(place: Path) -> str:
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline:
        if place.exists() and (text := place.read_text()):
            return json.loads(text)["address"]
        os.sched_yield()
    raise TimeoutError


def test_dask_workers_play_the_same_games_though_one_is_killed(
    whole: Path, cluster: tuple[str, list[int]], tmp_path: Path
) -> None:
    address, workers = cluster
    root = tmp_path / "sweep"
    killed: list[int] = []

    def kill() -> None:
        """Kill a worker that is in the middle of a chunk, after another has been done."""
        deadline = time.monotonic() + 120.0
        while time.monotonic() < deadline and not killed:
            if list(root.glob("games/*/*.parquet")):
                for journal in root.glob("attempts/*"):
                    try:
                        pid = int(journal.read_text().splitlines()[0].rpartition(":")[2])
                    except (FileNotFoundError, IndexError):
                        continue
                    os.kill(pid, signal.SIGKILL)
                    killed.append(pid)
                    break

    killer = Thread(target=kill)
    killer.start()
    told = run(root, DaskEngine(address))
    killer.join()
    assert killed[0] in workers
    assert (told.games, told.played, told.verified, told.differing) == (12, 12, 12, 0)
    assert games(root).equals(games(whole))
    assert len(list(root.glob("games/*/*.parquet"))) == 8


def test_nobody_answers_for_dask() -> None:
    with pytest.raises(EngineFailed, match=r"No Dask scheduler answers at tcp://127\.0\.0\.1:9 "):
        DaskEngine("tcp://127.0.0.1:9")


def test_jobs_play_the_same_games(whole: Path, tmp_path: Path) -> None:
    told = run(tmp_path / "sweep", SlurmEngine(2, tmp_path / "log", {}, cluster="local"))
    assert (told.played, told.verified, told.differing) == (12, 12, 0)
    assert games(tmp_path / "sweep").equals(games(whole))
