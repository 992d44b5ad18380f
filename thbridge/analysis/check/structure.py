"""Rules about the file: index, chunks, first record."""

from collections.abc import Iterator

from thbridge.analysis.check.finding import ALL, BagStructure, BagTool, Finding, FindingSeverity

HEADER_BYTES = 4096
"""Size of the first record's header and padding, as ROS 1 writes them, bytes (rosbag, bag.py, _FILE_HEADER_LENGTH)."""
ROS_LZ4_FLAGS = 0x64
"""FLG byte of the LZ4 frames that roslz4 can read: version 1, independent blocks, checksum of the content."""
OVERLAP_SHARE = 0.25
CUT = "run `thbridge bag cut`, which sorts the messages"
REINDEX = "run `thbridge bag reindex`"


def index_missing(bag: BagStructure) -> Iterator[Finding]:
    """Find bags without an index, because the writer was killed: no tool opens them."""
    if bag.header is None or bag.header.index_pos == 0:
        yield Finding(
            "no-index", FindingSeverity.ERROR, ALL, None, "the bag has no index: its writer was killed", REINDEX
        )
    elif not bag.unreadable and bag.header.chunks and not bag.index:
        problem = "the first record names an index, but there is none"
        yield Finding("no-index", FindingSeverity.ERROR, ALL, None, problem, REINDEX)


def index_wrong(bag: BagStructure) -> Iterator[Finding]:
    """Find an index that does not match the chunks. Readers then miss messages or read wrong messages."""
    if bag.header is None or not bag.index:
        return
    if (bag.header.connections, bag.header.chunks) != (bag.indexed_connections, len(bag.index)):
        problem = (
            f"the first record names {bag.header.connections} connections and {bag.header.chunks} chunks, "
            f"but the index has {bag.indexed_connections} and {len(bag.index)}"
        )
        yield Finding("index-wrong", FindingSeverity.ERROR, ALL, None, problem, REINDEX)
    indexed = {entry.position: entry.counts for entry in bag.index}
    wrong = [
        known
        for known in bag.chunks
        if indexed.get(known.chunk.position, {}) != known.counts or known.indexed != known.counts
    ]
    if wrong:
        position = wrong[0].chunk.position
        problem = f"the index of {len(wrong)} chunks does not match their messages, first at byte {position}"
        yield Finding("index-wrong", FindingSeverity.ERROR, ALL, None, problem, REINDEX, wrong[0].start_ns)


def unreadable_bytes(bag: BagStructure) -> Iterator[Finding]:
    """Find bytes that cannot be read."""
    if bag.unreadable:
        first = bag.unreadable[0]
        lost = sum(tear.lost for tear in bag.unreadable)
        problem = f"{lost} bytes cannot be read, first at byte {first.position}: {first.problem}"
        yield Finding("torn", FindingSeverity.ERROR, ALL, None, problem, f"{REINDEX}; unreadable data are lost")


def header_padding(bag: BagStructure) -> Iterator[Finding]:
    """Find bags whose first record does not have ROS's length. rosbag overwrites it and part of the first chunk."""
    if bag.header is not None and bag.header.length != HEADER_BYTES:
        problem = (
            f"the first record has {bag.header.length} bytes, but ROS 1 writes {HEADER_BYTES}: "
            "`rosbag reindex` and appending would overwrite the first chunk"
        )
        yield Finding(
            "header-padding", FindingSeverity.WARNING, (BagTool.ROSBAG,), None, problem, "run `thbridge bag cut`"
        )


def encrypted(bag: BagStructure) -> Iterator[Finding]:
    """Find encrypted bags, which only ROS's C++ library reads, and only with the key."""
    if bag.header is not None and bag.header.encryptor:
        problem = f"the bag is encrypted ({bag.header.encryptor})"
        tools = (BagTool.FOXGLOVE, BagTool.EVO)
        yield Finding("encrypted", FindingSeverity.ERROR, tools, None, problem, "decrypt it with `rosbag decrypt`")


def chunk_order(bag: BagStructure) -> Iterator[Finding]:
    """Find chunks that are not in the order of time: `rosbag info` uses the first and the last chunk for start and end.

    Foxglove's reader starts at the beginning of the first chunk, and omits all messages before it.
    """
    if not bag.index or bag.start_ns is None:
        return
    first, last = bag.index[0], bag.index[-1]
    if (first.start_ns, last.end_ns) == (bag.start_ns, bag.end_ns):
        return
    problem = (
        "chunks are empty or not in the order of time: "
        f"`rosbag info` reports {(last.end_ns - first.start_ns) / 1e9:.1f} s instead of {bag.seconds:.1f} s"
    )
    if first.start_ns > bag.start_ns:
        problem += f", and Foxglove omits all messages before {(first.start_ns - bag.start_ns) / 1e9:.1f} s"
        yield Finding("chunk-order", FindingSeverity.ERROR, (BagTool.ROSBAG, BagTool.FOXGLOVE), None, problem, CUT)
    else:
        yield Finding("chunk-order", FindingSeverity.WARNING, (BagTool.ROSBAG,), None, problem, CUT)


def chunks_overlap(bag: BagStructure) -> Iterator[Finding]:
    """Find overlapping chunks, which Foxglove keeps in memory together, with a warning (BagIterableSource.ts)."""
    latest_ns, overlapping = 0, 0
    for entry in bag.index:
        overlapping += entry.start_ns < latest_ns
        latest_ns = max(latest_ns, entry.end_ns)
    if overlapping > OVERLAP_SHARE * len(bag.index):
        problem = f"{overlapping} of {len(bag.index)} chunks overlap other chunks in time"
        yield Finding("chunks-overlap", FindingSeverity.WARNING, (BagTool.FOXGLOVE,), None, problem, CUT)


def lz4_frames(bag: BagStructure) -> Iterator[Finding]:
    """Find LZ4 frames that roslz4 cannot decompress: roslz4 needs independent blocks and a checksum of all content."""
    other = [known for known in bag.chunks if known.chunk.lz4_flags not in (None, ROS_LZ4_FLAGS)]
    if other:
        problem = (
            f"{len(other)} chunks are LZ4 frames that ROS cannot decompress, first at byte {other[0].chunk.position}"
        )
        tools = (BagTool.ROSBAG, BagTool.RVIZ, BagTool.PLOTJUGGLER)
        remedy = "run `thbridge bag cut --compression lz4` on the bag"
        yield Finding("lz4-frames", FindingSeverity.ERROR, tools, None, problem, remedy, other[0].start_ns)


def no_messages(bag: BagStructure) -> Iterator[Finding]:
    """Find bags without messages."""
    if bag.start_ns is None:
        yield Finding(
            "empty", FindingSeverity.WARNING, ALL, None, "there are no messages in the bag", "record it again"
        )


RULES = (
    index_missing,
    index_wrong,
    unreadable_bytes,
    header_padding,
    encrypted,
    chunk_order,
    chunks_overlap,
    lz4_frames,
    no_messages,
)
