"""The command line: `thbridge`."""

import logging
import signal
from importlib import metadata
from typing import Annotated

import typer

from ui.command_line.outputs import keep_to_owner
from ui.command_line.terminal import (
    escape_for_standard_output,
    forgive_standard_error,
    note,
    replace_closed_streams,
    whole_standard_output,
)
from ui.commands import programs, templates
from ui.commands.argue import argue
from ui.commands.bag import bag
from ui.commands.bag.export import bag_export
from ui.commands.bag.plot import bag_plot
from ui.commands.desktop import desktop_app
from ui.commands.docs import docs
from ui.commands.doctor import doctor
from ui.commands.group import CommandGroup
from ui.commands.keys import keys_app
from ui.commands.maps.maps import maps_app
from ui.commands.maps.measure import maps_measure
from ui.commands.maps.new import maps_edit, maps_new
from ui.commands.mavlink import mavlink_app
from ui.commands.offline.drive import GoalWithYaw, drive
from ui.commands.offline.localize import localize_command
from ui.commands.offline.plan import plan
from ui.commands.offline.scan import scan
from ui.commands.play import play
from ui.commands.plugins import plugins_app
from ui.commands.replay import replay_command
from ui.commands.report import report
from ui.commands.ros import ros_app
from ui.commands.study.edit import study_edit
from ui.commands.study.experiment import (
    study_backup,
    study_export,
    study_freeze,
    study_new,
    study_power,
    study_preview,
    study_rehearse,
    study_restore,
    study_run,
    study_status,
    study_watch,
    study_withdraw,
)
from ui.commands.study.study import study_app
from ui.commands.suggest import suggest
from ui.commands.sweep.plot import sweep_plot
from ui.commands.sweep.run import sweep_run
from ui.commands.sweep.sweep import sweep_app
from ui.commands.talk import talk_app
from ui.commands.watch import watch

app = typer.Typer(
    cls=CommandGroup,
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


for command in (
    play,
    programs.server,
    programs.simr,
    programs.hider,
    programs.tabui,
    suggest,
    report,
    plan,
    scan,
    watch,
    argue,
    docs,
    doctor,
):
    app.command()(command)
app.command(cls=GoalWithYaw)(drive)
app.command("localize")(localize_command)
bag.bag_app.command("export")(bag_export)
bag.bag_app.command("plot")(bag_plot)
app.command("replay")(replay_command)
app.add_typer(bag.bag_app, name="bag")
maps_app.command("measure")(maps_measure)
maps_app.command("new")(maps_new)
maps_app.command("edit")(maps_edit)
app.add_typer(maps_app, name="maps")
study_app.command("edit")(study_edit)
study_app.command("new")(study_new)
study_app.command("run")(study_run)
study_app.command("rehearse")(study_rehearse)
study_app.command("power")(study_power)
study_app.command("status")(study_status)
study_app.command("watch")(study_watch)
study_app.command("preview")(study_preview)
study_app.command("freeze")(study_freeze)
study_app.command("export")(study_export)
study_app.command("backup")(study_backup)
study_app.command("restore")(study_restore)
study_app.command("withdraw")(study_withdraw)
app.add_typer(study_app, name="study")
app.add_typer(templates.templates_app, name="templates")
app.add_typer(mavlink_app, name="mavlink")
app.add_typer(ros_app, name="ros")
app.add_typer(keys_app, name="keys")
app.add_typer(talk_app, name="talk")
app.add_typer(plugins_app, name="plugins")
app.add_typer(desktop_app, name="desktop")
sweep_app.command("run")(sweep_run)
sweep_app.command("plot")(sweep_plot)
app.add_typer(sweep_app, name="sweep")


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
