"""The journal of a game: each byte changed and each cut is noticed, or changes nothing in the history."""

from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import pytest

from tests.support.disks.damaged_files import EACH_BIT, SOME_BITS, cuts, flips
from thbridge import api
from thbridge.files.errors import BadFile
from thbridge.hunt.events import JournalEntry
from thbridge.recording.journal import Journal, RecoveredGame, read_journal
from thbridge.recording.journal_folder import JournalStore


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The journal of a short game with a dialogue, played to its end."""
    bag = tmp_path_factory.mktemp("played") / "hunt.bag"
    study = api.HuntStudy(robots=1, seed=3, game={"energy": 20})
    with api.HuntSession(study, participant="nearest", record=bag) as session:
        assert session.play()
    (journal,) = bag.with_suffix(".journal").glob("*.jsonl")
    return journal.read_bytes()


def history_of(found: RecoveredGame) -> tuple[JournalEntry, ...]:
    return found.started, *found.events


def outcomes(path: Path, content: bytes, damaged: Iterable[tuple[str, bytes]]) -> Counter[str]:
    """Read a journal with each damage, and count what came of it; another history than the one written is a failure."""
    path.write_bytes(content)
    whole = read_journal(path)
    assert whole.state.ended is not None
    counted: Counter[str] = Counter()
    for what, data in damaged:
        path.write_bytes(data)
        try:
            found = read_journal(path)
        except BadFile as fault:
            assert fault.path == path, what
            counted["refused"] += 1
            continue
        history = history_of(found)
        if history == history_of(whole):
            counted["the same"] += 1
        else:
            assert len(data) < len(content), what
            assert history == history_of(whole)[: len(history)], what
            # A server that finds it says that this game goes on, and that its last event is lost where it is torn.
            assert found.state.ended is None, what
            between_lines = data.endswith(b"\n") or content.startswith(data + b"\n")
            assert (found.torn is None) == between_lines, what
            counted["the beginning"] += 1
        journal, again = Journal.resume(path)
        journal.close()
        assert history_of(again) == history == history_of(read_journal(path)), what
    return counted


@pytest.mark.parametrize(
    ("masks", "stride"), [((0x01, 0xFF), 13), pytest.param(EACH_BIT, 1, marks=pytest.mark.slow)], ids=["quick", "each"]
)
def test_a_changed_byte_is_refused_or_changes_nothing(
    played: bytes, tmp_path: Path, masks: tuple[int, ...], stride: int
) -> None:
    counted = outcomes(tmp_path / "game-0001.jsonl", played, flips(played, masks, stride))
    assert counted["refused"] > 0
    assert counted["the beginning"] == 0


@pytest.mark.parametrize("stride", [7, pytest.param(1, marks=pytest.mark.slow)], ids=["quick", "each"])
def test_a_cut_leaves_the_beginning_of_a_game_that_has_not_ended(played: bytes, tmp_path: Path, stride: int) -> None:
    counted = outcomes(tmp_path / "game-0001.jsonl", played, cuts(played, stride))
    assert counted["the beginning"] > 0


def test_a_line_torn_after_the_end_of_a_game_is_told(
    played: bytes, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "game-0001.jsonl"
    path.write_bytes(played + b'{"v":1,"eve')
    assert JournalStore(tmp_path).resume() is None
    assert f"{path}: an event was only partly written" in caplog.text
    assert path.read_bytes() == played


@pytest.mark.parametrize("masks", [SOME_BITS, pytest.param(EACH_BIT, marks=pytest.mark.slow)], ids=["quick", "each"])
def test_a_changed_byte_of_the_last_event_of_a_game_that_was_cut_off_is_refused_or_changes_nothing(
    played: bytes, tmp_path: Path, masks: tuple[int, ...]
) -> None:
    """Where only the last line is wrong, it must not pass for one that was being written."""
    path = tmp_path / "game-0001.jsonl"
    cut_off = b"".join(played.splitlines(keepends=True)[:-1])
    path.write_bytes(cut_off)
    whole = history_of(read_journal(path))
    last = cut_off.rindex(b"\n", 0, len(cut_off) - 1) + 1
    for what, line in flips(cut_off[last:], masks):
        path.write_bytes(cut_off[:last] + line)
        try:
            found = read_journal(path)
        except BadFile:
            continue
        assert history_of(found) == whole, what
