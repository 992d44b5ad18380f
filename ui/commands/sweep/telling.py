"""Designs, results and status of sweeps, as text and as JSON."""

import dataclasses
from datetime import timedelta
from pathlib import Path

from rich.table import Table

from thbridge.batch.chunks import chunks_of, is_drawn
from thbridge.batch.design import SweepDesign
from thbridge.batch.status import SweepStatus
from thbridge.batch.sweep import SweepProgress
from ui.command_line.terminal import command, note, out, show

MOST_TOLD = 20
"""Maximum number of printed faults, and of printed conditions; there may be thousands."""


def design_as_json(design: SweepDesign) -> dict[str, object]:
    """Return a design as the JSON object of --check."""
    return {
        "conditions": [dict(condition.levels) for condition in design.conditions],
        "seeds": len(design.seeds),
        "games": design.games,
        "verified": _verified(design),
        "chunks": len(chunks_of(len(design.conditions), design.seeds, design.chunk)),
    }


def _verified(design: SweepDesign) -> int:
    """Return the number of games that will be repeated."""
    drawn = (
        is_drawn("verified", design.one_verified_in, condition.number, seed)
        for condition in design.conditions
        for seed in design.seeds
    )
    return sum(drawn)


def show_design(design: SweepDesign) -> None:
    """Print the conditions and the number of games of a design."""
    if design.factors:
        table = Table("condition", *design.factors)
        for condition in design.conditions[:MOST_TOLD]:
            table.add_row(str(condition.number), *(condition.levels.get(factor, "") for factor in design.factors))
        out.print(table)
    if len(design.conditions) > MOST_TOLD:
        show(f"and {len(design.conditions) - MOST_TOLD} more conditions")
    show(
        f"{len(design.conditions)} conditions, each with the same {len(design.seeds)} seeds: {design.games} games, "
        f"{_verified(design)} of them are played twice."
    )


def progress_as_json(progress: SweepProgress, root: Path) -> dict[str, object]:
    """Return the result of a run as the JSON object of --json."""
    values = dataclasses.asdict(progress)
    return values | {"cpu_seconds": round(progress.cpu_seconds, 2), "folder": str(root)}


def show_progress(progress: SweepProgress, root: Path) -> None:
    """Print the result of a run."""
    before = f" ({progress.before} in earlier runs)" if progress.before else ""
    died = f" {progress.deaths} workers crashed and were replaced." if progress.deaths else ""
    show(
        f"{progress.played} games played{before}; {progress.verified} games repeated, {progress.differing} with another"
        f" result. {progress.cpu_seconds:.0f} s of processor time.{died}"
    )
    note(f"To write a table, run {command('sweep', 'collect', root, '--to', 'games.csv')}. `sweep plot` draws figures.")


def show_status(status: SweepStatus) -> None:
    """Print the status of a sweep."""
    table = Table(show_header=False)
    table.add_row("games", str(status.games))
    table.add_row("done", f"{status.done} of {status.games} ({status.done / max(1, status.games):.0%})")
    for name, count in status.by_status.items():
        table.add_row(name, str(count))
    table.add_row("running", str(status.running))
    table.add_row("missing", f"{status.missing}, including running games")
    table.add_row("repeated", f"{status.verified} of {status.drawn}")
    table.add_row("repeated with another result", str(len(status.differing)))
    table.add_row("processor time", _clock(status.cpu_seconds))
    if status.rate is not None:
        table.add_row("rate", f"{status.rate:.2f} games/s")
    if status.missing and status.seconds_left is not None:
        table.add_row("time left", _clock(status.seconds_left))
    out.print(table)
    for sentence in (*status.differing, *status.faults)[:MOST_TOLD]:
        note(sentence)
    if len(status.versions) > 1:
        note("Different versions of programs played these games:")
        for versions, files in status.versions.items():
            note(f"  {files} files: {versions}")


def _clock(seconds: float) -> str:
    return str(timedelta(seconds=round(seconds)))
