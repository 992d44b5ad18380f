"""`thbridge bag`: look into recordings and mend them."""

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
"""Losses of a repair that are listed one by one."""

Out = Annotated[
    Path | None, typer.Option("--to", help="The new file; by default beside the bag. `-` is standard output.")
]


Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace a file of that name.")]


class Packing(StrEnum):
    """Compression of chunks in an MCAP file."""

    ZSTD = "zstd"
    LZ4 = "lz4"
    NONE = "none"


class Profile(StrEnum):
    """Generation of ROS that an MCAP file is for."""

    ROS1 = "ros1"
    ROS2 = "ros2"


def bag_info(
    bag: Recording,
    hashed: Annotated[
        bool, typer.Option("--hash", help="Also the digest of all messages but the session's own record.")
    ] = False,
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Say what is in a bag: topics, types, rates, gaps, and the session if it is ours."""
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
        say(f"{name} of the messages: {value}")


def bag_check(bag: Recording, progress: ProgressOption = ProgressKind.AUTO, as_json: AsJson = False) -> None:
    """Judge a bag: will rosbag, rviz, Foxglove, PlotJuggler and evo take it, and why not."""
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
    bag: Annotated[Path, typer.Argument(help="A bag whose writer was killed.")],
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Recover a bag that was cut off; the original is kept beside it."""
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
            say(f"  and {len(done.losses) - MOST_LOSSES} more, which --json lists.")
    if lost:
        raise typer.Exit(FAILED)


def bag_cut(
    bag: Recording,
    start: Annotated[float, typer.Option("--from", help="Seconds from its beginning.", min=0.0)] = 0.0,
    end: Annotated[float | None, typer.Option("--until", help="Seconds from its beginning; by default all.")] = None,
    topics: Annotated[str | None, typer.Option(help="Names with commas between; by default all.")] = None,
    compression: Annotated[
        Compression | None, typer.Option(help="Of the new bag; by default as the bag is packed.")
    ] = None,
    new: Out = None,
    overwrite: Overwrite = False,
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Cut a piece out of a bag; it begins with what was latched before. Parts become one bag."""
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
        latched = f", {done.latched} of them latched before" if done.latched else ""
        say(f"Cut {done.messages} messages into {done.path}{latched}.")


def bag_to_mcap(
    bag: Recording,
    compression: Annotated[Packing, typer.Option(help="Of the new file.")] = Packing.ZSTD,
    profile: Annotated[
        Profile, typer.Option(help="ros1: a file, for Foxglove; ros2: a folder of rosbag2, for ROS 2.")
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
        if new == STANDARD_OUTPUT or overwrite or compression is Packing.LZ4:
            problem = "a folder of rosbag2 goes to a new place on the disk, packed by zstd or not at all"
            fail(BAD_INPUT, f"--profile ros2: {problem}. Leave `-`, --overwrite and lz4 out.")
        with bad_input(), shown_progress(progress, "bag to-mcap"):
            folder = to_ros2(bag, new or bag.with_name(f"{bag.stem}-ros2"), compression is Packing.ZSTD)
        if as_json:
            print_json(msgspec.to_builtins(folder, enc_hook=str))
            return
        for topic in folder.left_out:
            note(f"{visible(topic)} is left out: its type cannot be converted.")
        if folder.broken:
            note(f"{folder.broken} messages are left out: they do not fit their definitions.")
        say(f"Wrote {folder.messages} messages to {folder.path}.")
        return
    with (
        bad_input(),
        destination(new or bag.with_suffix(".mcap"), ".mcap") as file,
        shown_progress(progress, "messages") as tell,
    ):
        done = to_mcap(bag, file, compression, overwrite, tell)
    for topic in done.undefined:
        note(f"{visible(topic)}: the bag has no definition of its type, and no reader can decode it.")
    if as_json:
        print_json(msgspec.to_builtins(done, enc_hook=str))
    elif new != STANDARD_OUTPUT:
        say(f"Wrote {done.messages} messages to {done.path}.")
