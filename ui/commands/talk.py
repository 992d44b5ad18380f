"""`thbridge talk`: dialogue games, checked and explained."""

from pathlib import Path
from typing import Annotated

import typer

from ui.commands.group import CommandGroup
from ui.options import AsJson
from ui.terminal import BAD_INPUT, print_json, say

talk_app = typer.Typer(
    cls=CommandGroup,
    help="Dialogue games between a robot and a person: who may say what, when, and how it ends.",
    no_args_is_help=True,
)


@talk_app.command("check")
def talk_check(
    folders: Annotated[
        list[Path] | None,
        typer.Argument(help="Folders of games of yours; by default those that come with the project."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Check files of dialogue games, and tell which games there are, who may say what in them, and how they end."""
    from ui.actions.talk_check import check_folder, shipped_folder

    checked = [check_folder(folder) for folder in folders or [shipped_folder()]]
    faults = [fault for each in checked for fault in each.faults]
    if as_json:
        print_json({"ok": not faults, "folders": [each.as_json() for each in checked]})
    else:
        for each in checked:
            for line in each.lines():
                say(line)
    if faults:
        raise typer.Exit(BAD_INPUT)


@talk_app.command("words")
def talk_words() -> None:
    """List the words of games' files with their meanings: conditions, effects, slots, turns and ends."""
    from ui.actions.talk_check import words

    for line in words():
        say(line)
