"""Parsers of files refuse what is damaged by BadFile, within bounds; `make fuzz` tries many more."""

from pathlib import Path
from random import Random

import pytest

from tests.fuzz.cases import TooSlow, bounded, fuzz
from tests.fuzz.mutating import mutated
from tests.fuzz.targets import TARGETS


@pytest.mark.parametrize("name", TARGETS)
def test_files_with_mistakes_are_refused_in_words(name: str, tmp_path: Path) -> None:
    assert list(fuzz(name, tmp_path, 1, TARGETS[name].quick)) == []


def test_mistakes_are_those_of_the_seed() -> None:
    assert mutated(b"abc" * 100, Random("1")) == mutated(b"abc" * 100, Random("1")) != b"abc" * 100


def test_what_hangs_or_takes_all_memory_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.fuzz.cases.SECONDS", 0.05)
    with pytest.raises(TooSlow), bounded():
        while True:
            pass
    with pytest.raises(MemoryError), bounded():
        bytearray(1 << 32)
