"""Growth is found where there is some, and where it is only noise nothing is said; a short run works to its end."""

import csv
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from scripts.endurance.growth import BOUNDS, Samples, growth_of, judge, slowdown_of
from sim.numerics.float_array import FloatArray
from tests.support.project import ROOT

HOURS = np.linspace(0.0, 24.0, 200)


def noise(size: float) -> FloatArray:
    return size * np.random.default_rng(4).standard_normal(len(HOURS))


def test_what_grows_slowly_beneath_noise_is_found() -> None:
    assert growth_of(HOURS, 200.0 + 2.0 * HOURS + noise(5.0), BOUNDS["MB"]).is_beyond
    assert growth_of(HOURS, np.floor(20.0 + 0.5 * HOURS), BOUNDS["descriptors"]).is_beyond


def test_what_is_flat_but_for_noise_and_single_samples_is_not_growth() -> None:
    jumps = np.where(np.arange(len(HOURS)) % 20 == 0, 100.0, 0.0)
    for what in BOUNDS:
        assert not growth_of(HOURS, 200.0 + noise(5.0) + jumps, BOUNDS[what]).is_beyond


def test_a_step_within_the_slack_is_no_growth_and_shrinking_is_none() -> None:
    assert not growth_of(HOURS, np.where(HOURS > 12.0, 21.0, 20.0), BOUNDS["descriptors"]).is_beyond
    assert not growth_of(HOURS, 200.0 - 2.0 * HOURS, BOUNDS["MB"]).is_beyond


def test_ticks_that_become_slower_are_found() -> None:
    assert slowdown_of(2.0 + HOURS / 12.0) > 1.25
    assert slowdown_of(2.0 + noise(0.2)) == pytest.approx(1.0, abs=0.1)


def written(folder: Path, figures: Mapping[str, Sequence[float] | FloatArray]) -> Samples:
    """Samples of a run of one process, flat where the figures do not say otherwise."""
    zero = HOURS * 0.0
    columns = dict.fromkeys(("games", "visits", "failed_visits", "lost", "dropped", "ros_messages"), zero)
    columns |= dict.fromkeys(("ros_nodes_passed", "mavlink_frames", "mavlink_trips", "journals_MB", "bags_MB"), zero)
    columns |= {"wall_s": HOURS * 600.0, "sim_s": HOURS * 3600.0, "session_MB": zero + 200.0}
    columns |= {"session_descriptors": zero + 20.0, "session_threads": zero + 8.0, "session_cpu_s": HOURS * 360.0}
    columns |= {name: np.array(values) for name, values in figures.items()}
    path = folder / "samples.csv"
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))
    return Samples(path)


def test_a_flat_run_is_judged_well(tmp_path: Path) -> None:
    assert judge(written(tmp_path, {}))


@pytest.mark.parametrize(
    ("column", "values", "told"),
    [
        ("session_MB", 200.0 + 3.0 * HOURS, "GROWS"),
        ("session_threads", 8.0 + np.floor(HOURS), "GROWS"),
        ("session_cpu_s", 15.0 * HOURS**2, "SLOWER"),
        ("failed_visits", HOURS, "failed connections of visitors"),
    ],
)
def test_a_run_is_judged_badly_for_one_fault(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], column: str, values: FloatArray, told: str
) -> None:
    assert not judge(written(tmp_path, {column: values}))
    assert told in capsys.readouterr().out


def test_a_machine_that_becomes_slower_is_no_fault_of_the_ticks(tmp_path: Path) -> None:
    slower = {"session_cpu_s": 15.0 * HOURS**2, "yardstick_ms": 1.0 + HOURS}
    assert judge(written(tmp_path, slower))


def test_a_run_without_enough_samples_is_no_proof(tmp_path: Path) -> None:
    assert not judge(written(tmp_path, {"sim_s": np.where(HOURS < 23.9, 0.0, 3600.0)}))


@pytest.mark.slow
def test_games_on_one_server_leave_nothing_behind(tmp_path: Path) -> None:
    words = ["server", "--minutes", "2", "--every", "3", "--folder", tmp_path / "run", "--to", tmp_path / "run.png"]
    command = [sys.executable, "scripts/long_run.py", *words]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=500, check=False)
    told = done.stdout + done.stderr  # not the code of its end: minutes say nothing about the times of ticks
    assert "robots descriptors" in told, told
    assert "GROWS" not in told, told
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")
    samples = Samples(tmp_path / "run" / "samples.csv")
    assert max(samples.columns["games"]) > 1
    assert max(samples.columns["failed_visits"]) == 0
