"""Check of the names of new recordings, before a session starts."""

from pathlib import Path

from thbridge.recording.bag.options import MCAP_COMPRESSIONS, ROS1_COMPRESSIONS, Compression
from thbridge.recording.recordings import BAG, MCAP, is_of_ros2


def problem_of(bag: Path, compression: Compression) -> str | None:
    """Return why a recording cannot have this name, as two sentences; None if it can.

    Args:
        bag: name of the recording.
        compression: compression of its chunks, from the study.
    """
    if bag.suffix not in {BAG, MCAP, ""} or bag.name in {"", "-", ".."} or (bag.suffix and bag.is_dir()):
        remedy = "Write a file name that ends in .bag or .mcap, or the name of a folder, without ending"
        return f"{bag} is not the name of a recording. {remedy}."
    ours, theirs = (MCAP_COMPRESSIONS, BAG) if is_of_ros2(bag) else (ROS1_COMPRESSIONS, MCAP)
    if compression in ours:
        return None
    kind = "an MCAP file" if is_of_ros2(bag) else "a bag of ROS 1"
    return (
        f"{bag} is {kind}, which cannot have `recording.compression: {compression}`. Write {', '.join(ours)} into the "
        f"study, or record into {bag.stem}{theirs}."
    )
