"""`thbridge replay`: run a recording again, unchanged or with changes."""

import math
from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import AsJson, ProgressKind, ProgressOption, SimulatedParticipant
from ui.command_line.outputs import make_copy_ready
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, fail, note, print_json


def replay(
    bag: Annotated[Path, typer.Argument(help="Recording of `thbridge play` or `thbridge simr`.")],
    rate: Annotated[
        float | None, typer.Option(help="Simulated seconds per real second; default: full speed.", min=0.01, max=1000)
    ] = None,
    start: Annotated[
        float,
        typer.Option("--from", help="Run at full speed and print nothing up to this session time, in seconds.", min=0),
    ] = 0.0,
    to: Annotated[Path | None, typer.Option(help="Bag to write the new recording to.")] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--with",
            metavar="KEY=VALUE|FILE.yaml",
            help="Change a key of the recorded study, for example `--with seed=2`, or all keys that a FILE.yaml "
            "contains; keep the recorded inputs. Can be repeated.",
        ),
    ] = None,
    participant: SimulatedParticipant = None,
    beside: Annotated[Path, typer.Option(help="Folder from which relative paths in the study start.")] = Path(),
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Run a recording again: give its inputs to a new session, and compare the messages of both.

    The exit code is 0 if all messages are bit-identical. Otherwise it is 1, and the first difference is printed. With
    `--with` or `--participant`, the command compares figures of both runs, and a difference is no failure.
    """
    from ui.first_start.bar import announce_start

    announce_start()

    from itertools import zip_longest
    from tempfile import TemporaryDirectory

    from sim.common.observations import TICK
    from thbridge.analysis.comparison import RunFigures, figures_of
    from thbridge.analysis.report.builder import read_games
    from thbridge.app.compose.setting import read_setting
    from thbridge.app.replay.replay import ReplayOptions, recorded_study, session_of
    from thbridge.app.replay.replay import replay as run_again
    from thbridge.app.session.session import TickRecord
    from thbridge.recording.bag.reading.reader import info, messages
    from thbridge.recording.bag.ros2 import has_cdr
    from thbridge.recording.recordings import BAG, MCAP
    from thbridge.ros.names import INPUTS
    from thbridge.study.overrides import with_changes
    from thbridge.text_protocol.wire import legacy
    from ui.command_line.event_loop import run
    from ui.command_line.progress import shown_progress
    from ui.command_line.settings import changes_of, with_strategy
    from ui.command_line.story import print_story
    from ui.commands.replay.difference import other_versions, replayed_as_json, show_replayed
    from ui.first_start.compiling import compile_ahead

    files, assignments = changes_of(changes or [])
    with bad_input():
        record = session_of(bag)
        study = recorded_study(bag, record)
        setting = read_setting(with_strategy(with_changes(study, files, assignments), participant), beside)
        recorded_seconds = info(bag).duration
    if participant is not None and not record.participant:
        fail(BAD_INPUT, f"--participant: in {bag}, another program was the participant. Omit the option.")
    what_if = bool(changes) or participant is not None
    for sentence in other_versions(record):
        note(sentence)
    if to is not None:
        make_copy_ready(to, bag, setting.study.recording.compression)

    rooms = setting.map.room_names

    refused = 0

    def follow(moment: TickRecord) -> None:
        nonlocal refused
        tell("simulated seconds", int(moment.tick * TICK), math.ceil(recorded_seconds))
        refused += sum(each.program == legacy.TABUI for each in moment.refusals)
        if not as_json:
            print_story(moment, rooms)

    compile_ahead(whole_hunt=False)
    figures: list[tuple[RunFigures | None, RunFigures | None]] = []
    with TemporaryDirectory(prefix="thbridge-") as folder:
        kept = to or (Path(folder) / f"replay{MCAP if has_cdr(bag) else BAG}" if what_if else None)
        options = ReplayOptions(rate or 0.0, start, kept, kept is not None, participant)
        with shown_progress(progress, "replay", beside_text=not as_json) as tell:
            done = run(run_again(bag, setting, options, follow))
        if what_if and kept is not None and done.finished:
            with bad_input():
                recorded, replayed = (map(figures_of, read_games(messages(each))) for each in (bag, kept))
                figures += zip_longest(recorded, replayed)
    if as_json:
        print_json(replayed_as_json(done, to, figures))
    else:
        show_replayed(done, figures)
    if what_if and participant is None and refused:
        note(f"Requests of the participant that were refused: {refused}. {_SAME_TIME}")
        if record.participant:
            note("To compare whole hunts, use a simulated participant instead of the recorded one: --participant NAME.")
    if not done.finished:
        fail(FAILED, "Stopped before the end of the recording.")
    if done.difference is not None and not what_if:
        if not any(topic.name == INPUTS for topic in info(bag).topics):
            note(f"The recording has no {INPUTS}: any inputs from outside have been removed. {_FRAMES}")
        raise typer.Exit(FAILED)


_SAME_TIME = "Requests are repeated at the recorded times, even if robots are now in other places."
_FRAMES = "If MAVLink frames drove the robots, use `thbridge mavlink replay`, which needs no inputs."
