"""`thbridge study init` and `study check`."""

from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ui.command_line.outputs import STANDARD_OUTPUT
from ui.command_line.terminal import BAD_INPUT, bad_input, command, fail, note, say

if TYPE_CHECKING:
    from thbridge.study.study_file import Study


def study_init(
    file: Annotated[Path, typer.Argument(help="File to write; must not exist. `-` is standard output.")],
) -> None:
    """Write the built-in study `standard` as a file with all keys and comments."""
    from thbridge.files.disk.whole import write_whole
    from thbridge.study.text import commented_study

    if file == STANDARD_OUTPUT:
        print(commented_study(), end="")  # noqa: T201 - the requested output
        return
    if file.exists():
        fail(BAD_INPUT, f"{file}: this file already exists. Choose another name.")
    with bad_input():
        write_whole(file, commented_study().encode(), "choose another folder")
    note(f"Wrote {file}. Play it with `{command('play', file)}`.")


def study_check(
    file: Annotated[Path, typer.Argument(help="Study file, or folder of a study with people.")],
) -> None:
    """Check a study file or a study with people, and all files that it names."""
    from thbridge.app.compose.setting import advice_on_language, missing_in
    from thbridge.study.study_file import check_manners, load_study
    from ui.command_line.settings import note_doubts, setting_of, study_of

    if file.is_dir():
        from thbridge.app.compose.machine import versions
        from thbridge.experiment.check import check_experiment
        from thbridge.experiment.design.advice import advice_on, people_in_words
        from thbridge.experiment.folder import ExperimentFolder
        from thbridge.experiment.sockets.markers import why_no_markers
        from ui.command_line.networks import check_doors
        from ui.commands.study.unfinished import finish_begun_withdrawals

        finish_begun_withdrawals(file)
        with bad_input():
            design, kept = check_experiment(ExperimentFolder(file), versions())
        for study in chain.from_iterable(cell.studies for cell in design.cells):
            check_doors(study)
        state = "accepted with its faults, because people have taken part" if kept else "no faults"
        say(f"{file}: {state}; {people_in_words(design)}")
        for fault in kept:
            note(f"A new study would be refused: {fault}")
        for advice in advice_on(design):
            note(advice)
        if design.file.markers and (reason := why_no_markers()):
            note(reason)
        note(f"Rehearse the study with simulated people: `{command('study', 'rehearse', file, '--to', 'rehearsal')}`.")
        return
    setting = setting_of(study_of(file, {}), file)
    note_doubts(setting)
    _check_start(setting.study, file)
    with bad_input():
        check_manners(load_study(file))
        lacking, missing = advice_on_language(setting.study, file.parent), missing_in(setting.study, file.parent)
    say(f"{file}: no faults")
    for fault in missing:
        note(f"Participants would see another language: {fault}")
    if lacking is not None:
        note(f"{lacking}.")


def _check_start(study: "Study", file: Path) -> None:
    """End the program with the message of a start, if a start of the study without options would be refused."""
    from thbridge.study.robots_from import RobotsFrom
    from ui.command_line.keys import keys_of
    from ui.command_line.listening import ports_of, ros2_of, watch_of
    from ui.command_line.networks import check_doors
    from ui.command_line.options import Ros2Options, WatchOptions
    from ui.commands.programs.client import note_settings_without_effect

    ring, door = keys_of(study, file, None), None
    if study.robots_from.is_real:
        note_settings_without_effect(study)
    else:
        ports_of(study, file, None)
        door = watch_of(study, file, WatchOptions(), ring)
    # A study with simulated robots may join its ROS 2 graph by an option.
    robots_graph = ros2_of(study, Ros2Options(join_ros2=study.robots_from is RobotsFrom.ROS2))
    check_doors(study, ring, door, None, robots_graph or study.ros2.address)
