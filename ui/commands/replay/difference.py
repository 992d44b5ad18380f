"""Changes and results that `thbridge replay` prints."""

import dataclasses
from collections.abc import Iterator, Sequence
from itertools import zip_longest
from pathlib import Path

from rich.table import Table

from thbridge.analysis.comparison import RobotFigures, RunFigures
from thbridge.analysis.report.report import label_of
from thbridge.app.compose.machine import machine, versions
from thbridge.app.replay.replay import Difference, Replayed
from thbridge.ros.messages.session_records import MACHINE, SessionRecord
from ui.command_line.terminal import out, show


def other_versions(record: SessionRecord) -> Iterator[str]:
    """Yield sentences about differences of versions and machine between the recording and now."""
    now = versions(record.versions)
    then = {name: was for name, was in record.versions.items() if name not in MACHINE}
    other = [f"{name} {was} then, {now.get(name, 'none')} now" for name, was in then.items() if now.get(name) != was]
    if other:
        yield f"Recorded with other versions, which may change results: {'; '.join(other)}."
    here, there = machine(), record.versions
    if not there.keys() & here.keys():
        yield (
            "Recorded by a version whose results depended on the machine. Small differences may come from the "
            "processor and the libraries."
        )
        return
    words = [
        # There are many processor features, so the sentence only says that they differ.
        f"other {name}" if "features" in name else f"{name} {there[name]} then, {here[name]} now"
        for name in MACHINE
        if name in there and there[name] != here[name]
    ]
    if words:
        yield (
            f"Recorded on another machine: {'; '.join(words)}. Results should not depend on the machine; if they "
            "differ, this may be the reason."
        )


Compared = tuple[RunFigures | None, RunFigures | None]
"""Figures of a game as recorded and as replayed; None for a run without this game."""


def replayed_as_json(done: Replayed, to: Path | None, figures: Sequence[Compared]) -> dict[str, object]:
    """Return the result of a replay as a JSON object, with the compared figures (of each game if there are several)."""
    result: dict[str, object] = {
        "equal": done.difference is None and done.finished,
        "first_difference": None if done.difference is None else dataclasses.asdict(done.difference),
        "messages": done.messages,
        "ticks": done.ticks,
        "cut_off": done.cut_off,
        "wall_seconds": round(done.wall_seconds, 2),
        "bag": None if to is None else str(to),
    }
    games = [
        {"recorded": was and dataclasses.asdict(was), "replayed": now and dataclasses.asdict(now)}
        for was, now in figures
    ]
    if len(games) == 1:
        result |= games[0]
    elif games:
        result["games"] = games
    return result


def show_replayed(done: Replayed, figures: Sequence[Compared]) -> None:
    """Print the result of a replay."""
    if done.difference is None:
        ending = " The recording ends in the middle of its last tick." if done.cut_off else ""
        reworded = f" ({done.reworded} of them except for changed wordings)" if done.reworded else ""
        text = f"All {done.messages} messages of {done.ticks} ticks are the same, bit for bit{reworded}.{ending}"
        show(f"{text} ({done.wall_seconds:.1f} s)")
    else:
        _show_difference(done.difference)
    for number, (was, now) in enumerate(figures, start=1):
        out.print(_table(was, now, f" of game {number}" if len(figures) > 1 else ""))


def _show_difference(difference: Difference) -> None:
    where = f"message {difference.number} (number {difference.topic_number} on {difference.topic})"
    show(f"First difference: {where} at {difference.seconds:.2f} s: {difference.what}.")
    if difference.fields:
        table = Table("field", "recorded", "replayed")
        for field in difference.fields:
            table.add_row(field.field, field.was, field.now)
        out.print(table)


def _table(was: RunFigures | None, now: RunFigures | None, of_game: str) -> Table:
    table = Table("", "recorded", "replayed", title=f"Recorded and replayed{of_game}")
    runs = (was, now)
    table.add_row("score", *(_figure(None if run is None else run.score) for run in runs))
    table.add_row("rooms visited", *(_figure(None if run is None else run.rooms_visited) for run in runs))
    for one, other in zip_longest(*(() if run is None else run.robots for run in runs)):
        table.add_section()
        for row in zip(_ROWS, _column(one), _column(other), strict=True):
            table.add_row(f"{label_of((one or other).name)}: {row[0]}", *row[1:])
    return table


_ROWS = ("mean error", "95 % of errors within", "distance driven", "arrivals", "arrival times, s", "energy left")


def _column(robot: RobotFigures | None) -> tuple[str, ...]:
    """Return the figures of a robot, one per row. If the robot is missing, the rows contain dashes."""
    if robot is None:
        return ("-",) * len(_ROWS)
    return (
        _figure(robot.error_mean, " m"),
        _figure(robot.error_95, " m"),
        _figure(robot.distance, " m"),
        str(len(robot.arrivals)),
        " ".join(f"{time:.1f}" for time in robot.arrivals),
        _figure(robot.energy),
    )


def _figure(value: float | None, unit: str = "") -> str:
    if value is None:
        return "-"
    return f"{value:.3f}{unit}" if unit else f"{value:g}"
