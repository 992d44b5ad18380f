"""`thbridge study edit`: edit a study file in a form."""

from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import ColourScheme, LookOption
from ui.command_line.terminal import BAD_INPUT, bad_input, command, fail
from ui.windows.display import why_no_window


def study_edit(
    file: Annotated[
        Path,
        typer.Argument(
            help="Study file, folder of a study with people, or file of a form. If a study file does not exist, saving "
            "creates it."
        ),
    ],
    look: LookOption = ColourScheme.SYSTEM,
) -> None:
    """Edit a study file or a study with people in a window, which explains and checks all settings."""
    from ui.first_start.bar import announce_start

    if why_no_window() is None:
        announce_start(look.value)

    from thbridge.experiment.folder import ExperimentFolder
    from ui.commands.study.unfinished import finish_begun_withdrawals
    from ui.first_start.compiling import announce_compiling

    if file.is_dir():
        folder, file = file, ExperimentFolder(file).file
        if not file.is_file():
            new = command("study", "new", "FOLDER")
            fail(
                BAD_INPUT,
                f"{folder}: there is no {file.name}. Create a study with people with `{new}`, or name a file.",
            )
        finish_begun_withdrawals(folder)
    reason = why_no_window()
    if reason is not None:
        fail(BAD_INPUT, f"{reason} Or edit {file} as text, and check it with `thbridge study check`.")
    announce_compiling()
    # These imports take a second, and no other command needs them.
    from ui.windows.study import edit

    with bad_input():
        code = edit(file, look.value)
    raise typer.Exit(code)
