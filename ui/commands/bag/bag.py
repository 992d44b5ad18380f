"""`thbridge bag`: inspect, check, repair, cut and convert recordings."""

import math
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from thbridge.files.errors import visible
from thbridge.recording.bag.options import Compression
from thbridge.recording.recordings import parts_of
from ui.command_line.options import AsJson, ProgressKind, ProgressOption
from ui.command_line.outputs import STANDARD_OUTPUT, destination, share_no_output
from ui.command_line.recordings import Recording
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, fail, note, print_json, say

MOST_LOSSES = 20
"""Maximum number of lost parts that a repair lists."""

Out = Annotated[
    Path | None, typer.Option("--to", help="File to write; default: next to the bag. `-` is standard output.")
]


Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace an existing file of this name.")]


class Packing(StrEnum):
    """Compression of chunks in an MCAP file."""

    ZSTD = "zstd"
    LZ4 = "lz4"
    NONE = "none"


class Profile(StrEnum):
    """Version of ROS for which an MCAP file is written."""

    ROS1 = "ros1"
    ROS2 = "ros2"


def bag_info(
    bag: Recording,
    hashed: Annotated[
        bool,
        typer.Option("--hash", help="Also print the hash of all messages, except the description of the session."),
    ] = False,
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Print what a bag contains: topics, types, rates, gaps, and the session if thbridge recorded it."""
    import msgspec

    from thbridge.analysis.bag_summary import summarise
    from thbridge.recording.digest import digest_of
    from ui.command_line.progress import shown_progress
    from ui.commands.bag.summary import show_summary

    with bad_input(), shown_progress(progress, "bag info"):
        found = summarise(bag)
        digest = {"hash": digest_of(bag)} if hashed else {}
    if as_json:
        print_json(msgspec.to_builtins(found, enc_hook=str) | digest)
        return
    show_summary(found)
    for name, value in digest.items():
        say(f"{name} of all messages: {value}")


def bag_check(bag: Recording, progress: ProgressOption = ProgressKind.AUTO, as_json: AsJson = False) -> None:
    """Check whether rosbag, rviz, Foxglove, PlotJuggler and evo can read a bag, and print all problems."""
    from thbridge.analysis.check import judge
    from thbridge.recording.bag.reading.scan import scan
    from ui.command_line.progress import shown_progress
    from ui.commands.bag.judgements import judgements_as_json, show_judgements

    with bad_input(), shown_progress(progress, "bag check"):
        judgements = {part: judge(scan(part)) for part in parts_of(bag)}
    if as_json:
        print_json(judgements_as_json(judgements))
    else:
        show_judgements(judgements)
    if not all(judgement.ok for judgement in judgements.values()):
        raise typer.Exit(FAILED)


def bag_reindex(
    bag: Annotated[Path, typer.Argument(help="Bag that ends abruptly, because its program was killed.")],
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Recover a bag that ends abruptly. The original file is renamed."""
    import msgspec

    from thbridge.recording.bag.repair import reindex as reindex_bag
    from ui.command_line.progress import shown_progress

    with bad_input(), shown_progress(progress, "bag reindex"):
        done = reindex_bag(bag)
    lost = done.lost_bytes > 0 and done.messages == 0
    if as_json:
        print_json(msgspec.to_builtins(done, enc_hook=str))
        raise typer.Exit(FAILED if lost else 0)
    say(f"Recovered {done.messages} messages into {done.path}; the original is {done.backup}.")
    if done.lost_bytes:
        say(f"{done.lost_bytes} bytes could not be read and are lost:")
        for loss in done.losses[:MOST_LOSSES]:
            say(f"  {visible(loss)}")
        if len(done.losses) > MOST_LOSSES:
            say(f"  and {len(done.losses) - MOST_LOSSES} more (list them with --json).")
    if lost:
        raise typer.Exit(FAILED)


def bag_cut(
    bag: Recording,
    start: Annotated[
        float, typer.Option("--from", help="Start, in seconds from the beginning of the bag.", min=0.0)
    ] = 0.0,
    end: Annotated[
        float | None, typer.Option("--until", help="End, in seconds from the beginning of the bag; default: its end.")
    ] = None,
    topics: Annotated[str | None, typer.Option(help="Names of topics, separated by commas; default: all.")] = None,
    compression: Annotated[
        Compression | None, typer.Option(help="Compression of the output bag; default: that of the input bag.")
    ] = None,
    new: Out = None,
    overwrite: Overwrite = False,
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Copy a part of a bag into a new bag, with the messages latched before this part. A split bag becomes one file."""
    import msgspec

    from thbridge.analysis.cut import CutRange, cut
    from ui.command_line.progress import shown_progress

    share_no_output(new, as_json)
    names = None if topics is None else tuple(name.strip() for name in topics.split(","))
    piece = CutRange(start, math.inf if end is None else end, names, compression)
    with (
        bad_input(),
        shown_progress(progress, "bag cut"),
        destination(new or bag.with_name(f"{bag.stem}-cut.bag"), ".bag") as file,
    ):
        done = cut(bag, piece, file, overwrite)
    if as_json:
        print_json(msgspec.to_builtins(done, enc_hook=str))
    elif new != STANDARD_OUTPUT:
        latched = f", {done.latched} of them latched before the start" if done.latched else ""
        say(f"Copied {done.messages} messages to {done.path}{latched}.")


def bag_to_mcap(
    bag: Recording,
    compression: Annotated[Packing, typer.Option(help="Compression of the output file.")] = Packing.ZSTD,
    profile: Annotated[
        Profile, typer.Option(help="`ros1`: a file for Foxglove; `ros2`: a rosbag2 folder for ROS 2.")
    ] = Profile.ROS1,
    new: Out = None,
    overwrite: Overwrite = False,
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Convert a bag to MCAP, for Foxglove and ROS 2."""
    import msgspec

    from thbridge.analysis.to_mcap import to_mcap
    from thbridge.analysis.to_ros2 import to_ros2
    from ui.command_line.progress import shown_progress

    share_no_output(new, as_json)
    if profile is Profile.ROS2:
        if new == STANDARD_OUTPUT or overwrite:
            problem = "a rosbag2 folder must be new and on the disk"
            fail(BAD_INPUT, f"--profile ros2: {problem}. Omit `-` and --overwrite.")
        with bad_input(), shown_progress(progress, "bag to-mcap"):
            folder = to_ros2(bag, new or bag.with_name(f"{bag.stem}-ros2"), Compression(compression))
        if as_json:
            print_json(msgspec.to_builtins(folder, enc_hook=str))
            return
        for topic in folder.left_out:
            note(f"{visible(topic)} is omitted: its type cannot be converted.")
        if folder.broken:
            note(f"{folder.broken} messages are omitted: they do not match their definitions.")
        say(f"Wrote {folder.messages} messages to {folder.path}.")
        return
    with (
        bad_input(),
        destination(new or bag.with_suffix(".mcap"), ".mcap") as file,
        shown_progress(progress, "messages") as tell,
    ):
        done = to_mcap(bag, file, compression, overwrite, tell)
    for topic in done.undefined:
        note(f"{visible(topic)}: the bag has no definition of its type, so no program can decode its messages.")
    if as_json:
        print_json(msgspec.to_builtins(done, enc_hook=str))
    elif new != STANDARD_OUTPUT:
        say(f"Wrote {done.messages} messages to {done.path}.")
