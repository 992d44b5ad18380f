import bz2
from pathlib import Path
from struct import pack

import lz4.frame
import pytest
import zstandard

from tests.support.bags import bags_with_faults
from thbridge.files.errors import BadFile
from thbridge.recording.bag import unpacking
from thbridge.recording.bag.damage import TooLargeChunk
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.reading.scan import UnreadableSpan, scan
from thbridge.recording.bag.unpacking import MCAP_MAGIC, UnpackedBytes, check_mcap, unpacked

ZEROS = bytes(1 << 20)


@pytest.mark.parametrize(("name", "pack"), [("bz2", bz2.compress), ("lz4", lz4.frame.compress)])
def test_a_chunk_gives_no_more_than_its_record_says(name: str, pack: object) -> None:
    packed = pack(ZEROS)  # type: ignore[operator]
    assert unpacked(name, packed, len(ZEROS)) == ZEROS
    with pytest.raises(TooLargeChunk, match="more than the 1000 bytes"):
        unpacked(name, packed, 1000)


def test_a_small_chunk_does_not_claim_gigabytes() -> None:
    with pytest.raises(TooLargeChunk, match="claims an unpacked size of 4000000000"):
        unpacked("bz2", bz2.compress(ZEROS), 4_000_000_000)


def test_many_chunks_do_not_unpack_to_more_than_their_file_can_hold() -> None:
    so_far = UnpackedBytes(1000)
    so_far.add(unpacking.ALWAYS_IN_ALL + 1000 * unpacking.TIMES_FILE)
    with pytest.raises(TooLargeChunk):
        so_far.add(1)


def test_a_bag_with_such_a_chunk_is_refused_and_its_check_tells_it(tmp_path: Path) -> None:
    bag = bags_with_faults.write(tmp_path / "bomb.bag", bags_with_faults.clean(), lz4_flags={})
    data = bag.read_bytes()
    at = data.index(b"size=") + 5
    bag.write_bytes(data[:at] + (4_000_000_000).to_bytes(4, "little") + data[at + 4 :])
    with pytest.raises(BadFile, match="claims an unpacked size"):
        list(messages(bag))
    spans = [record for record in scan(bag) if isinstance(record, UnreadableSpan)]
    assert len(spans) == 1
    assert "claims an unpacked size" in spans[0].problem


def mcap_of(path: Path, compression: bytes, packed: bytes, size: int) -> Path:
    """An MCAP file of one chunk."""
    head = pack("<QQQII", 0, 1, size, 0, len(compression)) + compression + pack("<Q", len(packed))
    path.write_bytes(MCAP_MAGIC + pack("<BQ", 6, len(head) + len(packed)) + head + packed)
    return path


PACKED = {
    b"zstd": zstandard.compress(ZEROS),
    b"lz4": lz4.frame.compress(ZEROS),
    b"": ZEROS,
}


@pytest.mark.parametrize("compression", PACKED)
def test_chunks_of_mcap_files_that_are_what_they_claim_pass(compression: bytes, tmp_path: Path) -> None:
    check_mcap(mcap_of(tmp_path / "a.mcap", compression, PACKED[compression], len(ZEROS)))


@pytest.mark.parametrize("compression", [b"zstd", b"lz4"])
def test_chunks_of_mcap_files_that_unpack_to_more_do_not(compression: bytes, tmp_path: Path) -> None:
    file = mcap_of(tmp_path / "a.mcap", compression, PACKED[compression], 1000)
    with pytest.raises(TooLargeChunk, match="more than the 1000 bytes"):
        check_mcap(file)
    with pytest.raises(BadFile, match="more than the 1000 bytes"):
        list(messages(file))
    with pytest.raises(TooLargeChunk, match="claims"):
        check_mcap(mcap_of(tmp_path / "b.mcap", compression, PACKED[compression], 4_000_000_000))


def test_a_second_frame_behind_one_that_is_right_is_counted(tmp_path: Path) -> None:
    with pytest.raises(TooLargeChunk):
        check_mcap(mcap_of(tmp_path / "a.mcap", b"zstd", 2 * PACKED[b"zstd"], len(ZEROS)))
