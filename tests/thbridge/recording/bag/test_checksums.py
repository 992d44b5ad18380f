"""Checksums of the blocks of a chunk."""

from hypothesis import given
from hypothesis import strategies as st

from thbridge.recording.bag.checksums import BLOCKS, block_checksums, intact_bytes

SIZES = st.integers(0, 3 * 4096 * BLOCKS)


def content(size: int) -> bytes:
    return bytes(place * 7919 >> 8 & 255 for place in range(min(size, 5000))) * (size // 5000 + 1)


@given(SIZES, SIZES)
def test_the_beginning_of_a_chunk_is_intact_up_to_a_block(size: int, kept: int) -> None:
    data = content(size)[:size]
    sums = block_checksums(data)
    assert len(sums) == 4 * BLOCKS
    assert intact_bytes(data, size, sums) == size
    intact = intact_bytes(data[:kept], size, sums)
    assert min(size, kept) - max(4096, 2 * size // BLOCKS) < intact <= min(size, kept)


@given(st.integers(1, 3 * 4096 * BLOCKS), st.data())
def test_no_byte_of_a_damaged_block_is_intact(size: int, draw: st.DataObject) -> None:
    data = bytearray(content(size)[:size])
    sums = block_checksums(data)
    place = draw.draw(st.integers(0, size - 1))
    data[place] ^= draw.draw(st.integers(1, 255))
    assert intact_bytes(data, size, sums) <= place


@given(SIZES, SIZES)
def test_a_shorter_chunk_stays_valid_below_a_longer_one(size: int, longer: int) -> None:
    """The bytes of the shorter one, with the checksums of either, are intact but for their last block."""
    size, longer = sorted((size, longer))
    data = content(longer)[:longer]
    stale = data[:size] + bytes(longer - size)
    block = max(4096, 2 * longer // BLOCKS)
    assert intact_bytes(stale, longer, block_checksums(data)) > size - block
    assert intact_bytes(stale[:size], size, block_checksums(data[:size])) == size


def test_checksums_of_another_length_check_nothing() -> None:
    assert intact_bytes(b"abc", 3, b"") == 0
