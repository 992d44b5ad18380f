"""Parsers refuse what is damaged in words, within bounds; `make fuzz` tries many more."""

from pathlib import Path
from random import Random

import pytest

from tests.fuzz import cases
from tests.fuzz.__main__ import done_before, run, shares
from tests.fuzz.cases import ALL, TooSlow, bounded, fuzz
from tests.fuzz.messages import MessageTarget
from tests.fuzz.mutating import mutated


@pytest.mark.parametrize("name", ALL)
def test_what_has_mistakes_is_refused_in_words(name: str, tmp_path: Path) -> None:
    assert list(fuzz(name, tmp_path, 1, ALL[name].quick)) == []


def test_mistakes_are_those_of_the_seed() -> None:
    assert mutated(b"abc" * 100, Random("1")) == mutated(b"abc" * 100, Random("1")) != b"abc" * 100


def test_what_hangs_or_takes_all_memory_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.fuzz.cases.SECONDS", 0.05)
    with pytest.raises(TooSlow), bounded():
        while True:
            pass
    with pytest.raises(MemoryError), bounded():
        bytearray(1 << 32)


def test_a_run_goes_on_where_it_was_ended_and_reads_what_it_would_have_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[bytes] = []
    target = MessageTarget(1, lambda: (b"abc" * 100,), read.append)
    monkeypatch.setitem(cases.ALL, "given", target)
    (tmp_path / "whole").mkdir()
    run({"given": 7}, 5, tmp_path / "whole")
    at_once = [data for data in read if data != b"abc" * 100]
    read.clear()
    (tmp_path / "parts").mkdir()
    for count in (3, 7):
        run({"given": count}, 5, tmp_path / "parts")
    assert [data for data in read if data != b"abc" * 100] == at_once
    assert done_before(tmp_path / "parts", 5) == {"given": 7}
    assert [path.name for path in (tmp_path / "parts").iterdir()] == ["done-5.json"]


def test_what_a_parser_does_not_refuse_well_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def read(data: bytes) -> None:
        if data != b"abc":
            raise KeyError(data)

    monkeypatch.setitem(cases.ALL, "given", MessageTarget(1, lambda: (b"abc",), read))
    assert run({"given": 2}, 5, tmp_path) == 2
    assert len(list(tmp_path.rglob("given-5-*"))) == 2


def test_a_total_is_shared_out_with_most_for_quick_parsers() -> None:
    counts = shares(10_000_000, list(ALL))
    assert 10_000_000 <= sum(counts.values()) < 10_000_000 + len(ALL)
    quick = ALL["tlog"].quick / ALL["bag"].quick
    assert counts["tlog"] == pytest.approx(quick**2 * counts["bag"], rel=1e-3)
