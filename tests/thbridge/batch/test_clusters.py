"""Engines of clusters: Dask with real workers, one killed; submitit with its own executor, for want of a Slurm."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from threading import Thread

import pytest

from tests.support.programs.inline_engine import InlineEngine
from tests.support.project import ROOT
from tests.thbridge.batch.small_sweeps import HoldingTask, games, run

pytest.importorskip("distributed")
pytest.importorskip("submitit")

from dask import config

from thbridge.batch.engines import dask
from thbridge.batch.engines.dask import DaskEngine
from thbridge.batch.engines.engine import EngineFailed
from thbridge.batch.engines.slurm import SlurmEngine
from ui.command_line.schedulers import is_open_to_others

FEW = """\
base: {game.energy: 20}
factors:
  noise.preset: [none, bad wheels]
seeds: [3, 5]
chunk: 1
verify: 1
max_seconds: 2
"""
"""Four games, each played twice: that chunks are carried out elsewhere, and what of, is seen in each of them."""

OF_AGAIN = ["messages", "verified"]
"""Columns that games have when they are played again."""

SURROUNDINGS = {**os.environ, "PYTHONPATH": str(ROOT)}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep that was played in this process."""
    root = tmp_path_factory.mktemp("whole") / "sweep"
    run(root, InlineEngine(), FEW)
    return root


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[int]]]:
    """A scheduler and two workers, each a program: its address, and the process ids of the workers."""
    with _cluster(tmp_path) as started:
        yield started


@contextmanager
def _cluster(tmp_path: Path, **settings: str) -> Iterator[tuple[str, list[int]]]:
    """Start a cluster with settings of Dask in the environment; see `cluster`."""
    place = tmp_path / "scheduler.json"
    with ExitStack() as programs:

        def start(role: str, *words: str) -> int:
            command = [sys.executable, "-m", f"distributed.cli.{role}", *words]
            surroundings = {**SURROUNDINGS, **settings}
            program = subprocess.Popen(command, env=surroundings, stderr=subprocess.DEVNULL, cwd=tmp_path)
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
        time.sleep(0.02)
    raise TimeoutError


@pytest.mark.slow
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
            time.sleep(0.002)

    killer = Thread(target=kill)
    killer.start()
    told = run(root, DaskEngine(address), FEW)
    killer.join()
    assert killed[0] in workers
    assert (told.games, told.played, told.verified, told.differing) == (4, 4, 4, 0)
    assert games(root).equals(games(whole))
    assert len(list(root.glob("games/*/*.parquet"))) == 4


@pytest.mark.slow
def test_a_worker_that_the_scheduler_ends_is_told_with_the_cause(tmp_path: Path) -> None:
    patience = _cluster(tmp_path, DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL="15s")
    with patience as (address, _), DaskEngine[HoldingTask](address) as engine:
        engine.submit(HoldingTask(tmp_path, 90))
        (ended,) = engine.finished()
    assert ended.outcome is not None
    assert ended.cause is not None
    assert "had not answered for 15 s: a long compiled call held its interpreter" in ended.cause
    assert "DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL=1h" in ended.cause


@pytest.mark.slow
def test_dask_plays_by_tls_alone(whole: Path, tmp_path: Path) -> None:
    """As docs/how-to/sweeps-on-clusters.md shows it, on this machine."""
    words = "req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 -subj /CN=dask -keyout k -out c"
    subprocess.run(["openssl", *words.split()], cwd=tmp_path, check=True, capture_output=True)
    place, security = tmp_path / "scheduler.json", ("--tls-ca-file", "c", "--tls-cert", "c", "--tls-key", "k")
    with ExitStack() as programs:
        for role, more in (("dask_scheduler", ("--protocol", "tls", "--port", "0")), ("dask_worker", ("--no-nanny",))):
            bound = (*more, "--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(place), *security)
            command = [sys.executable, "-m", f"distributed.cli.{role}", *bound]
            program = subprocess.Popen(command, env=SURROUNDINGS, stderr=subprocess.DEVNULL, cwd=tmp_path)
            programs.callback(program.wait)
            programs.callback(program.kill)
            address = _address(place)
        assert address.startswith("tls://127.0.0.1:")
        for wrong in (address, address.replace("tls://", "tcp://")):
            with pytest.raises(EngineFailed, match="No Dask scheduler answers"):
                DaskEngine(wrong)
        files = {"ca-file": "c", "client.cert": "c", "client.key": "k"}
        with config.set({f"distributed.comm.tls.{key}": str(tmp_path / name) for key, name in files.items()}):
            told = run(tmp_path / "sweep", DaskEngine(address), FEW)
    assert (told.played, told.verified, told.differing) == (4, 4, 0)
    assert games(tmp_path / "sweep").equals(games(whole))


@pytest.mark.parametrize(
    ("address", "is_open"),
    [
        ("tcp://10.0.0.1:8786", True),
        ("10.0.0.1:8786", True),
        ("tcp://robots:8786", True),
        ("tcp://[fe80::1]:8786", True),
        ("tls://10.0.0.1:8786", False),
        ("tcp://127.0.0.1:8786", False),
        ("tcp://[::1]:8786", False),
        ("localhost:8786", False),
    ],
)
def test_a_scheduler_that_others_reach_without_tls(address: str, is_open: bool) -> None:
    assert is_open_to_others(address) is is_open


def test_nobody_answers_for_dask(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask, "CONNECT_SECONDS", 0.5)
    with pytest.raises(EngineFailed, match=r"No Dask scheduler answers at tcp://127\.0\.0\.1:9 "):
        DaskEngine("tcp://127.0.0.1:9")


@pytest.mark.slow
@pytest.mark.parametrize("again", [0, 4])
def test_jobs_play_the_same_games(again: int, whole: Path, tmp_path: Path) -> None:
    """Games that are played again go to other jobs, after all of the first."""
    design = FEW if again else FEW.replace("verify: 1", "verify: 0")
    told = run(tmp_path / "sweep", SlurmEngine(2, tmp_path / "log", {}, cluster="local"), design)
    assert (told.played, told.verified, told.differing) == (4, again, 0)
    played, there = (games(root).drop_columns(OF_AGAIN) for root in (tmp_path / "sweep", whole))
    assert played.equals(there)
