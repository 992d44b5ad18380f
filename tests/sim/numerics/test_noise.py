import numpy as np
import pytest

from sim.numerics.noise import key, philox, uniform

# Random123, tests/kat_vectors, the lines "philox4x32 10": counter, key, result.
KNOWN_ANSWERS = [
    ("00000000 00000000 00000000 00000000", "00000000 00000000", "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
    ("ffffffff ffffffff ffffffff ffffffff", "ffffffff ffffffff", "408f276d 41c83b0e a20bc7c6 6d5451fd"),
    ("243f6a88 85a308d3 13198a2e 03707344", "a4093822 299f31d0", "d16cfe09 94fdcceb 5001e420 24126ea1"),
]


def words(text: str) -> list[np.uint64]:
    return [np.uint64(int(word, 16)) for word in text.split()]


@pytest.mark.parametrize(("counter", "stream", "result"), KNOWN_ANSWERS)
def test_philox_gives_the_known_answers_of_its_authors(counter: str, stream: str, result: str) -> None:
    assert list(philox(*words(counter), *words(stream))) == words(result)


def test_numbers_of_a_stream_are_the_same_for_ever() -> None:
    # Frozen on purpose: recordings are replayed by drawing the same numbers again.
    assert int(key(7, "robot1", "laser")) == 6293750106573414420
    assert [uniform(key(7, "robot1", "laser"), 3, index) for index in range(3)] == [
        0.5974859556477822,
        0.05114489660878385,
        0.5120727368929462,
    ]


def test_every_part_of_a_name_makes_another_stream() -> None:
    keys = {
        int(key(seed, *names))
        for seed in (0, 1, -1, 2**70)
        for names in [(), ("a",), ("a", "b"), ("ab",), ("b", "a"), ("", "ab"), ("ab", ""), ("a\x00b",)]
    }
    assert len(keys) == 4 * 8
