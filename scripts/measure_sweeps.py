"""Measure the processor time of sweeps, compared with `thbridge play`; docs/reference/benchmarks.md has the figures.

Run this script from the project's folder: `.venv/bin/python scripts/measure_sweeps.py`. It plays 1000 short games of
two robots with two processes, and the same games on a Dask cluster with two workers; one worker is killed halfway. It
also plays a fifth of these games with one process. Then it compares all results, and measures the cost of a chunk for a
scheduler. For a quick try, use `--games 40`. The exit code is 1 if results differ.
"""

import argparse
import ctypes
import json
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import pyarrow as pa
from pyarrow import compute

from thbridge.batch.design import read_design
from thbridge.batch.engines.dask import DaskEngine
from thbridge.batch.engines.engine import Engine
from thbridge.batch.engines.processes import ProcessEngine
from thbridge.batch.folder import open_folder
from thbridge.batch.sweep import WARM, tasks_of
from thbridge.batch.tables import VARYING, collect
from thbridge.batch.tasks import SweepTask

ROOT = Path(__file__).parents[1]
PROGRAM = [sys.executable, "-c", "from ui.cli import main; main()"]
STUDY = "map: arena8\nrobots: 2\ngame: {energy: 20}\nserver: {port: 0}\n"
DESIGN = "study: study.yaml\nreplicates: GAMES\nverify: 100\nchunk: 20\n"
PLAYS = 10
EMPTY_TASKS = 2000
ADOPT_ORPHANS = 36
"""PR_SET_CHILD_SUBREAPER: this process adopts orphaned processes, so that their processor time is counted."""


def run(*words: str | Path) -> None:
    """Run a thbridge command; end this program if the command fails."""
    command = [*PROGRAM, *map(str, words)]
    done = subprocess.run(
        command, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False
    )
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}: {done.stderr}")


