"""The commands about ROS 1: our message types for a ROS that is installed, and a master where none is."""

import asyncio
from pathlib import Path
from typing import Annotated

import typer

from thbridge.adapters.ros_package import write_package
from thbridge.adapters.rosgraph import master_server
from thbridge.adapters.text_server import CannotListen, Listening
from ui.terminal import BAD_INPUT, bad_input, fail, note

ros_app = typer.Typer(help="ROS 1: our message types for it, and its master.", no_args_is_help=True)


@ros_app.command("messages")
def ros_messages(folder: Annotated[Path, typer.Argument(help="Where the package goes, e.g. a catkin `src`.")]) -> None:
    """Write our message types as the ROS package `thbridge_msgs`."""
    with bad_input():
        package = write_package(folder)
    note(f"Wrote {package}.")


@ros_app.command("master")
def ros_master(
    host: Annotated[
        str, typer.Option(help="Address to listen on; 0.0.0.0 lets other machines in, all of them.")
    ] = master_server.DEFAULT_HOST,
    port: Annotated[
        int, typer.Option(help="TCP port; 0 takes a free one.", min=0, max=65535)
    ] = master_server.DEFAULT_PORT,
) -> None:
    """Run a ROS master, in place of roscore, until stopped."""

    def ready(where: Listening | CannotListen) -> None:
        if isinstance(where, CannotListen):
            fail(BAD_INPUT, str(where))
        print(f"listening on {where.host}:{where.port}", flush=True)  # noqa: T201 - programs wait for this line

    asyncio.run(master_server.serve(host, port, ready))
