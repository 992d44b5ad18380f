import errno
import json
import os

import pytest

from tests.support.hunts.game_states import EVENTS, STARTED, fold
from thbridge.files.errors import BadFile
from thbridge.hunt.codec import to_json
from thbridge.recording.journal import Journal, journal_path, next_game, read_journal


@pytest.fixture
def written(tmp_path):
    with Journal.start(tmp_path, STARTED) as journal:
        journal.append(EVENTS[:2])
        for event in EVENTS[2:]:
            journal.append((event,))
    return journal.path


def test_what_was_written_is_read_and_folds_to_the_same_game(written):
    found = read_journal(written)
    assert (found.started, found.events, found.torn) == (STARTED, EVENTS, None)
    assert found.state == fold(STARTED, EVENTS)


def test_events_are_on_the_disk_when_append_returns(tmp_path, monkeypatch):
    synced = []
    sync = os.fsync
    monkeypatch.setattr(os, "fsync", lambda descriptor: (sync(descriptor), synced.append(os.fstat(descriptor).st_size)))
    with Journal.start(tmp_path, STARTED) as journal:
        journal.append(EVENTS)
        assert synced[-1] == journal.path.stat().st_size
        assert read_journal(journal.path).events == EVENTS


def test_a_line_torn_anywhere_loses_only_itself(written):
    content = written.read_bytes()
    last = content.rstrip(b"\n").rfind(b"\n") + 1
    for end in range(last, len(content) - 1):
        written.write_bytes(content[:end])
        found = read_journal(written)
        assert found.events == EVENTS[:-1]
        assert found.torn == (content[last:end] or None)


def test_a_last_line_that_only_lacks_its_newline_is_whole(written):
    content = written.read_bytes()
    for end in (content[:-1], content[:-1] + b"\x8a"):
        written.write_bytes(end)
        assert read_journal(written).events == EVENTS
        journal, found = Journal.resume(written)
        with journal:
            assert (found.events, found.torn) == (EVENTS, None)
        assert written.read_bytes() == content


@pytest.mark.parametrize("change", [lambda byte: byte ^ 0x01, lambda byte: byte ^ 0x20, lambda byte: 0xFF ^ byte])
def test_each_byte_that_is_changed_is_noticed_or_changes_nothing(written, change):
    content = written.read_bytes()
    for place, byte in enumerate(content):
        written.write_bytes(content[:place] + bytes((change(byte),)) + content[place + 1 :])
        try:
            found = read_journal(written)
        except BadFile:
            continue
        assert (found.started, found.events) == (STARTED, EVENTS), place


def test_lines_that_are_swapped_repeated_or_left_out_are_noticed(written):
    lines = written.read_bytes().splitlines(keepends=True)
    for others in (
        [lines[0], lines[2], lines[1], *lines[3:]],
        [*lines[:2], lines[1], *lines[2:]],
        [*lines[:1], *lines[2:]],
    ):
        written.write_bytes(b"".join(others))
        with pytest.raises(BadFile, match="checksum"):
            read_journal(written)


def test_a_journal_of_before_checksums_is_read_and_goes_on(written):
    old = "".join(to_json(event) + "\n" for event in (STARTED, *EVENTS[:2]))
    written.write_text(old)
    journal, found = Journal.resume(written)
    with journal:
        assert found.events == EVENTS[:2]
        journal.append(EVENTS[2:])
    assert read_journal(written).events == EVENTS
    assert written.read_text().startswith(old)


def test_each_line_is_an_object_of_json_for_others(written):
    lines = [json.loads(line) for line in written.read_text().splitlines()]
    assert [line["event"] for line in lines][:3] == ["started", "departed", "arrived"]
    assert all(len(line["sum"]) == 16 for line in lines)


def test_a_power_failure_at_any_byte_gives_back_what_was_before_it(written):
    content = written.read_bytes()
    for end in range(content.index(b"\n") + 1, len(content)):
        written.write_bytes(content[:end])
        found = read_journal(written)
        # A line counts as soon as it is whole, with or without its newline.
        whole = content[: end + 1].count(b"\n") if content[end : end + 1] == b"\n" else content[:end].count(b"\n")
        assert found.events == EVENTS[: whole - 1]


def test_a_torn_journal_is_gone_on_with(written):
    content = written.read_bytes()
    written.write_bytes(content[:-5] + b"\0\0")
    journal, found = Journal.resume(written)
    with journal:
        assert found.torn is not None and found.events == EVENTS[:-1]
        journal.append(EVENTS[-1:])
    assert written.read_bytes() == content


@pytest.mark.parametrize(
    ("damage", "line"),
    [
        (lambda lines: [lines[0], b'{"v":1,', *lines[2:]], 2),
        (lambda lines: [lines[0], b"\xff\xfe", *lines[2:]], 2),
        (lambda lines: [*lines[:3], b"", *lines[3:]], 4),
        (lambda lines: lines[1:], 1),
        (lambda lines: [lines[0], lines[0], *lines[1:]], 2),
        (lambda lines: [*lines, lines[1].replace(b'"robot":0', b'"robot":5')], 6),
    ],
)
def test_damage_in_the_middle_is_refused_with_its_line(written, damage, line):
    lines = damage(written.read_bytes().splitlines())
    written.write_bytes(b"\n".join(lines) + b"\n")
    for read in (read_journal, Journal.resume):
        with pytest.raises(BadFile, match=f"line {line}:") as caught:
            read(written)
        assert caught.value.path == written


def test_a_journal_whose_start_was_torn_holds_no_game(written):
    written.write_bytes(written.read_bytes()[:20])
    with pytest.raises(BadFile, match="no start of a game"):
        read_journal(written)


def test_two_cannot_write_one_journal(tmp_path):
    with Journal.start(tmp_path, STARTED) as journal:
        with pytest.raises(BadFile, match="another program"):
            Journal.resume(journal.path)
        read_journal(journal.path)
    again, _ = Journal.resume(journal.path)
    again.close()
    again.close()


def test_each_game_has_its_own_file(tmp_path):
    folder = tmp_path / "new" / "journals"
    assert next_game(folder) == 1
    Journal.start(folder, STARTED).close()
    assert next_game(folder) == 2
    assert journal_path(folder, 1).exists()
    with pytest.raises(BadFile, match="next number"):
        Journal.start(folder, STARTED)
    (folder / "game-notes.jsonl").touch()
    (folder / "game-0041.jsonl").touch()
    assert next_game(folder) == 42


def test_a_full_disk_is_told_and_leaves_no_torn_line(written, monkeypatch):
    content = written.read_bytes()
    journal, _ = Journal.resume(written)

    def full(descriptor):
        raise OSError(errno.ENOSPC, "No space left on device")

    with journal, monkeypatch.context() as disk:
        disk.setattr(os, "fsync", full)
        with pytest.raises(BadFile, match="No space left"):
            journal.append(EVENTS[:1])
    assert written.read_bytes() == content


def test_a_game_that_cannot_be_written_leaves_no_file(tmp_path, monkeypatch):
    def full(descriptor):
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as disk:
        disk.setattr(os, "fsync", full)
        with pytest.raises(BadFile, match="No space left"):
            Journal.start(tmp_path, STARTED)
    Journal.start(tmp_path, STARTED).close()


def test_a_journal_that_is_not_there(tmp_path):
    for read in (read_journal, Journal.resume):
        with pytest.raises(BadFile, match="game-0001"):
            read(journal_path(tmp_path, 1))
