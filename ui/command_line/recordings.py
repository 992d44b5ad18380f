"""Argument that names a recording, and options that name topics in it.

A recording of ROS 2 is converted to a ROS 1 bag before it is read.
"""

from pathlib import Path
from typing import Annotated

import typer

from thbridge.files.errors import visible
from ui.command_line.terminal import bad_input, note


def _converted(path: Path) -> Path:
    """Convert a recording of ROS 2, and print which parts the conversion omits."""
    from thbridge.recording.bag.ros2 import converted, is_other_recording  # noqa: PLC0415 - loads parsers of ROS 2

    if is_other_recording(path):
        with bad_input():
            found = converted(path)
        note(f"{path} is {found.kind}. It is read as a converted ROS 1 bag.")
        for topic, reason in found.left_out.items():
            note(visible(f"{topic} is omitted: {reason}."))
    return path


Recording = Annotated[
    Path,
    typer.Argument(
        help="A ROS 1 bag, a rosbag2 folder, or an MCAP file. For a split bag, write the name without the "
        "numbers of the files, such as `hunt.bag`.",
        callback=_converted,
    ),
]

Truth = Annotated[
    str | None,
    typer.Option(
        "--truth",
        metavar="TOPIC",
        help="Topic of a robot's true poses (PoseStamped and other types). By default, the program finds it by name.",
    ),
]
Estimated = Annotated[
    str | None,
    typer.Option(
        "--estimate",
        metavar="TOPIC",
        help="Topic of the same robot's estimated poses. By default, the program finds it by name.",
    ),
]
