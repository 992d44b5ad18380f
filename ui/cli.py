"""The command line: `thbridge`."""

import logging
import signal
from importlib import metadata
from typing import Annotated

import typer

from ui.command_line.groups import CommandGroup, SharingGroup, group
from ui.command_line.outputs import keep_to_owner
from ui.command_line.terminal import (
    escape_for_standard_output,
    forgive_standard_error,
    note,
    replace_closed_streams,
    whole_standard_output,
)


class _SweepGroup(SharingGroup):
    """The commands of `sweep`; `run` may be left out."""

    def parse_args(self, ctx: typer.Context, args: list[str]) -> list[str]:  # type: ignore[override]
        """Take the name of the command, or add it."""
        if args and args[0] not in self.paths and args[0] not in ctx.help_option_names:
            args = ["run", *args]
        return super().parse_args(ctx, args)


class _Commands(CommandGroup):
    """All commands."""

    paths = {  # noqa: RUF012
        "play": "ui.commands.play:play",
        "server": "ui.commands.programs.programs:server",
        "simr": "ui.commands.programs.programs:simr",
        "hider": "ui.commands.programs.programs:hider",
        "tabui": "ui.commands.programs.programs:tabui",
        "suggest": "ui.commands.suggest.suggest:suggest",
        "report": "ui.commands.report:report",
        "plan": "ui.commands.offline.plan:plan",
        "scan": "ui.commands.offline.scan:scan",
        "watch": "ui.commands.watch:watch",
        "argue": "ui.commands.argue.argue:argue",
        "docs": "ui.commands.docs.docs:docs",
        "doctor": "ui.commands.doctor.doctor:doctor",
        "drive": "ui.commands.offline.drive:drive_app",
        "localize": "ui.commands.offline.localize:localize",
        "replay": "ui.commands.replay.replay:replay",
        "bag": group(
            "Look into recordings and mend them.",
            {
                "ui.commands.bag.bag:bag_": "info check reindex cut to-mcap",
                "ui.commands.bag.export:bag_": "export",
                "ui.commands.bag.plot:bag_": "plot",
            },
        ),
        "maps": group(
            "Maps: the arenas that robots drive in.",
            {
                "ui.commands.maps.maps:maps_": "check list",
                "ui.commands.maps.measure:maps_": "measure",
                "ui.commands.maps.new:maps_": "new edit",
            },
            SharingGroup,
        ),
        "study": group(
            "Study files: everything that can be set, in one YAML file.",
            {
                "ui.commands.study.study:study_": "init check",
                "ui.commands.study.edit:study_": "edit",
                "ui.commands.study.experiment:study_": "new run rehearse power status watch preview freeze export "
                "backup restore withdraw",
            },
        ),
        "templates": group(
            "Template sets: treasures, their properties and pictures, and the sentences of robots.",
            {"ui.commands.templates.templates:templates_": "check edit list new"},
            SharingGroup,
        ),
        "mavlink": group(
            "MAVLink: watch and command robots that speak it, such as those of `thbridge play --mavlink`.",
            {"ui.commands.mavlink.mavlink:mavlink_": "status goto replay"},
        ),
        "ros": group(
            "ROS 1: our message types for it, a master, and what rviz and Foxglove show.",
            {"ui.commands.ros:ros_": "messages master rviz foxglove"},
        ),
        "keys": group(
            "Keys by which programs and windows take part from other machines: made, listed, revoked.",
            {"ui.commands.keys:keys_": "new list revoke"},
        ),
        "talk": "ui.commands.talk.talk:talk_app",
        "plugins": group(
            "Plug-ins: programs of your lab that replace a part, found by their entry points.",
            {"ui.commands.plugins.plugins:plugins_": "list check"},
        ),
        "desktop": group(
            "Open bags by a double click on a Linux desktop: install or remove menu entry, file types and icon.",
            {"ui.commands.desktop.desktop:desktop_": "install remove"},
        ),
        "sweep": group(
            "Sweeps: many games over the factors of a design. `sweep DESIGN.yaml` is `sweep run DESIGN.yaml`.",
            {
                "ui.commands.sweep.sweep:sweep_": "status collect",
                "ui.commands.sweep.run:sweep_": "run",
                "ui.commands.sweep.plot:sweep_": "plot",
            },
            _SweepGroup,
        ),
    }


app = typer.Typer(
    cls=_Commands,
    name="thbridge",
    help="A treasure hunt shared by people and teams of robots: simulate it, play it, record it.",
    no_args_is_help=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
)


def _tell_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"thbridge {metadata.version('thbridge')}")
        raise typer.Exit


@app.callback()
def thbridge(
    _version: Annotated[
        bool, typer.Option("--version", callback=_tell_version, is_eager=True, help="Tell the version, and end.")
    ] = False,
) -> None:
    """Take what stands before a command."""


class NoteHandler(logging.Handler):
    """Log records as lines on standard error, above a progress bar where there is one."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print a record in one line; those of an exception are as many as Python prints."""
        note(self.format(record))


def main() -> None:
    """Run the command line."""
    keep_to_owner()
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        # Begun by `&` in a script. Else Ctrl-C would stop a server or not, by the moment, and SIGTERM not stop a kiosk.
        signal.signal(signal.SIGINT, signal.default_int_handler)
    replace_closed_streams()
    forgive_standard_error()
    escape_for_standard_output()
    logging.basicConfig(level=logging.WARNING, format="%(message)s", handlers=[NoteHandler()])
    with whole_standard_output():
        app()
