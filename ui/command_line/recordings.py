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
        note(f"{path} is {found.kind}; reading it as a converted ROS 1 bag.")
        for topic, reason in found.left_out.items():
            note(visible(f"{topic} is omitted: {reason}."))
    return path


Recording = Annotated[
    Path,
    typer.Argument(
        help="A ROS 1 bag (of a split one, the common name, such as `hunt.bag`), a rosbag2 folder, or an MCAP file.",
        callback=_converted,
    ),
]

Truth = Annotated[
    str | None,
    typer.Option(
        "--truth",
        metavar="TOPIC",
        help="Topic of a robot's true poses (PoseStamped and others); by default found by name.",
    ),
]
Estimated = Annotated[
    str | None,
    typer.Option("--estimate", metavar="TOPIC", help="Topic of its estimated poses; by default found by name."),
]
