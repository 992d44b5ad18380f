"""`thbridge study init` and `study check`."""

from pathlib import Path
from typing import Annotated

import typer

from ui.commands.group import CommandGroup
from ui.outputs import STANDARD_OUTPUT
from ui.terminal import BAD_INPUT, bad_input, command, fail, note, say

study_app = typer.Typer(
    cls=CommandGroup,
    help="Study files: everything that can be set, in one YAML file.",
    no_args_is_help=True,
)


@study_app.command("init")
def study_init(
    file: Annotated[Path, typer.Argument(help="The file to write; must not exist. `-` is standard output.")],
) -> None:
    """Write a study file with every key at its default, commented."""
    from thbridge.files.disk.whole import write_whole
    from thbridge.study.text import commented_study

    if file == STANDARD_OUTPUT:
        print(commented_study(), end="")  # noqa: T201 - this is what was asked for
        return
    if file.exists():
        fail(BAD_INPUT, f"{file}: there is such a file already. Choose another name.")
    with bad_input():
        write_whole(file, commented_study().encode(), "choose another folder")
    note(f"Wrote {file}. Run it with `{command('play', file)}`.")


@study_app.command("check")
def study_check(
    file: Annotated[Path, typer.Argument(help="A study file, or the folder of a study with people.")],
) -> None:
    """Check a study file, or a study with people, and everything it names."""
    from ui.settings import setting_of, study_of

    if file.is_dir():
        from thbridge.experiment.design.experiment_file import notices_of
        from thbridge.experiment.folder import ExperimentFolder
        from thbridge.experiment.markers import why_no_markers
        from ui.actions.unfinished_study import finish_begun_withdrawals

        finish_begun_withdrawals(file)
        with bad_input():
            design = ExperimentFolder(file).read(with_files=True)
        each = f"{len(design.conditions)} conditions for each" if len(design.conditions) > 1 else "one condition"
        say(f"{file}: no faults; {design.allocation.size} people, {each}")
        for notice in notices_of(design):
            note(notice)
        if design.file.markers and (reason := why_no_markers()):
            note(reason)
        note(f"Rehearse it with simulated people: `{command('study', 'rehearse', file, '--to', 'rehearsal')}`.")
        return
    setting_of(study_of(file, {}), file)
    say(f"{file}: no faults")
