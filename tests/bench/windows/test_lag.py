"""How far what a participant's window draws is behind the robots, in real games of several processes over TCP."""

import re
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest

from sim.common.observations import TICK
from sim.numerics.float_array import FloatArray
from tests.support.windows.desktop import desktop, needs_desktop

pytestmark = [pytest.mark.bench, needs_desktop]

SECONDS = 45.0
BEFORE, AFTER = 0.6, 0.1
"""What is drawn now is looked for among what robots believed from so long ago until so soon."""
DRIVES = 0.25
"""Only of robots that drive can be told how late they are drawn; meters a second."""
NEAR = 0.03
"""Who is drawn farther from where it ever was corrects its place; meters."""


def started(opened: ExitStack, folder: Path, environment: dict[str, str], *arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "tests.bench.windows.observed", str(folder), *arguments]
    program = opened.enter_context(
        subprocess.Popen(
            command,
            env=environment,
            cwd=folder,
            stdout=subprocess.PIPE,
            stderr=(folder / "errors").open("a"),
            text=True,
        )
    )
    opened.callback(program.terminate)
    return program


def watched(folder: Path) -> None:
    """Wait until robots are drawn, and then some time."""
    end = time.monotonic() + 180.0
    while not (folder / "drawn").exists() or (folder / "drawn").stat().st_size < 10_000:
        if time.monotonic() > end:
            raise TimeoutError((folder / "errors").read_text())
        time.sleep(0.5)
    time.sleep(SECONDS)


@pytest.mark.parametrize("robots", [4, 10])
def test_programs_apart(tmp_path: Path, robots: int) -> None:
    team = ["--robots", str(robots), "--map", "warehouse12"]
    study = tmp_path / "study.yaml"
    study.write_text(f"robots: {robots}\nmap: warehouse12\n")
    with ExitStack() as opened:
        there = opened.enter_context(desktop(1280, 860))
        server = started(opened, tmp_path, there.environment, "server", str(study), "--port", "0")
        found = re.search(r":(\d+)", server.stdout.readline() if server.stdout is not None else "")
        assert found is not None, (tmp_path / "errors").read_text()
        at = f"127.0.0.1:{found[1]}"
        started(opened, tmp_path, there.environment, "hider", "--server", at)
        started(opened, tmp_path, there.environment, "simr", "--server", at, *team)
        started(opened, tmp_path, there.environment, "tabui", "--server", at)
        watched(tmp_path)
    judge(f"server, simr, hider and the window apart, {robots} robots", tmp_path)


@pytest.mark.parametrize("robots", [4, 10])
def test_hosted(tmp_path: Path, robots: int) -> None:
    with ExitStack() as opened:
        there = opened.enter_context(desktop(1280, 860))
        options = ["--robots", str(robots), "--map", "warehouse12", "--port", "0", "--no-report"]
        started(opened, tmp_path, there.environment, "play", *options)
        watched(tmp_path)
    judge(f"thbridge play, {robots} robots", tmp_path)


def table(path: Path) -> FloatArray:
    """(n, 1 + 2 robots) lines of a file, the torn last one left out."""
    lines = [line.split() for line in path.read_text().splitlines()[:-1]]
    width = max(map(len, lines))
    return np.array([line for line in lines if len(line) == width], dtype=np.float64)


def late(believed: FloatArray, drawn: FloatArray) -> tuple[list[float], list[float]]:
    """How many seconds ago each robot that drives was where it is drawn, and how far it is from there by now."""
    times, seconds, metres = believed[:, 0], [], []
    for now, *places in drawn:
        low, high = np.searchsorted(times, [now - BEFORE, now + AFTER])
        here = int(np.searchsorted(times, now)) - 1
        if high - low < 10 or here <= low:
            continue
        for robot in range(len(places) // 2):
            path = believed[low:high, 1 + 2 * robot : 3 + 2 * robot]
            steps = np.diff(path, axis=0)
            lengths = np.hypot(*steps.T)
            if lengths.sum() < DRIVES * (times[high - 1] - times[low]) or lengths.min() < 1e-3:
                continue
            place = np.array(places[2 * robot : 2 * robot + 2])
            share = np.clip(np.sum((place - path[:-1]) * steps, axis=1) / lengths**2, 0.0, 1.0)
            off = np.hypot(*(path[:-1] + share[:, None] * steps - place).T)
            nearest = int(off.argmin())
            if off[nearest] < NEAR:
                begin, end = times[low + nearest], times[low + nearest + 1]
                seconds.append(now - (begin + share[nearest] * (end - begin)))
                metres.append(float(np.hypot(*(path[here - low] - place))))
    return seconds, metres


def judge(what: str, folder: Path) -> None:
    seconds, metres = late(table(folder / "believed"), table(folder / "drawn"))
    ticks = 1e3 * np.diff(table(folder / "believed")[:, 0])
    beats, worked = 1e3 * np.diff(table(folder / "beats"), axis=0).T
    print(
        f"\n{what}: drawn {figures(1e3 * np.array(seconds))} ms after it was so ({len(seconds)} places), "
        f"{figures(1e2 * np.array(metres))} cm from where it is; ticks {figures(ticks)} ms apart; the window's "
        f"event loop turns after {figures(beats)} ms, of which it works {figures(worked)}",
        end="",
    )
    assert np.median(seconds) < 5 * TICK
    assert np.median(metres) < 0.1
    assert np.median(ticks) == pytest.approx(1e3 * TICK, abs=1.0)
    assert np.percentile(worked, 95) < 1e3 * TICK


def figures(values: FloatArray) -> str:
    median, most = np.percentile(values, [50, 95])
    return f"{median:.0f} (median), {most:.0f} (95 %), {np.max(values):.0f} (most)"
