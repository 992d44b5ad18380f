"""Commands of `thbridge templates`: sets of treasures with their properties and pictures, and robots' sentences."""

from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import AsJson, ColourScheme, LookOption
from ui.command_line.terminal import BAD_INPUT, bad_input, command, fail, note, print_json, say
from ui.windows.display import why_no_window

SetName = Annotated[str, typer.Argument(help="Name of a template set, or path of its folder.")]


def templates_check(name: SetName, as_json: AsJson = False) -> None:
    """Check a template set, and print what it contains."""
    from ui.commands.templates.sets import folder_of, read_set
    from ui.model.template_set.preview import NOWHERE, contents, sentences, translations

    templates, folder = read_set(name), folder_of(name)
    if as_json:
        print_json({"ok": True, "properties": len(templates.properties), "treasures": len(templates.kinds)})
        return
    end = f"{len(templates.kinds)} treasures, {len(templates.properties)} properties: no faults"
    contained = (*contents(templates), *sentences(templates, NOWHERE), *translations(templates, folder, NOWHERE))
    for line in (*contained, *(f"warning: {warning}" for warning in templates.warnings), end):
        say(line)


def templates_edit(
    folder: Annotated[Path, typer.Argument(help="Folder of your own template set; see `thbridge templates new`.")],
    look: LookOption = ColourScheme.SYSTEM,
) -> None:
    """Edit a template set in a window: sentences, treasures and pictures, with a preview of what robots say."""
    from ui.commands.templates.sets import folder_of

    reason = why_no_window()
    if reason is not None:
        fail(
            BAD_INPUT,
            f"{reason} Or edit its files as text, and check them with `{command('templates', 'check', folder)}`.",
        )
    own = folder_of(f"{folder}/")
    # These imports take a second, and no other command needs them.
    from ui.windows.templates import edit_templates

    with bad_input():
        code = edit_templates(own, look.value)
    raise typer.Exit(code)


def templates_list() -> None:
    """List the template sets that come with thbridge."""
    from thbridge.files.resources import shipped

    for name in shipped().names("templates"):
        say(name)


def templates_new(
    folder: Annotated[Path, typer.Argument(help="Folder to create; must not exist.")],
    like: Annotated[str, typer.Option(help="Name or folder of the template set to copy.")] = "four-properties",
) -> None:
    """Create your own template set as a copy of another set, without the texts in further languages."""
    from thbridge.files.disk.whole import new_folder
    from ui.commands.templates.sets import copy_set, folder_of

    source = folder_of(like)
    with bad_input(), new_folder(folder) as new:
        copy_set(source, new)
    note(f"Wrote {folder}, a copy of {like}. Change its files, then run `{command('templates', 'check', folder)}`.")