def cpu_of(action: Callable[[], object]) -> tuple[float, float]:
    """Run an action; return the processor time of all processes that it starts, and its duration, in seconds."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    action()
    wall = time.monotonic() - began
    while True:
        try:
            os.wait()
        except ChildProcessError:
            break
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def table(root: Path) -> pa.Table:
    """Return the table of a sweep without the columns that vary from run to run."""
    return collect(root).drop_columns(list(VARYING))


@contextmanager
def cluster(folder: Path) -> Iterator[tuple[str, int, list[int]]]:
    """Yield the address of a Dask scheduler, its process id, and the process ids of its two workers."""
    place, programs = folder / "scheduler.json", []

    def start(role: str, *words: str) -> int:
        command = [sys.executable, "-m", f"distributed.cli.{role}", "--no-dashboard", "--scheduler-file", str(place)]
        surroundings = {**os.environ, "PYTHONPATH": str(ROOT)}
        programs.append(subprocess.Popen([*command, *words], env=surroundings, stderr=subprocess.DEVNULL, cwd=folder))
        return programs[-1].pid

    scheduler = start("dask_scheduler", "--port", "0")
    workers = [start("dask_worker", "--nthreads", "1", "--no-nanny") for _ in range(2)]
    while not (place.exists() and place.read_text()):
        time.sleep(0.1)
    try:
        yield json.loads(place.read_text())["address"], scheduler, workers
    finally:
        # A worker does not end without its scheduler, so the scheduler, which started first, ends last.
        for program in reversed(programs):
            program.terminate()
            program.wait()


def play_on_cluster(folder: Path, games: int) -> None:
    """Play the games on a cluster, and kill a worker when half of the games are done."""
    root = folder / "dask"
    with cluster(folder) as (address, _, workers):
        words = ("sweep", folder / "design.yaml", "--out", root, "--engine", "dask", "--scheduler", address)
        command = [*PROGRAM, *map(str, words)]
        sweep = subprocess.Popen(command, env={**os.environ, "PYTHONPATH": str(ROOT)}, stdout=subprocess.DEVNULL)
        while len(list(root.glob("games/*/*.parquet"))) < games // 40:
            time.sleep(0.05)
        os.kill(workers[0], signal.SIGKILL)
        if sweep.wait():
            sys.exit("The sweep on the cluster failed.")


def empty_tasks(engine: Engine[SweepTask], folder: Path) -> tuple[float, float]:
    """Run tasks whose results already exist. Return wall time and processor time of this process per task, seconds."""
    design = read_design(folder / "design.yaml")
    (task, *_) = tasks_of(design, open_folder(design, folder / "two"), lambda _chunk: True)
    with engine:
        for measured in (False, True):  # The first round starts the workers.
            began, cpu = time.monotonic(), time.process_time()
            for _ in range(EMPTY_TASKS if measured else 20):
                engine.submit(task)
            for _ in engine.finished():
                pass
        return (time.monotonic() - began) / EMPTY_TASKS, (time.process_time() - cpu) / EMPTY_TASKS


def cpu_so_far(process: int) -> float:
    """Return the processor time of a running process, seconds."""
    words = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def main() -> int:
    """Run the measurement."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--games", type=int, default=1000, help="number of games of each sweep")
    games = parser.parse_args().games
    ctypes.CDLL(None).prctl(ADOPT_ORPHANS, 1, 0, 0, 0)
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "study.yaml").write_text(STUDY)
        (folder / "design.yaml").write_text(DESIGN.replace("GAMES", str(games)))
        play = ("play", folder / "study.yaml", "--headless", "--json")
        run(*play, "--bag", folder / "warm.bag")  # this compiles the kernels if needed

        def play_all() -> None:
            for seed in range(1, PLAYS + 1):
                run(*play, "--seed", str(seed), "--bag", folder / f"{seed}.bag")

        spent, _ = cpu_of(play_all)
        print(
            f"play: {spent / PLAYS:.2f} s of processor time per game, {spent / PLAYS * games:.0f} s for {games}",
            flush=True,
        )
        for processes, out, count in ((1, "one", games // 5), (2, "two", games)):
            (folder / f"{out}.yaml").write_text(DESIGN.replace("GAMES", str(count)))
            words = ("sweep", folder / f"{out}.yaml", "--out", folder / out, "--processes", str(processes))
            cpu, wall = cpu_of(partial(run, *words))
            inside = float(compute.sum(collect(folder / out)["cpu_seconds"]).as_py())
            print(
                f"{processes} processes: {cpu:.0f} s of processor time ({inside:.0f} s in games), {wall:.0f} s; "
                f"{count} games; `play` needs {spent / PLAYS * count / cpu:.1f} times this processor time",
                flush=True,
            )
        cpu, wall = cpu_of(lambda: play_on_cluster(folder, games))
        print(f"Dask, one of two workers killed: {cpu:.0f} s of processor time, {wall:.0f} s", flush=True)
        whole = table(folder / "two")
        parts = {out: table(folder / out) for out in ("one", "dask")}
        equal = {out: part.equals(whole.slice(0, part.num_rows)) for out, part in parts.items()}
        print(f"identical results, {whole.num_rows} games: {equal}", flush=True)
        wall, ours = empty_tasks(ProcessEngine(2, WARM), folder)
        print(
            f"a chunk without games, processes: {1e3 * wall:.2f} ms, {1e3 * ours:.2f} ms of processor time here",
            flush=True,
        )
        with cluster(folder) as (address, scheduler, _):
            engine = DaskEngine[SweepTask](address)
            before = cpu_so_far(scheduler)
            wall, ours = empty_tasks(engine, folder)
            cost = (cpu_so_far(scheduler) - before) / EMPTY_TASKS
        print(
            f"a chunk without games, Dask: {1e3 * wall:.2f} ms, {1e3 * ours:.2f} ms of processor time here and "
            f"{1e3 * cost:.2f} ms in the scheduler"
        )
    return 0 if all(equal.values()) and whole.num_rows == parts["dask"].num_rows == games else 1


if __name__ == "__main__":
    sys.exit(main())
