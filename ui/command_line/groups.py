"""Groups of commands."""

from collections.abc import Mapping
from importlib import import_module
from typing import cast

import typer
import typer.main
from typer.core import TyperCommand, TyperGroup

from ui.command_line.conversion import convert_if_given
from ui.command_line.outputs import share_outputs
from ui.command_line.terminal import faults_of_files


class CommandGroup(TyperGroup):
    """Group of commands. Each command is imported when it is first needed.

    Attributes:
        paths: for each command, the path of its function, Typer application or group: the module, a colon, and the
            name.
    """

    paths: "Mapping[str, str | CommandGroup]"

    def parse_args(self, ctx: typer.Context, args: list[str]) -> list[str]:  # type: ignore[override]
        """Parse the options given before a command."""
        convert_if_given(self, ctx)
        return super().parse_args(ctx, args)

    def list_commands(self, ctx: typer.Context) -> list[str]:  # type: ignore[override]
        """Return the names of the commands."""
        return [*self.paths]

    def get_command(self, ctx: typer.Context, cmd_name: str) -> TyperCommand | None:  # type: ignore[override]
        """Import a command. If its name is unknown, import all commands, so that similar names can be suggested."""
        for name in [cmd_name] if cmd_name in self.paths else self.paths:
            if name not in self.commands:
                path = self.paths[name]
                command = _command_at(path) if isinstance(path, str) else path
                command.name = name
                self.add_command(command)
        found = cast("TyperCommand | None", super().get_command(ctx, cmd_name))
        if found is not None:
            convert_if_given(found, ctx)
        return found

    def invoke(self, ctx: typer.Context) -> object:  # type: ignore[override]
        """Run a command; print a message about faults of files that the command does not report itself."""
        with faults_of_files():
            return super().invoke(ctx)


class SharingGroup(CommandGroup):
    """Group of commands whose files other accounts may read, with the permissions of the user's umask."""

    def invoke(self, ctx: typer.Context) -> object:  # type: ignore[override]
        """Run a command."""
        share_outputs()
        return super().invoke(ctx)


def group(
    help: str,  # noqa: A002
    commands: Mapping[str, str],
    kind: type[CommandGroup] = CommandGroup,
) -> CommandGroup:
    """Return a group that shows its help if no command is given.

    Args:
        help: help text of the group.
        commands: see `paths_of`.
        kind: class of the group.
    """
    made = kind(help=help, no_args_is_help=True)
    made.paths = paths_of(commands)
    return made


def paths_of(commands: Mapping[str, str]) -> dict[str, str]:
    """Return the path of each command.

    Args:
        commands: for each beginning of a path, the names of commands, separated by blanks. The path of a command's
            function consists of this beginning and the command's name.
    """
    return {name: start + name.replace("-", "_") for start, names in commands.items() for name in names.split()}


def _command_at(path: str) -> TyperCommand | TyperGroup:
    module, _, attribute = path.partition(":")
    found = getattr(import_module(module), attribute)
    if isinstance(found, typer.Typer):
        app = found
    else:
        app = typer.Typer(add_completion=False)
        app.command()(found)
    return cast("TyperCommand | TyperGroup", typer.main.get_command(app))
