"""The argument that names a recording: a bag of ROS 1, or one of ROS 2, which is read as the bag that it becomes; and
options that name topics in it."""

from pathlib import Path
from typing import Annotated

import typer

from thbridge.files.errors import visible
from ui.command_line.terminal import bad_input, note


def _converted(path: Path) -> Path:
    """Convert a recording of ROS 2, and tell what that leaves out."""
    from thbridge.recording.bag.ros2 import converted, is_other_recording  # noqa: PLC0415 - loads parsers of ROS 2

    if is_other_recording(path):
        with bad_input():
            found = converted(path)
        note(f"{path} is {found.kind}; it is read as the ROS 1 bag that it becomes.")
        for topic, reason in found.left_out.items():
            note(visible(f"{topic} is left out: {reason}."))
    return path


Recording = Annotated[
    Path,
    typer.Argument(
        help="A ROS 1 bag, or the name of a split one; a folder of rosbag2, or an MCAP file.", callback=_converted
    ),
]

Truth = Annotated[
    str | None,
    typer.Option(
        "--truth", metavar="TOPIC", help="Topic of a robot's true poses (PoseStamped and others); by default by name."
    ),
]
Estimated = Annotated[
    str | None,
    typer.Option("--estimate", metavar="TOPIC", help="Topic of its estimated poses; by default by name."),
]
