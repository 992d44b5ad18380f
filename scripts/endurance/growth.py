"""Growth of the resources of programs in a long run, and of the time per tick, computed from samples."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import stats

from sim.common.observations import TICK
from sim.numerics.float_array import FloatArray

WARM_UP = 0.2
"""Share of a run, at its beginning, whose samples are ignored.

Later, caches are full, and allocators have reserved their memory.
"""
TREND = 10
"""Least number of samples from which a trend is computed."""


@dataclass(frozen=True, slots=True)
class Bound:
    """Maximum growth of a figure per simulated hour after the warm-up; `slack` is added once for the whole run."""

    growth: float
    slack: float


BOUNDS: Mapping[str, Bound] = {
    "MB": Bound(0.25, 4.0),
    "descriptors": Bound(0.0, 4.0),
    "threads": Bound(0.0, 1.0),
}
"""Bounds by the last word of column names.

In the first hours, caches and data for late watchers grow. `slack` allows this.
"""
SLOWER = 1.25
"""Maximum ratio of a tick's processor time in the second half after the warm-up to the first half.

If the run measured the time of the yardstick, the times of ticks are divided by it.
"""
COUNTED = {
    "games": "games",
    "visits": "connections of visitors",
    "failed_visits": "failed connections of visitors",
    "lost": "connections lost",
    "dropped": "messages dropped for the watcher",
    "ros_messages": "ROS messages to the node",
    "ros_nodes_passed": "short-lived ROS nodes",
    "mavlink_frames": "MAVLink frames",
    "mavlink_trips": "trips of the station",
    "journals_MB": "MB of journals",
    "bags_MB": "MB of bags",
}


@dataclass(frozen=True, slots=True)
class Growth:
    """Growth of a figure per simulated hour, with its 95 % interval, and the greatest growth allowed in this run."""

    begun: float
    ended: float
    hourly: float
    low: float
    high: float
    allowed: float

    @property
    def is_beyond(self) -> bool:
        """True if even the lower end of the interval exceeds the bound."""
        return self.low > self.allowed


def growth_of(hours: FloatArray, values: FloatArray, bound: Bound) -> Growth:
    """Return the growth of a figure by the Theil-Sen estimator (median of slopes), which is robust against outliers."""
    hourly, _, low, high = stats.theilslopes(values, hours)
    allowed = bound.growth + bound.slack / max(hours[-1] - hours[0], 1e-9)
    return Growth(values[0], values[-1], hourly, low, high, allowed)


def slowdown_of(times: FloatArray) -> float:
    """Return the median of the second half of times, divided by the median of the first half."""
    half = len(times) // 2
    return float(np.nanmedian(times[half:]) / np.nanmedian(times[:half]))


class Samples:
    """Samples of a run.

    Args:
        path: path of the CSV file with the samples.
    """

    def __init__(self, path: Path) -> None:
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.columns = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
        self.hours = self.columns["sim_s"] / 3600.0
        self.warm = self.hours >= WARM_UP * self.hours[-1]
        self.yardstick = self.columns.get("yardstick_ms", np.ones(len(rows)))
        self.processes = [name.removesuffix("_threads") for name in self.columns if name.endswith("_threads")]

    def growth(self, process: str, what: str) -> Growth:
        """Return the growth of a resource of a process, after the warm-up."""
        return growth_of(self.hours[self.warm], self.columns[f"{process}_{what}"][self.warm], BOUNDS[what])

    def tick_milliseconds(self, process: str) -> FloatArray:
        """Return the processor time of a process per tick, between successive samples."""
        used, passed = np.diff(self.columns[f"{process}_cpu_s"]), np.diff(self.columns["sim_s"])
        return 1000.0 * used * TICK / np.where(passed > 0.0, passed, np.nan)

    def slowdown(self, process: str) -> float:
        """Return the slowdown of ticks after the warm-up, divided by the slowdown of the machine."""
        return slowdown_of((self.tick_milliseconds(process) / self.yardstick[1:])[self.warm[1:]])


def judge(samples: Samples) -> bool:
    """Print the growth; return True if no bound is exceeded and no connection was refused."""
    if np.count_nonzero(samples.warm) < TREND:
        print("The run was too short for a trend.")
        return False
    last = {name: values[-1] for name, values in samples.columns.items()}
    print(f"{samples.hours[-1]:.2f} simulated hours in {last['wall_s'] / 60:.0f} minutes:")
    print(", ".join(f"{last[column]:.0f} {words}" for column, words in COUNTED.items()))
    held = not last["failed_visits"]
    print(f"{'':<24} {'first':>9} {'last':>9} {'per hour':>9}  {'95 % interval':<20} {'allowed':>9}")
    for process in samples.processes:
        for what in BOUNDS:
            each = samples.growth(process, what)
            interval, verdict = f"{each.low:.3f} to {each.high:.3f}", "GROWS" if each.is_beyond else ""
            held &= not each.is_beyond
            print(
                f"{process + ' ' + what:<24} {each.begun:>9.1f} {each.ended:>9.1f} {each.hourly:>9.3f}  {interval:<20} "
                f"{each.allowed:>9.3f}  {verdict}"
            )
    main = samples.processes[0]
    slower, times = samples.slowdown(main), samples.tick_milliseconds(main)[samples.warm[1:]]
    held &= slower <= SLOWER
    print(
        f"A tick takes {main} {np.nanmedian(times):.2f} ms of processor time. In the second half it takes "
        f"{slower:.2f} times as long as in the first half ({SLOWER} is allowed).  {'SLOWER' if slower > SLOWER else ''}"
    )
    return held
