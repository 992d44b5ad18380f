"""Command line: `thbridge`."""

import logging
import signal
from importlib import metadata
from typing import Annotated

import typer

from ui.command_line.groups import CommandGroup, SharingGroup, group
from ui.command_line.outputs import keep_to_owner
from ui.command_line.signals import ended_like_ctrl_c
from ui.command_line.terminal import (
    escape_for_standard_output,
    forgive_standard_error,
    note,
    replace_closed_streams,
    whole_standard_output,
)


class _SweepGroup(SharingGroup):
    """Commands of `sweep`; the name `run` is optional."""

    def parse_args(self, ctx: typer.Context, args: list[str]) -> list[str]:  # type: ignore[override]
        """Parse the arguments; if they name no command, the command is `run`."""
        if args and args[0] not in self.paths and args[0] not in ctx.help_option_names:
            args = ["run", *args]
        return super().parse_args(ctx, args)


class _Commands(CommandGroup):
    """All commands of `thbridge`."""

    paths = {  # noqa: RUF012
        "play": "ui.commands.play:play",
        "serve": "ui.commands.serve:serve",
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
            "Inspect, check, repair, convert and plot recordings.",
            {
                "ui.commands.bag.bag:bag_": "info check reindex cut to-mcap",
                "ui.commands.bag.export:bag_": "export",
                "ui.commands.bag.plot:bag_": "plot",
            },
        ),
        "maps": group(
            "Maps: list, check, measure, create and edit the maps on which robots drive.",
            {
                "ui.commands.maps.maps:maps_": "check list",
                "ui.commands.maps.measure:maps_": "measure",
                "ui.commands.maps.new:maps_": "new edit",
            },
            SharingGroup,
        ),
        "study": group(
            "Study files (one YAML file with all settings), and studies with people.",
            {
                "ui.commands.study.study:study_": "init check",
                "ui.commands.study.edit:study_": "edit",
                "ui.commands.study.experiment:study_": "new run codes rehearse power status watch preview freeze "
                "export backup restore withdraw",
            },
        ),
        "templates": group(
            "Template sets: treasures with their properties and pictures, and the robots' sentences.",
            {"ui.commands.templates.templates:templates_": "check edit list new"},
            SharingGroup,
        ),
        "mavlink": group(
            "MAVLink: watch and command robots that use this protocol, such as those of `thbridge play --mavlink`.",
            {"ui.commands.mavlink.mavlink:mavlink_": "status goto replay"},
        ),
        "ros": group(
            "ROS 1: message types, a ROS master, and views for rviz and Foxglove.",
            {"ui.commands.ros:ros_": "messages master rviz foxglove"},
        ),
        "ros2": group(
            "ROS 2: a zenoh router.",
            {"ui.commands.ros2:ros2_": "router"},
        ),
        "keys": group(
            "Keys: create, list and revoke the keys with which programs and windows on other machines connect.",
            {"ui.commands.keys:keys_": "new list revoke"},
        ),
        "talk": "ui.commands.talk.talk:talk_app",
        "plugins": group(
            "Plug-ins: list and check programs of your lab that replace a part of thbridge (Python entry points).",
            {"ui.commands.plugins.plugins:plugins_": "list check"},
        ),
        "desktop": group(
            "Linux desktop: open bags with a double click (menu entry, file types, icon).",
            {"ui.commands.desktop.desktop:desktop_": "install remove"},
        ),
        "sweep": group(
            "Sweeps: play many games in the conditions of a design. `sweep DESIGN.yaml` means `sweep run DESIGN.yaml`.",
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
    help="A treasure hunt for people and teams of robots: simulate, play, record and analyze it.",
    no_args_is_help=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"thbridge {metadata.version('thbridge')}")
        raise typer.Exit


@app.callback()
def thbridge(
    _version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Handle the options given before a command."""


class NoteHandler(logging.Handler):
    """Handler that prints log records on standard error, above the progress bar if one is shown."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print a record on one line, or on several lines if it has a traceback."""
        note(self.format(record))


def main() -> None:
    """Run the command line."""
    keep_to_owner()
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        # A shell script that starts a command with `&` makes it ignore SIGINT. Then Ctrl-C would not always stop a
        # server, and SIGTERM would not stop a kiosk.
        signal.signal(signal.SIGINT, signal.default_int_handler)
    replace_closed_streams()
    forgive_standard_error()
    escape_for_standard_output()
    logging.basicConfig(level=logging.WARNING, format="%(message)s", handlers=[NoteHandler()])
    with ended_like_ctrl_c(), whole_standard_output():
        app()
