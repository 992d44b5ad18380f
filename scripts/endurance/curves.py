"""Plots of a long run."""

from pathlib import Path

import matplotlib as mpl
import numpy as np

from endurance.growth import BOUNDS, WARM_UP, Samples

mpl.use("Agg")
from matplotlib import pyplot as plt

TITLES = {"MB": "Resident memory, MB", "descriptors": "Open descriptors", "threads": "Threads"}


def draw(samples: Samples, path: Path) -> None:
    """Draw the curves. The warm-up is gray, and legends show the growth after it."""
    figure, axes = plt.subplots(3, 2, figsize=(10.0, 10.0), sharex=True, layout="constrained")
    hours, columns = samples.hours, samples.columns
    memory, ticks, descriptors, waits, threads, games = axes.flat
    for what, panel in zip(BOUNDS, (memory, descriptors, threads), strict=True):
        for process in samples.processes:
            hourly = samples.growth(process, what).hourly
            panel.plot(hours, columns[f"{process}_{what}"], lw=1.2, label=f"{process}: {hourly:+.2f} per hour")
        panel.set_title(TITLES[what], loc="left", fontsize=10)
    for process in samples.processes:
        times = samples.tick_milliseconds(process)
        ticks.plot(hours[1:], times, lw=1.2, label=f"{process}: median {np.nanmedian(times):.2f}")
    ticks.set_ymargin(0.4)  # Space for the legend above the curves.
    ticks.set_title("Processor time per tick, ms", loc="left", fontsize=10)
    waits.plot(hours[1:], columns["longest_wait_ms"][1:], lw=1.2)
    waits.set_title("Longest wait for an answer of the text server, ms", loc="left", fontsize=10)
    games.plot(hours, columns["games"], lw=1.2, label="games")
    games.plot(hours, columns["journals_MB"], lw=1.2, label="journals, MB")
    if columns["bags_MB"].any():
        games.plot(hours, columns["bags_MB"] / 1024.0, lw=1.2, label="bags, GB")
    games.set_title("Games and recordings", loc="left", fontsize=10)
    for panel in axes.flat:
        panel.axvspan(0.0, WARM_UP * hours[-1], color="0.93", lw=0.0)
        panel.grid(color="0.9")
        panel.set_ylim(bottom=0.0)
        if panel is not waits:
            panel.legend(fontsize=7)
    for panel in axes[-1]:
        panel.set_xlabel("simulated hours")
    figure.savefig(path, dpi=100)
