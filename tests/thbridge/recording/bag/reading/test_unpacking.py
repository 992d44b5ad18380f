import bz2
from pathlib import Path

import lz4.frame
import pytest

from tests.thbridge.analysis import planting
from thbridge.files.errors import BadFile
from thbridge.recording.bag.damage import TooLargeChunk
from thbridge.recording.bag.reading import unpacking
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.reading.scan import UnreadableSpan, scan
from thbridge.recording.bag.reading.unpacking import UnpackedBytes, unpacked

ZEROS = bytes(1 << 20)


@pytest.mark.parametrize(("name", "pack"), [("bz2", bz2.compress), ("lz4", lz4.frame.compress)])
def test_a_chunk_gives_no_more_than_its_record_says(name: str, pack: object) -> None:
    packed = pack(ZEROS)  # type: ignore[operator]
    assert unpacked(name, packed, len(ZEROS)) == ZEROS
    with pytest.raises(TooLargeChunk, match="more than the 1000 bytes"):
        unpacked(name, packed, 1000)


def test_a_small_chunk_does_not_claim_gigabytes() -> None:
    with pytest.raises(TooLargeChunk, match="claims to unpack to 4000000000"):
        unpacked("bz2", bz2.compress(ZEROS), 4_000_000_000)


def test_many_chunks_do_not_unpack_to_more_than_their_file_can_hold() -> None:
    so_far = UnpackedBytes(1000)
    so_far.add(unpacking.ALWAYS_IN_ALL + 1000 * unpacking.TIMES_FILE)
    with pytest.raises(TooLargeChunk):
        so_far.add(1)


def test_a_bag_with_such_a_chunk_is_refused_and_its_check_tells_it(tmp_path: Path) -> None:
    bag = planting.write(tmp_path / "bomb.bag", planting.clean(), lz4_flags={})
    data = bag.read_bytes()
    at = data.index(b"size=") + 5
    bag.write_bytes(data[:at] + (4_000_000_000).to_bytes(4, "little") + data[at + 4 :])
    with pytest.raises(BadFile, match="claims to unpack"):
        list(messages(bag))
    spans = [record for record in scan(bag) if isinstance(record, UnreadableSpan)]
    assert len(spans) == 1
    assert "claims to unpack" in spans[0].problem
