"""`thbridge replay`: run a recording again, as it was or with something changed."""

import dataclasses
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer
from rich.table import Table

from thbridge.analysis.comparison import RobotFigures, RunFigures, figures_of
from thbridge.analysis.report.gathering import read_report
from thbridge.app.compose import read_setting, versions
from thbridge.app.replay.replay import Difference, Replayed, ReplayOptions, replay, session_of
from thbridge.app.session.session import TickRecord
from thbridge.recording.bag.reader import info, messages
from thbridge.roles.bot_strategy import BotStrategy
from thbridge.ros.messages.records import SessionRecord
from thbridge.ros.names import INPUTS
from thbridge.study.overrides import StudyChange, with_changes
from thbridge.study.study_file import read_study_text
from ui.options import AsJson, announce_compiling, make_copy_ready
from ui.seats import run
from ui.story import print_story
from ui.terminal import BAD_INPUT, FAILED, bad_input, fail, note, out, print_json


def replay_command(
    bag: Annotated[Path, typer.Argument(help="A recording of `thbridge play` or `thbridge simr`.")],
    rate: Annotated[
        float | None, typer.Option(help="Simulated seconds per second; full speed by default.", min=0.01)
    ] = None,
    start: Annotated[
        float,
        typer.Option("--from", help="Run at full speed and tell nothing up to this session time, seconds.", min=0),
    ] = 0.0,
    to: Annotated[Path | None, typer.Option(help="Keep the new recording in this bag.")] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--with",
            metavar="KEY=VALUE|FILE.yaml",
            help="What if: same inputs, but this in the study, e.g. `--with seed=2`. May be given several times.",
        ),
    ] = None,
    participant: Annotated[
        BotStrategy | None,
        typer.Option(help="Let a simulated participant play anew, instead of saying again what was said."),
    ] = None,
    beside: Annotated[Path, typer.Option(help="Folder that paths in the study start from.")] = Path(),
    as_json: AsJson = False,
) -> None:
    """Run a recording again: the same inputs go into a fresh session, which must say what the recorded one said.

    Ends with 0 when every message is the same, bit for bit, and with 1 when one differs; then it says which. With
    `--with` or `--participant` the two runs are compared by their figures, and a difference is no failure.
    """
    files, assignments = changes_of(changes or [])
    with bad_input():
        record = session_of(bag)
        study = read_study_text(bag, record.study)
        setting = read_setting(with_changes(study, files, assignments), beside)
    if participant is not None and not record.participant:
        fail(BAD_INPUT, f"--participant: nobody played inside the program that recorded {bag}. Leave the option out.")
    what_if = bool(changes) or participant is not None
    for sentence in other_versions(record):
        note(sentence)
    if to is not None:
        make_copy_ready(to, bag)

    def progress(moment: TickRecord) -> None:
        if not as_json:
            print_story(moment)

    announce_compiling()
    figures: tuple[RunFigures, RunFigures] | None = None
    with TemporaryDirectory(prefix="thbridge-") as folder:
        kept = to or (Path(folder) / "replay.bag" if what_if else None)
        options = ReplayOptions(rate or 0.0, start, kept, kept is not None, participant)
        done = run(replay(bag, setting, options, progress))
        if what_if and kept is not None and done.finished:
            with bad_input():
                figures = figures_of(read_report(messages(bag))), figures_of(read_report(messages(kept)))
    if as_json:
        print_json(_told(done, to, figures))
    else:
        _show(done, figures)
    if not done.finished:
        fail(FAILED, "stopped before the end of the recording")
    if done.difference is not None and not what_if:
        if not any(topic.name == INPUTS for topic in info(bag).topics):
            note(f"The recording has no {INPUTS}: if anything came from outside, it was cut out. {_FRAMES}")
        raise typer.Exit(FAILED)


_FRAMES = "Where MAVLink frames drove the robots, `thbridge mavlink replay` does without."


def changes_of(given: list[str]) -> tuple[list[Path], list[StudyChange]]:
    """Study files and single changes given by --with."""
    files, changes = [], []
    for text in given:
        key, equals, value = text.partition("=")
        if equals and key and not Path(text).exists():
            changes.append(StudyChange(key.strip(), value))
        elif text.endswith((".yaml", ".yml")):
            files.append(Path(text))
        else:
            problem = f"--with: {text!r} is neither KEY=VALUE nor a study file"
            fail(BAD_INPUT, f"{problem}. Write for example --with robot.amcl.max_particles=500.")
    return files, changes


def other_versions(record: SessionRecord) -> Iterator[str]:
    """Sentences on versions with which a session was recorded, where they differ from those of now."""
    now = versions()
    then = record.versions.items()
    other = [f"{name} {was} then, {now.get(name, 'none')} now" for name, was in then if now.get(name) != was]
    if other:
        yield f"Recorded with other versions, which may make a difference: {'; '.join(other)}."


def _told(done: Replayed, to: Path | None, figures: tuple[RunFigures, RunFigures] | None) -> dict[str, object]:
    told: dict[str, object] = {
        "equal": done.difference is None and done.finished,
        "first_difference": None if done.difference is None else dataclasses.asdict(done.difference),
        "messages": done.messages,
        "ticks": done.ticks,
        "cut_off": done.cut_off,
        "wall_seconds": round(done.wall_seconds, 2),
        "bag": None if to is None else str(to),
    }
    if figures is not None:
        told |= {"recorded": dataclasses.asdict(figures[0]), "replayed": dataclasses.asdict(figures[1])}
    return told


def _show(done: Replayed, figures: tuple[RunFigures, RunFigures] | None) -> None:
    if done.difference is None:
        ending = " The recording was cut off amid its last tick." if done.cut_off else ""
        text = f"All {done.messages} messages of {done.ticks} ticks are the same, bit for bit.{ending}"
        out.print(f"{text} ({done.wall_seconds:.1f} s)", highlight=False)
    else:
        _show_difference(done.difference)
    if figures is not None:
        out.print(_table(*figures))


def _show_difference(difference: Difference) -> None:
    where = f"message {difference.number}, number {difference.topic_number} on {difference.topic}"
    out.print(f"The first difference: {where}, at {difference.seconds:.2f} s: {difference.what}.", highlight=False)
    if difference.fields:
        table = Table("field", "was", "is")
        for field in difference.fields:
            table.add_row(field.field, field.was, field.now)
        out.print(table)


def _table(was: RunFigures, now: RunFigures) -> Table:
    table = Table("", "recorded", "replayed", title="What became of it")
    table.add_row("score", _figure(was.score), _figure(now.score))
    table.add_row("rooms visited", _figure(was.rooms_visited), _figure(now.rooms_visited))
    for index in range(max(len(was.robots), len(now.robots))):
        one, other = (run.robots[index] if index < len(run.robots) else None for run in (was, now))
        name = next(robot.name for robot in (one, other) if robot is not None)
        table.add_section()
        for row in zip(_ROWS, _column(one), _column(other), strict=True):
            table.add_row(f"{name}: {row[0]}", *row[1:])
    return table


_ROWS = ("mean error", "95 % of errors within", "driven", "arrivals", "at, s", "energy left")


def _column(robot: RobotFigures | None) -> tuple[str, ...]:
    """Figures of a robot, one per row; dashes without a robot."""
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
