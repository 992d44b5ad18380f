"""Commands of `thbridge ros`: message types for an installed ROS, a master, and views for rviz and Foxglove."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thbridge.sockets.addresses import LOCALHOST, ROS_MASTER_PORT, ListeningAddress
from thbridge.sockets.errors import CannotListen
from ui.command_line.options import MapName, OpenTo, Robots, StudyFile
from ui.command_line.outputs import STANDARD_OUTPUT
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, note

if TYPE_CHECKING:
    from sim.common.grid import OccupancyGrid
    from sim.parameters import RobotParameters


def ros_messages(
    folder: Annotated[Path, typer.Argument(help="Folder for the packages, such as `src` of a catkin workspace.")],
) -> None:
    """Write thbridge's message types as the ROS package `thbridge_msgs`.

    If mavros is not installed, also write its message types that thbridge uses.
    """
    import os

    from thbridge.files.ros.package import write_packages
    from thbridge.recording.bag.options import Readers

    os.umask(Readers.EVERYONE.umask)  # The message types contain no secrets, and many users share a system's ROS.
    with bad_input():
        packages = write_packages(folder)
    for package in packages:
        note(f"Wrote {package}.")


def ros_master(
    host: Annotated[
        str, typer.Option(help="Address to listen on; 0.0.0.0 also accepts the other machines of --open-to.")
    ] = LOCALHOST,
    port: Annotated[int, typer.Option(help="TCP port; 0 means any free port.", min=0, max=65535)] = ROS_MASTER_PORT,
    open_to: OpenTo = None,
) -> None:
    """Run a ROS master, as a substitute for roscore, until the command is stopped."""
    import asyncio

    from thbridge.rosgraph.sockets import master_server
    from thbridge.rosgraph.sockets.joining import GraphAddress
    from thbridge.sockets.admission import Admission
    from thbridge.study.study_file import Study
    from ui.command_line.networks import check_doors, with_open_to

    study = with_open_to(Study(), open_to)
    check_doors(study, None, None, GraphAddress(host=host), serves_text=False)

    def ready(where: ListeningAddress | CannotListen) -> None:
        if isinstance(where, CannotListen):
            fail(BAD_INPUT, str(where))
        print(f"listening on {where.host}:{where.port}", flush=True)  # noqa: T201 - programs wait for this line

    asyncio.run(master_server.serve(host, port, ready, Admission.to(study.open_to)))


ViewFile = Annotated[Path | None, typer.Option("--to", help="File to write; `-`, the default, is standard output.")]


def ros_rviz(
    study_file: StudyFile = None,
    robots: Robots = None,
    map_name: MapName = None,
    to: ViewFile = None,
    ros2: Annotated[
        bool, typer.Option("--ros2", help="Write a configuration of rviz2, for sessions on ROS 2 graphs.")
    ] = False,
) -> None:
    """Write an rviz configuration that shows the whole team of a study; open it with `rviz -d FILE`."""
    from thbridge.ros.rviz import configuration
    from thbridge.ros2.rviz import rviz2_configuration

    # Nodes of ROS 2 have this parameter each. Without it, rviz2 hides the frames of robots as too old.
    write, command = configuration, "rviz -d {to}"
    if ros2:
        write, command = rviz2_configuration, "rviz2 -d {to} --ros-args -p use_sim_time:=true"
    _write_view(write, study_file, robots, map_name, to, f"Open it with: {command}")


def ros_foxglove(
    study_file: StudyFile = None, robots: Robots = None, map_name: MapName = None, to: ViewFile = None
) -> None:
    """Write a Foxglove layout that shows the whole team of a study, for sessions with --foxglove and for recordings."""
    from thbridge.ros.foxglove_layout import foxglove_layout

    _write_view(foxglove_layout, study_file, robots, map_name, to, "Import it in Foxglove: Layouts, Import from file")


def _write_view(
    write: Callable[[Sequence[RobotParameters], OccupancyGrid], str],
    study_file: Path | None,
    robots: int | None,
    map_name: str | None,
    to: Path | None,
    use: str,
) -> None:
    """Write a configuration of rviz or Foxglove for a study's team.

    `write` returns its text for the parameters of the robots and the map.
    """
    from sim.common.robot_numbers import robot_numbers
    from thbridge.files.disk.whole import write_whole
    from ui.command_line.settings import map_of, study_of

    study = study_of(study_file, {"robots": robots, "map": map_name})
    grid = map_of(study, study_file).grid
    text = write([study.software(number) for number in robot_numbers(study.robots)], grid)
    if to is None or to == STANDARD_OUTPUT:
        print(text, end="")  # noqa: T201 - the requested output
        return
    with bad_input():
        write_whole(to, text.encode(), "choose another file with --to")
    note(f"Wrote {to}. {use.format(to=to)}")
